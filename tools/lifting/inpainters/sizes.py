"""Bring pictures to the size that a network takes, and back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import F32, Mask


@dataclass(frozen=True)
class Fitted:
    """How a picture was padded and resized.

    Attributes:
        size: height and width of the picture.
        padded: height and width after padding below and to the right.
        taken: height and width that the network takes.
    """

    size: tuple[int, int]
    padded: tuple[int, int]
    taken: tuple[int, int]

    @classmethod
    def to(cls, size: tuple[int, int], wanted: tuple[int | None, int | None], multiple: int = 8) -> Fitted:
        """For a network that takes one size, or any if `wanted` has None, in multiples of `multiple`."""
        height, width = wanted
        if height is None or width is None:
            padded = _up(size[0], multiple), _up(size[1], multiple)
            return cls(size, padded, (height or padded[0], width or padded[1]))
        aspect = width / height  # padded to the network's aspect ratio, so that nothing is stretched
        tall = max(size[0], round(size[1] / aspect))
        return cls(size, (tall, max(size[1], round(tall * aspect))), (height, width))

    def picture(self, rgb: F32) -> F32:
        """`[H, W, 3]` to the size taken; the padding mirrors the picture."""
        padded = np.pad(rgb, (*self._below(), (0, 0)), "symmetric")
        return padded if self.taken == self.padded else resized(padded, self.taken)

    def mask(self, mask: Mask) -> Mask:
        """`[H, W]` to the size taken: set wherever the hole is."""
        padded = np.pad(mask, self._below())
        if self.taken == self.padded:
            return padded
        return resized(padded[..., None].astype(np.float32), self.taken)[..., 0] > 0

    def back(self, rgb: F32) -> F32:
        """What the network returned at the size of the picture."""
        full = rgb if self.taken == self.padded else resized(rgb, self.padded)
        return np.ascontiguousarray(full[: self.size[0], : self.size[1]])

    def _below(self) -> tuple[tuple[int, int], tuple[int, int]]:
        return (0, self.padded[0] - self.size[0]), (0, self.padded[1] - self.size[1])


def resized(image: F32, size: tuple[int, int]) -> F32:
    """`[H, W, C]` resampled to a height and width."""
    from PIL import Image

    height, width = size
    how = Image.Resampling.BICUBIC if height > image.shape[0] else Image.Resampling.BOX
    channels = [
        Image.fromarray(np.ascontiguousarray(image[..., c])).resize((width, height), how) for c in range(image.shape[2])
    ]
    return np.stack([np.asarray(c, dtype=np.float32) for c in channels], axis=2)


def _up(side: int, multiple: int) -> int:
    return -(-side // multiple) * multiple


def bytes_of(rgb: F32) -> NDArray[np.uint8]:
    """`[H, W, 3]` uint8."""
    return (np.clip(rgb, 0, 1) * 255 + 0.5).astype(np.uint8)
