"""bench scale: scenes in tiles from one to a hundred million Gaussians: seconds, memory, and what an edit touches;
rooms embedded by blocks; and a scene that is made smaller part by part.

Copies of a composed room stand on a grid; one room is different, and its piano and its bicycle are the only ones. The
files lie in a temporary folder (TMPDIR chooses the disk: 22 GB for a hundred million) and are removed.
"""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch

from ..gaussians.cloud import GaussianCloud
from ..gaussians.language.field.loading import load
from ..gaussians.render import render
from ..gaussians.tiles.drawing import draw
from ..gaussians.tiles.records import row_bytes
from ..gaussians.tiles.store import Tiles
from ..gaussians.tiles.window import WORKING
from ._scale import blocks, slimming
from ._scale import grid as grids
from ._scale.grid import DELETED, RECOLORED, Grid
from ._scale.measured import Run, command, size_of
from .harness import Metric, Point, Result

EMBED = "embed"
SLIM = "slim"
PARTS = ("1M", "2M", "10M", "100M", EMBED, SLIM)
SIZES = {"1M": 10**6, "2M": 2 * 10**6, "10M": 10**7, "100M": 10**8}
QUICK = 3 * 10**5
COMPARED = "2M"  # edited and drawn in memory too
WIDTH, HEIGHT = 1920, 1080
MEMORY = "3GB"  # for the work; with the program and its libraries it has to stay below the goal
GOAL_MEMORY = 4 * 2**30
GOAL_PSNR, MOST_PSNR = 100.0, 200.0  # dB; equal pictures count as the latter
EDITS = {"recolor": f"make the {RECOLORED} teal", "delete": f"delete the {DELETED}"}


def run(quick: bool, parts: Sequence[str] = ()) -> Result:
    """Measure every size, or some of them."""
    wanted = parts or PARTS
    sizes = {name: SIZES[name] for name in wanted if name in SIZES}
    if quick and sizes:
        sizes = {"300k": QUICK}
    metrics: list[Metric] = []
    points: list[Point] = []
    if EMBED in wanted:
        with tempfile.TemporaryDirectory(prefix="scenewright-scale-") as place:
            metrics += blocks.measured(Path(place), blocks.SEEDS[:1] if quick else blocks.SEEDS)
    if SLIM in wanted:
        with tempfile.TemporaryDirectory(prefix="scenewright-scale-") as place:
            metrics += slimming.measured(QUICK if quick else SIZES["1M"], row_bytes(0) * WORKING, Path(place))
    for name, rows in sizes.items():
        with tempfile.TemporaryDirectory(prefix="scenewright-scale-") as place:
            found, curve = _size(name, rows, Path(place), quick or name == COMPARED)
        metrics += found
        points += curve
    notes = (
        "each figure is of a process of its own, from its start, imports and encoder included",
        f"--memory {MEMORY}; memory is the peak of resident memory, with the pages of files that were mapped",
        "untouched: tiles whose files an edit does not replace, and whose bytes were compared before and after",
        f"pictures: {WIDTH}x{HEIGHT} from inside the different room, and of the whole grid from above",
    )
    title = "scenes in tiles: seconds, memory, and what an edit touches"
    return Result(title, "millions of Gaussians", tuple(metrics), tuple(points), notes)


def _size(name: str, rows: int, place: Path, compared: bool) -> tuple[list[Metric], list[Point]]:
    """The figures of one size; the scene is written to `place`."""
    grid = grids.made(rows)
    source, folder = place / "grid.ply", place / "grid.tiles"
    grids.write(grid, source)
    runs = {"tile": command("tile", source, "-o", folder, "--memory", MEMORY)}
    tiles = Tiles.open(folder)
    first, size = tiles.digest(), size_of(folder)
    if not compared:
        source.unlink()  # room on the disk
    runs["info"] = command("info", folder)
    runs["select"] = command("select", folder, f"the {RECOLORED}", "--memory", MEMORY)
    written: dict[str, int] = {}
    for kind, words in EDITS.items():
        before = size_of(folder)
        runs[kind] = command("edit", folder, words, "--memory", MEMORY)
        written[kind] = size_of(folder) - before
    edited = Tiles.open(folder)
    same = _same_files(tiles, edited)
    for view, camera in (("inside", grid.inside(WIDTH, HEIGHT)), ("above", grid.overview(WIDTH, HEIGHT))):
        spot = ",".join(f"{float(c):.4f}" for c in camera.position)
        aim = ",".join(f"{float(c):.4f}" for c in camera.position + camera.forward)
        shot = ("--view", f"{spot}:{aim}", "--size", f"{WIDTH}x{HEIGHT}", "--memory", MEMORY)
        runs[f"render.{view}"] = command("render", folder, "-o", place / f"{view}.png", *shot)
    likeness = _likeness(grid, source, edited) if compared else []
    runs["undo"] = command("edit", folder, "--undo")
    runs["undo.again"] = command("edit", folder, "--undo")
    undone = Tiles.open(folder).digest() == first
    metrics = [
        Metric(f"{name}.rows", len(tiles), "count"),
        Metric(f"{name}.tiles", len(tiles.state.tiles), "count"),
        Metric(f"{name}.bytes a row", size / len(tiles), "B"),
        Metric(f"{name}.undo to the same hashes", float(undone), "1", "higher", goal=1.0),
        Metric(f"{name}.untouched tiles with the same bytes", same, "1", "higher", goal=1.0),
        Metric(f"{name}.tiles that two edits touched", _touched(tiles, edited), "count", "lower"),
        *(Metric(f"{name}.{kind}.written", count / 1e6, "MB") for kind, count in written.items()),
        *likeness,
    ]
    for kind, taken in runs.items():
        metrics += _figures(f"{name}.{kind}", taken)
    peak = max(taken.bytes for taken in runs.values())
    metrics.append(Metric(f"{name}.memory", peak / 2**30, "GiB", "lower", 0.1, GOAL_MEMORY / 2**30))
    points = [Point(kind, name, taken.seconds, len(tiles) / 1e6, taken.bytes) for kind, taken in runs.items()]
    return metrics, points


def _figures(key: str, taken: Run) -> list[Metric]:
    return [
        Metric(f"{key}.seconds", taken.seconds, "s", "lower", 0.3),
        Metric(f"{key}.processor", taken.processor, "s", "lower", 0.2),
        Metric(f"{key}.memory", taken.bytes / 2**30, "GiB", "lower", 0.1),
    ]


def _touched(before: Tiles, after: Tiles) -> int:
    """How many tiles have other files."""
    pairs = zip(before.state.tiles, after.state.tiles, strict=False)
    return sum(old != new for old, new in pairs) + len(after.state.tiles) - len(before.state.tiles)


def _same_files(before: Tiles, after: Tiles) -> float:
    """1 if each tile that is named as before still has the bytes that its hash says, read anew; else 0."""
    kept = [new for old, new in zip(before.state.tiles, after.state.tiles, strict=False) if old == new]
    for tile in kept:
        for stored in tile.columns.values():
            if hashlib.sha256((after.folder / "tiles" / stored.file).read_bytes()).hexdigest() != stored.sha256:
                return 0.0
    return float(len(kept) + _touched(before, after) == len(after.state.tiles))


def _likeness(grid: Grid, source: Path, edited: Tiles) -> list[Metric]:
    """The same edits in memory: whether the rows have the same bytes, and the likeness of pictures."""
    from ..agent.session.session import Session

    scene = load(source)
    for words in EDITS.values():
        session = Session(scene, planner="grammar")
        session.do(words)
        scene = session.scene.replace(painted=None)  # as in a scene that was saved and loaded between the edits
    known, found = scene.cloud, edited.every_row()
    camera = grid.inside(WIDTH, HEIGHT)
    pictures = (render(known, camera).rgb, draw(edited, camera).render.rgb)
    return [
        Metric("edited as in memory", float(_equal(known, found)), "1", "higher", goal=1.0),
        Metric("picture as in memory", _psnr(*pictures), "dB", "higher", goal=GOAL_PSNR),
    ]


def _equal(one: GaussianCloud, other: GaussianCloud) -> bool:
    return all(torch.equal(column, getattr(other, name)) for name, column in one.columns())


def _psnr(one: torch.Tensor, other: torch.Tensor) -> float:
    error = float(((one.double() - other.double()) ** 2).mean())
    return MOST_PSNR if error == 0 else min(MOST_PSNR, -10 * float(np.log10(error)))
