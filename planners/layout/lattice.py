"""Lattices of positions for the middle of a box, and a test at which of them the box overlaps others."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...gaussians.world.box import YawBox, cos_sin, extent_along, is_square, shared_height

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]
EPSILON = 1e-6  # metres; boxes that share no more than this touch
TURNS = (0.0, 90.0, 180.0, -90.0)


class Lattice(NamedTuple):
    """Positions `xs[i], ys[j]`, both ascending, for the middle of a thing turned by `yaw` degrees."""

    xs: F64
    ys: F64
    yaw: float


def blocked(lattice: Lattice, moving: YawBox, fixed: Sequence[YawBox], into: Flags) -> None:
    """Mark in `into` `[X, Y]` where `moving`, whose x and y are offsets to the lattice, would overlap any of `fixed`.

    A box along the axes forbids exactly a rectangle of middles (its Minkowski sum with the moving one).
    """
    for window, meets in overlap_windows(lattice, moving, fixed):
        into[window] |= meets


def overlap_windows(lattice: Lattice, moving: YawBox, fixed: Sequence[YawBox]) -> list[tuple[tuple[slice, slice], Any]]:
    """For each box of `fixed` within reach: a window of the lattice, and where in it the two boxes overlap."""
    others = [f for f in fixed if shared_height(f, moving) > EPSILON]
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
            dx = lattice.xs[window[0]][:, None] + (moving.x - others[k].x)
            dy = lattice.ys[window[1]][None, :] + (moving.y - others[k].y)
            found.append((window, _meet(dx, dy, moving, others[k])))
    return found


def _meet(dx: F64, dy: F64, moving: YawBox, other: YawBox) -> Flags:
    """Where two footprints overlap by their separating axes, for offsets within reach of both along the room's axes, so
    that the axes of a box that is aligned with the room separate nothing there."""
    meets: Flags = np.ones((len(dx), dy.shape[1]), bool)
    for yaw in dict.fromkeys((moving.yaw, other.yaw)):
        if is_square(yaw):
            continue
        c, s = cos_sin(yaw)
        for x, y, turn in ((c, s, yaw), (-s, c, yaw + 90.0)):
            reach = (extent_along(moving, turn) + extent_along(other, turn)) / 2 - EPSILON
            meets &= np.abs(dx * x + dy * y) < reach
    return meets


def in_disc(lattice: Lattice, moving: YawBox, x: float, y: float, radius: float) -> Flags:
    """`[X, Y]` where `moving`, whose x and y are offsets to the lattice, would reach into a disc."""
    here = moving._replace(x=lattice.xs[:, None] + moving.x, y=lattice.ys[None, :] + moving.y)
    inside: Flags = here.distance_to(x, y) < radius - EPSILON
    return inside
