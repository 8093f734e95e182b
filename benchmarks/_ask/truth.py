"""True tables of rooms, and plan geometry on them, from which the answers of generated questions are computed.

The geometry is this module's own (numpy on footprints and on a grid of the floor), not that of the product. Frame: z
up, metres, degrees counter-clockwise; an unturned thing faces -y.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]
CELL = 0.04  # metres between points of the floor's grid
FLAT = 0.05  # metres: things on the floor up to this height are walked on


@dataclass(frozen=True)
class Thing:
    """One thing as it truly is.

    Attributes:
        id: its number in the room.
        label: canonical name of its kind.
        color: basic colour term, "" where the paint is mixed.
        shades: all basic terms that a fair share of its surface has.
        size: width, depth, height, metres.
        center: of its box.
        yaw: degrees, 0 faces -y.
        support: id of what carries it, or "floor", "wall", "ceiling".
    """

    id: int
    label: str
    color: str
    shades: frozenset[str]
    size: tuple[float, float, float]
    center: tuple[float, float, float]
    yaw: float
    support: int | str

    @property
    def low(self) -> float:
        """Height of its underside."""
        return self.center[2] - self.size[2] / 2

    @property
    def high(self) -> float:
        """Height of its top."""
        return self.center[2] + self.size[2] / 2

    @property
    def volume(self) -> float:
        """Of its box."""
        return self.size[0] * self.size[1] * self.size[2]

    @property
    def xy(self) -> F64:
        """`[2]` its centre in plan."""
        return np.array(self.center[:2])

    @property
    def axes(self) -> F64:
        """`[2, 2]` unit vectors along its width and its depth, in plan."""
        turn = math.radians(self.yaw)
        return np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])

    @property
    def front(self) -> F64:
        """`[2]` unit vector that it faces along."""
        return -self.axes[1]

    @property
    def corners(self) -> F64:
        """`[4, 2]` corners of its footprint, around."""
        half = np.array(self.size[:2]) / 2
        around: F64 = self.xy + (np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half) @ self.axes
        return around

    def covers(self, points: F64, grown: float = 0.0) -> Mask:
        """`[...]` whether points `[..., 2]` lie within its footprint, enlarged by `grown` on all sides."""
        local = (points - self.xy) @ self.axes.T
        within = np.abs(local) <= np.array(self.size[:2]) / 2 + grown
        return np.asarray(within[..., 0] & within[..., 1])  # as `all` over the last axis, at a fraction of its time


@dataclass(frozen=True)
class Table:
    """A room as it truly is.

    Attributes:
        name: for reports.
        seed: of its questions.
        size: width (x), depth (y), height.
        things: everything in it but floor, walls and ceiling.
        eye, forward: where the viewer stands, and the level unit vector of the gaze, in plan.
    """

    name: str
    seed: int
    size: tuple[float, float, float]
    things: tuple[Thing, ...]
    eye: tuple[float, float]
    forward: tuple[float, float]

    @property
    def right(self) -> F64:
        """`[2]` the viewer's right."""
        return right_of(np.array(self.forward))

    def by_id(self, id: int) -> Thing:
        """The thing with this id."""
        return next(t for t in self.things if t.id == id)

    def carried_by(self, thing: Thing) -> tuple[Thing, ...]:
        """What stands directly on it."""
        return tuple(t for t in self.things if t.support == thing.id)

    def on_floor(self, thing: Thing) -> bool:
        """Whether it stands on the floor, or on something flat that lies there."""
        below = thing.support
        if isinstance(below, int):
            carrier = self.by_id(below)
            return carrier.support == "floor" and carrier.size[2] <= FLAT
        return below == "floor"

    @cached_property
    def grid(self) -> F64:
        """`[Y, X, 2]` points of the floor."""
        x, y = (np.arange(-s / 2 + CELL / 2, s / 2, CELL) for s in self.size[:2])
        return np.stack(np.meshgrid(x, y), axis=-1)

    def taken(self, things: Iterable[Thing], grown: float = 0.0) -> Mask:
        """`[Y, X]` the grid points within the footprints of things."""
        mask = np.zeros(self.grid.shape[:2], bool)
        for thing in things:
            mask |= thing.covers(self.grid, grown)
        return mask

    def seen_by(self, eye: tuple[float, float], forward: tuple[float, float]) -> Table:
        """The same room before another viewer."""
        return replace(self, eye=eye, forward=forward)


def right_of(forward: F64) -> F64:
    """`[2]` the right hand of someone who looks along `forward`."""
    return np.array([forward[1], -forward[0]])


def bearing(of: F64, eye: F64, forward: F64) -> tuple[float, float]:
    """Metres to the right and ahead of someone at `eye` who looks along `forward`."""
    offset = of - eye
    return float(offset @ right_of(forward)), float(offset @ forward)


def centers_apart(a: Thing, b: Thing) -> float:
    """Metres between two centres."""
    return math.dist(a.center, b.center)


def gap(a: Thing, b: Thing) -> float:
    """Metres between the surfaces of two upright boxes; 0 where they meet."""
    level = plan_gap(a, b)
    return math.hypot(level, max(a.low - b.high, b.low - a.high, 0.0))


def plan_gap(a: Thing, b: Thing) -> float:
    """Metres between two footprints; 0 where they overlap."""
    if _overlap(a, b):
        return 0.0
    corners = ((a.corners, b.corners), (b.corners, a.corners))
    return min(float(_to_segments(points, around).min()) for points, around in corners)


def _overlap(a: Thing, b: Thing) -> bool:
    """Whether two footprints share points: no axis of either separates them."""
    for axis in (*a.axes, *b.axes):
        one, other = a.corners @ axis, b.corners @ axis
        if one.max() < other.min() or other.max() < one.min():
            return False
    return True


def _to_segments(points: F64, around: F64) -> F64:
    """`[P, E]` metres from points to the edges of a polygon."""
    start, end = around, np.roll(around, -1, axis=0)
    way = end - start
    t = ((points[:, None] - start) * way).sum(axis=2) / (way**2).sum(axis=1)
    foot = start + np.clip(t, 0, 1)[..., None] * way
    return np.linalg.norm(points[:, None] - foot, axis=2)


def shared(a: Thing, b: Thing) -> float:
    """Share of the footprint of `a` that lies over that of `b`."""
    t = np.linspace(-0.5, 0.5, 41)
    points = a.xy + (np.stack(np.meshgrid(t, t), axis=-1) * np.array(a.size[:2])) @ a.axes
    return float(b.covers(points).mean())


def along_way(thing: Thing, start: F64, end: F64, half_width: float) -> float:
    """Metres of the straight way from `start` to `end` on which the footprint is within `half_width` of it."""
    length = float(np.linalg.norm(end - start))
    ahead = (end - start) / max(length, 1e-9)
    steps = np.arange(0, length, CELL)
    aside = np.arange(-half_width, half_width + 1e-9, CELL)
    points = start + steps[:, None, None] * ahead + aside[:, None] * right_of(ahead)
    return float(thing.covers(points).any(axis=1).sum() * CELL)


def outside(thing: Thing, other: Thing) -> F64:
    """`[2]` where the straight way from the centre of `thing` to that of `other` leaves its footprint."""
    steps = np.linspace(0, 1, 400)[:, None]
    points = thing.xy + steps * (other.xy - thing.xy)
    inside = thing.covers(points)
    found: F64 = points[int(np.argmin(inside)) if not inside.all() else -1]
    return found


def largest_fit(free: Mask, width: float, depth: float) -> bool:
    """Whether an axis-aligned rectangle of whole cells fits among the free ones `[Y, X]`, either way round."""
    total = np.pad(np.cumsum(np.cumsum(free, axis=0), axis=1), ((1, 0), (1, 0)))
    for x, y in ((width, depth), (depth, width)):
        columns, rows = math.ceil(x / CELL - 1e-6), math.ceil(y / CELL - 1e-6)
        if rows >= total.shape[0] or columns >= total.shape[1]:
            continue
        sums = total[rows:, columns:] - total[:-rows, columns:] - total[rows:, :-columns] + total[:-rows, :-columns]
        if (sums == rows * columns).any():
            return True
    return False


def fits_turned(table: Table, blocking: Sequence[Thing], width: float, depth: float, turns: int = 12) -> bool:
    """Whether a rectangle fits on the floor at one of `turns` angles of a quarter turn, among things that block it."""
    reach = math.hypot(*table.size[:2]) / 2
    t = np.arange(-reach, reach, CELL)
    square = np.stack(np.meshgrid(t, t), axis=-1)
    half = np.array(table.size[:2]) / 2
    for angle in np.linspace(0, math.pi / 2, turns, endpoint=False):
        c, s = math.cos(angle), math.sin(angle)
        points = square @ np.array([[c, s], [-s, c]])
        free = (np.abs(points[..., 0]) <= half[0]) & (np.abs(points[..., 1]) <= half[1])
        for thing in blocking:
            free &= ~thing.covers(points)
        if largest_fit(free, width, depth):
            return True
    return False


def walkable(table: Table, blocking: Sequence[Thing], radius: float) -> Mask:
    """`[Y, X]` where the middle of a round body of this radius can be."""
    from scipy import ndimage

    free = ~table.taken(blocking)
    padded = np.pad(free, 1, constant_values=False)
    far: F64 = ndimage.distance_transform_edt(padded)[1:-1, 1:-1] * CELL
    return far > radius


def regions(table: Table, blocking: Sequence[Thing], radius: float) -> NDArray[np.int32]:
    """`[Y, X]` number of the connected region of `walkable` that each grid point is in, 0 for none."""
    from scipy import ndimage

    numbered: NDArray[np.int32] = ndimage.label(walkable(table, blocking, radius))[0]
    return numbered


def connected(table: Table, numbered: NDArray[np.int32], one: Thing, other: Thing, near: float) -> bool:
    """Whether one region comes within `near` of both footprints."""
    at = [set(np.unique(numbered[thing.covers(table.grid, near)])) - {0} for thing in (one, other)]
    return bool(at[0] & at[1])
