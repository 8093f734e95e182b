"""Paths of what rolls (`rolled`): it turns about the axis across its way, by its way over its radius.

A ball of a few pixels that turns by a third of a turn from one frame to the next shows any of many poses: pictures
of single times do not tell its turns, but all together tell one radius.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .bodies import Body, turned
from .tracking import BLURS, Tracker

F64 = NDArray[np.float64]

RADII = np.geomspace(0.6, 1.8, 56)  # of the body's size: each two per cent more
LEAST_WAY = 3.0  # of the body's size: what goes less far does not roll


def rolled(tracker: Tracker, body: Body) -> Body | None:
    """The body rolling along its path, if the frames agree with that better than with its own turns.

    Args:
        body: its places are kept; its pivot is the tracker's.
    """
    ways = np.linalg.norm(np.diff(body.offsets, axis=0), axis=1)
    runs = body.runs[1:]
    if ways.sum() < LEAST_WAY * tracker.size:
        return None
    tried = [
        Body(body.pivot, rolling(body.offsets, up, radius), body.offsets)
        for up in np.concatenate([np.eye(3), -np.eye(3)])
        for radius in RADII * tracker.size
    ]
    scores = np.zeros(len(tried))
    for t, _ in runs:
        quats = np.stack([b.quats[t] for b in tried])
        scores += tracker.scores(quats, np.tile(body.offsets[t], (len(tried), 1)), t, BLURS[1])
    best = tried[int(scores.argmin())]
    own = rolls = 0.0
    for t, _ in runs:
        (a, b), _ = tracker.errors(t, [(body.quats[t], body.offsets[t]), (best.quats[t], best.offsets[t])])
        own, rolls = own + a, rolls + b
    return best if rolls < own else None


def rolling(offsets: F64, up: F64, radius: float) -> F64:
    """`[T, 4]` turns of a ball of a radius that rolls along offsets `[T, 3]` on a plane with a normal."""
    quats = np.tile([1.0, 0.0, 0.0, 0.0], (len(offsets), 1))
    for t in range(1, len(offsets)):
        quats[t] = turned(quats[t - 1], np.cross(up, offsets[t] - offsets[t - 1]) / radius)
    return quats
