"""Contours of a picture without a network: steps of colour, texture, depth and normals at several scales.

At each of some orientations the means of the two halves of a small Gaussian window are compared (Martin et al., TPAMI
2004, compare histograms). A step counts by how much it exceeds the steps around it, so that what is rough everywhere
has contours at its rim only.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import ndimage

from ....color import rgb_to_lab

F32 = NDArray[np.float32]

SCALES = (1.2, 2.4)  # pixels, of the windows for colour
TEXTURE_SCALE = 3.5  # pixels, of the windows for texture
SURROUND = 12.0  # pixels around a step with which it is compared
COLOR_UNIT = 12.0  # Lab difference between the halves that counts as one unit
TEXTURE_UNIT = 6.0  # likewise, of the mean deviation of lightness
DEPTH_UNIT = 0.06  # relative step of inverse depth
NORMAL_UNIT = 0.35  # length of the difference of normals
LIGHTNESS = 0.6  # light changes L along one surface more than a and b
CREST = 5  # pixels of the window in which a crest is the largest
ROUGH = 0.8  # of the mean step around that is added to the unit


def contours(picture: F32) -> F32:
    """Contour strength `[H, W]` in [0, 1] of a picture `[8, H, W]`, whose channels `channels.py` lists."""
    lab = rgb_to_lab(torch.from_numpy(np.ascontiguousarray(picture[:3].transpose(1, 2, 0)))).numpy().transpose(2, 0, 1)
    lab = lab.astype(np.float32) * np.array([LIGHTNESS, 1, 1], np.float32)[:, None, None]
    strength = np.zeros(picture.shape[1:], np.float32)
    for scale in SCALES:
        strength = np.maximum(strength, _relative(_step(lab, scale), COLOR_UNIT))
    light = lab[0] / LIGHTNESS
    rough = np.abs(light - ndimage.gaussian_filter(light, 2.0, mode="nearest"))
    rough = ndimage.gaussian_filter(rough, 1.5, mode="nearest")
    strength = np.maximum(strength, _relative(_step(rough[None], TEXTURE_SCALE), TEXTURE_UNIT))
    known = picture[7]
    if known.any():
        inner = ndimage.minimum_filter(known, size=5)
        depth = _step(picture[3:4], SCALES[0]) / np.maximum(ndimage.gaussian_filter(picture[3], 2.0), 1e-3)
        strength = np.hypot(strength, inner * depth / DEPTH_UNIT)
        strength = np.hypot(strength, inner * _relative(_step(picture[4:7], SCALES[1]), NORMAL_UNIT))
    thin = _thinned(strength)
    result: F32 = (1 - np.exp(-thin)).astype(np.float32)
    return result


def _step(channels: F32, scale: float) -> F32:
    """Largest difference over all directions between the two sides of each pixel, all channels together `[H, W]`.

    The derivative of a Gaussian of width s times s * sqrt(2 pi) is the difference between the means of its two halves
    across a straight step. The largest direction is that of the structure tensor.
    """
    xx = xy = yy = np.zeros(channels.shape[1:], np.float32)
    for channel in channels:
        x = ndimage.gaussian_filter(channel, scale, order=(0, 1), mode="nearest")
        y = ndimage.gaussian_filter(channel, scale, order=(1, 0), mode="nearest")
        xx, xy, yy = xx + x * x, xy + x * y, yy + y * y
    largest = 0.5 * (xx + yy + np.sqrt(np.square(xx - yy) + 4 * np.square(xy)))
    result: F32 = (scale * np.float32(np.sqrt(2 * np.pi)) * np.sqrt(np.maximum(largest, 0))).astype(np.float32)
    return result


def _relative(step: F32, unit: float) -> F32:
    """Steps in units that grow with the mean step around."""
    around = ndimage.uniform_filter(step, size=2 * int(SURROUND) + 1, mode="nearest")
    result: F32 = (step / (unit + ROUGH * around)).astype(np.float32)
    return result


def _thinned(strength: F32) -> F32:
    """The strengths with all but crests reduced, so that contours are a pixel or two wide."""
    crest = strength / np.maximum(ndimage.maximum_filter(strength, size=CREST, mode="nearest"), 1e-6)
    result: F32 = (strength * np.clip(4 * crest - 3, 0.1, 1)).astype(np.float32)
    return result
