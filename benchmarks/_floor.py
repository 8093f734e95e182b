"""The lower bound of the time for blending a picture, and the ratio of the renderer's time to it.

A pair is one Gaussian in one pixel where its alpha is at least 1/255 and the pixel is not yet saturated. The reference
renderer counts the pairs per pixel, without the idle lanes of SIMD blocks. The time of a pair is that of the renderer's
own block code at its best: all lanes busy, all records in the first-level cache, nothing sorted, copied or stored. So

    floor = pairs x time of a pair / workers

and the renderer's further time goes into idle lanes, the traversal of tiles and lists, and memory accesses.
"""

from __future__ import annotations

import math
import time

import numba
import numpy as np

from ..gaussians import compiled
from ..gaussians.camera import Camera
from ..gaussians.cloud import GaussianCloud
from ..gaussians.render import cpu, reference
from ..gaussians.render.cpu import lanes, layout, simd, touch
from .harness import Metric

STAGE = "draw"  # the kernel that blends
TRIALS, ROUNDS = 25, 400  # the least time of 25 trials counts, each of 400 chunks
ALPHA = 0.01  # of every pair that is timed: so low that a chunk does not saturate a pixel


def measure(cloud: GaussianCloud, camera: Camera, key: str, raster: float) -> list[Metric]:
    """The floor of a case whose raster stage took `raster` seconds, and their ratio; measured here and now."""
    pairs, each = reference.count_blends(cloud, camera), pair_seconds()
    floor = pairs * each / compiled.workers()
    return [
        Metric(f"{key}.pairs", pairs, "count"),
        Metric(f"{key}.pair", each * 1e9, "ns", "lower", 0.15),
        Metric(f"{key}.floor", floor * 1e3, "ms"),
        Metric(f"{key}.raster", raster * 1e3, "ms", "lower", 0.15),
        Metric(f"{key}.raster_over_floor", raster / floor, "x", "lower", 0.15),
    ]


def pair_seconds() -> float:
    """Seconds that one worker's block code takes for one pair, at best."""
    records = np.zeros((touch.CHUNK, layout.RECORD), np.float32)
    records[:, layout.SHIFT] = -math.log(ALPHA) / 8  # alpha = exp(-8 (0 + shift)) everywhere
    records[:, layout.RED : layout.DEPTH + 1] = 0.5
    chunk, state, every = records.reshape(-1), np.zeros(simd.STATE, np.float32), np.uint64(2**touch.CHUNK - 1)
    _blend_often(chunk, every, state, cpu.LIMITS, 1)
    least = math.inf
    for _ in range(TRIALS):
        start = time.perf_counter()
        _blend_often(chunk, every, state, cpu.LIMITS, ROUNDS)
        least = min(least, time.perf_counter() - start)
    return least / (ROUNDS * touch.CHUNK * lanes.LANES)


# Multiply-adds fuse as in the renderer's kernels. Not cached on disk: the cache would miss changes of the block's code.
@numba.njit(nogil=True, boundscheck=False, fastmath={"contract"})
def _blend_often(chunk, slots, state, limits, rounds):  # type: ignore[no-untyped-def]
    """Blend a whole chunk into one block, `rounds` times, each time from the start."""
    for _ in range(rounds):
        for lane in range(lanes.LANES):
            state[lane] = np.float32(1)
        simd.blend_block(chunk, slots, state, 0, np.float32(0), np.float32(0), limits)
