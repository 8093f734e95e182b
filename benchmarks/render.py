"""bench render: speed and accuracy of the fast CPU renderer and the reference renderer, scene by scene.

Accuracy is PSNR against the reference renderer run in float64. The blending stage is also compared with its lower bound
(`_floor`), and the backward pass is measured (`_gradient`). Besides the default, cheaper settings are measured: fewer
harmonics, fewer Gaussians, fewer pixels. Work that a scene needs once (cutting harmonics, dropping faint Gaussians) is
not timed; work for every picture is.
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch

from ..gaussians import compiled, files
from ..gaussians.camera import Camera, Vec3
from ..gaussians.cloud import GaussianCloud
from ..gaussians.render import cuda, reference, render
from . import _floor, _garden, _gradient
from .harness import Metric, Point, Result

DATA = Path(__file__).resolve().parents[1] / "../shared/data"  # unless SCENEWRIGHT_DATA says otherwise
SIZES, QUICK_SIZES = ((512, 512), (1920, 1080)), ((256, 256),)
REPEATS, QUICK_REPEATS = 5, 3
BEST_PSNR = 120.0  # dB, where equal pictures are capped: below float32's own rounding
FAINT = 0.1  # opacity from which one of the settings keeps Gaussians
SYNTHETIC = 300_000  # Gaussians of the cloud drawn where real scenes are absent; a tenth if quick
SEED = 0
BLACK = (0.0, 0.0, 0.0)

DEFAULT = ("cpu", "full")
GOALS = {
    "garden.1920x1080.raster_over_floor": 5.0,
    "playbot.512x512.raster_over_floor": 25.0,
    "guitar.512x512.gradient.speedup": 20.0,
    "garden.512x512.gradient.speedup": 20.0,
    "playbot.512x512.gradient.speedup": 10.0,
}

Way = tuple[str, str]  # method and setting
Draw = Callable[[], torch.Tensor]  # makes a picture, [H, W, 3]
Drawn = tuple[float, torch.Tensor]  # seconds, and the picture
Resized = Callable[[tuple[int, int]], Camera]  # a view, at a width and height


@dataclass(frozen=True)
class Case:
    """A scene and the camera whose image is one unit of work."""

    name: str
    cloud: GaussianCloud
    camera: Camera


@dataclass(frozen=True)
class View:
    """Where a scene is seen from, whatever the image's size: eye, target and up in its world, degrees of height."""

    scene: str
    eye: Vec3
    target: Vec3
    up: Vec3 = (0.0, -1.0, 0.0)
    fov: float = 45.0

    def camera(self, size: tuple[int, int]) -> Camera:
        return Camera.look_at(self.eye, self.target, self.up, *size, self.fov)


VIEWS = {
    "guitar": View("guitar.compressed.ply", (1.3, -1.2, 3.2), (0.0, -0.9, 0.1)),
    "playbot": View("playbot/0_0", (1.1, -0.9, 1.5), (0.0, -0.4, 0.0)),
    "bonsai": View("bonsai_room.ply", (-2.58, -1.28, 3.04), (-1.26, 0.06, 2.36), (0.22, -0.61, -0.76), 36.0),
}
SPHERES = View("", (2.4, -1.6, 2.4), (0.0, 0.0, 0.0))


def run(quick: bool) -> Result:
    """Measure every scene at every size; the points are means over the scenes at the first size."""
    sizes, repeats = (QUICK_SIZES, QUICK_REPEATS) if quick else (SIZES, REPEATS)
    scenes, notes = _scenes(quick)
    metrics: list[Metric] = []
    found: dict[Way, list[tuple[float, float, int]]] = {}
    for name, (cloud, seen) in scenes.items():
        for size in sizes:
            case = Case(name, cloud, seen(size))
            truth = reference.render(cloud, case.camera, BLACK, torch.float64).rgb
            slow = _slow(case) if size == sizes[0] else None
            metrics += _measure(case, truth, slow, repeats)
            if slow is not None:
                metrics += _gradient.measure(name, cloud, case.camera, repeats)
                for way, value in _dial(case, truth, slow, repeats).items():
                    found.setdefault(way, []).append(value)
    notes += [
        f"times: minimum of {repeats} runs; one run of the reference, at the first size",
        f"points: means over {', '.join(scenes)} at {sizes[0][0]}x{sizes[0][1]}, without work that is done once for a "
        "scene",
    ]
    points = tuple(_point(way, values) for way, values in found.items())
    title = "one picture with colour, alpha, depth and group"
    judged = tuple(replace(metric, goal=GOALS.get(metric.key)) for metric in metrics)
    return Result(title, "PSNR to float64, dB", judged, points, tuple(notes), (SEED,))


def _scenes(quick: bool) -> tuple[dict[str, tuple[GaussianCloud, Resized]], list[str]]:
    """Real scenes where they are, else synthetic spheres; and what to say about the choice."""
    folder = Path(os.environ.get("SCENEWRIGHT_DATA", DATA)) / "scenes"
    views = {name: view for name, view in VIEWS.items() if (folder / view.scene).exists()}
    if quick:
        views = dict(list(views.items())[:1])
    scenes: dict[str, tuple[GaussianCloud, Resized]] = {
        name: (files.load(folder / view.scene).cloud, view.camera) for name, view in views.items()
    }
    if not quick and (folder / _garden.FILE).exists():
        garden, camera = _garden.load(folder / _garden.FILE, SEED)
        return {**scenes, "garden": (garden, lambda size: camera.resized(*size))}, [_garden.NOTE]
    if scenes:
        return scenes, []
    note = (
        f"no real scenes in {folder.name}/ (set SCENEWRIGHT_DATA): synthetic spheres, which say little about real ones"
    )
    return {"spheres": (_spheres(SYNTHETIC // 10 if quick else SYNTHETIC), SPHERES.camera)}, [note]


def _spheres(count: int) -> GaussianCloud:
    """Flat Gaussians of degree 2 on the surfaces of 30 spheres, sized to cover them."""
    rng = np.random.default_rng(SEED)
    center, radius = rng.uniform(-1, 1, (30, 3)), rng.uniform(0.1, 0.4, 30)
    sphere = rng.integers(0, 30, count)
    normal = rng.normal(size=(count, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    spacing = radius[sphere] * np.sqrt(4 * np.pi * 30 / count)
    # The rotation that takes z to the normal: (1 + n_z, -n_y, n_x, 0), normalised.
    quats = np.stack([1 + normal[:, 2], -normal[:, 1], normal[:, 0], 0 * normal[:, 0]], axis=1)
    columns = (
        center[sphere] + normal * radius[sphere, None],
        quats / np.linalg.norm(quats, axis=1, keepdims=True),
        spacing[:, None] * np.exp(rng.normal(0, 0.4, (count, 3))) * [1, 1, 0.1],
        rng.beta(2, 1, count).clip(0.02, 0.99),
        rng.normal(0, 1, (30, 9, 3))[sphere] * np.array([1.0] + [0.2] * 8)[:, None] + rng.normal(0, 0.1, (count, 9, 3)),
    )
    return GaussianCloud.create(*(torch.tensor(column, dtype=torch.float32) for column in columns))


def psnr(picture: torch.Tensor, truth: torch.Tensor) -> float:
    """Decibels for a peak of 1, at most `BEST_PSNR`."""
    error = float((picture.double() - truth).square().mean())
    return BEST_PSNR if error == 0 else min(BEST_PSNR, -10 * math.log10(error))


def _slow(case: Case) -> Drawn:
    """One picture by the reference renderer, which takes seconds to minutes."""
    return _time(lambda: render(case.cloud, case.camera, backend="reference").rgb, 1)


def _measure(case: Case, truth: torch.Tensor, slow: Drawn | None, repeats: int) -> list[Metric]:
    """The fast renderer and its stages on one case, beside the reference renderer if it was timed."""
    key = f"{case.name}.{case.camera.width}x{case.camera.height}"
    fast, fast_rgb = _time(lambda: render(case.cloud, case.camera, backend="cpu").rgb, repeats)
    stages = _stages(case, repeats)
    return [
        Metric(f"{key}.cpu", fast * 1e3, "ms", "lower", 0.15),
        Metric(f"{key}.cpu.psnr", psnr(fast_rgb, truth), "dB", "higher", 0.05),
        *(_beside(key, fast, slow, truth) if slow is not None else ()),
        *(Metric(f"{key}.stage.{stage}", seconds * 1e3, "ms") for stage, seconds in stages.items()),
        *_floor.measure(case.cloud, case.camera, key, stages[_floor.STAGE]),
        *_on_a_gpu(case, truth, key, repeats),
    ]


def _beside(key: str, fast: float, slow: Drawn, truth: torch.Tensor) -> list[Metric]:
    """The reference renderer's time and accuracy, and how many times as fast the fast one is."""
    seconds, rgb = slow
    return [
        Metric(f"{key}.reference", seconds * 1e3, "ms", "lower", 0.3),
        Metric(f"{key}.speedup", seconds / fast, "x", "higher", 0.3),
        Metric(f"{key}.reference.psnr", psnr(rgb, truth), "dB", "higher", 0.05),
    ]


def _on_a_gpu(case: Case, truth: torch.Tensor, key: str, repeats: int) -> list[Metric]:
    """The same picture through gsplat, brought back to the host, where there is a device."""
    if cuda.missing():
        return []
    seconds, rgb = _time(lambda: render(case.cloud, case.camera, backend="cuda").rgb, repeats)
    return [
        Metric(f"{key}.cuda", seconds * 1e3, "ms", "lower", 0.15),
        Metric(f"{key}.cuda.psnr", psnr(rgb, truth), "dB", "higher", 0.05),
    ]


def _dial(case: Case, truth: torch.Tensor, slow: Drawn, repeats: int) -> dict[Way, tuple[float, float, int]]:
    """Seconds, accuracy and bytes of each way to draw a case; `slow`: as the reference renderer drew it."""
    cloud, camera = case.cloud, case.camera
    plain, solid = cloud.with_degree(0), cloud[cloud.opacities >= FAINT]
    half = camera.resized(max(1, camera.width // 2), max(1, camera.height // 2))
    ways: dict[Way, tuple[Draw, GaussianCloud]] = {
        DEFAULT: (lambda: render(cloud, camera).rgb, cloud),
        ("cpu", "no harmonics"): (lambda: render(plain, camera).rgb, plain),
        ("cpu", f"opacity from {FAINT:g}"): (lambda: render(solid, camera).rgb, solid),
        ("cpu", "half size"): (lambda: _enlarged(render(cloud, half).rgb, camera), cloud),
    }
    drawn = {way: (_time(draw, repeats), held) for way, (draw, held) in ways.items()}
    drawn["reference", "full"] = slow, cloud
    return {way: (seconds, psnr(rgb, truth), held.nbytes) for way, ((seconds, rgb), held) in drawn.items()}


def _enlarged(rgb: torch.Tensor, camera: Camera) -> torch.Tensor:
    """A picture brought to the camera's size, bilinearly."""
    channels, size = rgb.permute(2, 0, 1)[None], (camera.height, camera.width)
    return torch.nn.functional.interpolate(channels, size, mode="bilinear", align_corners=False)[0].permute(1, 2, 0)


def _point(way: Way, values: list[tuple[float, float, int]]) -> Point:
    """The mean of a way over the scenes."""
    seconds, accuracy, size = (sum(column) / len(values) for column in zip(*values, strict=True))
    return Point(*way, seconds, accuracy, int(size), default=way == DEFAULT)


def _time(draw: Draw, repeats: int) -> Drawn:
    """Least seconds of `repeats` calls, and a picture; several are warmed up by one that is not counted."""
    picture = draw() if repeats > 1 else None
    least = math.inf
    for _ in range(repeats):
        start = time.perf_counter()
        picture = draw()
        least = min(least, time.perf_counter() - start)
    assert picture is not None
    return least, picture


def _stages(case: Case, repeats: int) -> dict[str, float]:
    """Seconds of each stage of the fast renderer: the least of several runs."""
    least: dict[str, float] = {}
    for _ in range(repeats):
        with compiled.stage_times() as times:
            render(case.cloud, case.camera, backend="cpu")
        least = {stage: min(seconds, least.get(stage, seconds)) for stage, seconds in times.items()}
    return least
