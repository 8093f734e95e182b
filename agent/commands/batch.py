"""`scenewright batch JOBS.jsonl -o OUT`: many command lines, each done exactly once."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..options import Debug, Json
from ..terminal.output import terminal, time_left

if TYPE_CHECKING:
    from ..batch.engines import Engine
    from ..batch.running import Totals

_NAMED = 8  # failed jobs that are named


def command(
    jobs: Annotated[
        Path,
        typer.Argument(
            metavar="JOBS.jsonl",
            help='A job on each line: {"id": "a", "run": ["edit", "room.ply", "make it red", "-o", "{out}/a.ply"]}.',
        ),
    ],
    output: Annotated[
        str,
        typer.Option("--output", "-o", metavar="FOLDER|URL", help="Folder for results and receipts, or s3://..."),
    ],
    workers: Annotated[
        int | None,
        typer.Option("--workers", min=0, help="Processes; one for each core by default, 0: in this process."),
    ] = None,
    ray: Annotated[
        str | None,
        typer.Option("--ray", metavar="local|ADDRESS", help="Use Ray: one that is started here, or a cluster."),
    ] = None,
    needs: Annotated[
        list[str] | None,
        typer.Option(
            "--needs",
            metavar="VERB:NAME=N,...",
            help="What jobs of a verb need: fit:num_gpus=1,num_cpus=4,memory=16GB. A job's own resources win.",
        ),
    ] = None,
    again: Annotated[bool, typer.Option("--again", help="Also do once more what failed.")] = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Run many command lines: edits, questions, conversions, fits, embeddings.

    `{out}` in a job stands for a folder of its own, OUT/ID. A job that fails says so in its receipt, and the rest goes
    on; the same command goes on where it stopped. The same job on the same files is done once. The exit code is 3 if a
    job failed. Scenes may be named by URL (s3://, gs://, sftp://, file://), and so may the folder for results.
    """
    from ..batch.jobs import needing, read_jobs
    from ..batch.resources import parse_needs
    from ..batch.running import run_batch

    todo = needing(read_jobs(jobs), dict(map(parse_needs, needs or ())))
    engine = _engine(workers if workers is not None else os.cpu_count() or 1, ray)
    totals = run_batch(todo, output, engine, again=again, on_receipt=_shown)
    failed = [receipt for receipt in totals.receipts if receipt["code"]]
    terminal.result("\n".join(_told(totals, failed, output)), _data(totals, failed, output))
    if failed:
        raise typer.Exit(3)


def _engine(workers: int, ray: str | None) -> Engine:
    from ..batch.engines import Here, OnRay, Processes

    if ray is not None:
        return OnRay(ray, workers)
    return Processes(workers) if workers else Here()


def _shown(receipt: dict[str, Any], totals: Totals) -> None:
    ended, todo = totals.done + totals.failed, totals.jobs - totals.kept
    terminal.progress(f"{ended} of {todo} jobs, {totals.failed} failed, {time_left(totals.left)}", ended / max(todo, 1))
    if receipt["code"]:
        terminal.say(f"{receipt['id']} failed with {receipt['code']}: {_last_line(receipt)}")


def _last_line(receipt: dict[str, Any]) -> str:
    lines = str(receipt["messages"]).strip().splitlines()
    return lines[-1].removeprefix("scenewright: ") if lines else "it says nothing"


def _receipts(output: str) -> str:
    from ...gaussians.files.remote import cleaned, is_url

    return f"{cleaned(output.rstrip('/'))}/receipts.jsonl" if is_url(output) else str(Path(output) / "receipts.jsonl")


def _told(totals: Totals, failed: list[dict[str, Any]], output: str) -> list[str]:
    lines = [
        f"{totals.jobs} jobs: {totals.done} done in {totals.seconds:.1f} s, {totals.kept} were done before or are the "
        f"same as another, {len(failed)} failed; receipts: {_receipts(output)}"
    ]
    lines += [f"failed: {receipt['id']}: {_last_line(receipt)}" for receipt in failed[:_NAMED]]
    return [*lines, f"... and {len(failed) - _NAMED} more"] if len(failed) > _NAMED else lines


def _data(totals: Totals, failed: list[dict[str, Any]], output: str) -> dict[str, Any]:
    return {
        "jobs": totals.jobs, "done": totals.done, "kept": totals.kept, "failed": [r["id"] for r in failed],
        "seconds": round(totals.seconds, 2), "receipts": _receipts(output),
    }  # fmt: skip
