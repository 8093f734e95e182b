"""How a tower that was trained on photographs wants its pixels. Knows pixels; refuses to know towers and files."""

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
    """Attributes:
    size: side of the square input. Crops are square, so they are resampled to it whole and nothing is cut away.
    mean, std: of the pixels, in [0, 1], as trained.
    resample: how.
    """

    size: int
    mean: Channels
    std: Channels
    resample: Literal["bicubic", "bilinear"] = "bicubic"

    def prepare(self, images: NDArray[np.uint8]) -> Tensor:
        """`[B, H, W, 3]` uint8 to `[B, 3, size, size]` float32, normalised."""
        x = torch.from_numpy(np.ascontiguousarray(images)).movedim(-1, 1).float() / 255
        x = functional.interpolate(x, (self.size, self.size), mode=self.resample, antialias=True).clamp(0, 1)
        mean, std = (torch.tensor(v).reshape(1, 3, 1, 1) for v in (self.mean, self.std))
        return (x - mean) / std
