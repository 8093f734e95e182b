"""How good a fit is: PSNR and SSIM on photographs it never saw, and pictures to look at.

Knows renders and photographs. Refuses to know training.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ..cloud import GaussianCloud
from ..render import render
from .loss import similarity
from .train import Shot

BEST = 100.0  # dB, where equal pictures are capped


@dataclass(frozen=True)
class Quality:
    """Means over photographs, and each by the photograph's name.

    Attributes:
        psnr: dB, of pictures clipped to [0, 1].
        ssim: Wang et al. 2004, as `loss.similarity`.
        each: name to (psnr, ssim).
    """

    psnr: float
    ssim: float
    each: dict[str, tuple[float, float]]


def measure(cloud: GaussianCloud, shots: Sequence[Shot]) -> Quality:
    """How a cloud shows what was photographed; NaN of no photographs."""
    each = {}
    for shot in shots:
        seen = render(cloud, shot.camera).rgb.clamp(0, 1)
        photo = torch.from_numpy(shot.colors)
        off = float((seen - photo).square().mean(dtype=torch.float64))
        each[shot.camera.name] = (min(BEST, -10 * math.log10(max(off, 1e-12))), float(similarity(seen, photo)))
    psnr, ssim = np.mean(list(each.values()), axis=0).tolist() if each else (math.nan, math.nan)
    return Quality(psnr, ssim, each)


def beside(cloud: GaussianCloud, shot: Shot) -> NDArray[np.uint8]:
    """The photograph, the render, and their difference fourfold, side by side: `[H, 3 W, 3]`."""
    seen = render(cloud, shot.camera).to_uint8()
    off = np.clip(4 * np.abs(seen.astype(int) - shot.photo.astype(int)), 0, 255).astype(np.uint8)
    return np.concatenate([shot.photo, seen, off], axis=1)
