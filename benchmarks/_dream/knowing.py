"""A denoiser that knows the answer: the exact score of a Gaussian around renders of a target."""

from __future__ import annotations

import numpy as np
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.dream.sds import F64
from ...gaussians.dream.views import Asked
from ...gaussians.render import render


class Knowing:
    """Pictures are N(render of the target, spread^2) in [-1, 1]; the noise that it sees in one is exact."""

    def __init__(self, target: GaussianCloud, side: int, spread: float = 0.1) -> None:
        self.name, self.side = "knowing", side
        self._target, self._spread = target, spread
        betas = np.linspace(0.00085**0.5, 0.012**0.5, 1000) ** 2
        self.alphas: F64 = np.cumprod(1 - betas)

    def encode(self, picture: Tensor) -> Tensor:
        return 2 * picture - 1

    def noise(self, noisy: Tensor, step: int, asked: Asked) -> Tensor:
        alpha = float(self.alphas[step])
        wanted = render(self._target, asked.camera.resized(self.side, self.side), asked.background).rgb.clamp(0, 1)
        mean = alpha**0.5 * (2 * wanted.permute(2, 0, 1)[None] - 1)
        return (1 - alpha) ** 0.5 * (noisy - mean) / (alpha * self._spread**2 + 1 - alpha)
