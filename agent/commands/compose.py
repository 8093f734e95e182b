"""`scenewright compose "TEXT" -o graph.json --scene shop.ply`: make a scene from a sentence or a scene graph."""

from __future__ import annotations

import json
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ...gaussians.timing import timed
from ..options import Assets, Budget, Debug, Effort, Force, Json, Planner, Seed, Size, View, Window
from ..terminal.effort import dialled, tell
from ..terminal.output import terminal

if TYPE_CHECKING:
    from ...gaussians.effort import Dial
    from ...gaussians.scene import Scene
    from ...planners.rooms.build import Built
    from ...planners.rooms.graph import SceneGraph

_MAX_VIOLATIONS = 12  # violations printed on stderr; further ones are only counted


@dataclass(frozen=True)
class _Targets:
    """The files to write, and the view and size of the picture."""

    graph: Path | None
    scene: Path | None
    picture: Path | None
    force: bool
    view: str = "auto"
    size: str | None = None


def command(
    wish: Annotated[
        str,
        typer.Argument(metavar="TEXT|GRAPH.json", help="Description of the room, or a scene graph to build unchanged."),
    ],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="FILE", help="File for the scene graph (.json).")
    ] = None,
    scene: Annotated[
        Path | None, typer.Option("--scene", metavar="FILE", help="File for the scene (.ply); its field is saved too.")
    ] = None,
    picture: Annotated[
        Path | None, typer.Option("--picture", metavar="FILE", help="File for a picture of the scene (.png).")
    ] = None,
    assets: Assets = None,
    best: Annotated[
        bool, typer.Option("--best", help="Write the best plausible scene even if wishes conflict.")
    ] = False,
    detail: Annotated[float, typer.Option("--detail", help="Factor on the number of Gaussians, 0.05 to 8.")] = 1.0,
    planner: Planner = "auto",
    effort: Effort = None,
    budget: Budget = None,
    window: Window = None,
    seed: Seed = 0,
    view: View = "auto",
    size: Size = None,
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Compose a room: things, sizes and relations from words, positions from a layout solver, Gaussians from assets.

    With --json the scene graph goes to stdout. If the wishes cannot all be met, the smallest conflict is printed and
    the exit code is 3; --best writes the scene that meets as many as possible.
    """
    started = time.perf_counter()
    dial = dialled(effort, started)
    targets = _Targets(output, scene, picture, force, view, size)
    _check_paths(targets, assets)
    seconds: dict[str, float] = {}
    with timed(seconds, "compose"):
        graph, unmet = _graph(wish, seed, planner, budget, best, dial)
    with timed(seconds, "check"):
        _print_violations(graph, unmet)
    built = None
    if targets.scene is not None or targets.picture is not None:
        from ...planners.rooms.build import construct

        built = construct(graph, seed=seed, assets=assets, detail=detail)
        seconds |= built.seconds
        for note in built.notes:
            terminal.say(f"note: {note}")
        terminal.say(f"built {len(built.ids)} things of {len(built.scene.cloud):,} Gaussians")
    with timed(seconds, "write"):
        _write(graph, built, targets)
    seconds["total"] = time.perf_counter() - started
    terminal.result(_summary(graph), graph.model_dump(mode="json", exclude_none=True))
    tell(dial, always=True)  # the JSON is the graph alone
    terminal.say("seconds: " + ", ".join(f"{stage} {value:.2f}" for stage, value in seconds.items()))


def _check_paths(targets: _Targets, assets: str | None) -> None:
    """Check before the work that all files can be written and the folder of assets exists. Raises UserError if a file
    would be overwritten, has the wrong suffix or no folder; or there is no folder of assets."""
    from ...gaussians.errors import UserError
    from ...planners.rooms.own_assets import DREAM
    from ..output_files import refuse_existing, require_png

    wanted = [path for path in (targets.graph, targets.scene, targets.picture) if path is not None]
    refuse_existing(wanted, targets.force)
    if targets.picture is not None:
        require_png(targets.picture)
    if targets.graph is not None and targets.graph.suffix.lower() != ".json":
        raise UserError(f"{targets.graph}: -o writes the scene graph as .json; a scene is written with --scene")
    for path in wanted:
        if not path.absolute().parent.is_dir():
            raise UserError(f"there is no folder {path.parent}; make it, or write {path.name} elsewhere")
    if assets is not None and not assets.startswith(DREAM) and not Path(assets).is_dir():
        raise UserError(f"{assets} is not a folder; give one that holds .glb or .ply files")


def _graph(
    wish: str, seed: int, planner: str, budget: str | None, best: bool, dial: Dial | None
) -> tuple[SceneGraph, int]:
    """The given graph, or one composed from the words, and how many of their wishes are not met; prints what was
    assumed, left out and not met."""
    from ...planners.rooms.graph import SceneGraph

    if wish.lower().endswith(".json"):
        return SceneGraph.read(Path(wish)), 0
    from ...planners.compose.api import composed

    composition = composed(wish, seed=seed, planner=planner, budget=budget, dial=dial)
    for remark in composition.remarks:
        terminal.say(f"note: {remark}")
    layout = composition.layout
    if layout.left_out:
        label = {item.id: item.label for item in composition.problem.items}
        terminal.say(f"left out, as there is no room: {', '.join(f'{label[i]} ({i})' for i in layout.left_out)}")
    if layout.conflicts and not best:
        _refuse_conflict(layout.conflicts, layout.graph)
    for line in composition.unmet:
        terminal.say(f"not as said: {line}")
    for conflict in layout.conflicts:
        terminal.say(f"not possible together: {'; '.join(conflict.statements)}")
    return layout.graph, len(composition.unmet)


def _refuse_conflict(conflicts: Any, graph: SceneGraph) -> None:
    """Report wishes that cannot all be met: their smallest conflict and the best plausible scene; exit code 3."""
    from ...gaussians.errors import InstructionError

    smallest = min(conflicts, key=lambda conflict: len(conflict.statements))
    statements = "; ".join(smallest.statements)
    error = InstructionError(f"not all of this is possible together: {statements}")
    data = {
        "verdict": "impossible",
        "reason": str(error),
        "exit_code": error.exit_code,
        "conflicts": [conflict.model_dump(mode="json") for conflict in conflicts],
        "best": graph.model_dump(mode="json", exclude_none=True),
    }
    if not terminal.as_json:
        terminal.say(f"the best plausible scene has {_counted(graph)}; --best writes it")
    terminal.refuse(error, data)


def _print_violations(graph: SceneGraph, unmet: int) -> None:
    """Print the violations that the checker finds in the graph; `unmet`: wishes that are listed above as not met."""
    from ...planners.rooms.check import check, sentences

    report = check(graph)
    lines = sentences(report.violations)
    for line in lines[:_MAX_VIOLATIONS]:
        terminal.say(f"check: {line}")
    more = f" ({len(lines) - _MAX_VIOLATIONS} more are not shown)" if len(lines) > _MAX_VIOLATIONS else ""
    sound = f"nothing collides or floats, {unmet} not as said" if unmet else "nothing is wrong"
    terminal.say(f"check: {len(lines)} things are wrong{more}" if lines else f"check: {_counted(graph)}; {sound}")


def _write(graph: SceneGraph, built: Built | None, targets: _Targets) -> None:
    """Write the requested files, each completely or not at all."""
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
    """The size of the room, then one line for each thing: id, size, position, yaw and support."""
    lines = [_counted(graph)]
    for node in graph.nodes:
        what = " ".join(word for word in (node.color, node.label or "thing") if word)
        where = ", ".join(f"{c:+.2f}" for c in node.position)
        size = " x ".join(f"{side:.2f}" for side in node.size)
        on = node.support if isinstance(node.support, str) else f"({node.support})"
        lines.append(f"  ({node.id}) {what}: {size} m at {where}, {node.yaw:.0f}°, on {on}")
    return "\n".join(lines)
