"""Project Gaussians to image footprints (EWA splatting): one compiled pass over the rows of a cloud.

Output is written at the row's own index, so the result does not depend on which thread processed a row. Arithmetic
(`footprint`, `shade`) is done for 16 rows at once; what only visible rows need is done row by row.
"""

from __future__ import annotations

import math
import weakref
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ... import compiled
from ...compiled import exact, fetch_add, give_room, helper, make_lines, take_room
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
WHOLE_DEPTH = np.empty(0, np.uint64)  # bounds of one part


@dataclass(frozen=True)
class Projected:
    """The footprints of a cloud of N Gaussians. Refer to it as long as its arrays are read: their memory is used again
    when nothing does.

    Attributes:
        records: `[N, 16]` float32 (`layout`); of rows that are not visible, anything.
        spots: `[N, 2]` uint64, the tiles touched as a mask from the corner on (0 if they are too many) and the corner,
            the first tile (x | y << 16).
        visible: `[parts, chunks, CHUNK]` uint64, the visible rows below the bits of their depths (a positive float),
            listed by the part of the depths that they belong to and the chunk of `CHUNK` rows.
        found: `[chunks, parts]` int32, the lengths of these lists.
    """

    records: Array
    spots: Array
    visible: Array
    found: Array


def run(columns: tuple[Array, ...], view: View, workers: int, bounds: Array = WHOLE_DEPTH) -> Projected:
    """Project every row of means, quats, scales, opacities, sh and group (int32).

    `bounds` `[parts - 1]` are the depths between parts (`order.divide`). Fewer rows than the kernel takes at once are
    followed by invisible ones.
    """
    short = max(0, LANES - len(columns[0]))
    columns = tuple(np.ascontiguousarray(column) for column in columns)
    if short:
        columns = tuple(np.concatenate([c, np.zeros((short, *c.shape[1:]), c.dtype)]) for c in columns)
    n = len(columns[0])
    chunks, parts = -(-n // CHUNK), len(bounds) + 1
    shapes = (n, RECORD), (n, 2), (parts, chunks, CHUNK)
    room = take_room(4 * n * RECORD + 8 * (2 * n + parts * chunks * CHUNK))
    out = *_divided(room, shapes, (np.float32, np.uint64, np.uint64)), np.zeros((chunks, parts), np.int32)
    scratch = (
        make_lines(workers, PLACES * LANES, np.float32),
        make_lines(workers, LANES * RECORD, np.float32).reshape(workers, LANES, RECORD),
        make_lines(workers, 3 * LANES, np.uint64).reshape(workers, 3, LANES),
        make_lines(workers, TERMS * LANES, np.float32), make_lines(workers, parts, np.int64),
    )  # fmt: skip
    compiled.run(project, workers, *columns, view, bounds, out, scratch, np.zeros(1, np.int64))
    found = Projected(*out)
    weakref.finalize(found, give_room, room).atexit = False
    return found


def _divided(room: Array, shapes: tuple[tuple[int, ...], ...], kinds: tuple[type, ...]) -> Iterator[Array]:
    """Arrays one after another in some bytes."""
    start = 0
    for shape, kind in zip(shapes, kinds, strict=True):
        stop = start + math.prod(shape) * np.dtype(kind).itemsize
        yield room[start:stop].view(kind).reshape(shape)
        start = stop


@exact
def project(worker, workers, means, quats, scales, opacities, sh, group, view, bounds, out, scratch, counter):  # type: ignore[no-untyped-def]
    """Project every row of at least 16; `out` is what `Projected` holds, `counter` `[1]` int64 holding 0."""
    records, spots, visible, found = out
    places, table, tiles, terms = scratch[0][worker], scratch[1][worker], scratch[2][worker], scratch[3][worker]
    ends = scratch[4][worker]  # of the lists of a chunk: `found` lies on cache lines that workers share
    depth_bits, bands = table.view(np.uint32), sh.shape[1]
    per_alpha = ONE / view.alpha_min
    rows = means.shape[0]
    while True:
        chunk = fetch_add(counter, 1)
        start = chunk * CHUNK
        if start >= rows:
            break
        ends[:] = 0
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
                value = (np.uint64(depth_bits[lane, DEPTH]) << KEY) | np.uint64(n)
                part = 0
                for k in range(bounds.shape[0]):
                    part += bounds[k] <= value
                visible[part, chunk, ends[part]] = value
                ends[part] += 1
        for part in range(bounds.shape[0] + 1):
            found[chunk, part] = ends[part]


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
