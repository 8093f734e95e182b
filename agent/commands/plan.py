"""`scenewright plan [SCENE] "TEXT"`: print the plan of an instruction without carrying it out."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from .. import startup
from ..options import Batch, Budget, Debug, Encoder, Json, Picture, Planner, View, Window
from ..terminal.output import read_batch, terminal

Answer = Callable[[str, str | None], dict[str, Any]]  # arguments: the instruction and the previous one


def command(
    arguments: Annotated[
        list[str] | None,
        typer.Argument(metavar="[SCENE] TEXT", help="The instruction; after a scene file, its targets are resolved."),
    ] = None,
    batch: Batch = None,
    graph: Annotated[
        Path | None,
        typer.Option("--graph", metavar="ROOM.json", help="A scene graph to resolve on instead of a scene."),
    ] = None,
    resolve: Annotated[
        bool, typer.Option("--resolve", help="Resolve every target (the default with a scene or a graph).")
    ] = False,
    encoder: Encoder = "auto",
    planner: Planner = "auto",
    budget: Budget = None,
    window: Window = None,
    picture: Picture = False,
    view: View = "auto",
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Print the plan of an instruction as JSON. Nothing is changed.

    Without a scene, targets stay queries. With a scene, or a scene graph (see `scenewright schema graph`), every target
    is resolved: {"verdict", "steps", "candidates", "reason", "planner", "seconds"}, and the usage of a language model.
    With a scene the plan is also run on a copy, so that the answer shows what `edit` would do.
    """
    from ...gaussians.errors import UserError
    from ..session.opening import SessionOptions, open_session
    from ..session.plan_report import resolved_plan

    given = arguments or []
    if len(given) > (1 if batch else 2) or (not given and batch is None):
        raise UserError('write: scenewright plan [SCENE] "TEXT", or: scenewright plan [SCENE] --batch FILE')
    path = Path(given[0]) if len(given) == 2 or (batch and given) else None
    if path is None and batch is None and Path(given[0]).exists():
        raise UserError(f'{given[0]} is a scene; say what to do with it: scenewright plan {given[0]} "TEXT"')
    if path is not None and graph is not None:
        raise UserError(f"give either the scene {path} or --graph {graph}, not both")
    if resolve and path is None and graph is None:
        raise UserError('--resolve needs a scene or a graph: scenewright plan "TEXT" --graph ROOM.json --resolve')
    rows = read_batch(str(batch)) if batch else [{"text": given[-1]}]
    if path is not None:
        session, _ = open_session(SessionOptions(path, planner, encoder, view, budget=budget, picture=picture))
        answer: Answer = partial(resolved_plan, session)
    else:
        answer = _without_scene(graph, planner, budget)
    for row in rows:
        if batch is not None:
            terminal.row({"id": row["id"], **_batch_answer(answer, row)})
            continue
        data = answer(row["text"], row.get("context"))
        terminal.result(json.dumps(data, indent=2, ensure_ascii=False), data)
        if data["verdict"] != "ok":
            raise typer.Exit(3)


def _batch_answer(answer: Answer, row: dict[str, Any]) -> dict[str, Any]:
    """The answer to one line of a batch; a rejected text does not stop the others."""
    from ...gaussians.errors import UserError
    from ..session.plan_report import rejected_json

    try:
        return answer(row["text"], row.get("context"))
    except UserError as error:
        return rejected_json(str(error))


def _without_scene(graph: Path | None, planner: str, budget: str | None) -> Answer:
    """Answers that resolve targets on a graph, or, without one, leave them as queries."""
    from ...planners import load as load_planner
    from ...planners.budget import Budget, Ledger
    from ..session.plan_report import graph_plan, plan_json

    ledger = Ledger(Budget.parse(budget) if budget is not None else None)
    planner_used = load_planner(planner, ledger=ledger, progress=terminal.progress)
    startup.end()
    if graph is None:
        return lambda text, context: plan_json(planner_used.plan(text, previous=context))
    from ...planners.rooms.graph import SceneGraph
    from ...planners.rooms.graph_scene import Stage

    return partial(graph_plan, Stage.of(SceneGraph.read(graph)), planner_used)
