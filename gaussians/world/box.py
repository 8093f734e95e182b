"""Upright oriented boxes: their frames and corners, and the penetration depth and distance of two boxes.

`Box` is a box of a scene, whose up may be any direction; `Boxes` are many of them as arrays. `YawBox` is a box of a
room whose up is z; its position may be arrays, so that one box is tried at many places at once.
All boxes are upright, so that up is one separating axis and the others lie in the plan (the view from above).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from ..camera import Vec3

F64 = NDArray[np.float64]
Axes = tuple[Vec3, Vec3, Vec3]


@dataclass(frozen=True)
class Box:
    """An upright oriented box.

    Attributes:
        center: world, scene units.
        axes: two level unit vectors (x', y') and the scene's up, right-handed, as rows.
        size: full extents along those axes.
    """

    center: Vec3
    axes: Axes
    size: Vec3

    def local(self, points: NDArray[np.floating]) -> F64:
        """World points `[M, 3]` in the box's frame, origin at its centre."""
        local: F64 = (np.asarray(points, dtype=np.float64) - np.array(self.center)) @ np.array(self.axes).T
        return local

    def corners(self) -> F64:
        """`[8, 3]` world corners; the first four are the lower ones."""
        signs = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], dtype=np.float64)
        corners: F64 = np.array(self.center) + (signs * np.array(self.size) / 2) @ np.array(self.axes)
        return corners

    def bounds(self, along: tuple[float, float] | None = None) -> tuple[F64, F64]:
        """The lower and the upper corner `[3]` of the world-aligned box around it.

        Args:
            along: heights along its third axis from and to which it is taken instead, scene units.
        """
        corners = self.corners()
        if along is not None:
            up = np.array(self.axes[2])
            level = corners - np.outer(corners @ up, up)
            corners = np.concatenate([level + height * up for height in along])
        return corners.min(axis=0), corners.max(axis=0)

    def bottom(self, up: F64) -> float:
        """Height of its underside along `up` `[3]`."""
        return float(np.array(self.center) @ up) - self.size[2] / 2

    def top(self, up: F64) -> float:
        """Height of its top along `up` `[3]`."""
        return float(np.array(self.center) @ up) + self.size[2] / 2

    def extent(self, direction: F64) -> float:
        """Full extent along a unit vector `[3]`."""
        return float(np.abs(np.array(self.axes) @ direction) @ np.array(self.size))

    def covers(self, points: NDArray[np.floating]) -> NDArray[np.bool_]:
        """`[M]` whether each world point `[M, 3]` lies within the footprint, at any height."""
        return np.asarray((np.abs(self.local(points)[:, :2]) <= np.array(self.size[:2]) / 2).all(axis=1))

    def shifted(self, offset: F64) -> Self:
        """The same box, moved by `offset` `[3]`."""
        x, y, z = (float(v) for v in np.array(self.center) + offset)
        return replace(self, center=(x, y, z))


def penetration(a: Box, b: Box) -> float:
    """The penetration depth of two boxes of one scene, scene units: the shortest shift that separates them.

    Negative if they are apart: minus the widest gap along a separating axis, which is at most their `distance`.
    """
    axes = np.array([a.axes[2], *a.axes[:2], *b.axes[:2]])
    apart = np.array(a.center) - np.array(b.center)
    return min((a.extent(axis) + b.extent(axis)) / 2 - abs(float(apart @ axis)) for axis in axes)


def overlap(a: Box, b: Box) -> float:
    """The penetration depth of two boxes, scene units; 0 if they touch or are apart."""
    return max(0.0, penetration(a, b))


@dataclass(frozen=True, eq=False)
class Boxes:
    """C boxes as arrays: centers `[C, 3]`, axes `[C, 3, 3]` (rows), sizes `[C, 3]`, as in `Box`."""

    centers: F64
    axes: F64
    sizes: F64

    @classmethod
    def of(cls, boxes: Sequence[Box]) -> Self:
        """The boxes as arrays, in the given order."""
        return cls(
            np.array([b.center for b in boxes], dtype=np.float64).reshape(-1, 3),
            np.array([b.axes for b in boxes], dtype=np.float64).reshape(-1, 3, 3),
            np.array([b.size for b in boxes], dtype=np.float64).reshape(-1, 3),
        )

    def __len__(self) -> int:
        return len(self.centers)

    def at(self, rows: Sequence[int] | NDArray[np.intp]) -> Self:
        """The boxes of these rows."""
        rows = np.asarray(rows, dtype=np.intp)
        return type(self)(self.centers[rows], self.axes[rows], self.sizes[rows])

    def local(self, points: F64) -> F64:
        """World points `[C, P, 3]` in each box's frame, origin at its centre.

        One box, or one set of points, is broadcast to all.
        """
        local: F64 = (points - self.centers[:, None]) @ self.axes.transpose(0, 2, 1)
        return local

    def spread(self, lattice: F64) -> F64:
        """`[C, P, 3]` world points of each box at places `[P, 3]` of a box of size 1 around the origin."""
        points: F64 = self.centers[:, None] + (lattice * self.sizes[:, None]) @ self.axes
        return points

    def heights(self, up: F64) -> tuple[F64, F64]:
        """`[C]` heights of undersides and tops along `up` `[3]`."""
        middle = self.centers @ up
        return middle - self.sizes[:, 2] / 2, middle + self.sizes[:, 2] / 2


def lattice(across: int, up: int) -> F64:
    """`[across * across * up, 3]` points spread evenly through a box of size 1 around the origin; flat if `up` is 1."""
    t, z = np.linspace(-0.5, 0.5, across), np.linspace(-0.5, 0.5, up) if up > 1 else np.zeros(1)
    return np.stack(np.meshgrid(t, t, z, indexing="ij"), axis=-1).reshape(-1, 3)


_CORNERS = lattice(2, 1)


def distance(a: Box, b: Box) -> float:
    """Gap between two boxes of one scene, scene units; 0 where they touch or overlap."""
    return float(distances(Boxes.of([a]), Boxes.of([b]))[0])


def distances(boxes: Boxes, anchor: Boxes) -> F64:
    """`[C]` gaps between each box and one anchor `[1]`, scene units; 0 where they touch or overlap.

    Exact: all boxes are upright, so that the gap in plan and the gap in height are independent.
    """
    rise = np.abs((boxes.centers - anchor.centers) @ anchor.axes[0, 2])
    over = np.maximum(0.0, rise - (boxes.sizes[:, 2] + anchor.sizes[:, 2]) / 2)
    return np.hypot(_plan_distances(boxes, anchor), over)


def _plan_distances(boxes: Boxes, anchor: Boxes) -> F64:
    """`[C]` gaps between footprints: if two are apart, one end of the shortest connection is a corner of either."""
    apart, gaps = np.zeros(len(boxes), bool), []
    for one, other in ((boxes, anchor), (anchor, boxes)):
        corners = other.local(one.spread(_CORNERS))[..., :2]  # [C, 4, 2]
        half = other.sizes[:, None, :2] / 2
        outside = (corners.min(axis=1) > half[:, 0]) | (corners.max(axis=1) < -half[:, 0])
        apart = apart | outside.any(axis=1)
        gaps.append(np.linalg.norm(np.maximum(np.abs(corners) - half, 0), axis=2).min(axis=1))
    return np.where(apart, np.minimum(*gaps), 0.0)


# --- boxes of a room: z is up -----------------------------------------------------------------------------------------


class YawBox(NamedTuple):
    """An upright box in a room whose up is z, metres.

    Attributes:
        x, y: middle of its footprint; numbers, or arrays that broadcast: the box at many places at once.
        low: height of its underside.
        w, d, h: width, depth and height.
        yaw: degrees, counter-clockwise from above; its front is its -y side at yaw 0.
    """

    x: Any
    y: Any
    low: float
    w: float
    d: float
    h: float
    yaw: float = 0.0

    @property
    def high(self) -> float:
        """Height of its top."""
        return self.low + self.h

    @property
    def half(self) -> tuple[float, float]:
        """Half of its extents along world x and y."""
        c, s = cos_sin(self.yaw)
        return (abs(c) * self.w + abs(s) * self.d) / 2, (abs(s) * self.w + abs(c) * self.d) / 2

    @property
    def front(self) -> tuple[float, float]:
        """Unit vector (x, y) out of its front."""
        c, s = cos_sin(self.yaw)
        return s, -c

    @property
    def axes(self) -> F64:
        """`[2, 2]` rows: its own right and back directions in plan."""
        c, s = cos_sin(self.yaw)
        return np.array([[c, s], [-s, c]])

    @property
    def box(self) -> Box:
        """The box in a scene; its position must be numbers."""
        c, s = cos_sin(self.yaw)
        axes = ((c, s, 0.0), (-s, c, 0.0), (0.0, 0.0, 1.0))
        return Box((float(self.x), float(self.y), self.low + self.h / 2), axes, (self.w, self.d, self.h))

    def local(self, x: Any, y: Any) -> tuple[Any, Any]:
        """World points in its own axes, origin in the middle of its footprint."""
        c, s = cos_sin(self.yaw)
        dx, dy = x - self.x, y - self.y
        return dx * c + dy * s, dy * c - dx * s

    def world(self, right: Any, back: Any) -> tuple[Any, Any]:
        """Points of its own axes in the world; the inverse of `local`."""
        return to_world(self.x, self.y, self.yaw, right, back)

    def distance_to(self, x: Any, y: Any) -> Any:
        """Metres in plan from its footprint to points, 0 within it."""
        u, v = self.local(x, y)
        return np.hypot(np.maximum(np.abs(u) - self.w / 2, 0.0), np.maximum(np.abs(v) - self.d / 2, 0.0))

    def corners(self) -> F64:
        """`[4, 2]` of its footprint; its position must be numbers."""
        half = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.array([self.w, self.d]) / 2
        return np.asarray(half @ self.axes + np.array([self.x, self.y]))

    def grown(self, by: float) -> Self:
        """Wider and deeper by `by` on each side."""
        return self._replace(w=self.w + 2 * by, d=self.d + 2 * by)


@lru_cache(maxsize=4096)
def cos_sin(yaw: float) -> tuple[float, float]:
    """Cosine and sine of degrees; exact for quarter turns, so that boxes against walls are flush."""
    quarter = yaw % 360.0
    exact = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}
    return exact.get(quarter) or (math.cos(math.radians(quarter)), math.sin(math.radians(quarter)))


def to_world(x: Any, y: Any, yaw: float, right: Any, back: Any) -> tuple[Any, Any]:
    """Where a point (right, back) of a thing's own axes lies when the thing stands at (x, y), turned by `yaw`."""
    c, s = cos_sin(yaw)
    return x + c * right - s * back, y + s * right + c * back


def is_square(yaw: float) -> bool:
    """Whether a box of this yaw is aligned with the axes."""
    return abs(yaw % 90.0) < 1e-9 or abs(yaw % 90.0 - 90.0) < 1e-9


def wrapped(yaw: float) -> float:
    """Yaw in (-180, 180]."""
    turn = yaw % 360.0
    return turn - 360.0 if turn > 180.0 else turn


def plan_penetration(a: YawBox, b: YawBox) -> Any:
    """The penetration depth of two footprints by their separating axes, metres; negative where they are apart."""
    deepest: Any = np.inf
    for yaw in (a.yaw, b.yaw):
        for turn in (yaw, yaw + 90.0):
            c, s = cos_sin(turn)
            reach = (extent_along(a, turn) + extent_along(b, turn)) / 2
            deepest = np.minimum(deepest, reach - np.abs((a.x - b.x) * c + (a.y - b.y) * s))
    return deepest


def extent_along(a: YawBox, turn: float) -> float:
    """Full extent of a footprint along a direction, degrees."""
    c, s = cos_sin(turn - a.yaw)
    return abs(c) * a.w + abs(s) * a.d


def shared_height(a: YawBox, b: YawBox) -> float:
    """Length of the height interval that two boxes share, metres; negative where one is above the other."""
    return min(a.high, b.high) - max(a.low, b.low)


def meet(a: YawBox, b: YawBox, slack: float) -> Any:
    """Whether two boxes penetrate each other by more than `slack` metres, in plan and in height."""
    return shared_height(a, b) > slack and plan_penetration(a, b) > slack


def plan_gap(a: YawBox, b: YawBox) -> Any:
    """A lower bound of the gap between two footprints, metres, 0 where they meet; exact if both are axis-aligned."""
    if is_square(a.yaw) and is_square(b.yaw):
        (aw, ad), (bw, bd) = a.half, b.half
        return np.hypot(
            np.maximum(np.abs(a.x - b.x) - aw - bw, 0.0),
            np.maximum(np.abs(a.y - b.y) - ad - bd, 0.0),
        )
    return np.maximum(-plan_penetration(a, b), 0.0)


def plan_share(a: YawBox, b: YawBox) -> Any:
    """The shared area of two footprints as a share of the smaller one, from their axis-aligned bounds."""
    (aw, ad), (bw, bd) = a.half, b.half
    wide = np.minimum(a.x + aw, b.x + bw) - np.maximum(a.x - aw, b.x - bw)
    deep = np.minimum(a.y + ad, b.y + bd) - np.maximum(a.y - ad, b.y - bd)
    least = max(min(4 * aw * ad, 4 * bw * bd), 1e-9)
    return np.maximum(wide, 0.0) * np.maximum(deep, 0.0) / least
