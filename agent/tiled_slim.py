"""`slim` of a scene in tiles that does not fit into memory, and folders of tiles as what `slim` writes."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .terminal.output import terminal

if TYPE_CHECKING:
    from ..gaussians.camera import Camera
    from ..gaussians.scene import Scene
    from ..gaussians.slim import Settings
    from ..gaussians.tiles.slimming import SlimmedTiles
    from ..gaussians.tiles.store import Tiles

SUFFIX = ".tiles"


def too_large(scene: Path) -> Tiles | None:
    """A scene in tiles, if `slim` of all of it at once does not fit into the memory."""
    from ..gaussians.tiles import window
    from ..gaussians.tiles.budget import memory
    from ..gaussians.tiles.store import Tiles, is_tiles

    if not is_tiles(scene):
        return None
    tiles = Tiles.open(scene)
    return None if window.fits(tiles, len(tiles), memory()) else tiles


def refuse_whole(tiles: Tiles, target: Path, settings: Settings) -> None:
    """Check that what is asked for can be made part by part.

    Raises:
        UserError: it needs all of the scene at once; the message says what to do.
    """
    from ..gaussians.errors import UserError
    from ..gaussians.slim.loss import EXACT
    from ..gaussians.tiles import exporting, window

    size = window.needed(tiles, len(tiles)) / 1e9
    if settings.psnr >= EXACT:
        ply = f"{target.stem}.ply"
        raise UserError(
            f"nothing becomes smaller at this PSNR; write it as it is: scenewright convert {tiles.folder} {ply}"
        )
    if settings.steps or settings.seconds:
        raise UserError(
            f"--optimise needs the whole scene, about {size:.1f} GB of memory here; leave it out, or allow it with "
            f"--memory {size + 1:.0f}GB"
        )
    if target.suffix.lower() != SUFFIX and not exporting.is_streamed(target):
        raise UserError(
            f"{target.name} is encoded as a whole, which takes about {size:.1f} GB of memory here: allow it with "
            f"--memory {size + 1:.0f}GB, or slim to tiles or .ply, which are written part by part: "
            f"-o {target.stem}{SUFFIX}. For SOG, write levels of detail of these: "
            f"scenewright convert {target.stem}{SUFFIX} {target.stem}.lod"
        )


def slim_by_parts(
    tiles: Tiles, target: Path, settings: Settings, cameras: Sequence[Camera], force: bool
) -> tuple[SlimmedTiles, Path | None]:
    """Write the scene smaller, as tiles or .ply; returns what was made and the path of its language field."""
    from ..gaussians.tiles.budget import memory
    from ..gaussians.tiles.exporting import write_field, write_ply
    from ..gaussians.tiles.slimming import slim_tiles

    if target.suffix.lower() == SUFFIX:
        done = slim_tiles(tiles, target, settings, memory(), cameras, force, terminal.progress)
        return done, None if done.tiles.field is None else target / "tables"
    with tempfile.TemporaryDirectory(dir=target.absolute().parent, prefix=f".{target.name[:100]}.") as folder:
        done = slim_tiles(tiles, Path(folder) / "a.tiles", settings, memory(), cameras, False, terminal.progress)
        write_ply(done.tiles, target, force, terminal.progress)
        return done, write_field(done.tiles, target)


def write_tiles(scene: Scene, data: bytes, target: Path, force: bool) -> Path | None:
    """Write a slimmed scene, whose .ply has these bytes, as a folder of tiles; returns where its language field is."""
    from ..gaussians.language.field.store import save_field
    from ..gaussians.tiles.making import make

    with tempfile.TemporaryDirectory(dir=target.absolute().parent, prefix=f".{target.name[:100]}.") as folder:
        path = Path(folder) / f"{target.stem}.ply"
        path.write_bytes(data)
        if scene.language is not None:
            save_field(scene, path)
        made = make([path], target, force=force)
    return None if made.field is None else target / "tables"


def size_of(path: Path) -> int:
    """Bytes of a file, or of all files in a folder."""
    return path.stat().st_size if path.is_file() else sum(p.stat().st_size for p in path.rglob("*") if p.is_file())


def described(done: SlimmedTiles, tiles: Tiles, target: Path, psnr: float) -> dict[str, Any]:
    """What was made, under the keys that `slim` of a scene in memory has, and what each part keeps."""
    from dataclasses import asdict

    from ..gaussians.slim.report import row_bytes_of

    plain, size = len(tiles) * row_bytes_of(tiles.state.degree), size_of(target)
    field = done.tiles.field
    objects = None if field is None else field.objects()
    return {
        "path": str(target),
        "from": str(tiles.folder),
        "promised_psnr": psnr,
        "gaussians": len(done.tiles),
        "gaussians_before": len(tiles),
        "bytes": size,
        "bytes_as_ply": plain,
        "times_smaller": round(plain / size, 2),
        "bytes_before": size_of(tiles.folder),
        "held_out": asdict(done.held_out),
        "parts": [None if loss is None else asdict(loss) for loss in done.parts],
        "orbit": asdict(done.orbit) if done.orbit else None,
        "raised": done.raised,
        "cameras": done.cameras,
        "things": None if objects is None else (sum(g.count > 0 for g in objects), len(objects)),
        "same_thing": done.same_thing,
    }


def told(data: dict[str, Any]) -> str:
    """The same for a person."""
    count, loss, parts = data["gaussians"], data["held_out"], [part for part in data["parts"] if part]
    unseen = len(data["parts"]) - len(parts)
    lines = [
        f"{data['path']}: {count:,} of {data['gaussians_before']:,} Gaussians, chosen in {len(data['parts'])} parts",
        f"size: {data['bytes']:,} bytes, {data['times_smaller']:g} times smaller than as .ply "
        f"({data['bytes_as_ply']:,}), {data['bytes'] / count:.1f} a Gaussian",
        _pictures(loss, min(part["psnr"] for part in parts), data) if parts else "pictures: no view shows a part",
        f"views: {data['cameras']}, {loss['views']} held out and drawn of the whole scene",
        *([f"parts that no view shows, kept whole: {unseen}"] if unseen else []),
    ]
    if (things := data["things"]) is not None:
        same = "" if data["same_thing"] is None else f"; {data['same_thing']:.2%} of the pixels show the same thing"
        lines.append(f"language field: {things[0]} of {things[1]} things kept{same}, written to {data['field']}")
    return "\n".join([*lines, f"time: {data['seconds']} s"])


def _pictures(loss: dict[str, Any], least: float, data: dict[str, Any]) -> str:
    raised = f"; parts got more Gaussians {data['raised']} times for them" if data["raised"] else ""
    return (
        f"pictures: {loss['psnr']:.2f} dB over {loss['views']} held-out views, {least:.2f} dB over those of the worst "
        f"part, {data['promised_psnr']:g} promised{raised}"
    )
