"""bench motion: scenes with time. Films of nine rooms are fitted and compared with the truth (`fit`), in three of which
a thing changes its shape; what a frame at a time costs (`frame`); questions and instructions with time that somebody
wrote who knew the rooms but no code (`questions`, `instructions`); how much of labelled wishes is read where their
kinds and marks are known (`marks`).

Rooms, films and truth are ours (`_motion`), drawn with our renderer: what real cameras add (noise, exposure, shadows of
what moves) is not measured.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from statistics import fmean
from typing import NamedTuple, get_args

from ..gaussians.motion.fitting.fit import Detail
from ._motion import asking, frame, instructing, marks_read, rooms, soft
from ._motion.films import Rig, film
from ._motion.fitted import Figures, fitted, small, wanted
from .harness import Metric, Point, Result

PARTS = ("fit", "frame", "questions", "instructions", "marks")
SETS = ("", "held_")  # of written questions and instructions: what the readers were developed with, and others
STEPS, QUICK_STEPS = 5000, 500
WHOLE, INSIDE, PATH, OVERLAP = 28.0, 24.0, 0.02, 0.95  # goals with twelve cameras: dB, dB, metres, share
RIGS: dict[Rig, tuple[str, ...]] = {
    "12": (*rooms.names(), *soft.names()),
    "4": ("toy", "door"),
    "1": ("toy", "door"),  # one that moves
}  # rooms that are fitted from as many cameras
ABLATED = "towel"  # the room that is fitted as static, with rigid paths, and with residuals


class _Part(NamedTuple):
    """What a part gives to the result."""

    metrics: list[Metric]
    points: Sequence[Point] = ()
    notes: tuple[str, ...] = ()


def run(quick: bool = False, parts: Sequence[str] = PARTS) -> Result:
    """All parts, or some."""
    measures: dict[str, Callable[[bool], _Part]] = {
        "fit": _fit,
        "frame": lambda quick: _Part(frame.measured(quick)),
        "questions": lambda _: _Part([m for which in SETS for m in asking.metrics(f"{which}questions")]),
        "instructions": lambda _: _Part([m for which in SETS for m in instructing.metrics(f"{which}instructions")]),
        "marks": lambda quick: _Part(marks_read.metrics(quick)),
    }
    found = [measures[name](quick) for name in PARTS if name in parts]
    return Result(
        title="scenes with time: fits of films of nine rooms, and frames at a time",
        accuracy="PSNR of held-out frames, dB",
        metrics=tuple(m for part in found for m in part.metrics),
        points=tuple(p for part in found for p in part.points),
        notes=tuple(n for part in found for n in part.notes),
        seeds=(0,),
        cost="bytes",
    )


def _fit(quick: bool) -> _Part:
    """Rooms from twelve cameras, four and one that moves, and one room with less and with more motion."""
    if quick:
        return _Part(_metrics("toy", "12", fitted(small(), QUICK_STEPS), goals=False), (), ("fit: one small film",))
    metrics, points = list[Metric](), list[Point]()
    known: dict[Detail, Figures] = {}
    for rig, chosen in RIGS.items():
        every = {name: fitted(film(name, rig), STEPS) for name in chosen if wanted(name, rig)}
        if rig == "12" and ABLATED in every:
            known["residual"] = every[ABLATED]
        for name, figures in every.items():
            metrics += _metrics(name, rig, figures, goals=rig == "12")
        if len(every) > 1:
            metrics += _means(rig, list(every.values()))
    if wanted(ABLATED, "12"):
        made = film(ABLATED, "12")
        for detail in get_args(Detail):
            figures = known.get(detail) or fitted(made, STEPS, detail)
            points.append(Point(detail, "", figures.cpu, figures.whole, figures.bytes, detail == "residual"))
            metrics.append(Metric(f"ablation.{detail}.inside", figures.inside, "dB", "higher", 0.05))
    return _Part(
        metrics,
        points,
        (
            f"fit: {STEPS} steps each, pictures of 160 x 120; held-out frames are of two other cameras, half of them "
            "at times between two frames; `inside` is within the true masks of what moves",
            f"the chart is of the room {ABLATED!r} from twelve cameras",
        ),
    )


def _metrics(name: str, rig: Rig, f: Figures, goals: bool) -> list[Metric]:
    key = f"fit.{name}.{rig}"
    found = [
        Metric(f"{key}.whole", f.whole, "dB", "higher", 0.03, WHOLE if goals else None),
        Metric(f"{key}.inside", f.inside, "dB", "higher", 0.05, INSIDE if goals else None),
        Metric(f"{key}.pixels", f.overlap, "IoU", "higher", 0.05),
        Metric(f"{key}.assigned", f.assigned, "IoU", "higher", 0.05, OVERLAP if goals else None),
        Metric(f"{key}.kept", f.kept, "IoU", "higher", 0.05, OVERLAP if goals else None),
        Metric(f"{key}.residual", f.residual, "share"),
        Metric(f"{key}.keys", f.keys, "count"),
        Metric(f"{key}.cpu", f.cpu, "s", "lower", 0.3),
    ]
    if not math.isnan(f.found):
        found.append(Metric(f"{key}.found", f.found, "share", "higher", 0.0))
    if f.found > 0:
        found.append(Metric(f"{key}.path", f.path, "m", "lower", 0.3, PATH if goals else None))
        found.append(Metric(f"{key}.path worst", f.worst, "m", "lower", 0.5))
    return found


def _means(rig: Rig, every: Sequence[Figures]) -> list[Metric]:
    """Means over rooms; of paths, over those where something was found."""
    found = [f.path for f in every if f.found > 0]
    metrics = [
        Metric(f"fit.mean.{rig}.{name}", fmean(known), unit, "higher", 0.03)
        for name, unit in (
            ("whole", "dB"),
            ("inside", "dB"),
            ("found", "share"),
            ("overlap", "IoU"),
            ("assigned", "IoU"),
            ("kept", "IoU"),
        )
        if (known := [v for f in every if not math.isnan(v := getattr(f, name))])
    ]
    return [*metrics, Metric(f"fit.mean.{rig}.path", fmean(found), "m", "lower", 0.2)] if found else metrics
