"""When a body does something: spans of the scene's time for each kind of deed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ....gaussians.motion import events
from ....gaussians.motion.events import Encounter
from ....gaussians.motion.holding import Span, joined, lowest, rest, spans
from ...grammar.vocabulary.nouns import is_opened
from ..reading.time.deeds import Deed, Kind
from ..survey import Survey, Thing
from .bodies import Body, Timeline
from .worn import hiding, recoloring

F64 = NDArray[np.float64]
TURNS = np.radians(20.0)  # a body that turns by less about the vertical while it goes makes no turn
_TURNING = np.radians(15.0)  # radians a second from which it turns
_YAWS = {"left": 1, "right": -1, "course": 0}  # a change of the way it goes, and to which side
_STRAIGHT = 0.97  # of a way: one whose ends are so far apart is straight
_SHARES = {"quarter": 0.25, "half": 0.5}  # of how far it opens
_HOME = 0.02  # metres, and of a turn radians times the farthest corner: so near to where it started it is back
AJAR, WIDE = 0.02, 0.985  # of how far it opens: open from the one, wide open from the other
BESIDE = 0.3  # metres: a thing that stops so near to another has reached it
_CLOSER = 0.1  # metres by which it must have come nearer
_ABOUT = 1e-6
_PACE = 1.25  # times: one speed is clearly more than another
MOMENT = 0.1  # seconds: a speed at a moment is the mean over them, since keys of a motion are as far apart
STEP = MOMENT / 10
_PASSES = 1.5  # metres: a thing farther away is not passed


def spans_of(deed: Deed, body: Body, others: Sequence[Thing], timeline: Timeline, survey: Survey) -> list[Span] | None:
    """The spans in which a body does something; None where that cannot be told of it.

    What happens at once has spans of no length, or the span that it begins: having reached the wall, being on the rug.

    Args:
        others: what it does it to; of several, any.
    """
    kind, moving = deed.kind, list(body.moving)
    if kind == "scene":
        return [(timeline.start, timeline.stop)]
    if kind == "move":
        return _going(deed.way, body, timeline) if deed.way else moving
    if kind == "still":
        return rest(moving, timeline.start, timeline.stop) if moving else [(timeline.start, timeline.stop)]
    if kind == "turn":
        if deed.way not in _YAWS:
            return turning(body)
        sign = _YAWS[deed.way]
        yaws = [(s, events.yawed(body.course, s)) for s in turning(body)]
        return [s for s, yaw in yaws if abs(yaw) > TURNS and yaw * sign >= 0]
    if kind == "fall":
        falls = events.falls(body.course, timeline.unit)
        return [s for s in falls if is_near(body, others, timeline, s[0])] if others else falls
    if kind == "rise":
        return _going("up", body, timeline)
    if kind in ("slows", "speeds_up"):
        return [s for s in moving if _changes_pace(body, s) * (1 if kind == "speeds_up" else -1) > 0]
    if kind == "bob":
        return moving if bobs(body) > 0.005 * timeline.unit else []
    if kind in ("return", "is_back"):
        return _back(deed, body, timeline)
    if kind in ("open", "close", "is_open", "is_closed"):
        return _opening(deed, body, timeline)
    if kind in ("appear", "vanish", "recolor"):
        return _seen(kind, body, timeline)
    if kind == "land":
        others = others or tuple(survey.at(survey.stage.ids.index("floor")) for _ in range("floor" in survey.stage.ids))
        falls = events.falls(body.course, timeline.unit)
        return [s for s in _reached(body, others, timeline) if any(a < s[0] <= b + 0.3 for a, b in falls)]
    if not others:
        return None
    if kind in ("reach", "enter"):
        return _reached(body, others, timeline)
    if kind == "leave":
        return _left(body, others, timeline)
    if kind == "cross":
        return [s for s in _related("on", body, others, timeline) if s[0] > timeline.start or s[1] < timeline.stop]
    if kind == "pass":
        return _passed(body, others, timeline)
    if kind in ("nearest", "farthest"):
        return _extreme(kind == "nearest", body, others, timeline)
    if kind in ("approach", "recede"):
        return _nearing(kind == "approach", body, others, timeline)
    if kind == "related":
        return _related(deed.relation, body, others, timeline)
    return None


def _going(way: str, body: Body, timeline: Timeline) -> list[Span] | None:
    """The movements in which a body goes to one side of the viewer, or up; None for a way that needs its own front."""
    if way == "straight":
        course = body.course
        ways = [
            (s, events.path_length(course, s), float(np.linalg.norm(events.displacement(course, s))))
            for s in body.moving
        ]
        return [s for s, path, straight in ways if straight > _STRAIGHT * path > 0]
    stand = timeline.stand
    sides = {
        "left": -stand.right, "right": stand.right, "up": stand.up, "toward": -stand.forward, "away": stand.forward,
    }  # fmt: skip
    if way not in sides:
        return None
    far = {s: float(events.displacement(body.course, s) @ sides[way]) for s in body.moving}
    return [s for s in body.moving if far[s] > 0.3 * float(np.linalg.norm(events.displacement(body.course, s))) > 0]


def turning(body: Body) -> list[Span]:
    """The spans in which a body turns: of what goes along a way, in which it changes its direction; of what turns in
    its place or on a hinge, in which it moves."""
    course = body.course
    if not body.moving:
        return []
    yaw = sum(abs(events.yawed(course, s)) for s in body.moving)
    way = sum(events.path_length(course, s) for s in body.moving)
    goes = way > 0.5 * max(body.group.box.size) and float(np.linalg.norm(events.displacement(course))) > 0.3 * way
    if yaw < TURNS:
        return list(body.moving) if events.turned(course) > TURNS else []
    if not goes or course.moving is None or any(t.kind in ("hinge", "spin") for t in course.moving.tracks[:1]):
        return list(body.moving)

    def rate(times: F64) -> F64:
        return np.asarray(np.abs(course.turns(times) @ course.up))

    found = joined(spans(rate, course.grid(), _TURNING, 0.5 * _TURNING), events.PAUSE)
    return [s for s in found if abs(events.yawed(course, s)) >= TURNS]


def _changes_pace(body: Body, span: Span) -> int:
    """1 where the last third of a movement is clearly faster than the first, -1 where it is slower, else 0."""
    a, b = span
    third = (b - a) / 3
    early, late = (float(np.mean(body.course.rates(body.course.grid(s)))) for s in ((a, a + third), (b - third, b)))
    return 1 if late > _PACE * early else -1 if early > _PACE * late else 0


def peak(body: Body, span: Span) -> tuple[float, float]:
    """The greatest speed in a span, scene units a second, as a mean over `MOMENT`; and when that is."""
    times = body.course.grid(span, STEP)
    count = min(round(MOMENT / STEP), len(times))
    means = np.convolve(events.speeds(body.course, times), np.full(count, 1 / count), "valid")
    at_most = int(np.argmax(means))
    return float(means[at_most]), float(times[at_most + count // 2])


def bobs(body: Body) -> float:
    """How far a body goes up and down while it moves along, scene units: the largest swing of its height."""
    times = body.course.grid()
    heights = body.course.centers(times) @ body.course.up
    trend = np.interp(times, [times[0], times[-1]], [heights[0], heights[-1]])
    level = heights - trend
    changes = np.flatnonzero(np.diff(np.sign(np.diff(level))) != 0)
    return float(np.ptp(level)) if len(changes) >= 2 else 0.0


def steps(body: Body) -> F64:
    """`[S]` times at which a body that bobs as it moves along is highest: one of each step."""
    least = bobs(body) / 3
    times = np.concatenate([body.course.grid(s) for s in body.moving]) if body.moving and least else np.zeros(0)
    heights = body.course.centers(times) @ body.course.up if len(times) else times
    found, low, top = list[float](), np.inf, -np.inf
    for time, height in zip(times, heights, strict=True):
        if height > low + least and height > top:
            top, highest = height, time
        elif top > -np.inf and height < top - least:
            found.append(float(highest))
            low, top = height, -np.inf
        low = min(low, height)
    return np.array(found)


# -- doors, drawers and lids -----------------------------------------------------------------------------------------


def openness(body: Body, timeline: Timeline) -> tuple[F64, F64, float]:
    """Times `[T]`, how far it is open then `[T]` (radians of a hinge, scene units of what slides), and the most of it.

    Things open away from the pose in which they are flush: of a hinge the pose in line with a wall, of a slide the one
    that reaches out least from what it is a part of; where neither tells, the pose at the start is the closed one.
    """
    times = body.course.grid()
    away = opened(body, times)
    if _starts_open(body, timeline):
        away = float(away.max()) - away
    return times, away, float(away.max())


def opened(body: Body, times: F64) -> F64:
    """`[T]` how far it is from its pose at the start: radians for what turns, scene units for what slides."""
    angles = body.course.angles(times)
    if float(body.course.angles(body.course.grid()).max()) > np.radians(3.0):
        return angles
    start = body.course.centers(np.array([body.course.start]))
    return np.asarray(np.linalg.norm(body.course.centers(times) - start, axis=1))


def hinged(body: Body) -> bool:
    """Whether it turns on a hinge; else it slides."""
    return float(body.course.angles(body.course.grid()).max()) > np.radians(3.0)


def _starts_open(body: Body, timeline: Timeline) -> bool:
    """Whether the pose at the start is the open one: it reaches out farther than the pose farthest from it."""
    course = body.course
    times = course.grid()
    far = times[int(np.argmax(opened(body, times)))]
    ends = np.array([course.start, far])
    if hinged(body):
        axes = course.boxes(ends).axes
        sizes = course.boxes(ends).sizes
        walls = [g.box for g in timeline.scene.language.groups if g.level == "structure" and g.label == "wall"]  # type: ignore[union-attr]
        if not walls:
            return False
        off = []
        for k in range(2):
            thin = axes[k, int(np.argmin(sizes[k, :2]))]
            normals = [np.array(w.axes[int(np.argmin(w.size[:2]))]) for w in walls]
            off.append(min(float(np.degrees(np.arccos(min(1.0, abs(float(thin @ n)))))) for n in normals))
        return off[0] > off[1] + 10
    if body.thing is None or body.thing.id == body.group.id:
        return False
    whole = np.array(timeline.scene.language.groups[int(body.thing.id)].box.center)  # type: ignore[union-attr]
    apart = np.linalg.norm(course.centers(ends) - whole, axis=1)
    return bool(apart[0] > apart[1] + 0.02 * timeline.unit)


_RATE = 30  # looks a second at which way something goes


def _strokes(value: Callable[[F64], F64], span: Span) -> list[Span]:
    """The parts of a movement in which a value only grows or only falls: a door may close as soon as it is open."""
    times = np.linspace(*span, max(int((span[1] - span[0]) * _RATE), 1) + 1)
    ways = np.sign(np.round(np.diff(value(times)), 4))
    turns = [at for at in range(1, len(ways)) if ways[at] * ways[at - 1] <= 0 and ways[at] != ways[at - 1]]
    ends = [0, *turns, len(ways)]
    return [(float(times[a]), float(times[b])) for a, b in pairwise(ends) if ways[a] != 0]


def _opening(deed: Deed, body: Body, timeline: Timeline) -> list[Span] | None:
    if not body.moving:  # what opens, and never moves, is shut
        if body.thing is None or not is_opened(body.thing.label):
            return None
        return [(timeline.start, timeline.stop)] if deed.kind == "is_closed" else []
    times, _, most = openness(body, timeline)
    if most < _ABOUT:
        return None
    starts_open = _starts_open(body, timeline)

    def value(at: F64) -> F64:
        moved = opened(body, at)
        return (float(opened(body, times).max()) - moved if starts_open else moved) / most

    if deed.kind in ("open", "close"):
        sign = 1 if deed.kind == "open" else -1
        strokes = (stroke for span in body.moving for stroke in _strokes(value, span))
        return [(a, b) for a, b in strokes if sign * float(np.diff(value(np.array([a, b])))[0]) > 0.2]
    if deed.kind == "is_closed":
        return spans(lambda t: -value(t), times, -AJAR)
    if deed.phase in _SHARES:
        crossed = [t for s in spans(value, times, _SHARES[deed.phase]) for t in s]
        return [(t, t) for t in crossed if timeline.start < t < timeline.stop]
    return spans(value, times, WIDE if deed.phase == "full" else AJAR)


def _back(deed: Deed, body: Body, timeline: Timeline) -> list[Span] | None:
    """The spans in which it goes back to where it started, or is there again after it was away."""
    if not body.moving:
        return []
    kinds = {t.kind for t in body.course.moving.tracks} if body.course.moving is not None else set()
    if kinds & {"hinge", "slide"}:
        kind: Kind = "close" if deed.kind == "return" else "is_closed"
        found = _opening(Deed(kind), body, timeline) or []
        return [s for s in found if s[0] > timeline.start + _ABOUT]
    first = body.course.centers(np.array([timeline.start]))[0]

    def near(times: F64) -> F64:
        return np.asarray(-np.linalg.norm(body.course.centers(times) - first, axis=1))

    there = [s for s in spans(near, body.course.grid(), -_HOME * timeline.unit) if s[0] > timeline.start + _ABOUT]
    if deed.kind == "is_back" or events.path_length(body.course) < _HOME * timeline.unit:
        return there if deed.kind == "is_back" else []
    return [m for m in body.moving if any(m[0] < s[0] <= m[1] + _ABOUT for s in there)]


# -- other things ----------------------------------------------------------------------------------------------------


def _encounters(body: Body, others: Sequence[Thing], timeline: Timeline) -> list[Encounter]:
    ids = dict.fromkeys(g for thing in others for g in timeline.groups(thing) if g != body.group.id)
    return [Encounter.of(timeline.scene, body.group.id, [g]) for g in ids]


def _reached(body: Body, others: Sequence[Thing], timeline: Timeline) -> list[Span]:
    """From when on it touches one of the others, or stands beside it after it came nearer."""
    pairs = _encounters(body, others, timeline)
    found = [s for p in pairs for s in p.touching if s[0] > timeline.start + _ABOUT]
    if found:
        return sorted(_merged(found))
    beside = []
    for pair in pairs:
        for a, b in body.moving:
            before, after = (float(g) for g in pair.gaps(np.array([a, b])))
            if after <= BESIDE * timeline.unit and before - after > _CLOSER * timeline.unit:
                beside.append((b, timeline.stop))
    return sorted(beside)


def is_near(body: Body, others: Sequence[Thing], timeline: Timeline, time: float) -> bool:
    """Whether it is at one of the others at a time."""
    gaps = [float(p.gaps(np.array([time]))[0]) for p in _encounters(body, others, timeline)]
    return bool(gaps) and min(gaps) < BESIDE * timeline.unit


def _merged(found: list[Span]) -> list[Span]:
    """Spans that overlap as one."""
    kept: list[Span] = []
    for start, stop in sorted(found):
        if kept and start <= kept[-1][1]:
            kept[-1] = (kept[-1][0], max(stop, kept[-1][1]))
        else:
            kept.append((start, stop))
    return kept


def _left(body: Body, others: Sequence[Thing], timeline: Timeline) -> list[Span]:
    """The times at which it is no longer on, in or at one of the others."""
    found = list[Span]()
    for pair in _encounters(body, others, timeline):
        held = pair.holding("on", timeline.stand) or pair.touching
        ends = [b for _, b in held if b < timeline.stop - _ABOUT]
        if not held and body.moving:  # it stood beside it
            gap, later = (float(g) for g in pair.gaps(np.array(body.moving[0])))
            ends = (
                [body.moving[0][0]]
                if gap <= 2 * BESIDE * timeline.unit and later > gap + _CLOSER * timeline.unit
                else []
            )
        found += [(t, t) for t in ends]
    return sorted(found)


def _related(relation: str, body: Body, others: Sequence[Thing], timeline: Timeline) -> list[Span]:
    pairs = _encounters(body, others, timeline)
    if relation == "touches":
        return _merged([s for p in pairs for s in p.touching])
    return _merged([s for p in pairs for s in p.holding(relation, timeline.stand)])


def _passed(body: Body, others: Sequence[Thing], timeline: Timeline) -> list[Span]:
    """The times at which it is nearest to one of the others, on its way."""
    found = list[Span]()
    for pair in _encounters(body, others, timeline):
        for a, b in body.moving:
            time, gap = events.nearest_time(timeline.scene, body.group.id, pair.rows[0].id, (a, b))
            if a + 0.05 < time < b - 0.05 and gap < _PASSES * timeline.unit:
                found.append((time, time))
    return sorted(found)


def _extreme(near: bool, body: Body, others: Sequence[Thing], timeline: Timeline) -> list[Span]:
    """The time at which it is nearest to one of the others, or farthest from all."""
    pairs = _encounters(body, others, timeline)
    if not pairs or not body.moving:
        return []

    def gap(times: F64) -> F64:
        gaps = np.stack([p.gaps(times) for p in pairs])
        return np.asarray(gaps.min(axis=0) if near else -gaps.max(axis=0))

    time = lowest(gap, timeline.start, timeline.stop)
    return [(time, time)]


def first_near(body: Body, others: Sequence[Thing], timeline: Timeline) -> float:
    """The time at which a body first is at one of the others; where it never gets so near, when it is nearest."""
    pairs = _encounters(body, others, timeline)
    if not pairs:
        return timeline.stop
    times = body.course.grid()
    gaps = np.stack([p.gaps(times) for p in pairs]).min(axis=0)
    near = np.flatnonzero(gaps <= BESIDE * timeline.unit)
    return float(times[near[0] if len(near) else int(np.argmin(gaps))])


def _nearing(closer: bool, body: Body, others: Sequence[Thing], timeline: Timeline) -> list[Span]:
    """The spans in which the gap to the others gets smaller, or larger."""
    found = list[Span]()
    for pair in _encounters(body, others, timeline):
        for a, b in body.moving or ():
            before, after = (float(g) for g in pair.gaps(np.array([a, b])))
            if (before - after if closer else after - before) > 0.2 * _CLOSER * timeline.unit:
                found.append((a, b))
    return sorted(found)


def _seen(kind: str, body: Body, timeline: Timeline) -> list[Span]:
    """The times at which most of it disappears, appears again, or gets another colour."""
    if kind == "recolor":
        worn = recoloring(timeline, body.group.id)
        return [(t, t) for look in worn for t in (look.start, look.stop) if timeline.start < t < timeline.stop]
    ends = [look.start if kind == "vanish" else look.stop for look in hiding(timeline, body.group.id)]
    return [(t, t) for t in sorted(ends) if timeline.start <= t < timeline.stop]
