"""Writes a scene in tiles as levels of detail (`.lod`, Streamed SOG) without holding it: a tree over a sample divides
space into parts that fit into memory, and each part becomes levels of its own below that tree.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..cloud import GaussianCloud
from ..files.formats import streamed_sog_writing
from ..levels.making import make
from ..levels.tree import LEAF_ROWS, Node, Tree, build
from .blocks import sampled
from .records import row_bytes
from .store import Tiles, by_id

_SAMPLE = 1_000_000  # rows by which space is divided
_COPIES = 24  # of its columns that making levels of a part takes
_MOST = 500_000  # rows of a part
_LEAST = 1 << 12
Progress = Callable[[str, float], None]


def write_levels(
    tiles: Tiles,
    folder: Path,
    levels: int,
    memory: int,
    chunk_rows: int = streamed_sog_writing.CHUNK_ROWS,
    progress: Progress = lambda stage, share: None,
) -> int:
    """Write the levels of a scene into an empty folder; returns the number of leaves.

    No view says what shows of a scene that is never whole in memory, so that all Gaussians of a level count alike when
    they are merged.

    Args:
        levels: how many.
        memory: bytes that a part and the work on it may take.
        chunk_rows: most Gaussians of a chunk.

    Raises:
        UserError: there are too few or too many levels.
        FileError: a tile is torn, or a file cannot be written.
    """
    parts = streamed_sog_writing.Parts(folder, chunk_rows)
    above, held = _divided(tiles, min(max(memory // (row_bytes(tiles.state.degree) * _COPIES), _LEAST), _MOST))
    roots: list[Node] = []
    leaves = 0
    for part in range(above.leaves):
        progress(f"part {part + 1} of {above.leaves}", part / above.leaves)
        cloud = _of_part(tiles, above, held, part)
        made = make(tiles.scene(cloud).replace(language=None), levels, (), min(LEAF_ROWS, chunk_rows))
        leaves += made.tree.leaves
        roots.append(parts.add(made))
    parts.finish(_grafted(above.root, roots))
    streamed_sog_writing.annotate(folder, tiles.scene(GaussianCloud.empty(tiles.state.degree)), ())
    return leaves


def _divided(tiles: Tiles, most: int) -> tuple[Tree, NDArray[np.int64]]:
    """A tree whose leaves, the parts, hold about so many rows at most and one at least; and the rows `[tiles, parts]`
    of each tile in each."""
    means = np.concatenate([cloud.means.numpy() for cloud in sampled(tiles, _SAMPLE)])
    tree = build(means, max(1, most * len(means) // max(len(tiles), 1)))
    held = np.stack(
        [
            np.bincount(tree.leaf_of(np.asarray(tiles.column(k, "means"))), minlength=tree.leaves)
            for k in range(len(tiles.state.tiles))
        ]
    )
    return tree, held


def _of_part(tiles: Tiles, above: Tree, held: NDArray[np.int64], part: int) -> GaussianCloud:
    found = []
    for k in np.flatnonzero(held[:, part]).tolist():
        rows = np.flatnonzero(above.leaf_of(np.asarray(tiles.column(k, "means"))) == part)
        found.append(tiles.cloud(k, rows))
    return by_id(found)


def _grafted(node: Node, roots: list[Node]) -> Node:
    """The tree with the trees of the parts in place of its leaves."""
    if not node.children:
        return roots[node.leaf]
    return replace(node, children=tuple(_grafted(child, roots) for child in node.children))
