"""Upright boxes on a floor, and where the middle of one may lie so that it keeps clear of others.

Knows rectangles, heights and lattices of positions. Refuses to know what the boxes are and what is wished of them.
Yaw is in degrees, counter-clockwise from above; a box's front is its -y side at yaw 0. Coordinates may be numbers or
arrays: a box with arrays stands at many places at once, turned the same way.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]
EPSILON = 1e-6  # metres; boxes that share no more than this touch
TURNS = (0.0, 90.0, 180.0, -90.0)


class Spot(NamedTuple):
    """A box: middle of its footprint (numbers or arrays), yaw, width, depth, and heights of its underside and top."""

    x: Any
    y: Any
    yaw: float
    w: float
    d: float
    low: float
    high: float

    @property
    def half(self) -> tuple[float, float]:
        """Half of its extents along world x and y."""
        c, s = turned(self.yaw)
        return (abs(c) * self.w + abs(s) * self.d) / 2, (abs(s) * self.w + abs(c) * self.d) / 2

    @property
    def front(self) -> tuple[float, float]:
        """The direction that its front looks."""
        c, s = turned(self.yaw)
        return s, -c

    def local(self, x: Any, y: Any) -> tuple[Any, Any]:
        """World points in its own axes, origin in its middle."""
        c, s = turned(self.yaw)
        dx, dy = x - self.x, y - self.y
        return dx * c + dy * s, dy * c - dx * s


@lru_cache(maxsize=4096)
def turned(yaw: float) -> tuple[float, float]:
    """Cosine and sine of degrees; exact for quarter turns, so that boxes against walls are flush."""
    quarter = yaw % 360.0
    exact = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}
    return exact.get(quarter) or (math.cos(math.radians(quarter)), math.sin(math.radians(quarter)))


def shifted(x: Any, y: Any, yaw: float, ox: Any, oy: Any) -> tuple[Any, Any]:
    """Where a point at (ox, oy) of a thing's own axes lies when the thing stands at (x, y), turned by `yaw`."""
    c, s = turned(yaw)
    return x + c * ox - s * oy, y + s * ox + c * oy


def is_square(yaw: float) -> bool:
    """Whether a box of this yaw is along the axes."""
    return abs(yaw % 90.0) < 1e-9 or abs(yaw % 90.0 - 90.0) < 1e-9


def wrapped(yaw: float) -> float:
    """Yaw in (-180, 180]."""
    turn = yaw % 360.0
    return turn - 360.0 if turn > 180.0 else turn


def near(a: Spot, b: Spot) -> Any:
    """Gap between two footprints, metres, at least; exact where both are along the axes, and 0 where they meet."""
    if is_square(a.yaw) and is_square(b.yaw):
        (aw, ad), (bw, bd) = a.half, b.half
        return np.hypot(
            np.maximum(np.abs(a.x - b.x) - aw - bw, 0.0),
            np.maximum(np.abs(a.y - b.y) - ad - bd, 0.0),
        )
    return np.maximum(-depth(a, b), 0.0)


def depth(a: Spot, b: Spot) -> Any:
    """How deep two footprints are in each other by their separating axes; negative where they are apart."""
    deepest: Any = np.inf
    for yaw in (a.yaw, b.yaw):
        for turn in (yaw, yaw + 90.0):
            c, s = turned(turn)
            reach = (_along(a, turn) + _along(b, turn)) / 2
            deepest = np.minimum(deepest, reach - np.abs((a.x - b.x) * c + (a.y - b.y) * s))
    return deepest


def _along(a: Spot, turn: float) -> float:
    """Full extent of a footprint along a direction."""
    c, s = turned(turn - a.yaw)
    return abs(c) * a.w + abs(s) * a.d


def share(a: Spot, b: Spot) -> Any:
    """Area that two footprints have in common, of the smaller one's; both are taken along the axes."""
    (aw, ad), (bw, bd) = a.half, b.half
    wide = np.minimum(a.x + aw, b.x + bw) - np.maximum(a.x - aw, b.x - bw)
    deep = np.minimum(a.y + ad, b.y + bd) - np.maximum(a.y - ad, b.y - bd)
    least = max(min(4 * aw * ad, 4 * bw * bd), 1e-9)
    return np.maximum(wide, 0.0) * np.maximum(deep, 0.0) / least


class Lattice(NamedTuple):
    """Positions `xs[i], ys[j]`, both ascending, for the middle of something that stands turned by `yaw`."""

    xs: F64
    ys: F64
    yaw: float


def blocked(lattice: Lattice, moving: Spot, fixed: Sequence[Spot], into: Flags) -> None:
    """Mark in `into` `[X, Y]` where `moving`, whose x and y are offsets to the lattice, would be in any of `fixed`.

    A box along the axes forbids exactly a rectangle of middles (its Minkowski sum with the moving one).
    """
    for window, meets in meetings(lattice, moving, fixed):
        into[window] |= meets


def meetings(lattice: Lattice, moving: Spot, fixed: Sequence[Spot]) -> list[tuple[tuple[slice, slice], Any]]:
    """For each of `fixed` that is in reach: the window of the lattice, and where in it the two are in each other."""
    others = [f for f in fixed if min(f.high, moving.high) - max(f.low, moving.low) > EPSILON]
    if not others:
        return []
    mw, md = moving.half
    middles = np.array([(f.x, f.y) for f in others]) - (moving.x, moving.y)
    reach = np.maximum(np.array([f.half for f in others]) + np.array([mw, md]) - EPSILON, 0.0)
    x0 = np.searchsorted(lattice.xs, middles[:, 0] - reach[:, 0], side="right")
    x1 = np.searchsorted(lattice.xs, middles[:, 0] + reach[:, 0], side="left")
    y0 = np.searchsorted(lattice.ys, middles[:, 1] - reach[:, 1], side="right")
    y1 = np.searchsorted(lattice.ys, middles[:, 1] + reach[:, 1], side="left")
    found: list[tuple[tuple[slice, slice], Any]] = []
    level = is_square(moving.yaw)
    for k in np.flatnonzero((x1 > x0) & (y1 > y0)):
        window = slice(int(x0[k]), int(x1[k])), slice(int(y0[k]), int(y1[k]))
        if level and is_square(others[k].yaw):
            found.append((window, True))
        else:
            here = moving._replace(
                x=lattice.xs[window[0]][:, None] + moving.x, y=lattice.ys[window[1]][None, :] + moving.y
            )
            found.append((window, depth(here, others[k]) > EPSILON))
    return found


def in_disc(lattice: Lattice, moving: Spot, x: float, y: float, radius: float) -> Flags:
    """`[X, Y]` where `moving`, whose x and y are offsets to the lattice, would reach into a disc."""
    here = moving._replace(x=lattice.xs[:, None] + moving.x, y=lattice.ys[None, :] + moving.y)
    u, v = here.local(x, y)
    gap = np.hypot(np.maximum(np.abs(u) - moving.w / 2, 0.0), np.maximum(np.abs(v) - moving.d / 2, 0.0))
    inside: Flags = gap < radius - EPSILON
    return inside
