"""`scenewright convert IN OUT`: the same scene in another format."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..options import Debug, Force, Json, SceneFile
from ..terminal import terminal


def command(
    scene: SceneFile,
    output: Annotated[Path, typer.Argument(metavar="OUT", help="Where to write; its suffix says the format.")],
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Write a scene in another format.

    Read: INRIA .ply, PlayCanvas .compressed.ply, SOG (.sog, or a folder with meta.json). Written: INRIA .ply.
    """
    from ...gaussians.files import load_with_report, save
    from ..targets import refuse_existing

    refuse_existing([output], force)
    loaded, report = load_with_report(scene)
    save(loaded, output, force=force)
    for note in report.notes:
        terminal.say(f"note: {note}")
    data = {"path": str(output), "from": report.format, "gaussians": len(loaded.cloud), "notes": list(report.notes)}
    terminal.result(f"{output}: {len(loaded.cloud):,} Gaussians, from {report.format}", data)
