"""Training steps in torch, on any device, with a given differentiable rasteriser.

Refinement runs on the host: the parameters are downloaded for it and uploaded again. Each step computes the same as
`engine.CpuEngine` and draws random numbers from the same generator in the same order, so that both agree up to
rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..camera import Camera, Vec3
from ..cloud import SH_BANDS
from .adam import BETAS, EPSILON, Adam
from .densify import Strategy
from .layers import BEHIND, FRONT, THROUGH, UNIT, Layers
from .loss import BLACK, Slope, reference
from .parameters import SHN_LR, Parameters, learning_rates

F32 = NDArray[np.float32]


class Draw(Protocol):
    """A differentiable rasteriser, as `render.differentiable.draw`."""

    def __call__(
        self, means: Tensor, quats: Tensor, scales: Tensor, opacities: Tensor, sh: Tensor, camera: Camera,
        background: Vec3, centers: Tensor | None,
    ) -> tuple[Tensor, Tensor]: ...  # fmt: skip


class TorchEngine:
    """An `Engine` on a torch device.

    Args:
        parameters: copied to the device at the next step.
        strategy: regularises the gradients and runs after each step.
        ssim_lambda: weight of D-SSIM in the loss.
        device: torch device.
        draw: rasterises columns that lie on the device.
    """

    shn_lr = SHN_LR  # learning rate of all SH bands but band 0

    def __init__(
        self, parameters: Parameters, strategy: Strategy, ssim_lambda: float, *, device: str, draw: Draw
    ) -> None:
        self._strategy, self._ssim_lambda = strategy, ssim_lambda
        self._device, self._draw = device, draw
        self._host: Parameters | None = parameters  # None: the device holds the only copy

    def send(self, parameters: Parameters) -> None:
        """See `Engine`."""
        self._host = parameters

    def _upload(self, parameters: Parameters) -> None:
        self._host = None
        self._values = {name: torch.tensor(a, device=self._device) for name, a in parameters.arrays().items()}
        self._moments = {
            name: (torch.tensor(adam.first, device=self._device), torch.tensor(adam.second, device=self._device))
            for name, adam in parameters.optimisers.items()
        }
        self._steps = {name: adam.steps for name, adam in parameters.optimisers.items()}

    def fetch(self) -> Parameters:
        """See `Engine`."""
        if self._host is None:
            arrays = {name: _array(values) for name, values in self._values.items()}
            optimisers = {n: Adam(_array(a), _array(b), self._steps[n]) for n, (a, b) in self._moments.items()}
            self._host = Parameters(**arrays, optimisers=optimisers)
        return self._host

    @property
    def degree(self) -> int:
        """See `Engine`."""
        return SH_BANDS[self._values["sh"].shape[1]] if self._host is None else self._host.degree

    def train_step(self, camera: Camera, photo: F32, means_lr: float, around: Layers | None = None) -> float:
        """See `Engine`."""

        def learnt(rgb: Tensor) -> float:
            # A window's variance is a small difference of large sums. TF32, torch's default for convolutions on GPUs,
            # has a mantissa of ten bits and would lose it.
            with torch.backends.cudnn.flags(enabled=True, deterministic=True, allow_tf32=False):
                loss = reference(rgb, torch.from_numpy(photo).to(self._device), self._ssim_lambda)
                loss.backward()  # type: ignore[no-untyped-call]
            return loss.item()

        return self._step(camera, BLACK, learnt, means_lr, around)

    def learn(self, camera: Camera, background: Vec3, slope: Slope, means_lr: float) -> float:
        """See `Engine`."""

        def learnt(rgb: Tensor) -> float:
            loss, d_rgb = slope(_array(rgb))
            rgb.backward(torch.from_numpy(d_rgb).to(self._device))  # type: ignore[no-untyped-call]
            return loss

        return self._step(camera, background, learnt, means_lr, None)

    def _step(
        self,
        camera: Camera,
        background: Vec3,
        learnt: Callable[[Tensor], float],
        means_lr: float,
        around: Layers | None,
    ) -> float:
        """Draw, run backward through `learnt`, which returns the loss, and step."""
        if self._host is not None:
            self._upload(self._host)
        leaves = {name: values.detach().requires_grad_() for name, values in self._values.items()}
        scales, opacities = leaves["log_scales"].exp(), leaves["logit_opacities"].sigmoid()
        centers = torch.zeros(len(scales), 2, device=self._device, requires_grad=True)
        columns = leaves["means"], leaves["quats"], scales, opacities, leaves["sh"]
        rgb, alpha = self._draw(*columns, camera, background, centers)
        loss = learnt(rgb if around is None else self._among(rgb, alpha, around))
        with torch.no_grad():
            gradients = {n: torch.zeros_like(x) if x.grad is None else x.grad for n, x in leaves.items()}
            self._strategy.regularise(gradients, scales.detach(), opacities.detach())
            self._adam_step(gradients, means_lr)
            d_centers = torch.zeros_like(centers) if centers.grad is None else centers.grad
            self._strategy.after_step_torch(self._values, d_centers, (camera.width, camera.height), means_lr)
        return loss

    def _among(self, rgb: Tensor, alpha: Tensor, around: Layers) -> Tensor:
        """As `Layers.merge`; gradients are multiplied as by `Layers.split`."""
        values = torch.from_numpy(around.values.astype(np.float32) / np.float32(UNIT)).to(self._device)
        front, through, behind = values[..., FRONT], values[..., THROUGH], values[..., BEHIND]
        picture = front + through[..., None] * (rgb + (1 - alpha)[..., None] * behind)
        picture.register_hook(lambda slope: slope * around.share)  # type: ignore[no-untyped-call]
        return picture

    def _adam_step(self, gradients: dict[str, Tensor], means_lr: float) -> None:
        """One step of Adam, as `adam.Adam`."""
        for name, rate in learning_rates(means_lr).items():
            values, gradient, (first, second) = self._values[name], gradients[name], self._moments[name]
            self._steps[name] += 1
            bias1, bias2 = (1 - beta ** self._steps[name] for beta in BETAS)
            first.lerp_(gradient, 1 - BETAS[0])
            second.mul_(BETAS[1]).addcmul_(gradient, gradient, value=1 - BETAS[1])
            move = first / second.sqrt().div_(bias2**0.5).add_(EPSILON)
            if name == "sh":
                move[:, 1:] *= self.shn_lr / rate
            values.sub_(move, alpha=rate / bias1)


def _array(values: Tensor) -> F32:
    """A copy on the host."""
    found: F32 = values.detach().cpu().numpy().copy()
    return found
