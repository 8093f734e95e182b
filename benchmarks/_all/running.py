"""Runs every benchmark in processes of its own, and those that are timed again while time is left.

A process of its own keeps what one benchmark compiles, caches or allocates out of the figures of the next, and the
failure of one from the others. Long benchmarks are divided into jobs by their parts. Each finished job is kept
until the revision changes, so that a run that was stopped, or in which one job failed, goes on with the others.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field
from pathlib import Path

from ...gaussians.errors import FileError
from ...gaussians.files import writing
from ...gaussians.user_cache import user_cache
from .. import _fits, _machine
from ..harness import Result
from .repeats import joined, merged

# Seconds for all together, on two cores; drawing the page takes some of the three minutes and of the hour besides.
QUICK, WHOLE = 165.0, 3000.0
# Seconds after which one job is stopped, so that a slow machine does not wait for it without end.
QUICK_LIMIT, LIMIT = 150.0, 1500.0
# Charted against bytes, timed in seconds of the processor, or without a chart of times: they share the cores.
TOGETHER = frozenset(
    {
        "compose",
        "dream",
        "edit",
        "edits",
        "files",
        "fill",
        "fit_sizes",
        "layout",
        "mcp",
        "mesh",
        "plan",
        "restyle",
        "slim",
        "stability",
        "structure",
    }
)
# What no run of all measures: each takes long by itself, and its figures stand on a page of its own.
ALONE = {
    "batch": "docs/batch.md",
    "fit_blocks": "docs/fit.md",
    "motion": "docs/motion.md",
    "scale": "docs/scale.md",
    "view": "docs/view.md",
}
# What whole runs measure in their quick forms: a few things or rooms of what each measures by itself.
BRIEF = frozenset({"dream", "edits", "fill", "fit_sizes", "layout", "mesh", "restyle"})
# What quick runs leave out: it takes minutes, or has no point on a chart of time against accuracy.
LONG = frozenset(
    {
        "dream",
        "edits",
        "effort",
        "fill",
        "fit_sizes",
        "layout",
        "mcp",
        "mesh",
        "restyle",
        "stability",
        "start",
        "structure",
    }
)
# Parts that whole runs leave out, with the reason.
LEFT_OUT = {
    "edits graded": "its pictures are graded by eye; `scenewright bench edits` makes them",
    "ask sight": "`scenewright bench ask --part sight` measures it in minutes",
    "ask judge": "`scenewright bench ask --part judge` measures it in minutes",
}
# How benchmarks are divided: parts that share the cores (in whole runs a job each), and parts timed by the clock.
SHARED_PARTS: Mapping[str, tuple[tuple[str, ...], ...]] = {
    "select": (
        ("captures",), ("composed",), ("chart",), ("masks", "views"), ("floaters", "floor"),
        ("names", "thresholds", "finer"), ("attributes", "relations"), ("meshes", "vectors"),
    ),
    "ask": (("geometry",), ("written",), ("stability",), ("routing", "views", "vision")),
    "edits": (("colour", "checks"),),
}  # fmt: skip
# What quick runs measure of some benchmarks: the parts by which their settings are chosen.
QUICK_PARTS: Mapping[str, tuple[str, ...]] = {
    "ask": ("geometry", "written"),
    "plan": ("timed",),
    "select": ("chart", "names", "thresholds", "attributes", "relations"),
}
TIMED_PARTS: Mapping[str, tuple[str, ...]] = {"select": ("costs",), "ask": ("speed",), "edits": ()}
# The longest first, so that no core waits for a long job at the end.
LONGEST = (
    "slim",
    "stability",
    "select captures",
    "plan",
    "select composed",
    "select chart",
    "select masks views",
    "ask routing views vision",
    "files",
    "ask stability",
    "ask geometry",
    "edit",
)
QUICK_LONGEST = ("ask", "select", "slim", "plan", "edit")
MOST_REPEATS = 3
_STARTS = 5.0  # seconds that a process takes besides its measurement
_CHANGED = "the source changed while it was measured; leave it alone until all is measured"
# What long benchmarks measure here, so that all fit the time; each alone does more.
_LESS = {"fit": {_fits.ONLY: "default-5"}}
_ONE_THREAD = {key: "1" for key in ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS", "OPENBLAS_NUM_THREADS")}


@dataclass(frozen=True)
class Job:
    """One process: a benchmark, or some of its parts; `shares` the cores, with one thread, or has them to itself."""

    name: str
    parts: tuple[str, ...] = ()
    shares: bool = False

    @property
    def title(self) -> str:
        """Its name for people and files."""
        return " ".join((self.name, *self.parts))


@dataclass(frozen=True)
class Measured:
    """What was measured.

    Attributes:
        results: of the benchmarks of which something succeeded, parts joined and repeats merged.
        failed: jobs that failed, with the reason.
    """

    results: tuple[Result, ...]
    failed: Mapping[str, str] = field(default_factory=dict)


def jobs(names: Sequence[str], quick: bool) -> list[Job]:
    """What is run, in the order in which it starts: first jobs that are timed, then others, the longest first."""
    found = list[Job]()
    for name in names:
        shared = (QUICK_PARTS[name],) if quick and name in QUICK_PARTS else SHARED_PARTS.get(name, ((),))
        found += [Job(name, parts, name in TOGETHER or name in SHARED_PARTS) for parts in shared]
        if TIMED_PARTS.get(name):
            found.append(Job(name, TIMED_PARTS[name]))
    longest = QUICK_LONGEST if quick else LONGEST

    def place(job: Job) -> int:
        title = job.name if quick else job.title
        return longest.index(title) if title in longest else len(longest)

    return sorted(found, key=lambda job: (job.shares, place(job)))


def in_quick_form(name: str, quick: bool) -> bool:
    """Whether a run of all measures a benchmark in its quick form; `quick`: of all in theirs."""
    return quick or name in BRIEF


def prepare(say: Callable[[str], None]) -> None:
    """Fit the captures that several benchmarks look at, so that none of them waits for it, and no two do it twice."""
    started = time.perf_counter()
    done = subprocess.run([sys.executable, "-m", "scenewright.benchmarks._select.real.fitted"], check=False)
    said = "captures fitted, or kept from before" if done.returncode == 0 else "captures could not be fitted"
    say(f"{said}: {time.perf_counter() - started:.0f} s")


def measured(
    names: Sequence[str],
    quick: bool,
    say: Callable[[str], None],
    seconds: float | None = None,
    kept: Path | None = None,
) -> Measured:
    """Run benchmarks once, and the shortest of those that are timed again while time is left.

    Jobs that are timed run first, one after the other, with the machine to themselves; then those that share the cores,
    as many at a time as there are cores. `ALONE` is left out; quick runs leave out `LONG` too.

    Args:
        say: gets a sentence about each run.
        seconds: for all of it; each benchmark runs once even if that takes longer.
        kept: a folder of results of the jobs of this revision: read instead of measuring anew, and written.
    """
    until = time.perf_counter() + (seconds or (QUICK if quick else WHOLE))
    found: dict[Job, list[Result]] = {}
    failed: dict[str, str] = {}
    revision = _machine.revision()
    names = [name for name in names if name not in ALONE and not (quick and name in LONG)]
    for job, outcome in _once(jobs(names, quick), quick, kept):
        if isinstance(outcome, Result) and outcome.revision == revision:
            found[job] = [outcome]
            say(f"{job.title}: {outcome.seconds:.0f} s")
        else:
            failed[job.title] = _CHANGED if isinstance(outcome, Result) else outcome
            say(f"{job.title} failed: {failed[job.title]}")
    for job in _again({j: results for j, results in found.items() if not j.shares}, until):
        again = _run(job, quick)
        if isinstance(again, Result) and again.revision == revision:
            found[job].append(again)
            say(f"{job.title} again: {again.seconds:.0f} s")
    return Measured(tuple(_joined(name, found) for name in names if any(j.name == name for j in found)), failed)


def _joined(name: str, found: Mapping[Job, Sequence[Result]]) -> Result:
    """The result of a benchmark from those of its jobs: first the parts timed alone, as they are few."""
    own = sorted((job for job in found if job.name == name), key=lambda j: j.shares)
    parts = [merged(found[job]) for job in own]
    return joined(parts) if len(parts) > 1 else parts[0]


def _once(todo: Sequence[Job], quick: bool, kept: Path | None) -> Iterator[tuple[Job, Result | str]]:
    """Each job with its result or failure, as they end: first those that are timed, then those that share the cores."""
    for job in todo:
        if not job.shares:
            yield job, _kept_or_run(job, quick, kept)
    with ThreadPoolExecutor(_machine.cores()) as pool:
        under_way = {pool.submit(_kept_or_run, job, quick, kept): job for job in todo if job.shares}
        for done in as_completed(under_way):
            yield under_way[done], done.result()


def _kept_or_run(job: Job, quick: bool, kept: Path | None) -> Result | str:
    """The kept result of a job, or a new one, which is then kept."""
    path = None if kept is None else kept / f"{job.title.replace(' ', '-')}.json"
    revision = _machine.revision()
    if path is not None and path.is_file():
        known = Result.from_json(path.read_text(encoding="utf-8"))
        if known.revision == revision:
            return known
    outcome = _run(job, quick)
    if path is not None and isinstance(outcome, Result) and outcome.revision == revision:
        path.parent.mkdir(parents=True, exist_ok=True)
        with writing(path, force=True) as file:
            file.write(outcome.to_json().encode())
    return outcome


def kept_folder(quick: bool) -> Path | None:
    """Where results of this revision are kept, in the user's cache; None if the source has changes or no revision."""
    revision = _machine.revision()
    if revision is None or revision.endswith("-dirty"):
        return None
    return user_cache("bench", "all", f"{revision}{'-quick' if quick else ''}")


def side_by_side(names: Sequence[str], say: Callable[[str], None], surroundings: Mapping[str, str]) -> Measured:
    """Run the quick forms once, as many at a time as there are cores: for accuracies, since their times are spoiled.

    Args:
        say: gets a sentence about each run.
        surroundings: variables of the environment that the benchmarks get besides.
    """
    say(f"measuring {', '.join(names)}")
    with ThreadPoolExecutor(_machine.cores()) as pool:
        outcomes = dict(zip(names, pool.map(lambda name: _run(Job(name), True, surroundings), names), strict=True))
    results = tuple(o for o in outcomes.values() if isinstance(o, Result))
    return Measured(results, {name: o for name, o in outcomes.items() if isinstance(o, str)})


def _again(found: Mapping[Job, Sequence[Result]], until: float) -> Iterator[Job]:
    """Jobs to repeat, the shortest first, each for as long as it is likely to end in time."""
    for _ in range(MOST_REPEATS - 1):
        for job in sorted(found, key=lambda j: found[j][0].seconds):
            if time.perf_counter() + _STARTS + found[job][0].seconds < until:
                yield job


def _run(job: Job, quick: bool, besides: Mapping[str, str] | None = None) -> Result | str:
    """The result of a job in a process of its own, or why there is none."""
    form = ["--quick"] if in_quick_form(job.name, quick) else []
    command = [sys.executable, "-m", "scenewright", "bench", job.name, "--json", *form]
    command += [word for part in job.parts for word in ("--part", part)]
    less = {} if quick else _LESS.get(job.name, {})
    surroundings = {**less, **os.environ, **(_ONE_THREAD if job.shares and not quick else {}), **(besides or {})}
    limit = QUICK_LIMIT if quick else LIMIT
    try:
        ended = subprocess.run(command, capture_output=True, text=True, check=False, env=surroundings, timeout=limit)
    except subprocess.TimeoutExpired:
        return f"it was stopped after {limit:.0f} s; `scenewright bench {job.name}` runs it without a limit"
    if ended.returncode:
        lines = ended.stderr.strip().splitlines()
        return lines[-1].removeprefix("scenewright: ") if lines else f"it ended with code {ended.returncode}"
    try:
        return Result.from_json(ended.stdout)
    except FileError as error:
        return f"{error}"
