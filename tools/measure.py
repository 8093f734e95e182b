"""Measured properties of some Gaussians: their colour, how it spreads, where they are, how far they reach.

Knows numbers. Refuses to know words. Colours are those of the constant harmonic band: the average over all directions.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..gaussians.camera import Vec3
from ..gaussians.cloud import GaussianCloud
from ..gaussians.color import rgb_to_lab
from ..gaussians.harmonics import dc_to_color

SAMPLE = 1 << 13  # rows a colour is measured on: its mean is then known to about 1/90 of the spread
OPAQUE = 0.3  # below this a Gaussian is haze rather than something one could touch


@dataclass(frozen=True, eq=False)
class Sample:
    """An evenly spread sample of some rows.

    Attributes:
        rgb: `[M, 3]` float64 display colour of the constant band, not clamped.
        weight: `[M]` float64, opacity times footprint, summing to one.
    """

    rgb: Tensor
    weight: Tensor

    @cached_property
    def lab(self) -> Tensor:
        """`[M, 3]` of the colours as shown (clamped to the display)."""
        return rgb_to_lab(self.rgb.clamp(0, 1))


def sample(cloud: GaussianCloud, rows: Tensor, size: int = SAMPLE) -> Sample:
    """At most `size` of the rows, evenly spaced, with their weights.

    A footprint is the product of the two largest extents. It is clipped at its 99th percentile so that a single huge
    splat does not speak for the whole object.
    """
    rows = rows[:: max(1, -(-len(rows) // size))]
    rgb = dc_to_color(cloud.sh[rows, 0].to(torch.float64))
    extents = cloud.scales[rows].to(torch.float64).sort(dim=1).values
    area = extents[:, 1] * extents[:, 2]
    if len(area):
        area = area.clamp(max=float(torch.quantile(area, 0.99)))
    weight = cloud.opacities[rows].to(torch.float64) * area
    total = float(weight.sum())
    even = torch.full_like(weight, 1 / max(len(weight), 1))
    return Sample(rgb, weight / total if total > 0 else even)


def mean_lab(taken: Sample) -> Tensor:
    """`[3]` float64, weighted mean in CIE Lab of the colours as shown."""
    return (taken.weight[:, None] * taken.lab).sum(dim=0)


def lightness_spread(taken: Sample) -> float:
    """Weighted standard deviation of Lab lightness: how much shading and texture there is."""
    lightness = taken.lab[:, 0]
    mean = (taken.weight * lightness).sum()
    return float((taken.weight * (lightness - mean) ** 2).sum().sqrt())


def median_lab(taken: Sample) -> Vec3:
    """Weighted median in CIE Lab, channel by channel: what the language field stores of a group."""
    if not len(taken.weight):
        return (0.0, 0.0, 0.0)
    lab = taken.lab
    values = []
    for channel in range(3):
        order = lab[:, channel].argsort()
        cumulative = taken.weight[order].cumsum(0)
        index = int(torch.searchsorted(cumulative, torch.tensor(0.5, dtype=torch.float64)))
        values.append(float(lab[order[min(index, len(order) - 1)], channel]))
    return (values[0], values[1], values[2])


def centroid(cloud: GaussianCloud, rows: Tensor) -> NDArray[np.float64]:
    """`[3]`, plain mean of the centres, scene units."""
    means: NDArray[np.float64] = cloud.means[rows].to(torch.float64).mean(dim=0).cpu().numpy()
    return means


def solid_points(cloud: GaussianCloud, rows: Tensor) -> NDArray[np.float64]:
    """`[M, 3]` centres of those rows that are opaque enough to touch; all of them if none is."""
    points: NDArray[np.float64] = cloud.means[rows].to(torch.float64).cpu().numpy()
    solid = (cloud.opacities[rows] >= OPAQUE).cpu().numpy()
    return points[solid] if solid.any() else points


def reach(values: NDArray[np.float64]) -> tuple[float, float]:
    """Lowest and highest of `[M]`, a thousandth of them left out at each end (stray splats), none below 1000."""
    if not len(values):
        return 0.0, 0.0
    skip = len(values) // 1000
    ordered = np.partition(values, (skip, len(values) - 1 - skip))
    return float(ordered[skip]), float(ordered[len(values) - 1 - skip])
