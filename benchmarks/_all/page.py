"""Writes the page of all benchmarks: what was measured where, each chart with its table, and what failed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from .. import _chart, harness
from ..harness import Result, duration
from . import running

PAGE = "README.md"
_PARTS_BESIDE = ", ".join(sorted(set(running.SHARED_PARTS) - running.TOGETHER))
# What whole runs measure less of than they once did, or than a benchmark does by itself.
LESS = (
    f"{', '.join(sorted(running.TOGETHER))}, and parts of {_PARTS_BESIDE}, ran beside each other with one thread each: "
    "their times are of the processor, or describe a core beside a busy one; all other times were measured alone",
    f"{', '.join(sorted(running.BRIEF))}: their quick forms, on a few things or rooms; each by itself measures more, "
    "and its own page in docs/ holds those figures",
    *(f"{part} is left out: {reason}" for part, reason in running.LEFT_OUT.items()),
    *(f"{name} is left out: it is long, and its figures are in {page}" for name, page in running.ALONE.items()),
    "fit: the default for five minutes only; `scenewright bench fit` compares eight settings in an hour",
    "select: every second kind of composed room, relations in five rooms, faults of masks in one, disturbances and the "
    "chart in two",
    "ask: 240 questions in 8 furnished rooms and 200 in 12 graphs",
    "plan: every eighth sentence of other people, not every fourth",
    "slim: no 44 dB. render: the reference renderer is timed at 512x512 alone",
)
_ONCE = "accuracies are shares or likenesses, which do not depend on the machine; times do"


def write(
    folder: Path, results: Sequence[Result], failed: Mapping[str, str], elapsed: float | None = None
) -> tuple[Path, ...]:
    """Write `README.md`, and for each result its JSON and, where it has points, its chart; earlier ones are replaced,
    and those of benchmarks without a result removed.

    Args:
        folder: an existing folder.
        failed: names of benchmarks that failed, with the reason in a sentence.
        elapsed: seconds that the run of all took; None if it was done in several starts.

    Raises:
        BackendError: matplotlib is not installed.
        FileError: a file cannot be written.
    """
    from ...gaussians.files import writing

    made: list[Path] = []
    for result in results:
        made.append(folder / f"{result.name}.json")
        with writing(made[-1], force=True) as file:
            file.write(result.to_json().encode() + b"\n")
        if result.points or result.rows:
            made.append(_chart.draw(result, folder / f"{result.name}.svg"))
    for name in harness.names():
        for old in (folder / f"{name}.json", folder / f"{name}.svg"):
            if old not in made:
                old.unlink(missing_ok=True)
    made.append(folder / PAGE)
    with writing(made[-1], force=True) as file:
        file.write(text(results, failed, elapsed).encode())
    return tuple(made)


def text(results: Sequence[Result], failed: Mapping[str, str], elapsed: float | None = None) -> str:
    """The page in Markdown."""
    lines = ["# Benchmarks", "", *_head(results, failed, elapsed), "", *_goals(results), ""]
    for result in results:
        lines += [f"## {result.name}", "", f"{result.title}.", ""]
        if result.points or result.rows:
            lines += [f"![{result.title}]({result.name}.svg)", ""]
        body = result.to_markdown().split("\n", 2)[2].strip()
        lines += ["<details><summary>All figures</summary>", "", body, "", "</details>", ""]
    return "\n".join(lines).rstrip() + "\n"


def _head(results: Sequence[Result], failed: Mapping[str, str], elapsed: float | None) -> list[str]:
    """How and where all of it was measured."""
    if not results:
        return ["Nothing could be measured.", "", *_failures(failed)]
    first = results[0]
    facts = (first.machine, first.versions)
    told = "; ".join(", ".join(f"{key} {value}" for key, value in f.items() if key != "load") for f in facts)
    took = "in several starts" if elapsed is None else f"in {elapsed / 60:.0f} minutes"
    took += f" ({sum(r.processor for r in results) / 60:.0f} minutes of the processor)"
    left = sorted(set(harness.names()) - {r.name for r in results} - set(failed))
    quick = all(result.quick for result in results)  # whole runs measure some in quick forms
    form = "the quick forms, rougher than the full ones" if quick else "the full forms"
    form += f" (left out: {', '.join(left)})" if left else ""
    parts = [f"{name}: {', '.join(some)} only" for name, some in running.QUICK_PARTS.items()]
    less = ["", *(f"- {line}" for line in (parts if quick else LESS))]
    return [
        f"`scenewright bench all{' --quick' if quick else ''}` wrote this page: {len(results)} benchmarks, "
        f"{form}, on revision {first.revision or 'unknown'}, {took}. Every chart and figure here is of "
        f"this one revision; {_ONCE}.",
        "",
        f"{told}.",
        *less,
        *(["", *_failures(failed)] if failed else []),
    ]


def _failures(failed: Mapping[str, str]) -> list[str]:
    return [f"- **{name}** failed: {reason}" for name, reason in failed.items()]


def _goals(results: Sequence[Result]) -> list[str]:
    """How many goals each benchmark meets, and those that it misses."""
    lines = [
        "| benchmark | runs | time | of the processor | goals met | missed |",
        "| --- | ---: | ---: | ---: | ---: | --- |",
    ]
    for result in results:
        aimed = [m for m in result.metrics if m.goal is not None]
        missed = [f"{m.key} {m.value:.3g} of {m.goal:.3g} {m.unit}".rstrip() for m in aimed if not m.met]
        met = f"{len(aimed) - len(missed)} of {len(aimed)}" if aimed else ""
        lines.append(
            f"| [{result.name}](#{result.name}) | {result.repeats} | {duration(result.seconds)} "
            f"| {duration(result.processor)} | {met} "
            f"| {', '.join(missed)} |"
        )
    return lines
