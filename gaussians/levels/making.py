"""`make`: levels of detail of a scene by merging Gaussians within the leaves of a tree; `measure`: what each loses."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from ..cloud import GaussianCloud
from ..errors import UserError
from ..files.formats.streamed_sog import Streamed
from ..merging import masses, merge, visibility
from ..reduce import psnr
from ..scene import Scene
from ..slim.views import View
from .levels import Levels
from .tree import LEAF_ROWS, build

F64 = NDArray[np.float64]

LEVELS = 4
SHRINK = 4  # Gaussians of a level by those of the next: half as many along each side of a surface
MOST_LEVELS = 12


@dataclass(frozen=True)
class Level:
    """A level as it is on disk: its Gaussians, bytes, and PSNR in dB of held-out views (mean and least) to the scene it
    was made from for level 0, to level 0 for the others; None if the file does not say it."""

    gaussians: int
    bytes: int
    psnr: float | None = None
    psnr_least: float | None = None


def make(
    scene: Scene,
    levels: int,
    views: Sequence[View],
    leaf_rows: int = LEAF_ROWS,
    progress: Callable[[str, float], None] = lambda stage, share: None,
) -> Levels:
    """The scene at each level, and the tree over it; each level is merged from the one before.

    Args:
        levels: how many, at most `MOST_LEVELS`; every leaf keeps at least one Gaussian.
        views: that say how much each Gaussian shows; all show alike if there is none.
        leaf_rows: most Gaussians of a leaf at level 0.

    Raises:
        UserError: there are too few or too many levels, or a Gaussian is not finite.
    """
    if not 1 <= levels <= MOST_LEVELS:
        raise UserError(f"a scene has 1 to {MOST_LEVELS} levels, not {levels}")
    tree = build(scene.cloud.means.cpu().numpy(), leaf_rows)
    leaf = torch.from_numpy(tree.leaf_of(scene.cloud.means.cpu().numpy())).int()
    found = [scene.cloud.replace(group=leaf)]  # so that no Gaussian of two leaves is merged
    progress("finding what shows", 0.0)
    shown = visibility(found[0], [view.camera for view in views]) if views and levels > 1 else None
    weights = masses(found[0]) * (1.0 if shown is None else shown)
    rows, moved = np.arange(len(scene.cloud)), [np.zeros(tree.leaves)]
    for level in range(1, levels):
        progress(f"merging level {level}", level / levels)
        smaller = merge(found[-1], max(len(found[-1]) // SHRINK, tree.leaves), shown)
        found.append(smaller.cloud)
        shown, rows = smaller.shown, smaller.rows[rows]
        moved.append(_moved(found[0], smaller.cloud, rows, weights))
    return Levels(tuple(found), tree, np.stack(moved, axis=1))


def _moved(fine: GaussianCloud, coarse: GaussianCloud, rows: NDArray[np.int64], weights: F64) -> F64:
    """`[leaves]`, root mean square distance of the Gaussians `[N]` of the finest level from those `rows` `[N]` of a
    coarse one that stand for them; the groups of the finest level are the leaves."""
    leaf = fine.group.cpu().numpy()
    apart = (fine.means.cpu().double().numpy() - coarse.means.cpu().double().numpy()[rows]) ** 2
    mean = np.bincount(leaf, weights * apart.sum(axis=1)) / np.bincount(leaf, weights)
    root: F64 = np.sqrt(mean)
    return root


def measure(original: GaussianCloud, path: Path, views: Sequence[View]) -> tuple[tuple[float, float], ...]:
    """PSNR in dB of each level of a written folder, mean and least of held-out views, as `Level` has it.

    Args:
        original: what level 0 is compared with.

    Raises:
        FileError: the folder cannot be read.
    """
    streamed = Streamed.open(path)
    cameras = [view.camera for view in views]
    truth, found = original, list[tuple[float, float]]()
    for level in range(streamed.levels):
        cloud = streamed.level(level)[0]
        loss = psnr(truth, cloud, cameras)
        truth = cloud if level == 0 else truth
        found.append((sum(loss) / len(loss), min(loss)))
    return tuple(found)


def described(streamed: Streamed) -> tuple[Level, ...]:
    """The levels of a folder, with the PSNR that its index says."""
    sizes = (sum(chunk.size for chunk in streamed.of_level(k)) for k in range(streamed.levels))
    known = streamed.psnr or ((None, None),) * streamed.levels
    return tuple(Level(n, size, *pair) for n, size, pair in zip(streamed.counts, sizes, known, strict=True))
