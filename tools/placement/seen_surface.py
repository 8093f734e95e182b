"""The height at which a surface of a capture is seen: fitted ground is haze over layers of several depths."""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor

from ...gaussians.camera import Camera, Vec3
from ...gaussians.cloud import GaussianCloud
from ...gaussians.render import render
from ...gaussians.rows import rows_within
from ...gaussians.world.box import Axes
from .bodies import Array

_PIXELS = 28  # along a side of the picture from above
_FAR = 30.0  # times the footprint's longer side: distance of the eye, so that the view is nearly parallel
_BAND = 0.2  # of a thing's height: how far from the height that points tell the surface may be seen
_RISES = 0.03  # of its height: how much higher it may be seen
_HALF_OPAQUE, _FILLED = 0.5, 0.4  # alpha of a pixel that shows the surface, and share of the footprint that must
_FAINT = 0.02  # opacity below which a Gaussian does not count


def seen_height(cloud: GaussianCloud, without: Tensor | None, foot: Array, axes: Axes, size: Vec3) -> float | None:
    """How far above a foot the surface under it is seen, on average over its footprint; None if hardly any is seen.

    Args:
        without: `[N]` bool, Gaussians that are no part of it.
        foot: `[3]` world, the middle of the thing's underside.
        axes, size: of the thing's box.
    """
    across, _, up = (np.array(a) for a in axes)
    band, wide = _BAND * size[2], max(size[:2])
    corner = np.full(3, 0.75 * wide + band)
    near = rows_within(cloud.means, foot - corner, foot + corner)
    near = near if without is None else near[~without[near]]
    local = (cloud.means[near].to(torch.float64).cpu().numpy() - foot) @ np.array(axes).T
    use = (np.abs(local[:, 2]) < band) & (np.abs(local[:, :2]) < 0.75 * wide).all(axis=1)
    use &= (cloud.opacities[near] > _FAINT).cpu().numpy()
    if not use.any():
        return None
    eye = foot + _FAR * wide * up
    turn = float(np.degrees(2 * np.arctan(0.5 / _FAR)))
    camera = Camera.look_at(eye, foot, across, _PIXELS, _PIXELS, turn, "above")
    picture = render(cloud[near[torch.from_numpy(use).to(near.device)]], camera)
    shown = picture.alpha.cpu().numpy() > _HALF_OPAQUE
    if shown.mean() < _FILLED:
        return None
    # Remains of other things are higher; what carries a thing is hardly above where its points were found.
    return min(float(np.median(_FAR * wide - picture.depth.cpu().numpy()[shown])), _RISES * size[2])
