"""Forward and backward pass of the CPU renderer; runs the stages in `blend_backward` and `project_backward`.

`..differentiable` wraps both for torch's autograd.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import compiled
from ...camera import Camera, Vec3
from . import LIMITS, Bins, _counter, blend_backward, draw_strips, make_image, project_backward, workers

Array = NDArray[Any]


@dataclass(frozen=True)
class Drawn:
    """Result of a forward pass: `rgb [H, W, 3]` and `alpha [H, W]` float32, and the sorted footprints of each strip of
    image rows, which the backward pass needs."""

    columns: tuple[Array, ...]
    rgb: Array
    alpha: Array
    strips: tuple[tuple[int, int, Bins], ...]


@dataclass(frozen=True)
class Gradients:
    """Gradients of a scalar by the columns of a cloud, float32: `means [N, 3]`, `quats [N, 4]`, `scales [N, 3]`,
    `opacities [N]`, `sh [N, K, 3]`; and by the footprint centres in pixels, `centers [N, 2]`."""

    means: Array
    quats: Array
    scales: Array
    opacities: Array
    sh: Array
    centers: Array


def draw(columns: tuple[Array, ...], camera: Camera, background: Vec3) -> Drawn:
    """Draw five columns of a cloud (means, quats, scales, opacities, sh; float32, contiguous)."""
    out = make_image(camera)
    strips = tuple(draw_strips((*columns, np.zeros(len(columns[0]), np.int32)), camera, background, out))
    return Drawn(columns, out[0], out[1], strips)


def draw_backward(picture: Drawn, d_rgb: Array, d_alpha: Array) -> Gradients:
    """Propagate the gradient of an image, `[H, W, 3]` and `[H, W]`, back to the columns. Same input, same bytes."""
    columns, count = picture.columns, workers(len(picture.columns[0]), d_alpha.size)
    out = *(np.zeros_like(column) for column in columns), np.zeros((len(columns[0]), 2), np.float32)
    scratch = blend_backward.make_scratch(count)
    for top, bottom, bins in picture.strips:
        seen = picture.rgb[top:bottom], picture.alpha[top:bottom]
        gradient = d_rgb[top:bottom], d_alpha[top:bottom]
        each = np.empty((len(bins.entries), blend_backward.GRADIENT), np.float32)
        sorted_ = bins.first, bins.entries, bins.records, (d_alpha.shape[1], bottom - top), LIMITS
        compiled.run(blend_backward.draw_backward, count, *sorted_, seen, gradient, each, scratch, _counter())
        total = np.zeros((len(columns[0]), blend_backward.GRADIENT), np.float32)
        compiled.run(blend_backward.collect, count, bins.entries, each, total)
        projected = columns, bins.view, bins.records, total, out
        compiled.run(project_backward.project_backward, count, *projected, _counter())
    return Gradients(*out)
