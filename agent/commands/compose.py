"""`scenewright compose "TEXT" -o graph.json --scene shop.ply`: from a sentence, or a scene graph, to a scene."""

from __future__ import annotations

import json
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ...gaussians.timing import timed
from ..options import Debug, Force, Json, Planner, Seed, Size, View
from ..terminal.output import terminal

if TYPE_CHECKING:
    from ...gaussians.scene import Scene
    from ...planners.rooms.build import Built
    from ...planners.rooms.graph import SceneGraph

_MOST_TOLD = 12  # complaints of the checker on stderr; more are counted


@dataclass(frozen=True)
class _Targets:
    """Files that are asked for, and how the picture is taken."""

    graph: Path | None
    scene: Path | None
    picture: Path | None
    force: bool
    view: str = "auto"
    size: str | None = None


def command(
    wish: Annotated[
        str,
        typer.Argument(
            metavar="TEXT|GRAPH.json", help="What the room is to be, or a scene graph to be built as it is."
        ),
    ],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="FILE", help="Where to write the scene graph (.json).")
    ] = None,
    scene: Annotated[
        Path | None, typer.Option("--scene", metavar="FILE", help="Where to write the scene (.ply), embedded already.")
    ] = None,
    picture: Annotated[
        Path | None, typer.Option("--picture", metavar="FILE", help="Where to write a picture of it (.png).")
    ] = None,
    assets: Annotated[
        Path | None, typer.Option("--assets", metavar="FOLDER", help="Take things from .glb and .ply files there.")
    ] = None,
    best: Annotated[
        bool, typer.Option("--best", help="Write the best plausible scene even where wishes conflict.")
    ] = False,
    detail: Annotated[float, typer.Option("--detail", help="Factor on the number of Gaussians, 0.05 to 8.")] = 1.0,
    planner: Planner = "auto",
    seed: Seed = 0,
    view: View = "auto",
    size: Size = None,
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Compose a room: things, sizes and relations from words, places from a layout solver, Gaussians from assets.

    With --json the scene graph goes to stdout. Wishes that cannot all be met end with exit code 3 and their smallest
    conflict; --best then takes what can be.
    """
    targets = _Targets(output, scene, picture, force, view, size)
    _refuse_early(targets, assets)
    seconds: dict[str, float] = {}
    started = time.perf_counter()
    with timed(seconds, "compose"):
        graph = _graph(wish, seed, planner, best)
    with timed(seconds, "check"):
        _tell_check(graph)
    built = None
    if targets.scene is not None or targets.picture is not None:
        from ...planners.rooms.build import construct

        built = construct(graph, seed=seed, assets=assets, detail=detail)
        seconds |= built.seconds
        _tell_built(built)
    with timed(seconds, "write"):
        _write(graph, built, targets)
    seconds["total"] = time.perf_counter() - started
    terminal.result(_summary(graph), graph.model_dump(mode="json", exclude_none=True))
    terminal.say("seconds: " + ", ".join(f"{stage} {value:.2f}" for stage, value in seconds.items()))


def _refuse_early(targets: _Targets, assets: Path | None) -> None:
    """Say before the work what cannot be written or read.

    Raises:
        UserError: a file would be overwritten, a picture is none, or there is no folder of assets.
    """
    from ...gaussians.errors import UserError
    from ..output_files import refuse_existing, require_png

    wanted = [path for path in (targets.graph, targets.scene, targets.picture) if path is not None]
    refuse_existing(wanted, targets.force)
    if targets.picture is not None:
        require_png(targets.picture)
    if targets.graph is not None and targets.graph.suffix.lower() != ".json":
        raise UserError(f"{targets.graph} is where the scene graph goes, as .json; a scene is written with --scene")
    for path in wanted:
        if not path.absolute().parent.is_dir():
            raise UserError(f"there is no folder {path.parent}; make it, or write {path.name} elsewhere")
    if assets is not None and not assets.is_dir():
        raise UserError(f"{assets} is no folder; give one that holds .glb or .ply files")


def _graph(wish: str, seed: int, planner: str, best: bool) -> SceneGraph:
    """The graph that was given, or one composed of the words; what was left out and assumed is told."""
    from ...planners.rooms.graph import SceneGraph

    if wish.lower().endswith(".json"):
        return SceneGraph.read(Path(wish))
    from ...planners.compose.api import composed

    composition = composed(wish, seed=seed, planner=planner)
    for remark in composition.remarks:
        terminal.say(f"note: {remark}")
    layout = composition.layout
    if layout.left_out:
        label = {item.id: item.label for item in composition.problem.items}
        terminal.say(f"left out, as there is no room: {', '.join(f'{label[i]} ({i})' for i in layout.left_out)}")
    if layout.conflicts and not best:
        _refuse_conflict(layout.conflicts, layout.graph)
    for conflict in layout.conflicts:
        terminal.say(f"not possible together: {'; '.join(conflict.statements)}")
    return layout.graph


def _refuse_conflict(conflicts: Any, graph: SceneGraph) -> None:
    """Wishes that cannot all be met: the smallest set of them, and what could be had."""
    from ...gaussians.errors import InstructionError

    smallest = min(conflicts, key=lambda conflict: len(conflict.statements))
    said = "; ".join(smallest.statements)
    error = InstructionError(f"not all of this is possible together: {said}")
    data = {
        "verdict": "impossible",
        "reason": str(error),
        "exit_code": error.exit_code,
        "conflicts": [conflict.model_dump(mode="json") for conflict in conflicts],
        "best": graph.model_dump(mode="json", exclude_none=True),
    }
    if not terminal.as_json:
        terminal.say(f"the best plausible scene has {_counted(graph)}; --best takes it")
    terminal.refuse(error, data)


def _tell_check(graph: SceneGraph) -> None:
    """The neutral checker's verdict."""
    from ...planners.rooms.check import check, sentences

    report = check(graph)
    told = sentences(report.violations)
    for line in told[:_MOST_TOLD]:
        terminal.say(f"check: {line}")
    more = f" ({len(told) - _MOST_TOLD} more are not shown)" if len(told) > _MOST_TOLD else ""
    terminal.say(
        f"check: {len(told)} things are wrong{more}" if told else f"check: {_counted(graph)}; nothing is wrong"
    )


def _tell_built(built: Built) -> None:
    for note in built.notes:
        terminal.say(f"note: {note}")
    terminal.say(f"built {len(built.ids)} things of {len(built.scene.cloud):,} Gaussians")


def _write(graph: SceneGraph, built: Built | None, targets: _Targets) -> None:
    """Everything that was asked for, each file whole or not at all."""
    from ...gaussians.files import save, writing

    if targets.graph is not None:
        text = json.dumps(graph.model_dump(mode="json", exclude_none=True), indent=1, ensure_ascii=False)
        with writing(targets.graph, targets.force) as file:
            file.write((text + "\n").encode())
        terminal.say(f"wrote {targets.graph}")
    if built is None:
        return
    if targets.scene is not None:
        from ...gaussians.language.field.store import save_field

        save(built.scene, targets.scene, targets.force)
        field = save_field(built.scene, targets.scene)
        terminal.say(f"wrote {targets.scene} and {field}")
    if targets.picture is not None:
        _draw(built.scene, targets.picture, targets)


def _draw(scene: Scene, path: Path, targets: _Targets) -> None:
    from ...gaussians.color import parse
    from ...gaussians.render import render
    from ..pictures.image_files import save_png
    from ..pictures.named_cameras import choose_view

    camera = choose_view(scene, targets.view, targets.size)
    save_png(render(scene.cloud, camera, parse("#e9ecef")).to_uint8(), path, targets.force)
    terminal.say(f"wrote {path}")


def _counted(graph: SceneGraph) -> str:
    count = len(graph.nodes)
    size = " x ".join(f"{side:.1f}" for side in graph.room.size)
    return f"{count} thing{'s' if count != 1 else ''} in a room of {size} m"


def _summary(graph: SceneGraph) -> str:
    """Who stands where, a line each."""
    lines = [_counted(graph)]
    for node in graph.nodes:
        what = " ".join(word for word in (node.color, node.label or "thing") if word)
        where = ", ".join(f"{c:+.2f}" for c in node.position)
        size = " x ".join(f"{side:.2f}" for side in node.size)
        on = node.support if isinstance(node.support, str) else f"({node.support})"
        lines.append(f"  ({node.id}) {what}: {size} m at {where}, {node.yaw:.0f}°, on {on}")
    return "\n".join(lines)
