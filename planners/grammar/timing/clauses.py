"""Who does what: a clause divided into a thing, a verb and what stands beside it, in whatever mood it is said.

"open the door", "let the door open", "the door should be opened", "I want the door to open", "the door opens" and
"do not open the door" are one clause, with another form of the verb.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ..tagging.words import bag
from .manner import MOTION, Thing
from .verbs import Form, Verb, has_form, parted_verbs, verbs_at

ALL_OF_IT = Query(text="everything", pick="all")
MOVING = Query(text="", pick="all", moving=True)

AUXILIARIES = bag(
    "should must shall need needs to has have had ought is are was were be been being will would can could may might "
    "get gets got does do did also just only both all then now finally really actually please still simply going "
    "supposed already s 's who that which ever itself first"
)
_BETWEEN = AUXILIARIES | bag("not never longer")
_NOTHING = ("nothing", "none of it")
_BE = bag("is are was were be been being gets get")
_CAUSES = re.compile(
    r"^(?:(?P<no>do not|never|do not ever|please do not) )?(?P<cause>i (?:want|need)(?: it so)?|let|make sure|make|"
    r"have|get|cause|tell|ask|allow|force|"
    r"command|order|want|need|see to it|see|ensure|set|leave|keep|hold|put|bring|play|run|show|render|do|replay|"
    r"turn|help)"
    r"(?: that)? (?=\S)"
)
_KEEPING = bag("leave keep hold")
_PLAYING = bag("play run show render do replay")
_PLAYED = re.compile(
    r"^(?:it all|all of it|everything|all|the (?:whole |entire |full )?(?:thing|scene|clip|film|movie|video|animation|"
    r"sequence|shot|room|lot|motion|movement|time|footage)|all (?:the |of the )?(?:motion|movements?)|whole "
    r"(?:scene|clip|thing|shot|film)|"
    r"time|every movement|the movements|animation)$"
)
_SPEED = "speed|pace|tempo|velocity|rate"
_WAY = (
    "direction|rotation|spin|sense of rotation|rotation direction|spin direction|turning direction|sense|direction of "
    "(?:rotation|spin)|spinning|turning"
)
_EVENT = (
    "motion|movement|animation|anim|path|walk|roll|fall|drop|swing|ride|flight|turn|way|trip|journey|opening|closing|"
    "slide|run|move|departure|entrance|launch|takeoff|tumble|descent|ascent|course|march|stroll|tour|crossing|rolling|"
    "walking|falling"
)
_NAMES = {"speed": _SPEED, "way": _WAY, "event": _EVENT}
_ASPECTS = tuple(  # "the speed of the fan", "the fan 's speed"; and "the fan speed", where that is no name
    (
        aspect,
        re.compile(rf"^(?:(?:the )?(?:{names}) (?:of|for) (?P<of>.+)|(?P<who>.+?) (?:'s|s) (?:{names}))$"),
        re.compile(rf"^(?P<who>.+?) (?:{names})$"),
    )
    for aspect, names in _NAMES.items()
)
_ALONE = re.compile(
    r"^(?:the|its) (?:motion|movement|animation|walk|roll|fall|drop|flight|turn|opening|closing|departure)$"
)
_ANIMATION = re.compile(r"^(?P<who>.+?) (?:animation|anim|motion|movement)$")
_ONLY = re.compile(r"^only (?P<who>.+?) (?:(?:should|may|must|shall|can|is to|are to) )*(?P<verb>[a-z]+)$")
_NOT = re.compile(r"^(?:do not|never|no longer) (?=\S)")
_NO = re.compile(r"^no (?:more )?(?P<event>[a-z]+) (?:of|for|from) (?P<who>.+)$")  # "no movement of the robot"


@dataclass(frozen=True)
class Clause:
    """A verb with the thing that it is about.

    Attributes:
        target: what it is about: the object of an order, the subject of what is told.
        aspect: what of it is meant: its "speed", its "way" of turning, the "event"; else "".
        verb: None where the words only say how it is ("fan at half speed").
        tail: the words beside.
        np: the words for the target.
        ordered: whether it is an order with an object ("open the door").
        kept: whether it says that something stays so ("keep", "leave").
        played: whether a word for playing leads it.
        negated: whether it is not to be.
        aux: the words between the thing and its verb.
    """

    target: Query
    aspect: str
    verb: Verb | None
    tail: tuple[str, ...]
    np: str
    ordered: bool = False
    kept: bool = False
    played: bool = False
    negated: bool = False
    aux: tuple[str, ...] = ()

    @property
    def sense(self) -> str:
        """That of its verb; "be" without one."""
        return "be" if self.verb is None else self.verb.sense

    @property
    def form(self) -> Form:
        """That of its verb."""
        return "plain" if self.verb is None else self.verb.form


def clauses(said: str, thing: Thing) -> Iterator[Clause]:
    """Each way of dividing a command, the likeliest first."""
    words = said.split(" ")
    if (only := _ONLY.match(said)) is not None and has_form(only["verb"], MOTION, "plain", "s"):
        one = thing(only["who"])  # "only the green book falls": what else moves does not
        if one is not None:
            rest = MOVING.model_copy(update={"exclude": (one,)})
            yield Clause(rest, "", next(verbs_at(["fall"], 0)), (), only["who"], negated=True)
        return
    yield from _ordered(words, thing, False)
    if (found := _NOT.match(said)) is not None:
        yield from _ordered(said[found.end() :].split(" "), thing, True)
    if (found := _NO.match(said)) and (found["event"] in _EVENT.split("|") or has_form(found["event"], MOTION, "ing")):
        target = thing(found["who"])
        if target is not None:
            yield Clause(target, "event", next(verbs_at(["move"], 0)), (), found["who"], negated=True)
    if (cause := _CAUSES.match(said)) is not None:
        for clause in told(said[cause.end() :].split(" "), thing):
            yield replace(
                clause,
                kept=cause["cause"] in _KEEPING,
                played=cause["cause"] in _PLAYING,
                negated=clause.negated != (cause["no"] is not None),
            )
    yield from told(words, thing)


def _ordered(words: Sequence[str], thing: Thing, negated: bool) -> Iterator[Clause]:
    """An order: the verb first, then its object."""
    for verb, start in parted_verbs(words) if words else ():
        if verb.form != "plain":
            continue
        whose = owner(" ".join(words[1:start]), thing)
        if whose is not None:
            tail = tuple(words[start + len(verb.said.split(" ")) - 1 :])
            yield Clause(*whose, verb, tail, " ".join(words[1:start]), ordered=True, negated=negated)
    for verb in verbs_at(words, 0):
        if verb.form not in ("plain", "ing"):
            continue
        rest = words[verb.taken :]
        for end in range(1, min(len(rest), 10) + 1):
            whose = owner(" ".join(rest[:end]), thing)
            if whose is not None:
                yield Clause(*whose, verb, tuple(rest[end:]), " ".join(rest[:end]), ordered=True, negated=negated)


def told(words: Sequence[str], thing: Thing) -> Iterator[Clause]:
    """What something does, in any tense, or what it is to do."""
    for place in range(1, len(words)):
        for verb in verbs_at(words, place):
            yield from _with_subject(words, place, verb, thing)
    for place in range(1, len(words)):
        yield from _with_subject(words, place, None, thing)


def _with_subject(words: Sequence[str], place: int, verb: Verb | None, thing: Thing) -> Iterator[Clause]:
    """The clause whose verb stands at a place: before it a thing, and between them only auxiliaries."""
    first = place
    while first > 1 and (words[first - 1] in _BETWEEN or words[first - 1 : first + 1] == ["no", "longer"]):
        first -= 1
    for end in range(first, place + 1):
        between, np = words[end:place], " ".join(words[:end])
        whose = owner(np, thing)
        if whose is None or (between[:1] == ["first"] and owner(f"{np} first", thing) is not None):
            continue  # "the book that falls first" is a name
        if verb is not None and verb.form == "plain" and between[-1:] and between[-1] in _BE:
            return  # "is open" is how it is, not what it does
        negated = bool({"not", "never", "longer"} & set(between)) != (np in _NOTHING)
        tail = tuple(words[place + (verb.taken if verb else 0) :])
        yield Clause(*whose, verb, tail, np, negated=negated, aux=tuple(between))
        return


def owner(said: str, thing: Thing) -> tuple[Query, str] | None:
    """Whom a phrase means, and what of it: "the fan 's speed", "the fall of the book", "the whole clip"."""
    said = said.strip(" ,")
    if said in _NOTHING:
        return MOVING, ""
    if _PLAYED.match(said):
        return ALL_OF_IT, ""
    for aspect, parted, _ in _ASPECTS:
        of = parted.match(said)
        if of is not None and (whose := owner(of["of"] or of["who"], thing)) is not None:
            return whose[0], aspect
    if _ALONE.match(said):
        return MOVING, "event"
    compound = _ANIMATION.match(said)
    if compound is not None and (found := thing(compound["who"])) is not None:
        return found, "event"
    if (found := thing(said)) is not None:
        return found, ""
    for aspect, _, joined in _ASPECTS:
        of = joined.match(said)
        if of is not None and (found := thing(of["who"])) is not None:
            return found, aspect
    return None
