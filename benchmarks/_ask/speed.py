"""What an answer costs in a scene of a million Gaussians, once it is embedded."""

from __future__ import annotations

import time
from statistics import median

from ...gaussians.language.encoders import Encoder
from ...planners.questions import asking
from .._select.costs import ASKED, resized
from ..harness import Metric
from . import rooms
from .generate import questions
from .generated import furnished, shown_kinds
from .rooms import Known

GOAL = 50.0  # ms
REPEATS = 3


def measure(known: Known, encoder: Encoder, detail: float, quick: bool) -> list[Metric]:
    """Milliseconds of one question of every kind in the room resampled to a million Gaussians, and of the survey that
    the first question of a scene waits for. Of each question the best of some repetitions counts."""
    assert known.case is not None
    large = resized(known.case, ASKED)
    _, size = furnished(known.case.seed, detail)
    start = time.perf_counter()
    asked = rooms.surveyed(large, size, encoder)
    asking.answer("how many things are there?", asked.survey)
    first = 1e3 * (time.perf_counter() - start)
    times: dict[str, float] = {}
    for question in questions([asked.table], shown_kinds(encoder), 60):
        best = min(_timed(question.text, asked) for _ in range(1 if quick else REPEATS))
        times[question.kind] = max(best, times.get(question.kind, 0.0))
    every = sorted(times.values())
    return [
        Metric("ms.1m.median", median(every), "ms", "lower", 0.5, GOAL),
        Metric("ms.1m.slowest_kind", every[-1], "ms", "lower", 0.5, GOAL),
        Metric("ms.1m.survey", first, "ms", "lower", 0.5),
    ]


def _timed(text: str, known: Known) -> float:
    start = time.perf_counter()
    asking.answer(text, known.survey)
    return 1e3 * (time.perf_counter() - start)
