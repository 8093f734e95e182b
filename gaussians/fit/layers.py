"""The Gaussians around a block as pictures: what a photograph shows in front of the block, and what behind it.

A block among layers costs what the block costs, not what everything does, and needs no other Gaussians in memory. Cells
divided by planes do not overlap from any eye, so that what is around a cell lies in front of it or behind it; layers of
cells are how RetinaGS (Li et al. 2024) divides a scene, too. Sorted by cells, Gaussians at a border may be blended in
another order than by the depth of each.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import compiled
from ..compiled import exact

F32 = NDArray[np.float32]
UNIT = 1 << 13  # of a layer's numbers: they reach from -4 to 4 in steps of 1/8192
FRONT, THROUGH, BEHIND = slice(0, 3), 3, slice(4, 7)
f4 = np.float32
ONE, STEP = f4(1), f4(1 / UNIT)


@dataclass(frozen=True, eq=False)
class Layers:
    """What is around a block in one photograph.

    Attributes:
        values: `[H, W, 7]` int16, in 1/`UNIT`: colour in front, share of the light that passes it, colour behind.
        share: of a photograph that this part of it is. Its gradients count so much, as in the mean over the whole.
    """

    values: NDArray[np.int16]
    share: float

    @classmethod
    def of(cls, front: F32, alpha: F32, behind: F32, share: float) -> Layers:
        """Layers of colours `[H, W, 3]`, drawn over black, and the opacity in front `[H, W]`."""
        values = np.concatenate([front, (1 - alpha)[..., None], behind], axis=2)
        return cls((values * UNIT).round().clip(-4 * UNIT, 4 * UNIT - 1).astype(np.int16), share)

    def merge(self, rgb: F32, alpha: F32) -> F32:
        """The picture `[H, W, 3]` of a block, drawn as `rgb` over black and `alpha` `[H, W]`, among the layers."""
        picture = np.empty_like(rgb)
        compiled.run(_merge, compiled.workers(), self.values, rgb, alpha, picture)
        return picture

    def split(self, slope: F32) -> tuple[F32, F32]:
        """Gradients by `rgb` and `alpha` of `merge` from that by its picture, times `share`."""
        by_rgb, by_alpha = np.empty_like(slope), np.empty(slope.shape[:2], np.float32)
        compiled.run(_split, compiled.workers(), self.values, slope, f4(self.share), by_rgb, by_alpha)
        return by_rgb, by_alpha

    def half_size(self) -> Layers:
        """Averages of 2x2 pixels, as of the photograph."""
        height, width = self.values.shape[0] // 2, self.values.shape[1] // 2
        even = self.values[: 2 * height, : 2 * width].reshape(height, 2, width, 2, 7)
        return Layers(even.mean(axis=(1, 3)).round().astype(np.int16), self.share)


@exact
def _merge(worker, workers, layers, rgb, alpha, picture):  # type: ignore[no-untyped-def]
    height, width = alpha.shape
    for y in range(height * worker // workers, height * (worker + 1) // workers):
        for x in range(width):
            through, rest = f4(layers[y, x, 3]) * STEP, ONE - alpha[y, x]
            for c in range(3):
                front, behind = f4(layers[y, x, c]) * STEP, f4(layers[y, x, c + 4]) * STEP
                picture[y, x, c] = front + through * (rgb[y, x, c] + rest * behind)


@exact
def _split(worker, workers, layers, slope, share, by_rgb, by_alpha):  # type: ignore[no-untyped-def]
    height, width = by_alpha.shape
    for y in range(height * worker // workers, height * (worker + 1) // workers):
        for x in range(width):
            through, behind = share * f4(layers[y, x, 3]) * STEP, f4(0)
            for c in range(3):
                by_rgb[y, x, c] = through * slope[y, x, c]
                behind += slope[y, x, c] * f4(layers[y, x, c + 4]) * STEP
            by_alpha[y, x] = -through * behind
