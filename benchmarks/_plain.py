"""The baseline of training: the published recipe with the reference renderer and torch's autograd.

Kerbl et al. 2023: L1 and D-SSIM, Adam, Gaussians that are split, cloned and pruned, opacity resets, one more band of
harmonics every thousand steps. Gradients are those of torch through the reference renderer and the reference loss. The
order of photographs, densification and learning rates (except one that `gaussians.fit` raised) are those of
`gaussians.fit`, so that a comparison shows the effect of the compiled path and the strategy alone.
"""

from __future__ import annotations

import numpy as np
from torch import Tensor

from ..gaussians.camera import Camera, Vec3
from ..gaussians.cloud import GaussianCloud
from ..gaussians.fit import Photos, Settings
from ..gaussians.fit.densify import DefaultStrategy, Strategy
from ..gaussians.fit.engine_torch import TorchEngine
from ..gaussians.fit.initialize import initial_cloud
from ..gaussians.fit.layers import Layers
from ..gaussians.fit.parameters import F32, Parameters
from ..gaussians.fit.train import Schedule, Trainer
from ..gaussians.render import reference

BAND_EVERY = 1000  # steps between two bands of harmonics
HIGHEST = 3  # degree


class PlainEngine(TorchEngine):
    """An `Engine` of torch and the reference renderer. Bands are added by steps, as published, not by the schedule, and
    are trained with the published learning rate."""

    shn_lr = 2.5e-3 / 20

    def __init__(self, parameters: Parameters, strategy: Strategy, ssim_lambda: float) -> None:
        super().__init__(parameters, strategy, ssim_lambda, device="cpu", draw=_draw)
        self._taken = 0

    def train_step(self, camera: Camera, photo: F32, means_lr: float, around: Layers | None = None) -> float:
        """See `Engine`."""
        degree = min(HIGHEST, self._taken // BAND_EVERY)
        if degree > self.degree:
            self.fetch().raise_degree(degree)
        self._taken += 1
        return super().train_step(camera, photo, means_lr, around)


def trainer(photos: Photos, settings: Settings) -> Trainer:
    """A training with the initialization and the duration of `fit`, without a limit of Gaussians or coarse pictures."""
    rng = np.random.default_rng(settings.seed)
    parameters = Parameters.of(initial_cloud(photos, settings.max_gaussians, rng))
    strategy, schedule = DefaultStrategy(photos.extent, rng), Schedule(settings.steps, settings.seconds)
    return Trainer(photos.shots, parameters, strategy, photos.extent, schedule, rng, PlainEngine)


def _draw(
    means: Tensor, quats: Tensor, scales: Tensor, opacities: Tensor, sh: Tensor, camera: Camera, background: Vec3,
    centers: Tensor | None,
) -> tuple[Tensor, Tensor]:  # fmt: skip
    """As `render.differentiable.draw`."""
    seen = reference.render(
        GaussianCloud.create(means, quats, scales, opacities, sh), camera, background, centers=centers
    )
    return seen.rgb, seen.alpha
