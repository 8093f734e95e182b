"""Split the Gaussians of a surface on which a shadow falls, where they are too coarse to show it.

A fitted floor without texture has Gaussians as wide as a thing's whole shadow. Those over which the shadow changes are
split into children that look the same together (`finishing.subdivide`), down to about a cell of the shadow's chart, or
as far as a limit on their number allows. All other rows stay bit for bit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.rotations import to_matrix
from ..filling.occlusion import depth_of
from ..finishing.subdivide import counts_for, subdivided
from .carrier import Carried

F64 = NDArray[np.float64]
_CELLS = 1.3  # of a chart: standard deviation of children
_COARSE = 1.8  # times that: from which a Gaussian is split
_VARIES = 0.1  # ratio of colours by which a shadow varies over it, likewise
_MOST = 8_000  # children of the surface of one thing
_EACH = 6  # children along an axis at most: the opacities of more take long to find
_AT = 1.2  # standard deviations from its middle at which the shadow is compared
_FAINT = 0.05  # opacity below which none is split
_STEPS = 14  # of the search for their size
_LARGER = 1.18  # factor of the size from one to the next


@dataclass(frozen=True, eq=False)
class Finer:
    """Gaussians that are split: their rows `[S]` in the cloud, and the children in their place, parent by parent.

    Attributes:
        parents: `[C]` the row of each child's parent in the cloud.
    """

    split: Tensor
    children: GaussianCloud
    parents: Tensor


def finer(cloud: GaussianCloud, places: list[Carried], strength: float) -> Finer | None:
    """The Gaussians that are too coarse for the shadows of things; None if there are none.

    Args:
        places: what carries each thing.
    """
    counts = torch.ones(len(cloud), 2, dtype=torch.int64)
    for place in places:
        rows, wanted = _wanted(cloud, place, strength)
        counts[rows] = torch.maximum(counts[rows], wanted)
    split = (counts.amax(dim=1) > 1).nonzero().squeeze(1)
    if not len(split):
        return None
    children, parents = subdivided(cloud[split], counts[split])
    return Finer(split, children, split[parents])


def _wanted(cloud: GaussianCloud, place: Carried, strength: float) -> tuple[Tensor, Tensor]:
    """Rows to be split, and `[M, 2]` into how many along their longest and their second axis."""
    least = _CELLS * place.shade.chart.cell
    rows = place.rows.cpu()
    sides, order = cloud.scales[rows].sort(dim=1, descending=True)
    coarse = (sides[:, 0] > _COARSE * least) & (cloud.opacities[rows] > _FAINT)
    rows, sides, order = rows[coarse], sides[coarse], order[coarse]
    if not len(rows):
        return rows, torch.ones(0, 2, dtype=torch.int64)
    varies = torch.from_numpy(_varies(cloud, rows, order, place, strength) > _VARIES)
    rows, sides = rows[varies], sides[varies]
    opacities = cloud.opacities[rows]
    counts = torch.ones(len(rows), 2, dtype=torch.int64)
    for step in range(_STEPS):
        size = least * _LARGER**step
        counts = torch.stack([counts_for(sides[:, k], opacities, size).clamp(max=_EACH) for k in (0, 1)], dim=1)
        if int(counts.prod(dim=1).sum()) <= _MOST:
            break
    return rows, counts


def _varies(
    cloud: GaussianCloud, rows: Tensor, order: Tensor, place: Carried, strength: float
) -> F64:  # fmt: skip
    """`[M]` by how much the ratio of a shadow's colours varies over each Gaussian."""
    axes = to_matrix(cloud.quats[rows])
    means = cloud.means[rows]
    found = [_ratio(place, means, strength)]
    for k in (0, 1):
        along = axes.gather(2, order[:, k, None, None].expand(-1, 3, 1)).squeeze(2)
        side = _AT * cloud.scales[rows].gather(1, order[:, k, None])
        found += [_ratio(place, means + sign * side * along, strength) for sign in (-1.0, 1.0)]
    table = np.stack(found)
    return np.asarray(table.max(axis=0) - table.min(axis=0))


def _ratio(place: Carried, points: Tensor, strength: float) -> F64:
    return np.exp(-strength * depth_of(place.at(points)))
