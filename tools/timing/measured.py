"""Post-conditions of an edit through time, measured on the scenes before and after it at sampled times."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.errors import CheckFailedError
from ...gaussians.motion.at import at
from ...gaussians.motion.motion import Motion
from ...gaussians.rows import mask_of_ids, rows_of_ids
from ...gaussians.scene import Scene
from ..execute import Done
from ..judging.changes import changes_between
from ..operation import Affine
from ..receipt import Check, at_least, at_most, report
from .spans import Span

I64 = NDArray[np.int64]

_BESIDE = 1e-3  # seconds before and after an edge
_MOST = 6  # times that are looked at
_EXACT = 4e-6  # of the largest coordinate: float32 centres after two maps


def measured_through_time(
    before: Scene,
    done: Done,
    own: Tensor,
    spans: Sequence[Span],
    moved: Sequence[tuple[I64, Affine]] = (),
    since: float | None = None,
) -> Done:
    """A result with checks at sampled times in its receipt.

    Args:
        own: ids of Gaussians that may differ from before at some time.
        spans: in which they look different, and outside of which they do not; none if they may differ at all times.
        moved: the bodies that a movement takes along, with their maps.
        since: seconds from which they do not move as before; None: the movement is added to how they move anyway.

    Raises:
        CheckFailedError: one of them fails.
    """
    motion = done.scene.motion
    if motion is None and before.motion is None:
        return done
    checks = [_outside(before, done.scene, own, spans)]
    if spans:
        checks += _in_and_out(before, done.scene, own, spans)
    if moved and motion is not None:
        checks.append(_arrived(before, done.scene, motion, moved, since))
    receipt = done.receipt.model_copy(update={"checks": (*done.receipt.checks, *checks)})
    if failed := [c for c in checks if not c.passed]:
        told = "; ".join(f"{c.name}: measured {c.value:.4g} {c.unit} ({c.sentence})" for c in failed)
        raise CheckFailedError(
            f"{receipt.op['op']} {receipt.selection.asked} failed through time and was taken back: {told}"
        )
    return done._replace(receipt=receipt)


def _range(*scenes: Scene) -> Span:
    motions = [s.motion for s in scenes if s.motion is not None]
    return min(m.start for m in motions), max(m.stop for m in motions)


def _times(scenes: Sequence[Scene], spans: Sequence[Span]) -> list[float]:
    low, high = _range(*scenes)
    wanted = [low, (low + high) / 2, high]
    for start, stop in spans:
        wanted += [t for t in (start - _BESIDE, stop + _BESIDE) if math.isfinite(t)]
    inside = sorted({t for t in wanted if low <= t <= high})
    return inside[:: max(1, math.ceil(len(inside) / _MOST))]


def _outside(before: Scene, after: Scene, own: Tensor, spans: Sequence[Span]) -> Check:
    worst, at_time = 0, 0.0
    for time in _times((before, after), spans):
        was, now = at(before, time).cloud, at(after, time).cloud
        changes = changes_between(was, now)
        count = int((changes.any & ~mask_of_ids(was.ids, own)).sum())
        if count > worst:
            worst, at_time = count, time
    said = f"{worst} Gaussians of other things differ from before at some time" + (
        f", at {at_time:.2f} s" * (worst > 0)
    )
    return at_most("outside unchanged through time", worst, 0, "Gaussians", said)


def _in_and_out(before: Scene, after: Scene, own: Tensor, spans: Sequence[Span]) -> list[Check]:
    """The target differs inside the spans and is bit for bit as before outside of them."""
    low, high = _range(before, after)
    edges = sorted({t for span in spans for t in span if low < t < high})
    bounds = [low, *edges, high]
    early = late = 0.0
    seen = 0
    for first, last in itertools.pairwise(bounds):
        time = (first + last) / 2
        was, now = at(before, time).cloud, at(after, time).cloud
        differs = float((changes_between(was, now).any & mask_of_ids(was.ids, own)).sum())
        if any(a <= time < b for a, b in spans):
            late, seen = max(late, differs), seen + 1
        else:
            early = max(early, differs)
    checks = [at_most("as before at other times", early, 0, "Gaussians", f"{early:g} Gaussians differ at other times")]
    said = f"{late:g} Gaussians differ while it holds, from {_told(spans[0][0])} to {_told(spans[-1][1])}"
    if not seen:
        return [*checks, report("changed in time", late, "Gaussians", "the scene ends before it begins")]
    return [*checks, at_least("changed in time", late, 1, "Gaussians", said)]


def _told(time: float) -> str:
    return f"{time:.2f} s" if math.isfinite(time) else ("the start" if time < 0 else "the end")


def _arrived(
    before: Scene, after: Scene, motion: Motion, moved: Sequence[tuple[I64, Affine]], since: float | None
) -> Check:
    """At the end of the movement every centre is where the map takes what would be there without it."""
    worst, extent, time = 0.0, 1.0, 0.0
    ends = {int(t.ids[0]): float(t.times[-1]) for t in motion.tracks if len(t.runs)}
    for ids, body in moved:
        time = ends[int(ids.min())]
        names = torch.from_numpy(np.sort(ids))
        was, now = at(before, time if since is None else since).cloud, at(after, time).cloud
        a, b = (c.means[rows_of_ids(c.ids, names)].double().cpu().numpy() for c in (was, now))
        if a.shape != b.shape:
            return at_most("arrived in time", math.inf, 0, "units", "not all of it is there when it arrives")
        worst = max(worst, float(np.abs(a @ body.matrix.T + body.offset - b).max(initial=0.0)))
        extent = max(extent, float(np.abs(b).max(initial=0.0)))
    said = f"at {time:.2f} s every centre is within {worst:.2g} units of where it was sent"
    return at_most("arrived in time", worst, _EXACT * extent, "units", said)
