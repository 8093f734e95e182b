"""A motion from frames that show the same Gaussians in the same order: bodies are rows that move alike.

Rows that stay are left alone. Of the others a few neighbours say how a body would move (Kabsch's fit of each frame);
all rows that follow belong to it, and it is fitted again to all of them; the largest body first, until none is left.
What no body explains becomes a residual of low rank.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..cloud import GaussianCloud
from ..errors import UserError
from .motion import Motion, Residual, Track, poses

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

TOLERANCE = 1e-4  # of the scene's diagonal: a shift below it is none
LEAST_BODY = 12  # rows that make a body
MOST_BODIES = 64
MOST_RANK = 16  # of the residual
_NEIGHBOURS = 24  # rows from which a body is guessed
_GUESSES = 24  # of each round
_SAMPLE = 4000  # rows on which guesses are compared
_SAME = 0.02  # the share by which sizes and colours of a Gaussian may differ between frames
SEED = 18


@dataclass(frozen=True)
class Found:
    """What was found in a sequence.

    Attributes:
        motion: tracks and residuals; None if nothing moves.
        bodies: number of rows of each track.
        left: number of moving rows that no body explains; their residual follows them.
        rank: of that residual.
        worst: the farthest that a Gaussian of the motion is from its place in a frame, scene units.
        recolored: number of rows whose colour or opacity changes, which the motion leaves out.
    """

    motion: Motion | None
    bodies: tuple[int, ...]
    left: int
    rank: int
    worst: float
    recolored: int


def motion_of(frames: Sequence[Callable[[], GaussianCloud]], times: Sequence[float]) -> Found:
    """The motion of a sequence; the cloud that it moves is the first frame.

    Args:
        frames: each gives the cloud at one of the times; they are read twice, one at a time.
        times: `[T]` ascending, seconds.

    Raises:
        UserError: the frames have different numbers of rows, or hold other Gaussians or another order.
    """
    first = frames[0]()
    start = first.means.cpu().numpy().astype(np.float64)
    size = float(np.linalg.norm(np.ptp(start, axis=0))) or 1.0
    moved, recolored = np.zeros(len(first), bool), np.zeros(len(first), bool)
    for number, frame in enumerate(frames[1:], start=1):
        cloud = frame()
        _require_same(first, cloud, number)
        away = np.linalg.norm(cloud.means.cpu().numpy() - start, axis=1)
        moved |= away > TOLERANCE * size
        recolored |= (cloud.sh[:, 0] - first.sh[:, 0]).abs().amax(dim=1).cpu().numpy() > _SAME
        recolored |= (cloud.opacities - first.opacities).abs().cpu().numpy() > _SAME
    rows = np.flatnonzero(moved).astype(np.int64)
    if not len(rows):
        return Found(None, (), 0, 0, 0.0, int(recolored.sum()))
    paths = np.stack([frame().means.cpu().numpy()[rows] for frame in frames]).astype(np.float64)  # [T, M, 3]
    names = first.ids.cpu().numpy()[rows]
    now, tolerance = np.asarray(times, dtype=np.float64), TOLERANCE * size
    bodies, left = _bodies(paths, tolerance)
    tracks = [_track(names[own], paths[:, own], now, tolerance) for own in bodies]
    order = np.argsort([-len(own) for own in bodies], kind="stable")
    tracks, bodies = [tracks[i] for i in order], [bodies[i] for i in order]
    residual, rest = _residual(names[left], paths[:, left], now, tolerance)
    worst = max([rest, *(_farthest(track, paths[:, own], now) for track, own in zip(tracks, bodies, strict=True))])
    residuals = () if residual is None else (residual,)
    motion = Motion(tuple(tracks), (), residuals, float(now[0]), float(now[-1]))
    rank = 0 if residual is None else residual.basis.shape[1]
    return Found(motion, tuple(len(own) for own in bodies), len(left), rank, worst, int(recolored.sum()))


def _require_same(first: GaussianCloud, cloud: GaussianCloud, number: int) -> None:
    if len(cloud) != len(first):
        raise UserError(
            f"file {number + 1} of the sequence has {len(cloud):,} Gaussians and the first one {len(first):,}; a "
            "sequence must hold the same Gaussians in the same order"
        )
    other = (cloud.scales - first.scales).abs() > _SAME * (cloud.scales + first.scales)
    if float(other.any(dim=1).float().mean()) > 0.5:
        raise UserError(
            f"file {number + 1} of the sequence holds other Gaussians than the first one, or in another order; a "
            "sequence must hold the same ones in the same order"
        )


def _bodies(paths: F64, tolerance: float) -> tuple[list[I64], I64]:
    """Rows of each body, and of none, of paths `[T, M, 3]`."""
    from scipy.spatial import cKDTree

    rng = np.random.default_rng(SEED)
    free = np.arange(paths.shape[1])
    found: list[I64] = []
    while len(free) >= LEAST_BODY and len(found) < MOST_BODIES:
        tree = cKDTree(paths[0, free])
        seeds = rng.choice(len(free), min(_GUESSES, len(free)), replace=False)
        _, near = tree.query(paths[0, free[seeds]], min(_NEIGHBOURS, len(free)))
        sample = free if len(free) <= _SAMPLE else rng.choice(free, _SAMPLE, replace=False)
        followers = [_followers(paths, sample, free[group], tolerance).sum() for group in near]
        own = free[near[int(np.argmax(followers))]]
        for _ in range(3):  # from a few neighbours to all of the body
            own = free[_followers(paths, free, own, tolerance)]
            if len(own) < LEAST_BODY:
                break
        if len(own) < LEAST_BODY:
            return found, free
        found.append(own)
        free = np.setdiff1d(free, own, assume_unique=True)
    return found, free


def _followers(paths: F64, rows: I64, body: I64, tolerance: float) -> NDArray[np.bool_]:
    """`[len(rows)]`: which rows follow the body of some rows through all frames."""
    if len(body) < 3:
        return np.zeros(len(rows), dtype=np.bool_)
    turns, shifts = _fitted(paths[:, body])
    follows = np.ones(len(rows), dtype=np.bool_)
    for turn, shift, there in zip(turns, shifts, paths, strict=True):
        here = np.flatnonzero(follows)
        away = paths[0, rows[here]] @ turn.T + shift - there[rows[here]]
        follows[here[np.einsum("ij,ij->i", away, away) > tolerance**2]] = False
    return follows


def _fitted(paths: F64) -> tuple[F64, F64]:
    """The rigid maps `[T, 3, 3]`, `[T, 3]` that bring the first of paths `[T, M, 3]` nearest to each (Kabsch 1976)."""
    middles = paths.mean(axis=1)
    centred = paths - middles[:, None]
    u, _, vt = np.linalg.svd(np.einsum("tmi,mj->tij", centred, centred[0]))
    hand = np.sign(np.linalg.det(u @ vt))
    u[:, :, 2] *= hand[:, None]
    turns = u @ vt
    return turns, middles - turns @ middles[0]


def _track(names: I64, paths: F64, times: F64, tolerance: float) -> Track:
    """The track of a body with the keys that it needs."""
    turns, shifts = _fitted(paths)
    turns[0], shifts[0] = np.eye(3), 0.0
    middle = paths[0].mean(axis=0)
    corners = paths[0][_corners(paths[0])]
    where = np.einsum("tij,pj->tpi", turns, corners) + shifts[:, None]
    keys = [0, len(times) - 1] if len(times) > 1 else [0]
    while True:
        track = Track.poses_at(names, times[keys], turns[keys], shifts[keys], middle)
        got_turns, got_shifts = poses(track, times)
        away = np.linalg.norm(np.einsum("tij,pj->tpi", got_turns, corners) + got_shifts[:, None] - where, axis=2)
        away = away.max(axis=1)
        worst = int(np.argmax(away))
        if away[worst] <= tolerance or worst in keys:
            return track
        keys = sorted({*keys, worst})


def _corners(points: F64) -> I64:
    """Rows of the outermost of some points `[M, 3]` along eight ways."""
    ways = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
    return np.unique(np.argmax(points @ ways.T, axis=0))


def _residual(names: I64, paths: F64, times: F64, tolerance: float) -> tuple[Residual | None, float]:
    """Displacements of the rows that no body explains, and the farthest that they leave a row from its place."""
    if not len(names):
        return None, 0.0
    ways = (paths - paths[0]).reshape(len(paths), -1)
    values, vectors = np.linalg.eigh(ways @ ways.T)
    vectors = vectors[:, np.argsort(-values)]
    rank, worst = 0, math.inf
    while rank < min(MOST_RANK, len(times)) and worst > tolerance:
        rank += 1
        basis = vectors[:, :rank]
        away = (ways - basis @ (basis.T @ ways)).reshape(paths.shape)
        worst = float(np.linalg.norm(away, axis=2).max())
    basis = vectors[:, :rank].copy()
    basis[0] = 0.0  # the first frame is the cloud itself; eigenvectors have rounding errors there
    weights = (basis.T @ ways).T.reshape(len(names), 3, rank).transpose(0, 2, 1)
    order = np.argsort(names)
    return Residual(names[order], times, basis, weights[order].astype(np.float32)), worst


def _farthest(track: Track, paths: F64, times: F64) -> float:
    turns, shifts = poses(track, times)
    worst = 0.0
    for turn, shift, there in zip(turns, shifts, paths, strict=True):
        worst = max(worst, float(np.linalg.norm(paths[0] @ turn.T + shift - there, axis=1).max()))
    return worst
