"""One door to training: a capture and how long, to a scene and how good it is.

Knows the order: start, train, keep checkpoints, measure. Refuses to know the command line.
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

from ..errors import FileError, UserError
from ..scene import Scene
from . import checkpoint
from .growth import Budgeted, Classic, Growth
from .parameters import Parameters
from .photos import Photos
from .quality import Quality, measure
from .start import start
from .train import Schedule, Trainer

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
        degree: of the harmonics, 0 to 3.
        growth: "budgeted" or "classic", see `growth`.
        coarse: share of the training on photographs of half the size.
        seed: of everything drawn.
    """

    seconds: float | None = None
    steps: int | None = None
    most: int = 200_000
    degree: int = 0
    growth: Literal["budgeted", "classic"] = "budgeted"
    coarse: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        if (self.seconds is None) == (self.steps is None):
            raise UserError("a fit ends after seconds or after steps; give one of the two")
        if not (self.seconds or self.steps or 0) > 0 or not math.isfinite(self.seconds or 0):
            raise UserError("a fit needs more than no time; give --minutes above 0")
        if self.most < 1 or not 0 <= self.degree <= 3 or not 0 <= self.coarse <= 1:
            raise UserError(
                f"a fit needs at least one Gaussian, a degree from 0 to 3 and a share, "
                f"got {self.most}, {self.degree} and {self.coarse:g}"
            )


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
    """
    rng = np.random.default_rng(settings.seed)
    cloud = start(photos, settings.most, rng)
    schedule = Schedule(settings.steps, settings.seconds, settings.coarse, settings.degree)
    trainer = Trainer(
        photos.shots, Parameters.of(cloud), _growth(settings, photos.extent, rng), photos.extent, schedule, rng
    )
    name = _name(photos, settings)
    curve = _resumed(trainer, kept, name) if kept is not None else []
    _train(trainer, photos, curve, kept, name, told)
    made = trainer.parameters.cloud()
    cameras = tuple(sorted((s.camera for s in (*photos.shots, *photos.held)), key=lambda camera: camera.name))
    scene = Scene(made, cameras=cameras)
    quality = measure(made, photos.held)
    return Fitted(scene, quality, trainer.steps, trainer.seconds, tuple(curve))


def _train(
    trainer: Trainer,
    photos: Photos,
    curve: list[tuple[float, float]],
    kept: Path | None,
    name: str,
    told: Callable[[Status], None],
) -> None:
    loss, psnr = math.nan, curve[-1][1] if curve else math.nan
    spoken = saved = time.monotonic()
    while trainer.done < 1:
        found = trainer.step()
        loss = found if math.isnan(loss) else 0.95 * loss + 0.05 * found
        if trainer.done * LOOKS >= len(curve) + 1 and photos.held:
            psnr = measure(trainer.parameters.cloud(), photos.held[:WATCHED]).psnr
            curve.append((trainer.seconds, psnr))
        now = time.monotonic()
        if kept is not None and trainer.changed and now - saved >= KEEP_EVERY:
            arrays, values = trainer.state()
            checkpoint.keep(kept, arrays, {**values, "name": name, "curve": curve})
            saved = time.monotonic()
        if now - spoken >= TELL_EVERY or trainer.done >= 1:
            left = trainer.seconds * (1 / max(trainer.done, 1e-9) - 1)
            told(Status(trainer.steps, trainer.done, loss, psnr, len(trainer.parameters), left))
            spoken = now


def _growth(settings: Settings, extent: float, rng: np.random.Generator) -> Growth:
    return Budgeted(settings.most, rng) if settings.growth == "budgeted" else Classic(extent, rng, settings.most)


def _name(photos: Photos, settings: Settings) -> str:
    """What a checkpoint must be of to go on from: settings and photographs, whatever the time they were given."""
    digest = hashlib.sha256(repr({**asdict(settings), "seconds": None, "steps": None}).encode())
    for shot in photos.shots:
        digest.update(shot.photo.tobytes() + shot.camera.world_to_camera.tobytes())
    return digest.hexdigest()


def _resumed(trainer: Trainer, kept: Path, name: str) -> list[tuple[float, float]]:
    """Go on from a checkpoint if there is one; returns the curve so far."""
    found = checkpoint.resume(kept)
    if found is None:
        return []
    arrays, values = found
    if values.get("name") != name:
        raise FileError(f"{kept} is of another training (other photographs or settings); delete it to begin anew")
    try:
        trainer.restore(arrays, values)
        return [(float(s), float(p)) for s, p in values["curve"]]
    except (KeyError, ValueError, TypeError) as error:
        raise FileError(f"{kept} is no checkpoint to go on from ({error}); delete it to begin anew") from error
