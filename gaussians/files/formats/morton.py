"""Sorts the rows of a scene along a Morton curve, so that neighbouring rows are neighbours in space."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

from ...morton import BITS, codes
from ...scene import Scene


def morton_sorted(scene: Scene) -> Scene:
    """The same scene with its rows in Morton order; rows of one cell keep their order."""
    return scene.replace(cloud=scene.cloud[torch.from_numpy(morton_order(scene.cloud.means.cpu().numpy()))])


def morton_order(means: NDArray[np.float32]) -> NDArray[np.int64]:
    """Row numbers `[N]` in the order of a Morton curve through the positions `[N, 3]`.

    The curve uses the ranks of the coordinates instead of their values. A floater far away therefore does not move
    all other Gaussians into one cell.
    """
    cells = np.empty((len(means), 3), np.int64)
    for axis in range(3):
        ranks = np.empty(len(means), np.int64)
        ranks[np.argsort(means[:, axis], kind="stable")] = np.arange(len(means))
        cells[:, axis] = ranks * ((1 << BITS) - 1) // max(len(means) - 1, 1)
    return np.argsort(codes(cells), kind="stable")
