"""One door to training: a capture and how long, to a scene and how good it is.

Knows the order: start, train, keep checkpoints, measure. Refuses to know the command line.
"""

from __future__ import annotations

import hashlib
import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np

from ..errors import FileError, UserError
from ..scene import Scene
from . import checkpoint, held_out_choice
from .densify import Budgeted, Classic, Growth
from .engine import device_of, engine_on
from .held_out_choice import Choice
from .initialize import start
from .parameters import Parameters
from .photographs.photos import Photos
from .quality import Quality, measure
from .train import SETTLED, Schedule, Trainer

WATCHED = 6  # held-out photographs that are looked at on the way
LOOKS = 20  # how often
KEEP_EVERY = 30.0  # seconds between checkpoints
TELL_EVERY = 0.5  # seconds between two words to the user


@dataclass(frozen=True)
class Settings:
    """How to train.

    Attributes:
        seconds, steps: what ends it, whichever is given; exactly one. With steps, the same bytes every time.
        most: Gaussians.
        degree: of the harmonics, 0 to 3; "auto" trains all and keeps those that held-out photographs gain by.
        gain: dB that a band, or the last tenth of the Gaussians, must be worth on them; None: nothing is left out.
        growth: "budgeted" or "classic", see `growth`.
        coarse: share of the training on photographs of half the size.
        seed: of everything drawn.
        device: where steps happen; "auto" is a GPU where gsplat and one are there. The same bytes every time come from
            the CPU only.
    """

    seconds: float | None = None
    steps: int | None = None
    most: int = 200_000
    degree: int | Literal["auto"] = "auto"
    gain: float | None = held_out_choice.GAIN
    growth: Literal["budgeted", "classic"] = "budgeted"
    coarse: float = 0.0
    seed: int = 0
    device: Literal["auto", "cpu", "cuda"] = "cpu"

    def __post_init__(self) -> None:
        if (self.seconds is None) == (self.steps is None):
            raise UserError("a fit ends after seconds or after steps; give one of the two")
        if not (self.seconds or self.steps or 0) > 0 or not math.isfinite(self.seconds or 0):
            raise UserError("a fit needs more than no time; give --minutes above 0")
        if self.most < 1 or self.degree not in ("auto", 0, 1, 2, 3) or not 0 <= self.coarse <= 1:
            raise UserError(
                f"a fit needs at least one Gaussian, a degree from 0 to 3 and a share, "
                f"got {self.most}, {self.degree} and {self.coarse:g}"
            )
        if not (self.gain or 0) >= 0 or (self.gain is None and self.degree == "auto"):
            raise UserError(f"bands are chosen by a gain of at least 0 dB, got {self.gain}; give it, or a degree")


@dataclass(frozen=True)
class Status:
    """How far training is: `share` in [0, 1], loss averaged over the last steps, `psnr` (dB) of some held-out
    photographs when last looked at (NaN before), Gaussians, and seconds left as far as can be told."""

    steps: int
    share: float
    loss: float
    psnr: float
    gaussians: int
    left: float


@dataclass(frozen=True, eq=False)
class Fitted:
    """The scene with the capture's cameras, its quality on the held-out photographs, and what it took."""

    scene: Scene
    quality: Quality
    steps: int
    seconds: float
    curve: tuple[tuple[float, float], ...]  # seconds, dB on the watched photographs
    choices: tuple[Choice, ...]  # what was tried, in order


@dataclass
class _Record:
    """What a training has shown so far."""

    curve: list[tuple[float, float]] = field(default_factory=list)
    choices: list[Choice] = field(default_factory=list)


def fit(
    photos: Photos,
    settings: Settings,
    *,
    kept: Path | None = None,
    told: Callable[[Status], None] = lambda status: None,
) -> Fitted:
    """Train a scene.

    Args:
        kept: where checkpoints go; training goes on from the one that is there. Whoever has saved the scene takes it
            away (`checkpoint.drop`), so that a disk which is full in the end costs no training.
        told: called every `TELL_EVERY` seconds.

    Raises:
        FileError: the checkpoint belongs to another training, or cannot be written.
        BackendError: the device is not there.
    """
    engine = engine_on(device_of(settings.device))
    rng = np.random.default_rng(settings.seed)
    cloud = start(photos, settings.most, rng)
    degree = held_out_choice.HIGHEST if settings.degree == "auto" else settings.degree
    schedule = Schedule(settings.steps, settings.seconds, settings.coarse, degree)
    trainer = Trainer(
        photos.shots, Parameters.of(cloud), _growth(settings, photos.extent, rng), photos.extent, schedule, rng, engine
    )
    name = _name(photos, settings)
    record = _resumed(trainer, kept, name) if kept is not None else _Record()
    _train(trainer, photos, settings, record, None if kept is None else (kept, name), told)
    made = trainer.parameters.cloud()
    cameras = tuple(sorted((s.camera for s in (*photos.shots, *photos.held)), key=lambda camera: camera.name))
    scene = Scene(made, cameras=cameras)
    quality = measure(made, photos.held)
    return Fitted(scene, quality, trainer.steps, trainer.seconds, tuple(record.curve), tuple(record.choices))


def _train(
    trainer: Trainer,
    photos: Photos,
    settings: Settings,
    record: _Record,
    kept: tuple[Path, str] | None,
    told: Callable[[Status], None],
) -> None:
    """Step until the end; look, choose, keep and tell on the way."""
    teller, saved = _Teller(trainer, record, told), time.monotonic()
    while trainer.done < 1:
        loss = trainer.step()
        if trainer.done * LOOKS >= len(record.curve) + 1:
            psnr = measure(trainer.parameters.cloud(), photos.held[:WATCHED]).psnr
            record.curve.append((trainer.seconds, psnr))
        if trainer.changed:
            _choose(trainer, photos, settings, record.choices)
        if kept is not None and trainer.changed and time.monotonic() - saved >= KEEP_EVERY:
            arrays, values = trainer.state()
            checkpoint.keep(kept[0], arrays, {**values, "name": kept[1], **asdict(record)})
            saved = time.monotonic()
        teller.stepped(loss)


def _choose(trainer: Trainer, photos: Photos, settings: Settings, choices: list[Choice]) -> None:
    """Leave out bands and Gaussians, once, when their number is settled; the rest of the training makes up for it."""
    if settings.gain is None or trainer.done < SETTLED or choices:
        return
    if settings.degree == "auto":
        choices += held_out_choice.fewer_bands(trainer, photos, settings.gain)
    choices += held_out_choice.fewer_gaussians(trainer, photos, settings.gain)


class _Teller:
    """Tells the user every now and then how far training is."""

    def __init__(self, trainer: Trainer, record: _Record, told: Callable[[Status], None]) -> None:
        self._trainer, self._record, self._told = trainer, record, told
        self._loss, self._spoken = math.nan, time.monotonic()

    def stepped(self, loss: float) -> None:
        """After every step, with its loss."""
        trainer, curve, now = self._trainer, self._record.curve, time.monotonic()
        self._loss = loss if math.isnan(self._loss) else 0.95 * self._loss + 0.05 * loss
        if now - self._spoken < TELL_EVERY and trainer.done < 1:
            return
        left = trainer.seconds * (1 / max(trainer.done, 1e-9) - 1)
        psnr = curve[-1][1] if curve else math.nan
        self._told(Status(trainer.steps, trainer.done, self._loss, psnr, len(trainer.parameters), left))
        self._spoken = now


def _growth(settings: Settings, extent: float, rng: np.random.Generator) -> Growth:
    return Budgeted(settings.most, rng) if settings.growth == "budgeted" else Classic(extent, rng, settings.most)


def _name(photos: Photos, settings: Settings) -> str:
    """What a checkpoint must be of to go on from: settings and photographs, whatever its time and device."""
    digest = hashlib.sha256(repr({**asdict(settings), "seconds": None, "steps": None, "device": None}).encode())
    for shot in photos.shots:
        digest.update(shot.photo.tobytes() + shot.camera.world_to_camera.tobytes())
    return digest.hexdigest()


def _resumed(trainer: Trainer, kept: Path, name: str) -> _Record:
    """Go on from a checkpoint if there is one; returns what it had shown."""
    found = checkpoint.resume(kept)
    if found is None:
        return _Record()
    arrays, values = found
    if values.get("name") != name:
        raise FileError(f"{kept} is of another training (other photographs or settings); delete it to begin anew")
    try:
        trainer.restore(arrays, values)
        choices = [Choice(**{**c, "psnr": tuple(c["psnr"])}) for c in values["choices"]]
        return _Record([(float(s), float(p)) for s, p in values["curve"]], choices)
    except (KeyError, ValueError, TypeError) as error:
        raise FileError(f"{kept} is no checkpoint to go on from ({error}); delete it to begin anew") from error
