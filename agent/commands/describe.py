"""`scenewright describe SCENE`: a paragraph about a scene or a scene graph, and a line for each thing."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..options import Debug, Encoder, Json, View
from ..terminal.output import terminal

if TYPE_CHECKING:
    from ...planners.questions.describing import Description


def command(
    scene: Annotated[
        Path | None, typer.Argument(metavar="[SCENE]", help="A scene file or folder (see `convert --help`).")
    ] = None,
    graph: Annotated[
        Path | None, typer.Option("--graph", metavar="ROOM.json", help="A scene graph to describe instead of a scene.")
    ] = None,
    encoder: Encoder = "auto",
    view: View = "auto",
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Describe a scene from what is measured: one paragraph, and a line for each thing."""
    found = _described(scene, graph, encoder, view)
    terminal.result("\n".join([found.text, "", *(f"  {t.text}" for t in found.things)]), found.to_json())


def _described(scene: Path | None, graph: Path | None, encoder: str, view: str) -> Description:
    """The description of the scene or of the graph; raises UserError unless exactly one is given."""
    from ...gaussians.errors import UserError

    if scene is not None and graph is None:
        from ..session.opening import SessionOptions, open_session

        return open_session(SessionOptions(scene, "grammar", encoder, view))[0].describe()
    if graph is not None and scene is None:
        from ...planners.questions.describing import describe
        from ...planners.questions.survey import Survey
        from ...planners.rooms.graph import SceneGraph

        return describe(Survey.of_graph(SceneGraph.read(graph)))
    raise UserError("give a scene, or a scene graph with --graph ROOM.json")
