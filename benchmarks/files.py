"""bench files: size, loss, reading and writing time of each file format on real and synthetic scenes.

The loss is the PSNR of the scene read back against the written scene, from views chosen for the scene.
"""

from __future__ import annotations

import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np
import torch

from ..gaussians import files, harmonics
from ..gaussians.camera import Camera
from ..gaussians.cloud import GaussianCloud
from ..gaussians.files.formats import spz
from ..gaussians.files.formats.morton import morton_sorted
from ..gaussians.reduce import prune, psnr
from ..gaussians.scene import Scene
from ..gaussians.viewpoints.coverage import candidates, choose_views
from ._data import folder, missing
from .harness import Metric, Point, Result

REAL = {"bonsai": "bonsai_room.ply", "guitar": "guitar.compressed.ply", "playbot": "playbot/2_0"}
GLOSSY, QUICK_GLOSSY = 60_000, 10_000  # Gaussians of the synthetic scene of degree 3
LARGE, QUICK_LARGE = 1_000_000, 100_000  # of the one whose reading is timed
VIEWS, VIEW_SIZE, PRUNE_SIZE = 4, 384, 160
CHART_TOP = 70.0  # dB, where the chart ends: an error of a twelfth of a step of eight bits
REPEATS = 3  # of a reading, of which the median counts; a writing is timed once
GOAL_READ = 1.0  # s, a million Gaussians of degree 3
SEED = 7000

Write = Callable[[Scene, BinaryIO], None]


@dataclass(frozen=True)
class Case:
    """A scene, and where it is looked at from."""

    name: str
    scene: Scene
    cameras: tuple[Camera, ...]


@dataclass(frozen=True)
class Outcome:
    """One scene in one format: bytes on disk, Gaussians, PSNR in dB, seconds."""

    bytes: int
    count: int
    psnr: float
    read: float
    write: float


def run(quick: bool) -> Result:
    """Every format on every scene; then the cheaper settings, of which the chart is made, summed over the scenes."""
    cases, notes = _cases(quick)
    metrics: list[Metric] = []
    points: list[Point] = []
    settings = {name: change for name, change in _settings().items() if not quick or name in ("full", "half")}
    with tempfile.TemporaryDirectory() as place:
        for name, (suffix, write) in _formats().items():
            for setting, change in settings.items():
                found = {c.name: _outcome(c, change(c), Path(place) / f"a{suffix}", write) for c in cases}
                points.append(_point(name, setting, list(found.values())))
                if setting == "full":
                    metrics += [m for case, outcome in found.items() for m in _metrics(f"{case}.{name}", outcome)]
        metrics += _million(Path(place), QUICK_LARGE if quick else LARGE)
    notes += [
        f"loss: mean over {VIEWS} views of {VIEW_SIZE}x{VIEW_SIZE} that see most of the scene; 120 dB is equality",
        f"points: bytes summed over {', '.join(case.name for case in cases)}, PSNR and reading time their means; a "
        f"PSNR of more than {CHART_TOP:.0f} dB of a scene counts as that",
        "guitar and playbot come from compressed files: the loss of their own format does not occur again",
        "half, quarter: of the Gaussians, by their contribution to other views than the measured ones",
    ]
    title = "bytes against loss of file formats"
    return Result(title, "PSNR to the scene, dB", tuple(metrics), tuple(points), tuple(notes), (SEED,), cost="bytes")


def _formats() -> dict[str, tuple[str, Write]]:
    """Suffix and writer of each format by name."""
    found = {suffix[1:]: (suffix, files.writer(Path(f"a{suffix}")))
             for suffix in (".ply", ".compressed.ply", ".splat", ".sog")}  # fmt: skip
    return found | {f"spz {v}": (".spz", lambda s, f, v=v: spz.write(morton_sorted(s), f, v)) for v in spz.WRITABLE}


def _settings() -> dict[str, Callable[[Case], Scene]]:
    """Ways to make a scene smaller before it is written; "full" is none."""

    def degree(most: int) -> Callable[[Case], Scene]:
        return lambda case: case.scene.replace(cloud=case.scene.cloud.with_degree(min(most, case.scene.cloud.degree)))

    def share(part: float) -> Callable[[Case], Scene]:
        return lambda case: _pruned(case, round(part * len(case.scene.cloud)))

    return {
        "quarter": share(0.25),
        "half": share(0.5),
        "SH 0": degree(0),
        "SH 1": degree(1),
        "full": lambda case: case.scene,
    }


def _pruned(case: Case, most: int) -> Scene:
    poses = {camera.world_to_camera.tobytes() for camera in case.cameras}
    views = candidates(case.scene.cloud, case.scene.frame, PRUNE_SIZE)
    return prune(case.scene, most, [v for v in views if v.world_to_camera.tobytes() not in poses])


def _cases(quick: bool) -> tuple[list[Case], list[str]]:
    """Real scenes where they are, the synthetic one always; and what to say where there are none."""
    scenes: dict[str, Scene] = {}
    place = folder("scenes")
    if place is not None:
        names = list(REAL)[1:2] if quick else list(REAL)
        scenes |= {name: files.load(place / REAL[name]) for name in names if (place / REAL[name]).exists()}
    scenes["glossy"] = Scene(glossy(QUICK_GLOSSY if quick else GLOSSY))
    cases = [Case(name, scene, tuple(_views(scene))) for name, scene in scenes.items()]
    return cases, [] if place is not None else [missing("scenes")]


def _views(scene: Scene) -> Iterator[Camera]:
    for camera in choose_views(scene, VIEWS).cameras:
        yield camera.resized(VIEW_SIZE, VIEW_SIZE)


def glossy(count: int, seed: int = SEED) -> GaussianCloud:
    """`count` Gaussians of degree 3 on 30 spheres that shine: their harmonics are lobes around mirrored light."""
    rng = np.random.default_rng(seed)
    sphere = np.sort(rng.integers(0, 30, count))
    center, radius = rng.uniform(-1, 1, (30, 3)), rng.uniform(0.1, 0.35, 30)
    normal = rng.normal(size=(count, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    light = np.array([0.3, -0.8, 0.5]) / np.linalg.norm([0.3, -0.8, 0.5])
    mirrored = 2 * (normal @ light)[:, None] * normal - light
    quats = np.stack([1 + normal[:, 2], -normal[:, 1], normal[:, 0], 0 * normal[:, 0]], axis=1)  # z to the normal
    lobe = harmonics.basis(torch.from_numpy(-mirrored), 3).numpy() * np.repeat([1.0, 0.8, 0.5, 0.25], [1, 3, 5, 7])
    strength = rng.uniform(0.1, 0.7, (30, 1))[sphere] * np.clip(normal @ light, 0, 1)[:, None]
    sh = (lobe * strength)[:, :, None] * rng.uniform(0.8, 1.0, (1, 1, 3)) + rng.normal(0, 0.01, (count, 16, 3))
    sh[:, 0] += rng.normal(0, 1, (30, 3))[sphere] + rng.normal(0, 0.1, (count, 3))
    spacing = radius[sphere] * np.sqrt(4 * np.pi * 30 / count)
    columns = (
        center[sphere] + normal * radius[sphere, None],
        quats / np.linalg.norm(quats, axis=1, keepdims=True),
        spacing[:, None] * np.exp(rng.normal(0, 0.4, (count, 3))) * [1, 1, 0.1],
        rng.beta(2, 1, count).clip(0.02, 0.99),
        sh,
    )
    return GaussianCloud.create(*(torch.from_numpy(column.astype(np.float32)) for column in columns))


def _outcome(case: Case, scene: Scene, path: Path, write: Write) -> Outcome:
    """Write a scene, read it back, and look at both from the case's cameras."""
    seconds = _timed_write(scene, path, write)
    back, read = _timed_read(path)
    loss = statistics.fmean(psnr(case.scene.cloud, back.cloud, case.cameras))
    return Outcome(path.stat().st_size, len(scene.cloud), loss, read, seconds)


def _timed_write(scene: Scene, path: Path, write: Write) -> float:
    start = time.perf_counter()
    with path.open("wb") as file:
        write(scene, file)
    return time.perf_counter() - start


def _timed_read(path: Path) -> tuple[Scene, float]:
    times = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        scene = files.load(path)
        times.append(time.perf_counter() - start)
    return scene, statistics.median(times)


def _metrics(key: str, found: Outcome) -> Iterator[Metric]:
    yield Metric(f"{key}.bytes", found.bytes, "B", "lower", 0.02)
    yield Metric(f"{key}.bytes_each", found.bytes / found.count, "B a Gaussian", "lower", 0.02)
    yield Metric(f"{key}.psnr", found.psnr, "dB", "higher", 0.02)
    yield Metric(f"{key}.read", found.read, "s", "lower", 0.5)
    yield Metric(f"{key}.write", found.write, "s", "lower", 0.5)


def _point(name: str, setting: str, found: list[Outcome]) -> Point:
    mean = statistics.fmean(min(outcome.psnr, CHART_TOP) for outcome in found)
    seconds = statistics.fmean(outcome.read for outcome in found)
    size = sum(outcome.bytes for outcome in found)
    return Point(name, setting, seconds, mean, size, default=(name, setting) == ("ply", "full"))


def _million(place: Path, count: int) -> Iterator[Metric]:
    """Seconds to read and write one large scene of degree 3."""
    scene = Scene(glossy(count))
    for name, (suffix, write) in _formats().items():
        wrote = _timed_write(scene, place / f"a{suffix}", write)
        read = _timed_read(place / f"a{suffix}")[1]
        goal = GOAL_READ if count == LARGE else None
        yield Metric(f"{count // 1000}k.{name}.read", read, "s", "lower", 0.5, goal)
        yield Metric(f"{count // 1000}k.{name}.write", wrote, "s", "lower", 0.5)
