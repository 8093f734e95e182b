"""`scenewright export SCENE -o room.html`: one file that shows a scene in any browser, without a server."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from .. import startup
from ..options import Debug, Force, Json, SceneFile, View
from ..terminal.output import terminal


def command(
    scene: SceneFile,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="OUT", help="File to write (.html).")],
    title: Annotated[
        str | None, typer.Option("--title", metavar="TEXT", help="What the page is called; else the scene's file name.")
    ] = None,
    view: View = "auto",
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Write one HTML file that shows a scene in any browser, without a server or a network.

    It opens from a disk or from any web host, loads nothing else, and names the things that are clicked if the scene
    has a language field. `scenewright slim` makes it smaller beforehand.
    """
    started = time.perf_counter()
    from ...gaussians.errors import UserError
    from ...gaussians.files import writing
    from ...gaussians.language.field.loading import load
    from ..output_files import refuse_existing, require_folder
    from ..pictures.named_cameras import choose_view
    from ..view.standalone import page

    startup.end()
    if output.suffix.lower() not in (".html", ".htm"):
        raise UserError(f"{output.name} is no web page; name it {output.name}.html")
    require_folder(output)
    refuse_existing([output], force)
    loaded = load(scene)
    data = page(loaded, choose_view(loaded, view), title or scene.name)
    with writing(output, force) as file:
        file.write(data)
    seconds = round(time.perf_counter() - started, 2)
    terminal.result(
        f"{output}: {len(loaded.cloud):,} Gaussians, {len(data):,} bytes, {seconds} s; open it in a browser",
        {"path": str(output), "gaussians": len(loaded.cloud), "bytes": len(data), "seconds": seconds},
    )
