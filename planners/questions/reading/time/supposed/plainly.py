"""Plain questions of a kind: the things, the time and the unit of a question that no frame reads, put into one.

    "hey um, trolley get rolling at what second?"  ──►  "when does the trolley start to move"

A question is put plainly only if none of its words tells more: a negation, a number, a comparison, a rank, a thing.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

from ......gaussians import late_re as re
from ......gaussians.world import kinds as kinds_of_things
from ......gaussians.world.spelling import best_slip
from ......gaussians.world.words import singular
from .....grammar.learned.marks import Span
from .....grammar.tagging.spelling import is_word
from .....grammar.tagging.words import bag, clean, split
from .....grammar.timing.spoken import in_figures
from .....grammar.vocabulary.quantities import NUMBERS
from ...noun_phrase import is_color_word
from ..everyday import everyday
from ..frames import UNIT
from ..loosely import HARD
from .kinds import kinds_of, marked_ways, vocabulary
from .times import plain_time, time_left, with_article

LEAST = 0.5  # probability of a kind that is tried
SURE = 0.8  # probability from which words without a mark are taken for those of the question
_LONGEST = 70  # words
_SHORTEST = 2
_DETERMINED = re.compile(r"^(?:the|a|an|this|that|these|those|my|our|your|his|her|its|their|all|both|any|every)\b")
_PLURAL = re.compile(r"^(?:all |both )?(?:of )?(?:the |these |those |my |our )?")
_IN_UNIT = re.compile(rf"\b(?:{UNIT}|rpm|revs? (?:a|per) minute)\b")
_HARD = (HARD - {"one"}) | bag("after before further until while backwards backward reverse")


@dataclass(frozen=True)
class Said:
    """What a question says.

    Attributes:
        x, y: what it is about, and the other thing; "" if none is named.
        places: each other thing, where there are several.
        time: the words of its time, "" if there are none.
        unit: that of its answer, "" if none is said.
        times: the words of each of its times.
        off: words that ask for nothing.
        rest: all other words.
        names: words of the names of the things of the scene.
        first: its first word that asks for something.
        barred: `rest` with a bar for each mark.
    """

    x: str
    y: str
    time: str
    unit: str
    rest: str
    times: tuple[str, ...] = ()
    off: str = ""
    places: tuple[str, ...] = ()
    names: Collection[str] = ()
    first: str = ""
    barred: str = ""


@lru_cache(maxsize=1024)
def supposed(text: str, names: frozenset[str], least: float = LEAST) -> tuple[str, ...]:
    """Plain questions that a text most likely means, with its time; none if that is not likely enough.

    Args:
        names: words of the names of the things of the scene.
        least: the probability of its kind that is likely enough.
    """
    if not text.strip() or len(text.split()) > _LONGEST:
        return ()
    told = tuple(word.text for word in split(in_figures(clean(text))))
    told = tuple(_spelled(word, names) for word in told)
    if sum(word.isalpha() for word in told) < _SHORTEST:
        return ()
    told, leg = _without_leg(told)
    times = ([" ".join(told[a:b]) for tag, a, b in spans if tag == "t"] for spans in marked_ways(told))
    if (left := next(filter(None, (time_left(told, own) for own in times)), None)) is not None:
        return (left,)
    kind, chance = _likeliest(told)
    if chance < least or kind not in _PLAIN or _asks_why(kind, " ".join(told)):
        return ()
    for spans in marked_ways(told):
        if found := tuple(dict.fromkeys(_plainly(told, spans, leg, kind, chance, names))):
            return found
    return ()


def _plainly(
    told: tuple[str, ...], spans: Collection[Span], leg: str, kind: str, chance: float, names: frozenset[str]
) -> Iterator[str]:
    """The words of a question of a kind, with these marks, as plain questions; none if they say more."""
    said = _said(told, spans, names)
    if said is None or _says_more(kind, chance, said, names):
        return
    if not said.x and kind not in _OF_ALL:
        if any(
            kinds_of_things.find(singular(word)) is not None and singular(word) not in names and word not in names
            for word in told
        ):
            return  # "any window I could open"
        said = replace(said, x="it")
    if leg:
        if (said.time and not _UP_TO_THE_TURN.match(said.time)) or kind not in _OF_A_LEG:
            return
        said = replace(said, time=leg, times=(leg,))
    times = tuple(dict.fromkeys(_times(kind, said.times))) if said.time and kind != "gap" else ("",)
    if kind == "how_many" and "at the end" in times and _deed(said.rest, "") in ("fall", "land"):
        times = ("",)  # how many have fallen by then
    for time in times:
        for plain in _PLAIN[kind](said):
            whole = plain.format(when=time) if "{when}" in plain else f"{plain} {time}"
            yield " ".join(whole.split()).replace(" ,", ",")


def _times(kind: str, said: tuple[str, ...]) -> Iterator[str]:
    """The words for a time, as they are said and by what happens at it; those that both are read agree in it."""
    if kind in _OF_A_WAY and all(_ON_ITS_WAY.match(one) for one in said):
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


_OF_A_WAY = bag("fast fast_most far long_moves turns")
_ON_ITS_WAY = re.compile(  # that says nothing more of a movement
    r"^(?:on|during|along|over|in) (?:its|his|her|the) (?:whole |entire )?"
    r"(?:way|trip|journey|roll|run|course|path|route)\b|"
    r"^(?:while|whilst|when|as long as) (?:it|he|she) (?:is|'s) (?:actually )?"
    r"(?:moving|working|rolling|running|spinning|turning|going|in motion|on|under way)$"
)


def question_of(kind: str, x: str, y: str, rest: str = "") -> str | None:
    """The plain question of a kind about things; None if it needs another one.

    Args:
        rest: words beside them by which it is put otherwise: "half".
    """
    return next(_PLAIN[kind](Said(with_article(x), y and with_article(y), "", "", rest)), None)


_OF_ALL = bag(
    "what_moves what_still how_many first last order fastest happens film_long gap if_moves if_still if_together "
    "what_open what_shut what_on what_fell what_up"
)
_WHOLE_FILM = re.compile(  # a time that is all of the film
    r"^(?:(?:during|in|over|throughout|within|for|across|through) (?:the|this|these|all(?: of)? the|its|his|her) "
    r"(?:(?:whole|entire|full|complete) )?(?:(?:five|5) seconds|(?:\w+ )?"
    r"(?:(?:five|5) ?s(?:ec(?:ond)?s?)? )?(?:film|clip|video|scene|time|movie|"
    r"footage|recording|shot|proceedings|events|"
    r"sequence|interval of motion|motion|movement|run|journey|trip))(?: is to be| long)?|throughout|ever|overall|"
    r"in total|altogether|in all|"
    r"at any (?:point|time|moment)|at all|all told|at some (?:point|time|moment)|from (?:start|beginning|"
    r"first) to (?:finish|end|last)|the (?:whole|entire|full) (?:while|time)|"
    r"(?:during|in|over|from) 0(?: ?s)? (?:to |- ?)?5 ?s(?:ec\w*)?|(?:when|once) its (?:all )?(?:over|done)|"
    r"(?:during|in|over|throughout|within|for|across|through) (?:[a-z]+ ){0,4}(?:film|clip|video|movie|footage|"
    r"proceedings|recording|recorded|filmed|take)|"
    r"(?:by|in|at|before) the (?:very )?end|finally|eventually|in the end|at last|when (?:it|all|"
    r"everything) is (?:all )?(?:over|done)|(?:once|when|after) (?:the|this) \w+ is (?:over|done|finished)|"
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
    r"^(?:on|during) (?:the|its|his|her) (?:way|trip|journey|run|stroke|travel) (?P<way>out|open|back|in|home|"
    r"shut|closed)$|^while (?:going|coming|sliding|moving) (?P<doing>out|back|in)$"
)
_FURTHEST = re.compile(
    r"^at (?:full \w+|"
    r"(?:its|his|her|the) (?:very )?(?:furthest|farthest|widest|most|maximum|fullest|utmost|greatest|peak)\b.*)$"
)
_BEFORE_BACK = re.compile(
    r"^(?:before|until|till) (?:it |he |she )?(?:\w+ )?(?:goes|going|comes|coming|sliding|slides|moving|moves|"
    r"heads|heading|gets|is|starts|closing|closes|shuts|shutting)\b"
)


_UP_TO_THE_TURN = re.compile(
    r"^(?:before|until|till|up to|after|from) (?:the |its |his |her )?(?:corner|turn|bend)(?: to the \w+)?$"
)
_MIDWAY = re.compile(r"^(?:half ?way|mid ?way|in the middle)\b")
_ONCE_OUT = re.compile(
    r"^(?:(?:once|after|when|having) )?(?:it |he |she )?(?:has |is |having )?(?:been )?"
    r"(?:come|slid|pulled|gone|opened|fully|drawn)(?: \w+)? ?(?:out|open)?$"
)
_STRAIGHT = re.compile(r"\b(?:crow|straight|beeline)\b")
_EDGES = ("", "at the start", "at the end")
_ALL_OF_IT = re.compile(  # of a movement
    r"^(?:across|over|during|in|for|throughout) (?:its|his|her|their|the) (?:whole|entire|full|complete) \w+$|"
    r"^(?:between|from) (?:start(?:ing)?|beginning|first \w+|release) (?:and|to|until) (?:stop(?:ping)?|rest|"
    r"finish(?:ing)?|end|"
    r"(?:full |final |a )?(?:stop|rest|halt|standstill))$|"
    r"^(?:from|between) (?:its|his|her|the) (?:very )?(?:first |initial )?"
    r"(?:start|motion|movement|beginning|departure|release|move|push) (?:to|and|until|till) (?:its|his|her|the) "
    r"(?:very )?(?:final |last |full |complete )?(?:stop|halt|rest|end|standstill|arrival)$"
)
_TILL_IT_STOPS = re.compile(
    r"^(?:before|until|till) (?:it|he|she) (?:freez\w+|gave up|gives up|lay still|lies still|stop\w*|"
    r"c[oa]mes? to (?:a |its )?\w+|"
    r"settle\w*|died|dies|quits?|was done|is done)\b"
)
_AT_MOST = re.compile(r"^(?:once|when|after|at|in|by) (?!.*\d)(?!.*\bseconds?\b)")  # as far as it goes then


def _plain_time(kind: str, said: str) -> str:
    """The words for a time in plain words; "" for all of the film, where that says nothing."""
    said = re.sub(r"\bt ?= ?(?=\d[\d.]* ?s\b)| there$", "", re.sub(r"^(?:given|assuming) (?=t\b|\d)", "at ", said))
    if kind in ("turns", "far", "often") and _TILL_IT_STOPS.match(said):
        return ""
    if (kind == "far_turns" and _MIDWAY.match(said)) or (kind == "long_open" and _ONCE_OUT.match(said)):
        return ""
    if _ALL_OF_IT.match(said) or (kind in ("far_opens", "far_turns") and _AT_MOST.match(said)):
        return ""
    if kind in ("long_still", "long_open") and _BEFORE_BACK.match(said):
        return ""
    if kind == "long_on" and said.startswith(("before it ", "until it ", "before leav", "until leav", "before roll")):
        return ""
    if kind == "apart" and _STRAIGHT.search(said):
        return ""
    if (_FURTHEST.match(said) and kind.startswith("far")) or (kind == "long_open" and _BEFORE_BACK.match(said)):
        return ""
    if (way := _OUT.match(said)) is not None:
        return "while it is opening" if (way["way"] or way["doing"]) in ("out", "open") else "while it is closing"
    if _QUIET.match(said):
        said = "at the end"
    if _WHOLE_FILM.match(said):
        if kind not in _STATES:
            return ""
        if _THE_END.search(said):
            return "at the end"
        return said if kind in ("if_open", "if_shut", "if_on") else ""
    return said


_ROUGHLY = re.compile(
    r"\b(?:like|around|about|roughly|approximately|exactly|just|maybe|say) (?=\d)|"
    r"(?<=[sd]) (?:sharp|exactly|flat|precisely|on the dot)$"
)


def _spelled(word: str, names: frozenset[str]) -> str:
    """A word, or the word that it is with a slip."""
    if len(word) < 5 or not word.isalpha() or word in names or singular(word) in names or is_word(word):
        return word
    return word if word in vocabulary() else best_slip(word, vocabulary()) or word


def _likeliest(words: tuple[str, ...]) -> tuple[str, float]:
    """The likeliest kind with its probability; an average and a greatest speed are told apart by their words."""
    found, said = dict(kinds_of(words)), " ".join(words)
    if not _FILM.search(said):
        found.pop("film_long")
    if _IS_SHUT.search(said):
        found = {"if_shut" if kind == "if_closes" else kind: found[kind] for kind in found if kind != "if_shut"}
    if _YES_OR_NO.search(said):
        found = {kind: chance for kind, chance in found.items() if kind.startswith("if_")}
    if _SUMMED.search(said):
        found["far"] = found.get("far", 0.0) + found.pop("far_opens", 0.0)
    kind = max(found, key=found.__getitem__)
    if "how many times" in said:
        found["often"] = found.get("often", 0.0) + found.pop("how_many", 0.0)
    if _RANKS_ALL.match(said):
        found["order"] = sum(found.pop(own, 0.0) for own in ("order", "first", "last"))
    if _CUTS_OUT.search(said):
        found["when_stops"] = found.get("when_stops", 0.0) + found.pop("when_starts", 0.0)
    kind = max(found, key=found.__getitem__)
    if _TIMECODE.search(said):
        for place, time in (("where_ends", "when_stops"), ("where_starts", "when_starts")):
            found[time] = found.get(time, 0.0) + found.pop(place, 0.0)
        kind = max(found, key=found.__getitem__)
    if re.search(r"\bcross\w*", said):
        found["long_on"] = found.get("long_on", 0.0) + found.pop("long_reach", 0.0)
        kind = max(found, key=found.__getitem__)
    if kind == "where_ends" and _WHERE_IS.match(said):
        return "where_at", found[kind] + found["where_at"]
    if kind in ("fast", "fast_most"):
        return ("fast_most" if _GREATEST.search(said) else "fast"), found["fast"] + found["fast_most"]
    return kind, found[kind]


_RANKS_ALL = re.compile(r"^(?:please )?(?:rank|sort|order|arrange|line up)\b")
_CUTS_OUT = re.compile(r"\b(?:cuts?|conks?|gives?|gave|switch(?:es)?|shuts?|powers?) (?:out|off|down)\b")
_TIMECODE = re.compile(r"\b(?:time ?code|time ?stamp|(?:at )?(?:what|which) (?:time|second|moment|instant))\b")
_LEG = re.compile(
    r"(?:(?:during|for|on|in|over|of|along|while on) )?(?:^|(?:the|that|this|its|his|her|'s) )"
    r"(?P<rank>first|opening|initial|second|last|final) (?:straight |walking )?"
    r"(?:leg|stretch|part|bit|section|stage|walk|straight)"
    r"(?: of (?:the|its|his|her) (?:walk|way|trip|path|journey|route))?"
)
_LEGS = {"second": "after it has turned", "last": "after it has turned", "final": "after it has turned"}
_OF_A_LEG = bag("fast fast_most far long_moves way")


def goes_first(text: str) -> bool:
    """Whether a question is about one stretch of a way, or about the moment of a first movement, of which other readers
    tell the whole."""
    said = " ".join(word.text for word in split(clean(text)))
    return _LEG.search(said) is not None or _FIRST_MOVE.match(said) is not None


_FIRST_MOVE = re.compile(r"^(?:the )?(?:time ?stamp|time|frame|moment|instant) of (?:the )?(?:first|initial) ")


def _without_leg(words: tuple[str, ...]) -> tuple[tuple[str, ...], str]:
    """The words without those for one stretch of a way, and the time of that; "" if there are none."""
    said = " ".join(words)
    if (leg := _LEG.search(said)) is None:
        return words, ""
    rest = " ".join(f"{said[: leg.start()]} {said[leg.end() :]}".split())
    return tuple(rest.split(" ")), _LEGS.get(leg["rank"], "before it turns")


_FILM = re.compile(
    r"\b(?:film|clip|video|scene|movie|footage|recording|shot|sequence|animation|thing|it all|"
    r"whole)\b"
)


_WHERE_IS = re.compile(r"^where (?:is|are|was|were) ")
_IS_SHUT = re.compile(r"\bis (?:the|that|my|our|every)\w*\b.*\b(?:shut|closed)\b")


def _asks_why(kind: str, said: str) -> bool:
    """Whether words ask for a cause, or for what somebody does or feels, or only for one stretch of a way."""
    if _CAUSES.search(said) or _A_STRETCH.search(said) or _FEELS.search(said):
        return True
    return kind not in _OF_SOMEBODY and _REASONS.search(said) is not None


_CAUSES = re.compile(
    r"\bwhat (?:is it that )?(?:made|makes|shook|shakes|pushed|pushes|drives|caused|causes)\b|\bwhy\b|"
    r"\bthat (?:drove|made|pushed|caused)\b|\bwhat (?:induce[sd]|prompt(?:s|ed)|trigger(?:s|ed)|led|got|sets|set) "
    r"(?:the|it|him|her)\b|"
    r"\b(?:motives?|intentions?|intended|meant to|on whose)\b|"
    r"(?<!\bby )\bcolou?rs?\b"
)
_FEELS = re.compile(
    r"\bfeel(?:s|ing)?\b|\b(?:is|was|were|are|be|been|felt|get|gets|got) (?:the |it |he |she |they )?(?:[a-z]+ ){0,3}?"
    r"(?:frightened|afraid|scared|happy|unhappy|sad|angry|tired|exhausted|bored|hurt|lonely|nervous|shy|proud|ashamed|"
    r"jealous|hungry|thirsty|cold|sleepy|dizzy|worried|excited|upset|in pain)\b"
)
_A_STRETCH = re.compile(r"\b(?:first|second|last|final) (?:leg|stretch|part|half|bit|section|stage)\b")
_YES_OR_NO = re.compile(
    r"\b(?:yes or no|true or (?:false|not|nah)|right or wrong|is (?:that|this) (?:so|right|true|correct)|confirm|"
    r"am i right|that right|is it true)\b|, (?:right|correct|yes|true) \?$"
)
_REASONS = re.compile(
    r"\b(?:reason|explain|because of|caus(?:e|es|ed|ing)|blame|on purpose|who(?:m|se)?|somebody|someone)\b"
)
_OF_SOMEBODY = bag("first last order fastest what_moves what_still happens does how_many")
_GREATEST = re.compile(
    r"\b(?:top(?= (?:speed|pace|rate|velocity)\b)|max|maximum|maximal|peak|highest|greatest|fastest|most|record)\b"
)


def _said(words: tuple[str, ...], spans: Collection[tuple[str, int, int]], names: Collection[str]) -> Said | None:
    """The words of a question by their marks; None if two things stand where one can, or a time would be lost."""
    found: dict[str, list[str]] = {tag: [] for tag in ("x", "y", "t", "u", "off")}
    inside = set[int]()
    before = ("", *words)  # the word before each
    spans = [(tag, a - (tag == "t" and before[a] in _CONJUNCTIONS), b) for tag, a, b in spans]
    for tag, start, stop in spans:
        found[tag].append(" ".join(words[start:stop]).strip(" ,.?"))
        inside |= set(range(start, stop))
    rest = " ".join(word for at, word in enumerate(words) if at not in inside)
    starts = {start for _, start, _ in spans}
    barred = " ".join(
        "|" if at in starts else word for at, word in enumerate(words) if at not in inside or at in starts
    )
    idle = {at for tag, start, stop in spans if tag == "off" for at in range(start, stop)}
    first = next((word for at, word in enumerate(words) if at not in idle and word.isalpha()), "")
    events = [name for name in found["x"] if _AN_EVENT.match(name)]
    found["x"] = [name for name in found["x"] if name not in events and not _ONES.match(name)]
    if not found["x"] and (own := _THAT_ONE.search(" ".join(found["off"]))) is not None:
        found["x"] = [own[0]]  # "oh, the green one! when does it let go?"
    rest = _TAG.sub(" ", " ".join((rest, *events)))
    if not found["x"]:  # "one of the toys was in a sulk, which was it?"
        plain = (word for aside in found["off"] for word in aside.split())
        found["x"] = [f"the {word}" for word in plain if word.endswith("s") and singular(word) in names][:1]
    noun = next((singular(w) for w in words if w.endswith("s") and singular(w) in names), "")
    things = {
        tag: tuple(dict.fromkeys(_named(_ONE.sub(noun or "one", name), names) for name in found[tag]))
        for tag in ("x", "y")
    }
    if not found["t"] and len(found["off"]) == 1 and (blinked := _BLINKED.search(found["off"][0])) is not None:
        found["t"], found["off"] = [blinked["time"]], []  # "I blinked at 1.4 s, which book was falling?"
    asides = (words[start:stop] for tag, start, stop in spans if tag == "off" and not _is_apart(words, start, stop))
    if len(found["t"]) > 2 or any(_TIMED.search(_ASKS_WHEN.sub("", " ".join(aside))) for aside in asides):
        return None
    unit = _IN_UNIT.search(re.sub(r"metre", "meter", " ".join(found["u"])))
    return Said(
        x=_joined(things["x"]), y=_joined(things["y"][:1]), time=" ".join(found["t"]), unit=unit[0] if unit else "",
        rest=f" {rest} ", times=tuple(found["t"]), off=" ".join(found["off"]), places=things["y"],
        names=names, first=first, barred=f" {_TAG.sub(' ', barred)} ",
    )  # fmt: skip


_ASKS_WHEN = re.compile(r"^when ,")  # "when, to the best of your knowledge, ..."
_TAG = re.compile(  # "it opens, doesn't it?", "yes or no"
    r" ,? ?(?:or )?(?:is|are|was|does|do|did|has|have|will|would|could|can) "
    r"(?:not (?:it|he|she|they)|(?:it|he|she|they)"
    r"(?: not)?)(?: \?)?$|,? ?\b(?:yes ?(?:or|/) ?no|y ?/ ?n|true or (?:false|not)|right or wrong)\b|"
    r", true \?$|,? or \?$"
)


def _is_apart(words: tuple[str, ...], start: int, stop: int) -> bool:
    """Whether words are a sentence of their own in front of the question, or behind it."""
    ends = set(words[stop - 1 : stop + 1]) if start == 0 else set()
    begins = set(words[start - 1 : start + 1]) if start and stop >= len(words) - 1 else set()
    return not ends.isdisjoint(_STOPS) or not begins.isdisjoint(_STOPS)


_STOPS = (".", "!", "?", ":", ";")
_AN_EVENT = re.compile(
    r"^(?:the |its |his |her |this |that )?(?:turn|turning|roll|rolling|fall|falling|opening|closing|walk|spin|"
    r"movement|motion|rotation|drop)"
    r"(?: manoeuvre| maneuver| movement| motion| phase| part)?$"
)
_TIMED = re.compile(
    r"\b(?:when|while|until|till|once|after|before|during)\b(?!.*\b(?:i|we|you|me|us)\b)|\d|\bseconds?\b"
)
_ONES = re.compile(r"^(?:the |that |this |which )?ones?$")
_BLINKED = re.compile(r"^(?:i|we) [a-z ]+? (?P<time>at \d+(?:\.\d+)?(?: ?s(?:ec(?:ond)?s?)?)?)$")
_ONE = re.compile(r"\bone$")
_THAT_ONE = re.compile(r"\bthe (?:red|green|blue|yellow|white|black|brown|grey|gray|orange|purple|pink) one\b")
_CONJUNCTIONS = ("til", "till", "until", "before", "once")


def _named(said: str, names: Collection[str]) -> str:
    """A name with an article, without adjectives of which no thing of the scene has one in its name."""
    said = re.sub(r"^(?:the )?final (?=\w)", "the last ", said)
    if (whole := re.match(r"^(?:everything|anything|something)(?= [a-z]+ly$)", said)) is not None:
        return whole[0]  # "everything tidily"
    words = said.split()
    if words and singular(words[-1]) in names:
        said = " ".join(w for w in words if w in names or singular(w) in names or w in _TELLING or is_color_word(w))
    said = re.sub(
        r" 's$", "", re.sub(r"^(?:this|that|these|those|a|an|my|our|your|his|her|their|its) (?=\w)", "the ", said)
    )
    return said if _DETERMINED.match(said) or said in _PRONOUNS else f"the {said}"


_TELLING = bag(
    "on in at under beside behind below above from near by to next of "
    "the a an this that these those all both every each any two three top bottom middle upper lower first "
    "second third last left right other moving and of"
)
_PRONOUNS = ("it", "he", "she", "they", "anything", "something", "everything", "things", "what", "which")


def _joined(names: tuple[str, ...]) -> str:
    """Several names as one; without pronouns where a name stands beside."""
    nouns = tuple(name for name in names if name not in _PRONOUNS) or names
    return " and ".join(nouns)


def _says_more(kind: str, chance: float, said: Said, names: Collection[str]) -> bool:
    """Whether words without a mark say more than the kind of question does."""
    rest, allowed = _IN_A_ROOM.sub(" ", _WHAT_SECOND.sub("when", said.rest)).split(), _ALLOWED.get(kind, frozenset())
    if kind in ("what_moves", "what_still"):
        whose = said.x in _ANYTHING or _is_kind(said.x) or " and " in said.x or _APART.search(said.rest) is not None
        if not whose or said.y:
            return True  # "who moves the ball", "what never moves near the desk"
    if len(said.places) > 1 and kind != "visits":
        return True
    asks = not _ASKS.isdisjoint(rest) or (kind == "turn_way" and "or" in rest) or _ASKS_WHEN.match(said.off)
    if not kind.startswith("if_") and not said.unit and said.first in _AUXILIARIES and not asks:
        return True  # "is the ball at its top speed then?" wants no number
    if _NTH.search(said.time):
        return True
    deeds = _TWO_DEEDS.search(said.barred)
    if deeds is not None and deeds["deed"] not in _OWN_DEEDS.get(kind, ()):
        return True
    told = [word for word in rest if word not in allowed]
    if kind in _NEGATED or (chance < SURE and rest and rest[0] in _AUXILIARIES):  # "did it not move?"
        told = [word for word in told if word not in _DENIED]
    if not _DENIED.isdisjoint(told[1:]) or (kind not in _RANKED and (not _RANKS.isdisjoint(told) or "than" in told)):
        return True
    if kind in ("when_starts", "when_stops"):
        told = [word for word in told if word not in ("zero", "0")]  # of a speed
    if any((w in NUMBERS and w != "one" and kind not in _COUNTED) or w[0].isdigit() or is_color_word(w) for w in told):
        return True
    if chance < SURE:
        if (kind.startswith("if_") and _ASKS.intersection(rest)) or ("and" in rest and kind != "gap") or "or" in rest:
            return True  # "which way does it turn" wants no yes or no; two deeds, or things to choose from
        if any(word in _HARD for word in told):
            return True
    if chance >= CERTAIN and kind in _PLACED:
        told = _BY_A_PLACE.sub(" ", f" {' '.join(rest)} ").split()
    return any(singular(w) in names for w in told if w not in _VERBS and not (kind in _TO_THE_FLOOR and w in _LEVELS))


CERTAIN = 0.95  # probability of a kind from which the place of what happens needs no mark
_PLACED = bag(
    "when_closes when_shut when_falls when_opens when_turns when_stops first last order if_returns if_stops if_closes "
    "if_turns where_ends far_opens how_many turn_way what_fell what_up does long_closes long_opens"
)
_BY_A_PLACE = re.compile(  # "comes to rest at which wall", "quits the shelf board"
    r" (?:(?:in|into|to|from|at|off|on|onto|of|out of|back to|face|quits?|leaves?|against|towards?) )"
    r"(?:the |its |his |her |which |what |that )?(?:[a-z]+ )?[a-z]+(?= )"
)
_WHAT_SECOND = re.compile(
    r"\b(?:at|in|on|by|after)? ?(?:what|which) second\b|"
    r"\bthe (?:exact |precise |very )?second (?:(?:at|in|on) which|where|when|that)\b"
)
_IN_A_ROOM = re.compile(r"\b(?:in|of|inside) (?:the|this|that|our) (?:[a-z]+ )?room\b")
_APART = re.compile(r"\b(?:besides|apart from|except|excepting|other than|aside from|but)\b")
_RANKED = bag("order visits long_moves long_opens long_closes far apart long_falls")
_COUNTED = bag("order does visits how_many what_still what_shut what_up what_open what_on what_fell what_moves")
_OWN_DEEDS: Mapping[str, tuple[str, ...]] = {
    "when_shut": ("clos", "shut"), "if_shut": ("clos", "shut"), "what_shut": ("clos", "shut"),
    "when_stops": ("stop",), "when_lands": ("land",), "when_falls": ("fall",), "when_starts": ("start", "go", "mov"),
    "when_opens": ("open",), "when_open": ("open",), "what_fell": ("land", "fall"),
}  # fmt: skip
_TWO_DEEDS = re.compile(
    r" and (?:\w+ )?(?P<deed>stop|fall|open|clos|shut|turn|roll|walk|land|start|go|com|mov|reach)\w* "
)
_NTH = re.compile(r"\b(?:second|third|fourth|last) (?:time|trip|turn|movement|run|fall|way|lap|round)\b")
_ANYTHING = ("", "things", "the things", "anything", "everything", "something", "the furniture", "it")
_DENIED = bag("not no never without nothing nobody")
_RANKS = bag("second third first last other another twice again")
_LEVELS = bag("floor ground board shelf")
_TO_THE_FLOOR = bag("when_lands when_falls if_falls long_falls how_many what_fell what_up far_falls first last order")
_ASKS = bag("which what how when where who whose")
_AUXILIARIES = bag("is are was were does do did has have had")
_NEGATED = bag("if_still what_still long_still long_open what_up what_shut if_shut how_many")
_VERBS = bag("fall falls light turn turns open close drop step steps start stop move swing spin fan walk roll slide")
_ORDERS = bag("first last second third than before after earlier later sooner next other")
_ALLOWED: Mapping[str, frozenset[str]] = {
    "first": _ORDERS, "last": _ORDERS | {"final"}, "order": _ORDERS, "if_before": _ORDERS, "if_after": _ORDERS,
    "if_together": bag("same both each other"), "if_returns": bag("back again"), 
    "when_shut": bag("back again"), "if_closes": bag("back again"), "if_shut": bag("again back"),
    "long_closes": bag("back again"), "where_ends": bag("last final"),
    "fastest": bag("most than faster every each other"),
    "when_opens": bag("first"), "when_closes": bag("back again first"), "when_leaves": bag("first"),
    "when_closest": bag("most least"), "when_starts": bag("first"), "when_stops": bag("last final again"),
    "when_reaches": bag("first"), "when_falls": bag("first"), "where_starts": bag("first initial"),
    "turns": bag("every each"), "often": bag("every each again back"), "fast_most": bag("most"),
    "gap": _ORDERS | {"between"},
    "long_still": bag("before first only"), "long_reach": bag("before until"),
    "if_to_end": bag("until last second final"), "turn_way": bag("other"),
    "what_still": bag("only else other"), "what_moves": bag("only else other"),
    "does": _ORDERS | bag("one another"), "how_many": bag("every each other"),
}  # fmt: skip

# -- one plain question for each kind ----------------------------------------------------------------------------------

_DEEDS = tuple(
    (re.compile(rf"\b(?:{words})\b"), deed)
    for words, deed in (
        (r"land(?:s|ed|ing)?|hits? (?:the )?(?:floor|ground)|touch(?:es|ed)? down", "land"),
        (r"f[ae]ll(?:s|en|ing)?|drop(?:s|ped|ping)?|tumbl\w+|c[oa]mes? (?:down|off)|plung\w+|plummet\w*|down", "fall"),
        (r"stop(?:s|ped|ping)?|finish\w*|halt\w*|rest|standstill|end(?:s|ed)?|done|still", "stop"),
        (r"clos(?:e|es|ed|ing)|shut(?:s|ting)?", "close"),
        (r"open(?:s|ed|ing)?", "open"),
        (r"turn(?:s|ed|ing)?|rotat\w+|pivot\w*|swivel\w*", "turn"),
    )
)  # fmt: skip
_OFTEN = (
    (re.compile(r"\b(?:com(?:es?|ing)|slid(?:es?|ing)|pops?|pulled) (?:\w+ )?out\b"), "how often does {x} open"),
    (re.compile(r"\bsteps?\b|\bpaces?\b"), "how many steps does {x} take"),
    (re.compile(r"\bhops?\b|\bbounc\w+|\bbobs?\b|\bjumps?\b"), "how often does {x} bob"),
)


def _deed(rest: str, moving: str) -> str:
    """The verb of what things do."""
    return next((deed for words, deed in _DEEDS if words.search(rest)), moving)


def _s(verb: str) -> str:
    return re.sub(r"(?<=[^s])$", "s", verb.split(" ")[0]) + verb[len(verb.split(" ")[0]) :]


def _one_of(x: str) -> str:
    """Of several things the noun for one: "the books" is "book"."""
    bare = _PLURAL.sub("", x)
    words = [word for word in bare.split() if word not in NUMBERS] or bare.split()
    return " ".join((*words[:-1], singular(words[-1]))) if words else "thing"


def _is_kind(x: str) -> bool:
    """Whether what is asked about is a kind of things: "the drawers", and not "the room"."""
    return x.endswith("s") and " and " not in x and _several(x) not in ("things", "objects", "items", "ones", "others")


def _several(x: str) -> str:
    return _PLURAL.sub("", x)


def _uncounted(x: str) -> str:
    return re.sub(r"^(?:two|three|four) ", "", _several(x))


Plain = Callable[[Said], Iterator[str]]


def _about(text: str, unit: bool = False) -> Plain:
    """A plain question with the things in it; none if it needs one that is not named."""

    def made(said: Said) -> Iterator[str]:
        if "{y}" in text and not said.y and said.x.count(" and ") == 1:
            one, other = said.x.split(" and ")  # which is on which is told by the scene
            yield from (text.format(x=one, y=other), text.format(x=other, y=one))
            return
        if ("{y}" in text and not said.y) or ("{x}" in text and not said.x):
            return
        asked = text.format(x=said.x, y=said.y)
        yield f"{asked} in {said.unit}" if unit and said.unit else asked

    return made


def _either(*ways: Plain) -> Plain:
    """The first of the ways that gives a question."""

    def made(said: Said) -> Iterator[str]:
        for way in ways:
            found = tuple(way(said))
            if found:
                yield from found
                return

    return made


def _moves(said: Said) -> Iterator[str]:
    yield f"does {said.x or 'anything'} move"


_RANKED_AS = {
    "first": re.compile(r"\b(?:first|earliest|soonest|begins?|starts?|leads?|before|opens)\b"),
    "last": re.compile(r"\b(?:last|latest|final\w*|longest|longer|after|closes|ends?(?! up\b))\b"),
}


def _ordered(said: Said, rank: str) -> Iterator[str]:
    if _RANKED_AS[rank].search(f"{said.x} {said.rest}") is None:
        return
    deed = _deed(said.rest, "move")
    noun = "thing" if not said.x or " and " in said.x or said.x in _PRONOUNS else _one_of(said.x)
    yield f"which {noun} {_s(deed)} {rank}"


def _in_order(said: Said) -> Iterator[str]:
    if said.x and " and " not in said.x and said.x not in _PRONOUNS and not said.x.endswith("s"):
        yield f"what does {said.x} do"
        return
    deed = _deed(said.rest, "move")
    yield f"in what order do {said.x if said.x and said.x not in _PRONOUNS else 'things'} {deed}"


_MOVING = re.compile(
    r"\b(?:mov\w*|motion|go|goes|roll\w*|walk\w*|spin\w*|slid\w*|shift\w*|budg\w+|stir\w*|travel\w*|wobbl\w+|"
    r"action|animat\w+|active|dynamic|still|act|do|does|com\w+|run\w*|driv\w+|chang\w+|leav\w+)\b"
)


_LEFT_UP = re.compile(r"\b(?:left|still|remain\w*|stay\w*) (?:up|on the (?:shelf|board|high))\b")


_BESIDE = re.compile(r" (?:at|by|around|round|near|beside|in|on|under) ")
_NOT_DONE = {"open": "stay closed", "fall": "do not fall", "land": "do not fall"}


def _counted(said: Said) -> Iterator[str]:
    deed = _deed(said.rest, "move")
    if _LEFT_UP.search(said.rest) and said.x and said.x not in _PRONOUNS:
        yield f"how many {_PLURAL.sub('', said.x)} have not fallen"
        return
    if (
        deed == "fall"
        and re.match(r"^(?:at|by|after) \d", said.time)
        and re.search(r"\b(?:down|fallen|dropped|landed)\b", said.rest)
    ):
        deed = "have fallen"
    x, *others = said.x.split(" and ")
    if not (others and x.endswith("s") and not any(other.endswith("s") for other in others)):
        x = said.x  # "the chairs round the table" are chairs
    noun = _BESIDE.split(_PLURAL.sub("", x))[0] if x and x not in _PRONOUNS else "things"
    if not _DENIED.isdisjoint(said.rest.split()):
        yield f"how many {noun} {_NOT_DONE.get(deed, 'do not move')}"
        return
    if deed == "move" and not said.time and not _MOVING.search(said.rest):
        yield f"how many {noun} are there"
        return
    yield f"how many {noun} {deed}"


def _compared(said: Said, word: str) -> Iterator[str]:
    if said.x and said.y:
        deed = _deed(said.rest, "start to move")
        deed = "stop moving" if deed == "stop" else deed
        yield f"does {said.x} {deed} {word} {said.y}"


def _often(said: Said) -> Iterator[str]:
    if said.x:
        own = next((text for words, text in _OFTEN if words.search(said.rest)), "")
        yield (own or f"how often does {{x}} {_deed(said.rest, 'move')}").format(x=said.x)


def _turns(said: Said) -> Iterator[str]:
    if said.x:
        degrees = "degree" in f"{said.unit} {said.rest}" or "angle" in said.rest
        yield f"how many degrees does {said.x} turn" if degrees else f"how many turns does {said.x} make"


_HOW_LONG = re.compile(r"\b(?:how long|how many seconds|how much time|what (?:length|amount) of time|period)\b")


def _fast(said: Said) -> Iterator[str]:
    if said.x and _HOW_LONG.search(f"{said.rest} {said.unit}"):
        yield f"how long does {said.x} take for one turn"
    elif said.x and said.unit not in ("seconds", "second", "s", "sec"):
        yield f"how fast does {said.x} move in {said.unit}" if said.unit else f"what is the average speed of {said.x}"


def _long(said: Said) -> Iterator[str]:
    if said.x:
        deed = _deed(said.rest, "move")
        yield f"how long does {said.x} {deed if deed in ('turn', 'fall') else 'move'}"


_FULLY = re.compile(
    r"\b(?:right out|(?:its|the) furthest|full extension|fully|full|completely|wholly|"
    r"all the way|entirely|maximum|widest|furthest)\b"
)


_HALFWAY = re.compile(r"\b(?:half|half ?way|mid ?point|middle)\b")


def _when_open(said: Said) -> Iterator[str]:
    if said.x:
        yield f"when is {said.x} {'half' if _HALFWAY.search(said.rest) else 'fully'} open"


_WHICH = re.compile(r"\b(?:which|name|list|what)\b")


def _those_shut(said: Said) -> Iterator[str]:
    if _is_kind(said.x) and _WHICH.search(f"{said.rest} {said.off}") and not re.search(r"\d", said.time):
        yield f"which {_uncounted(said.x)} stay closed"


def _of_those(asked: str, always: str) -> Plain:
    """Which things of a kind do something at a time, or all the time."""

    def made(said: Said) -> Iterator[str]:
        noun = _uncounted(said.x) if _is_kind(said.x) else ""
        if "fallen" in asked and _IN_THE_AIR.search(said.rest):  # neither before its fall nor behind it
            yield f"which {singular(noun) or 'thing'} is falling"
            return
        form = asked if said.time or not always else always
        if _HOW_MANY.search(said.rest):
            yield f"how many {noun or 'things'} {form}"
            return
        yield f"which {noun} {form}" if noun else f"what {_singular(form)}"

    return made


def _offered(does: str, otherwise: Plain) -> Plain:
    """Which of several things that are named do something."""

    def made(said: Said) -> Iterator[str]:
        if " and " in said.x:
            *names, last = said.x.split(" and ")
            yield f"what {does} {{when}}, {', '.join(names)} or {last}"
        else:
            yield from otherwise(said)

    return made


_IN_THE_AIR = re.compile(
    r"\b(?:on (?:its|their|the) way (?:down|to the (?:floor|ground))|falling|mid ?air|in the air|airborne)\b"
)
_HOW_MANY = re.compile(r"\b(?:how many|(?:what|the) number of|count)\b")


def _singular(form: str) -> str:
    """A predicate of one thing: "are open" is "is open"."""
    for many, one in (("are", "is"), ("have", "has"), ("do", "does")):
        form = re.sub(rf"^{many}\b", one, form)
    return re.sub(r"^stay\b", "stays", form)


def _what_on(said: Said) -> Iterator[str]:
    if re.search(r"\b(?:inside|within)\b", said.rest):
        return
    if said.y:
        yield f"which {_several(said.x)} are on {said.y}" if _is_kind(said.x) else f"what is on {said.y}"
    elif said.x:
        yield f"what is on {said.x}"


_OUT = re.compile(r"\b(?:pulled|slid|hang\w*|extended|wide|all the way|fully|completely|right) (?:out|open)\b")


def _long_still(said: Said) -> Iterator[str]:
    back = not said.time or _BEFORE_BACK.match(said.time) is not None
    if said.x and back and _OUT.search(said.rest):  # "how long does it sit there pulled all the way out"
        yield f"how long does {said.x} stay fully open"
    elif said.x:
        yield f"how long does {said.x} stand still"


_EVENTS = re.compile(r"\b(?:leav|reach|set|start|stop|depart|arriv|roll|com)(?:e?s|ing)\b")  # that are put in order


def _visits(said: Said) -> Iterator[str]:
    places = [place for place in said.places if place != said.x]
    if said.x and len(places) > 1 and len(_EVENTS.findall(said.rest)) < 2:
        yield f"in what order does {said.x} pass {' and '.join(places)}"


def _long_open(said: Said) -> Iterator[str]:
    if said.x:
        fully = _FULLY.search(f"{said.rest} {said.time} {said.off}") is not None
        yield f"how long does {said.x} stay {'fully ' if fully else ''}open"


_SUMMED = re.compile(
    r"\b(?:strokes both|both (?:strokes|directions)|total|altogether|cumulative|sum|summed|"
    r"adds|added|add|adding|combined|both ways|there and back|out and back|overall|outward and return|both walks)\b"
)


def _in_total(said: Said) -> Iterator[str]:
    if said.x and _SUMMED.search(f"{said.rest} {said.off}"):
        yield f"how far does {said.x} move in total" + (f" in {said.unit}" if said.unit else "")


def _which(said: Said) -> Iterator[str]:
    if " and " in said.x:
        yield f"which of {said.x} is the fastest"
        nouns = {name.split()[-1] for name in said.x.split(" and ")}
        if len(nouns) == 1:
            yield f"which {singular(nouns.pop())} is the fastest"
    elif said.x:
        yield f"which {_one_of(said.x)} is the fastest"


def _over(said: Said) -> Iterator[str]:
    if said.x and said.y:
        passes = re.search(r"\b(?:past|pass|passes|passed|by)\b", said.rest) is not None
        yield f"does {said.x} {'pass' if passes else 'cross'} {said.y}"


_OUTWARD = re.compile(r"\b(?:out|outward|outwards|opening|extension)\b")
_INWARD = re.compile(r"\b(?:back|return|inward|inwards|closing|retraction|in)\b")
_RESTS = re.compile(r"\b(?:pause|break|rest|hold|wait|stay|dwell)\b")


_EVENT_OF = re.compile(  # "the onset of the red book 's fall", "the red book 's landing", "that of the blue one 's"
    r"^(?:(?:the |its )?(?P<first>[a-z]+(?: point)?|that) of )?(?P<who>(?:the )?[a-z ]+?)(?: 's)?"
    r"(?: (?:starting|beginning|begins|starts) to)?"
    r"(?: (?P<deed>starting|falling|landing|stopping|fall up|fall|drop|impact|start|onset|departure|"
    r"release|trigger|drop trigger|stop|end|opening|closing))?$"
)
_BEGINS = re.compile(r"\b(?:starting|start|onset|departure|release|trigger|beginning)\b")
_ENDS = re.compile(r"\b(?:stopping|end|stop|landing|impact|touchdown)\b")


def _is_there(word: str, names: Collection[str]) -> bool:
    """Whether a noun is that of a thing of the scene, or another word for it: "volume"."""
    kind = kinds_of_things.find(singular(word))
    return singular(word) in names or (kind is not None and any(own in names for own in kind.name.split()))


def _event_in(said: str, names: Collection[str], noun: str) -> tuple[str, str] | None:
    """Who does what in the words for an event, and "" for what is said of another one; None if nobody is named."""
    found = _EVENT_OF.match(said)
    if found is None:
        return None
    who, told = found["who"].removeprefix("the ").split(), f"{found['first'] or ''} {found['deed'] or ''}"
    if who[-1] in ("one", "fall", "drop"):
        who[-1] = noun
    if is_color_word(who[-1]):
        who.append(noun)
    if (not _is_there(who[-1], names) and who[-1] != "one") or who == ["one"]:
        return None
    falls = _deed(f"{told} {said}", "") in ("fall", "land")
    if _ENDS.search(told):
        deed = "landing" if falls else "stopping"
    elif falls:
        deed = "falling"
    else:
        deed = "starting" if _BEGINS.search(told) else ""
    return f"the {' '.join(who)}", deed


def _gap(said: Said) -> Iterator[str]:
    parts = (*said.times, said.x, said.y)
    nouns = (word for part in parts for word in part.split() if _is_there(word, said.names) and not is_color_word(word))
    noun = next(nouns, "one")
    told = [event for part in parts if part and (event := _event_in(part, said.names, noun))]
    if len(told) == 2 and told[0][0] != told[1][0]:
        (one, deed), (other, then) = told
        deed = deed or then or {"fall": "falling", "land": "landing"}.get(_deed(said.rest, ""), "starting")
        yield f"how much time is there between {one} {deed} and {other} {then or deed}"
        return
    rests = len(said.times) == 2 and _RESTS.search(said.rest) is not None
    if rests and _OUTWARD.search(said.times[0]) and _INWARD.search(said.times[1]):
        yield f"how long does {said.x or 'it'} stay fully open"
    elif rests:
        yield f"how long is the pause between {said.times[0]} and {said.times[1]}"
    elif len(said.times) == 2:
        yield f"how much time is there between {said.times[0]} and {said.times[1]}"
    deed = {"fall": "falling", "land": "landing", "stop": "stopping", "open": "opening", "close": "closing"}.get(
        _deed(said.rest, ""), "starting"
    )
    if said.x and said.y:
        yield f"how much time is there between {said.x} {deed} and {said.y} {deed}"


def _long_reach(said: Said) -> Iterator[str]:
    if _AFTER_TURN.match(said.time):  # "after the turn, the walk to the bed takes how long?"
        yield f"how long does {said.x} move after it has turned"
    elif not said.time.startswith(("after ", "once ")):
        yield from _about("how long does {x} take to reach {y}")(said)


_AFTER_TURN = re.compile(r"^(?:after|once|from) (?:the|its|his|her|it has) turn\w*$")
_PLAIN: Mapping[str, Plain] = {
    "when_starts": _about("when does {x} start to move"),
    "when_stops": _about("when does {x} stop moving"),
    "when_opens": _about("when does {x} start to open"),
    "when_open": _when_open,
    "when_closes": _about("when does {x} start to close"),
    "when_shut": _about("when is {x} closed"),
    "when_falls": _about("when does {x} fall"),
    "when_lands": _either(_about("when does {x} reach {y}"), _about("when does {x} land")),
    "when_turns": _about("when does {x} turn"),
    "when_reaches": _about("when does {x} reach {y}"),
    "when_leaves": _either(_about("when does {x} leave {y}"), _about("when does {x} start to move")),
    "when_closest": _about("when is {x} closest to {y}"),
    "long_moves": _long,
    "long_opens": _about("how long does {x} take to open"),
    "long_closes": _about("how long does {x} take to close"),
    "long_open": _long_open,
    "long_still": _long_still,
    "long_on": _about("how long is {x} on {y}"),
    "long_falls": _about("how long does {x} fall"),
    "long_reach": _long_reach,
    "gap": _gap,
    "film_long": lambda said: iter(("how long is the film",)),
    "far": _either(_in_total, _about("how far does {x} move", unit=True)),
    "far_opens": _either(_in_total, _about("how far does {x} open", unit=True)),
    "far_turns": _about("by how many degrees does {x} turn"),
    "fast": _fast,
    "fast_most": _about("what is the maximum speed of {x}", unit=True),
    "turns": _turns,
    "often": _often,
    "where_ends": _about("where does {x} stop"),
    "where_starts": _about("where does {x} start"),
    "where_at": _about("where is {x}"),
    "way": _about("which way does {x} move"),
    "turn_way": _about("which way does {x} turn"),
    "if_moves": _moves,
    "if_still": _about("does {x} stand still"),
    "if_opens": _about("does {x} open"),
    "if_closes": _about("does {x} close"),
    "if_open": _about("is {x} open"),
    "if_shut": _either(_those_shut, _about("is {x} closed")),
    "if_falls": _about("does {x} fall"),
    "if_reaches": _about("does {x} touch {y}"),
    "if_on": _about("is {x} on {y}"),
    "if_crosses": _over,
    "if_returns": _about("does {x} come back"),
    "if_to_end": _about("does {x} move until the end"),
    "if_stops": _about("does {x} stop"),
    "if_turns": _about("does {x} turn"),
    "if_before": lambda said: _compared(said, "before"),
    "if_after": lambda said: _compared(said, "after"),
    "if_together": lambda said: _compared(said, "at the same time as"),
    "what_moves": _offered(
        "moves", lambda said: iter((f"which {_several(said.x)} move" if _is_kind(said.x) else "what moves",))
    ),
    "what_still": _offered(
        "does not move",
        lambda said: iter((f"which {_several(said.x)} do not move" if _is_kind(said.x) else "what does not move",)),
    ),
    "what_open": _offered("is open", _of_those("are open", "are open")),
    "what_shut": _offered("is closed", _of_those("are closed", "stay closed")),
    "what_on": _what_on,
    "what_fell": _offered("has fallen", _of_those("have fallen", "fall")),
    "what_up": _offered("has not fallen", _of_those("have not fallen", "do not fall")),
    "visits": _visits,
    "apart": _about("how far does {x} move as the crow flies", unit=True),
    "far_falls": _about("how far does {x} fall", unit=True),
    "how_many": _counted,
    "first": lambda said: _ordered(said, "first"),
    "last": lambda said: _ordered(said, "last"),
    "order": _in_order,
    "fastest": _which,
    "happens": lambda said: iter(("what happens",)),
    "does": _about("what does {x} do"),
    "near": _about("what is {x} next to"),
    "on_way": _about("what does {x} touch"),
}
