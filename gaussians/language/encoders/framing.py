"""Crop a render to the square around its silhouette and composite it over neutral grey: the input of encoders.

Training and embedding share this module, so that an encoder gets images like those it was trained on.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

NEUTRAL = (0.5, 0.5, 0.5)  # display RGB of the background: as far from white furniture as from black
MARGIN = 0.1  # of the longer side of the silhouette, on each side
MIN_ALPHA = 0.25  # from which a pixel belongs to the silhouette


def silhouette_box(alpha: Tensor, level: float = MIN_ALPHA) -> tuple[int, int, int, int] | None:
    """Bounds `(top, left, bottom, right)`, end exclusive, of pixels with alpha >= `level`; None if there are none."""
    solid = alpha >= level
    rows, columns = solid.any(dim=1).nonzero(), solid.any(dim=0).nonzero()
    if not len(rows):
        return None
    return int(rows[0]), int(columns[0]), int(rows[-1]) + 1, int(columns[-1]) + 1


def square_rgba(
    rgb: Tensor, alpha: Tensor, size: int, margin: float = MARGIN, outline: Tensor | None = None
) -> Tensor | None:
    """Crop a render to the square around its silhouette and resample it.

    Args:
        rgb: `[H, W, 3]` float, composited over black (premultiplied).
        alpha: `[H, W]` float in [0, 1].
        size: side of the result in pixels.
        margin: empty border as a share of the silhouette's longer side.
        outline: `[H, W]` alpha of the object alone, if `alpha` includes its background.

    Returns:
        `[4, size, size]` float32, premultiplied RGB and alpha, or None if the render is empty.
    """
    box = silhouette_box(alpha if outline is None else outline)
    if box is None:
        return None
    top, left, bottom, right = box
    side = max(bottom - top, right - left)
    pad = max(1, round(margin * side))
    side += 2 * pad
    y0, x0 = (top + bottom - side) // 2, (left + right - side) // 2
    image = torch.cat([rgb.movedim(-1, 0), alpha[None]]).float()  # [4, H, W]
    height, width = alpha.shape
    image = functional.pad(
        image, (max(0, -x0), max(0, x0 + side - width), max(0, -y0), max(0, y0 + side - height))
    )  # outside the image alpha is 0
    y0, x0 = max(0, y0), max(0, x0)
    cut = image[None, :, y0 : y0 + side, x0 : x0 + side]
    return functional.interpolate(cut, (size, size), mode="bilinear", antialias=True)[0].clamp(0, 1)


def over_neutral(rgba: Tensor, background: tuple[float, float, float] = NEUTRAL) -> NDArray[np.uint8]:
    """Premultiplied RGBA `[..., 4, S, S]` composited over a uniform background, `[..., S, S, 3]` uint8."""
    behind = torch.tensor(background).reshape(3, 1, 1)
    image = rgba[..., :3, :, :] + (1 - rgba[..., 3:, :, :]) * behind
    pixels: NDArray[np.uint8] = (image.clamp(0, 1) * 255 + 0.5).to(torch.uint8).movedim(-3, -1).contiguous().numpy()
    return pixels


def crop(rgb: Tensor, alpha: Tensor, size: int, outline: Tensor | None = None) -> NDArray[np.uint8] | None:
    """The encoder input `[size, size, 3]` uint8 from a render over black; None if the render is empty.

    Args:
        outline: as for `square_rgba`.
    """
    rgba = square_rgba(rgb.detach().cpu(), alpha.detach().cpu(), size, outline=outline)
    return None if rgba is None else over_neutral(rgba)
