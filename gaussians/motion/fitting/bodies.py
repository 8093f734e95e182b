"""Gaussians in training of which some are of bodies that move: labels, poses at the frames' times, and gradients."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...fit.parameters import Parameters
from .. import keys

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
Columns = tuple[F32, F32, F32, F32, F32]


@dataclass(eq=False)
class Body:
    """A rigid body: a point x of it is at `R(t) @ (x - pivot) + pivot + offset(t)`.

    Attributes:
        pivot: `[3]`.
        quats: `[T, 4]` wxyz, unit, at each time of the frames; the first is the identity.
        offsets: `[T, 3]` scene units; the first is 0.
    """

    pivot: F64
    quats: F64
    offsets: F64

    @classmethod
    def at_rest(cls, pivot: F64, times: int) -> Body:
        """A body that does not move."""
        return cls(pivot, np.tile([1.0, 0.0, 0.0, 0.0], (times, 1)), np.zeros((times, 3)))

    def placed(self, t: int, means: F32, quats: F32) -> tuple[F32, F32]:
        """Means and quaternions of its Gaussians at a time."""
        return moved(means, quats, self.pivot, self.quats[t], self.offsets[t])


class Labelled(Parameters):
    """Parameters of Gaussians with the number of the body of each.

    Attributes:
        labels: `[N]` int32, 0 for what stands still, else the body's number, from 1 on.
    """

    labels: NDArray[np.int32]

    @classmethod
    def labelled(cls, parameters: Parameters, labels: NDArray[np.int32]) -> Labelled:
        """Parameters with labels."""
        made = cls(**parameters.arrays(), optimisers=parameters.optimisers)
        made.labels = labels.astype(np.int32)
        return made

    def take(self, rows: I64) -> None:
        """See `Parameters`."""
        super().take(rows)
        self.labels = self.labels[rows]

    def overwrite(self, rows: I64, source: I64) -> None:
        """See `Parameters`."""
        super().overwrite(rows, source)
        self.labels[rows] = self.labels[source]

    def append(self, source: I64) -> None:
        """See `Parameters`."""
        super().append(source)
        self.labels = np.concatenate([self.labels, self.labels[source]])


def placed(columns: Columns, labels: NDArray[np.int32], bodies: list[Body], t: int) -> Columns:
    """Columns with each body where it is at a time."""
    means, quats = columns[0].copy(), columns[1].copy()
    for number, body in enumerate(bodies, 1):
        rows = np.flatnonzero(labels == number)
        if len(rows):
            means[rows], quats[rows] = body.placed(t, means[rows], quats[rows])
    return means, quats, *columns[2:]


def moved(means: F32, quats: F32, pivot: F64, turn: F64, offset: F64) -> tuple[F32, F32]:
    """Means `[N, 3]` and quaternions `[N, 4]` of Gaussians under a pose."""
    matrix = keys.matrices(turn)
    at = ((means - pivot) @ matrix.T + pivot + offset).astype(np.float32)
    return at, (quats @ left(turn).T).astype(np.float32)


def left(q: F64) -> F64:
    """`[4, 4]`: multiplication by a quaternion from the left, `left(q) @ p = q p`."""
    w, x, y, z = q
    return np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]])


def multiplied(a: F64, b: F64) -> F64:
    """The product of two quaternions `[4]`, of length one."""
    found = left(a) @ b
    return np.asarray(found / np.linalg.norm(found))


def turned(q: F64, vector: F64) -> F64:
    """A quaternion after a further turn by a rotation vector `[3]`, world frame."""
    angle = float(np.linalg.norm(vector))
    if angle < 1e-12:
        return q
    return multiplied(np.array([np.cos(angle / 2), *(np.sin(angle / 2) / angle * vector)]), q)


def pose_gradient(at: F32, quats: F32, centre: F64, d_means: F32, d_quats: F32) -> tuple[F64, F64]:
    """Gradient by a further turn about `centre` (a rotation vector, world) and by a shift, from those by the placed
    means `[N, 3]` and quaternions `[N, 4]`."""
    slope = d_means.astype(np.float64)
    turn = np.cross(at - centre, slope).sum(axis=0)
    # d(dq q)/d(vector): half the vector's quaternion times q.
    w, x, y, z = quats.astype(np.float64).T
    dw, dx, dy, dz = d_quats.astype(np.float64).T
    turn = turn + 0.5 * np.array([
        (-x * dw + w * dx - z * dy + y * dz).sum(),
        (-y * dw + z * dx + w * dy - x * dz).sum(),
        (-z * dw - y * dx + x * dy + w * dz).sum(),
    ])  # fmt: skip
    return turn, slope.sum(axis=0)
