"""Circles round a thing that fit between what stands around: boxes of things on the same height, and walls."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...gaussians.rotations import axis_rotation
from ...gaussians.scene import Scene
from ...gaussians.world.box import Box, Boxes, distances
from ..placement.bodies import Body, centimetre, neighbours

F64 = NDArray[np.float64]

_STEP = 5.0  # centimetres between two radii that are tried
_WIDER = 1.25  # times as far as it stands is the widest circle that is tried
_CLEAR = 2.0  # centimetres that a circle leaves between the thing and what stands around, on each side
_FOOT = 3.0  # centimetres above its foot: what is lower, as a rug, is no obstacle
_FOOT_SHARE = 0.4  # of its height, likewise
_MOST = 2000  # places on a way that are looked at
_WALL, _EDGE = "the wall", "the edge of the floor"
_MANY = 10  # things count as much as a wall, or as what it goes round
_FLOORS = ("floor", "ground", "terrain")


@dataclass(frozen=True, eq=False)
class Circling:
    """A body that goes round a point.

    Attributes:
        box: of the body where it begins, without its foot.
        middle: `[3]` the point.
        name: of what it goes round.
        up: `[3]` unit.
        angle: radians in all, positive counter-clockwise seen from above.
        around: name and box of each thing that may be in its way, walls among them.
        floor: over which it stays; None: it is not over any.
        unit: a centimetre, scene units.
    """

    box: Box
    middle: F64
    name: str
    up: F64
    angle: float
    around: tuple[tuple[str, Box], ...]
    floor: Box | None
    unit: float

    @classmethod
    def of(cls, scene: Scene, body: Body, goal: Body, angle: float) -> Circling:
        """A body of a static scene that begins to go round another; what it is in from the start is not in its way."""
        up, unit = scene.frame.up_vector, centimetre(scene.frame, max(body.box.size))
        foot = min(_FOOT * unit, _FOOT_SHARE * body.box.size[2])
        center = np.asarray(body.box.center) + up * foot / 2
        wide, deep, high = body.box.size
        box = replace(body.box, center=tuple(center), size=(wide, deep, high - foot))
        others = [*neighbours(scene, {body.group, *body.carried}), *_walls(scene)]
        free = tuple((n, b) for n, b in others if _beside(box, b, up) and not _meets(Boxes.of([box]), b))
        floor = _floor(scene)
        inside = floor is not None and bool(_over(floor, Boxes.of([box]))[0])
        return cls(box, goal.center, goal.label, up, angle, free, floor if inside else None, unit)

    @property
    def out(self) -> F64:
        """`[3]` the level way from the middle to where it begins."""
        way = np.asarray(self.box.center) - self.middle
        return np.asarray(way - self.up * (way @ self.up))

    @property
    def radius(self) -> float:
        """How far from the middle it begins, scene units."""
        return float(np.linalg.norm(self.out))

    def best(self) -> tuple[float, tuple[str, ...]]:
        """The radius of the circle that goes through the fewest things, of several the one nearest to its own, and the
        names of these; a way there through anything is none. Its own radius if nothing is in its way there."""
        found, radius = tuple(self._in_the_way(self._circle(self.radius), 0.0)), self.radius
        if not found:
            return radius, ()
        step = _STEP * self.unit
        radii = np.arange(step, _WIDER * self.radius, step)
        for tried in sorted(map(float, radii), key=lambda r: abs(r - self.radius)):
            names = tuple(self._in_the_way(self._circle(tried), _CLEAR * self.unit))
            if self._cost(names) < self._cost(found) and not any(self._in_the_way(self._straight(tried), 0.0)):
                found, radius = names, tried
            if not found:
                break
        return radius, tuple(dict.fromkeys(found))

    def hit(self) -> tuple[str, ...]:
        """The names of what its circle goes through at its own radius."""
        return tuple(dict.fromkeys(self._in_the_way(self._circle(self.radius), 0.0)))

    def _cost(self, names: tuple[str, ...]) -> int:
        """How bad it is to go through some things."""
        return sum(_MANY if name in (_WALL, _EDGE, self.name) else 1 for name in names)

    def _in_the_way(self, way: Boxes, clear: float) -> Iterator[str]:
        grown = replace(way, sizes=way.sizes + np.array([2 * clear, 2 * clear, 0.0]))
        yield from (name or "something" for name, box in self.around if _meets(grown, box))
        if self.floor is not None and not bool(_over(self.floor, way).all()):
            yield _EDGE

    def _straight(self, radius: float) -> Boxes:
        """Where it is on its straight way to a circle."""
        far = radius - self.radius
        shifts = np.linspace(0.0, far, self._places(abs(far)))[:, None] * self.out / self.radius
        return self._boxes(shifts, np.zeros(len(shifts)))

    def _circle(self, radius: float) -> Boxes:
        """Where it is on a circle."""
        angle = math.copysign(min(abs(self.angle), 2 * math.pi), self.angle)
        angles = np.linspace(0.0, angle, self._places(radius * abs(angle)))
        shift = (radius / self.radius - 1.0) * self.out
        return self._boxes(np.tile(shift, (len(angles), 1)), angles)

    def _places(self, way: float) -> int:
        """How many places are looked at: so many that what is thin is not missed."""
        return min(max(math.ceil(way / min(self.box.size[:2])), 2), _MOST)

    def _boxes(self, shifts: F64, angles: F64) -> Boxes:
        """Its box shifted `[T, 3]` and then turned about the middle by `[T]` radians."""
        turns = np.stack([axis_rotation(self.up, math.degrees(a)) for a in angles])
        places = np.asarray(self.box.center) + shifts - self.middle
        centers = np.einsum("tij,tj->ti", turns, places) + self.middle
        axes = np.asarray(self.box.axes) @ turns.transpose(0, 2, 1)
        return Boxes(centers, axes, np.tile(np.asarray(self.box.size), (len(angles), 1)))


def _beside(box: Box, other: Box, up: F64) -> bool:
    """Whether two boxes are on the same height."""
    return other.bottom(up) < box.top(up) and box.bottom(up) < other.top(up)


def _meets(boxes: Boxes, other: Box) -> bool:
    return bool((distances(boxes, Boxes.of([other])) <= 0).any())


def _over(floor: Box, boxes: Boxes) -> NDArray[np.bool_]:
    """`[T]` whether the middle of a box is over the floor."""
    local = np.abs(floor.local(boxes.centers)[:, :2])
    return np.asarray((local <= np.asarray(floor.size)[:2] / 2).all(axis=1))


def _walls(scene: Scene) -> list[tuple[str, Box]]:
    """The boxes of walls; one box around all of them is none."""
    groups = scene.language.groups if scene.language is not None else ()
    walls = [g for g in groups if g.level == "structure" and g.label == "wall" and g.count]
    return [(_WALL, g.box) for g in walls if min(g.box.size[:2]) < 0.5 * max(g.box.size[:2])]


def _floor(scene: Scene) -> Box | None:
    groups = scene.language.groups if scene.language is not None else ()
    return next((g.box for g in groups if g.level == "structure" and g.label in _FLOORS and g.count), None)
