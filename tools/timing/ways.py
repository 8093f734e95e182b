"""A movement that takes time: the map of an edit as a track from the identity to the map."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.errors import InstructionError
from ...gaussians.motion.motion import Track
from ...gaussians.rows import rows_of_ids
from ...gaussians.scene import Scene
from ..operation import Affine, Context, EditOp
from ..ops.rotate import Rotate
from ..placement.bodies import heading
from ..when import When
from .spans import Span

I64 = NDArray[np.int64]

PACE = 0.8  # metres a second of what goes somewhere and is not told how long it takes
_TURN = 120.0  # degrees a second, likewise
_LEAST, _MOST = 0.5, 6.0  # seconds that it then takes
_RIGID = 1e-4  # by how much a rotation may differ from one
_FAR = 170.0  # degrees from which a turn needs its axis, as poses go the short way


def path_of(
    op: EditOp, when: When, span: Span, still: Scene, context: Context
) -> Callable[[I64, Affine], tuple[Track, str]]:
    """A function from the ids of a body and its map to the track that takes it there in a span, and a note.

    Args:
        still: the scene at the start of the span.
    """

    def track(ids: I64, body: Affine) -> tuple[Track, str]:
        if np.abs(body.matrix @ body.matrix.T - np.eye(3)).max() > _RIGID or np.linalg.det(body.matrix) < 0:
            raise InstructionError(
                "a size cannot change little by little: only places, turns and looks can; leave out the time"
            )
        rows = rows_of_ids(still.cloud.ids, torch.from_numpy(ids))
        middle = still.cloud.means[rows].double().mean(dim=0).cpu().numpy()
        way = float(np.linalg.norm(body.matrix @ middle + body.offset - middle))
        degrees = _degrees(op, body.matrix)
        start, stop, note = _ends(span, when, context, way * (still.frame.metres_per_unit or 1.0), abs(degrees))
        if isinstance(op, Rotate) and abs(degrees) >= _FAR:
            axis = heading(context.viewer, still.frame, op.axis)
            pivot = _fixed(body.matrix, body.offset, axis, middle)
            made = Track.hinge(ids, (start, stop), (0.0, math.radians(degrees)), axis, pivot)
        else:
            made = Track.poses_at(ids, (start, stop), (np.eye(3), body.matrix), (np.zeros(3), body.offset), middle)
        return made, note

    return track


def _ends(span: Span, when: When, context: Context, metres: float, degrees: float) -> tuple[float, float, str]:
    """When a movement starts and stops, and a note if nobody said how long it takes."""
    start = span[0] if math.isfinite(span[0]) else (context.time or 0.0)
    if math.isfinite(span[1]):
        return start, span[1], ""
    taken = min(max(metres / PACE, degrees / _TURN, _LEAST), _MOST)
    return start, start + taken, f"it was not said how long it takes: {taken:.2g} s"


def _degrees(op: EditOp, matrix: NDArray[np.float64]) -> float:
    """The angle of a turn; as it was said where that is more than the short way."""
    if isinstance(op, Rotate) and op.degrees is not None and op.toward is None:
        return op.degrees
    return math.degrees(math.acos(min(1.0, max(-1.0, (float(np.trace(matrix)) - 1) / 2))))


def _fixed(
    matrix: NDArray[np.float64], offset: NDArray[np.float64], axis: NDArray[np.float64], middle: NDArray[np.float64]
) -> NDArray[np.float64]:
    """`[3]` a point of the axis of `x -> matrix @ x + offset`, near the middle of the body."""
    away = offset - axis * (offset @ axis)
    step = np.eye(3) - matrix
    moved = away + matrix @ middle - middle
    return np.asarray(middle + np.linalg.lstsq(step, moved, rcond=1e-6)[0])
