"""New Gaussians for the filled cells of a chart: flat, one a cell, coloured like the picture."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.harmonics import color_to_dc, evaluate
from ...gaussians.rotations import from_matrix
from .charts import Chart
from .planes import F64, Mask

COVER = 0.6  # standard deviation over the side of a cell: no gaps, and edges stay crisp
_FLAT = 0.08  # thickness over the standard deviation along the surface
_OPACITY = 0.97
_NEIGHBOURS = 8  # Gaussians of the surface whose view-dependent colour a new one takes


def gaussians_of(
    chart: Chart, picture: F64, height: F64, cells: Mask, groups: NDArray[np.int32], cloud: GaussianCloud, rows: Tensor
) -> GaussianCloud:
    """A Gaussian for each cell of a mask.

    Args:
        picture: `[H, W, 3]` display colours seen along the normal.
        height: `[H, W]` above the plane.
        groups: `[H, W]` of the surface.
        cloud, rows: the Gaussians of the surface, whose view-dependent bands are continued.
    """
    points = torch.from_numpy(chart.points(height)[cells].astype(np.float32))
    count = len(points)
    axes = chart.plane.axes
    turn = from_matrix(torch.from_numpy(axes.T.astype(np.float32))[None])[0]
    side = COVER * chart.cell
    scales = torch.tensor([side, side, _FLAT * side], dtype=torch.float32).expand(count, 3).clone()
    rgb = torch.from_numpy(np.clip(picture[cells], 0.0, 1.0).astype(np.float32))
    sh = torch.zeros(count, cloud.sh.shape[1], 3)
    if cloud.degree and len(rows):
        sh[:, 1:] = _bands(points, cloud, rows)
        ahead = torch.from_numpy(-axes[2].astype(np.float32)).expand(count, 3)
        rgb = rgb - evaluate(sh, ahead)
    sh[:, 0] = color_to_dc(rgb)
    made = GaussianCloud.create(
        points, turn.expand(count, 4).clone(), scales, torch.full((count,), _OPACITY), sh,
        torch.from_numpy(groups[cells].astype(np.int32)),
    )  # fmt: skip
    return made.to(cloud.device)


def _bands(points: Tensor, cloud: GaussianCloud, rows: Tensor) -> Tensor:
    """`[M, K - 1, 3]` mean view-dependent bands of the nearest Gaussians of the surface."""
    tree = cKDTree(cloud.means[rows].cpu().numpy())
    _, near = tree.query(points.numpy(), k=min(_NEIGHBOURS, len(rows)))
    near = near.reshape(len(points), -1)
    return cloud.sh[rows].cpu()[torch.from_numpy(near)][:, :, 1:].mean(dim=1)
