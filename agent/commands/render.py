"""`scenewright render SCENE -o FILE`: a picture of a scene, or a film on an orbit, a capture's cameras or a path."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .. import startup
from ..options import Debug, Force, Json, Lod, Memory, SceneFile, Size, View
from ..output_files import refuse_existing
from ..pictures.named_cameras import PICTURE, choose_view, parse_size
from ..terminal.output import terminal

if TYPE_CHECKING:
    from ...gaussians.camera import Camera, Render
    from ...gaussians.scene import Scene
    from ..pictures.shots import Shots
    from ..streaming import Drawn
    from ..tiled_pictures import DrawnTiles

    Partly = Drawn | DrawnTiles | None  # a scene of which each picture reads a part; None: it is read whole

Draw = Callable[["Camera", float | None], Any]  # a picture from a camera at a time, None: of the scene as it is
Timing = tuple[float | None, float | None]  # seconds of a film, pictures a second

_GIF_SIZE = (480, 320)  # pixels, by default: the files of larger GIFs grow fast


def command(
    scene: SceneFile,
    output: Annotated[
        Path,
        typer.Option(
            "--output", "-o", metavar="FILE", help="A .png, .gif or .mp4, a folder, or a pattern as %04d.png."
        ),
    ],
    view: View = "auto",
    orbit: Annotated[
        int | None, typer.Option("--orbit", metavar="N", help="N pictures once around the scene or its centre.")
    ] = None,
    cameras: Annotated[
        Path | None,
        typer.Option(
            "--cameras",
            metavar="SOURCE",
            help="Every camera of a capture (transforms.json, COLMAP folder) or scene; with --orbit, the ring through "
            "them.",
        ),
    ] = None,
    path: Annotated[
        Path | None, typer.Option("--path", metavar="FILE", help="A camera path: keyframes in JSON, or nerfstudio's.")
    ] = None,
    at_time: Annotated[
        str | None,
        typer.Option(
            "--time", metavar="T", help="Seconds at which a moving scene is shown; 0:5 is a film, : all of it."
        ),
    ] = None,
    seconds: Annotated[float | None, typer.Option(help="Length of the film.")] = None,
    fps: Annotated[float | None, typer.Option(help="Pictures a second, 25 by default.")] = None,
    size: Size = None,
    background: Annotated[str, typer.Option(help="Background colour: a CSS name or #rrggbb.")] = "black",
    alpha: Annotated[bool, typer.Option("--alpha", help="PNGs with a transparent background.")] = False,
    depth: Annotated[
        bool, typer.Option("--depth", help="16-bit PNGs of depth in thousandths of a scene unit, 0 for background.")
    ] = False,
    backend: Annotated[str, typer.Option(help="Renderer: 'auto', 'cpu', 'reference' or 'cuda'.")] = "auto",
    lod: Lod = None,
    memory: Memory = None,
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Render a scene from a camera, or a film: around it, from a capture's cameras, along a path, or through time.

    A .lod is drawn at its finest level. With --lod each of its parts is drawn at the coarsest level that moves its
    Gaussians by at most so many pixels, and only the files of these levels are read.

    A scene in tiles is drawn exactly, in slabs of depth that fit into --memory.
    """
    from dataclasses import replace

    from ...gaussians.color import parse
    from ...gaussians.errors import UserError
    from ...gaussians.files import load_with_report
    from ...gaussians.motion.at import cloud_at
    from ...gaussians.render import render
    from ...gaussians.tiles.store import is_tiles
    from ..pictures.film import is_film
    from ..pictures.shots import timed_shots
    from ..pictures.times import spread, time_span
    from ..streaming import Drawn
    from ..tiled_pictures import DrawnTiles

    startup.end()
    film = is_film(output)
    options = {"--view": view != "auto", "--orbit": orbit is not None, "--cameras": cameras is not None}
    options |= {"--path": path is not None, "--seconds": seconds is not None, "--fps": fps is not None}
    _check_options([option for option, given in options.items() if given], output, film, at_time)
    if at_time is not None and lod is not None:
        raise UserError("levels of detail hold no motion; leave out --lod or --time")
    _check_channels(alpha, depth, output)
    behind = (0.0, 0.0, 0.0) if alpha else parse(background)
    finish = _transparent if alpha else _thousandths if depth else lambda drawn: drawn.to_uint8()

    def draw(camera: Camera, time: float | None = None) -> Any:
        if leveled is not None:
            return finish(leveled.render(camera, behind, backend))
        return finish(render(loaded.cloud if time is None else cloud_at(loaded, time), camera, behind, backend))

    if not film:
        refuse_existing([output], force)
    leveled: Partly = None if lod is None else Drawn.of(scene, lod)
    if is_tiles(scene):
        leveled = DrawnTiles.of(scene, backend)
        loaded = leveled.scene()
    elif not isinstance(leveled, Drawn):
        loaded, report = load_with_report(scene)
        for note in report.notes if at_time is not None else ():
            terminal.say(f"note: {note}")
    else:
        chosen = (view == "auto" and not leveled.streamed.cameras) if not film else cameras is None or bool(orbit)
        loaded = leveled.scene(whole=chosen)  # all of it where it says which views there are, as without levels
    span = None if at_time is None else time_span(at_time, loaded.motion, scene.name)
    if not film:
        _still(draw, choose_view(loaded, view, size), None if span is None else span[0], output, force, leveled)
        return
    timing = seconds, fps
    if span is not None and orbit is None and cameras is None and path is None:
        small = f"{_GIF_SIZE[0]}x{_GIF_SIZE[1]}" if output.suffix.lower() == ".gif" else None
        shots = timed_shots(choose_view(loaded, view, size or small), span, *timing)
    else:
        shots = _shots(loaded, orbit, cameras, path, timing, size, output)
        shots = shots if span is None else replace(shots, times=spread(span, len(shots.cameras)))
    _film(draw, shots, output, force, leveled)


def _check_options(given: list[str], output: Path, film: bool, time: str | None) -> None:
    """Check that the given options fit together and fit the output. Raises UserError if they do not; the message names
    them."""
    from ...gaussians.errors import UserError
    from ..pictures.times import check_times

    if time is not None:
        check_times(time)
    which = [option for option in given if option in ("--view", "--orbit", "--cameras", "--path")]
    if len(which) > 1 and which != ["--orbit", "--cameras"]:
        raise UserError(f"{' and '.join(which)} are different pictures; ask for one")
    if film and which in ([], ["--view"]) and (time is None or ":" not in time):
        one = "" if time is None else f", and --time {time} is one"
        raise UserError(
            f"{output} is for many pictures{one}; say which: --orbit 75, --cameras CAPTURE, --path FILE, or --time 0:5"
        )
    many = [option for option in given if option != "--view"]
    many += [f"--time {time}"] if time is not None and ":" in time else []
    if not film and many:
        raise UserError(f"{many[0]} is for many pictures; write a .gif, an .mp4 or a folder instead of {output.name}")


def _check_channels(alpha: bool, depth: bool, output: Path) -> None:
    """Check that transparency or depth is written to PNGs. Raises UserError if both are requested, or the output format
    cannot store them."""
    from ...gaussians.errors import UserError

    if alpha and depth:
        raise UserError("--alpha and --depth are different pictures; ask for one")
    if (alpha or depth) and output.suffix.lower() in (".gif", ".mp4"):
        raise UserError(f"{'--alpha' if alpha else '--depth'} needs PNGs; write a folder instead of {output.name}")


def _still(draw: Draw, camera: Camera, moment: float | None, output: Path, force: bool, leveled: Partly) -> None:
    from ..pictures.image_files import save_png

    started = time.perf_counter()
    picture = draw(camera, moment)
    seconds = round(time.perf_counter() - started, 3)
    save_png(picture, output, force)
    data = {"path": str(output), "size": [camera.width, camera.height], "view": camera.name, "seconds": seconds}
    data |= {} if moment is None else {"time": moment}
    text = f"{output}: {camera.width}x{camera.height}, drawn in {seconds} s"
    _tell(text, data, leveled)


def _tell(text: str, data: dict[str, Any], leveled: Partly) -> None:
    """Print the result, with what was drawn of which levels."""
    if leveled is not None:
        text, data = f"{text}\n  {leveled.text()}", data | {leveled.KEY: leveled.data()}
    terminal.result(text, data)


def _shots(
    scene: Scene, orbit: int | None, cameras: Path | None, path: Path | None, timing: Timing, size: str | None, to: Path
) -> Shots:
    """The pictures of a film; `timing` holds its seconds and its pictures a second."""
    from ..pictures import shots

    given = None if size is None else parse_size(size)
    default = _GIF_SIZE if to.suffix.lower() == ".gif" else PICTURE
    if path is not None:
        return shots.path_shots(scene, path, given, default, *timing)
    if orbit is not None:
        return shots.orbit_shots(scene, cameras, orbit, given or default, *timing)
    assert cameras is not None
    return shots.capture_shots(cameras, given, *timing)


def _film(draw: Draw, shots: Shots, output: Path, force: bool, leveled: Partly) -> None:
    from ..pictures import film

    sizes = {(camera.width, camera.height) for camera in shots.cameras}
    film.check(output, shots.names, sizes, shots.fps, force)
    count = len(shots.cameras)
    started = time.perf_counter()

    def drawn(i: int) -> Any:
        terminal.progress(f"drawing {i + 1} of {count}", i / count)
        return draw(shots.cameras[i], shots.times[i] if shots.times else None)

    with terminal.interruptible():
        size = film.write(output, shots.names, drawn, shots.fps, force)
    terminal.clear()
    spent = round(time.perf_counter() - started, 3)
    width, height = next(iter(sizes)) if len(sizes) == 1 else (None, None)
    data = {"path": str(output), "pictures": count, "size": [width, height] if width else None, "bytes": size}
    data |= {"fps": round(shots.fps, 3), "lasts": round(shots.seconds, 3), "seconds": spent}
    data |= {"time": [shots.times[0], shots.times[-1]]} if shots.times else {}
    of = f" of {width}x{height}" if width else ""
    lasts = "" if film.picture_paths(output, shots.names) else f", {shots.seconds:.1f} s at {shots.fps:g} a second"
    pictures = "1 picture" if count == 1 else f"{count} pictures"
    _tell(f"{output}: {pictures}{of}{lasts}, {size / 1e6:.1f} MB, drawn in {spent} s", data, leveled)


def _transparent(drawn: Render) -> Any:
    """`[H, W, 4]` uint8 with straight alpha: colours without the black background."""
    import torch

    alpha = drawn.alpha[..., None]
    straight = torch.cat([drawn.rgb / alpha.clamp(min=1e-6), alpha], dim=-1)
    return (straight.clamp(0, 1) * 255 + 0.5).to(torch.uint8).cpu().numpy()


def _thousandths(drawn: Render) -> Any:
    """`[H, W]` uint16, depth in thousandths of a scene unit; depths beyond 16 bits are 65535."""
    import numpy as np

    return (drawn.depth.cpu().numpy() * 1000 + 0.5).clip(0, 65535).astype(np.uint16)
