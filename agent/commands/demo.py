"""`scenewright demo -o demo/`: furnish a room, embed it and edit it with ten instructions."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..options import Debug, Encoder, Force, Json, Seed, Size
from ..terminal.output import terminal


def command(
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FOLDER", help="Folder for all files.")] = Path(
        "demo"
    ),
    seed: Seed = 0,
    size: Size = None,
    encoder: Encoder = "auto",
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Furnish a room, embed it, and edit it with ten instructions.

    Writes pictures before and after each step, the room before and after (.ply), the session log and a contact sheet.
    """
    from ..demo.run import Demo
    from ..pictures.named_cameras import parse_size

    demo = Demo(
        output,
        seed,
        parse_size(size) if size else (640, 480),
        force,
        encoder,
        say=terminal.say if as_json else terminal.line,
        progress=terminal.progress,
    )
    data = demo.run()
    stages = ", ".join(f"{stage} {value:.1f}" for stage, value in data["seconds"].items())
    terminal.result(f"seconds: {stages}\nsee {output / 'contact_sheet.png'}", data)
