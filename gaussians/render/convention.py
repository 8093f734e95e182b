"""Constants of the splatting convention that all renderers here share: projection, footprint and blending.

A Gaussian is projected by the first-order (EWA) approximation, its 2-D covariance is widened by `DILATION`, and at
offset d from its centre it has `alpha = min(ALPHA_MAX, opacity * exp(-d' inv(cov) d / 2))`, nothing below `ALPHA_MIN`.
Front to back by camera depth of the centres (ties: lower row first), each takes `weight = alpha * transmittance`;
a pixel is finished just before the Gaussian that would leave it `T_MIN` or less.
Sources: Zwicker et al. 2001 (EWA splatting); Kerbl et al. 2023 and its CUDA rasteriser; gsplat for `EDGE` and `NEAR`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from torch import Tensor

NEAR = 0.01  # scene units; a centre nearer than this, or behind the eye, is not drawn
NEAR_SHARE, NEAREST = 0.01, 1e-6  # of a small scene's extent: there the near plane is this far, see `near_plane`
_SAMPLE = 4096
FAR = 1e10  # scene units; beyond it float32 depth has too little precision
DILATION = 0.3  # px^2 added to both variances: no footprint is narrower than about a pixel
ALPHA_MIN = 1 / 255  # one step of an 8-bit image; lower alphas are not drawn
ALPHA_MAX = 0.999  # keeps the transmittance positive behind an opaque Gaussian
T_MIN = 1e-4  # transmittance at which a pixel counts as finished
# Share of the image size: in the Jacobian, tangents are clamped this far outside the image, because the first-order
# approximation breaks down at grazing angles.
EDGE = 0.15
MAX_DETERMINANT = 1e37  # px^4; a covariance near float32's range (a footprint of billions of pixels) is not drawn


def sample_step(count: int) -> int:
    """Of how many centres one is looked at for the near plane. A sample in this step is looked at whole."""
    return max(1, count // _SAMPLE)


def near_plane(means: NDArray[np.float32] | Tensor) -> float:
    """Distance of the near plane for centres `[N, 3]`, scene units.

    `NEAR`, or less where the whole scene is smaller than a unit: in a room of which a metre is a hundredth of a unit,
    0.01 units are a metre. The extent is that of an even sample of the finite centres; a scene without one has `NEAR`.
    """
    part = means[:: sample_step(len(means))]
    found = np.ascontiguousarray((part.detach().cpu().numpy() if isinstance(part, Tensor) else part).T)
    if not np.isfinite(found).all():
        found = found[:, np.isfinite(found).all(axis=0)]
    if found.shape[1] < 2:
        return NEAR
    extent = float(np.linalg.norm(found.max(axis=1).astype(np.float64) - found.min(axis=1)))
    return min(NEAR, max(NEAR_SHARE * extent, NEAREST)) if extent > 0 else NEAR
