"""The training loop: one photograph per step, the learning-rate and SH schedule, and refinement by a strategy.

Progress is measured in steps or in seconds. Measured in steps, on the CPU, the same photographs, initial parameters and
seed give the same bytes. An engine executes the steps (`engine`), a strategy densifies and prunes (`densify`).
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..morton import codes
from .densify import Strategy
from .engine import CpuEngine, EngineFactory
from .layers import Layers
from .parameters import Parameters

F32 = NDArray[np.float32]

MEANS_LR = 1.6e-4  # initial learning rate of means, times the scene's extent
LR_DECAY = 0.01  # learning rate of means at the end, as a share of the initial one; exponential in between
REFINE_EVERY = 100  # steps between two refinements
REFINE_START_ITER = 300  # step of the first refinement
REFINE_STOP = 0.8  # share of the training after which the numbers of Gaussians and SH bands stay constant


@dataclass(frozen=True, eq=False)
class Shot:
    """A posed photograph: `photo [H, W, 3]` uint8, undistorted, of the camera's size.

    `time`: seconds, of a frame of a film; None: the photograph has none. `share`: of the pixels of the photograph that
    it is a part of. `around`: what it shows besides the Gaussians in training; None: nothing.
    """

    camera: Camera
    photo: NDArray[np.uint8]
    time: float | None = None
    share: float = 1.0
    around: Layers | None = None

    @property
    def colors(self) -> F32:
        """`[H, W, 3]`, in [0, 1]."""
        return self.photo.astype(np.float32) / np.float32(255)


@dataclass(frozen=True)
class Schedule:
    """Length and schedule of a training.

    Attributes:
        steps, seconds: length of the training; at least one is given, and of two the one that is reached first counts.
        coarse: share of the training on photographs of half the size.
        degree: final SH degree; bands are added one by one in the first half.
        ssim_lambda: weight of D-SSIM in the loss.
        first, last: the part of a whole training that this one is, as shares of it; its learning rate, bands and
            refinements are those of that part.
    """

    steps: int | None = None
    seconds: float | None = None
    coarse: float = 0.0
    degree: int = 0
    ssim_lambda: float = 0.2
    first: float = 0.0
    last: float = 1.0


class Trainer:
    """A training in progress.

    Args:
        shots: photographs to train on.
        start: initial parameters; changed in place.
        strategy: densifies and prunes.
        extent: radius of the camera positions, scene units.
        schedule: length and schedule.
        rng: draws the order of photographs; shared with the strategy, so that one state covers both.
        engine: makes the engine that executes the steps.
    """

    def __init__(
        self,
        shots: Sequence[Shot],
        start: Parameters,
        strategy: Strategy,
        extent: float,
        schedule: Schedule,
        rng: np.random.Generator,
        engine: EngineFactory = CpuEngine,
    ) -> None:
        self.strategy, self.schedule = strategy, schedule
        self._engine = engine(start, strategy, schedule.ssim_lambda)
        self._shots, self._extent, self._rng = shots, extent, rng
        self._order: list[int] = []
        self.steps, self.seconds = 0, 0.0

    @property
    def parameters(self) -> Parameters:
        """The current parameters on the host. Changes made before the next step take effect."""
        return self._engine.fetch()

    def state(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Arrays and JSON values from which `restore` continues to the same bytes; complete only `at_refinement`."""
        rng = self._rng.bit_generator.state
        return self.parameters.state(), {
            "steps": self.steps, "seconds": self.seconds, "order": self._order, "rng": rng,
        }  # fmt: skip

    def restore(self, arrays: Mapping[str, Any], values: Mapping[str, Any]) -> None:
        """Continue from a state; raises KeyError or ValueError if it is invalid."""
        self._engine.send(Parameters.load(arrays))
        self.steps, self.seconds, self._order = values["steps"], values["seconds"], list(values["order"])
        self._rng.bit_generator.state = values["rng"]

    @property
    def at_refinement(self) -> bool:
        """Whether the last step ended with a refinement: the strategy has no accumulated statistics, so that `state` is
        complete."""
        first = REFINE_START_ITER if self.schedule.first == 0 else REFINE_EVERY
        return self.steps >= first and self.steps % REFINE_EVERY == 0

    @property
    def share(self) -> float:
        """Completed share of this training, in [0, 1]."""
        schedule = self.schedule
        share = max(self.steps / (schedule.steps or math.inf), self.seconds / (schedule.seconds or math.inf))
        return min(1.0, share)

    @property
    def progress(self) -> float:
        """Completed share of the whole training of which this is a part, in [0, 1]."""
        schedule = self.schedule
        return schedule.first + (schedule.last - schedule.first) * self.share

    def step(self) -> float:
        """Train on one photograph; returns its loss."""
        started, progress = time.perf_counter(), self.progress
        if not self._order:
            self._order = self._rng.permutation(len(self._shots)).tolist()
        shot = self._shots[self._order.pop()]
        camera, photo, around = shot.camera, shot.colors, shot.around
        if progress < self.schedule.coarse:
            (camera, photo), around = half_size(shot), None if around is None else around.half_size()
        degree, final = self._engine.degree, self.schedule.degree
        if degree < final and 0.5 * (degree + 1) / (final + 1) <= progress < REFINE_STOP:  # later, bands are dropped
            self.parameters.raise_degree(degree + 1)
        loss = self._engine.train_step(camera, photo, MEANS_LR * self._extent * LR_DECAY**progress, around)
        self.steps += 1
        if self.at_refinement and progress < REFINE_STOP:
            parameters = self.parameters
            self.strategy.refine(parameters, self.steps)
            parameters.take(morton_order(parameters.means))
        self.seconds += time.perf_counter() - started
        return loss


def half_size(shot: Shot) -> tuple[Camera, F32]:
    """Camera and photograph at half the size, by averages of 2x2 pixels; an odd last row or column is dropped."""
    height, width = shot.camera.height // 2, shot.camera.width // 2
    even = shot.colors[: 2 * height, : 2 * width].reshape(height, 2, width, 2, 3)
    whole = shot.camera
    camera = Camera(
        whole.world_to_camera, whole.fx / 2, whole.fy / 2, whole.cx / 2, whole.cy / 2, width, height, whole.name
    )
    return camera, np.ascontiguousarray(even.mean(axis=(1, 3), dtype=np.float32))


def morton_order(means: F32) -> NDArray[np.int64]:
    """Rows in Morton order. Gaussians near in space are then near in memory, and rendering is a third faster."""
    low, high = np.quantile(means, [0.01, 0.99], axis=0)
    cells = np.clip((means - low) / np.maximum(high - low, 1e-12), 0, 1 - 1e-6) * 1024
    return np.argsort(codes(cells.astype(np.int64)), kind="stable")
