"""The picture of one thing as the encoders see it: cut to its silhouette, square, over a neutral grey.

Training and embedding both go through here, so that an encoder is asked about pictures like those it learnt from.
Knows pixels. Refuses to know cameras, Gaussians and encoders.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

NEUTRAL = (0.5, 0.5, 0.5)  # display RGB behind the thing: as far from white furniture as from black
MARGIN = 0.1  # of the longer side of the silhouette, on each side
LEVEL = 0.25  # alpha from which a pixel belongs to the silhouette


def silhouette_box(alpha: Tensor, level: float = LEVEL) -> tuple[int, int, int, int] | None:
    """`(top, left, bottom, right)` in pixels, end exclusive, of what is opaque in alpha `[H, W]`; None if nothing."""
    solid = alpha >= level
    rows, columns = solid.any(dim=1).nonzero(), solid.any(dim=0).nonzero()
    if not len(rows):
        return None
    return int(rows[0]), int(columns[0]), int(rows[-1]) + 1, int(columns[-1]) + 1


def square_rgba(
    rgb: Tensor, alpha: Tensor, size: int, margin: float = MARGIN, outline: Tensor | None = None
) -> Tensor | None:
    """Cut a render to its silhouette's square and resample it.

    Args:
        rgb: `[H, W, 3]` float, composited over black (premultiplied).
        alpha: `[H, W]` float in [0, 1].
        size: side of the result in pixels.
        margin: free border as a share of the silhouette's longer side.
        outline: `[H, W]` alpha of the thing alone, where `alpha` shows its background too.

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
    )  # beyond the picture there is nothing: alpha 0
    y0, x0 = max(0, y0), max(0, x0)
    cut = image[None, :, y0 : y0 + side, x0 : x0 + side]
    return functional.interpolate(cut, (size, size), mode="bilinear", antialias=True)[0].clamp(0, 1)


def over_neutral(rgba: Tensor, background: tuple[float, float, float] = NEUTRAL) -> NDArray[np.uint8]:
    """`[..., 4, S, S]` premultiplied RGBA to `[..., S, S, 3]` uint8 over a plain background."""
    behind = torch.tensor(background).reshape(3, 1, 1)
    image = rgba[..., :3, :, :] + (1 - rgba[..., 3:, :, :]) * behind
    pixels: NDArray[np.uint8] = (image.clamp(0, 1) * 255 + 0.5).to(torch.uint8).movedim(-3, -1).contiguous().numpy()
    return pixels


def crop(rgb: Tensor, alpha: Tensor, size: int, outline: Tensor | None = None) -> NDArray[np.uint8] | None:
    """The encoder's picture `[size, size, 3]` uint8 of a thing rendered over black; None if nothing was drawn.

    Args:
        outline: as for `square_rgba`, of a thing that is not drawn alone.
    """
    rgba = square_rgba(rgb.detach().cpu(), alpha.detach().cpu(), size, outline=outline)
    return None if rgba is None else over_neutral(rgba)
