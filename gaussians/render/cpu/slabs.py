"""Draw one picture in slabs of depth, the nearest first, for scenes whose footprints do not fit into memory at once.

What a pixel has received stays between slabs, so that the sums are those of `blend.draw` in the same order: a picture
in slabs has the bytes of the picture in one. Footprints of equal depth follow each other by id, as rows of a file do.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import compiled
from ...camera import Camera, Vec3
from ...compiled import fetch_add, kernel, make_lines
from . import LIMITS, MAX_ENTRIES, make_image
from . import order as sorting
from . import project as projecting
from .blend import _begin, _draw_chunk, _finish, _gather, make_scratch
from .layout import DEPTH, RECORD, TILE, make_view
from .simd import STATE
from .touch import BLOCKS
from .touch import CHUNK as SLOTS

Array = NDArray[Any]
BYTES = RECORD * 4 + 2 * 8 + 3 * 8 + 2 * 8 + 4 + 16  # of memory that a footprint takes, with what sorting it takes


NOWHERE = (math.inf, -1)


def _before(end: tuple[float, int], depth: Array, ids: NDArray[np.int64]) -> NDArray[np.bool_]:
    """`[N]`: which footprints come before one with a depth and an id."""
    level = np.float32(end[0])
    found: NDArray[np.bool_] = (depth < level) | ((depth == level) & (ids < end[1]))
    return found


class Canvas:
    """A picture that is being drawn.

    Args:
        near: distance of the near plane, scene units.
        room: most footprints of a slab.

    Attributes:
        begins: depth and id of the footprint that the present slab may begin with.
        ends: depth and id of the footprint before which it ends; infinite until it is full.
        drawn: footprints drawn so far.
        slabs: slabs drawn so far.
    """

    def __init__(self, camera: Camera, near: float, room: int) -> None:
        self._view = make_view(camera, near, 0, camera.height)
        self._size = (camera.width, camera.height)
        self._tiles_wide, self._tiles_high = (-(-side // TILE) for side in self._size)
        tiles = self._tiles_wide * self._tiles_high
        self._state = np.empty((tiles, BLOCKS * STATE), np.float32)
        self._alive = np.empty((tiles, BLOCKS), np.bool_)
        compiled.run_alone(start, self._state, self._alive, self._size)
        self._records, self._spots = make_lines(room, RECORD, np.float32), np.empty((room, 2), np.uint64)
        self._ids, self._count = np.empty(room, np.int64), 0
        self.begins, self.ends = (0.0, -1), NOWHERE
        self.drawn = self.slabs = 0

    @property
    def finished(self) -> bool:
        """Whether no pixel takes any more."""
        return not bool(self._alive.any())

    def add(self, columns: tuple[Array, ...], ids: NDArray[np.int64]) -> None:
        """Add the footprints of some rows that lie in the present slab; it ends earlier if they are too many.

        Args:
            columns: means, quats, scales, opacities, sh, group, as `project.run` takes them.
            ids: `[N]`, different in all rows that are ever added.
        """
        found = projecting.run(columns, self._view, compiled.workers())
        records, spots = found.records, found.spots
        rows = np.concatenate([np.zeros(0, np.int64), *(
            (found.visible[0, c, :k] & np.uint64(0xFFFFFFFF)).astype(np.int64) for c, k in enumerate(found.found[:, 0])
        )])  # fmt: skip
        rows = rows[~_before(self.begins, records[rows, DEPTH], ids[rows])]
        rows = rows[_before(self.ends, records[rows, DEPTH], ids[rows])]
        while len(rows):
            left = len(self._ids) - self._count
            now, rows = rows[:left], rows[left:]
            span = slice(self._count, self._count + len(now))
            self._records[span], self._spots[span], self._ids[span] = records[now], spots[now], ids[now]
            self._count += len(now)
            if len(rows):
                self._halve()
                rows = rows[_before(self.ends, records[rows, DEPTH], ids[rows])]

    def draw(self) -> None:
        """Draw the present slab and begin the next."""
        while not self._drawn():
            self._halve()
        self.drawn, self.slabs = self.drawn + self._count, self.slabs + 1
        self.begins, self.ends, self._count = self.ends, NOWHERE, 0

    def picture(self, background: Vec3, camera: Camera) -> tuple[Array, ...]:
        """The picture: rgb, alpha, depth and group, as `cpu.make_image` makes them."""
        out = make_image(camera)
        colors = tuple(np.float32(channel) for channel in background)
        compiled.run_alone(end, self._state, self._size, colors, out)
        return out

    def _halve(self) -> None:
        """Let the slab end at about the median of its footprints, and forget those from there on."""
        depth, ids = self._records[: self._count, DEPTH], self._ids[: self._count]
        middle = np.partition(depth, self._count // 2)[self._count // 2]
        level = np.flatnonzero(depth == middle)
        self.ends = (float(middle), -1)
        if 4 * int((depth < middle).sum()) < self._count:  # a wall straight ahead: it is divided by ids
            self.ends = (float(middle), int(np.partition(ids[level], len(level) // 2)[len(level) // 2]))
        kept = np.flatnonzero(_before(self.ends, depth, ids))
        for column in (self._records, self._spots, self._ids):
            column[: len(kept)] = column[kept]
        self._count = len(kept)

    def _drawn(self) -> bool:
        """Draw the footprints of the slab; False, and nothing is drawn, if they touch too many tiles."""
        n, workers = self._count, compiled.workers()
        if not n:
            return True
        slots = np.argsort(self._ids[:n], kind="stable").astype(np.uint64)
        bits = self._records[:n, DEPTH].view(np.int32)[slots].astype(np.uint64)
        rows = sorting.by_depth(((bits << np.uint64(32)) | slots).reshape(1, 1, n), np.array([[n]], np.int32))
        sorted_ = rows, self._records, self._spots, self._view, self._tiles_wide
        tiles = len(self._alive)
        places = np.zeros((workers, tiles + self._tiles_wide + 2), np.int64)
        compiled.run(sorting.count_tiles, workers, *sorted_, places)
        first = np.empty(tiles + 1, np.int64)
        total = compiled.run_alone(sorting.starts, places, first)
        if total > MAX_ENTRIES and n > 1:
            return False
        entries = np.empty(total, np.int32)
        compiled.run(sorting.fill_tiles, workers, *sorted_, places, entries)
        rest = self._size[0], LIMITS, self._state, self._alive, make_scratch(workers), np.zeros(1, np.int64)
        compiled.run(draw_on, workers, first, entries, self._records, *rest)
        return True


@kernel
def start(state, alive, size):  # type: ignore[no-untyped-def]
    """Initialise the state `[tiles, BLOCKS * STATE]` and the unfinished blocks `[tiles, BLOCKS]` of a picture."""
    tiles_wide = (size[0] + TILE - 1) // TILE
    for tile in range(state.shape[0]):
        x, y = tile % tiles_wide * TILE, tile // tiles_wide * TILE
        _begin(state[tile], alive[tile], STATE, size[0] - x, size[1] - y)


@kernel
def draw_on(worker, workers, first, entries, records, width, limits, state, alive, scratch, counter):  # type: ignore[no-untyped-def]
    """As `blend.draw`, going on with the state of each tile and leaving it as it is then."""
    tiles_wide = (width + TILE - 1) // TILE
    chunk, touched = scratch[0][worker], scratch[1][worker]
    while True:
        tile = fetch_add(counter, 1)
        if tile >= first.shape[0] - 1:
            break
        x, y = tile % tiles_wide * TILE, tile // tiles_wide * TILE
        begun, stop = first[tile], first[tile + 1]
        while begun < stop:
            count = min(SLOTS, stop - begun)
            _gather(entries, begun, count, records, chunk, touched, np.float32(x), np.float32(y))
            begun = stop if _draw_chunk(chunk, touched, state[tile], alive[tile], limits, False) else begun + count


@kernel
def end(state, size, background, out):  # type: ignore[no-untyped-def]
    """Write all pixels, composited over the background."""
    tiles_wide = (size[0] + TILE - 1) // TILE
    for tile in range(state.shape[0]):
        _finish(state[tile], tile % tiles_wide * TILE, tile // tiles_wide * TILE, size, background, out)
