"""Distances between things, walls and people: centre to centre and between surfaces, with the line that shows them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...gaussians.world.box import Box, distance
from ...gaussians.world.support import SHELL
from .answer import Evidence, Line
from .candidates import meant
from .reading.measures import Unit
from .reading.situation import Situation
from .reading.spots import Spot
from .room_places import walls
from .survey import Survey, Thing
from .views import view_of

F64 = NDArray[np.float64]
_THIN = 1e-4  # metres: thickness of a wall or ceiling whose surface is measured
_LEVEL = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True, eq=False)
class End:
    """One end of a distance.

    Attributes:
        name: for sentences: "the sofa", "you".
        box: a person is an upright line, so that distances to people are those in plan.
        thing: None for a person or a point of the room.
    """

    name: str
    box: Box
    thing: Thing | None = None

    @property
    def is_surface(self) -> bool:
        """Whether it is a wall, the floor or the ceiling, whose centre says nothing."""
        return self.thing is not None and self.thing.node is None and self.thing.label in SHELL


@dataclass(frozen=True)
class Span:
    """The distance of two ends, metres.

    Attributes:
        gap: between the surfaces, 0 where they touch.
        centres: between the centres; to a wall, floor or ceiling and to a person the shortest way in plan or height.
        plan: between the centres, seen from above.
    """

    gap: float
    centres: float
    plan: float


def end_of(thing: Thing, survey: Survey) -> End:
    """A thing as an end; a wall or ceiling as its inner surface."""
    box = thing.group.box
    if thing.node is None and thing.label in ("wall", "ceiling"):
        size = [float(s) for s in box.size]
        size[2 if thing.label == "ceiling" else int(np.argmin(size[:2]))] = _THIN
        box = replace(box, size=(size[0], size[1], size[2]))
    name = f"the {thing.label}" if thing.node is None else survey.named(thing)
    if thing.node is None and thing.label == "wall":
        way = np.array(thing.group.box.center[:2])
        name = f"the {max(walls(survey.room), key=lambda w: float(w.out @ way)).name} wall"
    return End(name, box, thing)


def person(eye: F64, survey: Survey, name: str = "you") -> End:
    """A person who stands at a point in plan."""
    height = max(survey.graph.room.size[2], 1.0)
    return End(name, Box((float(eye[0]), float(eye[1]), height / 2), _LEVEL, (_THIN, _THIN, height)))


def ends(place: Spot, survey: Survey, situation: Situation | None = None) -> tuple[End, ...]:
    """Everything that a place may mean; of walls without a name the four of them.

    Raises:
        NotResolved: the thing is absent.
    """
    if place.who == "room":
        return (person(np.zeros(2), survey, "the middle of the room"),)
    if place.who == "me":
        return tuple(person(v.eye, survey) for v in view_of(situation, survey))
    assert place.query is not None
    return tuple(end_of(t, survey) for t in meant(place.query, survey))


def span(a: End, b: End) -> Span:
    """The distance of two ends."""
    gap = max(distance(a.box, b.box), 0.0)
    way = np.array(a.box.center) - np.array(b.box.center)
    if a.thing is None or b.thing is None:
        way[2] = 0.0
    centres, plan = float(np.linalg.norm(way)), float(np.linalg.norm(way[:2]))
    if a.is_surface or b.is_surface:
        one, other = (a, b) if a.is_surface else (b, a)
        centres = plan = distance(one.box, replace(other.box, size=(_THIN, _THIN, _THIN)))
    return Span(gap, centres, plan)


def nearest_of(a: Sequence[End], b: Sequence[End]) -> tuple[End, End]:
    """The two ends with the smallest gap."""
    return min(((x, y) for x in a for y in b), key=lambda pair: distance(pair[0].box, pair[1].box))


def evidence(a: End, b: End, gap: bool, told: str = "") -> Evidence:
    """The things of both ends and the line between their centres or nearest points."""
    ids = tuple(e.thing.id for e in (a, b) if e.thing is not None and e.thing.node is not None)
    if gap or a.is_surface or b.is_surface:
        start, end = _nearest_points(a.box, b.box)
    else:
        start, end = np.array(a.box.center), np.array(b.box.center)
        if a.thing is None:
            start = np.array([*start[:2], end[2]])
        elif b.thing is None:
            end = np.array([*end[:2], start[2]])
    return Evidence(ids=ids, lines=(Line(start=_point(start), end=_point(end), label=told),))


def told(metres: float, unit: Unit | None = None) -> str:
    """A length in words: "1.24 m", and in another unit that was asked for: "4.07 ft (1.24 m)"."""
    if unit is None or unit.metres == 1.0:
        return f"{metres:.2f} m"
    value = metres / unit.metres
    return f"{value:.{2 if unit.metres > 0.2 else 1 if unit.metres > 0.02 else 0}f} {unit.name} ({metres:.2f} m)"


def _point(values: F64) -> tuple[float, float, float]:
    x, y, z = (round(float(v), 4) for v in values)
    return (x, y, z)


def _nearest_points(a: Box, b: Box) -> tuple[F64, F64]:
    """The nearest points `[3]` of two boxes, by projecting back and forth."""
    point = np.array(b.center)
    for _ in range(60):
        on_a = _onto(a, point)
        point = _onto(b, on_a)
    return _onto(a, point), point


def _onto(box: Box, point: F64) -> F64:
    half = np.array(box.size) / 2
    inside = np.clip(box.local(point[None])[0], -half, half)
    return np.asarray(np.array(box.center) + inside @ np.array(box.axes))
