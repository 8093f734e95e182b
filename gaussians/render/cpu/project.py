"""Project Gaussians to image footprints (EWA splatting): one compiled pass over the rows of a cloud.

Output is written at the row's own index, so the result does not depend on which thread processed a row. Arithmetic
(`footprint`, `shade`) is done for 16 rows at once; what only visible rows need is done row by row.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ... import compiled
from ...compiled import exact, fetch_add, helper
from .footprint import LEVEL, PLACES, approach, footprints
from .lanes import LANES
from .layout import (
    BIT,
    CORNER_Y,
    DEPTH,
    EXTREME,
    KEY,
    L3,
    LIMIT,
    MASK_SIDE,
    ONE,
    REACH_Y,
    RECORD,
    RED,
    SLOPE,
    WIDTH,
    Array,
    Ellipse,
    View,
    X,
    Y,
    tile_span,
)
from .shade import TERMS, directions, fill_terms, plain, shade
from .touch import lowest_bit

CHUNK = 2048  # rows a worker takes at a time
WHOLE = np.int64((1 << LANES) - 1)


@dataclass(frozen=True)
class Projected:
    """The footprints of a cloud of N Gaussians.

    Attributes:
        records: `[N, 16]` float32 (`layout`); of rows that are not visible, anything.
        spots: `[N, 2]` uint64, the tiles touched as a mask from the corner on (0 if they are too many) and the corner,
            the first tile (x | y << 16).
        visible: `[N]` uint64, the visible rows below the bits of their depths (a positive float), packed to the front
            of each chunk of `CHUNK` rows.
        found: `[chunks]` int32, how many these are.
    """

    records: Array
    spots: Array
    visible: Array
    found: Array


def make_records(count: int) -> Array:
    """Allocate records `[count, 16]` float32, each on one cache line: numpy aligns large arrays to 16 bytes."""
    line = RECORD * np.dtype(np.float32).itemsize
    room = np.empty(count * RECORD + RECORD, np.float32)
    start = -room.ctypes.data % line // room.itemsize
    return room[start : start + count * RECORD].reshape(count, RECORD)


def run(columns: tuple[Array, ...], view: View, workers: int) -> Projected:
    """Project every row of means, quats, scales, opacities, sh and group (int32).

    Fewer rows than the kernel takes at once are followed by invisible ones.
    """
    short = max(0, LANES - len(columns[0]))
    columns = tuple(np.ascontiguousarray(column) for column in columns)
    if short:
        columns = tuple(np.concatenate([c, np.zeros((short, *c.shape[1:]), c.dtype)]) for c in columns)
    n = len(columns[0])
    out = make_records(n), np.empty((n, 2), np.uint64), np.empty(n, np.uint64), np.empty(-(-n // CHUNK), np.int32)
    scratch = (
        np.empty((workers, PLACES * LANES), np.float32), np.empty((workers, LANES, RECORD), np.float32),
        np.empty((workers, 3, LANES), np.uint64), np.empty((workers, TERMS * LANES), np.float32),
    )  # fmt: skip
    compiled.run(project, workers, *columns, view, out, scratch, np.zeros(1, np.int64))
    return Projected(*out)


@exact
def project(worker, workers, means, quats, scales, opacities, sh, group, view, out, scratch, counter):  # type: ignore[no-untyped-def]
    """Project every row of at least 16; `out` is what `Projected` holds, `counter` `[1]` int64 holding 0."""
    records, spots, visible, found = out
    places, table, tiles, terms = scratch[0][worker], scratch[1][worker], scratch[2][worker], scratch[3][worker]
    depth_bits, bands = table.view(np.uint32), sh.shape[1]
    per_alpha = ONE / view.alpha_min
    rows = means.shape[0]
    while True:
        chunk = fetch_add(counter, 1)
        start = chunk * CHUNK
        if start >= rows:
            break
        fill = start
        for group_start in range(start, min(start + CHUNK, rows), LANES):
            first = min(group_start, rows - LANES)  # rows below `group_start` belong to the group before
            seen = approach(means, scales, opacities, first, view, places) & (WHOLE << (group_start - first))
            if seen == 0:
                continue
            left = np.uint64(seen)
            while left != 0:
                lane = lowest_bit(left)
                left &= left - BIT
                places[LEVEL * LANES + lane] = math.log(min(opacities[first + lane], ONE) * per_alpha)
            seen = footprints(quats, scales, group, first, view, places, seen, table, tiles)
            if seen == 0:
                continue
            if bands == 1:
                seen &= plain(sh, first, terms)
            else:
                directions(places, terms)
                fill_terms(terms, bands)
            left = np.uint64(seen)
            while left != 0:
                lane = lowest_bit(left)
                left &= left - BIT
                n = first + lane
                touched, corner = tiles[0, lane], tiles[1, lane]
                if touched == 0:
                    touched, some = _touched(table, lane, corner, tiles[2, lane], view)
                    if not some:
                        continue
                for place in range(RECORD):
                    records[n, place] = table[lane, place]
                if bands == 1:
                    for channel in range(3):
                        records[n, RED + channel] = terms[channel * LANES + lane]
                elif shade(sh, n, terms, lane, bands, records) == 0:
                    continue
                spots[n, 0] = touched
                spots[n, 1] = corner
                visible[fill] = (np.uint64(depth_bits[lane, DEPTH]) << KEY) | np.uint64(n)
                fill += 1
        found[chunk] = fill - start


@helper
def _touched(table, lane, corner, size, view):  # type: ignore[no-untyped-def]
    """The mask of tiles that the ellipse in `lane` of `table` touches (0: too many for a mask), and whether there are
    any."""
    left, top = np.int64(corner & np.uint64(0xFFFF)), np.int64(corner >> CORNER_Y)
    wide, high = np.int64(size & np.uint64(0xFFFF)), np.int64(size >> CORNER_Y)
    if wide > MASK_SIDE or high > MASK_SIDE:
        return np.uint64(0), True
    ellipse = Ellipse(
        table[lane, X], table[lane, Y], table[lane, L3], table[lane, LIMIT],
        table[lane, REACH_Y], table[lane, SLOPE], table[lane, WIDTH], table[lane, EXTREME],
    )  # fmt: skip
    mask = np.uint64(0)
    for row in range(top, top + high):
        first, last = tile_span(ellipse, row, view.width)
        first, last = max(first, left), min(last, left + wide)
        run = (BIT << np.uint64(max(last - first, 0))) - BIT
        mask |= run << np.uint64((row - top) * MASK_SIDE + max(first - left, 0))
    return mask, mask != np.uint64(0)
