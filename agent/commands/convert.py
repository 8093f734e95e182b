"""`scenewright convert IN OUT`: write a scene in another format, optionally reduced, and measure the loss."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .. import startup
from ..options import Debug, Force, Json, Memory, SceneFile
from ..terminal.output import terminal

if TYPE_CHECKING:
    from ...gaussians.camera import Camera
    from ...gaussians.files import Report
    from ...gaussians.scene import Scene
    from ...gaussians.tiles.store import Tiles

VIEWS = 4  # to measure the loss from
VIEW_SIZE = 384  # pixels a side of the pictures that are compared
PRUNE_SIZE = 160  # pixels a side of the views that say which Gaussians matter
PRUNE_VIEWS = 64


def command(
    scene: SceneFile,
    output: Annotated[Path, typer.Argument(metavar="OUT", help="File to write; its suffix selects the format.")],
    sh_degree: Annotated[
        int | None, typer.Option("--sh-degree", min=0, max=3, metavar="N", help="Reduce harmonics to this degree.")
    ] = None,
    max_gaussians: Annotated[
        int | None,
        typer.Option("--max-gaussians", min=1, metavar="N", help="Keep the N that contribute most to rendered views."),
    ] = None,
    crop: Annotated[
        str | None, typer.Option("--crop", metavar="x0,y0,z0,x1,y1,z1", help="Keep the Gaussians in this box.")
    ] = None,
    crop_sphere: Annotated[
        str | None, typer.Option("--crop-sphere", metavar="x,y,z,r", help="Keep the Gaussians in this sphere.")
    ] = None,
    views: Annotated[
        int | None,
        typer.Option(
            "--views", min=0, max=24, help="Number of views to measure the loss from (4; 8 of a .lod); 0: none."
        ),
    ] = None,
    spz_version: Annotated[
        int, typer.Option("--spz-version", min=2, max=4, help="Version of .spz, for older readers.")
    ] = 4,
    levels: Annotated[
        int | None, typer.Option("--levels", min=1, max=12, metavar="N", help="Levels of detail of a .lod folder (4).")
    ] = None,
    chunk: Annotated[
        int | None,
        typer.Option("--chunk", min=1024, metavar="N", help="Most Gaussians of a file in a .lod folder (65536)."),
    ] = None,
    at_time: Annotated[
        str | None,
        typer.Option(
            "--time", metavar="T", help="A moving scene at so many seconds; 0:5 with OUT as %04d.ply: many files."
        ),
    ] = None,
    fps: Annotated[
        float | None, typer.Option("--fps", metavar="N", help="Files of a sequence that make a second.")
    ] = None,
    memory: Memory = None,
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Write a scene in another format, and report its size and the loss.

    Read and written: INRIA .ply, PlayCanvas .compressed.ply and SOG (.sog; read from a folder with meta.json as well),
    Niantic .spz (version 1 is read only), antimatter15 .splat (which holds no harmonics above the constant colour).
    A .lod folder (or a lod-meta.json in it) is PlayCanvas' Streamed SOG: levels of detail, each with a quarter of the
    Gaussians of the one before, merged, not dropped; the finest level is the scene that other verbs read.

    The names of things (the language field beside SCENE) go along, into a file beside OUT; levels of detail hold none.
    A scene with motion keeps it, in a file beside OUT. With --time it is written as it is at that time, or as one file
    for each time of a range; a sequence of files of the same Gaussians ('frames/*.ply' or frames/%04d.ply) becomes a
    scene with motion.

    A scene in tiles is written to a .ply as a stream, without loss, if nothing else is asked for. Where it does not fit
    into the memory, a .lod is written part by part.
    """
    from ...gaussians.errors import UserError
    from ...gaussians.files import writer
    from ...gaussians.tiles import exporting
    from ...gaussians.tiles.budget import memory as budget
    from ...gaussians.tiles.store import is_tiles
    from ..output_files import refuse_existing
    from ..sequences import is_pattern
    from ..streaming import HELD_OUT, is_streamed, write_levels, write_levels_of_tiles

    startup.end()
    if is_pattern(output):
        said = {"--sh-degree": sh_degree, "--max-gaussians": max_gaussians, "--crop": crop,
                "--crop-sphere": crop_sphere, "--levels": levels, "--views": views}  # fmt: skip
        if given := [name for name, value in said.items() if value is not None]:
            raise UserError(f"{given[0]} does not go with a file for each time; convert the scene with it first")
        _sequence(scene, output, at_time, fps, force)
        return
    refuse_existing([output], force)
    streamed = is_streamed(output)
    if not streamed:
        writer(output)  # raises if the suffix belongs to no format
        _refuse_levels(output, {"--levels": levels, "--chunk": chunk})
    changed = any(value is not None for value in (sh_degree, max_gaussians, crop, crop_sphere, at_time, fps, views))
    if is_tiles(scene) and exporting.is_streamed(output) and not changed:
        _stream(scene, output, force)
        return
    if is_tiles(scene) and streamed and not changed and (tiles := _too_large(scene)) is not None:
        write_levels_of_tiles(tiles, output, (levels, chunk), budget(), force)
        return
    if views is None:
        views = HELD_OUT if streamed else VIEWS
    box, ball = _numbers(crop, 6, "--crop"), _numbers(crop_sphere, 4, "--crop-sphere")
    start = time.perf_counter()
    loaded, report, size = _load(scene, fps, at_time)
    read = time.perf_counter() - start
    cut = _cut(loaded, box, ball)
    cameras = _views(cut, views) if views and not streamed else ()
    smaller = _smaller(cut, sh_degree, max_gaussians, cameras)
    if streamed:
        for note in (*report.notes, *_not_in_levels(smaller)):
            terminal.say(f"note: {note}")
        write_levels(smaller, cut.cloud, output, (levels, chunk), views, force)
        return
    start = time.perf_counter()
    names = _save(_counted_again(smaller, loaded), output, force, spz_version)
    wrote = time.perf_counter() - start
    after = len(smaller.cloud), _size(output)
    done = _Report(output, report.format, (report.rows, size), after, (read, wrote), names)
    done.notes += report.notes
    done.measure(cut, smaller, cameras)
    for note in done.notes:
        terminal.say(f"note: {note}")
    terminal.result(done.text(), done.data())


def _too_large(scene: Path) -> Tiles | None:
    """A scene in tiles, if work on all of it does not fit into the memory."""
    from ...gaussians.tiles import window
    from ...gaussians.tiles.budget import memory as budget
    from ...gaussians.tiles.store import Tiles

    tiles = Tiles.open(scene)
    return None if window.fits(tiles, len(tiles), budget()) else tiles


def _stream(scene: Path, output: Path, force: bool) -> None:
    """Write a scene in tiles to a .ply, tile by tile, and the names of its things beside it."""
    from ...gaussians.tiles.exporting import write_field, write_ply
    from ...gaussians.tiles.store import Tiles

    start = time.perf_counter()
    tiles, size = Tiles.open(scene), _size(scene)
    write_ply(tiles, output, force, terminal.progress)
    path = write_field(tiles, output)
    terminal.clear()
    counts = (len(tiles), size), (len(tiles), _size(output))
    names = None if path is None or tiles.field is None else (path, len(tiles.field.groups))
    done = _Report(output, "tiles", *counts, (0.0, time.perf_counter() - start), names)
    terminal.result(done.text(), done.data())


def _load(scene: Path, fps: float | None, at_time: str | None) -> tuple[Scene, Report, int]:
    """The scene to convert, the report of reading it, and its bytes: a file, or a sequence of them."""
    from ...gaussians.errors import UserError
    from ...gaussians.motion.at import at
    from .. import sequences
    from ..pictures.times import time_span

    if sequences.is_pattern(scene):
        loaded, report, size = sequences.read(scene, fps)
    elif fps is not None:
        raise UserError("--fps is for sequences of files; leave it out, or write OUT as a pattern such as %04d.ply")
    else:
        loaded, report = _named(scene)
        size = _size(scene)
    if at_time is not None:
        start, stop = time_span(at_time, loaded.motion, scene.name)
        if stop > start:
            raise UserError(f"--time {at_time} is many files; write OUT as a pattern such as frames/%04d.ply")
        loaded = at(loaded, start)
    return loaded, report, size


def _named(scene: Path) -> tuple[Scene, Report]:
    """The scene in a file with the language field beside it, and the report of reading it."""
    from dataclasses import replace

    from ...gaussians.files import load_with_report
    from ...gaussians.language.field.store import load_field, mismatch

    loaded, report = load_with_report(scene)
    named = load_field(loaded, scene)
    if named is None and (why := mismatch(scene)) is not None:
        report = replace(report, notes=(*report.notes, f"the language field beside {scene} {why}: it is left out"))
    return named or loaded, report


def _sequence(scene: Path, output: Path, at_time: str | None, fps: float | None, force: bool) -> None:
    """Write a scene with motion as one file for each time."""
    from ...gaussians.files import writer
    from .. import sequences
    from ..pictures.times import time_span

    writer(output)
    loaded, report = _named(scene)
    for note in report.notes:
        terminal.say(f"note: {note}")
    span = time_span(at_time or ":", loaded.motion, scene.name)
    data = sequences.write(loaded, output, span, fps, force)
    text = f"{output}: {data['files']} files from {span[0]:g} to {span[1]:g} s, {data['bytes'] / 1e6:.1f} MB"
    terminal.result(text, data)


@dataclass
class _Report:
    """The report of a conversion: `before` and `after` as (Gaussians, bytes), `seconds` of reading and writing, `names`
    as (path of the language field, its groups) if there are any."""

    output: Path
    format: str
    before: tuple[int, int]
    after: tuple[int, int]
    seconds: tuple[float, float]
    names: tuple[Path, int] | None = None
    notes: list[str] = field(default_factory=list)
    psnr: tuple[float, ...] = ()

    def measure(self, truth: Scene, written: Scene, cameras: tuple[Camera, ...]) -> None:
        """Read the written file, compare rendered views, and note what the format cannot store."""
        from ...gaussians.language.field.loading import load
        from ...gaussians.reduce import psnr

        back = load(self.output)
        if back.cloud.degree < written.cloud.degree:
            self.notes.append(f"harmonics of degree {written.cloud.degree} were cut to {back.cloud.degree}")
        if back.frame != written.frame:
            self.notes.append("up, scale and cameras of the scene were left out: only .ply files hold them")
        elif len(back.cameras) < len(written.cameras):
            self.notes.append("cameras of the scene were left out: only .ply files hold them")
        self.psnr = psnr(truth.cloud, back.cloud, cameras)

    def data(self) -> dict[str, Any]:
        return {
            "path": str(self.output),
            "from": self.format,
            "gaussians": self.after[0],
            "gaussians_before": self.before[0],
            "bytes": self.after[1],
            "bytes_before": self.before[1],
            "psnr": sum(self.psnr) / len(self.psnr) if self.psnr else None,
            "psnr_least": min(self.psnr) if self.psnr else None,
            "views": len(self.psnr),
            "read_seconds": self.seconds[0],
            "write_seconds": self.seconds[1],
            "field": str(self.names[0]) if self.names else None,
            "notes": self.notes,
        }

    def text(self) -> str:
        (count, size), (old_count, old_size) = self.after, self.before
        of_all = f" of {old_count:,}" if count != old_count else ""
        lines = [
            f"{self.output}: {count:,} Gaussians{of_all}, from {self.format}",
            f"size: {old_size:,} -> {size:,} bytes ({size / max(old_size, 1):.0%}), {size / count:.1f} a Gaussian",
        ]
        if self.psnr:
            mean, views = sum(self.psnr) / len(self.psnr), len(self.psnr)
            lines.append(
                f"pictures: {mean:.1f} dB PSNR to the original over {views} views, {min(self.psnr):.1f} dB at worst"
            )
        if self.names:
            lines.append(f"names: of {self.names[1]:,} groups, in {self.names[0]}")
        return "\n".join([*lines, f"time: read {self.seconds[0]:.2f} s, written {self.seconds[1]:.2f} s"])


def _refuse_levels(output: Path, given: dict[str, int | None]) -> None:
    """Check that nothing is asked of levels that this file does not have. Raises UserError otherwise."""
    from ...gaussians.errors import UserError

    for option, value in given.items():
        if value is not None:
            raise UserError(f"{option} is for levels of detail; write {output.stem}.lod, or leave it out")


def _numbers(text: str | None, count: int, option: str) -> list[float] | None:
    """`count` finite numbers separated by commas; None if the option was not given."""
    import math

    from ...gaussians.errors import UserError

    if text is None:
        return None
    try:
        found = [float(word) for word in text.split(",")]
    except ValueError:
        found = []
    if len(found) != count or not all(math.isfinite(number) for number in found):
        raise UserError(f"{option} takes {count} numbers with commas between them and no spaces, not {text!r}")
    return found


def _cut(scene: Scene, box: list[float] | None, ball: list[float] | None) -> Scene:
    from ...gaussians import reduce

    if box:
        scene = reduce.crop_box(scene, (box[0], box[1], box[2]), (box[3], box[4], box[5]))
    if ball:
        scene = reduce.crop_sphere(scene, (ball[0], ball[1], ball[2]), ball[3])
    return scene


def _views(scene: Scene, count: int) -> tuple[Camera, ...]:
    """Cameras to measure the loss from: evenly chosen from the scene's own, else the views that see most of it."""
    from ...gaussians.viewpoints.coverage import choose_views, fit_camera

    own = scene.cameras
    if own:
        return tuple(fit_camera(own[i * len(own) // count], VIEW_SIZE, VIEW_SIZE) for i in range(min(count, len(own))))
    return tuple(camera.resized(VIEW_SIZE, VIEW_SIZE) for camera in choose_views(scene, count).cameras)


def _smaller(scene: Scene, degree: int | None, max_gaussians: int | None, measured: tuple[Camera, ...]) -> Scene:
    """The scene pruned by contributions to views other than the `measured` ones, and with fewer harmonics."""
    from ...gaussians.reduce import prune
    from ...gaussians.viewpoints.coverage import candidates, fit_camera

    if max_gaussians is not None and max_gaussians < len(scene.cloud):
        own = scene.cameras[:: -(-len(scene.cameras) // PRUNE_VIEWS) or 1]
        pool = [fit_camera(camera, PRUNE_SIZE, PRUNE_SIZE) for camera in own]
        pool += candidates(scene.cloud, scene.frame, PRUNE_SIZE)
        poses = {camera.world_to_camera.tobytes() for camera in measured}
        scene = prune(scene, max_gaussians, [c for c in pool if c.world_to_camera.tobytes() not in poses] or pool)
    if degree is not None and degree < scene.cloud.degree:
        scene = scene.replace(cloud=scene.cloud.with_degree(degree))
    return scene


def _not_in_levels(scene: Scene) -> tuple[str, ...]:
    """Notes on what levels of detail leave out."""
    left_out = () if scene.motion is None else ("levels of detail hold no motion: it is left out",)
    if scene.language is None:
        return left_out
    return (*left_out, "levels of detail hold no names: embed what was written, or ask the scene that it was made from")


def _counted_again(scene: Scene, before: Scene) -> Scene:
    """The scene, which is `before` without some Gaussians, with the groups of its language field measured again."""
    from ...gaussians.rows import mask_of_ids
    from ...tools.field_update import after_removal

    if scene.language is None or len(scene.cloud) == len(before.cloud):
        return scene
    gone = ~mask_of_ids(before.cloud.ids, scene.cloud.ids)
    return scene.replace(language=after_removal(before, scene.cloud, before.cloud.ids[gone]))


def _save(scene: Scene, output: Path, force: bool, spz_version: int) -> tuple[Path, int] | None:
    """Write the scene with what is beside it; the path of its language field and its groups, None without one."""
    from ...gaussians.files import stored_order, writing
    from ...gaussians.files.formats import spz
    from ...gaussians.files.motion_file import save_motion
    from ...gaussians.language.field.saving import save
    from ...gaussians.language.field.store import save_field

    ordered = stored_order(scene, output)
    if output.suffix.lower() == ".spz" and spz_version != spz.LATEST:
        with writing(output, force) as file:
            spz.write(ordered, file, spz_version)
        save_motion(ordered, output)
        path = None if ordered.language is None else save_field(ordered, output)
    else:
        path = save(ordered, output, force)
    return None if path is None or ordered.language is None else (path, len(ordered.language.groups))


def _size(path: Path) -> int:
    """Bytes of a file, or of all files in a folder (or beside a meta.json)."""
    folder = path if path.is_dir() else path.parent if path.name in ("meta.json", "lod-meta.json") else None
    return path.stat().st_size if folder is None else sum(p.stat().st_size for p in folder.rglob("*") if p.is_file())
