"""Floaters: Gaussians that lie apart from every surface, as specks, or as round blobs that hang in the air.

A Gaussian of a surface has neighbours within a few of its own standard deviations, also on a plain wall, where they
are few and wide. Belonging to no group says little: much of a plain wall does not, and a blob may have a group.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...cloud import GaussianCloud
from ...world.core import least_opacity

Bool = NDArray[np.bool_]

_NEIGHBOURS = 5  # solid Gaussians that a piece of surface has around it; a cable has no more
_REACH = 3.0  # own standard deviations, plus as many typical spacings, within which they lie
_ROUND = 0.35  # least share of the longest standard deviation that the shortest of a blob has; surfaces are flatter
_WIDE = 12.0  # typical sizes from which a round Gaussian is a blob


def floaters(cloud: GaussianCloud, strength: float = 1.0) -> Bool:
    """Whether each Gaussian `[N]` is a floater; none is where there are too few to tell.

    Args:
        strength: at 2 about twice as many are floaters as at 1. What is one at a strength is one at every greater
            strength.
    """
    from scipy.spatial import cKDTree

    points = cloud.means.detach().cpu().numpy().astype(np.float64)
    solid: Bool = (cloud.opacities >= least_opacity(cloud.opacities)).cpu().numpy()
    if int(solid.sum()) <= 4 * _NEIGHBOURS:
        return np.zeros(len(points), dtype=bool)
    closer = math.sqrt(strength)
    # A solid Gaussian is its own first neighbour.
    away = cKDTree(points[solid]).query(points, k=_NEIGHBOURS + 1)[0][:, -1]
    sizes = np.sort(cloud.scales.detach().cpu().numpy().astype(np.float64), axis=1)
    typical, spacing = float(np.median(sizes[:, 2])), float(np.median(away[solid]))
    speck = away > _REACH / closer * (sizes[:, 2] + spacing)
    round_ = sizes[:, 0] > _ROUND * sizes[:, 2]
    blob = round_ & (sizes[:, 2] > _WIDE / closer * typical) & (away > sizes[:, 1] / closer)
    return np.asarray(speck | blob)
