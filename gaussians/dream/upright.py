"""Which way is up in an object that a program made: by the proportions of its kind, else as such programs have it."""

from __future__ import annotations

from typing import Literal

import numpy as np
import torch
from numpy.typing import NDArray

from ..assets.modeling.imported import FROM_Y_UP
from ..cloud import GaussianCloud
from ..rotations import from_matrix, multiply, normalize
from ..world.kinds import Kind

Up = Literal["auto", "x", "y", "z", "-x", "-y", "-z"]
F64 = NDArray[np.float64]

USUAL: Up = "y"  # of what programs write that turn a picture into Gaussians
_CLEARER = 1.3  # factor by which proportions have to fit better than as usual
# Rows: our x, y, z in the axes of the file. The front of files whose y is up is +z; of those whose z is up, -y. In the
# axes of a camera (COLMAP) -y is up, and what is seen from the front faces the camera, -z.
TURNS: dict[str, F64] = {
    "x": np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]),
    "y": FROM_Y_UP,
    "z": np.eye(3),
    "-x": np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]]),
    "-y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
    "-z": np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]),
}


def upright(cloud: GaussianCloud, kind: Kind | None, up: Up = "auto") -> tuple[GaussianCloud, str]:
    """The Gaussians with z up and harmonics of degree 0, which need no rotation; and the axis of theirs that was up.

    Args:
        kind: of the object; None if unknown.
        up: their axis that points up; "auto" takes y, or x or z if the proportions of the kind say so clearly. They
            tell no head from foot.
    """
    points = cloud.means.to(torch.float64).numpy()
    axis = up if up != "auto" else _by_proportions(points, kind)
    turn = TURNS[axis]
    spin = from_matrix(torch.from_numpy(turn)).to(torch.float32)
    return cloud.replace(
        means=torch.from_numpy((points @ turn.T).astype(np.float32)), quats=normalize(multiply(spin, cloud.quats)),
        sh=cloud.sh[:, :1].contiguous(),
    ), axis  # fmt: skip


def _by_proportions(points: F64, kind: Kind | None) -> str:
    if kind is None or len(points) < 8:
        return USUAL
    low, high = np.quantile(points, [0.005, 0.995], axis=0)
    span = np.maximum(high - low, 1e-9)
    usual = np.array([max((a * b) ** 0.5, b / 2, 1e-3) for a, b in kind.size])

    def off(axis: str) -> float:
        """Spread of the factors from the box to the kind's size, whichever way its front is."""
        box = np.abs(TURNS[axis]) @ span
        return min(float(np.ptp(np.log(usual / sides))) for sides in (box, box[[1, 0, 2]]))

    best = min(("x", "y", "z"), key=off)
    return best if off(USUAL) - off(best) > np.log(_CLEARER) else USUAL
