"""`scenewright plan [SCENE] "TEXT"`: what an instruction is taken to mean, without doing it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

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
    from ...planners import load as load_planner
    from ..opening import Opening, open_session
    from ..resolved import plan_json, resolved_plan

    given = arguments or []
    if len(given) > (1 if batch else 2) or (not given and batch is None):
        raise UserError('write: scenewright plan [SCENE] "TEXT", or: scenewright plan [SCENE] --batch FILE')
    path = Path(given[0]) if len(given) == 2 or (batch and given) else None
    if path is None and batch is None and Path(given[0]).exists():
        raise UserError(f'{given[0]} is a scene; say what to do with it: scenewright plan {given[0]} "TEXT"')
    rows = read_batch(str(batch)) if batch else [{"text": given[-1]}]
    session = None
    if path is not None:
        session, _ = open_session(Opening(path, planner, encoder, view))
    for row in rows:
        if session is not None:
            answer = resolved_plan(session, row["text"], row.get("context"))
        else:
            answer = plan_json(load_planner(planner).plan(row["text"], previous=row.get("context")))
        if batch is not None:
            terminal.row({"id": row["id"], **answer})
            continue
        terminal.result(json.dumps(answer, indent=2, ensure_ascii=False), answer)
        if answer["verdict"] != "ok":
            raise typer.Exit(3)
