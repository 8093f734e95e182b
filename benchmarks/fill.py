"""bench fill: what deletions reveal, filled, against the same rooms made without the thing.

Rooms are furnished from seeds, and only what photographs show of them is kept, so that things hide real holes. Each
deletion is compared from all sides in the pixels that the thing hid: deleting alone, filled, and each view filled by
itself as a picture.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..gaussians.cloud import GaussianCloud, concat
from ..tools.filling.fill import merged, patches_behind, unshaded
from ..tools.lifting.past import without_those_before
from ._fill.cast import cast_metrics
from ._fill.lifted import capture_metrics
from ._fill.measure import Scores, biharmonic, drawn, scored, telea, views_of
from ._fill.rooms import PLACES, Deletion, deletions
from .harness import Metric, Point, Result

DELETIONS, QUICK_DELETIONS = 40, 2
IN_ROOM, QUICK_IN_ROOM = 5, 2
SEED = 101
GOAL_OVER_BARE, GOAL_OVER_PICTURES, GOAL_OPEN, GOAL_SECONDS = 6.0, 3.0, 0.01, 3.0
_METHODS = ("deleted alone", "filled", "telea of each view", "biharmonic of each view")


@dataclass(frozen=True)
class _Measured:
    """One deletion: scores by method, in the order of `_METHODS`; what it took; what was made."""

    case: Deletion
    scores: tuple[Scores, ...]
    seconds: float
    made: int
    again: int


def run(quick: bool = False) -> Result:
    """Measure deletions in furnished rooms."""
    wanted = QUICK_DELETIONS if quick else DELETIONS
    found = list[_Measured]()
    seed = SEED
    while len(found) < wanted:
        for case in deletions(seed, QUICK_IN_ROOM if quick else IN_ROOM):
            if len(found) < wanted and (one := measured(case)) is not None:
                found.append(one)
        seed += 1
    result = _result(found, tuple(range(SEED, seed)))
    metrics, notes = capture_metrics(quick)
    return replace(result, metrics=(*result.metrics, *cast_metrics(quick), *metrics), notes=(*result.notes, *notes))


def measured(case: Deletion) -> _Measured | None:
    """The scores of one deletion; None if the thing hides hardly anything."""
    seen = views_of(case)
    if not seen:
        return None
    rest = case.before.replace(cloud=case.before.cloud[~case.gone])
    thing = case.before.cloud[case.gone]
    started = time.process_time()
    patches = without_those_before(case.before, rest, patches_behind(rest, thing))
    new = merged(rest, patches)
    seconds = time.process_time() - started
    cloud = _joined(unshaded(rest, patches), new)
    once = rest.replace(cloud=cloud)
    again = len(merged(once, without_those_before(case.before, once, patches_behind(once, thing))))
    pictures, alphas = drawn(cloud, seen)
    holes = [v.hidden & (v.bare_alpha < 0.5) for v in seen]
    scores = (
        scored(seen, [v.bare for v in seen], [v.bare_alpha for v in seen]),
        scored(seen, pictures, alphas),
        scored(seen, [telea(v.bare, h) for v, h in zip(seen, holes, strict=True)]),
        scored(seen, [biharmonic(v.bare, h) for v, h in zip(seen, holes, strict=True)]),
    )
    return _Measured(case, scores, seconds, len(new), again)


def _joined(cloud: GaussianCloud, new: GaussianCloud) -> GaussianCloud:
    return concat([cloud, new]) if len(new) else cloud


def _result(found: Sequence[_Measured], seeds: tuple[int, ...]) -> Result:
    holes = [m for m in found if m.scores[0].open > 0.02]
    shadows = [m for m in found if m.scores[0].open <= 0.02]
    metrics = [Metric("deletions", len(found), "count"), Metric("deletions.with_holes", len(holes), "count")]
    metrics += _group("all", found, goals=True)
    for place in PLACES:
        metrics += _group(place.replace(" ", "_"), [m for m in found if m.case.place == place])
    metrics += _group("holes", holes) + _group("shadows", shadows)
    if shadows:
        was, now = (float(np.mean([10 ** (-m.scores[k].psnr / 20) for m in shadows])) for k in (0, 1))
        metrics.append(Metric("shadows.residual", now / max(was, 1e-9), "x", "lower", 0.1, 0.25))
    slowest = max(m.seconds for m in found)
    metrics.append(Metric("seconds.slowest", slowest, "s", "lower", 0.5, GOAL_SECONDS))
    metrics.append(Metric("filled_again", sum(m.again for m in found), "Gaussians", "lower", 0.1, 0))
    seconds = max(float(np.mean([m.seconds for m in found])), 1e-3)
    points = tuple(
        Point(method, "", seconds, float(np.mean([m.scores[k].psnr for m in found])), 0, method == "filled")
        for k, method in enumerate(_METHODS)
    )
    notes = (
        "PSNR and SSIM count only the pixels that the thing hid, over six views from all sides.",
        "Telea and biharmonic are our own (OpenCV and scikit-image are not needed): each view is filled by itself, in "
        "the pixels where nothing is left, which needs no agreement of views.",
        "Seconds are of the processor, one thread.",
    )
    return Result("holes that deletions leave, filled", "PSNR in the hole, dB", tuple(metrics), points, notes, seeds)


def _group(name: str, found: Sequence[_Measured], goals: bool = False) -> list[Metric]:
    """Means over some deletions."""
    if not found:
        return []
    psnr = [float(np.mean([m.scores[k].psnr for m in found])) for k in range(len(_METHODS))]
    ssim = [float(np.mean([m.scores[k].ssim for m in found])) for k in (0, 1)]
    open_ = [float(np.mean([m.scores[k].open for m in found])) for k in (0, 1)]
    over_pictures = psnr[1] - max(psnr[2:])
    gain, open_goal = (GOAL_OVER_BARE, GOAL_OPEN) if goals else (None, None)
    return [
        Metric(f"{name}.psnr.bare", psnr[0], "dB"),
        Metric(f"{name}.psnr.filled", psnr[1], "dB", "higher", 0.02),
        Metric(f"{name}.psnr.over_bare", psnr[1] - psnr[0], "dB", "higher", 0.1, gain),
        Metric(f"{name}.psnr.over_pictures", over_pictures, "dB", "higher", 0.1, GOAL_OVER_PICTURES if goals else None),
        Metric(f"{name}.ssim.bare", ssim[0], "1"),
        Metric(f"{name}.ssim.filled", ssim[1], "1", "higher", 0.02),
        Metric(f"{name}.open.bare", open_[0], "1"),
        Metric(f"{name}.open.filled", open_[1], "1", "lower", 0.1, open_goal),
    ]
