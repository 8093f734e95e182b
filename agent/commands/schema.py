"""`scenewright schema NAME`: print the JSON Schema of plans, graphs, operations or queries."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from ..options import Debug, Json
from ..terminal.output import terminal


def command(
    name: Annotated[str, typer.Argument(metavar="NAME", help="plan, graph, ops or query.")],
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Print the JSON Schema of an edit plan, a scene graph, the operations or a query."""
    from ...planners.schemas import schema

    found = schema(name)
    terminal.result(json.dumps(found, indent=2, ensure_ascii=False), found)
