"""Constants of the splatting convention that all renderers here share: projection, footprint and blending.

A Gaussian is projected by the first-order (EWA) approximation, its 2-D covariance is widened by `DILATION`, and at
offset d from its centre it has `alpha = min(ALPHA_MAX, opacity * exp(-d' inv(cov) d / 2))`, nothing below `ALPHA_MIN`.
Front to back by camera depth of the centres (ties: lower row first), each takes `weight = alpha * transmittance`;
a pixel is finished just before the Gaussian that would leave it `T_MIN` or less.
Sources: Zwicker et al. 2001 (EWA splatting); Kerbl et al. 2023 and its CUDA rasteriser; gsplat for `EDGE` and `NEAR`.
"""

from __future__ import annotations

NEAR = 0.01  # scene units; a centre nearer than this, or behind the eye, is not drawn
FAR = 1e10  # scene units; beyond it float32 depth has too little precision
DILATION = 0.3  # px^2 added to both variances: no footprint is narrower than about a pixel
ALPHA_MIN = 1 / 255  # one step of an 8-bit image; lower alphas are not drawn
ALPHA_MAX = 0.999  # keeps the transmittance positive behind an opaque Gaussian
T_MIN = 1e-4  # transmittance at which a pixel counts as finished
# Share of the image size: in the Jacobian, tangents are clamped this far outside the image, because the first-order
# approximation breaks down at grazing angles.
EDGE = 0.15
MAX_DETERMINANT = 1e37  # px^4; a covariance near float32's range (a footprint of billions of pixels) is not drawn
