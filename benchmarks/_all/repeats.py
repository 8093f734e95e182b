"""Merges results of one benchmark: of repeats the median of each figure, of parts all that they have."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import replace

from ..harness import Metric, Point, Result


def merged(results: Sequence[Result]) -> Result:
    """One result of several of the same benchmark: medians with their spread, and the seconds of all together.

    Figures that are not in every repeat keep those that there are.

    Raises:
        ValueError: there is none, or they are of different benchmarks, forms or revisions.
    """
    kinds = {(r.name, r.quick, r.revision) for r in results}
    if len(kinds) != 1:
        raise ValueError(f"repeats of one benchmark are merged, not {sorted(map(str, kinds))}")
    first = results[0]
    metrics = tuple(_metric([m for r in results for m in r.metrics if m.key == key]) for key in _keys(results))
    points = tuple(_point([p for r in results for p in r.points[i : i + 1]]) for i in range(len(first.points)))
    return replace(
        first,
        metrics=metrics,
        points=points if all(_same(first, r) for r in results) else first.points,
        seconds=sum(r.seconds for r in results),
        processor=sum(r.processor for r in results),
        repeats=len(results),
    )


def joined(parts: Sequence[Result]) -> Result:
    """One result of several parts of a benchmark, in their order; a note that several have stands once.

    Raises:
        ValueError: there is none, or they are of different benchmarks, forms or revisions, or share a figure.
    """
    first = parts[0]
    if {(r.name, r.quick, r.revision) for r in parts} != {(first.name, first.quick, first.revision)}:
        raise ValueError(f"parts of one benchmark are joined, not of {sorted({r.name for r in parts})}")
    return replace(
        first,
        metrics=tuple(m for r in parts for m in r.metrics),
        points=tuple(p for r in parts for p in r.points),
        rows=tuple(row for r in parts for row in r.rows),
        notes=tuple(dict.fromkeys(n for r in parts for n in r.notes)),
        seeds=tuple(dict.fromkeys(s for r in parts for s in r.seeds)),
        seconds=sum(r.seconds for r in parts),
        processor=sum(r.processor for r in parts),
    )


def _keys(results: Sequence[Result]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(m.key for r in results for m in r.metrics))


def _metric(same: Sequence[Metric]) -> Metric:
    values = [m.value for m in same]
    return replace(same[0], value=statistics.median(values), low=min(values), high=max(values))


def _point(same: Sequence[Point]) -> Point:
    return replace(
        same[0],
        seconds=statistics.median(p.seconds for p in same),
        accuracy=statistics.median(p.accuracy for p in same),
        bytes=round(statistics.median(p.bytes for p in same)),
    )


def _same(first: Result, other: Result) -> bool:
    """Whether two results have the same points in the same order."""
    return [(p.method, p.setting) for p in first.points] == [(p.method, p.setting) for p in other.points]
