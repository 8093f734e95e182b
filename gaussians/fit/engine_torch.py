"""Steps of training in torch, on any device, with a rasteriser that is given.

Knows tensors, autograd and the memory of Adam. Refuses to know which rasteriser draws, and how Gaussians come and go:
for that the parameters go to the host and come back. Each step is that of `engine.CpuEngine` in other arithmetic; what
is drawn by chance comes from the same generator in the same order, so that the two tell the same story up to rounding.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..camera import Camera, Vec3
from ..cloud import SH_BANDS
from .adam import BETAS, EPSILON, Adam
from .densify import Growth
from .loss import BLACK, reference
from .parameters import HIGHER, Parameters, rates

F32 = NDArray[np.float32]


class Draw(Protocol):
    """A differentiable rasteriser, as `render.differentiable.draw`."""

    def __call__(
        self, means: Tensor, quats: Tensor, scales: Tensor, opacities: Tensor, sh: Tensor, camera: Camera,
        background: Vec3, centers: Tensor | None,
    ) -> tuple[Tensor, Tensor]: ...  # fmt: skip


class TorchEngine:
    """An `Engine` on a device of torch.

    Args:
        parameters: copied to the device when a step is made.
        growth: what regularises and lets Gaussians wander between changes.
        similarity: share of SSIM in the loss.
        device: of torch.
        draw: draws columns that lie there.
    """

    higher = HIGHER  # rate of all bands but the constant one

    def __init__(self, parameters: Parameters, growth: Growth, similarity: float, *, device: str, draw: Draw) -> None:
        self._growth, self._similarity = growth, similarity
        self._device, self._draw = device, draw
        self._host: Parameters | None = parameters  # None: they are on the device, and only there

    def send(self, parameters: Parameters) -> None:
        """See `Engine`."""
        self._host = parameters

    def _upload(self, parameters: Parameters) -> None:
        self._host = None
        self._values = {name: torch.tensor(a, device=self._device) for name, a in parameters.arrays().items()}
        self._memory = {
            name: (torch.tensor(memory.first, device=self._device), torch.tensor(memory.second, device=self._device))
            for name, memory in parameters.memory.items()
        }
        self._steps = {name: memory.steps for name, memory in parameters.memory.items()}

    def fetch(self) -> Parameters:
        """See `Engine`."""
        if self._host is None:
            arrays = {name: _array(values) for name, values in self._values.items()}
            memory = {n: Adam(_array(a), _array(b), self._steps[n]) for n, (a, b) in self._memory.items()}
            self._host = Parameters(**arrays, memory=memory)
        return self._host

    @property
    def degree(self) -> int:
        """See `Engine`."""
        return SH_BANDS[self._values["sh"].shape[1]] if self._host is None else self._host.degree

    def learn(self, camera: Camera, photo: F32, rate: float) -> float:
        """See `Engine`."""
        if self._host is not None:
            self._upload(self._host)
        leaves = {name: values.detach().requires_grad_() for name, values in self._values.items()}
        scales, opacities = leaves["logs"].exp(), leaves["logits"].sigmoid()
        centers = torch.zeros(len(scales), 2, device=self._device, requires_grad=True)
        shown, wanted = (leaves["means"], leaves["quats"], scales, opacities, leaves["sh"]), torch.from_numpy(photo)
        rgb, _ = self._draw(*shown, camera, BLACK, centers)
        # A window's variance is a small difference of large sums, which ten bits, torch's default on GPUs, would lose.
        with torch.backends.cudnn.flags(enabled=True, deterministic=True, allow_tf32=False):
            loss = reference(rgb, wanted.to(self._device), self._similarity)
            loss.backward()  # type: ignore[no-untyped-call]
        with torch.no_grad():
            gradients = {n: torch.zeros_like(x) if x.grad is None else x.grad for n, x in leaves.items()}
            self._growth.regularise(gradients, scales.detach(), opacities.detach())
            self._step(gradients, rate)
            pulled = torch.zeros_like(centers) if centers.grad is None else centers.grad
            self._growth.stepped_there(self._values, pulled, (camera.width, camera.height), rate)
        return loss.item()

    def _step(self, gradients: dict[str, Tensor], rate: float) -> None:
        """One step of Adam, as `adam.Adam`."""
        for name, each in rates(rate).items():
            values, gradient, (first, second) = self._values[name], gradients[name], self._memory[name]
            self._steps[name] += 1
            bias1, bias2 = (1 - beta ** self._steps[name] for beta in BETAS)
            first.lerp_(gradient, 1 - BETAS[0])
            second.mul_(BETAS[1]).addcmul_(gradient, gradient, value=1 - BETAS[1])
            move = first / second.sqrt().div_(bias2**0.5).add_(EPSILON)
            if name == "sh":
                move[:, 1:] *= self.higher / each
            values.sub_(move, alpha=each / bias1)


def _array(values: Tensor) -> F32:
    """A copy on the host."""
    found: F32 = values.detach().cpu().numpy().copy()
    return found
