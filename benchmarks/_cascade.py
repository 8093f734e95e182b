"""Grammar, cascade and language model on the written set: share of right plans, time, and how often a model is asked.

If no model is named, a scripted stand-in takes its place; table, chart and notes say so.
"""

from __future__ import annotations

import os
import statistics
from collections.abc import Sequence
from typing import get_args

from ..gaussians.errors import BackendError
from ..planners import load
from ..planners.cascade import Cascade
from ..planners.plan import EditPlan, Observation, Planner
from ..planners.wishes import WishPlanner
from . import _scripted, _written
from ._written import Judged
from .harness import Metric, Point

VARIABLE = "SCENEWRIGHT_BENCH_MODEL"
SEED = 7040
ERRORS = (0.02, 0.05, 0.1)  # error rates of the stand-in on the chart
DEFAULT_ERRORS = 0.05  # the rate that the cascade uses and that the figures are for
QUICK_STRIDE = 10  # a quick run asks a real model every tenth instruction


class _ModelAlone:
    """A planner that only asks a model; a failure counts as an abstention."""

    def __init__(self, model: Planner) -> None:
        self.name, self._model = model.name, model

    def plan(self, text: str, *, previous: str | None = None, observation: Observation | None = None) -> EditPlan:
        try:
            return self._model.plan(text, previous=previous, observation=observation)
        except BackendError as error:
            reason = str(error)[:2000]
            return EditPlan(instruction=text, planner=self.name, verdict="not_understood", reason=reason)


def measure(quick: bool) -> tuple[tuple[Metric, ...], tuple[Point, ...], tuple[str, ...]]:
    """Figures, points and notes. Seconds are means over instructions, as the few that ask a model take the most."""
    cases, grammar = _written.cases(), load("grammar")
    _written.measure(grammar, cases)  # warm-up: the comparison of words is cached and must not be timed
    spec = os.environ.get(VARIABLE, "").strip()
    todo = cases[::QUICK_STRIDE] if spec and quick else cases
    alone = _written.measure(grammar, todo)
    model = load(spec) if spec else _scripted.Scripted(DEFAULT_ERRORS, SEED)
    cascade = _written.measure(Cascade(grammar, WishPlanner, model), todo, accounted=not spec)
    asked = sum(j.asked for j in cascade) / len(cascade)
    found = [
        *_figures("grammar", alone),
        *_figures("cascade", cascade),
        Metric("cascade.asked", asked, "share", "lower"),
    ]
    points = [
        _point("grammar", "no model", alone, default=True),
        _point(f"cascade: grammar, then {model.name}", f"asks the model {asked:.1%} of the time", cascade),
    ]
    for errors in ERRORS if not spec else (DEFAULT_ERRORS,):
        one = model if spec or errors == DEFAULT_ERRORS else _scripted.Scripted(errors, SEED)
        every = _written.measure(_ModelAlone(one), todo, accounted=not spec)
        points.append(_point(model.name, "" if spec else f"{errors:.0%} errors", every))
        found += _figures("model" if spec else "stand_in", every) if errors == DEFAULT_ERRORS else []
    return tuple(found), tuple(points), (_note(spec, len(todo)),)


def _figures(who: str, judged: Sequence[Judged]) -> list[Metric]:
    """Outcomes, and milliseconds per instruction. Tolerance 0.5, as the time of a model varies from day to day."""
    times = sorted(1e3 * j.seconds for j in judged)
    found = [
        Metric(f"{who}.{name}", _written.share(judged, name), "share", "higher" if name == "right" else "lower")
        for name in get_args(_written.Outcome)
    ]
    found += [
        Metric(f"{who}.ms.{name}", value, "ms", "lower", 0.5)
        for name, value in (("mean", statistics.mean(times)), ("p50", statistics.median(times)), ("max", times[-1]))
    ]
    return found


def _point(method: str, setting: str, judged: Sequence[Judged], default: bool = False) -> Point:
    seconds = statistics.mean(j.seconds for j in judged)
    return Point(method, setting, seconds, _written.share(judged, "right"), 0, default)


def _note(spec: str, count: int) -> str:
    if spec:
        return f"grammar, cascade, model: {count} written instructions, both halves; the real model {spec} was asked."
    return (
        f"grammar, cascade, stand_in: {count} written instructions, both halves; times are means over the "
        f"instructions. No model was asked. The {_scripted.NAME}, knows the right answers and errs at the stated rate "
        f"(half of the errors: not understood; half: the wrong object; figures at {DEFAULT_ERRORS:.0%}). Its latency "
        f"is drawn from a log-normal distribution of median {_scripted.MEDIAN:g} s and sigma {_scripted.SPREAD:g}; it "
        "is added to the times without waiting. The chart shows how much time is saved by asking a model only where "
        "the grammar abstains, not how good a model is. The author of the grammar wrote the set; for instructions of "
        f"other people the model would be asked more often. {VARIABLE}=openai:… measures a real model."
    )
