"""Low frequencies of the shading: the luma of a surface, averaged over about a tenth of its extent.

The mean is weighted by luma too: Gaussians inside of a thing, which no photograph saw, are black and not in shadow.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ..color_map import LUMA
from .areas import areas
from .grid import Grid

_CELLS = 24  # along the longest axis
_SMOOTHINGS = 2  # of 3 cells each: together about a tenth of the extent
_BLACK = 0.01  # luma added to the weight, so that what is black has some
_SAMPLE = 1 << 14  # Gaussians that it is measured on


@dataclass(frozen=True, eq=False)
class Shading:
    """A smooth field of display luma over a thing.

    Attributes:
        grid: its cells.
        luma: `[cells]` float32.
    """

    grid: Grid
    luma: Tensor

    @classmethod
    def of(cls, cloud: GaussianCloud, rows: Tensor) -> Shading:
        """The field over some rows `[M]` of a cloud, M > 0, weighted by opacity and footprint."""
        points, area, rgb = areas(cloud, rows, _SAMPLE)
        luma = rgb @ torch.tensor(LUMA, dtype=torch.float32)
        weight = area * (luma + _BLACK)
        grid = Grid.over(points, _CELLS)
        sums = grid.sums(points, torch.stack([weight * luma, weight], dim=1))
        mean = sums[:, 0].sum() / sums[:, 1].sum().clamp(min=1e-30)
        sums = grid.smoothed(sums, _SMOOTHINGS)
        faint = 1e-3 * float(sums[:, 1].max()) + 1e-30  # cells far from all surfaces tend to the mean
        return cls(grid, (sums[:, 0] + faint * mean) / (sums[:, 1] + faint))

    def at(self, points: Tensor) -> Tensor:
        """`[M]` luma at points `[M, 3]`."""
        return self.grid.read(self.luma, points)
