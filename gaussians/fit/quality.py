"""Evaluate a trained scene: PSNR and SSIM on held-out photographs, and side-by-side comparison images."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ..cloud import GaussianCloud
from ..render import render
from .loss import ssim
from .train import Shot

MAX_PSNR = 100.0  # dB, reported for identical images


@dataclass(frozen=True)
class Quality:
    """Means over photographs, and each by the photograph's name.

    Attributes:
        psnr: dB, of pictures clipped to [0, 1].
        ssim: Wang et al. 2004, see `loss.ssim`.
        each: name to (psnr, ssim).
    """

    psnr: float
    ssim: float
    each: dict[str, tuple[float, float]]


def measure(cloud: GaussianCloud, shots: Sequence[Shot]) -> Quality:
    """PSNR and SSIM of a cloud's renders against photographs; NaN without photographs."""
    each = {}
    for shot in shots:
        seen = render(cloud, shot.camera).rgb.clamp(0, 1)
        photo = torch.from_numpy(shot.colors)
        mse = float((seen - photo).square().mean(dtype=torch.float64))
        each[shot.camera.name] = (min(MAX_PSNR, -10 * math.log10(max(mse, 1e-12))), float(ssim(seen, photo)))
    mean_psnr, mean_ssim = np.mean(list(each.values()), axis=0).tolist() if each else (math.nan, math.nan)
    return Quality(mean_psnr, mean_ssim, each)


def comparison(cloud: GaussianCloud, shot: Shot) -> NDArray[np.uint8]:
    """The photograph, the render, and four times their absolute difference, side by side: `[H, 3 W, 3]`."""
    seen = render(cloud, shot.camera).to_uint8()
    difference = np.clip(4 * np.abs(seen.astype(int) - shot.photo.astype(int)), 0, 255).astype(np.uint8)
    return np.concatenate([shot.photo, seen, difference], axis=1)
