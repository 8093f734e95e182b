"""Solid points and 2D grids of them: obstacles, supporting surfaces, and sums over windows of cells."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.kept import Kept
from ...gaussians.rotations import to_matrix
from ...gaussians.rows import rows_where, rows_within, taken
from ...gaussians.world.box import Box
from ...gaussians.world.core import least_opacity

Array = NDArray[np.float64]
Bool = NDArray[np.bool_]
_SAMPLE = 20_000  # solid Gaussians from which the typical extent is measured
_LARGE = 3.0  # times that: Gaussians that get further points
_MOST_LARGE = 60_000
_LEVELS = 4  # most surface heights of one thing (a shelf and a chair have several)


def obstacle_points(
    cloud: GaussianCloud, without: Tensor | None = None, within: tuple[Array, Array] | None = None
) -> NDArray[np.float32]:
    """`[M, 3]` float32 centres of the opaque Gaussians, and further points along the two long axes of large ones.

    Args:
        without: `[N]` bool, Gaussians that are no obstacles.
        within: only points from one corner to another, world-aligned; None: all.
    """
    if not len(cloud):
        return np.zeros((0, 3), dtype=np.float32)
    least, rows, spread, *_ = _measured(cloud)
    if within is None:
        own = rows_where(cloud.opacities >= least if without is None else (cloud.opacities >= least) & ~without)
    else:
        own = rows_within(cloud.means, *within)
        own = own[cloud.opacities[own] >= least]
        own = own if without is None else own[~without[own]]
    if len(rows) and without is not None:
        spread = spread[(~without[rows]).cpu().numpy()]
    further = spread.reshape(-1, 3)
    if within is not None:
        further = further[rows_within(torch.from_numpy(further), *within).numpy()]
    return np.concatenate([taken(cloud.means, own).cpu().numpy(), further])


class _Measures(NamedTuple):
    """What does not depend on the question: the least opacity of solid Gaussians, the rows `[B]` of the large ones,
    their points `[B, 24, 3]`, and the corners `[3]` of the world-aligned box around all Gaussians."""

    least: float
    rows: Tensor
    spread: NDArray[np.float32]
    low: Array
    high: Array


_measures: Kept[_Measures] = Kept(4)


def _measured(cloud: GaussianCloud) -> _Measures:
    return _measures.get((cloud.means, cloud.quats, cloud.scales, cloud.opacities), lambda: _measure(cloud))


def _measure(cloud: GaussianCloud) -> _Measures:
    least = least_opacity(cloud.opacities)
    low, high = (corner.double().cpu().numpy() for corner in torch.aminmax(cloud.means, dim=0))
    solid = cloud.opacities >= least
    sample = rows_where(solid)[:: max(1, int(solid.sum()) // _SAMPLE)]
    if not len(sample):
        return _Measures(least, sample, np.zeros((0, 24, 3), dtype=np.float32), low, high)
    typical = float(cloud.scales[sample].amax(dim=1).median())
    sides = rows_where(cloud.scales.reshape(-1) > _LARGE * typical)
    rows = torch.unique_consecutive(sides // 3)
    rows = rows[solid[rows]][:_MOST_LARGE]
    spread = _spread(cloud, rows).reshape(-1, 24, 3)
    if len(rows):
        low, high = np.minimum(low, spread.min(axis=(0, 1))), np.maximum(high, spread.max(axis=(0, 1)))
    return _Measures(least, rows, spread, low, high)


def column_of(cloud: GaussianCloud, box: Box) -> tuple[Array, Array]:
    """The corners of the world-aligned box around all that lies over and under a box's footprint in a cloud."""
    if not len(cloud):
        return box.bounds()
    found, up = _measured(cloud), np.array(box.axes[2])
    low, high = np.sort(np.stack([found.low * up, found.high * up]), axis=0).sum(axis=1)
    return box.bounds((float(low), float(high)))


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
