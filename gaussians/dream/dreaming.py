"""Dream an object: score distillation over random views, with densification, checkpoints and pictures on the way.

Measured in steps, on the CPU, the same denoiser, start, settings and seed give the same bytes.
"""

from __future__ import annotations

import hashlib
import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import torch

from ..cloud import GaussianCloud
from ..errors import BackendError, FileError, UserError
from ..fit import checkpoint
from ..fit.densify import MCMCStrategy
from ..fit.engine import engine_for, resolve_device
from ..fit.fitting import CHECKPOINT_EVERY, REPORT_EVERY
from ..fit.parameters import Parameters
from ..fit.train import LR_DECAY, MEANS_LR, REFINE_EVERY, REFINE_STOP, morton_order
from .sds import Denoiser, distilled
from .start import Start
from .views import drawn

EXTENT = 2.6  # distance of the views from the object, radii: what the learning rate of means is multiplied with
COARSE, SMALL = 0.4, 0.5  # share of the dreaming in small pictures, and their side over the whole one
FAINT = 0.02  # opacity below which a Gaussian is left out at the end
_SILENT = 10  # answers in a row without a finite number after which a dream ends
_NOISE = 5e3  # of the strategy: a tenth of that for photographs, as an object has no far places to find


@dataclass(frozen=True)
class Settings:
    """Settings of a dream.

    Attributes:
        seconds, steps: length; exactly one is given.
        size: side of the pictures, px.
        max_gaussians: greatest number of Gaussians.
        opacity_reg, scale_reg: weights of the mean opacity and the mean scale: no haze, no balloons.
        seed: of all random numbers.
        device: that draws and steps; "auto" is the GPU if gsplat and a device are available.
    """

    seconds: float | None = None
    steps: int | None = None
    size: int = 128
    max_gaussians: int = 20_000
    opacity_reg: float = 0.002
    scale_reg: float = 0.01
    seed: int = 0
    device: Literal["auto", "cpu", "cuda"] = "cpu"

    def __post_init__(self) -> None:
        length = self.seconds if self.steps is None else self.steps
        if (self.seconds is None) == (self.steps is None) or length is None or not (0 < length < math.inf):
            raise UserError("the length of a dream is seconds or steps above 0; give exactly one of the two")
        if not 16 <= self.size <= 1024 or self.max_gaussians < 1:
            raise UserError(
                f"a dream has pictures of 16 to 1024 px and at least one Gaussian, got {self.size} and "
                f"{self.max_gaussians}"
            )


@dataclass(frozen=True, eq=False)
class Status:
    """Progress of a dream.

    Attributes:
        steps: that are done.
        share: in [0, 1].
        residual: running mean of what `sds.distilled` returns.
        gaussians: current number.
        seconds_left: estimate.
        cloud: makes a copy of the Gaussians as they are now.
    """

    steps: int
    share: float
    residual: float
    gaussians: int
    seconds_left: float
    cloud: Callable[[], GaussianCloud]


@dataclass(frozen=True, eq=False)
class Dreamed:
    """A dreamt object: around the origin, upright, its front towards -y, within radius 1."""

    cloud: GaussianCloud
    steps: int
    seconds: float
    residual: float


def dream(
    denoiser: Denoiser,
    start: Start,
    settings: Settings,
    *,
    checkpoint_path: Path | None = None,
    on_status: Callable[[Status], None] = lambda status: None,
) -> Dreamed:
    """Dream an object from some Gaussians.

    Args:
        checkpoint_path: file for checkpoints; the dream goes on from it if it exists. The caller deletes it when the
            object is saved.
        on_status: called every `REPORT_EVERY` seconds and at the end.

    Raises:
        FileError: the checkpoint belongs to another dream, or cannot be written.
        BackendError: the device is not available, or the denoiser fails.
    """
    work = _Work(denoiser, start, settings)
    name = _name(denoiser, start, settings)
    if checkpoint_path is not None:
        work.resume(checkpoint_path, name)
    saved = told = time.monotonic()
    while work.share < 1:
        work.step()
        now = time.monotonic()
        if checkpoint_path is not None and work.refined and now - saved >= CHECKPOINT_EVERY:
            arrays, values = work.state()
            checkpoint.save(checkpoint_path, arrays, {**values, "name": name})
            saved = now
        if now - told >= REPORT_EVERY or work.share >= 1:
            on_status(work.status())
            told = now
    cloud = work.cloud()
    shown = cloud[(cloud.opacities > FAINT).nonzero().squeeze(1)]
    return Dreamed(shown if len(shown) else cloud, work.steps, work.seconds, work.residual)


class _Work:
    """A dream in progress."""

    def __init__(self, denoiser: Denoiser, start: Start, settings: Settings) -> None:
        self._denoiser, self._settings = denoiser, settings
        self._rng = np.random.default_rng(settings.seed)
        self._strategy = MCMCStrategy(
            settings.max_gaussians, self._rng, opacity_reg=settings.opacity_reg, scale_reg=settings.scale_reg,
            noise_lr=_NOISE,
        )  # fmt: skip
        engine = engine_for(resolve_device(settings.device))
        self._engine = engine(Parameters.of(start.cloud), self._strategy, 0.0)
        self.steps, self.seconds, self.residual, self._silent = 0, 0.0, math.nan, 0

    @property
    def share(self) -> float:
        """Of the dream that is over, in [0, 1]."""
        settings = self._settings
        return min(1.0, self.steps / settings.steps if settings.steps else self.seconds / (settings.seconds or 1.0))

    @property
    def refined(self) -> bool:
        """Whether the last step ended with a refinement: `state` is complete."""
        return self.steps > 0 and self.steps % REFINE_EVERY == 0

    def step(self) -> None:
        """One view."""
        started, share = time.perf_counter(), self.share
        size = self._settings.size if share >= COARSE else max(16, round(SMALL * self._settings.size))
        asked = drawn(self._rng, size)

        def slope(picture: np.ndarray) -> tuple[float, np.ndarray]:
            return distilled(self._denoiser, picture, asked, share, self._rng)

        off = self._engine.learn(asked.camera, asked.background, slope, MEANS_LR * EXTENT * LR_DECAY**share)
        self._silent = self._silent + 1 if off == 0 else 0  # what is not finite counts as no difference
        if self._silent == _SILENT:
            raise BackendError(
                f"the model gave no finite numbers {_SILENT} times in a row: its weights may be damaged; fetch it anew"
            )
        self.residual = off if math.isnan(self.residual) else 0.98 * self.residual + 0.02 * off
        self.steps += 1
        if self.refined and share < REFINE_STOP:
            parameters = self._engine.fetch()
            self._strategy.refine(parameters, self.steps)
            parameters.take(morton_order(parameters.means))
        self.seconds += time.perf_counter() - started

    def cloud(self) -> GaussianCloud:
        """A copy of the Gaussians."""
        return self._engine.fetch().cloud()

    def status(self) -> Status:
        """How far it is."""
        left = self.seconds * (1 / max(self.share, 1e-9) - 1)
        count = len(self._engine.fetch())
        return Status(self.steps, self.share, self.residual, count, left, self.cloud)

    def state(self) -> tuple[dict[str, np.ndarray], dict[str, object]]:
        """Arrays and JSON values from which `resume` goes on to the same bytes."""
        values = {"steps": self.steps, "seconds": self.seconds, "residual": self.residual}
        return self._engine.fetch().state(), {**values, "rng": self._rng.bit_generator.state}

    def resume(self, path: Path, name: str) -> None:
        """Go on from a checkpoint, if there is one."""
        found = checkpoint.load(path)
        if found is None:
            return
        arrays, values = found
        if values.get("name") != name:
            raise FileError(f"{path} is of another dream (words, model, start or settings); delete it to start over")
        try:
            self._engine.send(Parameters.load(arrays))
            self.steps, self.seconds, self.residual = values["steps"], values["seconds"], values["residual"]
            self._rng.bit_generator.state = values["rng"]
        except (KeyError, ValueError, TypeError) as error:
            raise FileError(f"cannot go on from {path} ({error}); delete it to start over") from error


def _name(denoiser: Denoiser, start: Start, settings: Settings) -> str:
    """Identifies a dream: digest of denoiser, start, and settings without length and device."""
    told = {**asdict(settings), "seconds": None, "steps": None, "device": None}
    digest = hashlib.sha256(f"{denoiser.name} {told}".encode())
    for _, column in start.cloud.columns():
        digest.update(np.ascontiguousarray(torch.as_tensor(column).numpy()).tobytes())
    return digest.hexdigest()
