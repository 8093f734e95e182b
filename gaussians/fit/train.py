"""The loop of training: a photograph, a step, and now and then Gaussians that come and go.

Knows the order of things and the schedule. Refuses to know files, where a step happens (`engine`), and which strategy
grows the scene. Progress is counted in steps or in seconds; counted in steps, on the CPU, the same photographs, start
and seed give the same bytes.
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
from .densify import Growth
from .engine import CpuEngine, Maker
from .parameters import Parameters

F32 = NDArray[np.float32]

MEANS = 1.6e-4  # rate of means at the start, in shares of the scene's extent
FALL = 0.01  # of that rate is left at the end
EVERY = 100  # steps between two changes of the number of Gaussians
QUIET = 300  # steps before the first
SETTLED = 0.8  # of the training, after which numbers of Gaussians and bands stay


@dataclass(frozen=True, eq=False)
class Shot:
    """A photograph to learn from: `photo [H, W, 3]` uint8, undistorted, of the camera's size."""

    camera: Camera
    photo: NDArray[np.uint8]

    @property
    def colors(self) -> F32:
        """`[H, W, 3]`, in [0, 1]."""
        return self.photo.astype(np.float32) / np.float32(255)


@dataclass(frozen=True)
class Schedule:
    """How long and how.

    Attributes:
        steps, seconds: what ends training, whichever is given; exactly one of them.
        coarse: share of the training on photographs of half the size.
        degree: of the harmonics at the end; bands are added one by one in the first half.
        similarity: share of SSIM in the loss.
    """

    steps: int | None = None
    seconds: float | None = None
    coarse: float = 0.0
    degree: int = 0
    similarity: float = 0.2


class Trainer:
    """A training under way.

    Args:
        shots: photographs to learn from.
        start: the parameters; changed in place.
        growth: how Gaussians come and go.
        extent: radius of the scene as the cameras stand around it, scene units.
        schedule: how long and how.
        rng: what the order of photographs is drawn by; the same as growth has, so that one state holds both.
        engine: makes what the steps happen in.
    """

    def __init__(
        self,
        shots: Sequence[Shot],
        start: Parameters,
        growth: Growth,
        extent: float,
        schedule: Schedule,
        rng: np.random.Generator,
        engine: Maker = CpuEngine,
    ) -> None:
        self.growth, self.schedule = growth, schedule
        self._engine = engine(start, growth, schedule.similarity)
        self._shots, self._extent, self._rng = shots, extent, rng
        self._order: list[int] = []
        self.steps, self.seconds = 0, 0.0

    @property
    def parameters(self) -> Parameters:
        """As they are now, on the host. To be changed, if at all, before the next step."""
        return self._engine.fetch()

    def state(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Arrays and plain values from which `restore` goes on to the same bytes, right after `changed` steps."""
        rng = self._rng.bit_generator.state
        return self.parameters.state(), {
            "steps": self.steps, "seconds": self.seconds, "order": self._order, "rng": rng,
        }  # fmt: skip

    def restore(self, arrays: Mapping[str, Any], values: Mapping[str, Any]) -> None:
        """Go on from a state; raises KeyError or ValueError if it is none."""
        self._engine.send(Parameters.load(arrays))
        self.steps, self.seconds, self._order = values["steps"], values["seconds"], list(values["order"])
        self._rng.bit_generator.state = values["rng"]

    @property
    def changed(self) -> bool:
        """Whether growth has nothing in mind: when a state is whole."""
        return self.steps >= QUIET and self.steps % EVERY == 0

    @property
    def done(self) -> float:
        """Share of the training behind us, in [0, 1]."""
        schedule = self.schedule
        share = self.steps / schedule.steps if schedule.steps else self.seconds / (schedule.seconds or math.inf)
        return min(1.0, share)

    def step(self) -> float:
        """One photograph; returns its loss."""
        started, done = time.perf_counter(), self.done
        if not self._order:
            self._order = self._rng.permutation(len(self._shots)).tolist()
        shot = self._shots[self._order.pop()]
        camera, photo = halved(shot) if done < self.schedule.coarse else (shot.camera, shot.colors)
        degree, most = self._engine.degree, self.schedule.degree
        if degree < most and 0.5 * (degree + 1) / (most + 1) <= done < SETTLED:  # what is left out then stays out
            self.parameters.widen(degree + 1)
        loss = self._engine.learn(camera, photo, MEANS * self._extent * FALL**done)
        self.steps += 1
        if self.changed and done < SETTLED:
            parameters = self.parameters
            self.growth.change(parameters, self.steps)
            parameters.take(along_a_curve(parameters.means))
        self.seconds += time.perf_counter() - started
        return loss


def halved(shot: Shot) -> tuple[Camera, F32]:
    """Camera and photograph at half the size; an odd last row or column is left out."""
    height, width = shot.camera.height // 2, shot.camera.width // 2
    even = shot.colors[: 2 * height, : 2 * width].reshape(height, 2, width, 2, 3)
    whole = shot.camera
    camera = Camera(
        whole.world_to_camera, whole.fx / 2, whole.fy / 2, whole.cx / 2, whole.cy / 2, width, height, whole.name
    )
    return camera, np.ascontiguousarray(even.mean(axis=(1, 3), dtype=np.float32))


def along_a_curve(means: F32) -> NDArray[np.int64]:
    """Rows in the order of a Morton curve: what is near in space is near in memory, which renders a third faster."""
    low, high = np.quantile(means, [0.01, 0.99], axis=0)
    cells = np.clip((means - low) / np.maximum(high - low, 1e-12), 0, 1 - 1e-6) * 1024
    code = np.zeros(len(means), np.int64)
    for axis in range(3):
        bits = cells[:, axis].astype(np.int64)
        for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
            bits = (bits | (bits << shift)) & mask
        code |= bits << axis
    return np.argsort(code, kind="stable")
