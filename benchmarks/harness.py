"""The benchmark harness: finds and runs benchmarks, and prints their results as JSON and Markdown.

A benchmark returns a `Result`; `run` adds the machine, the versions of packages and the revision of the source.
"""

from __future__ import annotations

import importlib
import json
import math
import pkgutil
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, Self

from ..gaussians.errors import BackendError, FileError, UserError
from . import _rows
from ._rows import Row

Direction = Literal["lower", "higher", "neither"]


@dataclass(frozen=True)
class Metric:
    """One measured figure.

    Attributes:
        key: dotted name, stable between versions, e.g. "guitar.512x512.cpu".
        value: the figure, finite.
        unit: "ms", "dB", "x", "count", ...
        direction: which way is better; "neither" for figures that describe and do not judge.
        tolerance: relative change in the bad direction that is noise, e.g. 0.1. Times do not carry over to other
            machines; ratios and accuracies do.
        goal: what it should reach in its direction, None if nobody set one.
        low, high: the least and the greatest of several repeats, of which `value` is the median; None: measured once.
    """

    key: str
    value: float
    unit: str
    direction: Direction = "neither"
    tolerance: float = 0.0
    goal: float | None = None
    low: float | None = None
    high: float | None = None

    def __post_init__(self) -> None:
        if not math.isfinite(self.value):
            raise ValueError(f"metric {self.key} is {self.value}; cap it where it is measured")
        if self.goal is not None and self.direction == "neither":
            raise ValueError(f"metric {self.key} has a goal and no direction")

    @property
    def met(self) -> bool | None:
        """Whether it reaches its goal; None if it has none."""
        if self.goal is None:
            return None
        return self.value <= self.goal if self.direction == "lower" else self.value >= self.goal

    def worse_than(self, earlier: Metric) -> bool:
        """Whether this is worse than `earlier` by more than the tolerance."""
        change = self.value - earlier.value if self.direction == "lower" else earlier.value - self.value
        return self.direction != "neither" and change > self.tolerance * abs(earlier.value)


@dataclass(frozen=True)
class Point:
    """One method with its setting on the chart of time (or bytes) against accuracy.

    Attributes:
        method: the family, drawn in one colour: "cpu", "reference", ...
        setting: what was chosen within it: "full", "half size", ...
        seconds: > 0, for one job.
        accuracy: finite, larger is better, in the result's `accuracy`.
        bytes: what the method holds in memory or on disk for the job.
        default: whether this is what users get unless they ask.
    """

    method: str
    setting: str
    seconds: float
    accuracy: float
    bytes: int
    default: bool = False

    def __post_init__(self) -> None:
        if not (0 < self.seconds < math.inf and math.isfinite(self.accuracy)):
            raise ValueError(f"point {self.method} {self.setting}: {self.seconds} s, accuracy {self.accuracy}")


@dataclass(frozen=True)
class Result:
    """The result of a benchmark, and the machine and versions it was measured with.

    Attributes:
        title: a sentence, what was measured.
        accuracy: what the points' accuracy is, with its unit.
        metrics, points: the figures.
        notes: what a reader must know to judge them, a sentence each.
        seeds: seeds of everything random.
        cost: what the points' accuracy is bought with on the chart: time, or bytes.
        name, quick, seconds, processor, machine, versions, revision: stamped by `run`; `processor` is in seconds of the
            process and of those that it started.
        repeats: how many times it was run; of several, figures are medians.
        rows: of a stability benchmark: what disturbances do to figures, and where they break.
    """

    title: str
    accuracy: str
    metrics: tuple[Metric, ...]
    points: tuple[Point, ...]
    notes: tuple[str, ...] = ()
    seeds: tuple[int, ...] = ()
    cost: Literal["seconds", "bytes"] = "seconds"
    name: str = ""
    quick: bool = False
    seconds: float = 0.0
    processor: float = 0.0
    machine: dict[str, Any] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)
    revision: str | None = None
    repeats: int = 1
    rows: tuple[Row, ...] = ()

    def __post_init__(self) -> None:
        keys = [metric.key for metric in self.metrics]
        if len(set(keys)) < len(keys):
            raise ValueError(f"metric keys must differ: {sorted(key for key in keys if keys.count(key) > 1)}")

    def to_json(self) -> str:
        """The whole result as JSON; `from_json` reads it back."""
        data = {**asdict(self), "rows": [row.figures() for row in self.rows]}
        return json.dumps(data, indent=2, allow_nan=False)

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Read what `to_json` wrote.

        Raises:
            FileError: the text is not such a result.
        """
        try:
            data = json.loads(text)
            data["metrics"] = tuple(Metric(**metric) for metric in data["metrics"])
            data["points"] = tuple(Point(**point) for point in data["points"])
            data["rows"] = tuple(Row.read(row) for row in data.get("rows", ()))
            return cls(**{**data, "notes": tuple(data["notes"]), "seeds": tuple(data["seeds"])})
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise FileError(f"not the JSON of a benchmark's result ({error}); write one with --json") from error

    def regressions(self, earlier: Result) -> tuple[str, ...]:
        """Sentences about metrics that got worse than in `earlier` by more than their tolerance."""
        before = {metric.key: metric for metric in earlier.metrics}
        return tuple(
            f"{metric.key}: {before[metric.key].value:.4g} -> {metric.value:.4g} {metric.unit}"
            for metric in self.metrics
            if metric.key in before and metric.worse_than(before[metric.key])
        )

    def front(self) -> tuple[Point, ...]:
        """The Pareto front, cheapest first: points that no other beats in both `cost` and accuracy."""
        best: list[Point] = []
        for point in sorted(self.points, key=lambda p: (self.cost_of(p), -p.accuracy)):
            if not best or point.accuracy > best[-1].accuracy:
                best.append(point)
        return tuple(best)

    def cost_of(self, point: Point) -> float:
        """What a point costs on the chart, in the unit of `cost`."""
        return point.seconds if self.cost == "seconds" else point.bytes

    def to_markdown(self) -> str:
        """The goals, the points, all figures and the surroundings, as a section of a page."""
        lines = [f"## {self.name or 'benchmark'}: {self.title}", ""]
        front = self.front()
        if goals := [m for m in self.metrics if m.goal is not None]:
            lines += ["| goal | wanted | measured | |", "| --- | ---: | ---: | --- |"]
            lines += [
                f"| {m.key} | {'at most' if m.direction == 'lower' else 'at least'} {m.goal:.4g} {m.unit} "
                f"| {m.value:.4g} {m.unit} | {'met' if m.met else 'missed'} |"
                for m in goals
            ]
            lines.append("")
        lines += _rows.table(self.rows)
        if self.points:
            lines += [
                f"| method | setting | time | {self.accuracy} | {'memory' if self.cost == 'seconds' else 'size'} | |",
                "| --- | --- | ---: | ---: | ---: | --- |",
            ]
            lines += [
                f"| {p.method} | {p.setting} | {duration(p.seconds)} | {p.accuracy:.4g} | {_size(p.bytes)} "
                f"| {', '.join(['default'] * p.default + ['on the front'] * (p in front))} |"
                for p in self.points
            ]
            lines.append("")
        if self.metrics:
            lines += ["| figure | value | better | noise |", "| --- | ---: | --- | ---: |"]
            lines += [
                f"| {m.key} | {_value(m)} {m.unit} | {'' if m.direction == 'neither' else m.direction} "
                f"| {f'{m.tolerance:.0%}' if m.direction != 'neither' else ''} |"
                for m in self.metrics
            ]
            lines.append("")
        lines += [f"- {note}" for note in self.notes] + self._surroundings()
        return "\n".join(lines) + "\n"

    def _surroundings(self) -> list[str]:
        """Where it was measured, as Markdown list items."""
        facts = [", ".join(f"{key} {value}" for key, value in part.items()) for part in (self.machine, self.versions)]
        facts += [f"seeds {', '.join(map(str, self.seeds))}"] if self.seeds else []
        facts += [f"revision {self.revision}"] if self.revision else []
        runs = f", {self.repeats} runs: medians, and the least to the greatest" if self.repeats > 1 else ""
        rough = ", quick: rougher than the full run" if self.quick else ""
        facts += [f"measured in {self.seconds:.0f} s, {self.processor:.0f} s of the processor{runs}{rough}"]
        return [f"- {fact}" for fact in facts if fact]


def names() -> tuple[str, ...]:
    """The benchmarks there are."""
    found = (module.name for module in pkgutil.iter_modules([str(Path(__file__).parent)]))
    return tuple(sorted(name for name in found if not name.startswith("_") and name != "harness"))


def run(name: str, quick: bool = False, parts: Sequence[str] = ()) -> Result:
    """Run a benchmark and add the machine, versions and revision to its result. `quick`: faster and less precise.

    Args:
        parts: some names of the module's `PARTS`, to run these alone; none: the whole benchmark.

    Raises:
        UserError: no benchmark has this name, or it has no such parts.
        BackendError: a package that it needs is not installed.
    """
    if name not in names():
        raise UserError(f"no benchmark is called {name!r}; choose {', '.join(names())}")
    from . import _machine

    try:
        module = importlib.import_module(f".{name}", __package__)
    except ImportError as error:
        raise BackendError(f"benchmark {name} cannot start ({error}); try: pip install 'scenewright[bench]'") from error
    known = tuple(getattr(module, "PARTS", ()))
    if unknown := [part for part in parts if part not in known]:
        choice = f"choose {', '.join(known)}" if known else "it runs as a whole"
        raise UserError(f"benchmark {name} has no part {', '.join(map(repr, unknown))}; {choice}")
    start, used = time.perf_counter(), _machine.processor()
    result: Result = module.run(quick, parts) if parts else module.run(quick)
    return replace(
        result,
        name=name,
        quick=quick,
        seconds=time.perf_counter() - start,
        processor=_machine.processor() - used,
        machine=_machine.describe(),
        versions=_machine.versions(),
        revision=_machine.revision(),
    )


def _value(metric: Metric) -> str:
    """A figure, with its spread where repeats differ."""
    if metric.low is None or metric.high is None or metric.low == metric.high:
        return f"{metric.value:.4g}"
    return f"{metric.value:.4g} ({metric.low:.4g} to {metric.high:.4g})"


def duration(seconds: float) -> str:
    """Seconds in words: milliseconds below one second."""
    return f"{seconds * 1e3:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"


def _size(count: int) -> str:
    return f"{count / 1e6:.3g} MB" if count >= 1e5 else f"{count} B"
