"""`convert SCENE NAME.lod`: a scene written in levels of detail, and what each level takes and loses."""

from __future__ import annotations

import time
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from .terminal.output import terminal

if TYPE_CHECKING:
    from ..gaussians.scene import Scene

HELD_OUT = 8  # views that measure


def is_streamed(path: Path) -> bool:
    """Whether a name asks for levels of detail."""
    return path.suffix.lower() == ".lod" or path.name == "lod-meta.json"


def write_levels(scene: Scene, output: Path, levels: int, chunk_rows: int, force: bool) -> None:
    """Write the scene in levels and print them."""
    from ..gaussians.files.formats import streamed_sog_writing
    from ..gaussians.levels.making import make, measure
    from ..gaussians.levels.tree import LEAF_ROWS
    from ..gaussians.slim.views import choose_views

    start = time.perf_counter()
    terminal.progress("choosing views", 0.0)
    views = choose_views(scene)
    made, tree = make(scene, levels, views.ranking, min(LEAF_ROWS, chunk_rows), terminal.progress)
    streamed_sog_writing.save(made, tree, output, force, chunk_rows, terminal.progress)
    wrote = time.perf_counter() - start
    found = measure(scene, output, views.held_out[:: -(-len(views.held_out) // HELD_OUT)])
    terminal.clear()
    total = sum(level.bytes for level in found)
    lines = [f"{output}: {len(found)} levels, {tree.leaves} leaves, {total:,} bytes, written in {wrote:.1f} s"]
    for k, level in enumerate(found):
        to = "the original" if k == 0 else "level 0"
        lines.append(
            f"  level {k}: {level.gaussians:,} Gaussians, {level.bytes:,} bytes, {level.psnr:.1f} dB PSNR to {to} from "
            f"held-out views, {level.psnr_least:.1f} dB at worst"
        )
    data = {"path": str(output), "levels": [asdict(level) for level in found], "leaves": tree.leaves}
    terminal.result("\n".join(lines), data | {"bytes": total, "seconds": wrote})
