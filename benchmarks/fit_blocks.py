"""bench fit_blocks: a capture fitted by blocks against the same capture fitted as a whole, in equal steps and time.

In equal steps each Gaussian gets as many either way. As blocks take more time for them, the whole is fitted once more,
with as many more steps as take the processor as long as the blocks did; if they took no longer, that is the same fit.

Seams are measured where blocks meet: the residual of held-out photographs in pixels near a border of blocks, over that
in all pixels, against the same of the whole fit.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..gaussians.cloud import GaussianCloud
from ..gaussians.errors import FileError
from ..gaussians.fit import Fitted, Photos, Settings, fit
from ..gaussians.fit.blocks import Cell, cells, fit_by_blocks, points_seen
from ..gaussians.render import render
from . import _fits
from .harness import Metric, Point, Result

STEPS, BLOCKS, MAX_GAUSSIANS = 2_000, 4, 80_000
QUICK_STEPS, QUICK_BLOCKS, QUICK_GAUSSIANS = 150, 2, 1_500
GOAL = -0.3  # dB over the whole fit
NEAR = 0.02  # of the scene's span, from a border: what counts as near
NOISE = 0.01  # of a PSNR
TITLE = "a capture fitted by blocks and as a whole"
ACCURACY = "PSNR on all held-out photographs, dB"


@dataclass(frozen=True, eq=False)
class Made:
    """A fit, and the processor seconds that it took."""

    fitted: Fitted
    cpu: float


def run(quick: bool) -> Result:
    """Both ways on the bonsai room, or on a small made-up capture if `quick`."""
    try:
        photos = _fits.photos(quick)
    except FileError as error:
        return Result(TITLE, ACCURACY, (), (), (str(error),))
    if quick:
        settings = Settings(steps=QUICK_STEPS, max_gaussians=QUICK_GAUSSIANS, gain=None, degree=0)
    else:
        settings = Settings(steps=STEPS, max_gaussians=MAX_GAUSSIANS)
    blocks = QUICK_BLOCKS if quick else BLOCKS
    whole = _timed(lambda: fit(photos, settings))
    parts = _timed(lambda: fit_by_blocks(photos, settings, blocks))
    steps = round((settings.steps or STEPS) * max(1.0, parts.cpu / whole.cpu))
    longer = whole if steps == settings.steps else _timed(lambda: fit(photos, replace(settings, steps=steps)))
    psnr = parts.fitted.quality.psnr
    division = cells(parts.fitted.scene.cloud.means.numpy(), blocks)
    goal = None if quick else GOAL
    metrics = [
        Metric("over_whole", psnr - whole.fitted.quality.psnr, "dB", "higher", 0.2, goal),
        Metric("over_whole_in_equal_time", psnr - longer.fitted.quality.psnr, "dB", "higher", 0.2, goal),
        Metric("longer.steps", steps, "count"),
    ]
    for name, made in (("whole", whole), ("blocks", parts), ("longer", longer)):
        metrics += [
            Metric(f"{name}.psnr", made.fitted.quality.psnr, "dB", "higher", NOISE),
            Metric(f"{name}.ssim", made.fitted.quality.ssim, "share", "higher", NOISE),
            Metric(f"{name}.cpu", made.cpu, "s"),
            Metric(f"{name}.gaussians", len(made.fitted.scene.cloud), "count"),
            Metric(f"{name}.seams", _seams(made.fitted.scene.cloud, photos, division), "x", "lower", 0.1),
        ]
    return Result(
        title=TITLE,
        accuracy=ACCURACY,
        metrics=tuple(metrics),
        points=tuple(
            Point(name, setting, made.cpu, made.fitted.quality.psnr, _bytes(made.fitted.scene.cloud), made is whole)
            for name, setting, made in (
                ("whole", "one", whole),
                *((("whole", f"one, {steps} steps", longer),) if longer is not whole else ()),
                ("blocks", f"{blocks}", parts),
            )
        ),
        notes=("seams: squared residual near borders of blocks over that of all pixels, in both fits.",),
        seeds=(settings.seed,),
    )


def _timed(make: Callable[[], Fitted]) -> Made:
    started = time.process_time()
    fitted = make()
    return Made(fitted, time.process_time() - started)


def _bytes(cloud: GaussianCloud) -> int:
    return sum(column.numpy().nbytes for _, column in cloud.columns())


def _seams(cloud: GaussianCloud, photos: Photos, division: list[Cell]) -> float:
    """Mean squared residual of held-out photographs where they show a border of cells, over that of all pixels."""
    near, every = list[NDArray[np.float64]](), list[NDArray[np.float64]]()
    low, high = np.quantile(cloud.means.numpy(), [0.02, 0.98], axis=0)
    for shot in photos.held_out:
        seen = render(cloud, shot.camera)
        residual = ((seen.rgb.numpy() - shot.colors) ** 2).mean(axis=2, dtype=np.float64)
        points = points_seen(shot.camera, seen.depth.numpy())
        border = _near_a_border(points, division, NEAR * float((high - low).max()))
        near.append(residual[border])
        every.append(residual.ravel())
    return float(np.concatenate(near).mean() / np.concatenate(every).mean())


def _near_a_border(points: NDArray[np.float64], division: list[Cell], reach: float) -> NDArray[np.bool_]:
    """`[H, W]` of points `[H, W, 3]`: within `reach` of a side of a cell that holds them, at which space goes on."""
    found = np.zeros(points.shape[:2], bool)
    for cell in division:
        inside = ((points >= cell.low) & (points < cell.high)).all(axis=-1)
        away = np.minimum(np.abs(points - cell.low), np.abs(points - cell.high)).min(axis=-1)
        found |= inside & (away < reach)
    return found
