"""Train a scene on a loaded capture: initialise, train with checkpoints, reduce, evaluate on held-out photographs."""

from __future__ import annotations

import hashlib
import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np

from ..effort import Dial, Effort
from ..errors import FileError, UserError
from ..scene import Scene
from . import checkpoint, held_out_choice
from .densify import DefaultStrategy, MCMCStrategy, Strategy
from .engine import engine_for, resolve_device
from .held_out_choice import Choice
from .initialize import initial_cloud
from .parameters import Parameters
from .photographs.photos import Photos
from .quality import Quality, measure
from .train import REFINE_STOP, Schedule, Trainer

SECONDS = 300.0  # of a training whose length nobody says
EVAL_PHOTOS = 6  # held-out photographs that are evaluated during training
EVALUATIONS = 20  # number of evaluations during training
CHECKPOINT_EVERY = 30.0  # seconds
REPORT_EVERY = 0.5  # seconds


@dataclass(frozen=True)
class Settings:
    """Settings of a training.

    Attributes:
        seconds, steps: length; exactly one is given. With steps, a training on the CPU is reproducible to the byte.
        max_gaussians: maximum number of Gaussians.
        degree: SH degree, 0 to 3; "auto" trains degree 3 and drops bands by `gain`.
        gain: dB on the held-out photographs below which a band or the least visible tenth of the Gaussians is dropped;
            None: nothing is dropped.
        growth: "budgeted" (`densify.MCMCStrategy`) or "classic" (`densify.DefaultStrategy`).
        coarse: share of the training on photographs of half the size.
        seed: of all random numbers.
        device: that executes the steps; "auto" is the GPU if gsplat and a device are available.
    """

    seconds: float | None = None
    steps: int | None = None
    max_gaussians: int = 200_000
    degree: int | Literal["auto"] = "auto"
    gain: float | None = held_out_choice.MIN_GAIN
    growth: Literal["budgeted", "classic"] = "budgeted"
    coarse: float = 0.0
    seed: int = 0
    device: Literal["auto", "cpu", "cuda"] = "cpu"

    def __post_init__(self) -> None:
        if (self.seconds is None) == (self.steps is None):
            raise UserError("the length of a fit is given in seconds or in steps; give exactly one of the two")
        if not (self.seconds or self.steps or 0) > 0 or not math.isfinite(self.seconds or 0):
            raise UserError("the length of a fit must be finite and above 0; give --minutes or --steps above 0")
        if self.max_gaussians < 1 or self.degree not in ("auto", 0, 1, 2, 3) or not 0 <= self.coarse <= 1:
            raise UserError(
                f"a fit needs at least one Gaussian, an SH degree from 0 to 3 and a coarse share from 0 to 1, "
                f"got {self.max_gaussians}, {self.degree} and {self.coarse:g}"
            )
        if not (self.gain or 0) >= 0 or (self.gain is None and self.degree == "auto"):
            raise UserError(f"degree auto needs a gain of at least 0 dB, got {self.gain}; give a gain or a degree")


@dataclass(frozen=True)
class Status:
    """Progress of a training.

    Attributes:
        steps: completed steps.
        share: completed share of the training, in [0, 1].
        loss: running mean.
        psnr: dB on some held-out photographs at the last evaluation; NaN before the first.
        gaussians: current number.
        seconds_left: estimate.
    """

    steps: int
    share: float
    loss: float
    psnr: float
    gaussians: int
    seconds_left: float


@dataclass(frozen=True, eq=False)
class Fitted:
    """A trained scene with the capture's cameras, its quality on held-out photographs, and the length of training."""

    scene: Scene
    quality: Quality
    steps: int
    seconds: float
    curve: tuple[tuple[float, float], ...]  # seconds, and dB on the first `EVAL_PHOTOS` held-out photographs
    choices: tuple[Choice, ...]  # tried reductions, in order


@dataclass
class Record:
    """Results of a training so far, as in `Fitted`."""

    curve: list[tuple[float, float]] = field(default_factory=list)
    choices: list[Choice] = field(default_factory=list)


def fit(
    photos: Photos,
    settings: Settings | None = None,
    *,
    effort: Effort | Dial | None = None,
    checkpoint_path: Path | None = None,
    on_status: Callable[[Status], None] = lambda status: None,
) -> Fitted:
    """Train a scene.

    Args:
        settings: default: five minutes.
        effort: "fast", "balanced", "accurate", or seconds for the whole with its measurements: it replaces the length
            of `settings` by one chosen from measured points.
        checkpoint_path: file for checkpoints; training resumes from it if it exists. The caller deletes it after saving
            the scene (`checkpoint.delete`), so that a full disk at the end does not cost the training.
        on_status: called every `REPORT_EVERY` seconds.

    Raises:
        FileError: the checkpoint belongs to another training, or cannot be written.
        BackendError: the device is not available.
    """
    settings = settings or Settings(seconds=SECONDS)
    if effort is not None:
        dial = effort if isinstance(effort, Dial) else Dial(effort)
        settings = replace(settings, seconds=dial.choose("fit", megapixels(photos)).clock, steps=None)
    engine = engine_for(resolve_device(settings.device))
    rng = np.random.default_rng(settings.seed)
    initial = initial_cloud(photos, settings.max_gaussians, rng)
    degree = held_out_choice.MAX_DEGREE if settings.degree == "auto" else settings.degree
    schedule = Schedule(settings.steps, settings.seconds, settings.coarse, degree)
    strategy: Strategy = DefaultStrategy(photos.extent, rng, settings.max_gaussians)
    if settings.growth == "budgeted":
        strategy = MCMCStrategy(settings.max_gaussians, rng)
    trainer = Trainer(photos.shots, Parameters.of(initial), strategy, photos.extent, schedule, rng, engine)
    name = training_id(photos, settings)
    record = resume(trainer, checkpoint_path, name) if checkpoint_path is not None else Record()
    train(trainer, photos, settings, record, None if checkpoint_path is None else (checkpoint_path, name), on_status)
    cloud = trainer.parameters.cloud()
    cameras = tuple(sorted((s.camera for s in (*photos.shots, *photos.held_out)), key=lambda camera: camera.name))
    scene = Scene(cloud, cameras=cameras)
    quality = measure(cloud, photos.held_out)
    return Fitted(scene, quality, trainer.steps, trainer.seconds, tuple(record.curve), tuple(record.choices))


def megapixels(photos: Photos) -> float:
    """Millions of pixels of the held-out photographs: what measuring during a training takes grows with it."""
    return sum(shot.photo.shape[0] * shot.photo.shape[1] for shot in photos.held_out) / 1e6


def train(
    trainer: Trainer,
    photos: Photos,
    settings: Settings,
    record: Record,
    target: tuple[Path, str] | None,
    on_status: Callable[[Status], None],
) -> None:
    """Step until the end, with evaluations, reductions, checkpoints and progress reports.

    Args:
        photos: the held-out ones are evaluated, and decide reductions.
        target: path of the checkpoint and identifier of the training; None: no checkpoints.
    """
    reporter, saved = _Reporter(trainer, record, on_status), time.monotonic()
    while trainer.share < 1:
        loss = trainer.step()
        if trainer.share * EVALUATIONS >= len(record.curve) + 1:
            psnr = measure(trainer.parameters.cloud(), photos.held_out[:EVAL_PHOTOS]).psnr
            record.curve.append((trainer.seconds, psnr))
        if trainer.at_refinement:
            _reduce(trainer, photos, settings, record.choices)
        if target is not None and trainer.at_refinement and time.monotonic() - saved >= CHECKPOINT_EVERY:
            arrays, values = trainer.state()
            checkpoint.save(target[0], arrays, {**values, "name": target[1], **asdict(record)})
            saved = time.monotonic()
        reporter.after_step(loss)


def _reduce(trainer: Trainer, photos: Photos, settings: Settings, choices: list[Choice]) -> None:
    """Reduce once, after the last refinement; the rest of the training recovers the loss."""
    if trainer.progress >= REFINE_STOP and not choices:
        choices += reduced(trainer.parameters, photos, settings)


def reduced(parameters: Parameters, photos: Photos, settings: Settings) -> list[Choice]:
    """Drop SH bands and Gaussians, as the settings allow; returns what was tried."""
    if settings.gain is None:
        return []
    choices = held_out_choice.drop_sh_bands(parameters, photos, settings.gain) if settings.degree == "auto" else []
    return choices + held_out_choice.drop_gaussians(parameters, photos, settings.gain)


class _Reporter:
    """Reports the status of a training every `REPORT_EVERY` seconds."""

    def __init__(self, trainer: Trainer, record: Record, on_status: Callable[[Status], None]) -> None:
        self._trainer, self._record, self._on_status = trainer, record, on_status
        self._loss, self._reported = math.nan, time.monotonic()

    def after_step(self, loss: float) -> None:
        """To be called after every step with its loss."""
        trainer, curve, now = self._trainer, self._record.curve, time.monotonic()
        self._loss = loss if math.isnan(self._loss) else 0.95 * self._loss + 0.05 * loss
        if now - self._reported < REPORT_EVERY and trainer.share < 1:
            return
        left = trainer.seconds * (1 / max(trainer.share, 1e-9) - 1)
        psnr = curve[-1][1] if curve else math.nan
        self._on_status(Status(trainer.steps, trainer.share, self._loss, psnr, len(trainer.parameters), left))
        self._reported = now


def training_id(photos: Photos, settings: Settings) -> str:
    """Identifies the training that a checkpoint belongs to: digest of photographs and settings without length and
    device."""
    digest = hashlib.sha256(repr({**asdict(settings), "seconds": None, "steps": None, "device": None}).encode())
    for shot in photos.shots:
        digest.update(shot.photo.tobytes() + shot.camera.world_to_camera.tobytes())
    return digest.hexdigest()


def resume(trainer: Trainer, path: Path, name: str) -> Record:
    """Continue from a checkpoint if there is one; returns its record."""
    found = checkpoint.load(path)
    if found is None:
        return Record()
    arrays, values = found
    if values.get("name") != name:
        raise FileError(f"{path} is of another training (other photographs or settings); delete it to start over")
    try:
        trainer.restore(arrays, values)
        choices = [Choice(**{**c, "psnr": tuple(c["psnr"])}) for c in values["choices"]]
        return Record([(float(s), float(p)) for s, p in values["curve"]], choices)
    except (KeyError, ValueError, TypeError) as error:
        raise FileError(f"cannot resume from {path} ({error}); delete it to start over") from error
