"""`Levels`: a scene at several levels of detail over one tree."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..cloud import GaussianCloud
from .tree import Tree


@dataclass(frozen=True, eq=False)
class Levels:
    """A scene in levels.

    Attributes:
        clouds: the scene at each level, the finest first.
        tree: over all of them; each Gaussian of a coarse level stands for Gaussians of the same leaf.
        moved: `[leaves, levels]`, scene units: how far the Gaussians of level 0 are from those that stand for them,
            root mean square over a leaf with mass times visibility as weight; zeros at level 0. None if unknown.
    """

    clouds: tuple[GaussianCloud, ...]
    tree: Tree
    moved: NDArray[np.float64] | None = None
