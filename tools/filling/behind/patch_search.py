"""Compiled search for similar patches of a picture (Barnes et al., "PatchMatch", 2009), and means of what they show."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....gaussians.compiled import kernel
from ..smooth import F64, Mask

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]
REACH = 3  # pixels on each side of a patch's middle
_SWEEPS = 2  # of propagation and random search


def searched(
    picture: F32, valid: Mask, whole: Mask, targets: I32, found: I32, near: float, seed: int
) -> tuple[I32, F32]:
    """The known patch that each target resembles most, `[H, W, 2]`, and their cost `[M]`.

    Args:
        picture: `[H, W, C]`.
        valid: `[H, W]`, pixels that are compared; the others are not filled yet.
        whole: `[H, W]`, middles of patches that are known.
        targets: `[M, 2]`, row by row, of patches within the picture.
        found: `[H, W, 2]` a known patch for each target, to start from.
        near: cost of a pixel's distance, squared, between a target and its patch.
        seed: of the random search, above 0.
    """
    h, w = whole.shape
    cost = np.full((h, w), -1.0, np.float32)
    out = found.copy()
    _search(picture, valid, whole, targets, out, cost, np.float32(near), np.uint32(seed * 2654435761 % 2**32))
    return out, cost[targets[:, 0], targets[:, 1]]


def aggregate(picture: F32, channels: int, hole: Mask, targets: I32, found: I32, trust: F64) -> F32:
    """The picture `[H, W, C]` whose hole shows the mean of the patches that overlap it, each weighted with `[M]`."""
    h, w = hole.shape
    total, weight = np.zeros((h, w, channels)), np.zeros((h, w))
    _add(picture, hole, targets, found, trust, total, weight)
    there = hole & (weight > 0)
    out = picture.copy()
    out[there, :channels] = (total[there] / weight[there][:, None]).astype(np.float32)
    return out


@kernel
def _distance(picture: F32, valid: Mask, y: int, x: int, v: int, u: int, near: float, most: float) -> Any:
    total = np.float32(near * ((y - v) * (y - v) + (x - u) * (x - u)))
    for a in range(-REACH, REACH + 1):
        for b in range(-REACH, REACH + 1):
            if valid[y + a, x + b]:
                for c in range(picture.shape[2]):
                    d = picture[y + a, x + b, c] - picture[v + a, u + b, c]
                    total += d * d
        if total > most:
            return total
    return total


@kernel
def _try(
    picture: F32, valid: Mask, whole: Mask, found: I32, cost: F32, near: float, y: int, x: int, v: int, u: int
) -> None:
    if v < 0 or u < 0 or v >= whole.shape[0] or u >= whole.shape[1] or not whole[v, u]:
        return
    d = _distance(picture, valid, y, x, v, u, near, cost[y, x])
    if d < cost[y, x]:
        cost[y, x] = d
        found[y, x, 0] = v
        found[y, x, 1] = u


@kernel
def _search(
    picture: F32, valid: Mask, whole: Mask, targets: I32, found: I32, cost: F32, near: float, seed: int
) -> None:
    state = np.uint32(seed | np.uint32(1))
    count = targets.shape[0]
    for k in range(count):
        y, x = targets[k, 0], targets[k, 1]
        cost[y, x] = np.float32(3.0e38)
        cost[y, x] = _distance(picture, valid, y, x, found[y, x, 0], found[y, x, 1], near, np.float32(3.0e38))
    for sweep in range(_SWEEPS):
        back = sweep % 2 == 1
        step = 1 if back else -1
        for k in range(count):
            i = count - 1 - k if back else k
            y, x = targets[i, 0], targets[i, 1]
            if cost[y + step, x] >= 0:
                _try(
                    picture, valid, whole, found, cost, near, y, x, found[y + step, x, 0] - step, found[y + step, x, 1]
                )
            if cost[y, x + step] >= 0:
                _try(
                    picture, valid, whole, found, cost, near, y, x, found[y, x + step, 0], found[y, x + step, 1] - step
                )
            wide = max(whole.shape[0], whole.shape[1])
            while wide >= 1:
                state ^= np.uint32(state << np.uint32(13))
                state ^= np.uint32(state >> np.uint32(17))
                state ^= np.uint32(state << np.uint32(5))
                v = found[y, x, 0] + np.int32(state % np.uint32(2 * wide + 1)) - wide
                u = found[y, x, 1] + np.int32((state >> np.uint32(8)) % np.uint32(2 * wide + 1)) - wide
                _try(picture, valid, whole, found, cost, near, y, x, v, u)
                wide //= 2


@kernel
def _add(picture: F32, hole: Mask, targets: I32, found: I32, trust: F64, total: F64, weight: F64) -> None:
    for k in range(targets.shape[0]):
        y, x = targets[k, 0], targets[k, 1]
        v, u = found[y, x, 0], found[y, x, 1]
        for a in range(-REACH, REACH + 1):
            for b in range(-REACH, REACH + 1):
                if hole[y + a, x + b]:
                    weight[y + a, x + b] += trust[k]
                    for c in range(total.shape[2]):
                        total[y + a, x + b, c] += trust[k] * picture[v + a, u + b, c]
