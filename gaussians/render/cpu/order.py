"""Sort footprints by depth, then into tiles: two stable counting sorts.

Equal depths keep row order, and the result does not depend on the number of workers.
"""

from __future__ import annotations

import numpy as np

from ...compiled import helper, kernel
from .project import EXTREME, L3, LIMIT, MASK_SIDE, REACH_Y, SLOPE, WIDTH, Ellipse, X, Y, tile_rows, tile_span
from .touch import lowest_bit

DIGIT = 11  # bits of a radix-sort digit: 2048 counters stay in the first-level cache
BUCKETS = 1 << DIGIT
DIGITS = 3  # 3 x 11 bits hold the 31 of a positive float


@kernel
def depth_order(depth, visible, found, chunk, keys, rows, tally):  # type: ignore[no-untyped-def]
    """Sort rows by depth (LSD radix sort); returns which half of `rows` holds the result and how many rows there are.

    `visible` `[N]` holds rows packed to the front of chunks of `chunk`, `found[c]` of them in chunk c. `keys` and
    `rows` are `[2, N]` int32, `tally` `[DIGITS, BUCKETS]` int64 holding zeros.
    """
    count = 0
    for c in range(found.shape[0]):
        for i in range(c * chunk, c * chunk + found[c]):
            key = depth[visible[i]]
            keys[0, count], rows[0, count] = key, visible[i]
            count += 1
            for digit in range(DIGITS):
                tally[digit, (key >> (DIGIT * digit)) & (BUCKETS - 1)] += 1
    source = 0
    for digit in range(DIGITS):
        if _scatter(tally[digit], DIGIT * digit, count, keys, rows, source):
            source = 1 - source
    return source, count


@helper
def _scatter(tally, shift, count, keys, rows, source):  # type: ignore[no-untyped-def]
    """One stable pass by the digit at `shift`; returns False and moves nothing if all keys share that digit."""
    total = 0
    for bucket in range(BUCKETS):
        size = tally[bucket]
        if size == count:
            return False
        tally[bucket] = total
        total += size
    target = 1 - source
    for i in range(count):
        key = keys[source, i]
        bucket = (key >> shift) & (BUCKETS - 1)
        place = tally[bucket]
        tally[bucket] = place + 1
        keys[target, place] = key
        rows[target, place] = rows[source, i]
    return True


@helper
def _ellipse(records, n):  # type: ignore[no-untyped-def]
    """The ellipse that record `n` holds."""
    return Ellipse(
        records[n, X], records[n, Y], records[n, L3], records[n, LIMIT],
        records[n, REACH_Y], records[n, SLOPE], records[n, WIDTH], records[n, EXTREME],
    )  # fmt: skip


@kernel
def count_tiles(worker, workers, order, records, corner, mask, view, tiles_wide, tally):  # type: ignore[no-untyped-def]
    """Add this worker's share of `order` to `tally[worker]` `[tiles]` int32, which holds zeros."""
    mine = tally[worker]
    for k in range(order.shape[0] * worker // workers, order.shape[0] * (worker + 1) // workers):
        n = order[k]
        touched = mask[n]
        if touched == 0:
            ellipse = _ellipse(records, n)
            top, bottom = tile_rows(ellipse, view.height)
            for row in range(top, bottom):
                first, last = tile_span(ellipse, row, view.width)
                for column in range(first, last):
                    mine[row * tiles_wide + column] += 1
        base = np.int64(corner[n] >> 16) * tiles_wide + np.int64(corner[n] & 0xFFFF)
        while touched != 0:
            bit = lowest_bit(touched)
            touched &= touched - np.uint64(1)
            mine[base + bit // MASK_SIDE * tiles_wide + bit % MASK_SIDE] += 1


@kernel
def starts(tally, first):  # type: ignore[no-untyped-def]
    """Turn counts `[workers, tiles]` into where each worker writes; fill `first` `[tiles + 1]`; returns the total."""
    total = 0
    for tile in range(tally.shape[1]):
        first[tile] = total
        for worker in range(tally.shape[0]):
            size = tally[worker, tile]
            tally[worker, tile] = total
            total += size
    first[tally.shape[1]] = total
    return total


@kernel
def fill_tiles(worker, workers, order, records, corner, mask, view, tiles_wide, places, entries):  # type: ignore[no-untyped-def]
    """Write rows into `entries`, tile by tile and nearest first; visits tiles in the same order as `count_tiles`."""
    mine = places[worker]
    for k in range(order.shape[0] * worker // workers, order.shape[0] * (worker + 1) // workers):
        n = order[k]
        touched = mask[n]
        if touched == 0:
            ellipse = _ellipse(records, n)
            top, bottom = tile_rows(ellipse, view.height)
            for row in range(top, bottom):
                first, last = tile_span(ellipse, row, view.width)
                for column in range(first, last):
                    tile = row * tiles_wide + column
                    entries[mine[tile]] = n
                    mine[tile] += 1
        base = np.int64(corner[n] >> 16) * tiles_wide + np.int64(corner[n] & 0xFFFF)
        while touched != 0:
            bit = lowest_bit(touched)
            touched &= touched - np.uint64(1)
            tile = base + bit // MASK_SIDE * tiles_wide + bit % MASK_SIDE
            entries[mine[tile]] = n
            mine[tile] += 1
