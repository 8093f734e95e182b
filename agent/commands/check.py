"""`scenewright check GRAPH.json`: check a scene graph for collisions, bounds, support, relations and reachability."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from ..options import Debug, Json
from ..terminal.output import terminal


def command(
    graph: Annotated[
        Path, typer.Argument(metavar="GRAPH.json", help="A scene graph (see `scenewright schema graph`).")
    ],
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Check a scene graph: collisions, bounds, support, stated relations, reachability. Exit code 3 on a violation."""
    from ...planners.rooms.check import check, sentences
    from ...planners.rooms.graph import SceneGraph

    report = check(SceneGraph.read(graph))
    lines = sentences(report.violations) or [f"{graph}: nothing is wrong"]
    lines += [f"not checked: {line}" for line in report.unchecked]
    terminal.result("\n".join(lines), {"ok": report.ok, **asdict(report)})
    if not report.ok:
        raise typer.Exit(3)
