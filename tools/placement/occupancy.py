"""Solid points and 2D grids of them: obstacles, supporting surfaces, and sums over windows of cells."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.rotations import to_matrix
from ...gaussians.world.box import Box
from ...gaussians.world.core import least_opacity

Array = NDArray[np.float64]
Bool = NDArray[np.bool_]
_LEVELS = 4  # most surface heights of one thing (a shelf and a chair have several)


def obstacle_points(cloud: GaussianCloud, without: Tensor | None = None) -> NDArray[np.float32]:
    """`[M, 3]` float32 centres of the opaque Gaussians, and further points along the two long axes of large ones."""
    solid = cloud.opacities >= least_opacity(cloud.opacities)
    if without is not None:
        solid = solid & ~without
    rows = solid.nonzero().squeeze(1)
    means = cloud.means.index_select(0, rows)
    largest = cloud.scales.index_select(0, rows).amax(dim=1)
    if not len(rows):
        return np.zeros((0, 3), dtype=np.float32)
    typical = float(largest[:: max(1, len(largest) // 20_000)].median())
    big = rows[(largest > 3 * typical)][:60_000]
    return np.concatenate([means.cpu().numpy(), _spread(cloud, big)])


def _spread(cloud: GaussianCloud, rows: Tensor) -> NDArray[np.float32]:
    """`[24 M, 3]` points at 0, half and one deviation along the two long axes of Gaussians, without the centres."""
    if not len(rows):
        return np.zeros((0, 3), dtype=np.float32)
    scales, order = cloud.scales[rows].sort(dim=1, descending=True)
    axes = to_matrix(cloud.quats[rows]).gather(2, order[:, None, :].expand(-1, 3, -1)) * scales[:, None, :]
    steps = torch.tensor([[x, y] for x in (-1, -0.5, 0, 0.5, 1) for y in (-1, -0.5, 0, 0.5, 1) if x or y])
    points = cloud.means[rows][:, None, :] + torch.einsum("sk,mck->msc", steps, axes[:, :, :2])
    spread: NDArray[np.float32] = points.reshape(-1, 3).cpu().numpy()
    return spread


def surface_heights(heights: Array, local: Array, tolerance: float) -> list[tuple[float, Bool]]:
    """Heights of a thing's surfaces that are open from above, the broadest first, with a mask of the points there.

    Only the highest point in each cell of a 40x40 grid over the thing counts as open from above.
    """
    low, high = local.min(axis=0), local.max(axis=0)
    cells = np.minimum(((local - low) / np.maximum(high - low, 1e-9) * 40).astype(np.int64), 39)
    index = cells[:, 0] * 40 + cells[:, 1]
    top = np.full(1600, -np.inf)
    np.maximum.at(top, index, heights)
    seen = np.sort(top[np.isfinite(top)])
    found: list[tuple[float, Bool]] = []
    free = np.ones(len(seen), dtype=bool)
    for _ in range(_LEVELS):
        if free.sum() < 0.08 * len(seen):
            break
        candidates = seen[free]
        reach = np.searchsorted(candidates, candidates + 2 * tolerance, side="right") - np.arange(len(candidates))
        start = int(np.argmax(reach))
        window = candidates[start : start + reach[start]]
        level = float(np.median(window))
        found.append((level, np.abs(heights - level) <= tolerance))
        free &= (seen < window[0]) | (seen > window[-1])
    return found


def histogram(points: Array, origin: Array, cell: float, shape: NDArray[np.int_]) -> NDArray[np.int64]:
    """Number of points in each cell, `[shape]`; points outside the grid are left out."""
    index = np.floor((points - origin) / cell).astype(np.int64)
    inside = ((index >= 0) & (index < shape)).all(axis=1)
    flat = index[inside, 0] * int(shape[1]) + index[inside, 1]
    return np.bincount(flat, minlength=int(shape[0] * shape[1])).reshape(shape)


def dilated(mask: Bool, by: int) -> Bool:
    """A mask dilated by `by` cells, which closes the gaps between sampled points."""
    result: Bool = window_sum(np.pad(mask, by).astype(np.int64), np.array([2 * by + 1] * 2), list(mask.shape)) > 0
    return result


def window_sum(values: NDArray[np.int64], window: NDArray[np.int_], counts: Sequence[int]) -> NDArray[np.int64]:
    """Sums over every `window` of cells, `[counts]`, by a summed-area table."""
    table = np.pad(values.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    w, d = (int(min(window[i], values.shape[i])) for i in range(2))
    n, m = (int(c) for c in counts)
    sums: NDArray[np.int64] = table[w : w + n, d : d + m] - table[:n, d : d + m] - table[w : w + n, :m] + table[:n, :m]
    return sums


def points_inside(placed: Array, others: NDArray[np.float32], box: Box, clear: float) -> int:
    """Number of solid points of other things that share a voxel with a placed thing's points, above height `clear`.

    Only points within the thing's box are compared, in voxels of a sixteenth of its size.
    """
    half = np.array(box.size) / 2
    near = (np.abs(others - np.array(box.center, dtype=np.float32)) <= np.linalg.norm(half)).all(axis=1)
    local = box.local(others[near])
    inside = (np.abs(local) <= half).all(axis=1) & (local[:, 2] > clear - half[2])
    if not inside.any():
        return 0
    voxel = max(float(max(box.size)) / 16, 1e-9)

    def keys(points: Array) -> NDArray[np.int64]:
        cells = np.floor((points + half) / voxel).astype(np.int64) + 1
        return np.asarray((cells[:, 0] * 4096 + cells[:, 1]) * 4096 + cells[:, 2])

    mine = box.local(placed)
    return int(np.isin(keys(local[inside]), np.unique(keys(mine[mine[:, 2] > clear - half[2]]))).sum())
