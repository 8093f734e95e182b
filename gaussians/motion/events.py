"""What happens in a scene with time: when relations hold, when things move, turn, fall and touch, how far and how fast.

`intervals` tells when a relation of a group to others holds; the other functions measure a `Course`. Ends of spans are
exact to a millisecond. Lengths are scene units, unless a name says metres.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..errors import UserError
from ..language.field.language_field import Group
from ..scene import Scene
from ..world import relations
from ..world.box import Boxes, distances
from ..world.relation_geometry import HOLDS, Stand, Things, viewer_stand
from ..world.support import is_sheet
from .courses import Course, course_of
from .holding import Span, Value, common, grid, joined, lowest, rest, spans

F64 = NDArray[np.float64]

TOUCHES = 0.04  # metres: gap up to which measured boxes may touch
SLIP = 0.006  # metres: more than the least gap of an encounter, and the things do not touch any more
LOOSE = 0.94  # of the score from which a relation holds: the hysteresis of its spans
LET_GO = 0.02  # metres: a gap up to which two encounters are one
_JUMP = 8.0  # times the usual speed: what is faster jumps, and tells nothing of how fast a thing moves
PAUSE = 0.15  # seconds: shorter rests are no stop
STILL = 0.004  # metres a second: a thing whose fastest corner is slower stands still
_SLOW = 0.02  # of the fastest speed: slower is still, so that smooth starts count from where they can be seen
_JITTER = 0.008  # metres of way, of the fastest corner, under which a movement is noise of a fit
_DROP = 0.08  # metres that a thing sinks, at least, to have fallen
_STEEP = 0.7  # of the way: what sinks by less rolls or slides
_TIPPED = math.radians(60)  # from the vertical: what leans by less has not tipped over
_LEVEL = 0.12  # of the way in plan: less up and down than this is a bobbing walk, whose way is that in plan
_OWN = ("touches", "moving", "still")


def intervals(
    scene: Scene, group: int, relation: str, anchors: Sequence[int] = (), stand: Stand | None = None
) -> list[Span]:
    """The spans of the scene's time in which a relation of a group to others holds, in order, seconds.

    What a relation needs is its name in `world/relations` ("on", "inside", "next_to", "left_of", ...), "touches", or
    "moving" and "still", which need no anchor. In a scene without motion it holds from 0 to 0, or never.

    Args:
        group: id of a group.
        anchors: ids of the anchors: an object, a floor, a wall, the ceiling; things that move count where they are.
        stand: whose left and right are meant; None: those of the scene's first camera.

    Raises:
        UserError: the scene has no language field, the relation is unknown or needs another number of anchors.
    """
    if scene.language is None:
        raise UserError("the scene has no language field yet; run `scenewright embed` on it first")
    course = course_of(scene, group)
    if relation in ("moving", "still"):
        moving = movements(course, _unit(scene))
        if relation == "moving":
            return moving
        return rest(moving, course.start, course.stop) if moving else [(course.start, course.stop)]
    needed = 1 if relation == "touches" else relations.named(relation).anchors if _is_known(relation) else -1
    if needed < 0 or len(anchors) != needed:
        wants = (
            f"needs {needed} of them" if needed >= 0 else f"is none of {', '.join((*relations.names('query'), *_OWN))}"
        )
        raise UserError(
            f"the relation {relation!r} to {len(anchors)} things cannot be followed through time: it {wants}"
        )
    pair = Encounter.of(scene, group, anchors)
    return pair.touching if relation == "touches" else pair.holding(relation, stand or default_stand(scene))


def _is_known(relation: str) -> bool:
    return relation in relations.names("query") and relations.named(relation).score is not None


def default_stand(scene: Scene) -> Stand:
    """The frame of left and right of the scene's first camera, or east and north if it has none."""
    assert scene.language is not None
    up, scale, middle = scene.frame.up_vector, scene.language.typical_size, scene.language.middle
    if scene.cameras:
        return viewer_stand(scene.cameras[0], up, scale, middle)
    east, north, _ = scene.frame.basis()
    return Stand(east, north, up, middle - north, scale, middle=middle)


@dataclass(frozen=True, eq=False)
class Encounter:
    """A group and its anchors through the time of a scene.

    Attributes:
        course: of the group.
        others: of the anchors.
        rows: the anchors' rows of the table.
        unit: scene units of a metre.
        inward: `[3]` a point of the room, from which walls are seen.
        floor: height of the floor along up, None if unknown.
    """

    course: Course
    others: tuple[Course, ...]
    rows: tuple[Group, ...]
    unit: float
    inward: F64
    floor: float | None

    @classmethod
    def of(cls, scene: Scene, group: int, anchors: Sequence[int]) -> Encounter:
        """The encounter of groups of an embedded scene."""
        assert scene.language is not None
        rows = tuple(scene.language.groups[a] for a in anchors)
        others = tuple(course_of(scene, a) for a in anchors)
        return cls(course_of(scene, group), others, rows, _unit(scene), scene.language.middle, scene.frame.floor)

    def gaps(self, times: F64) -> F64:
        """`[T]` signed gap to the first anchor: between surfaces, negative by the depth of penetration.

        To a floor, wall or ceiling it is that to its plane.
        """
        boxes, anchor = self.course.boxes(times), self.others[0].boxes(times)
        if self.rows[0].level == "structure":
            return self._plane_gaps(boxes, anchor)
        return signed_gaps(boxes, anchor)

    @cached_property
    def near(self) -> list[Span]:
        """The spans in which the two may touch, as exact as measured boxes are."""
        return self._spans(lambda t: -self.gaps(t), -TOUCHES * self.unit, -(TOUCHES + LET_GO) * self.unit)

    @cached_property
    def touching(self) -> list[Span]:
        """The spans in which the two touch.

        Measured boxes are not exact: in each span in which the two are near, they touch where the gap is the least of
        that span, or they overlap.
        """
        found = list[Span]()
        for start, stop in self.near:
            times = grid(start, stop)
            least = float(self.gaps(np.array([lowest(self.gaps, start, stop)]))[0])
            level = max(least, 0.0) + SLIP * self.unit
            found += spans(lambda t: -self.gaps(t), times, -level, -level - LET_GO * self.unit)
        return found

    def holding(self, relation: str, stand: Stand) -> list[Span]:
        """The spans in which a relation of `world/relations` holds.

        A thing is on a floor or wall that it touches, and on a sheet (a rug) that its middle is over.
        """
        if relation == "on" and self.rows[0].level == "structure":
            return self.touching
        if relation == "on" and is_sheet(self.rows[0].box.size):
            over = self._spans(self._inside, 0.0, -0.1 * TOUCHES * self.unit)
            return common(over, self.near)
        measure = relations.named(relation).score
        assert measure is not None

        def value(times: F64) -> F64:
            own = Things(self.course.boxes(times), np.zeros(len(times), bool))
            parties = [
                Things(c.boxes(times), np.full(len(times), row.level == "structure"), row.label == "wall")
                for c, row in zip(self.others, self.rows, strict=True)
            ]
            return np.asarray(measure(own, parties, stand))

        found = self._spans(value, HOLDS, LOOSE * HOLDS)
        if relation == "on":  # a book is on the floor when it has arrived there, not a hand's breadth above it
            found = common(found, self.near) or found  # measured boxes may leave a gap
        return found

    def _inside(self, times: F64) -> F64:
        """`[T]` how far the middle is within the footprint of the first anchor; negative outside it."""
        anchor = self.others[0].boxes(times)
        local = np.abs(anchor.local(self.course.boxes(times).centers[:, None])[:, 0, :2])
        return np.asarray((anchor.sizes[:, :2] / 2 - local).min(axis=1))

    def _spans(self, value: Value, hold: float, release: float) -> list[Span]:
        return spans(value, self.course.grid(), hold, release)

    def _plane_gaps(self, boxes: Boxes, anchor: Boxes) -> F64:
        """`[T]` signed gaps to a floor, wall or ceiling; a wall of several sides is one around the room."""
        up = self.course.up
        low, high = boxes.heights(up)
        base, top = anchor.heights(up)
        if self.rows[0].label in ("floor", "ground", "terrain"):
            return low - (np.maximum(top, self.floor) if self.floor is not None else top)
        if self.rows[0].label == "ceiling":
            return base - high
        sizes = anchor.sizes[:, :2]
        thin = np.argmin(sizes, axis=1)
        if float(sizes.min()) > 0.5 * float(sizes.max()):  # all walls as one group: the nearest of its sides
            local = np.abs(anchor.local(boxes.spread(_CORNERS))[..., :2])
            return np.asarray((anchor.sizes[:, None, :2] / 2 - local).min(axis=(1, 2)))
        out = np.take_along_axis(anchor.axes, thin[:, None, None], axis=1)[:, 0]  # [T, 3] normal of the wall
        inward = np.sign(((self.inward - anchor.centers) * out).sum(axis=1))[:, None] * out
        reach = (np.abs((boxes.axes * inward[:, None]).sum(axis=2)) * boxes.sizes).sum(axis=1) / 2
        plane = ((boxes.centers - anchor.centers) * inward).sum(axis=1) - reach - sizes.min(axis=1) / 2
        return np.where(self._is_beside(boxes, anchor), plane, np.maximum(plane, distances(boxes, anchor)))

    @staticmethod
    def _is_beside(boxes: Boxes, anchor: Boxes) -> NDArray[np.bool_]:
        """`[T]` whether a box is in front of some part of a wall's long side."""
        wide = np.argmax(anchor.sizes[:, :2], axis=1)
        along = np.take_along_axis(anchor.axes, wide[:, None, None], axis=1)[:, 0]
        half = (np.abs((boxes.axes * along[:, None]).sum(axis=2)) * boxes.sizes).sum(axis=1) / 2
        off = np.abs(((boxes.centers - anchor.centers) * along).sum(axis=1))
        return np.asarray(off <= half + anchor.sizes[:, :2].max(axis=1) / 2)


_CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])


def signed_gaps(boxes: Boxes, anchor: Boxes) -> F64:
    """`[T]` gaps between the surfaces of boxes and of the anchors `[T]`; minus the depth of penetration in overlap."""
    axes = np.concatenate([anchor.axes, boxes.axes[:, :2]], axis=1)  # [T, 5, 3]
    way = np.abs((axes * (boxes.centers - anchor.centers)[:, None]).sum(axis=2))
    halves = [(np.abs(axes @ b.axes.transpose(0, 2, 1)) * b.sizes[:, None]).sum(axis=2) / 2 for b in (boxes, anchor)]
    apart = (way - halves[0] - halves[1]).max(axis=1)
    return np.where(apart > 0, distances(boxes, anchor), apart)


# -- one group -------------------------------------------------------------------------------------------------------


def movements(course: Course, unit: float = 1.0) -> list[Span]:
    """The spans in which a group, or a part of it, moves or turns; a rest shorter than `PAUSE` does not end one.

    Args:
        unit: scene units of a metre.
    """
    if course.moving is None:
        return []
    times = course.grid()
    rates = course.rates(times)
    fastest = float(rates.max())
    if fastest < STILL * unit:
        return []
    fastest = min(fastest, _JUMP * float(np.median(rates[rates >= STILL * unit])))
    level = max(STILL * unit, _SLOW * fastest)
    found = joined(spans(course.rates, times, level, 0.5 * level), PAUSE)
    return [s for s in found if _swept(course, s) > _JITTER * unit]


def falls(course: Course, unit: float = 1.0) -> list[Span]:
    """The spans in which a group falls: it sinks, and more than it moves to the side; or it tips over, and lies lower
    then than it stood."""
    if not course.moves:
        return []
    times = course.grid()

    def sinking(at: F64) -> F64:
        return np.asarray(-course.velocities(at) @ course.up)

    fastest = float(sinking(times).max())
    level = max(STILL * unit, _SLOW * fastest)
    found = joined(spans(sinking, times, level, 0.5 * level), PAUSE / 3)
    found = [s for s in found if _drop(course, s) > max(_DROP * unit, _STEEP * _way(course, s))]
    tipped = [s for s in movements(course, unit) if _tilt(course, s) > _TIPPED and _drop(course, s) > _DROP * unit]
    return sorted([*found, *(s for s in tipped if not any(s[0] < b and a < s[1] for a, b in found))])


def path_length(course: Course, span: Span | None = None) -> float:
    """The length of the way of a group's middle in a span; of a walk that bobs, of its way in plan."""
    points = course.centers(course.grid(span))
    heights = points @ course.up
    plan = points - heights[:, None] * course.up
    level = float(np.linalg.norm(np.diff(plan, axis=0), axis=1).sum())
    if float(np.ptp(heights)) < _LEVEL * level:
        return level
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def displacement(course: Course, span: Span | None = None) -> F64:
    """`[3]` from where a group's middle is at the start of a span to where it is at its end."""
    start, stop = span or (course.start, course.stop)
    before, after = course.centers(np.array([start, stop]))
    return np.asarray(after - before)


def turned(course: Course, span: Span | None = None) -> float:
    """Radians that a group turns in a span, all turns added, to and fro."""
    times = course.grid(span, 1 / 240)
    rates = np.linalg.norm(course.turns(times), axis=1)
    return float(np.sum((rates[1:] + rates[:-1]) / 2 * np.diff(times)))


def yawed(course: Course, span: Span | None = None) -> float:
    """Radians that a group turns about the vertical in a span, to the left (counter-clockwise from above) positive."""
    times = course.grid(span, 1 / 240)
    rates = course.turns(times) @ course.up
    return float(np.sum((rates[1:] + rates[:-1]) / 2 * np.diff(times)))


def speeds(course: Course, times: F64) -> F64:
    """`[T]` speed of a group's middle, units a second; in plan where it only bobs."""
    velocity = course.velocities(times)
    points = course.centers(course.grid())
    rise = float(np.ptp(points @ course.up))
    plan = velocity - np.outer(velocity @ course.up, course.up)
    level = path_length(course)
    return np.asarray(np.linalg.norm(plan if rise < _LEVEL * level else velocity, axis=1))


def first_contact(scene: Scene, group: int, anchor: int, after: float | None = None) -> float | None:
    """The first time at which a group begins to touch another one, None if it never does.

    Args:
        after: only contacts that begin later than this; None: also one that is there at the start.
    """
    touching = Encounter.of(scene, group, [anchor]).touching
    return next((start for start, _ in touching if after is None or start > after), None)


def nearest_time(scene: Scene, group: int, anchor: int, span: Span | None = None) -> tuple[float, float]:
    """When the middles of two groups are nearest in plan, and the gap between them then."""
    pair = Encounter.of(scene, group, [anchor])
    up = pair.course.up

    def apart(times: F64) -> F64:
        way = pair.course.centers(times) - pair.others[0].centers(times)
        return np.asarray(np.linalg.norm(way - np.outer(way @ up, up), axis=1))

    time = lowest(apart, *(span or (pair.course.start, pair.course.stop)))
    return time, float(pair.gaps(np.array([time]))[0])


def nearest_gap(scene: Scene, group: int, anchor: int) -> tuple[float, float]:
    """When the surfaces of two groups are nearest, and the gap between them then."""
    pair = Encounter.of(scene, group, [anchor])
    time = lowest(pair.gaps, pair.course.start, pair.course.stop)
    return time, float(pair.gaps(np.array([time]))[0])


def _swept(course: Course, span: Span) -> float:
    """The way of the fastest corner in a span."""
    times = course.grid(span)
    rates = course.rates(times)
    return float(np.sum((rates[1:] + rates[:-1]) / 2 * np.diff(times)))


def _drop(course: Course, span: Span) -> float:
    return float(-displacement(course, span) @ course.up)


def _tilt(course: Course, span: Span) -> float:
    """How much farther from the vertical it is at the end of a span than at its start, radians."""
    before, after = course.tilts(np.array(span))
    return float(after - before)


def _way(course: Course, span: Span) -> float:
    points = course.centers(course.grid(span))
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def _unit(scene: Scene) -> float:
    """Scene units of a metre; one where the scale is not known."""
    return 1.0 / (scene.frame.metres_per_unit or 1.0)
