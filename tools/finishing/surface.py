"""Coordinates on the surface of a thing: in metres, in its own axes, with the side that each Gaussian faces.

Normals of single Gaussians are noisy where a capture has no texture, so they are averaged over small cells. A pattern
is laid on along the axes of the thing: a point lies on the side that its normal is closest to (triplanar projection).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.rotations import to_matrix
from ...gaussians.scene import Scene
from ...gaussians.world.box import F64, Box
from ..coloring.grid import Grid
from .noise import F32
from .textures import Spots

_CELLS = 40  # along the longest axis, for normals
_FLAT = 0.12  # thickness of a thing relative to its second extent below which it counts as one sheet


@dataclass(frozen=True, eq=False)
class Chart:
    """The frame in which a thing is textured.

    Attributes:
        origin: `[3]` float64, world; the lower corner of its box, so that a unit begins there.
        axes: `[3, 3]` float64 rows: two level axes, the longer one first, and up.
        metres: metres per scene unit.
        sheet: index of the axis that a sheet (a wall, a rug) faces, None for a solid thing.
        grain: index of its longest axis.
    """

    origin: F64
    axes: F64
    metres: float
    sheet: int | None
    grain: int


def chart_of(scene: Scene, rows: Tensor, box: Box, metres: float) -> Chart:
    """The chart of a thing.

    Args:
        rows: `[M]` its Gaussians.
        box: its box.
        metres: metres per scene unit.
    """
    axes = np.array(box.axes, dtype=np.float64)
    size = np.array(box.size, dtype=np.float64)
    points = scene.cloud.means[rows].double().numpy() @ axes.T
    low, high = np.quantile(points, (0.02, 0.98), axis=0)
    if size[1] > size[0]:  # turned by 90 degrees: the longer level axis first
        axes = np.stack([axes[1], -axes[0], axes[2]])
        low, high = np.array([low[1], -high[0], low[2]]), np.array([high[1], -low[0], high[2]])
    extent = np.maximum(high - low, 1e-9)
    order = np.argsort(extent)
    sheet = int(order[0]) if extent[order[0]] < _FLAT * extent[order[1]] else None
    return Chart(low @ axes, axes, metres, sheet, int(np.argmax(extent)))


def spots_of(chart: Chart, means: Tensor, normals: F32, blur: Tensor) -> Spots:
    """Texture coordinates of points.

    Args:
        means: `[N, 3]` world.
        normals: `[N, 3]` in the axes of the chart.
        blur: `[N]` scene units.
    """
    local = (means.double().numpy() - chart.origin) @ chart.axes.T
    xyz = (local * chart.metres).astype(np.float32)
    facing = np.abs(normals).argmax(axis=1)
    across = np.where(facing == 0, xyz[:, 1], xyz[:, 0])
    up = np.where(facing == 2, xyz[:, 1], xyz[:, 2])
    plane = np.stack([across, up], axis=1).astype(np.float32)
    return Spots(xyz, plane, normals, (blur.numpy() * chart.metres).astype(np.float32), chart.grain)


def normals_of(chart: Chart, cloud: GaussianCloud, rows: Tensor) -> F32:
    """`[M, 3]` unit normals of some rows of a cloud in the axes of the chart, averaged over cells, up to their sign;
    all that of the sheet where the thing is one. They point up where they can."""
    if chart.sheet is not None:
        flat = np.zeros((len(rows), 3), dtype=np.float32)
        flat[:, chart.sheet] = 1.0
        return flat
    scales = cloud.scales[rows]
    thin = scales.argmin(dim=1)
    axes = torch.tensor(chart.axes, dtype=torch.float32)
    turned = to_matrix(cloud.quats[rows])  # columns are the local axes
    own = turned.gather(2, thin[:, None, None].expand(-1, 3, 1)).squeeze(2) @ axes.T
    ordered = scales.sort(dim=1).values
    weight = cloud.opacities[rows] * ordered[:, 2] * (ordered[:, 1] - ordered[:, 0])
    outer = weight[:, None] * (own[:, :, None] * own[:, None, :]).reshape(-1, 9)
    grid = Grid.over(cloud.means[rows], _CELLS)
    sums = grid.smoothed(grid.sums(cloud.means[rows], outer)).reshape(-1, 3, 3)
    held = grid.cell_of(cloud.means[rows])
    used, inverse = torch.unique(held, return_inverse=True)
    found = torch.linalg.eigh(sums[used] + 1e-12 * torch.eye(3)).eigenvectors[:, :, 2]
    found = torch.where(found[:, 2:] < 0, -found, found)
    normals: F32 = found[inverse].numpy().astype(np.float32)
    return normals
