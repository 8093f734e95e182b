"""Gaussians in training of which some are of bodies that move: labels, poses at the frames' times, and gradients."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...fit.parameters import Parameters
from .. import keys
from .bends import Bend

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
Columns = tuple[F32, F32, F32, F32, F32]


@dataclass(frozen=True, eq=False)
class Line:
    """One axis on which all poses of a body lie.

    Attributes:
        kind: "hinge", a turn about the line through `pivot` along `axis`; "slide", a shift along `axis`.
        axis: `[3]` unit.
        pivot: `[3]` a point of the line of a hinge.
        values: `[T]` radians or scene units at each time of the frames; the first is 0, but in training.
    """

    kind: Literal["hinge", "slide"]
    axis: F64
    pivot: F64
    values: F64

    def poses(self, values: F64, centre: F64) -> tuple[F64, F64]:
        """Turns `[n, 4]` and offsets `[n, 3]` of a body with this pivot at values `[n]` on the axis."""
        if self.kind == "slide":
            return np.tile([1.0, 0.0, 0.0, 0.0], (len(values), 1)), values[:, None] * self.axis
        turns = keys.about(self.axis, values)
        arm = centre - self.pivot
        return turns, keys.matrices(turns) @ arm - arm

    def gradient(self, t: int, centre: F64, turn: F64, shift: F64) -> tuple[float, F64, F64]:
        """Gradient by the value at a time, by a shift of the pivot and by a turn of the axis, both `[3]`.

        Args:
            centre: about which `turn` is taken.
            turn, shift: gradient by a further turn and a further shift of the body at that time (`pose_gradient`).
        """
        value = float(self.values[t])
        if self.kind == "slide":
            return float(self.axis @ shift), np.zeros(3), value * np.cross(self.axis, shift)
        about = turn + np.cross(centre - self.pivot, shift)  # the same turn, about the line
        # A shift s of the pivot moves the body by (1 - R) s; a turn w of the axis turns it by (1 - R) w.
        away = np.eye(3) - keys.matrices(keys.about(self.axis, np.array([value]))[0])
        return float(self.axis @ about), away.T @ shift, away.T @ about

    def stepped(self, times: slice, value: float, pivot: F64, axis: F64) -> Line:
        """The line after steps: of the value at some times, of the pivot, and a turn of the axis."""
        values = self.values.copy()
        values[times] += value
        tilted = self.axis + np.cross(axis, self.axis)
        return replace(self, axis=tilted / np.linalg.norm(tilted), pivot=self.pivot + pivot, values=values)


@dataclass(eq=False)
class Body:
    """A body: a point x of it is at `R(t) @ (x - pivot) + pivot + offset(t)`, and displaced before if it bends.

    Attributes:
        pivot: `[3]`.
        quats: `[T, 4]` wxyz, unit, at each time of the frames; the first is the identity, but in training.
        offsets: `[T, 3]` scene units; the first is 0, but in training (`Joint.settle`).
        line: the axis on which all poses lie, if the frames tell no more than that.
        bend: how it changes its shape; None: it is rigid.
    """

    pivot: F64
    quats: F64
    offsets: F64
    line: Line | None = None
    bend: Bend | None = None

    @classmethod
    def at_rest(cls, pivot: F64, times: int) -> Body:
        """A body that does not move."""
        return cls(pivot, np.tile([1.0, 0.0, 0.0, 0.0], (times, 1)), np.zeros((times, 3)))

    def placed(self, t: int, means: F32, quats: F32) -> tuple[F32, F32]:
        """Means and quaternions of its Gaussians at a time."""
        if self.bend is not None:
            means = self.bend.displaced(t, means)
        return moved(means, quats, self.pivot, self.quats[t], self.offsets[t])

    def on(self, line: Line) -> Body:
        """The body with all poses on one axis."""
        return Body(self.pivot, *line.poses(line.values, self.pivot), line, self.bend)

    @property
    def runs(self) -> list[tuple[int, int]]:
        """From which time to before which it has one pose and one shape: a body at rest has one for all of its rest."""
        same = (self.quats[1:] == self.quats[:-1]).all(axis=1) & (self.offsets[1:] == self.offsets[:-1]).all(axis=1)
        if self.bend is not None:
            same &= (self.bend.moves[1:] == self.bend.moves[:-1]).all(axis=(1, 2))
        starts = [0, *(np.flatnonzero(~same) + 1).tolist()]
        return list(zip(starts, [*starts[1:], len(self.offsets)], strict=True))

    def started_at(self, t: int) -> Body:
        """The same movement of the Gaussians as they are at a time."""
        back = np.array([left(q) @ (self.quats[t] * [1, -1, -1, -1]) for q in self.quats])
        line = self.line and replace(self.line, values=self.line.values - self.line.values[t])
        bend = self.bend and self.bend.started_at(t, self.quats[t], self.pivot, self.offsets[t])
        return Body(self.pivot + self.offsets[t], back, self.offsets - self.offsets[t], line, bend)

    def backwards(self) -> Body:
        """The same poses in the opposite order of times."""
        line = self.line and replace(self.line, values=self.line.values[::-1].copy())
        bend = self.bend and self.bend.backwards()
        return Body(self.pivot, self.quats[::-1].copy(), self.offsets[::-1].copy(), line, bend)

    def seen_from(self, pivot: F64) -> Body:
        """The same poses about another pivot."""
        arm = pivot - self.pivot
        return Body(pivot, self.quats, self.offsets + keys.matrices(self.quats) @ arm - arm, self.line, self.bend)


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


def turn_around(labelled: Labelled, bodies: list[Body]) -> None:
    """Put bodies that were followed backwards where they are at the first time, and their paths the right way round; in
    place."""
    for number, body in enumerate(bodies, 1):
        last = len(body.offsets) - 1
        put_at(labelled, number, body, last)
        bodies[number - 1] = body.started_at(last).backwards()


def put_at(labelled: Labelled, number: int, body: Body, t: int) -> None:
    """Put the Gaussians of a body where it is at a time; in place."""
    rows = np.flatnonzero(labelled.labels == number)
    labelled.means[rows], labelled.quats[rows] = body.placed(t, labelled.means[rows], labelled.quats[rows])


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
