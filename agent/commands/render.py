"""`scenewright render SCENE -o FILE.png`: a picture of a scene."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from ..options import Debug, Force, Json, SceneFile, Size, View
from ..terminal import terminal


def command(
    scene: SceneFile,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="Where to write the picture (.png).")],
    view: View = "auto",
    size: Size = None,
    background: Annotated[str, typer.Option(help="Colour behind everything: a CSS name or #rrggbb.")] = "black",
    backend: Annotated[str, typer.Option(help="Renderer: 'auto', 'cpu' or 'reference'.")] = "auto",
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Draw a scene as one of its cameras, or one that you give, sees it."""
    from ...gaussians.color import parse
    from ...gaussians.files import load
    from ...gaussians.render import render
    from ..pictures import save_png
    from ..targets import refuse_existing, require_png
    from ..views import choose_view

    require_png(output)
    refuse_existing([output], force)
    loaded = load(scene)
    camera = choose_view(loaded, view, size)
    started = time.perf_counter()
    picture = render(loaded.cloud, camera, parse(background), backend).to_uint8()
    seconds = round(time.perf_counter() - started, 3)
    save_png(picture, output, force)
    data = {"path": str(output), "size": [camera.width, camera.height], "view": camera.name, "seconds": seconds}
    terminal.result(f"{output}: {camera.width}x{camera.height}, drawn in {seconds} s", data)
