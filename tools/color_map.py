"""Affine maps of display colour that act on harmonics exactly, and how far colours are apart.

Harmonics are linear in colour: with T(c) = A c + b the constant band becomes A dc + (b + A h - h) / C0 (h = 0.5, the
offset of display colour), every other band becomes A times itself, and the recoloured Gaussian shows exactly T of its
old colour from every direction. A map in Lab for each Gaussian would need a Jacobian, which is right to first order
only and would tint highlights.

Light multiplies linear light. For a display whose transfer is a power law it multiplies display values too, so a map
without an offset is a change of pigment or light.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from ..gaussians.color import LUMA as LUMA
from ..gaussians.harmonics import SH_C0

# Largest allowed CIE94 distance of the lit faces from the requested colour. A pure colour at the end of the display's
# range has to change its lightness to leave room for light and shadow: a distance of 5 is usual, and twice that for a
# target of several colours whose pattern stays visible. At half as much again another colour name begins.
NEAR = 15.0


@dataclass(frozen=True, eq=False)
class ColorMap:
    """`c -> matrix @ c + offset` on display colours.

    Attributes:
        matrix: `[3, 3]` float64.
        offset: `[3]` float64, or `[M, 3]`: one for each of M Gaussians.
    """

    matrix: Tensor
    offset: Tensor

    def __call__(self, rgb: Tensor) -> Tensor:
        """Mapped colours `[..., 3]`."""
        return rgb @ self.matrix.T.to(rgb.dtype) + self.offset.to(rgb.dtype)

    def on_harmonics(self, sh: Tensor) -> Tensor:
        """Coefficients `[N, K, 3]` that show the mapped colour in every direction."""
        own = torch.diagonal(self.matrix)
        turned = sh * own.to(sh) if torch.equal(torch.diag(own), self.matrix) else sh @ self.matrix.T.to(sh)
        half = torch.full((3,), 0.5, dtype=torch.float64)
        shift = ((self(half) - half) / SH_C0).to(sh)
        turned[:, 0] += shift
        return turned


def distance(shown: Tensor, asked: Tensor) -> Tensor:
    """CIE94 distance of Lab colours `[..., 3]` from the requested one, graphic-arts weights.

    CIE76 gives a slightly darker pure red the same distance as a pink; CIE94 divides chroma differences at a chroma of
    100 by 5.5.
    """
    lightness, chroma = shown[..., 0] - asked[..., 0], torch.linalg.vector_norm(asked[..., 1:], dim=-1)
    off_chroma = torch.linalg.vector_norm(shown[..., 1:], dim=-1) - chroma
    off_plane = torch.linalg.vector_norm(shown[..., 1:] - asked[..., 1:], dim=-1)
    off_hue = (off_plane**2 - off_chroma**2).clamp(min=0).sqrt()
    by_chroma, by_hue = off_chroma / (1 + 0.045 * chroma), off_hue / (1 + 0.015 * chroma)
    return torch.sqrt(lightness**2 + by_chroma**2 + by_hue**2)
