"""`make`: levels of detail of a scene by merging Gaussians within the leaves of a tree; `measure`: what each loses."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import torch

from ..cloud import GaussianCloud
from ..errors import UserError
from ..files.formats.streamed_sog import Streamed
from ..merging import merge, visibility
from ..reduce import psnr
from ..scene import Scene
from ..slim.views import View
from .tree import LEAF_ROWS, Tree, build

LEVELS = 4
SHRINK = 4  # Gaussians of a level by those of the next: half as many along each side of a surface
MOST_LEVELS = 12


@dataclass(frozen=True)
class Level:
    """A level as it is on disk: its Gaussians, bytes, and PSNR in dB of held-out views (mean and least) to the scene it
    was made from for level 0, to level 0 for the others."""

    gaussians: int
    bytes: int
    psnr: float
    psnr_least: float


def make(
    scene: Scene,
    levels: int,
    views: Sequence[View],
    leaf_rows: int = LEAF_ROWS,
    progress: Callable[[str, float], None] = lambda stage, share: None,
) -> tuple[tuple[GaussianCloud, ...], Tree]:
    """The scene at each level, the finest first, and the tree over it; each level is merged from the one before.

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
    for level in range(1, levels):
        progress(f"merging level {level}", level / levels)
        smaller = merge(found[-1], max(len(found[-1]) // SHRINK, tree.leaves), shown)
        found.append(smaller.cloud)
        shown = smaller.shown
    return tuple(found), tree


def measure(scene: Scene, path: Path, views: Sequence[View]) -> tuple[Level, ...]:
    """The levels of a written folder, measured from held-out views.

    Raises:
        FileError: the folder cannot be read.
    """
    streamed = Streamed.open(path)
    cameras = [view.camera for view in views]
    truth, found = scene.cloud, list[Level]()
    for level, count in enumerate(streamed.counts):
        cloud = streamed.level(level)[0]
        loss = psnr(truth, cloud, cameras)
        truth = cloud if level == 0 else truth
        size = sum(chunk.size for chunk in streamed.of_level(level))
        found.append(Level(count, size, sum(loss) / len(loss), min(loss)))
    return tuple(found)
