"""Engines execute training steps: render, loss, backward pass, regularisation, optimiser step, strategy hook.

`CpuEngine` runs here, `engine_torch` on GPUs. Refinement (densify and prune) runs on the host with either engine.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from functools import partial
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera, Vec3
from ..render.cpu import gradient
from .densify import Strategy
from .loss import BLACK, Slope, photometric
from .parameters import Columns, Parameters, parameter_gradients

F32 = NDArray[np.float32]


class Engine(Protocol):
    """Holds the parameters, on the host or on a device, and trains them."""

    def train_step(self, camera: Camera, photo: F32, means_lr: float) -> float:
        """Train on one photograph `[H, W, 3]` in [0, 1]. Returns the loss before the step.

        Args:
            means_lr: learning rate of means, scene units.
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
    """Trains with numba kernels on the host. Same input, same bytes.

    Args:
        around: columns (`Parameters.columns`) of Gaussians that are drawn too and stay as they are, of any degree.
    """

    def __init__(
        self, parameters: Parameters, strategy: Strategy, ssim_lambda: float, around: Columns | None = None
    ) -> None:
        self._parameters, self._strategy, self._ssim_lambda = parameters, strategy, ssim_lambda
        self._around = None if around is None else _Around(around)

    def train_step(self, camera: Camera, photo: F32, means_lr: float) -> float:
        """See `Engine`."""
        return self.learn(camera, BLACK, lambda rgb: photometric(rgb, photo, self._ssim_lambda), means_lr)

    def learn(self, camera: Camera, background: Vec3, slope: Slope, means_lr: float) -> float:
        """See `Engine`."""
        columns = self._parameters.columns()
        shown = columns if self._around is None else self._around.after(columns)
        drawn = gradient.draw(shown, camera, background)
        loss, d_rgb = slope(drawn.rgb)
        found = gradient.draw_backward(drawn, d_rgb, np.zeros(d_rgb.shape[:2], np.float32))
        found = found if self._around is None else _first_rows(found, len(columns[0]))
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


class _Around:
    """Columns that are drawn after those in training, in one piece of memory with them."""

    def __init__(self, columns: Columns) -> None:
        self._columns = columns
        self._joined: Columns | None = None

    def after(self, own: Columns) -> Columns:
        """Both, with as many SH bands as `own` has. The arrays are overwritten by the next call."""
        joined = self._joined
        if joined is None or joined[4].shape != (len(own[0]) + len(self._columns[0]), *own[4].shape[1:]):
            joined = self._joined = self._made(own)
        for column, values in zip(joined, own, strict=True):
            column[: len(values)] = values
        return joined

    def _made(self, own: Columns) -> Columns:
        bands, sh = own[4].shape[1], self._columns[4][:, : own[4].shape[1]]
        padded = np.zeros((len(sh), bands, 3), np.float32)
        padded[:, : sh.shape[1]] = sh
        means, quats, scales, opacities, sh = (
            np.concatenate([mine, other]) for mine, other in zip(own, (*self._columns[:4], padded), strict=True)
        )
        return means, quats, scales, opacities, sh


def _first_rows(found: gradient.Gradients, count: int) -> gradient.Gradients:
    """The gradients of the first Gaussians."""
    return gradient.Gradients(**{f.name: getattr(found, f.name)[:count] for f in fields(found)})


def resolve_device(device: Literal["auto", "cpu", "cuda"]) -> Literal["cpu", "cuda"]:
    """Resolve "auto": the GPU if gsplat and a device are available, else the CPU.

    Raises:
        BackendError: "cuda" was given and something is missing; the message says what.
    """
    from ..render import cuda

    if device == "cuda":
        cuda.require()
    return "cpu" if device == "cpu" or cuda.missing() else "cuda"


def engine_for(device: Literal["cpu", "cuda"], around: Columns | None = None) -> EngineFactory:
    """The factory of engines for a device.

    Args:
        around: Gaussians that are drawn too and stay as they are, see `CpuEngine`.
    """
    if device == "cpu":
        return CpuEngine if around is None else partial(CpuEngine, around=around)
    from ..render import cuda
    from .engine_torch import TorchEngine

    return partial(TorchEngine, device=cuda.splatting.DEVICE, draw=cuda.draw, around=around)
