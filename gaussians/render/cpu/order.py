"""Sort footprints by depth, then into tiles: two stable counting sorts.

Equal depths keep row order, and the result does not depend on the number of workers.
"""

from __future__ import annotations

import numpy as np

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
    Ellipse,
    X,
    Y,
    tile_rows,
    tile_span,
)
from .touch import lowest_bit, prefetch

DIGIT = 11  # bits of a radix-sort digit: 2048 counters stay in the first-level cache
BUCKETS = 1 << DIGIT
AHEAD = 32  # rows between the prefetch of a footprint's tiles and their use
DIGITS = 3  # 3 x 11 bits hold the 31 of a positive float
# Masks of at most 2x2 tiles are counted without a branch on each tile: processors cannot predict it.
SQUARE = np.uint64(0b11 | 0b11 << MASK_SIDE)


@kernel
def depth_order(visible, found, chunk, buffer, rows, tally):  # type: ignore[no-untyped-def]
    """Sort the visible rows by depth into `rows` (LSD radix sort); returns how many there are.

    `visible` `[N]` holds depth and row, packed to the front of chunks of `chunk`, `found[c]` of them in chunk c; it is
    overwritten. `buffer` is `[N]` uint64, `rows` `[N]` int32, `tally` `[DIGITS, BUCKETS]` int64 holding zeros.
    """
    count = 0
    for c in range(found.shape[0]):
        for i in range(c * chunk, c * chunk + found[c]):
            value = visible[i]
            buffer[count] = value
            count += 1
            for digit in range(DIGITS):
                tally[digit, _digit(value, digit)] += 1
    source, target = buffer, visible
    for digit in range(DIGITS):
        if _offsets(tally[digit], count):
            _scatter(tally[digit], digit, count, source, target)
            source, target = target, source
    for i in range(count):
        rows[i] = np.int32(source[i])
    return count


@helper
def _digit(value, digit):  # type: ignore[no-untyped-def]
    """A digit of the depth, the lowest first."""
    return np.int64(value >> (KEY + np.uint64(DIGIT * digit))) & (BUCKETS - 1)


@helper
def _offsets(tally, count):  # type: ignore[no-untyped-def]
    """Turn the counts of a digit into where each bucket begins; False if all of `count` values share that digit."""
    total = 0
    for bucket in range(BUCKETS):
        size = tally[bucket]
        if size == count:
            return False
        tally[bucket] = total
        total += size
    return True


@helper
def _scatter(places, digit, count, source, target):  # type: ignore[no-untyped-def]
    """One stable pass from `source` to `target` by a digit whose buckets begin at `places`."""
    for i in range(count):
        value = source[i]
        bucket = _digit(value, digit)
        place = places[bucket]
        places[bucket] = place + 1
        target[place] = value


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
