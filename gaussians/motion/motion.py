"""Motion of a scene over time, as little of it as needed: rigid paths of Gaussians (`Track`), how some look for a while
(`Look`), and small displacements of single ones (`Residual`), together a `Motion`.

The cloud as stored is the scene at `Motion.start`: every pose there is the identity, so that what knows no time sees
the scene at its start. Gaussians are named by their stable ids. A Gaussian at x of the cloud is first displaced by
residuals, then placed by the tracks that hold it, in their order: a later one moves what earlier ones placed (the
wheel, then the toy). Times are seconds, angles radians, lengths scene units, all in the world frame.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, Self

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from torch import Tensor

from ..errors import UserError
from ..rotations import IDENTITY
from . import keys
from .runs import checked_runs, held_by, ids_of, runs_of, whole_numbers

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
Kind = Literal["rigid", "hinge", "slide", "spin"]

KINDS: tuple[Kind, ...] = ("rigid", "hinge", "slide", "spin")
AT_REST = 1e-4  # the largest turn (radians) and shift (of the track's size) of a pose that counts as the identity
_UNIT = 1e-3  # by how much the length of a unit vector in a file may differ from one


@dataclass(frozen=True, eq=False)
class Track:
    """Where some Gaussians are as a function of time.

    A point x is at `R(t) @ (x - pivot) + pivot + offset(t)`. Before the first and after the last key the pose is that
    of the key; a `spin` goes on with its last rate. `rigid`, `poses_at`, `along`, `hinge`, `slide` and `spin` make one.

    Attributes:
        runs: `[R, 2]` sorted, disjoint intervals [start, stop) of stable ids (`GaussianCloud.ids`).
        times: `[K]` ascending, seconds.
        quats: `[K, 4]` wxyz, unit: the rotation at each key.
        offsets: `[K, 3]` scene units.
        pivot: `[3]` world point.
        kind: "rigid" for any path; "hinge", "slide" and "spin" have all keys on one axis.
        axis: `[3]` unit, world, of a hinge, slide or spin; else None.
        angles: `[K]` radians of a hinge or spin, counter-clockwise from the tip of the axis, or scene units of a slide;
            `quats` and `offsets` follow from them. Else None.
        smooth: monotone cubics between keys, which do not overshoot and are at rest at both ends (a spin is not);
            else straight lines.
        name: what a person calls it; may be empty.
        frame: `[3, 3]` orthogonal: its columns are the directions along each of which `offsets` follow a curve of their
            own; None: the world's axes. A rigid path that is turned takes them along, so that it stays the same path.
    """

    runs: I64
    times: F64
    quats: F64
    offsets: F64
    pivot: F64
    kind: Kind = "rigid"
    axis: F64 | None = None
    angles: F64 | None = None
    smooth: bool = True
    name: str = ""
    frame: F64 | None = None

    def __post_init__(self) -> None:
        times = _array(self.times, "times", (-1,))
        k = len(times)
        if self.kind not in KINDS:
            raise UserError(f"a track's kind must be one of {', '.join(KINDS)}, not {self.kind!r}")
        if not k or not (np.diff(times) > 0).all():
            raise UserError("a track needs at least one key, and the times of its keys must ascend")
        made: dict[str, Any] = {"runs": checked_runs(self.runs), "times": times}
        made["pivot"] = _array(self.pivot, "pivot", (3,))
        if self.frame is not None:
            made["frame"] = frame = _array(self.frame, "frame", (3, 3))
            if self.kind != "rigid" or np.abs(frame @ frame.T - np.eye(3)).max() > _UNIT:
                raise UserError("the frame of a track must be orthogonal, and only rigid tracks have one")
        if self.kind == "rigid":
            if self.axis is not None or self.angles is not None:
                raise UserError("a rigid track has rotations and offsets, no axis and no angles")
            made |= {"quats": _unit(self.quats, "quats", (k, 4)), "offsets": _array(self.offsets, "offsets", (k, 3))}
        else:
            if self.axis is None or self.angles is None:
                raise UserError(f"a {self.kind} needs an axis and an angle (or a distance) at each key")
            axis, angles = _unit(self.axis, "axis", (3,)), _array(self.angles, "angles", (k,))
            slides = self.kind == "slide"
            made |= {"axis": axis, "angles": angles}
            made["quats"] = np.tile(IDENTITY, (k, 1)) if slides else keys.about(axis, angles)
            made["offsets"] = angles[:, None] * axis if slides else np.zeros((k, 3))
        for name, value in made.items():
            object.__setattr__(self, name, value)

    @classmethod
    def rigid(
        cls,
        ids: ArrayLike,
        times: ArrayLike,
        quats: ArrayLike | None = None,
        offsets: ArrayLike | None = None,
        pivot: ArrayLike = (0.0, 0.0, 0.0),
        smooth: bool = True,
        name: str = "",
    ) -> Self:
        """A path of poses: unit quaternions `[K, 4]` (None: no turn) about a pivot, and offsets `[K, 3]` (None: 0)."""
        k = np.asarray(times).size
        turns = np.tile(IDENTITY, (k, 1)) if quats is None else quats
        ways = np.zeros((k, 3)) if offsets is None else offsets
        return cls(runs_of(ids), times, turns, ways, pivot, smooth=smooth, name=name)  # type: ignore[arg-type]

    @classmethod
    def poses_at(
        cls,
        ids: ArrayLike,
        times: ArrayLike,
        rotations: ArrayLike,
        shifts: ArrayLike,
        pivot: ArrayLike = (0.0, 0.0, 0.0),
        smooth: bool = True,
        name: str = "",
    ) -> Self:
        """A path through maps `x -> rotation @ x + shift`, `[K, 3, 3]` and `[K, 3]`.

        The pivot does not change the maps, only the way between them; the middle of the body is the natural one.
        """
        turns = np.asarray(rotations, dtype=np.float64).reshape(-1, 3, 3)
        middle = np.asarray(pivot, dtype=np.float64)
        offsets = np.asarray(shifts, dtype=np.float64).reshape(-1, 3) + turns @ middle - middle
        return cls.rigid(ids, times, keys.quaternions(turns), offsets, middle, smooth, name)

    @classmethod
    def along(cls, ids: ArrayLike, times: ArrayLike, path: ArrayLike, smooth: bool = True, name: str = "") -> Self:
        """A path without turns: points `[K, 3]` that some point of the body passes; the first is where it is."""
        points = np.asarray(path, dtype=np.float64).reshape(-1, 3)
        return cls.rigid(ids, times, None, points - points[:1], smooth=smooth, name=name)

    @classmethod
    def hinge(
        cls,
        ids: ArrayLike,
        times: ArrayLike,
        angles: ArrayLike,
        axis: ArrayLike,
        pivot: ArrayLike,
        smooth: bool = True,
        name: str = "",
    ) -> Self:
        """A turn by angles `[K]` (radians) about the line through `pivot` along `axis`."""
        return cls._on_axis("hinge", ids, times, angles, axis, pivot, smooth, name)

    @classmethod
    def slide(
        cls,
        ids: ArrayLike,
        times: ArrayLike,
        distances: ArrayLike,
        axis: ArrayLike,
        smooth: bool = True,
        name: str = "",
    ) -> Self:
        """A shift by distances `[K]` (scene units) along `axis`."""
        return cls._on_axis("slide", ids, times, distances, axis, (0.0, 0.0, 0.0), smooth, name)

    @classmethod
    def spin(
        cls,
        ids: ArrayLike,
        turns_a_second: float,
        axis: ArrayLike,
        pivot: ArrayLike,
        start: float = 0.0,
        name: str = "",
    ) -> Self:
        """A turn without an end about the line through `pivot` along `axis`, from `start` (seconds) on."""
        return cls._on_axis(
            "spin", ids, (start, start + 1), (0.0, 2 * math.pi * turns_a_second), axis, pivot, True, name
        )

    @classmethod
    def _on_axis(
        cls,
        kind: Kind,
        ids: ArrayLike,
        times: ArrayLike,
        angles: ArrayLike,
        axis: ArrayLike,
        pivot: ArrayLike,
        smooth: bool,
        name: str,
    ) -> Self:
        direction = np.asarray(axis, dtype=np.float64).reshape(-1)
        length = float(np.linalg.norm(direction))
        if direction.shape != (3,) or not 0 < length < math.inf:
            raise UserError(f"the axis of a {kind} must be a finite vector that is not zero, got {axis!r}")
        made = {"axis": direction / length, "angles": angles, "smooth": smooth, "name": name}
        return cls(runs_of(ids), times, _NONE, _NONE, pivot, kind, **made)  # type: ignore[arg-type]

    @property
    def ids(self) -> I64:
        """Its stable ids `[M]`, ascending."""
        return ids_of(self.runs)

    def __len__(self) -> int:
        """The number of ids that it holds."""
        return int((self.runs[:, 1] - self.runs[:, 0]).sum())

    @property
    def still(self) -> bool:
        """Whether its pose is the identity at every time."""
        if self.angles is not None and np.ptp(self.angles) > AT_REST:  # a full turn is at rest at its keys only
            return False
        return all(_rests(self, *found) for found in zip(*poses(self, self.times), strict=True))


_NONE = np.zeros(0)


@dataclass(frozen=True, eq=False)
class Look:
    """How some Gaussians look during a time. Arrays of any kind are taken.

    Attributes:
        ids: `[n]` stable ids, ascending.
        start, stop: seconds, from `start` to before `stop`; may be infinite.
        sh: `[n, K, 3]` float32 harmonics as they are in the cloud as stored (tracks turn them with the thing), or None.
        opacities: `[n]` float32 from 0 to below 1, or None. A Gaussian of opacity 0 is left out of the cloud.
    """

    ids: I64
    start: float
    stop: float
    sh: Tensor | None = None
    opacities: Tensor | None = None

    def __post_init__(self) -> None:
        ids = _ids(self.ids, "look")
        start, stop = _seconds(self.start), _seconds(self.stop)
        if not start < stop:
            raise UserError(f"a look must begin before it ends, not last from {self.start} to {self.stop} s")
        sh, opacities = _tensor(self.sh, "harmonics"), _tensor(self.opacities, "opacities")
        if sh is not None and (sh.ndim != 3 or sh.shape[0] != len(ids) or sh.shape[2] != 3):
            raise UserError(f"the harmonics of a look of {len(ids)} Gaussians must be [n, K, 3]")
        if sh is not None and not bool(sh.isfinite().all()):
            raise UserError("the harmonics of a look must be finite")
        if opacities is not None:
            if tuple(opacities.shape) != (len(ids),):
                raise UserError(f"the opacities of a look of {len(ids)} Gaussians must be [n]")
            if not bool(((opacities >= 0) & (opacities < 1)).all()):
                raise UserError("the opacities of a look must be from 0 to below 1")
        made = {"ids": ids, "start": start, "stop": stop, "sh": sh, "opacities": opacities}
        for name, value in made.items():
            object.__setattr__(self, name, value)

    def lasts_at(self, time: float) -> bool:
        """Whether Gaussians look like this at a time, seconds."""
        return self.start <= time < self.stop


@dataclass(frozen=True, eq=False)
class Residual:
    """Small displacements of single Gaussians, of low rank: `sum over b of basis_b(t) * weights[:, b]`.

    They apply to the cloud as stored, before its tracks. Between keys the basis follows monotone cubics.

    Attributes:
        ids: `[n]` stable ids, ascending.
        times: `[K]` ascending, seconds.
        basis: `[K, B]`, 0 at the start of the motion.
        weights: `[n, B, 3]` float32, scene units.
    """

    ids: I64
    times: F64
    basis: F64
    weights: NDArray[np.float32]

    def __post_init__(self) -> None:
        ids = _ids(self.ids, "residual")
        times = _array(self.times, "times", (-1,))
        if not len(times) or not (np.diff(times) > 0).all():
            raise UserError("a residual needs at least one key, and the times of its keys must ascend")
        basis = _array(self.basis, "basis", (len(times), -1))
        weights = _array(self.weights, "weights", (len(ids), basis.shape[1], 3)).astype(np.float32)
        for name, value in {"ids": ids, "times": times, "basis": basis, "weights": weights}.items():
            object.__setattr__(self, name, value)

    @property
    def still(self) -> bool:
        """Whether it displaces nothing at any time."""
        return not (self.basis.any() and self.weights.any())

    def at(self, times: F64) -> F64:
        """The basis `[T, B]` at times."""
        return np.asarray(keys.between(self.times, self.basis, times, smooth=True))

    def displacements(self, time: float) -> F64:
        """`[n, 3]` at a time, scene units."""
        return np.asarray(np.einsum("b,nbc->nc", self.at(np.array([time], dtype=np.float64))[0], self.weights))


@dataclass(frozen=True, eq=False)
class Motion:
    """All that changes with time in a scene.

    Attributes:
        tracks: paths; applied in their order, a later one moves what earlier ones placed.
        looks: appearances for a while; of two at one time the later one holds.
        residuals: displacements of single Gaussians, before the tracks.
        start, stop: of the scene, seconds. At `start` every pose is the identity.
    """

    tracks: tuple[Track, ...] = ()
    looks: tuple[Look, ...] = ()
    residuals: tuple[Residual, ...] = ()
    start: float = 0.0
    stop: float = 0.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.start) and math.isfinite(self.stop) and self.start <= self.stop):
            raise UserError(f"a motion must last from a start to a later stop, not from {self.start} to {self.stop} s")
        parts: dict[str, type] = {"tracks": Track, "looks": Look, "residuals": Residual}
        for name, kind in parts.items():
            given = getattr(self, name)
            if not isinstance(given, tuple) or not all(isinstance(each, kind) for each in given):
                raise UserError(
                    f"the {name} of a motion must be a tuple, as in ({name[:-1]},), not {type(given).__name__}"
                )
        for number, track in enumerate(self.tracks):
            if not _rests(track, *pose(track, self.start)):
                raise UserError(
                    f"track {track.name or number} is not at rest at the start of the motion ({self.start:g} s); the "
                    "cloud is the scene at the start, so that every pose there must be the identity"
                )
        for residual in self.residuals:
            away = np.abs(residual.displacements(self.start)).max(initial=0.0)
            if away > AT_REST * max(1e-6, float(np.abs(residual.weights).max(initial=0.0))):
                raise UserError(f"a residual is not 0 at the start of the motion ({self.start:g} s)")
        ends = max((float(track.times[-1]) for track in self.tracks), default=self.start)
        if self.stop == self.start < ends:
            raise UserError(
                f"a motion of no length: nothing would move; give its end, stop={ends:g} for all of its tracks"
            )

    def __bool__(self) -> bool:
        """Whether anything changes with time."""
        return bool(self.tracks or self.looks or self.residuals)

    def replace(self, **changes: Any) -> Self:
        """A new motion with some fields replaced."""
        return replace(self, **changes)

    @property
    def nbytes(self) -> int:
        """Bytes of its arrays."""
        arrays: list[Any] = []
        for track in self.tracks:
            arrays += [track.runs, track.times, track.pivot]
            arrays += [track.quats, track.offsets] if track.kind == "rigid" else [track.axis, track.angles]
        for look in self.looks:
            arrays += [look.ids, look.sh, look.opacities]
        for residual in self.residuals:
            arrays += [residual.ids, residual.times, residual.basis, residual.weights]
        return sum(int(a.nbytes) for a in arrays if a is not None)


def pose(track: Track, time: float) -> tuple[F64, F64]:
    """The map `x -> R @ x + shift` of a track at a time (seconds): R `[3, 3]`, shift `[3]`."""
    turns, shifts = poses(track, (time,))
    return turns[0], shifts[0]


def poses(track: Track, times: ArrayLike) -> tuple[F64, F64]:
    """The maps `x -> R @ x + shift` of a track at times `[T]`, seconds: R `[T, 3, 3]`, shifts `[T, 3]`.

    Raises:
        UserError: a time is not finite.
    """
    now = np.asarray(times, dtype=np.float64).reshape(-1)
    if not np.isfinite(now).all():
        raise UserError("a time must be a finite number of seconds")
    if track.axis is not None and track.angles is not None:
        angles = _angles(track, now)
        if track.kind == "slide":
            return np.tile(np.eye(3), (len(now), 1, 1)), angles[:, None] * track.axis
        turns = keys.matrices(keys.about(track.axis, angles))
        return turns, track.pivot - turns @ track.pivot
    turns = keys.matrices(keys.turns_between(track.times, track.quats, now, track.smooth))
    frame = np.eye(3) if track.frame is None else track.frame
    offsets = keys.between(track.times, track.offsets @ frame, now, track.smooth) @ frame.T
    return turns, offsets + track.pivot - turns @ track.pivot


def _angles(track: Track, now: F64) -> F64:
    """`[T]` angles (or distances) of a track on an axis."""
    assert track.angles is not None
    spins = track.kind == "spin"
    found = keys.between(track.times, track.angles[:, None], now, track.smooth, ease=not spins)[:, 0]
    if spins and len(track.times) > 1:
        rate = (track.angles[-1] - track.angles[-2]) / (track.times[-1] - track.times[-2])
        found = found + rate * np.maximum(0.0, now - track.times[-1])
    return np.asarray(found)


def _rests(track: Track, turn: F64, shift: F64) -> bool:
    """Whether a pose of a track is the identity."""
    size = 1e-6 + float(np.abs(track.pivot).max()) + float(np.abs(track.offsets).max())
    return bool(np.abs(turn - np.eye(3)).max() <= AT_REST and np.abs(shift).max() <= AT_REST * size)


def moving_ids(motion: Motion | None) -> I64:
    """Stable ids `[M]` of all that moves at some time, ascending. Looks move nothing."""
    if motion is None:
        return np.zeros(0, dtype=np.int64)
    parts = [track.ids for track in motion.tracks if not track.still]
    parts += [residual.ids for residual in motion.residuals if not residual.still]
    return np.unique(np.concatenate(parts)) if parts else np.zeros(0, dtype=np.int64)


def mentioned_ids(motion: Motion | None) -> I64:
    """Stable ids `[M]` of all that a motion says anything of, ascending."""
    if motion is None:
        return np.zeros(0, dtype=np.int64)
    parts = [track.ids for track in motion.tracks]
    parts += [part.ids for part in motion.looks] + [part.ids for part in motion.residuals]
    return np.unique(np.concatenate(parts)) if parts else np.zeros(0, dtype=np.int64)


def without_ids(motion: Motion | None, gone: ArrayLike) -> Motion | None:
    """The motion without some ids, in any order: what remains of a scene from which they were removed.

    The same object if it holds none of them; None if nothing is left that changes with time.
    """
    if motion is None:
        return None
    lost = np.asarray(gone, dtype=np.int64).reshape(-1)
    held = mentioned_ids(motion)
    kept = held[~np.isin(held, lost)]
    return motion if len(kept) == len(held) else _mapped(motion, kept, kept)


def with_only(motion: Motion | None, kept: ArrayLike) -> Motion | None:
    """The motion of some ids alone, in any order; None if nothing is left that changes with time."""
    if motion is None:
        return None
    held = mentioned_ids(motion)
    return without_ids(motion, held[~np.isin(held, np.asarray(kept, dtype=np.int64).reshape(-1))])


def renumbered(motion: Motion | None, old: ArrayLike, new: ArrayLike) -> Motion | None:
    """The motion with ids `old` `[M]` called `new` `[M]`, both without repeats; ids that are not in `old` are dropped.

    None if nothing is left that changes with time.
    """
    if motion is None:
        return None
    before, after = (np.asarray(ids, dtype=np.int64).reshape(-1) for ids in (old, new))
    order = np.argsort(before)
    return _mapped(motion, before[order], after[order])


def _mapped(motion: Motion, old: I64, new: I64) -> Motion | None:
    """`old` ascends."""

    def called(ids: I64) -> tuple[NDArray[np.bool_], I64]:
        place = np.minimum(np.searchsorted(old, ids), max(len(old) - 1, 0))
        stays = old[place] == ids if len(old) else np.zeros(len(ids), dtype=np.bool_)
        return stays, new[place[stays]] if len(old) else ids[:0]

    tracks = [replace(track, runs=runs_of(called(track.ids)[1])) for track in motion.tracks]
    looks, residuals = [], []
    for look in motion.looks:
        stays, names = called(look.ids)
        order = np.argsort(names)
        rows = torch.from_numpy(np.flatnonzero(stays)[order])
        sh, opacities = (None if v is None else v[rows.to(v.device)] for v in (look.sh, look.opacities))
        looks.append(replace(look, ids=names[order], sh=sh, opacities=opacities))
    for residual in motion.residuals:
        stays, names = called(residual.ids)
        order = np.argsort(names)
        residuals.append(replace(residual, ids=names[order], weights=residual.weights[stays][order]))
    left = motion.replace(
        tracks=tuple(t for t in tracks if len(t.runs)),
        looks=tuple(look for look in looks if len(look.ids)),
        residuals=tuple(r for r in residuals if len(r.ids)),
    )
    return left or None


def carried(motion: Motion | None, ids: ArrayLike, matrix: ArrayLike, offset: ArrayLike) -> Motion | None:
    """The motion after Gaussians `ids` of the stored cloud were mapped by A: `x -> matrix @ x + offset`.

    Each pose p of theirs becomes A p A^-1, so that the scene at every time is mapped as the cloud was: a door that is
    moved and turned opens as before in its new place. A track that also holds others is divided. Where A stretches
    unevenly, paths follow all of A and turns only its rotation, since bodies stay rigid.

    Args:
        ids: `[M]`, in any order.
        matrix: `[3, 3]`, not singular; may scale and mirror.
        offset: `[3]` scene units.
    """
    held = np.asarray(ids, dtype=np.int64).reshape(-1)
    if motion is None or not np.isin(mentioned_ids(motion), held).any():
        return motion
    linear = np.asarray(matrix, dtype=np.float64).reshape(3, 3)
    away = np.asarray(offset, dtype=np.float64).reshape(3)
    tracks: list[Track] = []
    for track in motion.tracks:
        own = track.ids
        inside = np.isin(own, held)
        if inside.any():
            if not inside.all():
                tracks.append(replace(track, runs=runs_of(own[~inside])))
            track = _conjugated(replace(track, runs=runs_of(own[inside])), linear, away)
        tracks.append(track)
    looks = tuple(_turned_look(look, held, linear) for look in motion.looks)
    residuals = []
    for residual in motion.residuals:
        inside = np.isin(residual.ids, held)
        weights = np.where(inside[:, None, None], residual.weights @ linear.T, residual.weights)
        residuals.append(replace(residual, weights=weights))
    return motion.replace(tracks=tuple(tracks), looks=looks, residuals=tuple(residuals))


def rotation_in(matrix: F64) -> F64:
    """The nearest orthogonal matrix `[3, 3]` of a matrix (its polar factor), mirrored if that is.

    Raises:
        UserError: the matrix is singular or not finite.
    """
    if not np.isfinite(matrix).all() or abs(float(np.linalg.det(matrix))) < 1e-12:
        raise UserError("a motion cannot be mapped by a matrix that flattens it")
    left, _, right = np.linalg.svd(matrix)
    return np.asarray(left @ right)


def _conjugated(track: Track, linear: F64, away: F64) -> Track:
    turn = rotation_in(linear)
    hand = float(np.sign(np.linalg.det(turn)))  # a mirror turns the sense of rotation
    pivot = linear @ track.pivot + away
    if track.axis is None or track.angles is None:
        turns = turn @ keys.matrices(track.quats) @ turn.T
        frame = turn if track.frame is None else turn @ track.frame
        quats, offsets = keys.quaternions(turns), track.offsets @ linear.T
        return replace(track, quats=quats, offsets=offsets, pivot=pivot, frame=frame)
    if track.kind == "slide":
        along = linear @ track.axis
        length = float(np.linalg.norm(along))
        return replace(track, axis=along / length, angles=track.angles * length, pivot=pivot)
    axis = hand * (turn @ track.axis)
    return replace(track, axis=axis / np.linalg.norm(axis), pivot=pivot)


def _turned_look(look: Look, held: I64, linear: F64) -> Look:
    """A look whose harmonics are turned as those of the mapped Gaussians are."""
    from ..harmonics import rotate

    rows = torch.from_numpy(np.flatnonzero(np.isin(look.ids, held)))
    turn = rotation_in(linear)
    if look.sh is None or not len(rows) or np.linalg.det(turn) < 0 or np.allclose(turn, np.eye(3), atol=1e-9):
        return look
    sh = look.sh.clone()
    sh[rows] = rotate(look.sh[rows], torch.from_numpy(turn))
    return replace(look, sh=sh)


def composed(earlier: Motion | None, later: Motion | None) -> Motion | None:
    """Both motions at once: the later one moves what the earlier one placed, and its looks hold over earlier ones.

    They begin at the same time; the motion lasts as long as the longer one.

    Raises:
        UserError: they do not begin at the same time.
    """
    if earlier is None or later is None:
        return earlier or later
    if earlier.start != later.start:
        raise UserError(f"motions that begin at {earlier.start:g} s and {later.start:g} s cannot be joined")
    return Motion(
        (*earlier.tracks, *later.tracks),
        (*earlier.looks, *later.looks),
        (*earlier.residuals, *later.residuals),
        earlier.start,
        max(earlier.stop, later.stop),
    )


def combinations(motion: Motion) -> list[tuple[I64, tuple[int, ...]]]:
    """Ids that the same tracks hold: intervals `[R, 2]` and the numbers of these tracks, ascending."""
    if not motion.tracks:
        return []
    edges = np.unique(np.concatenate([track.runs.reshape(-1) for track in motion.tracks]))
    if not len(edges):
        return []
    cells = np.stack([edges[:-1], edges[1:]], axis=1)
    member = np.stack([held_by(track.runs, cells[:, 0]) for track in motion.tracks], axis=1)  # [cells, tracks]
    kinds, which = np.unique(member, axis=0, return_inverse=True)
    found: list[tuple[I64, tuple[int, ...]]] = []
    for number, kind in enumerate(kinds):
        if kind.any():
            found.append((cells[which.reshape(-1) == number], tuple(int(i) for i in np.flatnonzero(kind))))
    return found


def chained(tracks: Sequence[Track], times: ArrayLike) -> tuple[F64, F64]:
    """The maps `x -> R @ x + shift` of tracks applied one after the other at times `[T]`: `[T, 3, 3]`, `[T, 3]`."""
    now = np.asarray(times, dtype=np.float64).reshape(-1)
    turn, shift = np.tile(np.eye(3), (len(now), 1, 1)), np.zeros((len(now), 3))
    for track in tracks:
        turns, shifts = poses(track, now)
        turn, shift = turns @ turn, (turns @ shift[:, :, None])[:, :, 0] + shifts
    return turn, shift


def _array(values: Any, name: str, shape: tuple[int, ...]) -> F64:
    """Finite numbers of a shape, -1 for any length. Raises UserError otherwise."""
    try:
        found = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise UserError(f"{name} of a motion must be numbers, not {values!r:.60}") from error
    fits = found.ndim == len(shape) and all(want in (-1, have) for want, have in zip(shape, found.shape, strict=True))
    if not np.isfinite(found).all():
        where = np.argwhere(~np.isfinite(found))[0].tolist()
        raise UserError(f"{name} of a motion must be finite, but at {where} there is {found[tuple(where)]}")
    if not fits:
        wanted = ", ".join("any" if n < 0 else str(n) for n in shape)
        raise UserError(f"{name} of a motion must be numbers of shape [{wanted}], got {list(found.shape)}")
    return found


def _ids(values: ArrayLike, what: str) -> I64:
    """The ids of a look or a residual, which stand in the order of its other arrays.

    Raises:
        UserError: they are no whole numbers from 0 on, or do not ascend.
    """
    whole_numbers(values)
    found: I64 = np.asarray(values).astype(np.int64).reshape(-1)
    if len(found) and (found[0] < 0 or not (np.diff(found) > 0).all()):
        raise UserError(f"the ids of a {what} must ascend, from 0 on")
    return found


def _seconds(value: Any) -> float:
    """A time, also an infinite one. Raises UserError if it is no number."""
    if isinstance(value, (int, float, np.number)) and not math.isnan(value):
        return float(value)
    raise UserError(f"a look begins and ends at numbers of seconds, not {value!r:.60}; use math.inf for ever")


def _tensor(values: Any, name: str) -> Tensor | None:
    """float32 values of a look, of any kind of array; None stays. Raises UserError if they are no numbers."""
    if values is None or isinstance(values, Tensor):
        return values if values is None or values.dtype == torch.float32 else values.float()
    try:
        return torch.from_numpy(np.array(values, dtype=np.float32))
    except (TypeError, ValueError) as error:
        raise UserError(f"the {name} of a look must be numbers, not {values!r:.60}") from error


def _unit(values: Any, name: str, shape: tuple[int, ...]) -> F64:
    """Vectors of length one. Raises UserError if one is not."""
    found = _array(values, name, shape)
    length = np.linalg.norm(found, axis=-1, keepdims=True)
    if not (np.abs(length - 1) < _UNIT).all():
        raise UserError(f"{name} of a motion must have length one")
    return np.asarray(found / length)
