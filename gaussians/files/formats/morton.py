"""The order of rows along a Morton curve, which lays neighbours in space side by side. Refuses to know any format."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

from ...scene import Scene

_BITS = 21  # an axis, so that three fit in 64


def arranged(scene: Scene) -> Scene:
    """The same scene with its rows in Morton order (Morton 1966); rows of one cell stay as they were."""
    return scene.replace(cloud=scene.cloud[torch.from_numpy(morton_order(scene.cloud.means.cpu().numpy()))])


def morton_order(means: NDArray[np.float32]) -> NDArray[np.int64]:
    """Row numbers `[N]` in the order of a Morton curve through the positions `[N, 3]`.

    The curve is laid through the ranks of the coordinates, not their values: a floater far out does not push all
    others into one cell.
    """
    keys = np.zeros(len(means), np.uint64)
    for axis in range(3):
        ranks = np.empty(len(means), np.int64)
        ranks[np.argsort(means[:, axis], kind="stable")] = np.arange(len(means))
        cells = (ranks * ((1 << _BITS) - 1) // max(len(means) - 1, 1)).astype(np.uint64)
        keys |= _spread(cells) << np.uint64(axis)
    return np.argsort(keys, kind="stable")


def _spread(cells: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Two zero bits between neighbouring bits of 21-bit numbers."""
    for shift, mask in (
        (32, 0x001F00000000FFFF), (16, 0x001F0000FF0000FF), (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3), (2, 0x1249249249249249),
    ):  # fmt: skip
        cells = (cells | (cells << np.uint64(shift))) & np.uint64(mask)
    return cells
