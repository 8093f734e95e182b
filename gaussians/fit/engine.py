"""Where a step of training happens: what holds the parameters and moves them against the gradient of a photograph.

Knows the order within a step: draw, compare, carry back, regularise, step, wander. Refuses to know schedules, files,
and when Gaussians come and go, which happens on the host whatever the engine. `engine_torch` is the one for GPUs.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..render.cpu import gradient
from .densify import Growth
from .loss import BLACK, photometric
from .parameters import Parameters, chained

F32 = NDArray[np.float32]


class Engine(Protocol):
    """Parameters under training, wherever they lie."""

    def learn(self, camera: Camera, photo: F32, rate: float) -> float:
        """One step towards a photograph `[H, W, 3]` in [0, 1]; `rate` is that of means. Returns the loss before it."""
        ...

    def fetch(self) -> Parameters:
        """The parameters on the host as they are now. What is changed about them until the next step, holds."""
        ...

    def send(self, parameters: Parameters) -> None:
        """Go on with these."""
        ...

    @property
    def degree(self) -> int:
        """Of the harmonics as they are now."""
        ...


Maker = Callable[[Parameters, Growth, float], Engine]  # the last is the share of SSIM in the loss


class CpuEngine:
    """Numba on the host. Same input, same bytes."""

    def __init__(self, parameters: Parameters, growth: Growth, similarity: float) -> None:
        self._parameters, self._growth, self._similarity = parameters, growth, similarity

    def learn(self, camera: Camera, photo: F32, rate: float) -> float:
        """See `Engine`."""
        columns = self._parameters.columns()
        drawn = gradient.draw(columns, camera, BLACK)
        loss, slope = photometric(drawn.rgb, photo, self._similarity)
        found = gradient.draw_backward(drawn, slope, np.zeros(slope.shape[:2], np.float32))
        gradients = chained(found, columns[2], columns[3])
        self._growth.regularise(gradients, columns[2], columns[3])
        self._parameters.step(gradients, rate)
        self._growth.stepped(self._parameters, found.centers, (camera.width, camera.height), rate)
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


def device_of(wish: Literal["auto", "cpu", "cuda"]) -> Literal["cpu", "cuda"]:
    """What a wish comes to on this machine; "auto" is the GPU where gsplat and a device are there.

    Raises:
        BackendError: "cuda", and something is missing; the message says what.
    """
    from ..render import cuda

    if wish == "cuda":
        cuda.require()
    return "cpu" if wish == "cpu" or cuda.missing() else "cuda"


def engine_on(device: Literal["cpu", "cuda"]) -> Maker:
    """What makes an engine for a device."""
    if device == "cpu":
        return CpuEngine
    from ..render import cuda
    from .engine_torch import TorchEngine

    return partial(TorchEngine, device=cuda.splatting.DEVICE, draw=cuda.draw)
