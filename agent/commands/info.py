"""`scenewright info SCENE`: print the contents of a scene file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .. import startup
from ..options import Capture, Debug, Json, SceneFile
from ..terminal.output import terminal

if TYPE_CHECKING:
    from ...gaussians.language.field.language_field import LanguageField
    from ...gaussians.scene import Scene


def command(
    scene: SceneFile,
    graph: Annotated[
        bool, typer.Option("--graph", help="Print its scene graph as JSON instead; the scene must be embedded.")
    ] = False,
    budget: Annotated[
        bool,
        typer.Option("--budget", help="Measure what each part of the model takes, and what pictures lose without it."),
    ] = False,
    capture: Capture = None,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Print the contents of a scene file: format, Gaussians, frame, cameras, repairs, and things if it is embedded;
    of a .lod also its levels.

    With --budget, what each part of its model buys: harmonics, Gaussians, things, views and the language field, with
    the bytes that dropping it saves and the PSNR or names that are left; --capture gives the views for it.
    """
    from ...gaussians.errors import UserError
    from ...gaussians.files import load_with_report
    from ...gaussians.language.field.store import load_field
    from ...gaussians.tiles.store import is_tiles
    from ..streaming import levels_of
    from ..terminal.motion_text import motion_data

    startup.end()
    if capture is not None and not budget:
        raise UserError("--capture gives the views of --budget; add --budget or leave it out")
    if is_tiles(scene) and not (budget or graph):
        _show_tiles(scene)
        return
    loaded, report = load_with_report(scene)
    loaded = load_field(loaded, scene) or loaded
    if budget:
        _show_budget(loaded, capture)
        return
    if graph:
        from ...planners.rooms.graph import SceneGraph

        nodes = SceneGraph.from_scene(loaded).model_dump(mode="json", exclude_none=True)
        terminal.result(json.dumps(nodes, indent=1, ensure_ascii=False), nodes)
        return
    cloud, frame = loaded.cloud, loaded.frame
    low, high = (getattr(cloud.means, f)(dim=0).values.tolist() for f in ("min", "max"))
    levels_text, levels = levels_of(scene)
    data: dict[str, Any] = {
        "path": str(scene),
        "format": report.format,
        "gaussians": len(cloud),
        "degree": cloud.degree,
        "megabytes": round(cloud.nbytes / 1e6, 1),
        "bounds": [low, high],
        "up": [frame.up, frame.up_source],
        "floor": frame.floor,
        "metres_per_unit": [frame.metres_per_unit, frame.scale_source],
        "cameras": [{"name": c.name, "size": [c.width, c.height]} for c in loaded.cameras],
        "notes": list(report.notes),
        "levels": levels,
        "motion": motion_data(loaded),
        "language": None,
    }
    data["language"], things_text = _things(loaded.language)
    terminal.result("\n".join([*_lines(data), *levels_text, things_text]), data)


def _things(language: LanguageField | None) -> tuple[dict[str, Any] | None, str]:
    """The things of a scene as data and as lines."""
    from dataclasses import asdict

    from ..terminal.thing_names import describe_things

    if language is None:
        return None, "  not embedded yet: run `scenewright embed`"
    shown = [g for g in language.objects() if g.count]
    things = [{"group": g.id, "label": g.label, "sure": round(g.label_score, 3), "count": g.count} for g in shown]
    making = language.making
    data = {
        "encoder": language.encoder, "things": things, "notes": list(language.notes),
        "making": None if making is None else asdict(making),
    }  # fmt: skip
    made = [f"embedded with {language.encoder}"] if making is None else making.lines()
    return data, "\n".join(f"  {line}" for line in (describe_things(shown), *made))


def _show_tiles(path: Path) -> None:
    """Print the contents of a scene in tiles; no tile is read."""
    from ...gaussians.tiles.records import row_bytes
    from ...gaussians.tiles.store import Tiles

    tiles = Tiles.open(path)
    low, high = tiles.bounds
    size = len(tiles) * row_bytes(tiles.state.degree)
    frame, edits = tiles.frame, [step.text for step in (*tiles.head.past, tiles.head.present) if step.text]
    data: dict[str, Any] = {
        "path": str(path),
        "format": "tiles",
        "gaussians": len(tiles),
        "degree": tiles.state.degree,
        "megabytes": round(size / 1e6, 1),
        "bounds": [low.tolist(), high.tolist()],
        "up": [frame.up, frame.up_source],
        "floor": frame.floor,
        "metres_per_unit": [frame.metres_per_unit, frame.scale_source],
        "cameras": [{"name": c.name, "size": [c.width, c.height]} for c in tiles.cameras],
        "notes": list(tiles.state.notes),
        "tiles": [{"gaussians": tile.rows, "low": tile.low, "high": tile.high} for tile in tiles.state.tiles],
        "edits": edits,
        "undone": [step.text for step in reversed(tiles.head.future)],
        "motion": None,
    }
    data["language"], things_text = _things(tiles.field)
    rows = [tile.rows for tile in tiles.state.tiles]
    more = [f"  {len(rows)} tiles of {min(rows):,} to {max(rows):,} Gaussians"]
    more += [f"  {len(edits)} edits, the last: {edits[-1]}"] if edits else []
    terminal.result("\n".join([*_lines(data), *more, things_text]), data)


def _show_budget(loaded: Scene, capture: Path | None) -> None:
    """Measure and print what each part of the model buys."""
    from dataclasses import asdict

    from ...gaussians.errors import BackendError
    from ...gaussians.files.captures.capture import read_capture
    from ...gaussians.language import encoders
    from ...gaussians.slim.budget import budget
    from ..terminal.budget_table import budget_text

    cameras = () if capture is None else read_capture(capture).cameras
    encoder, language = None, loaded.language
    if language is not None:
        try:
            encoder = encoders.load("auto" if language.making is None else language.making.encoder)
        except BackendError as error:
            terminal.say(f"note: the things are not named again with shorter vectors: {error}")
    found = budget(loaded, cameras, encoder, progress=terminal.progress)
    terminal.result(budget_text(found), asdict(found))


def _lines(data: dict[str, Any]) -> list[str]:
    from ..terminal.motion_text import motion_lines

    low, high = data["bounds"]
    span = " x ".join(f"{b - a:.2f}" for a, b in zip(low, high, strict=True))
    scale, source = data["metres_per_unit"]
    return [
        f"{data['path']}: {data['format']}",
        f"  {data['gaussians']:,} Gaussians, harmonics of degree {data['degree']}, {data['megabytes']} MB in memory",
        f"  extent {span} units; " + (f"{scale:g} m a unit ({source})" if scale else "scale unknown"),
        f"  up {tuple(round(c, 3) for c in data['up'][0])} ({data['up'][1]})",
        f"  {len(data['cameras'])} cameras",
        *motion_lines(data["motion"]),
        *(f"  repaired: {note}" for note in data["notes"]),
    ]
