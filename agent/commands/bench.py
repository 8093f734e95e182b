"""`scenewright bench NAME`: run a benchmark and compare it with an earlier result."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..options import Debug, Force, Json
from ..terminal.output import terminal

if TYPE_CHECKING:
    from ...benchmarks.harness import Result


def command(
    name: Annotated[
        str | None,
        typer.Argument(metavar="NAME", help="Benchmark, 'all', 'guard' or 'calibrate'; without it, list them."),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Much faster and less precise.")] = False,
    part: Annotated[
        list[str] | None, typer.Option("--part", metavar="PART", help="Measure this part of the benchmark alone.")
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="'all' takes what it has already measured at this revision.")
    ] = False,
    chart: Annotated[
        Path | None, typer.Option("--chart", metavar="FILE", help="Draw time against accuracy (.png, .svg, .pdf).")
    ] = None,
    against: Annotated[
        Path | None,
        typer.Option(
            "--against", metavar="FILE", help="Earlier --json result, or folder of 'all'; exit code 3 if worse."
        ),
    ] = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FOLDER", help="Where 'all' writes its page and charts.")
    ] = Path("docs/benchmarks"),
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Run a benchmark and print its figures as a table (Markdown) or, with --json, as data.

    Times do not carry over to other machines; ratios and accuracies do. `bench all` runs every benchmark and writes
    one page with its charts: 3 minutes with --quick, else up to an hour; --resume goes on with a stopped run.
    `bench guard` holds quick accuracies against the committed baseline, exit code 3 if one is worse; with
    --force it takes them as the new baseline. `bench calibrate` measures in a few minutes how fast this machine is,
    for the predictions of --effort; it needs no checkout.
    """
    from ...gaussians.errors import UserError

    if name == "calibrate":  # works without a checkout
        _calibrate()
        return
    try:
        from ...benchmarks import _chart, harness
    except ModuleNotFoundError as error:
        if error.name != "scenewright.benchmarks":
            raise
        raise UserError(
            "benchmarks are not part of an installed package: clone the repository, run "
            '`pip install -e ".[bench]"` in it, and measure there'
        ) from error
    from ..output_files import refuse_existing

    if name in (None, "list"):
        terminal.result("\n".join(harness.names()), {"benchmarks": list(harness.names())})
        return
    if name == "all":
        _all(quick, output, against, force, resume)
        return
    if name == "guard":
        _guard(force)
        return
    refuse_existing([chart] if chart else [], force)
    earlier = _read(against) if against else None
    if earlier is not None:
        _refuse_other_form(earlier, quick)
    result = harness.run(name, quick, part or ())
    if chart is not None:
        terminal.say(f"chart: {_chart.draw(result, chart)}")
    terminal.result(result.to_markdown(), json.loads(result.to_json()))
    _tell(result.regressions(earlier) if earlier is not None else ())


def _all(quick: bool, folder: Path, against: Path | None, force: bool, resume: bool) -> None:
    """Run every benchmark and write the page of all."""
    import shutil
    import time

    from ...benchmarks import harness
    from ...benchmarks._all import page, running
    from ..output_files import make_folder, refuse_existing

    started = time.perf_counter()
    refuse_existing([folder / page.PAGE], force)
    make_folder(folder)
    earlier = [_read(path) for path in sorted(against.glob("*.json"))] if against else []
    for result in earlier:
        _refuse_other_form(result, running.in_quick_form(result.name, quick))
    kept = running.kept_folder(quick)
    if kept is not None and not resume:
        shutil.rmtree(kept, ignore_errors=True)
    if not quick:
        running.prepare(terminal.say)
    found = running.measured(harness.names(), quick, terminal.say, kept=kept)
    elapsed = time.perf_counter() - started
    made = page.write(folder, found.results, found.failed, None if resume else elapsed)
    told = {
        "page": str(made[-1]),
        "results": [json.loads(r.to_json()) for r in found.results],
        "failed": dict(found.failed),
    }
    terminal.result(f"{made[-1]}: {len(found.results)} benchmarks, {len(found.failed)} failed, {elapsed:.0f} s", told)
    before = {result.name: result for result in earlier}
    _tell([f"{r.name}: {s}" for r in found.results if r.name in before for s in r.regressions(before[r.name])])
    if found.failed:
        raise typer.Exit(1)


def _calibrate() -> None:
    """Measure how fast this machine is, and write the file that the dial reads."""
    from ...gaussians.effort import user_file
    from ..calibrating import calibrated

    found, seconds = calibrated(terminal.progress)
    path = user_file.write(found)
    lines = [f"{name}: {found.factors[name]:.2f} times the reference machine's {took / found.factors[name]:.2f} s"
             for name, took in seconds.items()]  # fmt: skip
    data = {"path": str(path), "factors": found.factors, "seconds": seconds, "machine": found.machine}
    terminal.result("\n".join([*lines, f"written to {path}; `--effort` uses it from now on"]), data)


def _guard(update: bool) -> None:
    """Compare quick accuracies with the committed baseline, or replace it."""
    from ...benchmarks._all import guard
    from ...gaussians.files import writing

    now = guard.measured(terminal.say)
    told = {"figures": {m.key: m.value for m in now.metrics}}
    if update:
        with writing(guard.BASELINE, force=True) as file:
            file.write(now.to_json().encode() + b"\n")
        terminal.result(f"{guard.BASELINE}: {len(now.metrics)} figures", told)
        return
    worse = guard.worse(now, _read(guard.BASELINE))
    terminal.result(f"{len(now.metrics)} accuracies, {len(worse)} worse than the baseline", {**told, "worse": worse})
    _tell(worse)


def _read(path: Path) -> Result:
    """An earlier result.

    Raises:
        FileError: it cannot be read, or is none.
    """
    from ...benchmarks import harness
    from ...gaussians.errors import FileError

    try:
        return harness.Result.from_json(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror}") from error


def _refuse_other_form(earlier: Result, quick: bool) -> None:
    """Quick and whole runs measure different sizes, so that their figures do not compare.

    Raises:
        UserError: the earlier result is of the other form.
    """
    from ...gaussians.errors import UserError

    if earlier.quick != quick:
        forms = ("quick", "whole") if earlier.quick else ("whole", "quick")
        how = "add --quick" if earlier.quick else "leave out --quick"
        raise UserError(
            f"the earlier result of {earlier.name or 'the benchmark'} is of a {forms[0]} run and cannot be compared "
            f"with a {forms[1]} one: {how}, or give a result of the same form"
        )


def _tell(worse: Sequence[str]) -> None:
    """Tell what is worse; exit code 3 if anything is."""
    for sentence in worse:
        terminal.say(f"worse: {sentence}")
    if worse:
        raise typer.Exit(3)
