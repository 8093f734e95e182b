"""Finds the similarity between two frames in which the same photographs have poses.

Tools that convert a COLMAP model to `transforms.json` turn, move and scale the poses (instant-ngp's colmap2nerf does),
and leave the points of the model as they were.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...camera import Camera

F64 = NDArray[np.float64]

MIN_SHARED = 3  # photographs that must have poses in both frames
MAX_TURN = 3.0  # degrees, median, by which poses may differ after the similarity
MAX_SHIFT = 0.03  # of the cameras' spread, median, likewise
_SAME_TURN = 0.1  # degrees, from which two frames differ
_SAME_SHIFT = 1e-3  # of the cameras' spread, likewise


@dataclass(frozen=True, eq=False)
class Similarity:
    """`x -> scale * turn @ x + offset`, from one frame to another.

    Attributes:
        scale: positive.
        turn: `[3, 3]`, a rotation.
        offset: `[3]`, units of the target frame.
        spread: of the cameras around their mean, units of the target frame.
        shared: photographs that it was found from.
    """

    scale: float
    turn: F64
    offset: F64
    spread: float
    shared: int

    def apply(self, points: F64) -> F64:
        """`[N, 3]` points in the target frame."""
        return np.asarray(self.scale * points @ self.turn.T + self.offset, dtype=np.float64)

    def is_identity(self) -> bool:
        """Whether both frames are the same, within the digits that files are written with."""
        near = abs(self.scale - 1) < _SAME_SHIFT and float(np.linalg.norm(self.offset)) < _SAME_SHIFT * self.spread
        return near and _degrees(self.turn) < _SAME_TURN

    def describe(self) -> str:
        """The similarity in words."""
        turned = f"turned by {_degrees(self.turn):.0f} degrees, scaled by {self.scale:.4g}"
        return f"{turned} (found from {self.shared} photographs that both know)"


def similarity(source: Mapping[str, Camera], target: Mapping[str, Camera]) -> Similarity | None:
    """The similarity that takes the cameras of `source` to those of `target` with the same names.

    The rotation is the mean of those of the single cameras, so that it is also known where the cameras stand in a line.

    Returns:
        None if too few cameras are in both, or no similarity takes the ones to the others.
    """
    shared = sorted(set(source) & set(target))
    if len(shared) < MIN_SHARED:
        return None
    a, b = (np.stack([cameras[name].position for name in shared]) for cameras in (source, target))
    turns = [target[n].world_to_camera[:3, :3].T @ source[n].world_to_camera[:3, :3] for n in shared]
    u, _, v = np.linalg.svd(np.mean(turns, axis=0))
    turn = u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ v))]) @ v
    spread_a, spread_b = (float(np.sqrt(((x - x.mean(axis=0)) ** 2).sum(axis=1).mean())) for x in (a, b))
    if not (spread_a > 0 and spread_b > 0):
        return None
    scale = spread_b / spread_a
    offset = b.mean(axis=0) - scale * turn @ a.mean(axis=0)
    found = Similarity(scale, turn, offset, spread_b, len(shared))
    off = float(np.median([_degrees(t @ turn.T) for t in turns]))
    shift = float(np.median(np.linalg.norm(found.apply(a) - b, axis=1)))
    return found if off <= MAX_TURN and shift <= MAX_SHIFT * spread_b else None


def _degrees(turn: F64) -> float:
    """The angle of a rotation."""
    return float(np.degrees(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1))))
