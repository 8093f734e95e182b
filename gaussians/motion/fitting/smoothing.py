"""Paths that single pictures tell but in part (`smoothed`): where one camera cannot tell a pose, the times around do.

A picture tells well where a body is across the line of sight, and hardly how far along it. Each picture's knowledge of
its pose is the Gauss-Newton matrix of the rendered difference; against it stands how much the path's speed changes from
time to time. Both are minimised together for all times, by damped Gauss-Newton steps. Sudden changes, as of what is
kicked or bumps into something, count by a Cauchy weight.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .bodies import Body, multiplied, turned
from .tracking import Tracker, vector

F64 = NDArray[np.float64]

ROUNDS = 6
NOISE = 0.12  # difference of colour that a picture is expected to have with the right pose
INDEPENDENT = 6.0  # pixels of which one counts as an observation: neighbours err alike
SUDDEN = 0.002  # of the cameras' radius: a change of the way from one time to the next that is not unusual
DAMPED = 1e-3, 10.0, 1e4  # of the diagonal, at first; factor after a step that fails; greatest


def smoothed(tracker: Tracker, body: Body, radius: float) -> Body:
    """The body with the path that its pictures and its steadiness tell together."""
    count = len(body.offsets)
    runs, times = [(t, t + 1) for t in range(count)], list(range(count))
    if len(runs) < 3 or len(body.runs) < 2:
        return body
    found, damped = body, DAMPED[0]
    known = _Known.of(tracker, found, times)
    value = known.value + _steadiness(found, times, tracker, radius)[0]
    for _ in range(ROUNDS):
        _, slope, bend = _steadiness(found, times, tracker, radius)
        slope, bend = slope + known.slope, bend + known.bend
        while damped < DAMPED[2]:
            own = bend + damped * np.diag(np.diag(bend))
            step = np.asarray(-np.linalg.solve(own[6:, 6:] + 1e-9 * np.eye(len(own) - 6), slope[6:]), dtype=np.float64)
            tried = _stepped(found, runs, step.reshape(-1, 6), tracker.size)
            there = _Known.of(tracker, tried, times)
            after = there.value + _steadiness(tried, times, tracker, radius)[0]
            if after < value:
                found, known, damped = tried, there, damped / DAMPED[1]
                break
            damped *= DAMPED[1]
        else:
            break
        if value - after < 1e-3 * value:
            break
        value = after
    return found


@dataclass(frozen=True, eq=False)
class _Known:
    """What the pictures tell of the poses: their difference, its gradient and its Gauss-Newton matrix by a shift (scene
    units) and a turn (radians times the body's size) at each time."""

    value: float
    slope: F64
    bend: F64

    @classmethod
    def of(cls, tracker: Tracker, body: Body, times: list[int]) -> _Known:
        """At the times at which runs of one pose begin."""
        count, value = len(times), 0.0
        slope, bend = np.zeros(6 * count), np.zeros((6 * count, 6 * count))
        for k, t in enumerate(times):
            if k:
                own = slice(6 * k, 6 * k + 6)
                error, slope[own], bend[own, own] = tracker.known(body, t)
                value += error
        scale = 1 / (NOISE**2 * INDEPENDENT)
        return cls(scale * value, scale * slope, scale * bend)


def _steadiness(body: Body, times: list[int], tracker: Tracker, radius: float) -> tuple[float, F64, F64]:
    """How unsteady a path is, with gradient and matrix as in `_Known`."""
    seconds = tracker.seconds[times]
    unit = float(np.median(np.diff(tracker.seconds)))
    count, value = len(times), 0.0
    slope, bend = np.zeros(6 * count), np.zeros((6 * count, 6 * count))
    for k in range(1, count - 1):
        before, after = (unit / (seconds[k + j + 1] - seconds[k + j]) for j in (-1, 0))
        a, b, c = times[k - 1], times[k], times[k + 1]
        shift = after * (body.offsets[c] - body.offsets[b]) - before * (body.offsets[b] - body.offsets[a])
        turn = after * _turn(body, b, c) - before * _turn(body, a, b)
        off = np.r_[shift, tracker.size * turn] / (SUDDEN * radius)
        square = float(off @ off)
        weight = 1 / (1 + square)
        value += float(np.log1p(square))
        row = np.concatenate([before * np.eye(6), -(before + after) * np.eye(6), after * np.eye(6)], axis=1)
        row = row / (SUDDEN * radius)
        own = slice(6 * (k - 1), 6 * (k + 2))
        slope[own] += 2 * weight * row.T @ off
        bend[own, own] += 2 * weight * row.T @ row
    return value, slope, bend


def _turn(body: Body, a: int, b: int) -> F64:
    """The rotation vector from one time to another."""
    return vector(multiplied(body.quats[b], body.quats[a] * [1, -1, -1, -1]))


def _stepped(body: Body, runs: list[tuple[int, int]], step: F64, size: float) -> Body:
    """The body with a step of the pose of each run but the first."""
    quats, offsets = body.quats.copy(), body.offsets.copy()
    for (start, stop), move in zip(runs[1:], step, strict=True):
        quats[start:stop] = turned(quats[start], move[3:] / size)
        offsets[start:stop] += move[:3]
    return Body(body.pivot, quats, offsets)
