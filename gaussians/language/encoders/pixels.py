"""Preprocessing of images for image towers that were trained on photographs: resize and normalise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

Channels = tuple[float, float, float]


@dataclass(frozen=True)
class Pixels:
    """Preprocessing of one model.

    Attributes:
        size: side of the square input. Crops are square, so they are resized without cropping.
        mean, std: of the pixels in [0, 1] of the training.
        resample: interpolation of the resizing.
    """

    size: int
    mean: Channels
    std: Channels
    resample: Literal["bicubic", "bilinear"] = "bicubic"

    def prepare(self, images: NDArray[np.uint8]) -> Tensor:
        """Images `[B, H, W, 3]` uint8 as normalised input `[B, 3, size, size]` float32."""
        x = torch.from_numpy(np.ascontiguousarray(images)).movedim(-1, 1).float() / 255
        x = functional.interpolate(x, (self.size, self.size), mode=self.resample, antialias=True).clamp(0, 1)
        mean, std = (torch.tensor(v).reshape(1, 3, 1, 1) for v in (self.mean, self.std))
        return (x - mean) / std
