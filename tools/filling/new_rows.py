"""New Gaussians for the filled cells of a chart: flat, one a cell, coloured like the picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.harmonics import color_to_dc, evaluate
from ...gaussians.rotations import from_matrix
from .charts import Chart
from .planes import F64

COVER = 0.6  # standard deviation over the side of a cell: no gaps, and edges stay crisp
FLAT = 0.0813  # thickness over the standard deviation along the surface: no other Gaussians have just this one
OPACITY = 0.97
_SAME = 1e-3  # relative error of the proportions and the opacity by which a fill is recognised
_EXACT = 1e-5  # likewise of the proportions alone: float32 logarithms keep 1e-6
_NEIGHBOURS = 8  # Gaussians of the surface whose view-dependent colour a new one takes


@dataclass(frozen=True, eq=False)
class Look:
    """Places and colours of new Gaussians.

    Attributes:
        points: `[M, 3]` float32, world.
        rgb: `[M, 3]` display colours, seen in the directions `ahead`.
        group: `[M]` of the surface.
        ahead: `[M, 3]` float32, unit, from the eye.
    """

    points: Tensor
    rgb: F64
    group: NDArray[np.int32]
    ahead: Tensor


def gaussians_of(chart: Chart, look: Look, cloud: GaussianCloud, rows: Tensor) -> GaussianCloud:
    """A Gaussian for each place.

    Args:
        cloud, rows: the Gaussians of the surface, whose view-dependent bands are continued.
    """
    count = len(look.points)
    turn = from_matrix(torch.from_numpy(chart.plane.axes.T.astype(np.float32))[None])[0]
    side = COVER * chart.cell
    scales = torch.tensor([side, side, FLAT * side], dtype=torch.float32).expand(count, 3).clone()
    rgb = torch.from_numpy(np.clip(look.rgb, 0.0, 1.0).astype(np.float32))
    sh = torch.zeros(count, cloud.sh.shape[1], 3)
    if cloud.degree and len(rows):
        sh[:, 1:] = _bands(look.points, cloud, rows)
        rgb = rgb - evaluate(sh, look.ahead)
    sh[:, 0] = color_to_dc(rgb)
    made = GaussianCloud.create(
        look.points, turn.expand(count, 4).clone(), scales, torch.full((count,), OPACITY), sh,
        torch.from_numpy(look.group.astype(np.int32)),
    )  # fmt: skip
    return made.to(cloud.device)


def is_fill(cloud: GaussianCloud, rows: Tensor) -> Tensor:
    """`[M]` bool: the rows that a fill made, told by their opacity and proportions, which a file keeps.

    Where pictures changed the opacity (see `lifting`), the proportions tell, which they then have to do exactly.
    """
    scales = cloud.scales[rows]
    off = (scales[:, 2] / (FLAT * scales[:, 0]) - 1).abs()
    return (off < _EXACT) | ((off < _SAME) & ((cloud.opacities[rows] / OPACITY - 1).abs() < _SAME))


def _bands(points: Tensor, cloud: GaussianCloud, rows: Tensor) -> Tensor:
    """`[M, K - 1, 3]` mean view-dependent bands of the nearest Gaussians of the surface."""
    from scipy.spatial import cKDTree

    tree = cKDTree(cloud.means[rows].cpu().numpy())
    _, near = tree.query(points.numpy(), k=min(_NEIGHBOURS, len(rows)))
    near = near.reshape(len(points), -1)
    return cloud.sh[rows].cpu()[torch.from_numpy(near)][:, :, 1:].mean(dim=1)
