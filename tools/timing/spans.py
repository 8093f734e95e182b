"""The spans of a scene's time that a `When` means."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.errors import InstructionError
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.motion.motion import moving_ids
from ...gaussians.scene import Frame, Scene
from ...gaussians.world.relation_geometry import viewer_stand
from ..operation import Context
from ..when import During, When

if TYPE_CHECKING:
    from ...gaussians.motion.courses import Course

Span = tuple[float, float]  # start and stop, seconds

SHORTEST = 1e-3  # seconds: spans that are shorter are none
_APART = 1e-6  # seconds: spans that are nearer are one


class Length(NamedTuple):
    """Start and stop of a scene, seconds, and whether it has a motion that says so."""

    start: float
    stop: float
    known: bool


def length_of(scene: Scene) -> Length:
    """The time of a scene; one that stands still has none yet, and starts at 0."""
    motion = scene.motion
    return Length(0.0, 0.0, False) if motion is None else Length(motion.start, motion.stop, True)


def longer_notes(whole: Length, stop: float, anyway: bool = False) -> tuple[str, ...]:
    """A note that a scene with motion has become longer, if it has.

    Args:
        whole: its time before.
        stop: its end now, seconds.
        anyway: whether a scene that stood still before is told of, too.
    """
    longer = (whole.known or anyway) and stop > whole.stop + SHORTEST
    return (f"the scene lasts {stop - whole.start:g} s now",) if longer else ()


def spans_of(when: When | None, scene: Scene, target: Selection, context: Context, onward: bool = False) -> list[Span]:
    """The spans that are meant, in order, seconds; open ends are infinite. At all times without a `When`.

    Args:
        onward: whether they may begin later than the scene ends, as what moves then makes it longer.

    Raises:
        AbsentError, AmbiguousError: a thing by which the time is told is not in the scene, or not unique.
        InstructionError: nothing of the kind happens in the scene, or the time lies outside it.
    """
    if when is None:
        return [(-math.inf, math.inf)]
    whole = length_of(scene)
    if when.during is not None:
        found = _told(when, when.during, scene, target, context)
    else:
        start = _moment(when.start, whole, -math.inf)
        if when.lasting is not None and when.start is None:
            start = whole.start if context.time is None else context.time
        found = [(start, math.inf)]
    if when.until is not None:
        found = _ended(found, when.until, scene, target, context)
    stop = _moment(when.stop, whole, math.inf)
    found = [(a, min(b, stop, a + when.lasting if when.lasting is not None else math.inf)) for a, b in found]
    found = [(a, b) for a, b in found if b - a > SHORTEST]
    if not found:
        raise InstructionError(f"no time is left {when.describe()}: it would end before it starts")
    if when.every is not None:
        found = _in_turns(found, when.every, whole)
    if not onward:
        require_within(found, scene)
    return found


def require_within(spans: list[Span], scene: Scene) -> None:
    """Refuse spans of which the first begins later than a scene with motion ends.

    Raises:
        InstructionError: it does.
    """
    whole, first = length_of(scene), spans[0][0]
    if whole.known and first > whole.stop:
        raise InstructionError(f"the scene lasts until {whole.stop:g} s, and {first:g} s is later: say an earlier time")


_BLINKS = 5.0  # seconds for which something comes and goes in a scene without an end


def _in_turns(found: list[Span], every: float, whole: Length) -> list[Span]:
    """The first half of each period in the spans."""
    made = list[Span]()
    for start, stop in found:
        first = start if math.isfinite(start) else whole.start
        last = stop if math.isfinite(stop) else whole.stop if whole.known else first + _BLINKS
        made += [(t, min(t + every / 2, last)) for t in np.arange(first, last - SHORTEST, every)]
    return [(float(a), float(b)) for a, b in made if b - a > SHORTEST] or found


def _moment(said: float | str | None, whole: Length, default: float) -> float:
    """A time, seconds."""
    if said is None:
        return default
    if isinstance(said, str) or said < 0:
        if not whole.known:
            raise InstructionError("this scene has no end in time, as nothing moves in it: give seconds from its start")
        if isinstance(said, str):
            return whole.stop if said == "end" else (whole.start + whole.stop) / 2
        return whole.stop + said
    return float(said)


def _told(when: When, during: During, scene: Scene, target: Selection, context: Context) -> list[Span]:
    """The spans that are told by what happens."""
    whole = length_of(scene)
    found = _happening(during, scene, target, context)
    if during.state == "closest":
        return [(found[0][0] + _delay(when), math.inf)]
    if not found:
        if during.part == "unless":
            return [(-math.inf, math.inf)]
        raise InstructionError(f"that never happens in this scene: {during.describe().split(' ', 1)[1]}")
    first, last = found[0], found[-1]
    delay = _delay(when)
    if during.part == "while":
        return [(_open(a, whole.start, -math.inf) + delay, _open(b, whole.stop, math.inf)) for a, b in found]
    if during.part == "unless":
        return [
            (_open(a, whole.start, -math.inf) + delay, _open(b, whole.stop, math.inf))
            for a, b in _rest(found, whole.start, whole.stop)
        ]
    if during.part == "from":  # "when it touches the wall" is not said of what touches it from the start
        begun = next((a for a, _ in found if a > whole.start + SHORTEST), first[0])
        return [(begun + delay, math.inf)]
    if during.part == "after":
        latest = _latest_end(during, scene, target, context)
        if first[1] > latest:
            raise InstructionError(f"that does not end in this scene: {during.describe().split(' ', 1)[1]}")
        ended = first[1] if during.state not in ("moving", "falling") else last[1]
        return [(ended + delay, math.inf)] if ended <= latest else [(first[1] + delay, math.inf)]
    if during.part == "until":
        begun = next((a for a, _ in found if a > whole.start + SHORTEST), first[0])
        return [(-math.inf, begun - delay)]
    return [(-math.inf, last[1] - delay)]


def _ended(spans: list[Span], until: During, scene: Scene, target: Selection, context: Context) -> list[Span]:
    """The spans, each at most until something happens for the first time after its start."""
    happens = _happening(until, scene, target, context)
    ends = [b if until.part == "until_end" else a for a, b in happens]
    latest = _latest_end(until, scene, target, context)
    ended = list[Span]()
    for start, stop in spans:
        end = next((t for t in ends if t > start + SHORTEST and t <= latest), None)
        if end is None:
            told = until.model_copy(update={"part": "while"}).describe().removeprefix("while ")
            how = "end" if until.part == "until_end" else "happen"
            raise InstructionError(f"that does not {how} after {start:.3g} s: {told}")
        ended.append((start, min(stop, end)))
    return ended


_MOVING = ("moving", "falling", "turning", "opening", "closing", "halfway")  # which a movement begins and ends


def _latest_end(during: During, scene: Scene, target: Selection, context: Context) -> float:
    """Until when what happens may have ended, seconds: before the end of the scene, but with it where it is a movement
    whose last key is then, as what begins behind that makes the scene longer."""
    whole = length_of(scene)
    if during.state in _MOVING and scene.motion is not None:
        ids = _ids_of(scene, _groups(target if during.of is None else _meant(scene, during.of, context), scene))
        own = [track for track in scene.motion.tracks if np.isin(ids, track.ids).any()]
        ends = all(track.kind != "spin" and float(track.times[-1]) <= whole.stop + SHORTEST for track in own)
        waves = [r for r in scene.motion.residuals if np.isin(ids, r.ids).any()]
        if ends and all(float(r.times[-1]) <= whole.stop + SHORTEST for r in waves):
            return whole.stop + SHORTEST
    return whole.stop - SHORTEST


def _delay(when: When) -> float:
    return float(when.start) if isinstance(when.start, float | int) else 0.0


def _open(time: float, end: float, without: float) -> float:
    """A time, open where it is the end of the scene."""
    return without if abs(time - end) < SHORTEST else time


def _happening(during: During, scene: Scene, target: Selection, context: Context) -> list[Span]:
    """When it is so, for any of the things that it is about."""
    from ...gaussians.motion.courses import course_of
    from ...gaussians.motion.events import falls, intervals, movements, nearest_time
    from ...gaussians.motion.holding import joined

    groups = _groups(target if during.of is None else _meant(scene, during.of, context), scene)
    anchors = [_groups(_anchor(scene, q, context, during, target), scene) for q in during.anchors]
    if scene.motion is None:
        raise InstructionError("nothing moves in this scene: give the time in seconds")
    up, field = scene.frame.up_vector, scene.language
    assert field is not None
    if during.state == "closest":
        time, gap = nearest_time(scene, groups[0], anchors[0][0])
        if gap > _PASSED / (scene.frame.metres_per_unit or 1.0):
            raise InstructionError(f"it does not come near {during.anchors[0].describe()}: send it there")
        return [(time, math.inf)]
    stand = viewer_stand(context.viewer, up, field.typical_size, field.middle)
    unit = 1.0 / (scene.frame.metres_per_unit or 1.0)

    def of(group: int) -> list[Span]:
        if during.state in ("falling", "turning", "open", "opening", "closing", "fully_open", "halfway"):
            course = course_of(scene, group)
            return falls(course, unit) if during.state == "falling" else _own(course, during, scene.frame)
        if during.state == "touches":  # "the wall" may be several
            return [s for anchor in anchors[0] for s in _touching(scene, group, anchor, unit)]
        if len(anchors) == 1:
            return [s for anchor in anchors[0] for s in intervals(scene, group, during.state, (anchor,), stand)]
        return list(intervals(scene, group, during.state, [a[0] for a in anchors], stand))

    each = [of(group) for group in groups]
    found = [span for spans in each for span in spans]
    if during.of is not None and during.of.pick == "all" and during.of.text and found:
        if during.part in ("while", "unless"):  # "while the books fall", one after the other
            found = [(min(a for a, _ in found), max(b for _, b in found))]
        elif anchors and all(each):  # "once all books are on the floor"
            found = [(max(spans[0][0] for spans in each), max(b for _, b in found))]
    if during.state == "closing" and not found:  # what began open closes as it moves
        found = [s for group in groups for s in movements(course_of(scene, group), unit)]
    exact = _edges(scene, groups) if during.state in _KEYED else []
    return joined(sorted((_snapped(a, exact), _snapped(b, exact)) for a, b in found), _APART)


_KEYED = ("moving", "still", "falling", "open", "opening", "closing", "fully_open")  # which begin and end with a track
_ROUGH = 0.1  # seconds: an edge that was measured is the key of a track that is nearer
_TURNS = 0.2  # radians a second about the vertical from which a thing turns
_AWAY = 0.02  # metres from where it is at the start: then it is open
_SLOW = 0.05  # of the greatest speed away or back: from there on it opens or closes
_SOON = 0.02  # seconds: a speed is measured over twice as much
_PASSED = 0.5  # metres between what stops beside a thing and that thing at most
_WIDE = 0.99  # of as far as it opens: then it is open all the way
_REACHED = 0.35  # metres: what comes this near and no nearer has reached it


def _edges(scene: Scene, groups: tuple[int, ...]) -> list[float]:
    """The times of the keys of the tracks that hold groups."""
    assert scene.motion is not None
    ids = _ids_of(scene, groups)
    return sorted({float(t) for track in scene.motion.tracks if np.isin(ids, track.ids).any() for t in track.times})


def _ids_of(scene: Scene, groups: tuple[int, ...]) -> NDArray[np.int64]:
    """The ids `[M]` of the Gaussians of groups."""
    assert scene.language is not None
    leaves = torch.tensor([i for g in groups for i in scene.language.leaves(g)], dtype=torch.int32)
    return np.asarray(scene.cloud.ids[torch.isin(scene.cloud.group.cpu(), leaves)].cpu().numpy())


def _snapped(time: float, edges: list[float]) -> float:
    nearest = min(edges, key=lambda t: abs(t - time), default=time)
    return nearest if abs(nearest - time) <= _ROUGH else time


def _own(course: Course, during: During, frame: Frame) -> list[Span]:
    """When a thing turns (about the vertical, if it ever does), or is away from where it is at the start, or goes away
    or comes back."""
    from ...gaussians.motion.events import movements
    from ...gaussians.motion.holding import spans

    times, state, unit = course.grid(), during.state, 1.0 / (frame.metres_per_unit or 1.0)
    if state == "turning":
        upright = spans(lambda t: np.abs(course.turns(t) @ course.up), times, _TURNS)
        return upright or spans(lambda t: np.linalg.norm(course.turns(t), axis=1), times, _TURNS)
    if state == "halfway":
        begun = ((_gone(course, span, during, frame), span[1]) for span in movements(course, unit))
        return [(start, stop) for start, stop in begun if start is not None]
    first = course.centers(np.array([course.start]))
    if state in ("opening", "closing"):
        return _going(course, first, 1.0 if state == "opening" else -1.0, unit)
    if state == "fully_open":
        far = np.linalg.norm(course.centers(times) - first, axis=1)
        if float(far.max()) < _AWAY * unit:
            return []
        return spans(lambda t: np.linalg.norm(course.centers(t) - first, axis=1), times, _WIDE * float(far.max()))
    return spans(lambda t: np.linalg.norm(course.centers(t) - first, axis=1), times, _AWAY * unit)


def _gone(course: Course, span: Span, during: During, frame: Frame) -> float | None:
    """When a thing has gone half a movement, or turned by half its angle, or as much as is told; None if it never
    does."""
    times = course.grid(span)
    rates, wanted = course.rates(times), None
    if during.degrees is not None:
        rates, wanted = np.linalg.norm(course.turns(times), axis=1), math.radians(during.degrees)
    elif during.distance is not None:
        rates, wanted = np.linalg.norm(course.velocities(times), axis=1), during.distance.in_units(frame)
    steps = (rates[1:] + rates[:-1]) / 2 * np.diff(times)
    gone = np.concatenate([[0.0], np.cumsum(steps)])
    if wanted is None:
        wanted = float(gone[-1]) * (0.5 if during.share is None else during.share)
    return float(np.interp(wanted, gone, times)) if wanted < gone[-1] else None


def _going(course: Course, first: NDArray[np.float64], sign: float, unit: float) -> list[Span]:
    """When a thing goes away from `first` (sign 1), or comes nearer to it (sign -1), by more than a trifle."""
    from ...gaussians.motion.holding import joined, spans

    def away(t: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(np.linalg.norm(course.centers(t) - first, axis=1))

    def speed(t: NDArray[np.float64]) -> NDArray[np.float64]:
        return sign * (away(t + _SOON) - away(t - _SOON)) / (2 * _SOON)

    times = course.grid()
    fastest = float(np.abs(speed(times)).max(initial=0.0))
    found = joined(spans(speed, times, _SLOW * fastest), _APART) if fastest > 0 else []
    return [s for s in found if sign * float(np.diff(away(np.array(s)))[0]) > _AWAY * unit]


def _touching(scene: Scene, group: int, anchor: int, unit: float) -> list[Span]:
    """When a thing touches another; where it never does, when it is as near as it comes, if it moves there."""
    from ...gaussians.motion.events import Encounter
    from ...gaussians.motion.holding import lowest, spans

    pair = Encounter.of(scene, group, (anchor,))
    if pair.touching:
        return pair.touching
    course = pair.course
    time = lowest(pair.gaps, course.start, course.stop)
    least = float(pair.gaps(np.array([time]))[0])
    first = float(pair.gaps(np.array([course.start]))[0])
    if least > _REACHED * unit or first - least < _AWAY * unit:
        return []
    return spans(lambda t: -pair.gaps(t), course.grid(), -least - 0.005 * unit)


def comes_to(scene: Scene, group: int, goal: Query, context: Context) -> bool:
    """Whether a thing that moves ends beside another, so that it goes there by itself."""
    from ...gaussians.motion.events import Encounter

    if scene.motion is None:
        return False
    unit, last = 1.0 / (scene.frame.metres_per_unit or 1.0), np.array([scene.motion.start, scene.motion.stop])
    for anchor in _groups(_meant(scene, goal, context), scene):
        first, gap = (float(g) for g in Encounter.of(scene, group, (anchor,)).gaps(last))
        if gap <= _REACHED * unit and first - gap > _AWAY * unit:
            return True
    return False


def _rest(found: list[Span], start: float, stop: float) -> list[Span]:
    """What the spans leave of a time from start to stop."""
    bounds = [start, *(t for span in found for t in span), stop]
    return [(a, b) for a, b in zip(bounds[::2], bounds[1::2], strict=True) if a < b]


_SEVERAL = ("wall", "walls", "floor", "ground", "ceiling")


def _meant(scene: Scene, query: Query, context: Context) -> Selection:
    all_of_it = query.model_copy(update={"pick": "all"}) if _is_several(query) else query
    return moving_one(scene, all_of_it, context).require()


def _is_several(query: Query) -> bool:
    """Whether a query for one thing means several: "the wall"."""
    return query.text in _SEVERAL and query.pick == "one" and not query.relations


def _anchor(scene: Scene, query: Query, context: Context, during: During, target: Selection) -> Selection:
    """What a query for another thing means; of several the one with which it is ever so: "when the book leaves the
    shelf" is about the shelf on which it stands."""
    found = context.resolve(scene, query)
    if found.verdict != "ambiguous" and not _is_several(query):
        return found.require()
    if found.verdict != "ambiguous" or query.pick != "one" or len(during.anchors) > 1 or during.state == "closest":
        return _meant(scene, query, context)
    fits = list[Selection]()
    for candidate in found.candidates:
        one = context.resolve(scene, Query(text=query.text, groups=(candidate.group,)))
        alone = during.model_copy(update={"anchors": (one.query,)})
        if one.chosen and _happening(alone, scene, target, context):
            fits.append(one)
    return fits[0] if len(fits) == 1 else _meant(scene, query, context)


def moving_one(scene: Scene, query: Query, context: Context, moves: bool = False) -> Selection:
    """What a query means where time is spoken of: of several things that it may mean, the one that moves.

    Args:
        moves: whether only what moves can be meant, as of a change of how it moves: where what is named stands still,
            or is not found as a part of something, the one thing that moves and has the same noun is meant.
    """
    found = context.resolve(scene, query)
    plain = query.pick == "one" and query.moving is None  # "the middle drawer" is not the one that moves
    if scene.motion is None or not plain:
        return found
    if found.verdict == "ambiguous":
        return _that_moves(scene, query, context) or found
    if not moves or (found.chosen and np.isin(moving_ids(scene.motion), found.ids.cpu().numpy()).any()):
        return found
    whole = tuple(relation for relation in query.relations if relation.name != "part_of")
    for looser in dict.fromkeys((query, query.model_copy(update={"relations": whole}))):
        if (other := _that_moves(scene, looser, context)) is not None and other.verdict == "found":
            return other
    return found


def _that_moves(scene: Scene, query: Query, context: Context) -> Selection | None:
    """The one thing that a query means and that moves; None if there is none, or several."""
    found = context.resolve(scene, query.model_copy(update={"moving": True}))
    return found if found.chosen else None


def _groups(found: Selection, scene: Scene) -> tuple[int, ...]:
    if not found.groups:
        raise InstructionError(f"{found.query.describe()} is no thing of its own, so that its way cannot be followed")
    return found.groups
