"""Paths on one axis (`line_of`): a hinge or a slide replaces a free path where the pictures lose less by it than the
numbers that it saves are worth, or hardly anything.

The lines to try are told by the poses: the one that most of them lie on. Values and line are then refined by the
rendered difference, and both paths are compared by the Bayesian information criterion (Schwarz 1978).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .. import keys
from .bodies import Body, Line
from .tracking import Tracker

F64 = NDArray[np.float64]
Kind = Literal["hinge", "slide"]

ON_LINE = 0.2  # of the body's size: as near to a line is a pose that lies on it
MOST_ON = 0.4  # share of the poses that lie on a line that is tried
LEAST_TURN = 0.12  # radians; a smaller turn tells no axis
LEAST_WAY = 0.05  # of the body's size; a shorter way tells no direction
ROUNDS, TRIES = 2, 5  # of the refinement of values, and values that are tried in each
GRID, WIDE = 9, 4.0  # values that are tried all along a line that is not longer than this, of the body's size
SPAN = 0.3  # of the body's size: how far from a value others are tried in the first round, a third of it in the next
LINE_STEPS, LINE_RATE = 5, 0.02  # steps of the line in each round; their size: radians, or of the body's size
LINE_TIMES = 6  # greatest number of times by which it is refined
KEEPS = 0.97  # of what a free path gains on standing still, from which a line is as good as it
INDEPENDENT = 25  # pixels of which one counts as an observation: neighbours err alike


def line_of(tracker: Tracker, body: Body) -> Line | None:
    """The line on which all poses of a body may lie, or its line refined; None if its path is no hinge and no slide."""
    if body.line is not None:
        return refined(tracker, body, body.line)
    runs = body.runs[1:]
    if len(runs) < 2:  # one place to go to lies on any line
        return None
    best: tuple[float, Line | None] = (np.inf, None)
    kinds: tuple[Kind, ...] = ("slide", "hinge")
    for kind in kinds:
        line = _told(body, kind, tracker.size)
        if line is None:
            continue
        line = refined(tracker, body, line)
        error, enough = _judged(tracker, body, line, runs)
        if enough and error < best[0]:
            best = error, line
    return best[1]


def agrees(tracker: Tracker, free: Body, line: Line) -> bool:
    """Whether the frames tell no more of a body than its place on a line, beside a free path."""
    return _judged(tracker, free, line, free.runs[1:])[1]


def _judged(tracker: Tracker, body: Body, line: Line, runs: list[tuple[int, int]]) -> tuple[float, bool]:
    """The squared difference with the line, and whether it is enough: the information criterion prefers it to the free
    path, or it keeps nearly all that the free path gains on standing still. The criterion alone takes the errors of a
    body's shape, which all times share, for as many observations, and a free path bends to hide them."""
    on = body.on(line)
    free = bound = rest = pixels = 0.0
    for t, _ in runs:
        poses = [(b.quats[k], b.offsets[k]) for b, k in ((body, t), (on, t), (body, 0))]
        errors, count = tracker.errors(t, poses)
        free, bound, rest, pixels = free + errors[0], bound + errors[1], rest + errors[2], pixels + count
    n = max(pixels / INDEPENDENT, 2.0)
    saved = 6 * len(runs) - (len(runs) + (4 if line.kind == "hinge" else 2))
    preferred = saved * float(np.log(n)) > n * float(np.log((bound + 1e-9) / (free + 1e-9)))
    return bound, preferred or rest - bound > KEEPS * (rest - free) > 0


def _told(body: Body, kind: Kind, size: float) -> Line | None:
    """The line of this kind that most poses lie on, of those that single poses tell."""
    times = [t for t, _ in body.runs[1:]]
    hints = [line for t in times if (line := _hint(body, t, kind, size)) is not None]
    if not hints:
        return None
    each = [_projected(body, line) for line in hints]
    moved = slice(times[0], None)
    near = [float((_misses(body, line, size) < ON_LINE * size)[moved].mean()) for line in each]
    return each[int(np.argmax(near))] if max(near) >= MOST_ON else None


def _hint(body: Body, t: int, kind: Kind, size: float) -> Line | None:
    """The line that one pose tells."""
    offset, quat, values = body.offsets[t], body.quats[t], np.zeros(len(body.offsets))
    if kind == "slide":
        way = float(np.linalg.norm(offset))
        return None if way < LEAST_WAY * size else Line("slide", offset / way, body.pivot, values)
    sine = float(np.linalg.norm(quat[1:]))
    if 2 * np.arctan2(sine, abs(quat[0])) < LEAST_TURN:
        return None
    axis = quat[1:] / sine
    # The point nearest to the middle that the pose leaves where it is, but for what it shifts along the axis.
    turn = keys.matrices(quat) - np.eye(3)
    across = offset - axis * (axis @ offset)
    return Line("hinge", axis, body.pivot + np.linalg.lstsq(turn, -across, rcond=1e-6)[0], values)


def _projected(body: Body, line: Line) -> Line:
    """The line with the values that bring it nearest to all poses."""
    if line.kind == "slide":
        return replace(line, values=body.offsets @ line.axis)
    values = np.unwrap(2 * np.arctan2(body.quats[:, 1:] @ line.axis, body.quats[:, 0]))
    return replace(line, values=values - values[0])


def _misses(body: Body, line: Line, size: float) -> F64:
    """`[T]` how far each pose is from that of a line, scene units."""
    on = body.on(line)
    cosines = np.clip(np.abs((on.quats * body.quats).sum(axis=1)), 0, 1)
    return np.asarray(np.linalg.norm(on.offsets - body.offsets, axis=1) + size * 2 * np.arccos(cosines))


def refined(tracker: Tracker, body: Body, line: Line) -> Line:
    """The line and its values, by the rendered difference."""
    runs = body.runs[1:]
    unit = tracker.size if line.kind == "hinge" else 1.0
    low, high = float(line.values.min()), float(line.values.max())
    if (high - low) * unit < WIDE * tracker.size:  # else a turn that goes on and on, whose values are all near
        grid = np.linspace(low, high, GRID)
        for run in runs:
            line = _scanned(tracker, body, line, run, grid)
    for k in range(ROUNDS):
        around = SPAN * tracker.size / unit / 3**k * np.linspace(-1, 1, TRIES)
        for run in runs:
            line = _scanned(tracker, body, line, run, line.values[run[0]] + around)
        line = _steered(tracker, body, line, [t for t, _ in runs], LINE_RATE / 2**k)
    return line


def _scanned(tracker: Tracker, body: Body, line: Line, run: tuple[int, int], others: F64) -> Line:
    """The line with the best value of a run of times: the present one, its neighbours' or another."""
    start, stop = run
    before, here = line.values[start - 1], line.values[start]
    after = line.values[min(stop, len(line.values) - 1)]
    tried = np.concatenate([[here, before, after, (before + after) / 2], others])
    errors, _ = tracker.errors(start, list(zip(*line.poses(tried, body.pivot), strict=True)))
    values = line.values.copy()
    values[start:stop] = tried[int(errors.argmin())]
    return replace(line, values=values)


def _steered(tracker: Tracker, body: Body, line: Line, times: list[int], rate: float) -> Line:
    """The line after some steps of Adam on its pivot and its axis."""
    some = [times[k] for k in np.unique(np.linspace(0, len(times) - 1, min(LINE_TIMES, len(times))).astype(int))]
    first, second = np.zeros(6), np.zeros(6)
    for k in range(1, LINE_STEPS + 1):
        on, slope = body.on(line), np.zeros(6)
        for t in some:
            turn, shift = tracker.slope(on, t)
            _, pivot, axis = line.gradient(t, body.pivot + on.offsets[t], turn, shift)
            slope += np.r_[pivot * tracker.size, axis]
        first, second = 0.7 * first + 0.3 * slope, 0.9 * second + 0.1 * slope**2
        move = -rate * first / (1 - 0.7**k) / (np.sqrt(second / (1 - 0.9**k)) + 1e-12)
        line = line.stepped(slice(0), 0.0, move[:3] * tracker.size, move[3:])
    return line
