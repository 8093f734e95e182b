"""Questions about a scene with time that ask of one moment what a static scene tells: "where is the vase at 3 s?"."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ....gaussians import late_re as re
from ...grammar.tagging.words import bag
from ..kind import Asked
from ..reading.time.deeds import Deed, said_in
from ..reading.time.frames import Frame, frames, plain
from ..reading.time.happenings import Happening
from ..reading.time.moments import When, clauses, without_time
from ..survey import NotResolved, Survey
from .asked import NO_VERBS, Told, Untold, window, within
from .bodies import Body, Timeline

SAMPLES = 6  # moments at which "always" and "ever" are asked
_ENDS_UP = re.compile(
    r"^(?P<aux>does|do|did|will|would|is|are) (?P<x>.+?) (?:ends? up|ending up|finish(?:es)?(?: up)?|come to rest|"
    r"comes to rest|stop|stops|"
    r"land|lands|wind up|winds up|end|settle|settles) (?P<r>(?:on|in|at|next to|near|beside|under|by|against|behind|"
    r"in front of|inside|"
    r"to the left of|to the right of|left of|right of|close to|on top of|between) .+)$"
)
_ENDS_FAR = re.compile(
    r"^how (?P<far>far(?: away)?|close|near) (?:from|to) (?P<b>.+?) (?:does|do|did|is|will) (?P<x>.+?) (?:stop|end up|"
    r"end|finish|come to rest|land)$|"
    r"^how (?P<far2>far(?: away)?|close|near) (?:does|do|did|is|will) (?P<x2>.+?) (?:stop|end up|end|finish|come to "
    r"rest|land) (?:away )?(?:from|to) "
    r"(?P<b2>.+)$"
)
_ENDS_WHERE = re.compile(
    r"^where (?:does|do|did|will|is) (?P<x>.+?) (?:end up|ends up|finish|wind up|at last|in the end)$"
)
_ENDS_BY = re.compile(
    r"^(?P<q>(?:what|which)(?: thing| object| furniture)?) (?:does|do|did|is|will) (?P<x>.+?) (?:end up|stop|finish|"
    r"come to rest|land|end) "
    r"(?P<r>next to|near|beside|against|on|in front of|closest to|nearest to|by|at)$"
)


@dataclass(frozen=True)
class AtMoment:
    """A question for a static scene, and when it is asked of.

    Attributes:
        words: the question without its time.
        times: seconds; several for "always" and "ever".
        every: whether it must hold at all of several times.
        said: whether a time was said.
    """

    words: str
    times: tuple[float, ...]
    every: bool = False
    said: bool = True


_PLACE_OF = re.compile(r"^(?P<x>(?:the )?\w+(?: \w+)?)(?: 's)? (?:position|location|place)$")
_ASKS = re.compile(
    r"^(?:how|what|which|when|where|who|why|is|are|was|were|does|do|did|has|have|can|in|on|at|to|list|name|count)\b"
)
_ADVERB = re.compile(r"\b(?:still|already|yet) (?=(?:on|in|at|next|near|under|beside|behind|by|above|against)\b)")
_RELATIVE = re.compile(
    r"\b(?P<np>the (?:\w+ ){0,2}?(?P<noun>(?!at\b|in\b|on\b|from\b|by\b)\w+)) (?:that|which|who) (?P<clause>.+)$"
)
_PARTICIPLE = re.compile(r"\bthe (moving|rolling|falling|spinning|turning|walking|rotating|sliding) (?!of\b)(\w+)")
_WHAT_IS = re.compile(r"^(?:and )?(?:what|which|who)(?: one| thing)? (?:is|was|are|were) $")


IN_PLACE = re.compile(  # whose words are those of motions, too: "left", "back", "corner"
    r"\b(?:in|at|on|by|against|along|near|to) the (?:(?:back|front|far|near|left|right|hand) )*"
    r"(?:left|right|corner|wall|side)\b(?! (?:wall|door|drawer|one))"
)


_OF_THE_ROOM = re.compile(r"\b(?P<place>corner|wall) of (?:the|this|our) \w+$")


def without_relative(words: tuple[str, ...], survey: Survey, timeline: Timeline) -> tuple[str, ...]:
    """The words with the name of what moves in place of what tells it by its motion: "the book that falls last"."""
    said = _PARTICIPLE.sub(r"the \2 that is \1", " ".join(words))
    found = _RELATIVE.search(said)
    if found is None or _WHAT_IS.match(said[: found.start()]):
        return words
    clause = found["clause"].split()
    for taken in range(len(clause), 0, -1):
        told = ("which", *found["np"].split()[1:], *clause[:taken])
        for frame in frames(told):
            if frame.asks != "which" or frame.what.deed is None:
                continue
            try:
                meant = named_by(Told(frame, Asked(said, words=told, timeline=timeline), survey, timeline))
            except (NotResolved, Untold):
                continue
            if meant is not None:
                return tuple(f"{said[: found.start()]}{meant.name} {' '.join(clause[taken:])}".split())
    return words


def named_by(told: Told) -> Body | None:
    """The one body that does it, the first or the last of several; None if there are several."""
    found = [(s, b) for b in told.bodies() for s in within(told.spans(b), told.window())]
    bodies = list(dict.fromkeys(b for _, b in sorted(found, key=lambda e: e[0])))
    if told.frame.rank in ("first", "last") and bodies:
        return bodies[0 if told.frame.rank == "first" else -1]
    return bodies[0] if len(bodies) == 1 else None


def moments(words: tuple[str, ...], survey: Survey, timeline: Timeline, asked: Asked) -> Iterator[AtMoment]:
    """Each way of reading a question as one about a moment, the present one last.

    Raises:
        NotResolved, Untold: the moment is told by an event that is not there.
    """
    said, plainer = (_named(s, survey, timeline) for s in (" ".join(words), plain(words)))
    for when, rest in (*_readings(said), *(() if plainer == said else _readings(plainer))):
        unplaced = IN_PLACE.sub(" there ", rest)
        if not _MOTION_NOUNS.isdisjoint(rest.split()) or any(_is_of_motion(deed) for _, _, deed in said_in(unplaced)):
            continue
        rest = _OF_THE_ROOM.sub(r"\g<place>", _ADVERB.sub("", rest))
        if when is None:
            yield AtMoment(rest, (timeline.now,), said=False)
        elif when.kind in ("always", "ever"):
            step = (timeline.stop - timeline.start) / (SAMPLES - 1)
            times = tuple(timeline.start + i * step for i in range(SAMPLES))
            yield AtMoment(rest, times, when.kind == "always")
        else:
            yield AtMoment(rest, (_time(when, survey, timeline, asked),))


def _readings(said: str) -> Iterator[tuple[When | None, str]]:
    if found := _ENDS_UP.match(said):
        yield When("end"), f"{'are' if found['aux'] in ('do', 'are') else 'is'} {found['x']} {found['r']}"
    if found := _ENDS_FAR.match(said):
        yield When("end"), f"how far is {found['x'] or found['x2']} from {found['b'] or found['b2']}"
    if found := _ENDS_WHERE.match(said):
        yield When("end"), f"where is {found['x']}"
    if found := _ENDS_BY.match(said):
        yield When("end"), f"{found['q']} is {found['x']} {found['r']}"
    yield from clauses(said)
    when, rest = without_time(said)
    if when is not None:
        if (found := _PLACE_OF.match(rest)) is not None:
            yield when, f"where is {found['x']}"
        elif not _ASKS.match(rest):
            yield when, f"is {rest}"  # "ball on the rug at 2 s?"
        yield when, rest
    yield None, said


_MOTION_NOUNS = bag(
    "rotation rotations revolution revolutions movement movements motion spins turns speed velocity falls"
)
_NO_MOTION = ("related", "still", "is_open", "is_closed", "is_back", "appear", "nearest", "farthest")


def _is_of_motion(deed: Deed) -> bool:
    """Whether a question with it asks of motion, so that one moment does not tell its answer."""
    return deed.kind not in _NO_MOTION and deed.verb not in NO_VERBS


def _time(when: When, survey: Survey, timeline: Timeline, asked: Asked) -> float:
    """The moment that is meant: just before or after an event, or in the middle of a span."""
    span = window(when, Told(Frame("yesno", Happening(None), when=when), asked, survey, timeline))
    assert span is not None
    if when.conj == "by":
        return span[1]
    if when.kind == "clause" and when.conj == "before":
        return max(span[1] - _ASIDE, timeline.start)
    if (when.kind == "clause" and when.conj == "after") or when.kind == "after":
        return min(span[0] + (_ASIDE if when.kind == "clause" else 0.0), timeline.stop)
    return (span[0] + span[1]) / 2


_ASIDE = 0.05  # seconds before or after an event


def _named(said: str, survey: Survey, timeline: Timeline) -> str:
    """The words with the name of what moves in place of "it", where nothing was spoken of and one thing moves."""
    movers = timeline.movers(survey)
    if survey.last or len(movers) != 1:
        return said
    return re.sub(
        r"(?<!what )(?<!does )(?<!is )\bit\b(?! (?:take|is that))|(?<=is )it\b(?= )|(?<=does )it\b",
        movers[0].name,
        said,
        count=1,
    )
