"""There and back: a picture with what it takes to carry its gradient back to the Gaussians.

Knows the order of the stages of both ways. Refuses to know their insides (`backward`, `unproject`) and
torch's bookkeeping (`..differentiable`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import compiled
from ...camera import Camera, Vec3
from . import LIMITS, Bins, _counter, blend_backward, canvas, drawn, project_backward

Array = NDArray[Any]


@dataclass(frozen=True)
class Drawn:
    """A picture, `rgb [H, W, 3]` and `alpha [H, W]` float32, and the sorted footprints of each strip of its rows."""

    columns: tuple[Array, ...]
    rgb: Array
    alpha: Array
    strips: tuple[tuple[int, int, Bins], ...]


@dataclass(frozen=True)
class Gradients:
    """Of one number by the columns of a cloud, float32: `means [N, 3]`, `quats [N, 4]`, `scales [N, 3]`,
    `opacities [N]`, `sh [N, K, 3]`; and by the footprints' centres in pixels, `centers [N, 2]`."""

    means: Array
    quats: Array
    scales: Array
    opacities: Array
    sh: Array
    centers: Array


def draw(columns: tuple[Array, ...], camera: Camera, background: Vec3) -> Drawn:
    """Draw five columns of a cloud (means, quats, scales, opacities, sh; float32, contiguous)."""
    out = canvas(camera)
    strips = tuple(drawn((*columns, np.zeros(len(columns[0]), np.int32)), camera, background, out))
    return Drawn(columns, out[0], out[1], strips)


def undraw(picture: Drawn, d_rgb: Array, d_alpha: Array) -> Gradients:
    """Carry the gradient of a picture, `[H, W, 3]` and `[H, W]`, back to the columns. Same input, same bytes."""
    columns, count = picture.columns, compiled.workers()
    out = *(np.zeros_like(column) for column in columns), np.zeros((len(columns[0]), 2), np.float32)
    scratch = blend_backward.make_scratch(count)
    for top, bottom, bins in picture.strips:
        seen = picture.rgb[top:bottom], picture.alpha[top:bottom]
        gradient = d_rgb[top:bottom], d_alpha[top:bottom]
        each = np.empty((len(bins.entries), blend_backward.GRADIENT), np.float32)
        sorted_ = bins.first, bins.entries, bins.records, (d_alpha.shape[1], bottom - top), LIMITS
        compiled.run(blend_backward.unblend_tiles, count, *sorted_, seen, gradient, each, scratch, _counter())
        total = np.zeros((len(columns[0]), blend_backward.GRADIENT), np.float32)
        compiled.run(blend_backward.collect, count, bins.entries, each, total)
        shaped = columns, bins.view, bins.records, total, out
        compiled.run(project_backward.unproject, count, *shaped, _counter())
    return Gradients(*out)
