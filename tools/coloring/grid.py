"""A grid over a thing: sums of values in its cells, smoothed, and read back at points. Its size does not grow with the
number of points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import torch
from torch import Tensor
from torch.nn.functional import avg_pool3d, grid_sample

_EDGE = 0.01  # share of the points at each end along an axis that may lie outside the grid
_SAMPLE = 1 << 12  # points from which its extent is measured


@dataclass(frozen=True, eq=False)
class Grid:
    """`cells` along the longest axis of the extent of some points, cubes of side `step` (scene units), from `low`.

    Attributes:
        low: `[3]` float32, lower corner.
        step: side of a cell.
        shape: number of cells along x, y and z.
    """

    low: Tensor
    step: float
    shape: tuple[int, int, int]

    @classmethod
    def over(cls, points: Tensor, cells: int) -> Self:
        """The grid over points `[M, 3]`, without the outermost hundredth along each axis."""
        few = points[:: max(1, len(points) // _SAMPLE)].to(torch.float32)
        ordered = few.sort(dim=0).values
        low, high = ordered[int(_EDGE * (len(few) - 1))], ordered[int((1 - _EDGE) * (len(few) - 1))]
        step = max(float((high - low).max()) / cells, 1e-9)
        across = ((high - low) / step).ceil().clamp(3, max(cells, 3)).to(torch.int64).tolist()
        return cls(low, step, (across[0], across[1], across[2]))

    @property
    def size(self) -> int:
        """Number of cells."""
        return self.shape[0] * self.shape[1] * self.shape[2]

    def cell_of(self, points: Tensor) -> Tensor:
        """`[M]` int64 flat index of the cell of each point; points outside are put into the nearest cell."""
        top = torch.tensor(self.shape, dtype=torch.float32) - 1
        x, y, z = ((points - self.low) / self.step).floor().clamp_(min=0).minimum(top).to(torch.int64).unbind(1)
        return (x * self.shape[1] + y) * self.shape[2] + z

    def sums(self, points: Tensor, values: Tensor) -> Tensor:
        """`[cells, C]` sums of the values `[M, C]` of the points in each cell."""
        return torch.zeros(self.size, values.shape[1], dtype=values.dtype).index_add_(0, self.cell_of(points), values)

    def smoothed(self, cells: Tensor, times: int = 1) -> Tensor:
        """`[cells, C]`: each cell becomes the mean of the 27 around it, `times` times; zero beyond the border."""
        block = cells.T.reshape(1, -1, *self.shape)
        for _ in range(times):
            block = avg_pool3d(block, 3, stride=1, padding=1)
        return block.reshape(cells.shape[1], -1).T

    def read(self, cells: Tensor, points: Tensor) -> Tensor:
        """`[M]` values at points, linearly interpolated between the centres of the cells `[cells]`."""
        block = cells.to(torch.float32).reshape(1, 1, *self.shape)
        extent = torch.tensor(self.shape, dtype=torch.float32) * self.step
        where = (2 * (points - self.low) / extent - 1).flip(1).reshape(1, 1, 1, -1, 3)  # its order is z, y, x
        return grid_sample(block, where, padding_mode="border", align_corners=False).reshape(-1)
