"""How far a scene reaches: nothing is made beyond everything that is there, as nobody knows what follows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.cloud import GaussianCloud

F64 = NDArray[np.float64]

_POINTS = 20_000  # of a scene from which its hull is made
_VISIBLE = 0.12  # opacity of a Gaussian that counts
_STANDS_OUT = 0.03  # of the thing's extent: how far beyond it something may be made


@dataclass(frozen=True, eq=False)
class Span:
    """The convex hull of a scene: `[F, 4]` half spaces, `a x + b y + c z + d <= 0` inside; none: everything is."""

    half_spaces: F64

    @classmethod
    def of(cls, cloud: GaussianCloud, size: float) -> Self:
        """The hull of the visible Gaussians; everything where they span no volume.

        Args:
            size: of a thing, scene units, which tells how far a surface may stand out.
        """
        from scipy.spatial import ConvexHull, QhullError

        points = cloud.means[cloud.opacities > _VISIBLE].to(torch.float64).cpu().numpy()
        points = points[np.isfinite(points).all(axis=1)]
        if len(points) < 4:
            return cls(np.zeros((0, 4)))
        far = [int((points @ way).argmax()) for way in np.concatenate([np.eye(3), -np.eye(3)])]
        try:
            half_spaces: F64 = ConvexHull(
                np.concatenate([points[:: -(-len(points) // _POINTS)], points[far]])
            ).equations
        except QhullError:
            return cls(np.zeros((0, 4)))
        half_spaces[:, 3] -= _STANDS_OUT * size
        return cls(half_spaces)

    def outside(self, points: F64) -> NDArray[np.bool_]:
        """Which points `[M, 3]` lie beyond it."""
        out = np.zeros(len(points), bool)
        for a, b, c, d in self.half_spaces:
            out |= points @ np.array([a, b, c]) + d > 0
        return out
