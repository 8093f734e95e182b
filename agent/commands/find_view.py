"""`scenewright find-view SCENE "TEXT" -o FILE`: find the camera for a view described in words, and draw it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..options import Debug, Encoder, Force, Json, Planner, SceneFile, Size, View
from ..output_files import refuse_existing, require_folder, require_png
from ..terminal.output import terminal

if TYPE_CHECKING:
    from ...gaussians.scene import Scene
    from ..pictures.image_files import Picture
    from ..session.find_view import FoundView

Drawn = Annotated[Path | None, typer.Option("--output", "-o", metavar="FILE", help="A .png to draw it into.")]
Marks = Annotated[bool, typer.Option("--marks", help="Outline the things and write their names on them.")]


def command(
    scene: SceneFile,
    text: Annotated[
        str,
        typer.Argument(metavar="TEXT", help="The view, e.g. 'the guitar from behind' or 'the view from the sofa'."),
    ],
    output: Drawn = None,
    marks: Marks = False,
    size: Size = None,
    view: View = "auto",
    encoder: Encoder = "auto",
    planner: Planner = "auto",
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Find the camera that shows things as the words say, and print it as `--view` takes it.

    A thing's front, left and right are its own where its shape or its wall shows them, else the viewer's (`--view`).
    """
    from ...gaussians.errors import UserError
    from ..pictures.named_cameras import PICTURE, parse_size
    from ..session.find_view import find_view
    from ..session.opening import SessionOptions, open_session

    if output is not None:
        require_png(output)
        require_folder(output)
        refuse_existing([output], force)
    elif marks:
        raise UserError("--marks are drawn into a picture; give one with -o FILE.png")
    pixels = PICTURE if size is None else parse_size(size)
    session, _ = open_session(SessionOptions(scene, planner, encoder, view))
    found = find_view(session, text, pixels)
    if output is not None:
        from ..pictures.image_files import save_png

        save_png(_drawn(session.scene, found, marks), output, force)
    data = _data(session.scene, found, output)
    terminal.result(_told(data), data)


def _drawn(scene: Scene, found: FoundView, marks: bool) -> Picture:
    from ..pictures.evidence import name_marks
    from ..pictures.marked_views import draw_view
    from ..pictures.marks import draw_marks

    drawing = draw_view(scene, found.view.camera, found.groups, found.view.cut)
    return draw_marks(drawing.image, drawing.labels, name_marks(scene, found.groups))[0] if marks else drawing.image


def _data(scene: Scene, found: FoundView, output: Path | None) -> dict[str, Any]:
    from ..pictures.named_cameras import view_text
    from ..terminal.thing_names import name_of_thing

    assert scene.language is not None
    camera = found.view.camera
    things = [
        {"group": g, "label": name_of_thing(scene.language.groups[g]), "share": round(share, 4)}
        for g, share in zip(found.groups, found.shares, strict=True)
    ]
    return {
        "path": None if output is None else str(output),
        "size": [camera.width, camera.height],
        "view": view_text(camera),
        "things": things,
        "left_out": sorted(found.view.cut.groups),
        "notes": list(found.notes),
    }


def _told(data: dict[str, Any]) -> str:
    """The result for a person: the view, how much of it each thing takes, and remarks."""
    shown = ", ".join(f"{t['label']} (group {t['group']}) {100 * t['share']:.1f} %" for t in data["things"])
    lines = [f"--view {data['view']}"]
    if data["path"] is not None:
        lines.insert(0, f"{data['path']}: {data['size'][0]}x{data['size'][1]}")
    if shown:
        lines.append(f"of the picture: {shown}")
    return "\n".join([*lines, *data["notes"]])
