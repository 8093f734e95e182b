"""Score distillation: the gradient by which a picture becomes more probable to a denoiser.

Poole et al. 2022, "DreamFusion", equation 3: a picture is noised, the denoiser predicts the noise, and the difference
between what it predicts and what was added is the gradient; the denoiser's own Jacobian is left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from .views import Asked

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


@runtime_checkable
class Denoiser(Protocol):
    """Predicts the noise in pictures of what is wanted.

    Attributes:
        name: its specification.
        side: px of the pictures that it takes.
        alphas: `[T]` cumulative products of 1 - beta, descending: the share of the picture in a noised one.
    """

    name: str
    side: int
    alphas: F64

    def encode(self, picture: Tensor) -> Tensor:
        """`[1, C, h, w]` of a picture `[1, 3, side, side]` in [0, 1], on its own device; differentiable."""
        ...

    def noise(self, noisy: Tensor, step: int, asked: Asked) -> Tensor:
        """The noise `[1, C, h, w]` that it sees in what `encode` gave, noised to a step of `alphas`."""
        ...


@dataclass(frozen=True)
class Annealing:
    """Which steps of a denoiser are drawn.

    Coarse form comes from strong noise, detail from weak: the strongest falls during the optimisation.

    Attributes:
        low: weakest, share of all steps.
        high, last: strongest at the start and at the end.
    """

    low: float = 0.02
    high: float = 0.98
    last: float = 0.5

    def step(self, share: float, count: int, rng: np.random.Generator) -> int:
        """A step of `count`, after a share of the optimisation."""
        top = self.high + (self.last - self.high) * min(max(share, 0.0), 1.0)
        least = int(self.low * count)
        return int(rng.integers(least, max(least + 1, min(int(top * count) + 1, count))))


def weight(alpha: float) -> float:
    """Of a step in the gradient: the variance of its noise, as in DreamFusion."""
    return 1 - alpha


def distilled(
    denoiser: Denoiser, picture: F32, asked: Asked, share: float, rng: np.random.Generator,
    annealing: Annealing | None = None,
) -> tuple[float, F32]:  # fmt: skip
    """How far a picture is from what the denoiser wants, and the gradient `[H, W, 3]` of a step towards it.

    Args:
        picture: `[H, W, 3]` float32, display space; what lies outside of [0, 1] is clipped for the denoiser.
        asked: the view that it shows.
        share: of the optimisation that is over, in [0, 1].
        rng: draws step and noise.

    Returns:
        The root mean square of the noise that was wrongly predicted, and a gradient of the order of a mean over pixels.
    """
    leaf = torch.from_numpy(np.ascontiguousarray(picture)).requires_grad_()
    inside = leaf + (leaf.clamp(0, 1) - leaf).detach()  # the gradient passes: what is too bright can come back
    shown = inside.permute(2, 0, 1)[None]
    if shown.shape[-1] != denoiser.side:
        shown = torch.nn.functional.interpolate(
            shown, size=(denoiser.side, denoiser.side), mode="bilinear", antialias=shown.shape[-1] > denoiser.side
        )
    code = denoiser.encode(shown)
    step = (annealing or Annealing()).step(share, len(denoiser.alphas), rng)
    alpha = float(denoiser.alphas[step])
    noise = torch.from_numpy(rng.standard_normal(tuple(code.shape), dtype=np.float32)).to(code)
    with torch.no_grad():
        noisy = alpha**0.5 * code + (1 - alpha) ** 0.5 * noise
        off = torch.nan_to_num(denoiser.noise(noisy, step, asked).to(code) - noise, 0.0, 0.0, 0.0)
    (gradient,) = torch.autograd.grad(code, leaf, weight(alpha) * off / code.numel())
    return float(off.square().mean().sqrt()), np.ascontiguousarray(gradient.numpy())
