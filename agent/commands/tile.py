"""`scenewright tile SCENE [SCENE ...] -o NAME.tiles`: divide scenes that do not fit into memory into tiles."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated, Any

import typer

from .. import startup
from ..options import Debug, Force, Json, Memory
from ..terminal.output import terminal


def command(
    scenes: Annotated[list[Path], typer.Argument(metavar="SCENE...", help="Scene files; several become one scene.")],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="NAME.tiles", help="Folder to write.")],
    memory: Memory = None,
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Divide a scene into tiles of at most a million Gaussians, so that it can be larger than memory.

    The folder is a scene for info, select, edit and render, and for every other verb while it fits into memory.
    A .ply is read as a stream; language fields saved beside the files (see embed) become one table of things.
    """
    from ...gaussians.errors import UserError
    from ...gaussians.tiles.budget import memory as budget
    from ...gaussians.tiles.making import make
    from ...gaussians.tiles.store import SUFFIX
    from ..output_files import refuse_existing

    startup.end()
    if output.suffix.lower() != SUFFIX:
        raise UserError(f"tiles are written to a folder NAME{SUFFIX}, not to {output.name}")
    refuse_existing([output], force)
    started = time.perf_counter()
    made = make(scenes, output, memory=budget(), force=force, progress=terminal.progress)
    terminal.clear()
    seconds = round(time.perf_counter() - started, 3)
    groups = 0 if made.field is None else sum(1 for g in made.field.objects() if g.count)
    data: dict[str, Any] = {
        "path": str(output), "gaussians": len(made), "tiles": len(made.state.tiles), "things": groups,
        "degree": made.state.degree, "notes": list(made.state.notes), "seconds": seconds,
    }  # fmt: skip
    for note in made.state.notes:
        terminal.say(f"note: {note}")
    named = f"{groups:,} things" if made.field is not None else "not embedded"
    terminal.result(f"{output}: {len(made):,} Gaussians in {len(made.state.tiles)} tiles, {named}, {seconds} s", data)
