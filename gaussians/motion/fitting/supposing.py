"""Hinges and slides that a body's shape suggests (`supposed`), for one camera, whose pictures tell a free path badly.

Doors turn about an edge, fans about their middle, drawers slide along an axis of their own. For each such line, the
values at all times are searched together, by the colours of points of the body. The lines that explain these best are
refined and compared by the rendered difference.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .axes import refined
from .bodies import Body, Line
from .tracking import BLURS, Tracker

F64 = NDArray[np.float64]

ENDS = 0.04  # share of the points beyond an edge, at either side
TURNS = np.radians(np.arange(-174, 181, 6.0))  # that are tried of a hinge
WAYS = np.linspace(-4, 4, 65)  # that are tried of a slide, of the body's size
STEADY = 0.03  # difference of colour that a change by the body's size from one time to the next is worth
BEST = 2  # lines that are compared by rendering


def supposed(tracker: Tracker, times: int) -> Body:
    """The body on the line that explains the frames best, of those that its shape suggests."""
    still = Body.at_rest(tracker.pivot, times)
    told = sorted((_followed(tracker, still, line) for line in _lines(tracker, times)), key=lambda found: found[0])
    tried = []
    for _, line in told[:BEST]:
        line = refined(tracker, still.on(line), line)
        on = still.on(line)
        tried.append((sum(float(tracker.errors(t, [(on.quats[t], on.offsets[t])])[0][0]) for t in range(1, times)), on))
    return min(tried, key=lambda found: found[0])[1]


def _lines(tracker: Tracker, times: int) -> list[Line]:
    """Slides along the body's axes, and hinges along these through its middle and its edges."""
    axes, low, high = tracker.box(ENDS)
    found = [Line("slide", axis, tracker.pivot, np.zeros(times)) for axis in axes]
    for k, axis in enumerate(axes):
        a, b = (j for j in range(3) if j != k)
        middle = [(0.0, 0.0)]
        for x, y in middle + [(x, y) for x in (low[a], high[a]) for y in (low[b], high[b])]:
            found.append(Line("hinge", axis, tracker.pivot + x * axes[a] + y * axes[b], np.zeros(times)))
    return found


def _followed(tracker: Tracker, still: Body, line: Line) -> tuple[float, Line]:
    """The line with the values that explain the colours of all times best while they change little, and how badly they
    do (Viterbi 1967)."""
    count = len(line.values)
    tried = TURNS if line.kind == "hinge" else WAYS * tracker.size
    arm = max(tracker.size, float(np.linalg.norm(np.cross(tracker.pivot - line.pivot, line.axis))))
    apart = np.abs(tried[:, None] - tried)
    if line.kind == "hinge":
        apart = np.minimum(apart, 2 * np.pi - apart) * arm
    change = STEADY * apart / tracker.size
    turns, offsets = line.poses(tried, still.pivot)
    total = np.where(tried == tried[np.abs(tried).argmin()], 0.0, np.inf)
    came = np.zeros((count, len(tried)), np.int64)
    for t in range(1, count):
        ways = total[:, None] + change
        came[t] = ways.argmin(axis=0)
        total = ways.min(axis=0) + tracker.scores(turns, offsets, t, BLURS[1])
    best = [int(total.argmin())]
    for t in range(count - 1, 0, -1):
        best.append(int(came[t, best[-1]]))
    values = tried[best[::-1]]
    if line.kind == "hinge":
        values = np.unwrap(values)
    return float(total.min()), replace(line, values=values - values[0])
