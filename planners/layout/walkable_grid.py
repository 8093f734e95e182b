"""A grid of the walkable floor, updated with each added or removed thing: which things can a person still walk up to?

The cells are those of `planners.rooms.floor_grid`, so that this test and the checker's give the same result.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from ...gaussians.world.box import YawBox
from ...gaussians.world.person import ARM, HEADROOM, SHOULDERS, STEP
from ..rooms.floor_grid import CELL
from .lattice import EPSILON

_MAX_CELLS = 400  # cells along a side; the cells of larger halls grow
_ALL_AROUND = np.ones((3, 3))


class _Stamp(NamedTuple):
    """Cells that a thing blocks (None: people walk over or under it), and cells from which it is within reach."""

    window: tuple[slice, slice]
    taken: NDArray[np.int16] | None
    near: NDArray[np.bool_]


class WalkableGrid:
    """The floor as cells, the things that block them, and the things that must be accessible.

    Args:
        size: width and depth of the room, metres.
        width: of the person, metres.
    """

    def __init__(self, size: tuple[float, float], width: float) -> None:
        cell = max(CELL, max(size) / _MAX_CELLS)
        self.half = width / 2 - 1e-9
        self.xs, self.ys = ((np.arange(n) - (n - 1) / 2) * cell for n in (max(int(s / cell), 1) for s in size))
        inside = (np.abs(self.xs) <= size[0] / 2 - self.half)[:, None] & (np.abs(self.ys) <= size[1] / 2 - self.half)
        self.taken = np.where(inside, 0, 1).astype(np.int16)
        self.stamps: dict[Hashable, _Stamp] = {}
        self.required: set[Hashable] = set()
        self.doors: set[Hashable] = set()
        self.width = width
        self._lost: frozenset[Hashable] | None = None  # what is not accessible, until a thing is put or taken

    def put(self, name: Hashable, spot: YawBox, required: bool, door: bool = False) -> None:
        """Add a thing. `required`: it must be accessible; `door`: people enter by it."""
        stamp = self._stamp(spot, SHOULDERS + ARM if door else self.width / 2 + ARM)
        self.stamps[name] = stamp
        self._lost = None
        if stamp.taken is not None:
            self.taken[stamp.window] += stamp.taken
        if door:
            self.doors.add(name)
        elif required:
            self.required.add(name)

    def take(self, name: Hashable) -> None:
        """Remove a thing."""
        stamp = self.stamps.pop(name)
        self._lost = None
        if stamp.taken is not None:
            self.taken[stamp.window] -= stamp.taken
        self.required.discard(name)
        self.doors.discard(name)

    def unreached(self) -> frozenset[Hashable]:
        """Things that must be accessible and are not."""
        if self._lost is None:
            self._lost = frozenset(self._found_unreached())
        return self._lost

    def _found_unreached(self) -> set[Hashable]:
        if not self.required:
            return set()
        areas, count = scipy.ndimage.label(self.taken == 0, structure=_ALL_AROUND)
        if not count:
            return set(self.required)
        if self.doors:
            entered = {int(a) for d in self.doors for a in self._beside(areas, d)[:1]}
            lost: set[Hashable] = {d for d in self.doors if not self._beside(areas, d)}
        else:
            lost, entered = set(), {int(np.bincount(areas.ravel())[1:].argmax()) + 1}
        walkable = np.isin(areas, sorted(entered)) if count > 1 else areas > 0
        for name in self.required:
            stamp = self.stamps[name]
            if not (walkable[stamp.window] & stamp.near).any():
                lost.add(name)
        return lost

    def _beside(self, areas: NDArray[np.int32], name: Hashable) -> list[int]:
        """Connected areas within reach of a thing, the one with the most cells there first."""
        stamp = self.stamps[name]
        here = np.bincount(areas[stamp.window][stamp.near])
        here[:1] = 0
        return [int(a) for a in np.argsort(-here, kind="stable") if here[a]]

    def _stamp(self, spot: YawBox, arm: float) -> _Stamp:
        reach = float(np.hypot(spot.w, spot.d)) / 2 + max(arm, self.half)
        x, y = (
            slice(*np.searchsorted(cells, (middle - reach, middle + reach)).tolist())
            for cells, middle in ((self.xs, spot.x), (self.ys, spot.y))
        )
        gap = spot.distance_to(self.xs[x][:, None], self.ys[y][None, :])
        solid = spot.high > STEP and spot.low < HEADROOM
        return _Stamp((x, y), (gap < self.half).astype(np.int16) if solid else None, gap <= arm - EPSILON)


def walkable_grids(size: tuple[float, float], widths: Iterable[float]) -> tuple[WalkableGrid, ...]:
    """One grid for each width of a person, the widest first; no width is below the checker's."""
    return tuple(WalkableGrid(size, width) for width in sorted({max(w, SHOULDERS) for w in widths}, reverse=True))
