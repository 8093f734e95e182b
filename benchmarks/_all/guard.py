"""Holds the accuracies that quick benchmarks measure against a committed baseline.

Times and memory are left out, and the data folder is hidden, so that the figures are the same wherever the repository
is cloned.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from ...gaussians.errors import FileError
from ..harness import Metric, Result
from . import running

BASELINE = Path(__file__).parent / "baseline.json"
GUARDED = ("compose", "fill", "files", "plan", "relight", "restyle")  # what takes seconds and needs no data
_OF_MACHINES = frozenset({"s", "ms", "ns", "x", "x a copy", "B"})  # units of times, of their ratios, and of memory
_DATA = {"SCENEWRIGHT_DATA": "/nowhere"}


def measured(say: Callable[[str], None], names: Sequence[str] = GUARDED) -> Result:
    """The accuracies of the quick forms, as figures "benchmark.key".

    Args:
        say: gets a sentence about each run.

    Raises:
        FileError: a benchmark fails.
    """
    found = running.side_by_side(names, say, _DATA)
    if found.failed:
        raise FileError("; ".join(f"bench {name} failed: {reason}" for name, reason in found.failed.items()))
    metrics = tuple(replace(m, key=f"{r.name}.{m.key}") for r in found.results for m in r.metrics if is_accuracy(m))
    return Result("accuracies of quick benchmarks without data", "", metrics, (), name="guard", quick=True)


def is_accuracy(metric: Metric) -> bool:
    """Whether a figure says how good something is, and does not depend on the machine."""
    return metric.direction != "neither" and metric.unit not in _OF_MACHINES


def worse(now: Result, baseline: Result) -> tuple[str, ...]:
    """Sentences on figures that are worse than in the baseline by more than their tolerance, or not measured now."""
    known = {metric.key for metric in now.metrics}
    gone = (f"{m.key}: was {m.value:.4g} {m.unit}, is not measured" for m in baseline.metrics if m.key not in known)
    return (*now.regressions(baseline), *gone)
