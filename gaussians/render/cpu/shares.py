"""Sum the blending weight of each footprint for each label of a label image, tile by tile.

Each tile lists the labels that occur in it: at most one a pixel, mostly one or two. The cost depends on the borders
between labels, not on the number of labels.
"""

from __future__ import annotations

import numpy as np

from ...compiled import fetch_add, helper, kernel
from .blend import _begin, _gather, _weigh_chunk
from .lanes import LANES, lane_sum
from .layout import BIT, TILE, Array
from .simd import weigh_block
from .touch import BLOCK_HEIGHT, BLOCK_WIDTH, BLOCKS, BLOCKS_WIDE, CHUNK, lowest_bit, slots_touching

PIXELS = TILE * TILE  # of a tile, and therefore its maximum number of labels

f4 = np.float32
ZERO = f4(0)


def make_plan(labels: Array) -> tuple[Array, Array, Array]:
    """Allocate what `list_labels` fills for a label image `[H, W]` int32: the tile-local number of each pixel's label,
    the number of labels of each tile, and the labels themselves, `PIXELS` places a tile."""
    tiles = -(-labels.shape[0] // TILE) * -(-labels.shape[1] // TILE)
    return np.zeros(labels.shape, np.uint8), np.zeros(tiles, np.int64), np.zeros(tiles * PIXELS, np.int32)


@kernel
def list_labels(labels, local, count, names):  # type: ignore[no-untyped-def]
    """Number the labels of each tile in the order of their first pixel."""
    height, width = labels.shape
    tiles_wide = (width + TILE - 1) // TILE
    for y in range(height):
        for x in range(width):
            tile = y // TILE * tiles_wide + x // TILE
            found = count[tile]
            label, place = labels[y, x], 0
            while place < found and names[tile * PIXELS + place] != label:
                place += 1
            if place == found:
                names[tile * PIXELS + place] = label
                count[tile] = found + 1
            local[y, x] = place


@kernel
def split(worker, workers, first, entries, records, size, limits, plan, share, scratch, counter):  # type: ignore[no-untyped-def]
    """As `blend.weigh`, but write the weight of each entry for each label of its tile.

    `plan` is (local, count, start): from `make_plan`, and where each tile's shares begin. Tile t's entry k has its
    `count[t]` shares at `start[t] + (k - first[t]) * count[t]`; `share` holds zeros.
    """
    tiles_wide = (size[0] + TILE - 1) // TILE
    local, count, place = plan
    chunk, touched, state, alive = scratch[0][worker], scratch[1][worker], scratch[2][worker], scratch[3][worker]
    weights = scratch[4][worker]
    while True:
        tile = fetch_add(counter, 1)
        if tile >= first.shape[0] - 1:
            break
        x, y = tile % tiles_wide * TILE, tile // tiles_wide * TILE
        _begin(state, alive, LANES, size[0] - x, size[1] - y)
        start, stop, finished = first[tile], first[tile + 1], False
        labels, to = count[tile], place[tile]
        while start < stop and not finished:
            taken = min(CHUNK, stop - start)
            _gather(entries, start, taken, records, chunk, touched, f4(x), f4(y))
            if labels == 1:
                weights[:] = ZERO
                finished = _weigh_chunk(chunk, touched, state, alive, weights, limits)
                for slot in range(taken):
                    share[to + slot] = lane_sum(weights, slot)
            else:
                finished = True
                for block in range(BLOCKS):
                    if alive[block]:
                        left, top = block % BLOCKS_WIDE * BLOCK_WIDTH, block // BLOCKS_WIDE * BLOCK_HEIGHT
                        slots = slots_touching(touched, block)
                        if slots != 0:
                            weights[:] = ZERO
                            at = block * LANES
                            alive[block] = weigh_block(chunk, slots, state, at, weights, f4(left), f4(top), limits) != 0
                            _add_by_label(weights, slots, local, x + left, y + top, labels, share, to)
                        finished = finished and not alive[block]
            to += taken * labels
            start += taken


@helper
def _add_by_label(weights, slots, local, left, top, labels, share, to):  # type: ignore[no-untyped-def]
    """Add the weights of a block's pixels to the shares of their labels. Pixels outside the image have weight zero."""
    height, width = local.shape
    while slots != 0:
        slot = lowest_bit(slots)
        slots &= slots - BIT
        for lane in range(LANES):
            weight = weights[slot * LANES + lane]
            if weight > ZERO:
                y, x = min(top + lane // BLOCK_WIDTH, height - 1), min(left + lane % BLOCK_WIDTH, width - 1)
                share[to + slot * labels + local[y, x]] += weight


@kernel
def gather(first, entries, plan, names, share, rows, labels, weights):  # type: ignore[no-untyped-def]
    """Write row, label and weight of every share above zero, tile after tile; returns their number."""
    _, count, place = plan
    found = 0
    for tile in range(first.shape[0] - 1):
        for k in range(first[tile], first[tile + 1]):
            at = place[tile] + (k - first[tile]) * count[tile]
            for label in range(count[tile]):
                if share[at + label] > ZERO:
                    rows[found] = entries[k]
                    labels[found] = names[tile * PIXELS + label]
                    weights[found] = share[at + label]
                    found += 1
    return found
