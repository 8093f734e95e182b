"""Runs the trainings of a benchmark, each in a separate process, and keeps their results.

A finished training is a JSON file and a scene in the folder that `SCENEWRIGHT_BENCH_KEEP` names; an interrupted one
resumes from its checkpoint there. `SCENEWRIGHT_BENCH_ONLY` (names separated by commas) selects the trainings to run
now, so that a long benchmark can be split; those that are neither kept nor run are left out of the result.
"""

from __future__ import annotations

import json
import os
import statistics
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from multiprocessing import get_context, parent_process
from pathlib import Path

import numpy as np

from ..agent.terminal.output import terminal
from ..gaussians import files, harmonics
from ..gaussians.camera import Camera
from ..gaussians.cloud import GaussianCloud
from ..gaussians.errors import FileError, UserError
from ..gaussians.files import writing
from ..gaussians.files.captures.colmap import Points
from ..gaussians.fit import Photos, Settings, checkpoint, fit, load_photos
from ..gaussians.fit.checkpoint import delete
from ..gaussians.fit.fitting import EVAL_PHOTOS, EVALUATIONS
from ..gaussians.fit.held_out_choice import Choice
from ..gaussians.fit.quality import measure
from ..gaussians.fit.train import Shot
from ..gaussians.render import render
from ..gaussians.scene import Scene
from . import _machine, _plain
from ._data import folder, missing
from .files import glossy

CAPTURE, SCALE = "captures/bonsai_room", 0.5  # 400x266
KEEP, ONLY = "SCENEWRIGHT_BENCH_KEEP", "SCENEWRIGHT_BENCH_ONLY"
SMALL, SMALL_VIEWS, SMALL_SIZE = 1500, 16, (72, 48)  # the synthetic capture: Gaussians, photographs, pixels
SEED = 7000


Curve = tuple[tuple[float, float], ...]  # seconds of training, and dB


@dataclass(frozen=True)
class Run:
    """A training to run: `name` for options and files, `title` for people, `plain` to train with `_plain`."""

    name: str
    title: str
    settings: Settings
    plain: bool = False


@dataclass(frozen=True)
class Made:
    """The result of a training.

    Attributes:
        settings: as text; a kept training with other settings is run again.
        psnr, ssim: on all held-out photographs.
        curve: seconds of training, and dB on the watched held-out photographs; the last is the end.
        choices: bands and numbers of Gaussians that were tried.
        gaussians, degree, steps, seconds: of the training; its seconds do not count measuring and checkpoints.
        bytes: of the scene as an INRIA .ply.
        peak: bytes of memory, the most that its process held at once.
        revision: of the source.
    """

    settings: str
    psnr: float
    ssim: float
    curve: Curve
    choices: tuple[Choice, ...]
    gaussians: int
    degree: int
    steps: int
    seconds: float
    bytes: int
    peak: int
    revision: str | None


@contextmanager
def kept() -> Iterator[Path]:
    """The folder of finished trainings; a temporary one if none is named."""
    if named := os.environ.get(KEEP):
        Path(named).mkdir(parents=True, exist_ok=True)
        yield Path(named)
        return
    with tempfile.TemporaryDirectory() as place:
        yield Path(place)


Make = Callable[[Run, Path], None]  # train, and leave the outcome in a folder


def maker(quick: bool) -> Make | None:
    """The function that trains on the real capture, or on the small one if `quick`; None if the data are missing."""
    capture = folder(CAPTURE)
    if quick:
        return make_of(small_photos())
    return None if capture is None else make_apart(capture)


def photos(quick: bool) -> Photos:
    """What `maker` trains on, to measure with.

    Raises:
        FileError: the capture is not here.
    """
    capture = folder(CAPTURE)
    if quick:
        return small_photos()
    if capture is None:
        raise FileError(missing(CAPTURE))
    return load_photos(capture, SCALE)


def all_made(runs: Sequence[Run], place: Path, make: Make) -> dict[str, Made]:
    """Every training by its name, run by `make` unless it is kept.

    Raises:
        UserError: `SCENEWRIGHT_BENCH_ONLY` has an unknown name.
        FileError: a kept one cannot be read.
    """
    names = [run.name for run in runs]
    only = [name.strip() for name in os.environ.get(ONLY, "").split(",") if name.strip()] or names
    if unknown := sorted(set(only) - set(names)):
        raise UserError(f"{ONLY}: no training is called {', '.join(unknown)}; choose {', '.join(names)}")
    found = {}
    for run in runs:
        made = _read(place, run)
        if made is None and run.name in only:
            terminal.say(f"{run.name}: training")
            make(run, place)
            made = _read(place, run)
        if made is not None:
            terminal.say(f"{run.name}: {made.psnr:.2f} dB, {made.gaussians:,} Gaussians, {made.steps} steps")
            found[run.name] = made
    return found


def notes(runs: Sequence[Run], found: Mapping[str, Made], quick: bool) -> Iterator[str]:
    """Notes on trainings that were left out, different revisions of the source, and quick runs."""
    if absent := [run.name for run in runs if run.name not in found]:
        yield f"not made: {', '.join(absent)}"
    if len({made.revision for made in found.values()}) > 1:
        yield "revisions: " + ", ".join(f"{name} {made.revision}" for name, made in found.items())
    if quick:
        yield "quick: a few steps on a small synthetic capture; its decibels say nothing about real ones"


def scene_of(name: str, place: Path) -> Path:
    """The scene file of a training."""
    return place / f"{name}.ply"


def make_apart(capture: Path) -> Make:
    """Train in separate processes, so that the peak memory of each can be measured."""

    def make(run: Run, place: Path) -> None:
        with ProcessPoolExecutor(1, get_context("spawn"), initializer=_end_with_parent) as apart:
            apart.submit(_make_from, capture, run, place).result()

    return make


def _end_with_parent() -> None:
    """End this process with its parent: a training left over from a killed benchmark would distort the next figures."""

    def watch() -> None:
        parent = parent_process()
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _make_from(capture: Path, run: Run, place: Path) -> None:
    make_of(load_photos(capture, SCALE))(run, place)


def make_of(photos: Photos) -> Make:
    """Train in this process on given photographs."""
    fit(small_photos(), Settings(steps=1))  # compiles the kernels before any training is timed

    def make(run: Run, place: Path) -> None:
        cloud, curve, choices, steps, seconds = (_plainly if run.plain else _fitted)(photos, run, place)
        quality = measure(cloud, photos.held_out)
        watched = statistics.fmean(quality.each[shot.camera.name][0] for shot in photos.held_out[:EVAL_PHOTOS])
        curve = (*(look for look in curve if look[0] < seconds), (seconds, watched))
        path = scene_of(run.name, place)
        files.save(Scene(cloud), path, force=True)
        made = Made(
            repr(run.settings), quality.psnr, quality.ssim, curve, choices, len(cloud), cloud.degree, steps, seconds,
            path.stat().st_size, _peak(), _machine.revision(),
        )  # fmt: skip
        with writing(place / f"{run.name}.json", force=True) as file:
            file.write(json.dumps(asdict(made)).encode())
        checkpoint.delete(_checkpoint(run, place))
        delete(place / f"{run.name}.checkpoint")

    return make


Outcome = tuple[GaussianCloud, Curve, tuple[Choice, ...], int, float]  # the last two: steps and seconds


def _fitted(photos: Photos, run: Run, place: Path) -> Outcome:
    done = fit(photos, run.settings, checkpoint_path=_checkpoint(run, place))
    return done.scene.cloud, done.curve, done.choices, done.steps, done.seconds


def _checkpoint(run: Run, place: Path) -> Path:
    return place / f"{run.name}.checkpoint"


def _plainly(photos: Photos, run: Run, place: Path) -> Outcome:
    """Train with the plain recipe, without checkpoints."""
    trainer = _plain.trainer(photos, run.settings)
    curve: list[tuple[float, float]] = []
    while trainer.progress < 1:
        trainer.step()
        if trainer.progress * EVALUATIONS >= len(curve) + 1:
            curve.append((trainer.seconds, measure(trainer.parameters.cloud(), photos.held_out[:EVAL_PHOTOS]).psnr))
    return trainer.parameters.cloud(), tuple(curve), (), trainer.steps, trainer.seconds


def _read(place: Path, run: Run) -> Made | None:
    """A kept training; None if there is none with these settings.

    Raises:
        FileError: the file cannot be read as a training.
    """
    path = place / f"{run.name}.json"
    if not path.exists():
        return None
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
        curve = tuple((float(seconds), float(psnr)) for seconds, psnr in told["curve"])
        choices = tuple(Choice(**{**choice, "psnr": tuple(choice["psnr"])}) for choice in told["choices"])
        made = Made(**{**told, "curve": curve, "choices": choices})
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise FileError(f"{path} is not a kept training ({error}); delete it to train again") from error
    return made if made.settings == repr(run.settings) else None


def _peak() -> int:
    """Peak resident memory of this process, bytes."""
    import resource

    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most if sys.platform == "darwin" else most * 1024  # Linux counts in KiB


def small_photos(seed: int = SEED) -> Photos:
    """A capture of a synthetic scene: photographs all around shining spheres, every eighth held out."""
    cloud, (width, height) = glossy(SMALL, seed), SMALL_SIZE
    angles = np.linspace(0, 2 * np.pi, SMALL_VIEWS, endpoint=False)
    eyes = [(3.2 * np.cos(a), 3.2 * np.sin(a), np.sin(3 * a)) for a in angles]
    cameras = [Camera.look_at(e, (0, 0, 0), (0, 0, 1), width, height, name=f"{i:03d}") for i, e in enumerate(eyes)]
    shots = [Shot(camera, render(cloud, camera).to_uint8()) for camera in cameras]
    colors = harmonics.dc_to_color(cloud.sh[:, 0]).clamp(0, 1)
    points = Points(cloud.means.double().numpy(), colors.double().numpy())
    held = tuple(shots[::8])
    return Photos(tuple(s for i, s in enumerate(shots) if i % 8), held, points, 3.5)
