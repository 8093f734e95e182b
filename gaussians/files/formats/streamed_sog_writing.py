"""Writes Streamed SOG version 1 (see `streamed_sog` for reading and the source): the index, and a SOG folder a chunk.

Neighbouring leaves share a chunk; a chunk holds one level. In a leaf the rows follow a Morton curve.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ...cloud import GaussianCloud
from ...levels.levels import Levels
from ...levels.tree import Node, Tree
from ...rotations import to_matrix
from ...scene import Scene
from ..atomic import writing_folder
from . import comments, sog, sog_writing
from .morton import morton_order
from .streamed_sog import INDEX, scene_folder

CHUNK_ROWS = 65_536  # most Gaussians of a chunk: about a megabyte
_DIGITS = 7  # significant ones of bounds, as the format asks for

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Run = dict[str, int | float]
Runs = Sequence[dict[str, Run]]  # of each leaf by level
Progress = Callable[[str, float], None]


def save(levels: Levels, path: Path, force: bool = False, chunk_rows: int = CHUNK_ROWS) -> None:
    """Write a scene in levels as a folder: complete, or not at all.

    Args:
        path: of the folder, or of the index in it.
        force: replace a folder of this kind.
        chunk_rows: most Gaussians of a chunk; a leaf with more has a chunk of its own.

    Raises:
        UserError: the folder exists and is not to be replaced, or some rows hold NaN or infinite values.
        FileError: the folder cannot be written.
    """
    with replacing(path, force) as folder:
        write(levels, folder, chunk_rows)


def replacing(path: Path, force: bool = False) -> AbstractContextManager[Path]:
    """An empty folder that takes its place when the block succeeds; arguments and errors as of `save`."""
    return writing_folder(scene_folder(path), force, _ours)


def _ours(path: Path) -> bool:
    """Whether a file of a folder is of this format, by its path in the folder."""
    return str(path) == INDEX or (len(path.parts) == 2 and (path.name == sog.META or path.suffix == ".webp"))


def write(levels: Levels, folder: Path, chunk_rows: int = CHUNK_ROWS, progress: Progress | None = None) -> None:
    """Write chunks and index into an empty folder; `progress` is called with the stage and its share.

    Raises:
        UserError: some rows hold NaN or infinite values.
    """
    parts = Parts(folder, chunk_rows)
    parts.finish(parts.add(levels, progress))


class Parts:
    """Writes a scene that does not fit into memory, part by part: each has levels and a tree of its own, and a tree
    above them is given last.

    Args:
        folder: empty.
        chunk_rows: most Gaussians of a chunk.
    """

    def __init__(self, folder: Path, chunk_rows: int = CHUNK_ROWS) -> None:
        self._folder, self._chunk_rows = folder, chunk_rows
        self._runs: list[dict[str, Run]] = []
        self._bounds: list[Floats] = []
        self._names: list[str] = []
        self._counts: list[int] = []
        self._chunks: list[int] = []

    def add(self, levels: Levels, progress: Progress | None = None) -> Node:
        """Write a part; the root of its tree, with leaves numbered among those of all parts.

        Raises:
            UserError: some rows hold NaN or infinite values.
        """
        tree, clouds, moved = levels.tree, levels.clouds, levels.moved
        runs: list[dict[str, Run]] = [{} for _ in range(tree.leaves)]
        bounds = np.empty((tree.leaves, 2, 3))
        bounds[:] = [[np.inf], [-np.inf]]
        self._counts += [0] * (len(clouds) - len(self._counts))
        self._chunks += [0] * (len(clouds) - len(self._chunks))
        total, done = sum(len(cloud) for cloud in clouds), 0
        for level, cloud in enumerate(clouds):
            order, ends = _by_leaf(cloud, tree)
            cloud = cloud[torch.from_numpy(order)]
            _widen(bounds, cloud, ends)
            for number, (first, last) in enumerate(_chunks(ends, self._chunk_rows), self._chunks[level]):
                if progress is not None:
                    progress(f"writing level {level}", done / total)
                start, end = _span(ends, first)[0], _span(ends, last)[1]
                _write_chunk(self._folder / f"{level}_{number}", cloud[start:end])
                for leaf in range(first, last + 1):
                    begin, stop = _span(ends, leaf)
                    if stop > begin:
                        run: Run = {"file": len(self._names), "offset": begin - start, "count": stop - begin}
                        if moved is not None and level > 0:
                            run["moved"] = _rounded(moved[leaf, level])
                        runs[leaf][str(level)] = run
                self._names.append(f"{level}_{number}/{sog.META}")
                self._chunks[level] = number + 1
                done += end - start
            self._counts[level] += len(cloud)
        root = _shifted(tree.root, len(self._runs))
        self._runs += runs
        self._bounds += list(bounds)
        return root

    def finish(self, root: Node) -> None:
        """Write the index.

        Args:
            root: of the tree over all parts.
        """
        index = {
            "version": 1,
            "asset": {"generator": "scenewright"},
            "count": sum(self._counts),
            "counts": self._counts,
            "lodLevels": len(self._counts),
            "filenames": self._names,
            "tree": _node(root, self._bounds, self._runs)[0],
        }
        _write_index(self._folder, index)


def _shifted(node: Node, first: int) -> Node:
    """A tree whose leaves are counted from a number."""
    if not node.children:
        return replace(node, leaf=node.leaf + first)
    return replace(node, children=tuple(_shifted(child, first) for child in node.children))


def annotate(folder: Path, scene: Scene, psnr: Sequence[tuple[float, float]]) -> None:
    """Add the frame and the cameras of a scene to a written index, and the PSNR (mean and least) of each level."""
    index = json.loads((folder / INDEX).read_text())
    told = {"comments": list(comments.describe(scene)), "psnr": [[round(v, 3) for v in pair] for pair in psnr]}
    tree = index.pop("tree")  # stays last, so that a reader of text sees the rest
    _write_index(folder, index | {"extras": {"scenewright": told}, "tree": tree})


def _write_index(folder: Path, index: dict[str, Any]) -> None:
    (folder / INDEX).write_text(json.dumps(index, separators=(",", ":")))


def _by_leaf(cloud: GaussianCloud, tree: Tree) -> tuple[Ints, Ints]:
    """Row numbers `[N]` sorted by leaf and along a Morton curve within each; and where each leaf ends, `[leaves]`."""
    means = cloud.means.cpu().numpy()
    curve = morton_order(means)
    leaf = tree.leaf_of(means)
    order = curve[np.argsort(leaf[curve], kind="stable")]
    return order, np.cumsum(np.bincount(leaf, minlength=tree.leaves))


def _span(ends: Ints, leaf: int) -> tuple[int, int]:
    """Rows of a leaf: the first, and the one after the last."""
    return int(ends[leaf - 1]) if leaf else 0, int(ends[leaf])


def _chunks(ends: Ints, chunk_rows: int) -> list[tuple[int, int]]:
    """First and last leaf of each chunk, as few as possible; chunks hold at least one Gaussian."""
    found: list[tuple[int, int]] = []
    for leaf in range(len(ends)):
        start, end = _span(ends, leaf)
        if found and (start == end or end - _span(ends, found[-1][0])[0] <= chunk_rows):
            found[-1] = (found[-1][0], leaf)
        else:
            found.append((leaf, leaf))
    return found


def _widen(bounds: Floats, cloud: GaussianCloud, ends: Ints) -> None:
    """Widen the boxes `[leaves, 2, 3]` to hold the ellipsoids (one standard deviation) of a cloud sorted by leaf."""
    spread = (to_matrix(cloud.quats) * cloud.scales[:, None, :]).norm(dim=2)
    low, high = (cloud.means - spread).cpu().numpy(), (cloud.means + spread).cpu().numpy()
    for leaf in range(len(ends)):
        start, end = _span(ends, leaf)
        if end > start:
            np.minimum(bounds[leaf, 0], low[start:end].min(axis=0), out=bounds[leaf, 0])
            np.maximum(bounds[leaf, 1], high[start:end].max(axis=0), out=bounds[leaf, 1])


def _write_chunk(folder: Path, cloud: GaussianCloud) -> None:
    folder.mkdir()
    for name, data in sog_writing.encoded(cloud).items():
        (folder / name).write_bytes(data)


def _node(node: Node, bounds: Sequence[Floats], runs: Runs) -> tuple[dict[str, Any], Floats]:
    """A node of the index, with what is below it, and its box `[2, 3]`."""
    if not node.children:
        return {"bound": _bound(bounds[node.leaf]), "lods": runs[node.leaf]}, bounds[node.leaf]
    (left, a), (right, b) = (_node(child, bounds, runs) for child in node.children)
    box = np.stack([np.minimum(a[0], b[0]), np.maximum(a[1], b[1])])
    return {"bound": _bound(box), "children": [left, right]}, box


def _bound(box: Floats) -> dict[str, list[float]]:
    return {name: [_rounded(v) for v in corner] for name, corner in zip(("min", "max"), box, strict=True)}


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
