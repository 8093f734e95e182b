"""Engines execute training steps: render, loss, backward pass, regularisation, optimiser step, strategy hook.

`CpuEngine` runs here, `engine_torch` on GPUs. Refinement (densify and prune) runs on the host with either engine.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera, Vec3
from ..render.cpu import gradient
from .densify import Strategy
from .layers import Layers
from .loss import BLACK, Slope, photometric
from .parameters import Parameters, parameter_gradients

F32 = NDArray[np.float32]


class Engine(Protocol):
    """Holds the parameters, on the host or on a device, and trains them."""

    def train_step(self, camera: Camera, photo: F32, means_lr: float, around: Layers | None = None) -> float:
        """Train on one photograph `[H, W, 3]` in [0, 1]. Returns the loss before the step.

        Args:
            means_lr: learning rate of means, scene units.
            around: what else the photograph shows, which stays as it is.
        """
        ...

    def learn(self, camera: Camera, background: Vec3, slope: Slope, means_lr: float) -> float:
        """Train on one view by a loss of any kind. Returns the loss before the step.

        Args:
            background: display-space RGB behind everything.
            slope: gives the loss of the drawn picture, and its gradient.
            means_lr: as in `train_step`.
        """
        ...

    def fetch(self) -> Parameters:
        """The current parameters on the host. Changes made to them before the next step take effect."""
        ...

    def send(self, parameters: Parameters) -> None:
        """Replace the parameters."""
        ...

    @property
    def degree(self) -> int:
        """Current SH degree."""
        ...


EngineFactory = Callable[[Parameters, Strategy, float], Engine]  # the last is the weight of D-SSIM in the loss


class CpuEngine:
    """Trains with numba kernels on the host. Same input, same bytes."""

    def __init__(self, parameters: Parameters, strategy: Strategy, ssim_lambda: float) -> None:
        self._parameters, self._strategy, self._ssim_lambda = parameters, strategy, ssim_lambda

    def train_step(self, camera: Camera, photo: F32, means_lr: float, around: Layers | None = None) -> float:
        """See `Engine`."""
        return self._step(camera, BLACK, lambda rgb: photometric(rgb, photo, self._ssim_lambda), means_lr, around)

    def learn(self, camera: Camera, background: Vec3, slope: Slope, means_lr: float) -> float:
        """See `Engine`."""
        return self._step(camera, background, slope, means_lr, None)

    def _step(self, camera: Camera, background: Vec3, slope: Slope, means_lr: float, around: Layers | None) -> float:
        """Draw, run backward, and step."""
        columns = self._parameters.columns()
        drawn = gradient.draw(columns, camera, background)
        if around is None:
            loss, d_rgb = slope(drawn.rgb)
            d_alpha = np.zeros(d_rgb.shape[:2], np.float32)
        else:
            loss, d_picture = slope(around.merge(drawn.rgb, drawn.alpha))
            d_rgb, d_alpha = around.split(d_picture)
        found = gradient.draw_backward(drawn, d_rgb, d_alpha)
        gradients = parameter_gradients(found, columns[2], columns[3])
        self._strategy.regularise(gradients, columns[2], columns[3])
        self._parameters.step(gradients, means_lr)
        self._strategy.after_step(self._parameters, found.centers, (camera.width, camera.height), means_lr)
        return loss

    def fetch(self) -> Parameters:
        """See `Engine`."""
        return self._parameters

    def send(self, parameters: Parameters) -> None:
        """See `Engine`."""
        self._parameters = parameters

    @property
    def degree(self) -> int:
        """See `Engine`."""
        return self._parameters.degree


def resolve_device(device: Literal["auto", "cpu", "cuda"]) -> Literal["cpu", "cuda"]:
    """Resolve "auto": the GPU if gsplat and a device are available, else the CPU.

    Raises:
        BackendError: "cuda" was given and something is missing; the message says what.
    """
    from ..render import cuda

    if device == "cuda":
        cuda.require()
    return "cpu" if device == "cpu" or cuda.missing() else "cuda"


def engine_for(device: Literal["cpu", "cuda"]) -> EngineFactory:
    """The factory of engines for a device."""
    if device == "cpu":
        return CpuEngine
    from ..render import cuda
    from .engine_torch import TorchEngine

    return partial(TorchEngine, device=cuda.splatting.DEVICE, draw=cuda.draw)
