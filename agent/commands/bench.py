"""`scenewright bench NAME`: run a benchmark and compare it with an earlier result."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from ..options import Debug, Force, Json
from ..terminal.output import terminal


def command(
    name: Annotated[str | None, typer.Argument(metavar="NAME", help="Benchmark; without it, list them.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Much faster and less precise.")] = False,
    chart: Annotated[
        Path | None, typer.Option("--chart", metavar="FILE", help="Draw time against accuracy (.png, .svg, .pdf).")
    ] = None,
    against: Annotated[
        Path | None, typer.Option("--against", metavar="FILE", help="Earlier --json result; exit code 3 if worse.")
    ] = None,
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Run a benchmark and print its figures as a table (Markdown) or, with --json, as data.

    Times do not carry over to other machines; ratios and accuracies do.
    """
    from ...gaussians.errors import FileError, UserError

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
    refuse_existing([chart] if chart else [], force)
    try:
        earlier = harness.Result.from_json(against.read_text(encoding="utf-8")) if against else None
    except OSError as error:
        raise FileError(f"cannot read {against}: {error.strerror}") from error
    result = harness.run(name, quick)
    if chart is not None:
        terminal.say(f"chart: {_chart.draw(result, chart)}")
    terminal.result(result.to_markdown(), json.loads(result.to_json()))
    worse = result.regressions(earlier) if earlier is not None else ()
    for sentence in worse:
        terminal.say(f"worse: {sentence}")
    if worse:
        raise typer.Exit(3)
