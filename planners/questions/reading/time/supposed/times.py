"""The time of a question in plain words, where it is told by what happens: "having made its turn" is "after it has
turned"."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from ......gaussians import late_re as re
from .....grammar.learned.events import Event, event_of
from .....grammar.tagging.words import bag
from .....grammar.vocabulary.quantities import ORDINALS
from ..everyday import everyday
from ..moments import NUMBER, seconds

_LEADS = (  # how a phrase begins, and the conjunction that says the same
    (re.compile(r"^(?:right |just |only )*(?:until|till|til|up to)\b"), "until"),
    (re.compile(r"^(?:right |just |only )*(?:before|prior to)\b"), "before"),
    (re.compile(r"^by\b"), "by the time"),
    (re.compile(r"^(?:right |just |only |directly |straight )*(?:after|following|having|past|post|since)\b"), "after"),
)
_MOMENTS = {  # what happens, as a predicate
    "starts": "starts to move", "stops": "stops", "opens": "starts to open", "open": "is fully open",
    "closes": "starts to close", "shut": "is closed", "half": "is half open", "falls": "falls", "lands": "lands",
    "turns": "starts to turn", "turned": "has turned", "reaches": "reaches {y}", "leaves": "leaves {y}",
    "first_of": "falls first", "last_of": "falls last",
}  # fmt: skip
_SPANS = {  # what is so for a while
    "moves": "is moving", "still": "stands still", "opening": "is opening", "is_open": "is open",
    "closing": "is closing", "is_shut": "is closed", "falling": "is falling", "turning": "is turning",
    "on": "is on {y}", "in_step": "is moving",
}  # fmt: skip

_IT_ENDS = (
    r"(?:before|until|till|to when) (?:the|this|our) (?:film|clip|video|movie|footage|recording|"
    r"scene|shot|show|story|picture) "
    r"(?:ends?|concludes?|runs out|is (?:over|done|finished)|finish(?:es)?|stops|cuts out|closes)"
)
_END = (
    r"(?:last frame|(?:very )?end(?! of (?:it|its|his|her|that))|"
    r"(?:film|clip|video|movie|footage|recording|scene|shot) 's end)"
)
_LEFT = re.compile(
    r"\b(?:how (?:much|long|many)|what)\b.*\b(?:left|remain\w*|still to (?:come|go)|"
    rf"{_IT_ENDS}|(?:to|until|till) the {_END})\b|"
    rf"\b(?:(?:to|until|till|and) the {_END}\b|{_IT_ENDS}).*\bhow (?:much|long|many)\b"
)
_TO_THE_END = re.compile(rf"(?: ,)? (?:\w+ )?(?:(?:to|until|till|and) the {_END}\b|{_IT_ENDS}).*$")
_SHOWN = re.compile(
    r"\b(?:film|clip|video|movie|picture|footage|recording|shot|frames?|seconds?|air|screen|time|show|scene|end)\b"
)
_OF_ONE = ("it", "he", "she", "they")


def plain_time(phrase: str) -> str | None:
    """A time that is told by what happens, as a clause with a plain verb; "" for all of the film, None for another."""
    event = event_of(phrase)
    if event is None:
        return None
    lead = next((word for pattern, word in _LEADS if pattern.match(phrase)), "")
    if event.kind == "film_end" and lead:
        return ""  # before it ends
    if event.kind in ("film_start", "film_end"):
        return "at the start" if event.kind == "film_start" else "at the end"
    who = event.x or "it"
    if who not in _OF_ONE:
        who = with_article(who)
    if event.kind == "first_leg":
        return f"before {who} turns"
    if event.kind == "last_leg":
        return f"after {who} has turned"
    said = (_MOMENTS | _SPANS)[event.kind].format(y=with_article(event.y))
    return f"{lead or _conjunction(event)} {who} {said}"


def with_article(name: str) -> str:
    """A name with an article."""
    return name if re.match(r"^(?:the|a|an|my|our|this|that|all|both)\b", name) else f"the {name}"


def _conjunction(event: Event) -> str:
    if event.kind == "turned":
        return "after"
    return "while" if event.kind in _SPANS else "when"


def time_left(words: Sequence[str], times: Sequence[str]) -> str | None:
    """The plain question of how much of the film is left when something happens: "once the fan gives up, how much of
    the picture have we left"; None of others.

    Args:
        words: those of the question.
        times: those of its times.
    """
    said = " ".join(words)
    if not times or _LEFT.search(said) is None or _SHOWN.search(said) is None:
        return None
    event = event_of(_TO_THE_END.sub("", times[0]))
    if event is None or not event.x or not _is_moment(event):
        return None
    return f"how long is it from when {_happens(event, event.x)} to the end of the film"


def _is_moment(event: Event) -> bool:
    """Whether an event is a moment, or begins with one."""
    return event.kind in _MOMENTS or event.kind in _BEGUN_BY


def _happens(event: Event, who: str) -> str:
    """Who does what, of an event that is a moment or begins with one."""
    done = _MOMENTS[_BEGUN_BY.get(event.kind, event.kind)].format(y=with_article(event.y))
    return f"{who if who in _OF_ONE else with_article(who)} {done}"


_BEGUN_BY = {  # what lasts, and what it begins with
    "is_open": "open", "still": "stops", "is_shut": "shut", "moves": "starts", "opening": "opens", "closing": "closes",
    "falling": "falls", "turning": "turns",
}  # fmt: skip


def from_one_to_another(times: Sequence[str], x: str, named: Callable[[str], bool]) -> str | None:
    """The plain question of how long it is from one event to another: "the door 's first twitch to its standstill";
    None if one of them is none.

    Args:
        x: who does what is told without a name, "" for the one that the other event names.
        named: whether words name a thing of the scene.
    """
    if len(times) != 2 or re.search(r"\d", " ".join(times)):
        return None
    found = (event_of(_CONJUNCTION.sub("", time)) for time in times)
    events = [event for event in found if event is not None and event.chance >= _TOLD]
    if len(events) != 2 or not all(event.kind in _ENDS_OF_FILM or _is_moment(event) for event in events):
        return None
    who = next((event.x for event in events if event.x not in _OF_ONE and named(event.x)), x or "it")
    one, other = (
        _ENDS_OF_FILM.get(event.kind) or f"when {_happens(event, event.x if named(event.x) else who)}"
        for event in events
    )
    return f"how long is it from {one} to {other}" if one != other else None


_ENDS_OF_FILM = {"film_start": "the start of the film", "film_end": "the end of the film"}
_CONJUNCTION = re.compile(r"^(?:from|until|till|til|to|when|once|and) ")
_TOLD = 0.54  # probability of an event from which another one is counted


def times_of(kind: str, said: tuple[str, ...]) -> Iterator[str]:
    """The words for a time, as they are said and by what happens at it; those that both are read agree in it."""
    both = f"from {_AFTER.sub('', said[0])} to {_BEFORE.sub('', said[1])}" if len(said) == 2 else ""
    if kind in _OF_A_WAY and (all(map(_is_all_of_it, said)) or _ALL_OF_IT.match(both)):
        yield ""
        return
    plain = " ".join(filter(None, (_plain_time(kind, one) for one in said)))
    told = plain_time(plain) if plain else None
    if told is not None and told in _EDGES and kind not in _STATES:
        yield ""  # it is asked of the whole film
        return
    yield everyday(_ROUGHLY.sub("", plain))
    if told and not re.search(r"\d", plain):
        yield told


def _is_all_of_it(said: str) -> bool:
    """Whether a time is that of all of a movement."""
    return _ON_ITS_WAY.match(said) is not None or _ALL_OF_IT.match(said) is not None


_OF_A_WAY = bag("fast fast_most far long_moves turns")
_AFTER = re.compile(r"^(?:after|from|since|once|following) ")
_BEFORE = re.compile(r"^(?:before|until|till|til|to|up to) ")
_ON_ITS_WAY = re.compile(  # that says nothing more of a movement
    r"^(?:on|during|along|over|in) (?:its|his|her|the|that|this) (?:whole |entire )?"
    r"(?:way|trip|journey|roll|run|course|path|route)\b(?! (?:to|towards?|back|out|in|home|from)\b)|"
    r"^(?:while|whilst|when|as long as) (?:it|he|she) (?:is|'s) (?:actually )?"
    r"(?:moving|working|rolling|running|spinning|turning|going|in motion|on|under way)$"
)

_WHOLE_FILM = re.compile(  # a time that is all of the film
    r"^(?:(?:during|in|over|throughout|within|for|across|through) (?:the|this|these|all(?: of)? the|its|his|her) "
    r"(?:(?:whole|entire|full|complete) )?(?:(?:five|5) seconds|(?:\w+ )?"
    r"(?:(?:five|5) ?s(?:ec(?:ond)?s?)? )?(?:film|clip|video|scene|time|movie|"
    r"footage|recording|shot|proceedings|events?|incident|episode|"
    r"sequence|interval of motion|motion|movement|run|journey|trip))(?: is to be| long)?|throughout|ever|overall|"
    r"in total|altogether|in all|"
    r"at any (?:point|time|moment)|at all|all told|at some (?:point|time|moment)|from (?:start|beginning|"
    r"first) to (?:finish|end|last)|the (?:whole|entire|full) (?:while|time)|"
    r"(?:during|in|over|from) 0(?: ?s)? (?:to |- ?)?5 ?s(?:ec\w*)?|from curtain up to curtain down|"
    r"(?:in|during) all (?:of )?(?:these|the|those) (?:five|5) seconds|(?:when|once) its (?:all )?(?:over|done)|"
    r"(?:during|in|over|throughout|within|for|across|through) (?:[a-z]+ ){0,4}(?:film|clip|video|movie|footage|"
    r"proceedings|recording|recorded|filmed|take)|"
    r"(?:by|in|at|before) the (?:very )?end(?: of (?:the|my|our|this|its|all|it)(?: \w+)?)?|"
    r"of the (?:five|5) seconds(?: \w+)?|finally|eventually|in the end|at last|"
    r"when (?:it|all|"
    r"everything) is (?:all )?(?:over|done|finished)|"
    r"(?:once|when|after) (?:the|this|our|my) \w+ is (?:over|done|finished)|"
    r"(?:at|by) the (?:final )?curtain|"
    r"when all is (?:said and )?done|before the (?:clip|film|video|scene) (?:ends|is over)|at the finish)$"
)
_STATES = (
    "if_open",
    "if_shut",
    "if_still",
    "where_at",
    "near",
    "if_on",
    "what_moves",
    "what_still",
    "if_moves",
    "how_many",
    "what_open",
    "what_shut",
    "what_on",
    "what_up",
)
_THE_END = re.compile(r"\b(?:end|finish|finally|eventually|last|over|done|ends)\b")
_QUIET = re.compile(
    r"^(?:once|when|after) (?:everything|all|the room|things?) (?:is|are|has|have) (?:\w+ )?(?:still|quiet|over|"
    r"calm|settled|stopped|done|finished)(?: again)?$"
)
_OUT = re.compile(
    r"^(?:on|during) (?:the|its|his|her) (?:(?:way|trip|journey|run|stroke|travel) (?P<way>out|open|back|in|home|"
    r"shut|closed)|(?P<leg>out|in|home|return)(?:bound|ward)? (?:leg|trip|journey|stroke|run|way))$|"
    r"^(?:while |when )?(?:going|coming|sliding|moving|heading) (?P<doing>out|back|in)$"
)
_FURTHEST = re.compile(
    r"^at (?:full \w+|"
    r"(?:its|his|her|the) (?:very )?(?:furthest|farthest|widest|most|maximum|fullest|utmost|greatest|peak)\b.*)$"
)
STROKES = re.compile(  # "between the outward slide and the return"
    r"^between (?:the |its )?(?:[a-z]+ )?(?:out\w*|opening|extension)\b.* and (?:the |its )?(?:[a-z]+ )?"
    r"(?:return\w*|back\w*|in\w*|clos\w*|retract\w*)\b|"
    r"^between (?:coming|going|sliding)(?: out)? and (?:going|coming)\b"
)
_WHILE_ON = re.compile(r"^(?:(?:before|until|till|til) (?:it |he |she |leav|roll)|once (?:it|he|she) (?:is|has|gets) )")
BEFORE_BACK = re.compile(
    r"\b(?:before|until|till|til) (?:it |he |she )?(?:\w+ )?(?:goes|going|comes|coming|sliding|slides|moving|moves|"
    r"heads|heading|return\w*|retract\w*|gets|is|starts|closing|closes|shuts|shutting)\b"
)


_BEFORE_IT_STARTS = re.compile(
    r"^(?:before|until|till) (?:it|he|she) (?:first |finally )?(?:gets (?:going|moving|rolling|started)|"
    r"(?:starts?|begins?)(?: (?:to )?(?:mov|roll|go|walk|fall|turn)\w*)?|sets off|moves(?! back)|rolls off|takes off)$"
)
UP_TO_THE_TURN = re.compile(
    r"^(?:before|until|till|up to|after|from) (?:(?:the |its |his |her )?(?:corner|turn|bend)(?: to the \w+)?|"
    r"(?:it|he|she) turns)$"
)
_MIDWAY = re.compile(r"^(?:half ?way|mid ?way|in the middle)\b")
_ONCE_OUT = re.compile(
    r"^(?:(?:once|after|when|having) )?(?:it |he |she )?(?:has |is |having )?(?:been )?"
    r"(?:come|slid|pulled|gone|opened|fully|drawn)(?: \w+)? ?(?:out|open)?$"
)
_STRAIGHT = re.compile(r"\b(?:crow|straight|beeline)\b")
_EDGES = ("", "at the start", "at the end")
_BEGUN = (  # of a movement
    r"(?:very )?(?:first |initial )?(?:start(?:ing)?(?: off| point| gate)?|beginning|push ?off|crack|shut|closed|"
    r"stirrings?|motion|movement|move|push|"
    r"departure|release|launch|take ?off|kick(?: ?off)?|(?:being|getting) kicked|shove|nudge|"
    r"setting (?:off|out)|set ?off|leaving(?: (?:the |its )?\w+){0,2}|"
    r"parting|go|opening)"
)
_OVER = (
    r"(?:very )?(?:final |last |full |complete |dead |eventual )?(?:(?:wide |fully |full )?open|finish line|"
    r"stop(?:ping)?(?: point)?|halt|rest|end|standstill|"
    r"(?:moment |point |instant |time )?(?:when |where |at which )?(?:it|he|she) (?:stops|halts|rests|stands|settles|"
    r"(?:comes|gets) to (?:a |its )?(?:\w+ )?(?:rest|stop|halt|standstill))|"
    r"finish(?:ing)?|arrival(?: (?:at|by|in) (?:the |its )?(?:\w+ )?\w+)?|last|coming to (?:a |its )?\w+|closing)"
)
_ALL_OF_IT = re.compile(
    r"^(?:across|over|during|in|for|throughout) (?:its|his|her|their|the) (?:whole|entire|full|complete) \w+$|"
    rf"^(?:(?:between|from|of) )?(?:its |his |her |the |a )?{_BEGUN}(?: of (?:its|the) \w+)? "
    rf"(?:and|to|until|till|up to|through to) (?:its |his |her |the |a )?{_OVER}$"
)
_TILL_IT_STOPS = re.compile(
    r"^(?:before|until|till) (?:it|he|she) (?:freez\w+|gave up|gives up|lay still|lies still|stop\w*|"
    r"c[oa]mes? to (?:a |its )?\w+|"
    r"settle\w*|died|dies|quits?|was done|is done)\b"
)
_AT_MOST = re.compile(r"^(?:once|when|after|at|in|by) (?!.*\d)(?!.*\bseconds?\b)")  # as far as it goes then


def _plain_time(kind: str, said: str) -> str:
    """The words for a time in plain words; "" for all of the film, where that says nothing."""
    said = re.sub(r"\bt ?= ?(?=\d[\d.]* ?s\b)| there$", "", re.sub(r"^(?:given|assuming|if) (?=t\b|\d)", "at ", said))
    if (passed := _PASSED.match(said)) is not None and any(passed[part] for part in _HOW_PASSED):
        said = f"{'at' if kind in _STATES or kind in ('does', 'what_fell') else 'by'} {_number(passed)} s"
    said = _ACROSS.sub("moves", _AT_ABOUT.sub("at ", _PLAINER_STILL.sub(_still_plainer, said)))
    if (clock := _CLOCK.match(said)) is not None:
        said = f"at {clock['time']} s"
    if kind in _STATES and (passing := _BY_NOW.match(said)) is not None:
        said = f"at {passing['time']}"
    if kind in ("turns", "far", "often") and _TILL_IT_STOPS.match(said):
        return ""
    if kind in _OF_A_MOVEMENT and (_TILL_ITS_END.match(said) or _FROM_ITS_START.match(said)):
        return ""
    if (kind == "far_turns" and _MIDWAY.match(said)) or (kind == "long_open" and _ONCE_OUT.match(said)):
        return ""
    if _ALL_OF_IT.match(said) or (kind in ("far_opens", "far_turns") and _AT_MOST.match(said)):
        return ""
    if kind == "long_still" and _BEFORE_IT_STARTS.match(said):
        return "before it starts to move"
    if kind in ("long_still", "long_open") and (BEFORE_BACK.match(said) or STROKES.match(said)):
        return ""
    if kind == "long_on" and _WHILE_ON.match(said) is not None:
        return ""
    if kind == "apart" and _STRAIGHT.search(said):
        return ""
    if _FURTHEST.match(said) and kind.startswith("far"):
        return ""
    if (way := _OUT.match(said)) is not None:
        out = (way["way"] or way["leg"] or way["doing"]) in ("out", "open")
        return "while it is opening" if out else "while it is closing"
    if _QUIET.match(said):
        said = "at the end"
    if _WHOLE_FILM.match(said):
        if kind not in _STATES:
            return ""
        if _THE_END.search(said):
            return "at the end"
        return said if kind in ("if_open", "if_shut", "if_on") else ""
    return said


_OF_A_MOVEMENT = (*_OF_A_WAY, "long_opens", "long_closes", "long_reach", "far_turns", "far_opens")
_FROM_ITS_START = re.compile(
    r"^from (?:the |its |his |her )?(?:very )?(?:first|start|beginning|initial)(?: [a-z]+){0,2}$|"
    r"^from (?:the )?(?:start|beginning|onset) of (?:the |its )?(?:motion|movement|roll|walk|turn)$"
)
_TILL_ITS_END = re.compile(  # "from start of motion till it stops"
    r"^from (?:the |its )?(?:start|beginning|onset)(?: of (?:the |its )?[a-z]+)? (?:to|till|until) "
    r"(?:(?:it|he|she) (?:stops|rests|halts)|"
    r"(?:the |its )?(?:final |full |complete )?(?:stop|end|rest|halt|standstill))$|"
    r"^(?:before|until|till) (?:it|he|she|they) (?:grows?|falls?|goes|is|are|comes?) (?:still|quiet|silent|to rest)$"
)
_PLAINER_STILL = re.compile(
    r"^come (?=\d|two\b|three\b|four\b|five\b)|"
    r"^at the end of (?:everything|it all|all this)$|\b(?:when )?t (?:=|equals|is) (?P<t>\d+(?:\.\d+)?)(?! ?s)|"
    r" 's (?P<doing>going|on|running)\b|\bfrom (?P<zero>zero)\b|(?<=[a-z]) 's (?=[a-z]+ing\b|open\b|shut\b|closed\b)"
)


def _still_plainer(found: re.Match[str]) -> str:
    """A time in plainer words."""
    if found["t"]:
        at = "" if found.start() and not found[0].startswith("when") else "at "
        return f"{at}{found['t']} s"
    if found["doing"]:
        return " is moving"
    if found["zero"]:
        return "from 0 s"
    return "by " if found[0].startswith("come") else "at the end" if found[0].startswith("at") else " is "


_AT_ABOUT = re.compile(
    r"^(?:as at|right (?:about|around|at)|(?:exactly |just )?on the (?:count|stroke|mark) of|right|at the mark of|"
    r"at about) (?=\d)|^(?=\d+(?:\.\d+)? ?s(?:ec(?:ond)?s?)?(?: in(?:to (?:it|the \w+))?)?$)"
)
_ACROSS = re.compile(r"\b(?:crosses|(?:rolls|goes|runs|moves|walks) across) the (?:room|floor)\b")
_CLOCK = re.compile(  # "once the clock 's hit 4.8"
    r"^(?:once|when|as|after|by the time) (?:(?:the|my|our) )?"
    r"(?:clock|timer|counter|time ?code|stopwatch|display|watch) "
    r"(?:'s |is |has |shows? |reads? |says? |hits? |reaches |reached |hit |at |on |gets to |past )+"
    rf"(?P<time>{NUMBER})(?: ?s(?:ec(?:ond)?s?)?)?$"
)
_PASSED = re.compile(  # "with two on the clock", "one and a half seconds gone", "as the clock strikes three"
    r"^(?:(?:come|some|around|about|exactly|just|with|at|on|when|once|as) ){0,2}"
    r"(?P<struck>(?:the )?(?:clock (?:strikes|shows|says|hits|reads)|count of|end of the|stroke of|mark of) )?"
    rf"(?:(?P<time>{NUMBER})(?P<half> and (?:a )?half)?(?: decimal (?P<tenths>{NUMBER}))?|"
    r"(?P<rank>first|second|third|fourth|fifth)(?= second))"
    r"(?P<unit> ?s(?:ec(?:ond)?s?)?)?"
    r"(?P<gone>(?: (?:exactly|gone|along|in|elapsed|having passed|having gone|passed|over|up|flat|sharp|mark|"
    r"on the clock|(?:is|are|have|has) (?:gone|up|over|passed|elapsed)|into (?:the|it)(?: \w+)?))*)$"
)


_HOW_PASSED = ("struck", "half", "tenths", "rank", "gone")


def _number(passed: re.Match[str]) -> str:
    """The number of seconds in a match of `_PASSED`."""
    if passed["rank"]:
        return str(ORDINALS[passed["rank"]])
    tenths = seconds(passed["tenths"]) / 10 if passed["tenths"] else 0.5 if passed["half"] else 0.0
    return f"{seconds(passed['time']) + tenths:g}"


_BY_NOW = re.compile(  # "by 3 s", "by the time 3 seconds have passed"
    r"^(?:by|once|when|after|on)(?: the time)? (?P<time>\d+(?:\.\d+)? ?s(?:ec(?:ond)?s?)?)"
    r"(?: (?:have|has|are|is) (?:passed|gone(?: by)?|up|elapsed|over))?$"
)
_ROUGHLY = re.compile(
    r"\b(?:like|around|about|roughly|approximately|exactly|just|maybe|say) (?=\d)|"
    r"(?<=[sd]) (?:sharp|exactly|flat|precisely|on the dot)$"
)
