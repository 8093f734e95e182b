"""Another turn on the way of what moves: what comes behind the turn goes on in the new direction."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...gaussians.motion import keys
from ...gaussians.motion.courses import rotation_vectors
from ...gaussians.motion.motion import Track, poses

F64 = NDArray[np.float64]
_WIDE = 0.9 * np.pi / 2  # radians between two keys at most: rotations go the short way


def upright_turns(track: Track, times: F64, up: F64) -> F64:
    """`[T]` radians by which a track has turned about the vertical since the first time, whole turns kept.

    Args:
        times: `[T]` ascending, close enough for less than half a turn from one to the next.
        up: `[3]` unit.
    """
    turns = poses(track, times)[0]
    steps = rotation_vectors(turns[1:] @ turns[:-1].transpose(0, 2, 1)) @ up
    return np.concatenate([[0.0], np.cumsum(steps)])


def bent(track: Track, angle: float, up: F64, point: F64, times: F64) -> Track:
    """A track that turns by another angle on its way, to the side to which it does: at each time, what is left of its
    way is turned by as much more or less as it has turned till then.

    Args:
        angle: radians in all.
        up: `[3]` unit, the axis of the turn.
        point: `[3]` of what moves, at the start; its way is what bends.
        times: `[T]` ascending from the start to the end of the movement, as of `upright_turns`.
    """
    turned = upright_turns(track, times, up)
    more = turned * (angle / abs(float(turned[-1])) - 1.0)
    turns, shifts = poses(track, times)
    way = turns @ point + shifts
    steps = keys.matrices(keys.about(up, (more[1:] + more[:-1]) / 2)) @ np.diff(way, axis=0)[:, :, None]
    new_way = np.concatenate([way[:1], way[:1] + np.cumsum(steps[:, :, 0], axis=0)])
    own = np.unique(np.concatenate([np.clip(track.times, times[0], times[-1]), _on_the_turn(times, more)]))
    at = np.stack([np.interp(own, times, column) for column in new_way.T], axis=1)
    made = keys.matrices(keys.about(up, np.interp(own, times, more))) @ poses(track, own)[0]
    return Track.poses_at(track.ids, own, made, at - made @ point, point, track.smooth, track.name)


def _on_the_turn(times: F64, more: F64) -> F64:
    """Times so close that no turn between two of them is too wide to go the short way."""
    gone = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(more)))])
    wanted = np.arange(_WIDE, gone[-1], _WIDE)
    return times[np.searchsorted(gone, wanted)]
