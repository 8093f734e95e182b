"""`scenewright plan [SCENE] "TEXT"`: what an instruction is taken to mean, without doing it."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Annotated, Any

import typer

from ..options import Batch, Debug, Encoder, Json, Planner, View
from ..terminal import read_batch, terminal


def command(
    arguments: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[SCENE] TEXT", help="The instruction; with a scene before it, its targets are resolved."
        ),
    ] = None,
    batch: Batch = None,
    encoder: Encoder = "auto",
    planner: Planner = "auto",
    view: View = "auto",
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Tell what an instruction is taken to mean, as JSON. Nothing is changed.

    Without a scene the words alone are read. With one, every target is looked up and the plan is tried on a copy, so
    that the answer is what `edit` would do: {"verdict", "steps", "candidates", "reason", "planner", "seconds"}.
    """
    from ...gaussians.errors import UserError
    from ..opening import Opening, open_session

    given = arguments or []
    if len(given) > (1 if batch else 2) or (not given and batch is None):
        raise UserError('write: scenewright plan [SCENE] "TEXT", or: scenewright plan [SCENE] --batch FILE')
    path = Path(given[0]) if len(given) == 2 or (batch and given) else None
    rows = read_batch(str(batch)) if batch else [{"text": given[-1]}]
    session = None
    if path is not None:
        session, _ = open_session(Opening(path, planner, encoder, view))
    for row in rows:
        if session is not None:
            from ..resolved import resolved_plan

            answer = resolved_plan(session, row["text"], row.get("context"))
        else:
            answer = _words_alone(planner, row["text"])
        if batch is not None:
            terminal.row({"id": row["id"], **answer})
            continue
        terminal.result(json.dumps(answer, indent=2, ensure_ascii=False), answer)
        if answer["verdict"] != "ok":
            raise typer.Exit(3)


def _words_alone(planner: str, text: str) -> dict[str, Any]:
    """The plan of an instruction without a scene: targets are phrases."""
    from ...gaussians.errors import ScenewrightError
    from ...planners import load as load_planner
    from ..resolved import verdict_of

    started = time.perf_counter()
    answer: dict[str, Any] = {"verdict": "ok", "steps": [], "candidates": [], "reason": "", "planner": planner}
    try:
        plan = load_planner(planner).plan(text)
        answer["steps"] = [op.model_dump(mode="json", exclude_none=True) for op in plan.ops]
        answer["planner"] = plan.planner
    except ScenewrightError as error:
        answer["verdict"], answer["reason"] = verdict_of(error), str(error)
    return {**answer, "seconds": round(time.perf_counter() - started, 4)}
