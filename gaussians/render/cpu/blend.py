"""Blend sorted footprints into pixels, tile by tile.

A tile of 16x16 pixels is 16 blocks of 16 lanes. Its footprints are processed in chunks: each record is copied next to
its neighbours and marked with the blocks that its ellipse touches; then each block, with its whole state in registers,
loops over the records that touch it (`simd.py`). Finished blocks cost nothing, and colour, depth and group share every
exponential.
"""

from __future__ import annotations

import numpy as np

from ...compiled import fetch_add, helper, kernel, make_lines
from .lanes import LANES, lane_sum
from .layout import RECORD, TILE, Array
from .simd import REST, STATE, WINNER, blend_block, blend_block_alone, store_block, weigh_block
from .touch import BLOCK_HEIGHT, BLOCK_WIDTH, BLOCKS, BLOCKS_WIDE, CHUNK, copy_record, prefetch, slots_touching

PREFETCH = CHUNK  # entries between the prefetch of a record and its use: records arrive while a chunk is blended

f4 = np.float32
ZERO, ONE = f4(0), f4(1)


def make_scratch(workers: int) -> tuple[Array, ...]:
    """Allocate each worker's scratch memory: chunk, touched, state, alive, weights, one row a worker."""
    sizes = (
        (CHUNK * RECORD, np.float32), (CHUNK, np.uint16), (BLOCKS * STATE, np.float32), (BLOCKS, np.bool_),
        (CHUNK * LANES, np.float32),
    )  # fmt: skip
    return tuple(make_lines(workers, size, kind) for size, kind in sizes)


def only_group(groups: Array) -> tuple[bool, np.int32]:
    """Whether all Gaussians `[N]` are of one group, and which: then the group of a pixel is known without a search."""
    first = np.int32(groups[0]) if len(groups) else np.int32(-1)
    return bool((groups == first).all()), first


@kernel
def draw(worker, workers, first, entries, records, size, limits, background, only, out, scratch, counter):  # type: ignore[no-untyped-def]
    """Draw tiles until none is left. Tile t's footprints are `entries[first[t]:first[t + 1]]`, nearest first.

    `size` is (width, height), `limits` (largest alpha, least transmittance, largest q), `only` from `only_group`, `out`
    (rgb `[H, W, 3]`, alpha, depth, group `[H, W]`, the last int32), `scratch` from `make_scratch`, `counter` `[1]`
    int64 holding 0.
    """
    tiles_wide = (size[0] + TILE - 1) // TILE
    chunk, touched, state, alive = scratch[0][worker], scratch[1][worker], scratch[2][worker], scratch[3][worker]
    while True:
        tile = fetch_add(counter, 1)
        if tile >= first.shape[0] - 1:
            break
        x, y = tile % tiles_wide * TILE, tile // tiles_wide * TILE
        start, stop = first[tile], first[tile + 1]
        if start == stop:
            _clear(x, y, size, background, out)
            continue
        _begin(state, alive, STATE, size[0] - x, size[1] - y)
        while start < stop:
            count = min(CHUNK, stop - start)
            _gather(entries, start, count, records, chunk, touched, f4(x), f4(y))
            start = stop if _draw_chunk(chunk, touched, state, alive, limits, only[0]) else start + count
        if only[0]:
            _assign_group(state, only[1])
        _finish(state, x, y, size, background, out)


@helper
def _begin(state, alive, stride, width, height):  # type: ignore[no-untyped-def]
    """Initialise a tile: transmittance 1, nothing drawn. Pixels outside the image, of which `width` and `height` remain
    from the tile's corner, start as finished."""
    bits = state.view(np.int32)
    whole = width >= TILE and height >= TILE
    for block in range(BLOCKS):
        left, top = block % BLOCKS_WIDE * BLOCK_WIDTH, block // BLOCKS_WIDE * BLOCK_HEIGHT
        alive[block] = left < width and top < height
        base = block * stride
        for lane in range(LANES):
            state[base + lane] = ONE
        if not whole:
            for lane in range(LANES):
                if left + lane % BLOCK_WIDTH >= width or top + lane // BLOCK_WIDTH >= height:
                    state[base + lane] = ZERO
        if stride == STATE:
            for place in range(base + LANES, base + STATE):
                state[place] = ZERO
            for lane in range(LANES):
                state[base + REST + lane] = ONE
                bits[base + WINNER + lane] = -1


@helper
def _clear(x, y, size, background, out):  # type: ignore[no-untyped-def]
    """Write the pixels of a tile that nothing touches."""
    rgb, alpha, depth, group = out
    right = min(x + TILE, size[0])
    for row in range(y, min(y + TILE, size[1])):
        for column in range(x, right):
            for channel in range(3):
                rgb[row, column, channel] = background[channel]
        alpha[row, x:right] = ZERO
        depth[row, x:right] = ZERO
        group[row, x:right] = -1


@helper
def _gather(entries, start, count, records, chunk, touched, x, y):  # type: ignore[no-untyped-def]
    """Copy `count` records into the chunk and compute the blocks each touches."""
    for slot in range(count):
        prefetch(records, entries[min(start + slot + PREFETCH, entries.shape[0] - 1)])
        touched[slot] = copy_record(records, entries[start + slot], chunk, slot, x, y)
    for slot in range(count, CHUNK):
        touched[slot] = 0


@helper
def _draw_chunk(chunk, touched, state, alive, limits, alone):  # type: ignore[no-untyped-def]
    """Blend a chunk into every unfinished block; returns whether the tile is finished.

    `alone`: there is one group only, which `_assign_group` gives to the pixels in the end.
    """
    finished = True
    for block in range(BLOCKS):
        if not alive[block]:
            continue
        slots = slots_touching(touched, block)
        if slots != 0:
            x, y = f4(block % BLOCKS_WIDE * BLOCK_WIDTH), f4(block // BLOCKS_WIDE * BLOCK_HEIGHT)
            if alone:
                alive[block] = blend_block_alone(chunk, slots, state, block * STATE, x, y, limits) != 0
            else:
                alive[block] = blend_block(chunk, slots, state, block * STATE, x, y, limits) != 0
        finished = finished and not alive[block]
    return finished


@helper
def _assign_group(state, group):  # type: ignore[no-untyped-def]
    """Give the pixels of a tile that have any weight the only group that there is. A weight leaves less than all light:
    alpha is at least 1/255."""
    bits = state.view(np.int32)
    for block in range(BLOCKS):
        for lane in range(block * STATE, block * STATE + LANES):
            bits[WINNER + lane] = group if state[REST + lane] < ONE else -1


@helper
def _finish(state, x, y, size, background, out):  # type: ignore[no-untyped-def]
    """Write a tile's pixels, composited over the background."""
    rgb, alpha, depth, group = out
    red, green, blue = background
    for block in range(BLOCKS):
        left, top = x + block % BLOCKS_WIDE * BLOCK_WIDTH, y + block // BLOCKS_WIDE * BLOCK_HEIGHT
        if left + BLOCK_WIDTH <= size[0] and top + BLOCK_HEIGHT <= size[1]:
            store_block(state, block * STATE, rgb, alpha, depth, group, top * size[0] + left, size[0], red, green, blue)
        else:
            _store_pixels(state, block * STATE, left, top, size, background, out)


@helper
def _store_pixels(state, offset, left, top, size, background, out):  # type: ignore[no-untyped-def]
    """As `store_block`, pixel by pixel, for a block that crosses the image border."""
    rgb, alpha, depth, group = out
    bits = state.view(np.int32)
    for y in range(top, min(top + BLOCK_HEIGHT, size[1])):
        for x in range(left, min(left + BLOCK_WIDTH, size[0])):
            place = offset + (y - top) * BLOCK_WIDTH + x - left
            rest = state[place + REST]
            cover = ONE - rest
            for channel in range(3):
                rgb[y, x, channel] = state[place + (channel + 1) * LANES] + rest * background[channel]
            alpha[y, x] = cover
            depth[y, x] = state[place + 4 * LANES] / cover if cover > ZERO else ZERO
            group[y, x] = bits[place + WINNER]


@kernel
def weigh(worker, workers, first, entries, records, size, limits, share, scratch, counter):  # type: ignore[no-untyped-def]
    """As `draw`, but write each entry's summed weight in its tile to `share` `[entries]`, which holds zeros."""
    tiles_wide = (size[0] + TILE - 1) // TILE
    chunk, touched, state, alive = scratch[0][worker], scratch[1][worker], scratch[2][worker], scratch[3][worker]
    weights = scratch[4][worker]
    while True:
        tile = fetch_add(counter, 1)
        if tile >= first.shape[0] - 1:
            break
        x, y = tile % tiles_wide * TILE, tile // tiles_wide * TILE
        _begin(state, alive, LANES, size[0] - x, size[1] - y)
        start, stop, finished = first[tile], first[tile + 1], False
        while start < stop and not finished:
            count = min(CHUNK, stop - start)
            _gather(entries, start, count, records, chunk, touched, f4(x), f4(y))
            weights[:] = ZERO
            finished = _weigh_chunk(chunk, touched, state, alive, weights, limits)
            for slot in range(count):
                share[start + slot] = lane_sum(weights, slot)
            start += count


@helper
def _weigh_chunk(chunk, touched, state, alive, weights, limits):  # type: ignore[no-untyped-def]
    """Sum the weights of a chunk over every unfinished block; returns whether the tile is finished."""
    finished = True
    for block in range(BLOCKS):
        if not alive[block]:
            continue
        slots = slots_touching(touched, block)
        if slots != 0:
            x, y = f4(block % BLOCKS_WIDE * BLOCK_WIDTH), f4(block // BLOCKS_WIDE * BLOCK_HEIGHT)
            alive[block] = weigh_block(chunk, slots, state, block * LANES, weights, x, y, limits) != 0
        finished = finished and not alive[block]
    return finished


@kernel
def collect(entries, share, total):  # type: ignore[no-untyped-def]
    """Add the shares of all tiles to their rows in `total` `[N]` float64, in the order of the entries."""
    for k in range(entries.shape[0]):
        total[entries[k]] += share[k]
