"""The time that words with a mark tell by what happens, by its kind: "on fan stop", "having made its turn"."""

from __future__ import annotations

from dataclasses import dataclass

from .....gaussians import late_re as re
from .....gaussians.language.query.query import Query
from .....gaussians.world.words import singular
from .....tools.when import During, Part
from ...learned.events import Event, event_of
from ...tagging.words import bag
from ..happenings import IT, Happening
from ..manner import Thing
from ..moments import Moment
from .names import named

_PRONOUNS = bag("it he she they him her them its his their this that")
_BEFORE = re.compile(r"^(?:right |just |only )*(?:until|till|til|before|by|up to|prior to|no later than)\b")
_AFTER = re.compile(r"^(?:right |just |only |directly |straight )*(?:after|following|past|post|beyond)\b")
_OVER = re.compile(r"\b(?:end|finish|close) of\b")  # "at the end of its first walk"
_NOWHERE = re.compile(r"\b(?:comes?|came|coming) (?:over|by|near|close)$")  # to where is not told
_EACH_TIME = re.compile(r"\b(?:each|every) time\b|\bwhenever\b")  # one event has one time
_NTH_OF_SEVERAL = re.compile(
    r"\b(?:first|second|third|last|next|final) (?:walk|leg|stretch|movement|roll|fall|run|part|stage|lap|step)\b"
)
_FULLY = re.compile(r"\b(?:at rest|full|fully|out|extended|wide|all the way|completely)\b")


@dataclass(frozen=True)
class _State:
    """A state, and which part of the time it tells: from when, while and until when something is to be."""

    state: str
    since: Part = "from"
    through: Part = "while"
    until: Part = "until"


def _begins(state: str) -> _State:
    return _State(state, through="from")


def _ends(state: str) -> _State:
    return _State(state, "after", "after", "until_end")


_STATES = {
    "starts": _begins("moving"), "moves": _State("moving"), "stops": _ends("moving"), "still": _State("still"),
    "opens": _begins("opening"), "opening": _State("opening"), "open": _State("fully_open"), "is_open": _State("open"),
    "closes": _begins("closing"), "closing": _State("closing"), "shut": _ends("closing"),
    "is_shut": _State("open", "after", "unless", "until_end"), "half": _begins("halfway"),
    "falls": _begins("falling"), "falling": _State("falling"), "lands": _ends("falling"),
    "turns": _begins("turning"), "turning": _State("turning"), "turned": _ends("turning"),
    "reaches": _begins("touches"), "leaves": _ends("on"), "on": _State("on"),
    "first_of": _begins("moving"), "last_of": _ends("moving"), "in_step": _State("moving"),
}  # fmt: skip
_RANKS = {"first_of": "first", "last_of": "last"}
# Kinds that no rule reads, or takes for something else.
_ITS_OWN = ("film_start", "film_end", "first_leg", "last_leg", "in_step")
_SURELY = 0.7  # probability from which they go before what rules read
_CERTAINLY = 0.95  # probability from which any kind does


def is_told_by_event(phrase: str) -> bool:
    """Whether words tell an edge of the film, or a stretch of a way, which rules take for something else, or surely
    another event."""
    event = event_of(phrase)
    return event is not None and event.chance >= (_SURELY if event.kind in _ITS_OWN else _CERTAINLY)


def told_by_event(tag: str, phrase: str, thing: Thing) -> tuple[Moment | None, Happening | None] | None:
    """The time that words with a tag of time tell by what happens, as `times.told_by`; None if they tell none,
    or a thing in them is unknown."""
    event = event_of(phrase)
    if event is None or _NOWHERE.search(phrase) is not None or _EACH_TIME.search(phrase) is not None:
        return None
    if _NTH_OF_SEVERAL.search(phrase) is not None and event.kind not in ("first_leg", "last_leg"):
        return None  # "in sync with its second walk" is not all of its way
    ends = tag == "to" or _BEFORE.match(phrase) is not None
    if event.kind in ("film_start", "film_end"):
        return _of_film(event.kind == "film_end", ends, phrase), None
    of = _who(event, thing)
    if of is None:
        return None
    if event.kind in ("first_leg", "last_leg"):
        return None, _leg(event.kind == "first_leg", ends, of, phrase)
    found = _STATES[event.kind]
    anchors: tuple[Query, ...] = ()
    if found.state in ("touches", "on"):
        if (other := thing(event.y)) is None:
            return None
        anchors = (other,)
    state = "fully_open" if event.kind == "is_open" and _FULLY.search(phrase) else found.state
    part = found.since if tag == "from" else found.through
    if ends:
        part = found.until
    elif found.through == "while" and _AFTER.match(phrase):
        part = "after"
    return None, Happening(During(state=state, anchors=anchors, of=of, part=part), phrase)


def told_by_leg(tag: str, phrase: str, thing: Thing) -> Happening | None:
    """The time that words with a tag of time tell by a leg of a way, before a turn or behind it: "during its second
    walk", "when the first leg is over"; None for others."""
    found = _LEG.search(phrase)
    if found is None or found["rank"] == "third":
        return None
    before = named(phrase[: found.start()], thing)
    whose = thing(found["who"] or before[0]) if found["who"] or before else IT
    first = found["rank"] == "first"
    ends = tag == "to" or _BEFORE.match(phrase) is not None
    if whose is None:
        return None
    if tag in ("from", "to") and _STARTS.search(phrase[found.end() :]):  # "when the second walk begins"
        edge = During(state="moving", of=whose, part="until" if ends else "from")
        turned = During(state="turning", of=whose, part="until_end" if ends else "after")
        return Happening(edge if first else turned, phrase)
    if tag == "from" and _STOPS.search(phrase[found.end() :]):
        phrase = f"after {phrase}"
    return _leg(first, ends, whose, phrase)


_LEG = re.compile(
    r"\b(?:(?P<who>(?:the|my|our) (?:[a-z]+ )?[a-z]+) 's|its|his|her|the) "
    r"(?P<rank>first|second|last|final|third) (?:walk|leg|stretch|straight)\b"
)
_STARTS = re.compile(r"^ (?:begins?|starts?|is beginning|gets? going|sets? in)\b")
_STOPS = re.compile(r"^ (?:ends?|stops?|is (?:over|done|finished)|finishes)\b")


def _of_film(last: bool, ends: bool, phrase: str) -> Moment:
    """Its start or its end."""
    if ends:
        return Moment(stop=None if last else 0.0, always=last, said=(phrase,))
    return Moment(start="end" if last else 0.0, said=(phrase,))


def _leg(first: bool, ends: bool, of: Query, phrase: str) -> Happening:
    """The way of something before its turn, or behind it."""
    turn, way = (During(state=state, of=of) for state in ("turning", "moving"))
    if first:
        start, stop = way.model_copy(update={"part": "from"}), turn.model_copy(update={"part": "until"})
        over = turn.model_copy(update={"part": "from"})
    else:
        start, stop = turn.model_copy(update={"part": "after"}), way.model_copy(update={"part": "until_end"})
        over = way.model_copy(update={"part": "after"})
    if ends:
        return Happening(stop, phrase)
    return Happening(over, phrase) if _AFTER.match(phrase) or _OVER.search(phrase) else Happening(start, phrase, stop)


def _who(event: Event, thing: Thing) -> Query | None:
    """Whose state it is."""
    if not event.x or event.x in _PRONOUNS:
        return thing("everything that moves") if event.kind == "last_of" else IT
    if event.kind in _RANKS:
        noun = singular(event.x.split()[-1])
        return thing(f"the {noun} that moves {_RANKS[event.kind]}")
    return thing(event.x)
