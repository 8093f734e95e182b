"""Pictures that new Gaussians are optimised against, cut out of larger ones, and where given Gaussians show in them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud
from ...gaussians.harmonics import color_to_dc
from ...gaussians.render import render

F32 = NDArray[np.float32]
Mask = NDArray[np.bool_]
Box = tuple[int, int, int, int]  # left, top, right, bottom of a part of a picture, pixels; right and bottom excluded

LEAST_SIDE = 16  # px of a part: the renderer works in tiles, and the loss in windows of 11 px
MAX_PSNR = 60.0  # dB


@dataclass(frozen=True, eq=False)
class Target:
    """A picture, or a part of one, that shows what new Gaussians should look like.

    Attributes:
        camera: of the part's size.
        rgb: `[H, W, 3]` in [0, 1], display space.
        counts: `[H, W]`, the pixels that count.
    """

    camera: Camera
    rgb: F32
    counts: Mask


def part_of(camera: Camera, box: Box) -> Camera:
    """The camera of a part of a picture."""
    left, top, right, bottom = box
    return replace(camera, cx=camera.cx - left, cy=camera.cy - top, width=right - left, height=bottom - top)


def box_around(camera: Camera, points: Tensor, pad: int) -> Box | None:
    """The part of a picture that shows some points `[M, 3]`, with a border of `pad` pixels; None if it shows none."""
    pixels, depth = camera.project(points.to(torch.float64).cpu().numpy())
    inside = pixels[camera.contains(pixels, depth)]
    if not len(inside):
        return None
    low, high = np.floor(inside.min(axis=0)) - pad, np.ceil(inside.max(axis=0)) + pad
    left, right = _wide(low[0], high[0], camera.width)
    top, bottom = _wide(low[1], high[1], camera.height)
    return left, top, right, bottom


def _wide(low: float, high: float, size: int) -> tuple[int, int]:
    """A range of pixels within a picture, at least `LEAST_SIDE` of them where the picture has as many."""
    missing = max(0.0, LEAST_SIDE - (high - low)) / 2
    first, last = max(0, math.floor(low - missing)), min(size, math.ceil(high + missing))
    if last - first < LEAST_SIDE:
        first, last = max(0, last - LEAST_SIDE), min(size, first + LEAST_SIDE)
    return first, last


def shares(cloud: GaussianCloud, marks: Sequence[Tensor], camera: Camera) -> F32:
    """`[H, W, 3]`: the blending weight that the marked Gaussians have in each pixel, one channel a mark.

    Args:
        marks: at most three, `[N]` bool.
    """
    rgb = torch.zeros(len(cloud), 3)
    for channel, mark in enumerate(marks):
        rgb[:, channel] = mark.to(rgb)
    weights: F32 = render(cloud.replace(sh=color_to_dc(rgb)[:, None].to(cloud.device)), camera).rgb.cpu().numpy()
    return weights


def psnr(cloud: GaussianCloud, targets: Sequence[Target]) -> float:
    """dB of the mean squared error over all pixels that count; NaN if none does."""
    square, pixels = 0.0, 0
    for target in targets:
        seen = render(cloud, target.camera).rgb.clamp(0, 1).cpu().numpy()
        square += float(((seen - target.rgb)[target.counts].astype(np.float64) ** 2).sum())
        pixels += 3 * int(target.counts.sum())
    return min(MAX_PSNR, -10 * math.log10(max(square / pixels, 1e-12))) if pixels else math.nan
