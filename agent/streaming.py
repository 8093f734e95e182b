"""Levels of detail on the command line: a `.lod` written by `convert`, told by `info`, and drawn by `render --lod`."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .terminal.output import terminal

if TYPE_CHECKING:
    from ..gaussians.camera import Camera, Render, Vec3
    from ..gaussians.cloud import GaussianCloud
    from ..gaussians.files.formats.streamed_sog import Streamed
    from ..gaussians.levels.making import Level
    from ..gaussians.scene import Scene
    from ..gaussians.tiles.store import Tiles

HELD_OUT = 8  # views that measure
Sizes = tuple[int | None, int | None]  # levels, and most Gaussians of a chunk; None: as many as usual


def is_streamed(path: Path) -> bool:
    """Whether a name asks for levels of detail."""
    return path.suffix.lower() == ".lod" or path.name == "lod-meta.json"


def write_levels(
    scene: Scene, original: GaussianCloud, output: Path, sizes: Sizes, measured: int, force: bool
) -> None:  # fmt: skip
    """Write the scene in levels, with what each keeps in so many held-out views, and print them.

    Args:
        original: what the finest level is compared with; the scene may be a reduced form of it.
    """
    from ..gaussians.files.formats import streamed_sog_writing
    from ..gaussians.files.formats.streamed_sog import Streamed
    from ..gaussians.levels.making import LEVELS, described, make, measure
    from ..gaussians.levels.tree import LEAF_ROWS
    from ..gaussians.slim.views import choose_views, estimated_frame

    start = time.perf_counter()
    terminal.progress("choosing views", 0.0)
    scene = scene.replace(frame=estimated_frame(scene))  # kept, so that no reader estimates it again
    views = choose_views(scene)
    levels, chunk_rows = sizes[0] or LEVELS, sizes[1] or streamed_sog_writing.CHUNK_ROWS
    made = make(scene, levels, views.ranking, min(LEAF_ROWS, chunk_rows), terminal.progress)
    with streamed_sog_writing.replacing(output, force) as folder:
        streamed_sog_writing.write(made, folder, chunk_rows, terminal.progress)
        terminal.progress("measuring", 0.99)
        held_out = views.held_out[:: -(-len(views.held_out) // measured)] if measured else ()
        streamed_sog_writing.annotate(folder, scene, measure(original, folder, held_out) if held_out else ())
        found = described(Streamed.open(folder))
    seconds = time.perf_counter() - start
    terminal.clear()
    data = {"path": str(output), "levels": _rows(found), "leaves": made.tree.leaves}
    total, measuring = sum(level.bytes for level in found), " and measured" if measured else ""
    head = f"{output}: {len(found)} levels, {made.tree.leaves} leaves, {total:,} bytes, written{measuring} in "
    terminal.result("\n".join([f"{head}{seconds:.1f} s", *_lines(found)]), data | {"bytes": total, "seconds": seconds})


def write_levels_of_tiles(tiles: Tiles, output: Path, sizes: Sizes, memory: int, force: bool) -> None:
    """Write a scene that does not fit into memory in levels, part by part, and print them; nothing is measured."""
    from ..gaussians.files.formats import streamed_sog_writing
    from ..gaussians.files.formats.streamed_sog import Streamed
    from ..gaussians.levels.making import LEVELS, described
    from ..gaussians.tiles import leveling

    start = time.perf_counter()
    levels, chunk_rows = sizes[0] or LEVELS, sizes[1] or streamed_sog_writing.CHUNK_ROWS
    with streamed_sog_writing.replacing(output, force) as folder:
        leaves = leveling.write_levels(tiles, folder, levels, memory, chunk_rows, terminal.progress)
        found = described(Streamed.open(folder))
    seconds = time.perf_counter() - start
    terminal.clear()
    notes = [
        "all Gaussians of a level counted alike when they were merged, and no loss was measured: both need views of "
        "the whole scene in memory",
        *(["levels of detail hold no names"] if tiles.field is not None else []),
    ]
    for note in notes:
        terminal.say(f"note: {note}")
    total = sum(level.bytes for level in found)
    data = {"path": str(output), "levels": _rows(found), "leaves": leaves, "bytes": total, "seconds": seconds}
    head = f"{output}: {len(found)} levels, {leaves} leaves, {total:,} bytes, written in {seconds:.1f} s"
    terminal.result("\n".join([head, *_lines(found)]), data | {"notes": notes})


def levels_of(path: Path) -> tuple[list[str], list[dict[str, Any]]]:
    """Lines and rows that tell the levels of a scene; none if it has none."""
    from ..gaussians.files.formats import streamed_sog

    if not streamed_sog.recognises(path, b""):
        return [], []
    from ..gaussians.levels.making import described

    found = described(streamed_sog.Streamed.open(path))
    return _lines(found), _rows(found)


def _rows(levels: Sequence[Level]) -> list[dict[str, Any]]:
    from dataclasses import asdict

    return [asdict(level) for level in levels]


def _lines(levels: Sequence[Level]) -> list[str]:
    lines = []
    for k, level in enumerate(levels):
        line = f"  level {k}: {level.gaussians:,} Gaussians, {level.bytes:,} bytes"
        if level.psnr is not None and level.psnr_least is not None:
            to = "the original" if k == 0 else "level 0"
            line += f", {level.psnr:.1f} dB PSNR to {to} from held-out views, {level.psnr_least:.1f} dB at worst"
        lines.append(line)
    return lines


@dataclass(eq=False)
class Drawn:
    """A `.lod` from which each picture takes the levels that suffice for it.

    Attributes:
        streamed: the levels.
        pixels: by which Gaussians may move on the screen.
        gaussians: of the pictures so far.
        leaves: how often a leaf was drawn at each level.
    """

    streamed: Streamed
    pixels: float
    gaussians: list[int] = field(default_factory=list)
    leaves: Counter[int] = field(default_factory=Counter)
    KEY = "lod"

    @classmethod
    def of(cls, path: Path, pixels: float) -> Drawn:
        """Open a scene.

        Raises:
            UserError: it has no levels.
            FileError: it cannot be read.
        """
        from ..gaussians.errors import FileError, UserError
        from ..gaussians.files.formats import streamed_sog

        if not path.exists():
            raise FileError(f"no such file or folder: {path}")
        if not streamed_sog.recognises(path, b""):
            raise UserError(
                f"{path.name} has no levels of detail; write them with `scenewright convert {path.name} "
                f"{path.stem}.lod`, or leave out --lod"
            )
        return cls(streamed_sog.Streamed.open(path), pixels)

    def scene(self, whole: bool) -> Scene:
        """The scene that cameras are chosen by: its finest level, or else the coarsest, which is read at once."""
        if whole:
            return self.streamed.scene()[0]
        from ..gaussians.scene import Scene

        last = max(k for k, count in enumerate(self.streamed.counts) if count)
        return Scene(self.streamed.level(last)[0], self.streamed.frame, self.streamed.cameras)

    def render(self, camera: Camera, background: Vec3, backend: str) -> Render:
        """A picture from this camera."""
        from ..gaussians.render import render

        return render(self.cloud(camera), camera, background, backend)

    def cloud(self, camera: Camera) -> GaussianCloud:
        """What a picture from this camera is drawn of."""
        from ..gaussians.levels.choosing import choose

        levels = choose(self.streamed, camera, self.pixels)
        cloud = self.streamed.chosen(levels)
        self.gaussians.append(len(cloud))
        self.leaves.update(levels)
        return cloud

    def data(self) -> dict[str, Any]:
        """What was drawn: Gaussians of a picture on average, of the finest level, and leaves by level."""
        mean = round(sum(self.gaussians) / max(len(self.gaussians), 1))
        leaves = [self.leaves[k] for k in range(self.streamed.levels)]
        return {"gaussians": mean, "gaussians_finest": max(self.streamed.counts), "leaves": leaves}

    def text(self) -> str:
        told = self.data()
        leaves = ", ".join(f"{count} at level {k}" for k, count in enumerate(told["leaves"]) if count)
        return f"{told['gaussians']:,} of {told['gaussians_finest']:,} Gaussians a picture; leaves: {leaves}"
