"""A body's poses at the frames' times as a track of few keys (`track_of`): on one axis where one explains them all."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .. import keys
from ..motion import Track, poses
from .bodies import Body, Line

F64 = NDArray[np.float64]

AXIS_SLACK = 1.5  # times the tolerance: a path is put on one axis if no pose is farther from it
LEAST_TURN = 0.12  # radians of a hinge; less is taken for noise
NEVER = 2.0  # times the tolerance: a body that moves less does not move


def track_of(body: Body, ids: NDArray[np.int64], times: F64, size: float, tolerance: float, name: str) -> Track | None:
    """The track of a body with the fewest keys that keeps all poses within a tolerance; None if it rests.

    Args:
        ids: of its Gaussians.
        times: `[T]` of the frames, seconds.
        size: of the body, scene units: a turn counts as how far it moves a point at this distance.
        tolerance: scene units.
    """
    far = np.linalg.norm(body.offsets, axis=1) + size * _angles(body.quats)
    if far.max() < NEVER * tolerance:
        return None
    rested = _rested(body, size, tolerance)
    found = []
    if body.line is not None:
        rested = body.on(replace(body.line, values=_rested_values(body, size, tolerance)))
    for smooth in (True, False):
        if rested.line is not None:
            found.append(_fewest(_on_line(rested.line, ids, times, smooth), rested, times, size, tolerance))
            continue
        for axial in (_slide, _hinge):
            if (track := axial(rested, ids, times, size, tolerance, smooth)) is not None:
                found.append(_fewest(track, rested, times, size, AXIS_SLACK * tolerance))
                break
        whole = Track.rigid(ids, times, rested.quats, rested.offsets, rested.pivot, smooth)
        found.append(_fewest(whole, rested, times, size, tolerance))
    best = min(found, key=lambda t: (t.kind == "rigid", len(t.times)))
    return replace(best, name=name)


def _rested(body: Body, size: float, tolerance: float) -> Body:
    """The body with poses that hardly differ from the one before set to the mean of their run; the first is at rest."""
    quats, offsets = body.quats.copy(), body.offsets.copy()
    start = 0
    for t in range(1, len(offsets) + 1):
        if t < len(offsets) and _apart(body, t, start, size) < 0.5 * tolerance:
            continue
        own = slice(start, t)
        if start:
            signs = np.sign(quats[own] @ quats[start])[:, None]
            middle = (quats[own] * np.where(signs == 0, 1, signs)).mean(axis=0)
            quats[own], offsets[own] = middle / np.linalg.norm(middle), offsets[own].mean(axis=0)
        else:
            quats[own], offsets[own] = [1.0, 0.0, 0.0, 0.0], 0.0
        start = t
    return Body(body.pivot, quats, offsets)


def _rested_values(body: Body, size: float, tolerance: float) -> F64:
    """Values of a body's line, where those that hardly differ from the one before are the mean of their run."""
    assert body.line is not None
    values, start = body.line.values.copy(), 0
    for t in range(1, len(values) + 1):
        if t < len(values) and _apart(body, t, start, size) < 0.5 * tolerance:
            continue
        values[start:t] = values[start:t].mean() if start else 0.0
        start = t
    return np.asarray(values)


def _on_line(line: Line, ids: NDArray[np.int64], times: F64, smooth: bool) -> Track:
    """The track with a key at every time of the frames."""
    if line.kind == "slide":
        return Track.slide(ids, times, line.values, line.axis, smooth)
    return Track.hinge(ids, times, line.values, line.axis, line.pivot, smooth)


def _apart(body: Body, a: int, b: int, size: float) -> float:
    """How far two poses are apart, scene units."""
    cosine = min(1.0, abs(float(body.quats[a] @ body.quats[b])))
    return float(np.linalg.norm(body.offsets[a] - body.offsets[b])) + size * 2 * float(np.arccos(cosine))


def _angles(quats: F64) -> F64:
    """`[T]` the angle of each turn, radians, at most pi."""
    return np.asarray(2 * np.arccos(np.clip(np.abs(quats[:, 0]), 0, 1)))


def _misses(track: Track, body: Body, times: F64, size: float) -> F64:
    """`[T]` how far each pose is from that of a track, scene units."""
    turns, shifts = poses(track, times)
    wanted = keys.matrices(body.quats)
    there = body.offsets + body.pivot
    here = turns @ body.pivot + shifts
    cosine = np.clip((np.einsum("tij,tij->t", turns, wanted) - 1) / 2, -1, 1)
    return np.asarray(np.linalg.norm(here - there, axis=1) + size * np.arccos(cosine))


def _fewest(track: Track, body: Body, times: F64, size: float, tolerance: float) -> Track:
    """The track with keys left out: from both ends, the time that is missed most becomes a key until none is missed."""
    chosen = [0, len(times) - 1]
    while True:
        some = np.array(sorted(chosen))
        angles = None if track.angles is None else track.angles[some]
        thin = replace(track, times=times[some], quats=track.quats[some], offsets=track.offsets[some], angles=angles)
        off = _misses(thin, body, times, size)
        off[some] = 0
        if off.max() <= tolerance or len(chosen) == len(times):
            return thin
        chosen.append(int(off.argmax()))


def _slide(body: Body, ids: NDArray[np.int64], times: F64, size: float, tolerance: float, smooth: bool) -> Track | None:
    """The path as a slide along one axis, if no pose is far from it."""
    if size * _angles(body.quats).max() > AXIS_SLACK * tolerance:
        return None
    _, _, axes = np.linalg.svd(body.offsets, full_matrices=False)
    axis = axes[0] * np.sign(axes[0] @ body.offsets[np.linalg.norm(body.offsets, axis=1).argmax()])
    found = Track.slide(ids, times, body.offsets @ axis, axis, smooth)
    return found if _misses(found, body, times, size).max() <= AXIS_SLACK * tolerance else None


def _hinge(body: Body, ids: NDArray[np.int64], times: F64, size: float, tolerance: float, smooth: bool) -> Track | None:
    """The path as a turn about one line, if no pose is far from it."""
    angles = _angles(body.quats)
    if angles.max() < LEAST_TURN:
        return None
    vectors = body.quats[:, 1:]
    _, _, axes = np.linalg.svd(vectors, full_matrices=False)
    axis = axes[0] / np.linalg.norm(axes[0])
    turned = np.unwrap(2 * np.arctan2(vectors @ axis, body.quats[:, 0]))
    if turned[np.abs(turned).argmax()] < 0:
        axis, turned = -axis, -turned
    turns = keys.matrices(body.quats)
    # The line: points that all poses leave where they are.
    matrix = np.concatenate([*(turns - np.eye(3)), 0.01 * axis[None]])
    wanted = np.concatenate(
        [-(body.offsets + body.pivot - turns @ body.pivot).reshape(-1), [0.01 * float(axis @ body.pivot)]]
    )
    pivot = np.linalg.lstsq(matrix, wanted, rcond=None)[0]
    found = Track.hinge(ids, times, turned - turned[0], axis, pivot, smooth)
    return found if _misses(found, body, times, size).max() <= AXIS_SLACK * tolerance else None
