"""Backward pass of blending: from the gradient of an image to that of every footprint, tile by tile.

`simd_backward` handles the blocks of pixels, `project_backward` continues from footprints to Gaussians. Each entry's
gradient is written at the entry's own place and then summed per row in the order of the entries. No two threads write
the same place, so the same input gives the same bytes on any number of threads.
"""

from __future__ import annotations

import numpy as np

from ...compiled import fetch_add, helper, kernel, make_lines
from .blend import _gather
from .lanes import LANES
from .layout import HALF, L1, L2, L3, ONE, RECORD, TILE, ZERO, Array, X, Y, f4
from .simd_backward import (
    STATE,
    SUM_BLUE,
    SUM_E,
    SUM_EX,
    SUM_EY,
    SUM_F,
    SUM_FY,
    SUM_GREEN,
    SUM_RED,
    SUM_SHIFT,
    blend_blocks_backward,
)
from .touch import BLOCK_HEIGHT, BLOCK_WIDTH, BLOCKS, BLOCKS_WIDE, CHUNK

# Gradient of a footprint: centre (px), the three fields of its exponent, shift, colour.
GRADIENT = 9
D_X, D_Y, D_L1, D_L2, D_L3, D_SHIFT, D_RED, D_GREEN, D_BLUE = range(GRADIENT)


def make_scratch(workers: int) -> tuple[Array, ...]:
    """Allocate each worker's scratch memory: chunk, touched, state, sums, one row a worker."""
    sizes = (CHUNK * RECORD, np.float32), (CHUNK, np.uint16), (BLOCKS * STATE, np.float32), (LANES, np.float32)
    return tuple(make_lines(workers, size, kind) for size, kind in sizes)


@kernel
def draw_backward(worker, workers, first, entries, records, size, limits, picture, gradient, out, scratch, counter):  # type: ignore[no-untyped-def]
    """Write the gradient of every entry to `out` `[entries, GRADIENT]`, all of which is written.

    `picture` is (rgb, alpha) as drawn, `gradient` that of both, `[H, W, 3]` and `[H, W]`; the rest as in `blend.draw`.
    """
    tiles_wide = (size[0] + TILE - 1) // TILE
    chunk, touched, state, sums = scratch[0][worker], scratch[1][worker], scratch[2][worker], scratch[3][worker]
    while True:
        tile = fetch_add(counter, 1)
        if tile >= first.shape[0] - 1:
            break
        x, y = tile % tiles_wide * TILE, tile // tiles_wide * TILE
        alive = _begin(state, x, y, size, picture, gradient)
        start, stop = first[tile], first[tile + 1]
        while start < stop:
            count = min(CHUNK, stop - start)
            if alive != 0:
                _gather(entries, start, count, records, chunk, touched, f4(x), f4(y))
            for slot in range(count):
                reached = touched[slot] & alive
                if reached != 0:
                    alive ^= reached & ~blend_blocks_backward(chunk, slot, reached, state, sums, limits)
                    _finish(records, entries[start + slot], sums, f4(x), f4(y), out, start + slot)
                else:
                    for place in range(GRADIENT):
                        out[start + slot, place] = ZERO
            start += count


@helper
def _begin(state, left, top, size, picture, gradient):  # type: ignore[no-untyped-def]
    """Initialise the state of a tile; returns the bits of the blocks that lie in the image."""
    rgb, alpha = picture
    d_rgb, d_alpha = gradient
    alive = 0
    for block in range(BLOCKS):
        for lane in range(LANES):
            x = left + block % BLOCKS_WIDE * BLOCK_WIDTH + lane % BLOCK_WIDTH
            y = top + block // BLOCKS_WIDE * BLOCK_HEIGHT + lane // BLOCK_WIDTH
            at = block * STATE + lane
            inside = x < size[0] and y < size[1]
            state[at] = ONE if inside else ZERO
            to_come = ZERO
            if inside:
                alive |= 1 << block
                to_come = -d_alpha[y, x] * (ONE - alpha[y, x])
            state[at + 5 * LANES], state[at + 6 * LANES] = f4(x - left) + HALF, f4(y - top) + HALF
            for channel in range(3):
                g = d_rgb[y, x, channel] if inside else ZERO
                state[at + (2 + channel) * LANES] = g
                if inside:
                    to_come += g * rgb[y, x, channel]
            state[at + LANES] = to_come
    return alive


@helper
def _finish(records, row, sums, left, top, out, entry):  # type: ignore[no-untyped-def]
    """Compute the gradient of one entry's footprint from the sums over its pixels."""
    x, y = records[row, X] - left, records[row, Y] - top
    e, f = sums[SUM_E], sums[SUM_F]
    out[entry, D_L1] = sums[SUM_EX] - x * e
    out[entry, D_L2] = sums[SUM_EY] - y * e
    out[entry, D_L3] = sums[SUM_FY] - y * f
    out[entry, D_X] = -records[row, L1] * e
    out[entry, D_Y] = -records[row, L2] * e - records[row, L3] * f
    out[entry, D_SHIFT] = sums[SUM_SHIFT]
    out[entry, D_RED], out[entry, D_GREEN], out[entry, D_BLUE] = sums[SUM_RED], sums[SUM_GREEN], sums[SUM_BLUE]


@kernel
def collect(worker, workers, entries, each, total):  # type: ignore[no-untyped-def]
    """Add the gradients of entries to those of their rows, `total` `[N, GRADIENT]`; workers own disjoint rows."""
    rows = total.shape[0]
    low, high = rows * worker // workers, rows * (worker + 1) // workers
    for k in range(entries.shape[0]):
        row = entries[k]
        if low <= row < high:
            for place in range(GRADIENT):
                total[row, place] += each[k, place]
