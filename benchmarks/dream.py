"""bench dream: score distillation with a denoiser that knows the answer, from a sphere and from a form.

The denoiser is the exact score of a Gaussian around renders of a target (`_dream.knowing`), so what is measured is the
optimisation: views, schedule, densification, regularisation and start. What a real model knows is not measured.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch

from ..gaussians.assets import make
from ..gaussians.assets.modeling import imported
from ..gaussians.cloud import GaussianCloud
from ..gaussians.dream.dreaming import Settings, Status, dream
from ..gaussians.dream.prior import start_for
from ..gaussians.dream.start import Start, form, sphere
from ..gaussians.dream.views import view
from ..gaussians.render import render
from ._data import folder, missing
from ._dream.knowing import Knowing
from .harness import Metric, Point, Result

SECONDS, QUICK_SECONDS = 12.0, 6.0
SIDE, QUICK_SIDE = 96, 64
GOALS = {"sphere": 24.0, "form": 27.0}  # dB, in ten minutes of two cores
OWN = ("armchair", "guitar", "bicycle", "desk lamp", "teddy bear")  # designs of seed 3; the form is that of seed 11
FOREIGN = {  # meshes by others, and what the prompt calls them
    "chairRounded": "a chair", "loungeSofaCorner": "a sofa", "kitchenBlender": "a blender", "plant": "a potted plant",
    "televisionModern": "a television",
}  # fmt: skip
SEEN_FROM = tuple((azimuth, elevation) for elevation in (5.0, 35.0) for azimuth in (15.0, 105.0, 195.0, 285.0))
CURVE = (0.125, 0.25, 0.5, 0.75, 1.0)  # shares of the time at which the likeness is measured
MOST = 60_000


@dataclass(frozen=True, eq=False)
class Target:
    """What is to be dreamt, around the origin; and a form to start from."""

    name: str
    cloud: GaussianCloud
    prior: Start


@dataclass
class _Curve:
    """Likeness during a dream."""

    target: GaussianCloud
    side: int
    found: list[tuple[float, float]] = field(default_factory=list)  # share, dB

    def __call__(self, status: Status) -> None:
        if len(self.found) < len(CURVE) and status.share >= CURVE[len(self.found)]:
            self.found.append((status.share, psnr(status.cloud(), self.target, self.side)))


def run(quick: bool) -> Result:
    """Ten targets, from a sphere and from a form of their kind."""
    seconds, side = (QUICK_SECONDS, QUICK_SIDE) if quick else (SECONDS, SIDE)
    targets = [*own(OWN[:2] if quick else OWN), *([] if quick else foreign())]
    curves: dict[str, list[list[tuple[float, float]]]] = {"sphere": [], "form": []}
    metrics = []
    for target in targets:
        for way in curves:
            start = sphere(np.random.default_rng(0)) if way == "sphere" else target.prior
            curve, started = _Curve(target.cloud, side), time.process_time()
            done = dream(Knowing(target.cloud, side), start, Settings(seconds=seconds, size=side), on_status=curve)
            metrics += [
                Metric(
                    f"{target.name}.{way}.psnr", psnr(done.cloud, target.cloud, side), "dB", "higher", 0.1, GOALS[way]
                ),
                Metric(f"{target.name}.{way}.gaussians", len(done.cloud), "count"),
                Metric(f"{target.name}.{way}.cpu", time.process_time() - started, "s"),
            ]
            curves[way].append(curve.found)
    for way, found in curves.items():
        last = [curve[-1][1] for curve in found]
        metrics.append(Metric(f"{way}.psnr", statistics.median(last), "dB", "higher", 0.05, GOALS[way]))
        metrics.append(Metric(f"{way}.worst", min(last), "dB", "higher", 0.1, GOALS[way]))
    gain = [f[-1][1] - s[-1][1] for s, f in zip(curves["sphere"], curves["form"], strict=True)]
    metrics.append(Metric("form.over_sphere", statistics.median(gain), "dB"))
    return Result(
        title="objects by score distillation, with a denoiser that knows the answer",
        accuracy="PSNR from eight views that were not drawn, median, dB",
        metrics=tuple(metrics),
        points=tuple(_points(curves, seconds)),
        notes=(
            f"pictures of {side} px, {seconds:.0f} s of one machine for each target; the goals are for ten minutes.",
            "form: the library's thing of the same kind, in another design, paler; at the start it is a guess.",
            *(() if quick or folder("meshes") else (missing("meshes"),)),
        ),
        seeds=(0,),
    )


def own(names: tuple[str, ...]) -> list[Target]:
    """Things of the library; the form is another design of the same kind."""
    return [
        _target(name, make(name, 3).cloud, form(make(name, 11).cloud, 8_000, np.random.default_rng(0)))
        for name in names
    ]


def foreign() -> list[Target]:
    """Meshes by others as Gaussians; the form is what the prompt's words give."""
    meshes = folder("meshes")
    if meshes is None:
        return []
    found = []
    for name, prompt in FOREIGN.items():
        path = Path(meshes) / f"{name}.glb"
        cloud = imported.read(path, imported.natural_size(path), "object").cloud
        found.append(_target(name, cloud, start_for("auto", prompt, 8_000, np.random.default_rng(0))[0]))
    return found


def _target(name: str, cloud: GaussianCloud, prior: Start) -> Target:
    """A cloud brought into the sphere of the views with its own colours."""
    placed = form(cloud, MOST, np.random.default_rng(0))
    means = (cloud.means - torch.tensor(placed.middle)) / placed.size
    return Target(name, cloud.replace(means=means.float(), scales=cloud.scales / placed.size), prior)


def psnr(cloud: GaussianCloud, target: GaussianCloud, side: int) -> float:
    """dB of the mean squared error over views from `SEEN_FROM`, before white."""
    off = []
    for azimuth, elevation in SEEN_FROM:
        asked = view(azimuth, elevation, side)
        a, b = (render(c, asked.camera, asked.background).rgb.clamp(0, 1) for c in (cloud, target))
        off.append(float((a - b).square().mean()))
    return -10 * math.log10(max(statistics.fmean(off), 1e-10))


def _points(curves: dict[str, list[list[tuple[float, float]]]], seconds: float) -> Iterator[Point]:
    """The median over targets at each share of the time."""
    for way, found in curves.items():
        for k, share in enumerate(CURVE):
            at = [curve[k][1] for curve in found if len(curve) > k]
            if at:
                last = share == CURVE[-1]
                yield Point(
                    way, f"{share * seconds:g} s", share * seconds, statistics.median(at), 0, last and way == "form"
                )
