"""Runs every benchmark in a process of its own, and those that are timed again while time is left.

A process of its own keeps what one benchmark compiles, caches or allocates out of the figures of the next, and the
failure of one from the others.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

from ...gaussians.errors import FileError
from .. import _fits, _machine
from ..harness import Result
from .repeats import merged

# Seconds for all together, on two cores; drawing the page takes some of the three minutes and of the hour besides.
QUICK, WHOLE = 165.0, 3000.0
# Seconds after which one benchmark is stopped, so that a slow machine does not wait for it without end.
QUICK_LIMIT, LIMIT = 150.0, 1500.0
# Charted against bytes, timed in seconds of the processor, or without a chart of times: they share the cores.
TOGETHER = frozenset({"edit", "edits", "files", "layout", "mcp", "restyle", "slim", "stability", "structure"})
# What quick runs leave out: it takes minutes, or has no point on a chart of time against accuracy.
LONG = frozenset({"edits", "effort", "fit_sizes", "layout", "mcp", "stability", "structure", "view"})
MOST_REPEATS = 3
_STARTS = 5.0  # seconds that a process takes besides its measurement
_CHANGED = "the source changed while it was measured; leave it alone until all is measured"
# What long benchmarks measure here, so that all fit the time; each alone does more.
_PARTS = {"fit": {_fits.ONLY: "default-5,classic-5"}}


@dataclass(frozen=True)
class Measured:
    """What was measured.

    Attributes:
        results: of the benchmarks that succeeded, repeats merged.
        failed: the others, with the reason.
    """

    results: tuple[Result, ...]
    failed: Mapping[str, str] = field(default_factory=dict)


def measured(names: Sequence[str], quick: bool, say: Callable[[str], None], seconds: float | None = None) -> Measured:
    """Run benchmarks once, and the shortest of those that are timed again while time is left.

    Those of `TOGETHER` run first, as many at a time as there are cores; the others one after the other, with the
    machine to themselves. Quick runs leave out `LONG`.

    Args:
        say: gets a sentence about each run.
        seconds: for all of it; each benchmark runs once even if that takes longer.
    """
    until = time.perf_counter() + (seconds or (QUICK if quick else WHOLE))
    found: dict[str, list[Result]] = {}
    failed: dict[str, str] = {}
    revision = _machine.revision()
    names = [name for name in names if not (quick and name in LONG)]
    for name, outcome in _once(names, quick):
        if isinstance(outcome, Result) and outcome.revision == revision:
            found[name] = [outcome]
            say(f"{name}: {outcome.seconds:.0f} s")
        else:
            failed[name] = _CHANGED if isinstance(outcome, Result) else outcome
            say(f"{name} failed: {failed[name]}")
    for name in _again({n: results for n, results in found.items() if n not in TOGETHER}, until):
        outcome = _run(name, quick)
        if isinstance(outcome, Result) and outcome.revision == revision:
            found[name].append(outcome)
            say(f"{name} again: {outcome.seconds:.0f} s")
    return Measured(tuple(merged(found[name]) for name in names if name in found), failed)


def _once(names: Sequence[str], quick: bool) -> Iterator[tuple[str, Result | str]]:
    """Each benchmark with its result or failure, as they end: first those that may share the cores, then the others."""
    together = [name for name in names if name in TOGETHER]
    with ThreadPoolExecutor(_machine.cores()) as pool:
        yield from zip(together, pool.map(lambda name: _run(name, quick), together), strict=True)
    for name in names:
        if name not in TOGETHER:
            yield name, _run(name, quick)


def side_by_side(names: Sequence[str], say: Callable[[str], None], surroundings: Mapping[str, str]) -> Measured:
    """Run the quick forms once, as many at a time as there are cores: for accuracies, since their times are spoiled.

    Args:
        say: gets a sentence about each run.
        surroundings: variables of the environment that the benchmarks get besides.
    """
    say(f"measuring {', '.join(names)}")
    with ThreadPoolExecutor(_machine.cores()) as pool:
        outcomes = dict(zip(names, pool.map(lambda name: _run(name, True, surroundings), names), strict=True))
    results = tuple(o for o in outcomes.values() if isinstance(o, Result))
    return Measured(results, {name: o for name, o in outcomes.items() if isinstance(o, str)})


def _again(found: Mapping[str, Sequence[Result]], until: float) -> Iterator[str]:
    """Names to repeat, the shortest first, each for as long as it is likely to end in time."""
    for _ in range(MOST_REPEATS - 1):
        for name in sorted(found, key=lambda n: found[n][0].seconds):
            if time.perf_counter() + _STARTS + found[name][0].seconds < until:
                yield name


def _run(name: str, quick: bool, besides: Mapping[str, str] | None = None) -> Result | str:
    """The result of a benchmark in a process of its own, or why there is none."""
    command = [sys.executable, "-m", "scenewright", "bench", name, "--json", *(["--quick"] if quick else [])]
    surroundings = {**({} if quick else _PARTS.get(name, {})), **os.environ, **(besides or {})}
    limit = QUICK_LIMIT if quick else LIMIT
    try:
        ended = subprocess.run(command, capture_output=True, text=True, check=False, env=surroundings, timeout=limit)
    except subprocess.TimeoutExpired:
        return f"it was stopped after {limit:.0f} s; `scenewright bench {name}` runs it without a limit"
    if ended.returncode:
        lines = ended.stderr.strip().splitlines()
        return lines[-1].removeprefix("scenewright: ") if lines else f"it ended with code {ended.returncode}"
    try:
        return Result.from_json(ended.stdout)
    except FileError as error:
        return f"{error}"
