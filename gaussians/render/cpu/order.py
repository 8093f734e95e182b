"""Sort footprints by depth, then into tiles: stable counting sorts.

Equal depths keep row order, and the result does not depend on the number of workers.
"""

from __future__ import annotations

import numpy as np

from ... import compiled
from ...compiled import helper, kernel
from .layout import (
    CORNER_Y,
    EXTREME,
    KEY,
    L3,
    LIMIT,
    MASK_SIDE,
    REACH_Y,
    SLOPE,
    WIDTH,
    Array,
    Ellipse,
    View,
    X,
    Y,
    tile_rows,
    tile_span,
)
from .touch import lowest_bit, prefetch

DIGIT = 12  # bits of a radix-sort digit: 4096 counters of 32 bits stay in the first-level cache
BUCKETS = 1 << DIGIT
DIGIT_BITS = np.uint64(DIGIT)
PARTS = 4  # at most: each may need a list of all rows
ALONE = 1 << 15  # Gaussians up to which a second thread costs more than it saves
FARTHEST = np.uint64((1 << 64) - 1)  # beyond every depth
AHEAD = 32  # rows between the prefetch of a footprint's tiles and their use
# Masks of at most 2x2 tiles are counted without a branch on each tile: processors cannot predict it.
SQUARE = np.uint64(0b11 | 0b11 << MASK_SIDE)


def divide(means: Array, view: View, workers: int, count: int) -> Array:
    """Depths that divide the `count` rows of a cloud into parts of about one size, each of which a worker sorts.

    Args:
        means: `[M, 3]`, an even sample of the centres.

    Returns:
        `[parts - 1]` uint64, bits of depths above the bits of a row. They do not change the order.
    """
    parts = min(workers, PARTS) if count > ALONE else 1
    with np.errstate(invalid="ignore", over="ignore"):
        offset = means - np.array([view.ex, view.ey, view.ez])
        u, v, depth = np.array([view[:3], view[3:6], view[6:9]]) @ offset.T
        inside = (depth > view.near) & (u > view.u0 * depth) & (u < view.u1 * depth)
        inside &= (v > view.v0 * depth) & (v < view.v1 * depth) & (depth < view.far)
    depth = np.sort(depth[inside])
    if not len(depth):
        return np.full(parts - 1, FARTHEST)
    levels = depth[len(depth) * np.arange(1, parts) // parts]
    return np.asarray(levels.view(np.uint32).astype(np.uint64) << KEY)


def by_depth(visible: Array, found: Array) -> Array:
    """Sort rows by depth, the nearest first, one worker for each part.

    Args:
        visible: `[parts, chunks, chunk]` uint64, the rows below the bits of their depths. The depths of a part are less
            than those of the next.
        found: `[chunks, parts]` int32, how many values each chunk begins with.

    Returns:
        The rows, int32.
    """
    count = int(found.sum())
    buffers, rows = np.empty((2, count), np.uint64), np.empty(count, np.int32)
    parts = len(visible)
    compiled.run(depth_order, parts, visible, found, buffers, rows, np.empty((parts, BUCKETS), np.int32))
    return rows


@kernel
def depth_order(part, parts, visible, found, buffers, rows, tally):  # type: ignore[no-untyped-def]
    """Sort one part into its places in `rows` (see `by_depth`): an LSD radix sort by as many digits as its depths
    differ in, at least two.

    `buffers` is `[2, len(rows)]` uint64, `tally` `[parts, BUCKETS]` int32.
    """
    start = 0
    for c in range(found.shape[0]):
        for before in range(part):
            start += found[c, before]
    lists, places = visible[part], tally[part]
    count, nearest, farthest = _extent(lists, found, part)
    source, target = buffers[0, start : start + count], buffers[1, start : start + count]
    shift = KEY
    places[:] = 0
    for c in range(found.shape[0]):
        for value in lists[c, : found[c, part]]:
            places[_digit(value, nearest, shift)] += 1
    _add_up(places)
    for c in range(found.shape[0]):
        for value in lists[c, : found[c, part]]:
            source[_place(value, nearest, shift, places)] = value
    shift += DIGIT_BITS
    while farthest - nearest >> shift >> DIGIT_BITS != 0:
        _offsets(source, nearest, shift, places)
        for value in source:
            target[_place(value, nearest, shift, places)] = value
        source, target = target, source
        shift += DIGIT_BITS
    _offsets(source, nearest, shift, places)
    for value in source:
        rows[start + _place(value, nearest, shift, places)] = np.int32(value)


@helper
def _extent(lists, found, part):  # type: ignore[no-untyped-def]
    """How many values a part has, and its least and largest depth (as values without a row)."""
    count, nearest, farthest = 0, FARTHEST, np.uint64(0)
    for c in range(found.shape[0]):
        count += found[c, part]
        for value in lists[c, : found[c, part]]:
            nearest, farthest = min(nearest, value), max(farthest, value)
    return count, nearest >> KEY << KEY, farthest >> KEY << KEY


@helper
def _digit(value, nearest, shift):  # type: ignore[no-untyped-def]
    """The digit of the depth behind `nearest` that begins at bit `shift`."""
    return np.int64((value - nearest) >> shift) & (BUCKETS - 1)


@helper
def _offsets(source, nearest, shift, places):  # type: ignore[no-untyped-def]
    """Fill `places` with where each bucket of a digit begins."""
    places[:] = 0
    for value in source:
        places[_digit(value, nearest, shift)] += 1
    _add_up(places)


@helper
def _add_up(places):  # type: ignore[no-untyped-def]
    """Turn the sizes of buckets into where they begin."""
    total = 0
    for bucket in range(BUCKETS):
        size = places[bucket]
        places[bucket] = total
        total += size


@helper
def _place(value, nearest, shift, places):  # type: ignore[no-untyped-def]
    """Where a value belongs by a digit; the next one of its bucket belongs behind it."""
    bucket = _digit(value, nearest, shift)
    place = places[bucket]
    places[bucket] = place + 1
    return place


@helper
def _ellipse(records, n):  # type: ignore[no-untyped-def]
    """The ellipse that record `n` holds."""
    return Ellipse(
        records[n, X], records[n, Y], records[n, L3], records[n, LIMIT],
        records[n, REACH_Y], records[n, SLOPE], records[n, WIDTH], records[n, EXTREME],
    )  # fmt: skip


@helper
def _first_tile(corner, tiles_wide):  # type: ignore[no-untyped-def]
    """Index of the tile at a footprint's corner."""
    return np.int64(corner >> CORNER_Y) * tiles_wide + np.int64(corner & np.uint64(0xFFFF))


@helper
def _bit(mask, place):  # type: ignore[no-untyped-def]
    """A bit of a mask, 0 or 1."""
    return np.int64(mask >> np.uint64(place)) & 1


@kernel
def count_tiles(worker, workers, order, records, spots, view, tiles_wide, tally):  # type: ignore[no-untyped-def]
    """Add this worker's share of `order` to `tally[worker]`, which holds zeros.

    `tally` is `[workers, tiles + tiles_wide + 2]` int64: 2x2 tiles from the last one on end in its margin.
    """
    mine = tally[worker]
    for k in range(order.shape[0] * worker // workers, order.shape[0] * (worker + 1) // workers):
        prefetch(spots, order[min(k + AHEAD, order.shape[0] - 1)])
        n = order[k]
        touched = spots[n, 0]
        if touched == 0:
            ellipse = _ellipse(records, n)
            top, bottom = tile_rows(ellipse, view.height)
            for row in range(top, bottom):
                first, last = tile_span(ellipse, row, view.width)
                for column in range(first, last):
                    mine[row * tiles_wide + column] += 1
        base = _first_tile(spots[n, 1], tiles_wide)
        if touched & ~SQUARE == 0:
            below = base + tiles_wide
            mine[base] += _bit(touched, 0)
            mine[base + 1] += _bit(touched, 1)
            mine[below] += _bit(touched, MASK_SIDE)
            mine[below + 1] += _bit(touched, MASK_SIDE + 1)
            continue
        while touched != 0:
            bit = lowest_bit(touched)
            touched &= touched - np.uint64(1)
            mine[base + bit // MASK_SIDE * tiles_wide + bit % MASK_SIDE] += 1


@kernel
def starts(tally, first):  # type: ignore[no-untyped-def]
    """Turn counts from `count_tiles` into where each worker writes; fill `first` `[tiles + 1]`; returns the total."""
    total = 0
    for tile in range(first.shape[0] - 1):
        first[tile] = total
        for worker in range(tally.shape[0]):
            size = tally[worker, tile]
            tally[worker, tile] = total
            total += size
    first[first.shape[0] - 1] = total
    return total


@kernel
def fill_tiles(worker, workers, order, records, spots, view, tiles_wide, places, entries):  # type: ignore[no-untyped-def]
    """Write rows into `entries`, tile by tile and nearest first; visits tiles in the same order as `count_tiles`."""
    mine = places[worker]
    for k in range(order.shape[0] * worker // workers, order.shape[0] * (worker + 1) // workers):
        prefetch(spots, order[min(k + AHEAD, order.shape[0] - 1)])
        n = order[k]
        touched = spots[n, 0]
        if touched == 0:
            ellipse = _ellipse(records, n)
            top, bottom = tile_rows(ellipse, view.height)
            for row in range(top, bottom):
                first, last = tile_span(ellipse, row, view.width)
                for column in range(first, last):
                    tile = row * tiles_wide + column
                    entries[mine[tile]] = n
                    mine[tile] += 1
        base = _first_tile(spots[n, 1], tiles_wide)
        while touched != 0:
            bit = lowest_bit(touched)
            touched &= touched - np.uint64(1)
            tile = base + bit // MASK_SIDE * tiles_wide + bit % MASK_SIDE
            entries[mine[tile]] = n
            mine[tile] += 1
