"""`scenewright slim SCENE -o OUT --psnr 40`: make a scene file smaller without losing more than promised."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from .. import startup
from ..options import Capture, Debug, Effort, Force, Json, Memory, SceneFile
from ..terminal.effort import dialled, reported, tell
from ..terminal.output import terminal

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ...gaussians.scene import Scene
    from ...gaussians.slim import Slimmed

FORMATS = (".compressed.ply", ".ply", ".spz", ".sog", ".splat", ".tiles")  # longest first where one ends with another


def command(
    scene: SceneFile,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="OUT", help="File to write.")],
    psnr: Annotated[
        float,
        typer.Option("--psnr", metavar="DB", help="PSNR that held-out views keep; 'inf' keeps every bit (.ply)."),
    ] = 40.0,
    format: Annotated[
        Literal["ply", "compressed.ply", "spz", "sog", "splat", "tiles"] | None,
        typer.Option("--format", help="File format, if the name of OUT does not say it; sog is the smallest."),
    ] = None,
    capture: Capture = None,
    optimise: Annotated[
        str | None,
        typer.Option(
            "--optimise",
            metavar="LENGTH",
            help="Then optimise fewer Gaussians for so long: seconds as in 120, or 600steps (same bytes every run).",
        ),
    ] = None,
    size: Annotated[
        int, typer.Option("--pixels", min=64, max=2048, metavar="N", help="Longer side of the compared pictures.")
    ] = 512,
    ids: Annotated[
        Path | None,
        typer.Option("--ids", metavar="FILE", help="Write for each row of OUT its row number in SCENE (.npy)."),
    ] = None,
    effort: Effort = None,
    memory: Memory = None,
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Make a scene file smaller without losing more than promised.

    Gaussians that show least are left out, then higher harmonics; values are rounded where the format packs them. The
    strength is chosen by some views and the promise is measured from others: with --capture from the cameras of
    photographs, without it from computed views around and inside the scene, and from an orbit. A language field is
    kept: groups, names and vectors stay, and the field is written beside OUT.

    A scene in tiles that does not fit into the memory is made smaller part by part, to tiles (-o NAME.tiles) or .ply.
    Every part keeps the promise in views of it, which are drawn of the whole scene.
    """
    started = time.perf_counter()
    from ...gaussians.files.captures.capture import read_capture
    from ...gaussians.language.field.loading import load
    from ...gaussians.language.field.store import field_path
    from ...gaussians.slim import Settings, slim
    from ..output_files import refuse_existing, require_folder
    from ..tiled_slim import described, refuse_whole, slim_by_parts, told, too_large

    startup.end()
    dial = dialled(effort, started)
    target = named(output, format)
    settings = Settings(psnr, size, *_length(optimise))
    require_folder(target)
    refuse_existing([target, field_path(target), *([ids] if ids else [])], force)
    cameras = () if capture is None else read_capture(capture).cameras
    if (tiles := too_large(scene)) is not None:
        refuse_whole(tiles, target, settings)
        if dial is not None:
            dial.choose("slim", len(tiles))
        parted, field = slim_by_parts(tiles, target, settings, cameras, force)
        kept = _write_ids(parted.ids, ids, force)
        data = described(parted, tiles, target, psnr) | {"field": str(field) if field else None} | kept
        text = told
    else:
        loaded = load(scene)
        done = slim(loaded, _suffix(target), settings, cameras, terminal.progress, effort=dial)
        paths = _write(done, target, ids, force)
        data, text = _data(done, loaded, scene, target, psnr) | paths, _text
    terminal.clear()
    data |= {"seconds": round(time.perf_counter() - started, 2)}
    terminal.result(text(data), data | reported(dial))
    tell(dial)


def _length(text: str | None) -> tuple[int | None, float | None]:
    """Steps or seconds of an optimisation.

    Raises:
        UserError: the text is neither.
    """
    from ...gaussians.errors import UserError

    if text is None:
        return None, None
    word = text.strip().lower()
    try:
        return (int(word.removesuffix("steps")), None) if word.endswith("steps") else (None, float(word.rstrip("s")))
    except ValueError:
        raise UserError(f"--optimise takes seconds or steps, as in 120 or 600steps, not {text!r}") from None


def named(output: Path, format: str | None) -> Path:
    """The path of the file with its suffix.

    Raises:
        UserError: the name says another format than `format`, or neither says one.
    """
    from ...gaussians.errors import UserError

    if output.suffix.lower() == ".lod":
        raise UserError(
            f"{output.name} would hold levels, which only `scenewright convert` makes: slim to {output.stem}.ply, then "
            f"`scenewright convert {output.stem}.ply {output.name}`"
        )
    known = next((suffix for suffix in FORMATS if output.name.lower().endswith(suffix)), None)
    if known is not None:
        if format is not None and known != f".{format}":
            raise UserError(f"{output.name} is a {known} file and --format says {format}; change one of them")
        return output
    if format is None:
        raise UserError(f"{output.name} does not say its format; name it {output.name}.sog or add --format sog")
    return output.with_name(f"{output.name}.{format}")


def _suffix(path: Path) -> str:
    """The format that is measured: tiles keep every bit, as .ply does."""
    suffix = next(suffix for suffix in FORMATS if path.name.lower().endswith(suffix))
    return ".ply" if suffix == ".tiles" else suffix


def _write(done: Slimmed, target: Path, ids: Path | None, force: bool) -> dict[str, Any]:
    """Write the scene, its language field, and the row numbers; returns the paths of the latter two."""
    from ...gaussians.errors import UserError
    from ...gaussians.files import writing
    from ...gaussians.files.motion_file import save_motion
    from ...gaussians.language.field.store import save_field
    from ..tiled_slim import write_tiles

    field = None
    if target.name.lower().endswith(".tiles"):
        if done.scene.motion is not None:
            raise UserError("a scene in tiles stands still: it keeps no motion; write another format")
        field = write_tiles(done.scene, done.data, target, force)
    else:
        with writing(target, force) as file:
            file.write(done.data)
        save_motion(done.scene, target)
        field = None if done.scene.language is None else save_field(done.scene, target, packed=True)
    return {"field": str(field) if field else None} | _write_ids(done.scene.cloud.ids.cpu().numpy(), ids, force)


def _write_ids(rows: NDArray[np.int64], ids: Path | None, force: bool) -> dict[str, Any]:
    """Write the row numbers if they are asked for."""
    import io

    import numpy as np

    from ...gaussians.files import writing

    if ids is not None:
        stored = io.BytesIO()
        np.save(stored, rows, allow_pickle=False)
        with writing(ids, force) as file:
            file.write(stored.getvalue())
    return {"ids": str(ids) if ids else None}


def _data(done: Slimmed, loaded: Scene, scene: Path, target: Path, psnr: float) -> dict[str, Any]:
    from dataclasses import asdict

    from ...gaussians.slim.report import inria_bytes, things_left
    from ..tiled_slim import size_of

    plain, size = inria_bytes(loaded.cloud), size_of(target)
    return {
        "path": str(target),
        "from": str(scene),
        "promised_psnr": psnr if psnr < float("inf") else None,
        "gaussians": len(done.scene.cloud),
        "gaussians_before": len(loaded.cloud),
        "bytes": size,
        "bytes_as_ply": plain,
        "times_smaller": round(plain / size, 2),
        "strength": asdict(done.strength) if done.strength else None,
        "held_out": asdict(done.held_out) if done.held_out else None,
        "choice": asdict(done.choice) if done.choice else None,
        "format_alone": asdict(done.alone) if done.alone else None,
        "raised": done.raised,
        "cameras": done.cameras,
        "steps": done.steps,
        "things": things_left(done.scene),
        "same_thing": done.same_thing,
    }


def _text(data: dict[str, Any]) -> str:
    count, before = data["gaussians"], data["gaussians_before"]
    lines = [
        f"{data['path']}: {count:,} of {before:,} Gaussians",
        f"size: {data['bytes']:,} bytes, {data['times_smaller']:g} times smaller than as .ply "
        f"({data['bytes_as_ply']:,}), {data['bytes'] / count:.1f} a Gaussian",
    ]
    if (strength := data["strength"]) is not None:
        kept = [f"harmonics of degree {strength['degree']}"]
        kept += [f"{strength['dull']:.0%} of the Gaussians without their higher bands"] if strength["dull"] else []
        kept += [f"{strength['sets']:,} sets of higher coefficients"] if strength["sets"] else []
        kept += [f"optimised in {data['steps']} steps"] if data["steps"] else []
        kept += ["values rounded"] if strength["rounding"] else []
        lines.append("kept: " + ", ".join(kept))
    if (loss := data["held_out"]) is None:
        lines.append("pictures: every bit is kept")
    else:
        raised = f"; a weaker setting was taken {data['raised']} times for them" if data["raised"] else ""
        lines += [
            f"pictures: {loss['psnr']:.2f} dB over {loss['views']} held-out views ({loss['mean']:.1f} on average, "
            f"{loss['worst']:.1f} at worst), {data['promised_psnr']:g} promised{raised}",
            f"views: {data['cameras']}; the format alone keeps {data['format_alone']['psnr']:.1f} dB",
        ]
    if (things := data["things"]) is not None:
        same = "" if data["same_thing"] is None else f"; {data['same_thing']:.2%} of the pixels show the same thing"
        lines.append(f"language field: {things[0]} of {things[1]} things kept{same}, written to {data['field']}")
    return "\n".join([*lines, f"time: {data['seconds']} s"])
