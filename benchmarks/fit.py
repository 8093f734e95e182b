"""bench fit: quality of a scene against training time, for several settings and the plain recipe.

One real capture, every eighth photograph held out. It takes an hour; `_fits` tells how to split it and resume it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from ..gaussians.fit import Settings
from ..gaussians.fit.fitting import EVAL_PHOTOS
from . import _fits
from ._data import missing
from ._effort.named import words
from ._fits import Made, Run
from .harness import Metric, Point, Result

SHORT, LONG = 300.0, 900.0  # s
QUICK_STEPS, QUICK_PLAIN = 400, 20
SHOWN = (1, 2, 3, 4, 6, 8, 10, 13, 16)  # looks of twenty that the chart shows besides the end: even on a logarithm
GOALS = {"default-15": 28.0, "default-5": 26.5}  # dB on all held-out photographs
MEMORY = 3e9  # B
COMPARED = {("default-5", "plain-5"): 0.0, ("default-5", "classic-5"): None, ("default-15", "classic-15"): None}  # dB
NOISE = 0.02  # of a PSNR: half a decibel, as other seeds give
TITLE = "seconds of training against likeness to photographs that were held out"
ACCURACY = f"PSNR on {EVAL_PHOTOS} held-out photographs, dB"
NOTES = (
    "time: training only, without the evaluation on held-out photographs, checkpoints and loading of the capture",
    f"points: on the first {EVAL_PHOTOS} held-out photographs; figures: on all of them, at the end",
    "memory: peak of the training's process, with the photographs",
    "plain: the recipe as published (Kerbl et al. 2023), gradients by torch through the reference renderer; the same "
    "photographs, initialization, learning rates, optimizer and densification as classic, which uses the compiled path",
    "left_out: Gaussians dropped at four fifths of the training, since held-out photographs did not need them",
    "the learning rate of means decays over the whole training, so that 5 minutes are not the first third of 15",
)


def run(quick: bool) -> Result:
    """All settings; each point is a look at a training under way, the last of each is its end."""
    make = _fits.maker(quick)
    if make is None:
        return Result(TITLE, ACCURACY, (), (), (missing(_fits.CAPTURE),))
    runs = _runs(quick)
    with _fits.kept() as place:
        found = _fits.all_made(runs, place, make)
    titles = {one.name: one.title for one in runs}
    metrics = [m for name, made in found.items() for m in _metrics(name, made)]
    points = [p for name, made in found.items() for p in _points(name, titles[name], made)]
    notes = (*NOTES, *_fits.notes(runs, found, quick))
    return Result(TITLE, ACCURACY, (*metrics, *_gains(found)), tuple(points), notes, (0,))


def _runs(quick: bool) -> tuple[Run, ...]:
    """What is compared, the default first."""
    if quick:
        base = Settings(steps=QUICK_STEPS, max_gaussians=2 * _fits.SMALL)
        plain = Settings(steps=QUICK_PLAIN)
        return (
            Run("default-5", "default", base),
            Run("classic-5", "classic growth", replace(base, growth="classic")),
            Run("plain-5", "plain recipe", plain, plain=True),
        )
    short, long = Settings(seconds=SHORT), Settings(seconds=LONG)
    return (
        Run("default-15", "default, 15 min", long),
        Run("classic-15", "classic growth, 15 min", replace(long, growth="classic")),
        Run("default-5", f"default, 5 min{words('fit', clock=SHORT)}", short),
        Run("classic-5", "classic growth, 5 min", replace(short, growth="classic")),
        Run("coarse-5", "coarse to fine, 5 min", replace(short, coarse=0.4)),
        Run("60k-5", "60,000 Gaussians, 5 min", replace(short, max_gaussians=60_000)),
        Run("300k-5", "300,000 Gaussians, 5 min", replace(short, max_gaussians=300_000)),
        Run("plain-5", "plain recipe, 5 min", short, plain=True),
    )


def _metrics(name: str, made: Made) -> Iterator[Metric]:
    yield Metric(f"{name}.psnr", made.psnr, "dB", "higher", NOISE, GOALS.get(name))
    yield Metric(f"{name}.ssim", made.ssim, "1", "higher", NOISE)
    yield Metric(f"{name}.memory", made.peak, "B", "lower", 0.1, MEMORY if name in GOALS else None)
    yield Metric(f"{name}.bytes", made.bytes, "B")
    yield Metric(f"{name}.gaussians", made.gaussians, "count")
    yield Metric(f"{name}.sh_degree", made.degree, "1")
    yield Metric(f"{name}.steps", made.steps, "count")
    yield Metric(f"{name}.seconds", made.seconds, "s")
    if left_out := [c for c in made.choices if c.what == "gaussians"]:
        yield Metric(f"{name}.left_out", sum(c.before - c.after for c in left_out if c.taken), "count")


def _points(name: str, title: str, made: Made) -> Iterator[Point]:
    for look, (seconds, psnr) in enumerate(made.curve, start=1):
        end = look == len(made.curve)
        if end or look in SHOWN:
            setting = f"{name}: {psnr:.1f} dB" if end else ""
            yield Point(title, setting, seconds, psnr, made.peak, default=end and name == "default-5")


def _gains(found: Mapping[str, Made]) -> Iterator[Metric]:
    """What the default is better by at equal time."""
    for (mine, other), goal in COMPARED.items():
        if mine in found and other in found:
            gain = found[mine].psnr - found[other].psnr
            yield Metric(f"{mine}.over.{other}", gain, "dB", "higher", 1.0, goal)
