"""Paths that single pictures tell but in part (`smoothed`): where one camera cannot tell a pose, the times around do.

A picture tells well where a body is across the line of sight, and hardly how far along it. Each picture's knowledge of
its pose is the Gauss-Newton matrix of the rendered difference; against it stands how much the path's speed changes from
time to time. Both are minimised together for all times, by damped Gauss-Newton steps. Sudden changes, as of what is
kicked or bumps into something, count by a Cauchy weight.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .bodies import Body, turned
from .tracking import Tracker, turn_between

F64 = NDArray[np.float64]

ROUNDS = 6
ENOUGH = 1e-3  # of the cost: a step that gains less is the last
LEAST = 1e-9  # on the diagonal: of a time at which nothing tells the pose
NOISE = 0.12  # difference of colour that a picture is expected to have with the right pose
INDEPENDENT = 6.0  # pixels of which one counts as an observation: neighbours err alike
SUDDEN = 0.002  # of the cameras' radius: a change of the way from one time to the next that is not unusual
DAMPED = 1e-3, 10.0, 1e4  # of the diagonal, at first; factor after a step that fails; greatest


def smoothed(tracker: Tracker, body: Body, radius: float) -> Body:
    """The body with the path that its pictures and its steadiness tell together.

    Args:
        radius: of the cameras around their middle, scene units.
    """
    if len(body.offsets) < 3 or len(body.runs) < 2:
        return body
    found, known, damped = body, _told(tracker, body, radius), DAMPED[0]
    for _ in range(ROUNDS):
        tried, there = found, known
        while damped < DAMPED[2]:
            tried = _stepped(found, known.step(damped), tracker.size)
            there = _told(tracker, tried, radius)
            if there.value < known.value:
                break
            damped *= DAMPED[1]
        gained = known.value - there.value
        if gained > 0:
            found, known, damped = tried, there, damped / DAMPED[1]
        if not gained > ENOUGH * known.value:
            break
    return found


@dataclass(frozen=True, eq=False)
class _Told:
    """What is told of all poses: a cost, its gradient and its Gauss-Newton matrix by a shift (scene units) and a turn
    (radians times the body's size) at each time, `[6 T]` and `[6 T, 6 T]`."""

    value: float
    slope: F64
    bend: F64

    def step(self, damped: float) -> F64:
        """The damped Gauss-Newton step `[T - 1, 6]`; the first pose stays."""
        bend = self.bend[6:, 6:]
        bend = bend + np.diag(damped * np.diag(bend) + LEAST)
        return np.asarray(-np.linalg.solve(bend, self.slope[6:]), dtype=np.float64).reshape(-1, 6)


def _told(tracker: Tracker, body: Body, radius: float) -> _Told:
    """By the pictures and by steadiness together."""
    found = _steadiness(body, tracker, radius)
    scale, value = 1 / (NOISE**2 * INDEPENDENT), found.value
    for t in range(1, len(body.offsets)):
        own = slice(6 * t, 6 * t + 6)
        error, slope, bend = tracker.known(body, t)
        value += scale * error
        found.slope[own] += scale * slope
        found.bend[own, own] += scale * bend
    return replace(found, value=value)


def _steadiness(body: Body, tracker: Tracker, radius: float) -> _Told:
    """By how little the way from one time to the next changes."""
    seconds, count = tracker.seconds, len(body.offsets)
    unit, value = float(np.median(np.diff(seconds))), 0.0
    slope, bend = np.zeros(6 * count), np.zeros((6 * count, 6 * count))
    for t in range(1, count - 1):
        before, after = (unit / (seconds[k + 1] - seconds[k]) for k in (t - 1, t))
        shift = after * (body.offsets[t + 1] - body.offsets[t]) - before * (body.offsets[t] - body.offsets[t - 1])
        turn = after * turn_between(body.quats[t], body.quats[t + 1]) - before * turn_between(
            body.quats[t - 1], body.quats[t]
        )
        off = np.r_[shift, tracker.size * turn] / (SUDDEN * radius)
        square = float(off @ off)
        value += float(np.log1p(square))
        row = np.concatenate([before * np.eye(6), -(before + after) * np.eye(6), after * np.eye(6)], axis=1)
        row = row / (SUDDEN * radius)
        own = slice(6 * (t - 1), 6 * (t + 2))
        slope[own] += 2 / (1 + square) * row.T @ off
        bend[own, own] += 2 / (1 + square) * row.T @ row
    return _Told(value, slope, bend)


def _stepped(body: Body, step: F64, size: float) -> Body:
    """The body with a step of each pose but the first."""
    quats, offsets = body.quats.copy(), body.offsets.copy()
    for t, move in enumerate(step, 1):
        quats[t] = turned(quats[t], move[3:] / size)
    offsets[1:] += step[:, :3]
    return Body(body.pivot, quats, offsets)
