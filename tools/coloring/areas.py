"""Evenly spaced samples of Gaussians with their places, visible areas and colours."""

from __future__ import annotations

from typing import NamedTuple

from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.harmonics import dc_to_color

_LARGEST = 0.95  # quantile of the areas above which they are clipped: a few very large splats do not decide


class Areas(NamedTuple):
    """Some Gaussians of a thing.

    Attributes:
        points: `[M, 3]` centres.
        area: `[M]` product of opacity and the two largest extents.
        rgb: `[M, 3]` display colour of the constant band, clamped to the display.
    """

    points: Tensor
    area: Tensor
    rgb: Tensor


def areas(cloud: GaussianCloud, rows: Tensor, size: int) -> Areas:
    """About `size` of the rows `[N]`, N > 0, evenly spaced."""
    rows = rows[:: max(1, len(rows) // size)]
    extents = cloud.scales[rows]
    area = extents.prod(dim=1) / extents.amin(dim=1).clamp(min=1e-30) * cloud.opacities[rows]
    largest = area.kthvalue(max(1, int(_LARGEST * len(area)))).values
    return Areas(cloud.means[rows], area.minimum(largest), dc_to_color(cloud.sh[rows, 0]).clamp(0, 1))
