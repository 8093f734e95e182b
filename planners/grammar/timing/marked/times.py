"""The time that words with a mark of time tell: in numbers, by the film, or by what happens."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from .....gaussians import late_re as re
from .....tools.when import During, Part
from ...tagging.spelling import is_word
from ...tagging.words import bag
from ...vocabulary.nouns import is_known
from ...vocabulary.quantities import ORDINALS
from ..happenings import CONJUNCTION, IT, Happening, clause_of
from ..manner import Thing
from ..moments import DURATION, End, Moment, cut, seconds_of
from ..restated.restating import restated
from .names import named as names_in
from .plain import loosely, plain

TIMES = {"from": "when", "to": "until", "in": "while", "for": "for"}  # tags of times, and how such a time is begun
TRIM = " ,.;:!?'\""  # at the ends of marks
LEADING = re.compile(
    r"^(?:(?:,|and|then|but|just|only|right|exactly|about|around|starting|beginning|starts?|begins?|leaves?|leaving|"
    r"departs?|departing|departure|"
    r"(?:sets?|setting|heads?|heading|kicks?|kicking|takes?|taking|goes|going|pulls?|pulling|moves?|moving) "
    r"(?:off|out|away)|go(?:es|ing)?|finish(?:ed|ing)?|done|ending|end|arriving|arrives?|being|be|there|taking|takes?|"
    r"lasting|lasts?) (?=\w))*"
)
UNTIL = re.compile(r"^(?:arriv|finish|ending|done|there |be there|complet|reach|all |over )")  # what it is until then
LASTS = re.compile(r"^(?:and )?(?:tak(?:es?|ing)|last(?:s|ing)?)\b")  # how long it is said to take
_DELAY = re.compile(
    rf"^(?:with a (?:lag|delay|gap) of |in )?(?P<delay>{DURATION}|\d+(?:\.\d+)?|a (?:moment|bit)) "
    r"(?:(?=(?:after|once|when) )|(?P<word>behind|past|following|upon|into|from(?= when\b)) )"
)
_PLUS = re.compile(  # "fully open + 0.5 s", "after a second's rest at the wall", "after it has lain there for a second"
    rf"^(?P<clause>.+?) (?:\+|plus|and then)(?: an?(?: [a-z]+)? of)? (?P<delay>{DURATION})$"
)
_STOOD = re.compile(
    r"^(?:once|after|when|as soon as)(?: (?P<who>.+?) (?:has|have|is|'s|had))? (?:been |just |only )?"
    r"(?P<how>stood|standing|lain|lying|rested|resting|sat|sitting|stayed|staying|remained|remaining|hung|hanging|"
    rf"waited|waiting|stopped|paused|being)\b ?(?P<state>(?:(?!at\b|by\b|until\b|till\b|from\b)[a-z]+ ?)*?) ?"
    rf"(?:for|of)? ?(?P<delay>{DURATION})(?: there| so)?$"
)
_BARE = re.compile(
    r"^(?:(?:by|at|on|from|in|into|to|till|until|after|before|up|for|over|within|during|the|only|just|about|around|"
    r"exactly|"
    r"somewhere|roughly|approximately|precisely|"
    r"say|like|mark|starting|beginning|finished|done|,) )*(?P<value>.+?)(?: (?:mark|on|onwards?|already|sharp|"
    r"flat|in|"
    r"long|exactly|precisely|or so))*$"
)
_AS = re.compile(
    r"^(?:all the while|the whole time(?: that)?|(?:for|in|during) (?:the|that) (?:time|bit|part|stretch|moments?|"
    r"seconds|period|phase)(?: (?:that|where|when|in which|during which))?) (?=\w)"
)
_FROM_EVENT = re.compile(
    r"^(?:from|starting (?:from|with)|with|at) (?:the|its|his|her) (?P<event>turn|fall|drop)(?: on(?:wards?)?)?$"
)
_GERUND = re.compile(r"^(?P<word>after|once|when|while|before|until) (?P<doing>[a-z]+ing)(?= |$)")
_WHERE = re.compile(r"^(?:right |just |exactly )?(?:at )?(?:the (?:point|place|spot|corner) )?(?:where|upon) (?=\w)")
_BESIDE = re.compile(  # "set off with the robot", "at the same time as the top one"
    r"^(?:at |in )?(?:just |right |exactly )?(?:the )?(?:(?:very )?same (?:time|moment|second|instant)(?: as)?|"
    r"together with|along with|alongside|in (?:sync|step|time|unison|parallel) with|with) "
    r"(?P<who>(?:the|my|our|that) [a-z ]+?)(?: (?:does|moves|starts|sets off|opens|goes))?$"
)
_ALL = re.compile(
    r"\b(?:whole|entire|throughout|all (?:of )?(?:the|this) (?:film|clip|video|scene|movie|sequence|shot)|"
    r"all (?:the way )?through|over the length of|all the time|always|permanent(?:ly)?|"
    r"^all day(?: long)?$|^for good(?: and all)?$|"
    r"^(?:from now on|henceforth|from here on)$|"
    r"(?:beginning|start) to (?:the )?(?:end|finish))\b"
)
_A_PART = re.compile(r"\b(?:first|last|opening|closing|final|initial|middle|second|third)\b.*\b(?:seconds?|secs?)\b")
_NAMED: tuple[tuple[re.Pattern[str], End], ...] = (
    (re.compile(r"\b(?:middle|half ?way|half time|mid ?way|mid ?point|half the)\b"), "middle"),
    (
        re.compile(
            r"^(?:un)?till? the (?:very )?last (?:second|moment)$|\b(?:end|ends|finish|close|last frame|over|"
            r"finale)\b"
        ),
        "end",
    ),
    (
        re.compile(
            r"\b(?:begin(?:n?ing)?|start|outset|first (?:frame|moment|second)|at once|immediately|straight away)\b|"
            r"\bthe top(?: of the (?:film|show|clip|video|scene|shot))?$"
        ),
        0.0,
    ),
)
_AROUND = bag(  # words that may stand beside the name of a moment
    "the a of to in through from at up until till towards toward very right exactly about around just only near "
    "somewhere point way mark is 's it has have been all like straight onwards on onward when as once by with and , "
    "after before we they comes come reach reaches again off out for during over this our that then"
)
_HALF = re.compile(r"\b(first|second|last|latter|other) half\b")
_HALFWAY = re.compile(
    r"^(?:when |once |at |as soon as )?(?:(?P<who>.+?) (?:is|has (?:gone|got)|gets) )?"
    r"(?:half ?way|midway|half the way|in the middle of|(?:in )?mid (?:fall|air|flight|swing|walk|roll|turn))"
    r"(?P<way>(?: (?:down|up|through|there|across|along|over|to|into|out|open|of))* ?(?P<what>.*))$"
)
_ALONE = re.compile(r"^(?:at |from )?(?:half ?way|midway|half time)(?: through| in| point)*$")
_FILM = re.compile(r"\b(?:film|clip|video|movie|scene|shot|time|animation|footage|sequence)\b")
_GIVEN = re.compile(  # "once it is open give it a second"
    r"^(?P<clause>(?:once|when|after|as soon as) .+?) (?:give|allow|leave|wait)(?: it| him| her)? "
    rf"(?P<delay>{DURATION})(?: 's?)?(?: (?:airing|rest|break|pause|peace|hold|breather|grace))?$"
)
_AND_WAITS = re.compile(  # "after it has opened it waits half a second"
    r"^(?P<clause>(?:once|when|after|as soon as) .+?)(?: ,)?(?: and)? (?:it|he|she|they) "
    r"(?:waits?|pauses?|rests?|lingers?|holds?|"
    r"(?:stays?|stands?|remains?|sits?|hangs?)(?: there| so| open| still| out)?)"
    rf"(?: for)? (?P<delay>{DURATION})$"
)
_THEN = re.compile(r"(?: ,)?(?: and)? then$")
_AT_ITS_WIDEST = re.compile(
    r"^(?:at (?:its|the) (?:widest|fullest|full stretch|far end)|at full stretch|"
    r"(?:fully|wide|all the way) (?:open|out|extended))"
    rf" for (?P<delay>{DURATION})$"
)
_HAS_BEEN = re.compile(
    r"^(?P<who>(?:once|after|when|as soon as|only after|from when) .+?) (?:has|have|is|'s|was|had) been "
    rf"(?P<state>[a-z ]+?)(?: for)? (?P<delay>{DURATION})$"
)


_WAITS = re.compile(
    rf"^(?:(?:we|it|he|she|they) )?(?:waits?|pauses?|rests?|lingers?) (?:for )?(?P<delay>{DURATION}|a sec)$"
)


def delayed(phrase: str) -> tuple[str, float | None]:
    """Words with a mark of time without the seconds that pass behind what they tell, and these; None if none do."""
    phrase = _THEN.sub("", phrase)
    if (widest := _AT_ITS_WIDEST.match(phrase)) is not None:
        return "once it is fully open", seconds_of(widest["delay"])
    if (waits := _WAITS.match(phrase)) is not None:
        return "after it has stopped", seconds_of(waits["delay"]) or 1.0
    delay = None
    if (stood := _STOOD.match(phrase)) is not None and (seconds := seconds_of(stood["delay"])) is not None:
        who = stood["who"] or "it"
        opened = re.search(r"\b(?:open|out)\b", stood["state"]) is not None
        return (f"once {who} is fully open" if opened else f"after {who} has stopped"), seconds
    for pattern in (_DELAY, _HAS_BEEN, _GIVEN, _AND_WAITS, _PLUS):
        found = pattern.match(phrase)
        seconds = None if found is None else seconds_of(found["delay"]) or seconds_of(f"{found['delay']} seconds")
        if found is not None and seconds is not None:
            delay = seconds
            if pattern is _DELAY:
                phrase = _SINCE.get(found["word"], "{}").format(phrase[found.end() :])
            else:
                phrase = _so_far(found) if pattern is _HAS_BEEN else found["clause"]
    return phrase, delay


_SINCE = {  # from when the seconds count behind which a word stands
    "behind": "when {} starts", "into": "from the start of {}", "past": "after {}", "following": "after {}",
    "upon": "after {}",
}  # fmt: skip


def _so_far(found: re.Match[str]) -> str:
    """What was so for some time, as what begins it: "once it has been lying there" is once it has stopped."""
    state = found["state"].strip()
    if re.fullmatch(r"(?:lying|resting|sitting|standing|still|there|on|at|down)\b.*", state):
        return f"{found['who']} has stopped"
    return f"{found['who']} is {state}"


def told_by(tag: str, phrase: str, thing: Thing) -> tuple[Moment | None, Happening | None] | None:
    """The time in numbers and what happens, either of which words with a tag may tell; None if they tell neither."""
    phrase = plain(tag, phrase)
    if tag == "in" and phrase.startswith("from ") and (ends := _from_until(phrase, thing)) is not None:
        return ends
    if (found := _moment(tag, phrase)) is not None:
        return found, None
    if (event := _event(tag, phrase, thing)) is not None:
        return None, event
    if (found := _named_moment(tag, phrase, thing)) is not None:
        return found, None
    return _from_until(phrase, thing) if tag in ("in", "from") else None


def _from_until(phrase: str, thing: Thing) -> tuple[Moment | None, Happening | None] | None:
    """As `told_by`, of words with two ends: "from halfway till the end", "from when it turns until it stops"."""
    begun = re.sub(r"^(?:from|between|in between) ", "", phrase)
    for joint in _JOINTS.finditer(begun):
        start = told_by("from", begun[: joint.start()].strip(" ,"), thing)
        stop = told_by("to", begun[joint.end() :].strip(" ,"), thing)
        if start is None or stop is None:
            continue
        (begins, happens), (ends, over) = start, stop
        if begins is None and ends is None and happens is not None and over is not None:
            both = happens.ended(over)
            return None if both is None else (None, both)
        if begins is not None and over is not None:
            return begins, replace(over, from_start=True)
        if happens is None and begins is not None and ends is not None:
            both_ends = joined(begins, ends)
            return None if both_ends is None else (both_ends, None)
    return None


_JOINTS = re.compile(r"(?: ,)? (?:until|till|til|to|and|up to|through|-)(?= )")


def joined(one: Moment, other: Moment) -> Moment | None:
    """Both times as one; None if both tell the same part of it, each another. A number tells more than a name: "at the
    end, from 4 s on"."""
    if all(isinstance(moment.start, float) for moment in (one, other)):
        one, other = sorted((one, other), key=lambda moment: float(moment.start or 0.0) >= 0)
        if one.start is not None and float(one.start) < 0 <= float(other.start or 0.0):
            one = replace(one, start=None)  # "in the last two seconds, from 3 s on"
    for key in ("start", "stop", "lasting"):
        told = [getattr(moment, key) for moment in (one, other)]
        if None in told or told[0] == told[1]:
            continue
        if sum(isinstance(value, str) for value in told) != 1:
            return None
        ends: dict[str, Any] = {key: None}
        one, other = (replace(one, **ends), other) if isinstance(told[0], str) else (one, replace(other, **ends))
    return Moment(
        start=other.start if one.start is None else one.start,
        stop=other.stop if one.stop is None else one.stop,
        lasting=other.lasting if one.lasting is None else one.lasting,
        taken=one.taken or other.taken, always=one.always or other.always, said=(*one.said, *other.said),
    )  # fmt: skip


def _moment(tag: str, phrase: str) -> Moment | None:
    """The time in numbers that words with a tag tell, None if they tell none."""
    if _half_its_way(phrase) is not None:
        return None
    if tag == "to" and re.match(r"by (?:the )?(?:very )?end\b", phrase):
        return Moment(stop="end", said=(phrase,))
    phrase = _PASSED.sub("", _WHOLE_SECONDS.sub("", phrase))
    rest, moment = cut(phrase)
    if moment != Moment() and not any(is_word(word) or is_known(word) for word in rest.strip(" ,.").split()):
        if tag == "to" and isinstance(moment.start, float) and moment.stop is None and moment.lasting is None:
            moment = replace(moment, start=None, stop=moment.start)  # "only gets there at five seconds"
        return moment
    if (half := _HALF.search(phrase)) is not None:
        first = half[1] == "first"
        return Moment(start=None if first else "middle", stop="middle" if first else "end", said=(phrase,))
    if _ALL.search(phrase) and not _A_PART.search(phrase):
        return Moment(always=True, said=(phrase,))
    bare = _BARE.match(phrase)
    value = None if bare is None else _seconds(bare["value"])
    return None if value is None else _at(tag, phrase, value)


def _named_moment(tag: str, phrase: str, thing: Thing) -> Moment | None:
    """The start, the middle or the end of the film where words with a tag name it, None if they name none."""
    if any(is_known(name.split(" ")[-1]) for name in names_in(phrase, thing)):
        return None  # "until the fall of the book is over"
    leads = phrase.split(" ")[0] not in _EVEN_SO and _FILM.search(phrase) is None
    if tag == "for" or (leads and CONJUNCTION.match(phrase)):
        return None
    if tag == "to" and _WITH_THE_FILM.search(phrase):
        return _at(tag, phrase, "end")
    begins = re.sub(r" (?:to|until|till) the (?:very )?end$", "", phrase) if tag != "to" else phrase
    value = None
    for pattern, end in _NAMED:
        if pattern.search(begins):
            beside = _FILM.sub(" ", pattern.sub(" ", begins)).split()
            value = end if set(beside) <= _AROUND else None  # not "clear the middle"
            break
    return None if value is None else _at(tag, phrase, value)


def _at(tag: str, phrase: str, value: End) -> Moment | None:
    """A time as its tag has it: from then, until then, or for so long."""
    if tag == "for":
        return Moment(lasting=value, taken=True, said=(phrase,)) if isinstance(value, float) else None
    if tag == "from":
        return Moment(start=value, said=(phrase,))
    if tag == "to":
        return Moment(stop=None if value == "end" else value, always=value == "end", said=(phrase,))
    return None


_PASSED = re.compile(
    r" (?:on the dot|(?<=seconds )reach(?:ed)?|(?:has|have) (?:passed|elapsed|gone(?: by)?)|(?:is|are) (?:over|up))$"
)
_WHOLE_SECONDS = re.compile(r"\b(?:whole|full|entire|good|solid|complete) (?=(?:seconds?|secs?)\b)")
_UNTIL_THEN: dict[Part, Part] = {"from": "until", "while": "until", "after": "until_end"}
_WITH_THE_FILM = re.compile(r"\b(?:with|as) the (?:film|clip|video|movie|scene|shot)$")
_EVEN_SO = ("until", "till", "after", "by", "before")


def _seconds(said: str) -> float | None:
    """Seconds that a number names, with or without its unit."""
    said = re.sub(r"^another (?=second)", "one ", said)
    said = re.sub(r"^(?:second|sec|t|time)\b ?=? ?(?=\w)", "", re.sub(r"\b(?:more|another|extra|further) ", "", said))
    found = seconds_of(said)
    if found is None:
        found = seconds_of(f"{said} seconds")
    if found is None and (rank := re.fullmatch(r"(\w+) second", said)) is not None and rank[1] in ORDINALS:
        found = float(ORDINALS[rank[1]])
    return found


def _half_its_way(phrase: str) -> re.Match[str] | None:
    """The words for half the way of something; None for others, and for half the film."""
    return None if _FILM.search(phrase) or _ALONE.match(phrase) else _HALFWAY.match(phrase)


def _event(tag: str, phrase: str, thing: Thing) -> Happening | None:
    """The time told by what happens of words with a tag, None if they tell none."""
    if (half := _half_its_way(phrase)) is not None:
        of = names_in(half["who"] or half["what"], thing)[:1]
        whose = thing(of[0]) if of and (half["who"] or half["way"].startswith((" through", " of"))) else None
        return Happening(During(state="halfway", of=whose or IT, part="until" if tag == "to" else "from"), phrase)
    phrase = re.sub(r" onwards?$", "", phrase)
    phrase = re.sub(r"^(while|as) its (?=[a-z]+ing\b)", r"\1 it is ", phrase)
    if (noun := _FROM_EVENT.match(phrase)) is not None and tag == "from":
        phrase = f"from when it {noun['event']}s"
    phrase = _GERUND.sub(r"\g<word> it is \g<doing>", _WHERE.sub("when ", _AS.sub("while ", phrase)))
    if (beside := _BESIDE.match(phrase)) is not None and (query := thing(beside["who"])) is not None:
        return Happening(During(state="moving", of=query, part="until" if tag == "to" else "from"), phrase)
    for said in dict.fromkeys((phrase, f"{TIMES[tag]} {phrase}", restated(phrase), restated(f"{TIMES[tag]} {phrase}"))):
        for found in CONJUNCTION.finditer(said):
            if found.start() == 0 and (during := clause_of(found["word"], said[found.end() :].strip(" ,."), thing)):
                if tag == "to" and during.part in _UNTIL_THEN:  # "... and normal again [to when it slides back]"
                    during = during.model_copy(update={"part": _UNTIL_THEN[during.part]})
                return Happening(during, said)
    moved = loosely(phrase, thing)
    return None if moved in (None, phrase) else _event(tag, moved, thing)
