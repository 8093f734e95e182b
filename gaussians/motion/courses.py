"""Where a group of a scene is through time: its boxes, and how fast it moves and turns.

Names: T times, `[T]`, seconds; lengths are scene units, angles radians. A pose is a rotation R and a shift s: a point x
of the start is at R x + s.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import torch
from numpy.typing import NDArray

from ..language.field.group_index import index_groups
from ..scene import Scene
from ..world.box import Box, Boxes
from . import keys
from .boxes import boxes_over, groups_of
from .holding import STEP, Span, grid
from .motion import Motion, Residual, Track, chained, combinations
from .runs import held_by

F64 = NDArray[np.float64]
SHARE = 0.5  # of a group's Gaussians: when more than these are in tracks, the group moves; else a part of it does
_STRAYS = 0.02  # of a group's Gaussians: fewer moving ones are strays of what moves beside it
_H = 1e-3  # seconds before and after a time between which a speed is measured
_SPREAD = 200  # Gaussians of a piece whose ways tell its speed


@dataclass(frozen=True, eq=False)
class Piece:
    """Some Gaussians of a group that move alike.

    Attributes:
        tracks: that move them, in their order; none for what stands still, or only changes its shape.
        points: `[P, 3]` some of them at the start.
        middle: `[3]` of them at the start.
        share: of the group's Gaussians, in [0, 1].
        bent: `[T, P, 3]` displacements of the points at times, before the tracks; None: its shape does not change.
    """

    tracks: tuple[Track, ...]
    points: F64
    middle: F64
    share: float
    bent: Callable[[F64], F64] | None = None

    @property
    def moves(self) -> bool:
        """Whether it is in tracks, or changes its shape."""
        return bool(self.tracks) or self.bent is not None

    def poses(self, times: F64) -> tuple[F64, F64]:
        """`[T, 3, 3]` rotations and `[T, 3]` shifts."""
        return chained(list(self.tracks), times)

    def center(self, times: F64) -> F64:
        """`[T, 3]` its middle at times."""
        turn, shift = self.poses(times)
        away = np.zeros((len(times), 3)) if self.bent is None else self.bent(times).mean(axis=1)
        return np.asarray(np.einsum("tij,tj->ti", turn, self.middle + away) + shift)

    def places(self, times: F64) -> F64:
        """`[T, P, 3]` its points at times."""
        turn, shift = self.poses(times)
        points = self.points if self.bent is None else self.points + self.bent(times)
        return np.asarray(points @ turn.transpose(0, 2, 1) + shift[:, None])


@dataclass(frozen=True, eq=False)
class Course:
    """One group through the time of its scene.

    Attributes:
        group: its id.
        still: its box at the start.
        pieces: the largest first.
        start, stop: the time of the scene, seconds.
        up: `[3]` unit, world.
        tracked: its boxes `[T]` where something of it moves.
    """

    group: int
    still: Box
    pieces: tuple[Piece, ...]
    start: float
    stop: float
    up: F64
    tracked: Callable[[F64], list[Box]]

    @cached_property
    def moving_share(self) -> float:
        """Share of its Gaussians that move."""
        return sum(p.share for p in self.pieces if p.moves)

    @cached_property
    def moves(self) -> bool:
        """Whether most of it is in tracks, or changes its shape; it may stand still for all that."""
        return self.moving_share > SHARE

    @cached_property
    def moving(self) -> Piece | None:
        """The largest piece that moves, None if there is none."""
        return next((p for p in self.pieces if p.moves), None)

    def boxes(self, times: F64) -> Boxes:
        """Its upright boxes at T times."""
        if self.moving is None:
            one = Boxes.of([self.still])
            return one.at(np.zeros(len(times), np.intp))
        return Boxes.of(self.tracked(times))

    def centers(self, times: F64) -> F64:
        """`[T, 3]` the middle of its moving piece; of what stands still the middle of its box."""
        if self.moving is None:
            return np.tile(np.array(self.still.center), (len(times), 1))
        return self.moving.center(times)

    def velocities(self, times: F64) -> F64:
        """`[T, 3]` of the middle, units a second."""
        early, late = self._around(times)
        return np.asarray((self.centers(late) - self.centers(early)) / (late - early)[:, None])

    def rates(self, times: F64) -> F64:
        """`[T]` speed of the fastest Gaussian of its moving piece, units a second: of what only turns, too."""
        if self.moving is None:
            return np.zeros(len(times))
        early, late = self._around(times)
        way = self.moving.places(late) - self.moving.places(early)
        return np.asarray(np.linalg.norm(way, axis=2).max(axis=1) / (late - early))

    def turns(self, times: F64) -> F64:
        """`[T, 3]` vectors along the axis about which its moving piece turns, radians a second, counter-clockwise."""
        if self.moving is None:
            return np.zeros((len(times), 3))
        early, late = self._around(times)
        turn, later = self.moving.poses(early)[0], self.moving.poses(late)[0]
        return rotation_vectors(later @ turn.transpose(0, 2, 1)) / (late - early)[:, None]

    def angles(self, times: F64) -> F64:
        """`[T]` angle of its moving piece to its pose at the start, in [0, pi]."""
        if self.moving is None:
            return np.zeros(len(times))
        return np.asarray(np.linalg.norm(rotation_vectors(self.moving.poses(times)[0]), axis=1))

    def tilts(self, times: F64) -> F64:
        """`[T]` angle from the vertical of what of its moving piece is upright at the start, in [0, pi]."""
        if self.moving is None:
            return np.zeros(len(times))
        return np.asarray(np.arccos(np.clip(self.moving.poses(times)[0] @ self.up @ self.up, -1, 1)))

    def grid(self, span: Span | None = None, step: float = STEP) -> F64:
        """Times of the scene, or of a span, for sampling."""
        return grid(*(span or (self.start, self.stop)), step)

    def _around(self, times: F64) -> tuple[F64, F64]:
        """Times just before and after; on one side only at the ends of the scene."""
        late = np.minimum(times + _H, self.stop)
        early = np.maximum(times - _H, self.start)
        return early, np.where(late > early, late, early + _H)


def courses(scene: Scene) -> dict[int, Course]:
    """The groups of an embedded scene of which Gaussians move, by id; none in a scene without motion."""
    if scene.motion is None or scene.language is None:
        return {}
    touched = {*boxes_over(scene, (scene.motion.start,)), *_bent_groups(scene)}
    found = {group: course_of(scene, group) for group in sorted(touched)}
    return {group: course for group, course in found.items() if course.moving is not None}


def course_of(scene: Scene, group: int) -> Course:
    """The course of one group of an embedded scene; it stands still in a scene without motion."""
    assert scene.language is not None
    row, up, motion = scene.language.groups[group], scene.frame.up_vector, scene.motion

    def tracked(times: F64) -> list[Box]:
        return boxes_over(scene, times).get(group) or [row.box] * len(times)

    if motion is None:
        return Course(group, row.box, (), 0.0, 0.0, up, tracked)
    rows = index_groups(scene.cloud).rows(scene.language.leaves(group))
    ids = scene.cloud.ids[torch.from_numpy(rows)].cpu().numpy()
    pieces, left = list[Piece](), np.ones(len(ids), bool)
    for runs, numbers in combinations(motion):
        held = held_by(runs, ids)
        left &= ~held
        if held.sum() > _STRAYS * len(ids):
            tracks = tuple(motion.tracks[i] for i in numbers)
            pieces.append(_piece(scene, rows[held], tracks, len(ids)))
    for residual in motion.residuals:
        held = np.isin(ids, residual.ids) & left
        left &= ~held
        if held.sum() > _STRAYS * len(ids):
            pieces.append(_piece(scene, rows[held], (), len(ids)))
    if left.sum() > _STRAYS * len(ids):
        pieces.append(_piece(scene, rows[left], (), len(ids)))
    pieces.sort(key=lambda p: -p.share)
    return Course(group, row.box, tuple(pieces), motion.start, motion.stop, up, tracked)


def rotation_vectors(turns: F64) -> F64:
    """`[T, 3]` axis times angle in [0, pi] of rotations `[T, 3, 3]`."""
    quats = keys.quaternions(turns)
    quats = np.where(quats[:, :1] < 0, -quats, quats)
    sine = np.linalg.norm(quats[:, 1:], axis=1)
    angle = 2 * np.arctan2(sine, quats[:, 0])
    return np.asarray(quats[:, 1:] * np.where(sine > 1e-12, angle / np.maximum(sine, 1e-12), 2.0)[:, None])


def _piece(scene: Scene, rows: NDArray[np.int64], tracks: tuple[Track, ...], count: int) -> Piece:
    """Some rows of a group of `count` Gaussians as a piece."""
    points = scene.cloud.means[torch.from_numpy(rows)].double().cpu().numpy()
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    some = slice(None, None, max(len(points) // _SPREAD, 1))
    ids = scene.cloud.ids[torch.from_numpy(rows[some])].cpu().numpy()
    return Piece(tracks, points[some], middle, len(rows) / count, _bent(scene.motion, ids))


def _bent(motion: Motion | None, ids: NDArray[np.int64]) -> Callable[[F64], F64] | None:
    """The displacements `[T, P, 3]` of some Gaussians at times; None: they have none."""
    own = list[tuple[Residual, NDArray[np.int64], NDArray[np.float32]]]()
    for residual in () if motion is None else motion.residuals:
        held = np.flatnonzero(np.isin(ids, residual.ids))
        if len(held):
            own.append((residual, held, residual.weights[np.searchsorted(residual.ids, ids[held])]))
    if not own:
        return None

    def bent(times: F64) -> F64:
        found = np.zeros((len(times), len(ids), 3))
        for residual, held, weights in own:
            found[:, held] += np.einsum("tb,nbc->tnc", residual.at(times), weights)
        return found

    return bent


def _bent_groups(scene: Scene) -> set[int]:
    """The groups of which Gaussians are displaced one by one, and what these are parts of."""
    assert scene.motion is not None and scene.language is not None
    if not scene.motion.residuals:
        return set()
    ids = torch.from_numpy(np.concatenate([residual.ids for residual in scene.motion.residuals]))
    return groups_of(scene.language, scene.cloud.group.cpu()[torch.isin(scene.cloud.ids.cpu(), ids)].numpy())
