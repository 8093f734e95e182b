"""Training as first published, through the renderer that is made to be read: what all speed-ups are measured against.

Kerbl et al. 2023: L1 and D-SSIM, Adam, Gaussians that are split, cloned, pruned and made faint, one more band of
harmonics every thousand steps. Gradients are torch's own, of the readable renderer and of the readable loss; order of
photographs, rates, optimiser and growth are the very ones of `gaussians.fit`, so that a comparison of the two says what
the compiled path and the strategy give, and nothing else.

Knows autograd. Refuses to know photographs on the disk, and how good the scene becomes.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import torch

from ..gaussians.camera import Camera
from ..gaussians.cloud import GaussianCloud
from ..gaussians.fit import Photos, Settings, loss
from ..gaussians.fit.growth import Classic
from ..gaussians.fit.parameters import F32, Parameters, chained
from ..gaussians.fit.start import start
from ..gaussians.fit.train import BLACK, Schedule, Trainer
from ..gaussians.render import reference

BAND_EVERY = 1000  # steps between two bands of harmonics
HIGHEST = 3  # degree
COLUMNS = ("means", "quats", "scales", "opacities", "sh")


class PlainTrainer(Trainer):
    """A `Trainer` whose steps go through torch. Its schedule's degree must be 0: bands come by steps, as published."""

    def _learn(self, camera: Camera, photo: F32, rate: float) -> float:
        parameters = self.parameters
        parameters.widen(min(HIGHEST, self.steps // BAND_EVERY))
        columns = parameters.columns()
        leaves = {name: torch.tensor(c, requires_grad=True) for name, c in zip(COLUMNS, columns, strict=True)}
        centers = torch.zeros(len(parameters), 2, requires_grad=True)
        picture = reference.render(GaussianCloud.create(**leaves), camera, BLACK, centers=centers).rgb
        off = loss.reference(picture, torch.from_numpy(photo), self.schedule.similarity)
        off.backward()  # type: ignore[no-untyped-call]
        found = {n: leaf.grad.numpy() for n, leaf in leaves.items() if leaf.grad is not None}
        gradients = chained(SimpleNamespace(**found), columns[2], columns[3])
        self.growth.regularise(gradients, columns[2], columns[3])
        parameters.step(gradients, rate)
        pulls = torch.zeros_like(centers) if centers.grad is None else centers.grad
        self.growth.stepped(parameters, pulls.numpy(), (camera.width, camera.height), rate)
        return float(off.detach())


def trainer(photos: Photos, settings: Settings) -> PlainTrainer:
    """A training from the same start as `fit` makes, to the same end, without a budget and without coarse pictures."""
    rng = np.random.default_rng(settings.seed)
    parameters = Parameters.of(start(photos, settings.most, rng))
    schedule = Schedule(settings.steps, settings.seconds)
    return PlainTrainer(photos.shots, parameters, Classic(photos.extent, rng), photos.extent, schedule, rng)
