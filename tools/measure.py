"""What edits measure of some Gaussians besides what the language field stores of them: means, spreads, contact.

Knows numbers. Refuses to know words, and how a group's own box and colour are measured (gaussians.language.measure).
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..gaussians.cloud import GaussianCloud
from ..gaussians.language.field.measure import Sample

OPAQUE = 0.3  # below this a Gaussian is haze rather than something one could touch


def mean_lab(taken: Sample) -> Tensor:
    """`[3]` float64, weighted mean in CIE Lab of the colours as shown."""
    return (taken.weight[:, None] * taken.lab).sum(dim=0)


def lightness_spread(taken: Sample) -> float:
    """Weighted standard deviation of Lab lightness: how much shading and texture there is."""
    lightness = taken.lab[:, 0]
    mean = (taken.weight * lightness).sum()
    return float((taken.weight * (lightness - mean) ** 2).sum().sqrt())


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
