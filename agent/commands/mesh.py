"""`scenewright mesh SCENE --select "the armchair" -o chair.glb`: a scene, or what a phrase names, as a mesh."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..options import Debug, Encoder, Force, Json, SceneFile, Up
from ..terminal.output import terminal

if TYPE_CHECKING:
    from ...gaussians.language.query.selection import Selection
    from ...gaussians.meshing import Mesh
    from ...gaussians.scene import Scene


def command(
    scene: SceneFile,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="OUT", help="File to write (.glb).")],
    select: Annotated[
        str | None, typer.Option("--select", metavar="TEXT", help="Only what this phrase names: 'the armchair'.")
    ] = None,
    faces: Annotated[
        int | None, typer.Option("--faces", metavar="N", help="Triangles at most; else as many as the shape needs.")
    ] = None,
    texture: Annotated[
        int, typer.Option("--texture", metavar="PX", help="Side of the texture; 0: colours of the vertices instead.")
    ] = 1024,
    watertight: Annotated[
        bool, typer.Option("--watertight", help="Keep what no view sees, so that the mesh is closed.")
    ] = False,
    cells: Annotated[
        int | None,
        typer.Option("--cells", metavar="N", help="Of the grid along the longest side; else by the Gaussians' size."),
    ] = None,
    in_place: Annotated[
        bool, typer.Option("--in-place", help="Keep the scene's origin; else the mesh stands on its own.")
    ] = False,
    at_time: Annotated[
        str | None,
        typer.Option("--time", metavar="T", help="Seconds at which a moving scene is taken."),
    ] = None,
    up: Up = None,
    metres_per_unit: Annotated[
        float | None,
        typer.Option("--metres-per-unit", metavar="M", help="Scale of the scene, whatever its file says."),
    ] = None,
    encoder: Encoder = "auto",
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Write a scene, or what a phrase names, as a mesh with a texture (.glb), in metres, y up.

    Words are meant as things stand at the start of a moving scene; --time takes what they name as it is then. --up and
    --metres-per-unit place the mesh; the names that were saved beside SCENE stay.

    Views all around decide what is filled. A texture needs xatlas: pip install "scenewright[mesh]".
    """
    started = time.perf_counter()
    from ...gaussians.meshing import check, mesh
    from ...gaussians.motion.at import at
    from ..output_files import refuse_existing, require_folder
    from ..pictures.named_cameras import with_frame
    from ..pictures.times import one_time
    from ..session.opening import SessionOptions, open_session

    check(output, faces, texture, cells)
    require_folder(output)
    refuse_existing([output], force)
    options = SessionOptions(scene, encoder=encoder, up=up, metres_per_unit=metres_per_unit, saved_names=True)
    session, _ = open_session(options)
    moment = None if at_time is None else one_time(at_time, session.scene.motion, scene.name)
    chosen = None if select is None else _chosen(session.select(select))
    if chosen is not None and chosen.verdict == "unconfirmed":
        terminal.say(f"note: {select!r} is not confirmed: {chosen.reason}; look at it before you use it")
    whole = with_frame(session.scene, up, metres_per_unit)  # a saved field brings the frame that it was made in
    if moment is not None:
        whole = at(whole, moment)
        _check_shown(whole, chosen, moment)
    made = mesh(
        whole, None if chosen is None else chosen.ids, faces=faces, texture=texture, watertight=watertight,
        cells=cells, in_place=in_place, name=select or scene.stem, progress=terminal.progress,
    )  # fmt: skip
    made.save(output, force)
    terminal.clear()
    if faces is not None and len(made.faces) > faces:
        terminal.say(f"note: {len(made.faces):,} triangles are the fewest that keep its pieces closed")
    if whole.frame.up_source == "unknown":
        terminal.say("note: which way is up is unknown; the third axis of the scene is taken for it (--up)")
    if whole.frame.metres_per_unit is None:
        terminal.say("note: the scene's scale is unknown; one of its units is written as a metre (--metres-per-unit)")
    data = _data(made, output, chosen) | ({} if moment is None else {"time": moment})
    data |= {"seconds": round(time.perf_counter() - started, 2)}
    terminal.result(_text(data), data)


def _chosen(selection: Selection) -> Selection:
    """The selection, if it is one; its candidates are told otherwise, and the command ends with code 3."""
    if selection.chosen:
        return selection
    terminal.result(selection.reason, {"verdict": selection.verdict, "reason": selection.reason, "path": None})
    for number, candidate in enumerate(selection.candidates, start=1):
        terminal.say(f"  {number}. {candidate.describe()}, score {candidate.score:.2f}")
    raise typer.Exit(3)


def _check_shown(scene: Scene, chosen: Selection | None, moment: float) -> None:
    """Check that something of what is chosen is there at a time; raises UserError otherwise."""
    from ...gaussians.errors import UserError
    from ...gaussians.rows import mask_of_ids

    if chosen is not None and not bool(mask_of_ids(scene.cloud.ids, chosen.ids).any()):
        raise UserError(f"what is named is hidden at {moment:g} s; give another --time")


def _data(made: Mesh, output: Path, chosen: Selection | None) -> dict[str, Any]:
    return {
        "path": str(output),
        "verdict": None if chosen is None else chosen.verdict,
        "gaussians": made.gaussians,
        "faces": len(made.faces),
        "vertices": len(made.vertices),
        "size": [round(float(side), 4) for side in made.size],
        "texture": None if made.texture is None else made.texture.shape[0],
        "watertight": made.closed,
        "cell": round(made.cell * made.scale, 5),
        "bytes": output.stat().st_size,
    }


def _text(data: dict[str, Any]) -> str:
    width, height, depth = data["size"]
    colors = f"a texture of {data['texture']} px" if data["texture"] else "colours of the vertices"
    closed = ", watertight" if data["watertight"] else ""
    return (
        f"{data['path']}: {data['faces']:,} triangles of {data['gaussians']:,} Gaussians{closed}, {colors}, "
        f"{data['bytes'] / 1e6:.1f} MB\n"
        f"size: {width:.2f} m wide, {depth:.2f} m deep, {height:.2f} m high; details of {100 * data['cell']:.1f} cm\n"
        f"time: {data['seconds']} s"
    )
