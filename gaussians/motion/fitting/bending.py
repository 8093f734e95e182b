"""How a body bends, by the pictures (`bent`): the displacements of its nodes are followed from time to time.

All nodes of a time are trained together by the rendered difference, each drawn a little towards its neighbours. They
start from where the last two times lead or, of a thing that was taken for several rigid ones (`Torn`), from where these
are. A thing bends if that explains the pictures much better than a path, or as well as several.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from .bends import Bend
from .bodies import Body
from .tracking import Placed, Tracker

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

STEPS = 16  # of Adam at each time
RATE, LAST = 0.1, 0.15  # size of a step, of how far a node is felt; and of the last one, of that
TOGETHER = 0.06  # how far a node is drawn towards its neighbours at each step
LEADS = 0.7  # of the change since the time before, which is taken to go on
WORST = 5  # times by which is told whether a body bends
EXPLAINS = 0.5  # of the difference standing still, below which what has no path bends
HIDDEN = 0.5  # of the area at the first time, below which a body hides, so that the pictures tell nothing of it


@dataclass(frozen=True, eq=False)
class Torn:
    """The Gaussians of a tracker, each on the path of a body of its own; others stand.

    Attributes:
        parts: rows and body of each, the largest first.
    """

    parts: tuple[tuple[I64, Body], ...]

    def placed(self, t: int, means: F32, quats: F32) -> tuple[F32, F32]:
        """Means and quaternions at a time."""
        means, quats = means.copy(), quats.copy()
        for rows, body in self.parts:
            means[rows], quats[rows] = body.placed(t, means[rows], quats[rows])
        return means, quats

    def moves(self, bend: Bend, means: F32) -> F64:
        """`[T, K, 3]` displacements of the nodes of a bend as these bodies have them."""
        near = cKDTree(means).query(bend.nodes)[1]
        quats = np.tile(np.array([1, 0, 0, 0], np.float32), (len(means), 1))
        each = [self.placed(t, means, quats)[0][near] - means[near] for t in range(len(bend.moves))]
        return np.stack(each).astype(np.float64)


def bent(tracker: Tracker, path: Body, starts: F64 | None = None) -> Body:
    """A body on its path, with the displacements that the pictures of each time tell.

    Args:
        starts: `[T, K, 3]` displacements of the nodes that are known about; None: the last two times lead.
    """
    bend = Bend.none(tracker.means, len(path.offsets))
    found, since = replace(path, bend=bend), 0
    for t in range(1, len(path.offsets)):
        known = found.bend
        assert known is not None
        held = _held(found, t, since)
        if tracker.rests(held, t, since):
            found = held
            continue
        since = t
        start = known.moves[t - 1] + (LEADS * (known.moves[t - 1] - known.moves[t - 2]) if t > 1 else 0)
        if starts is not None:
            start = starts[t]
        found = _trained(tracker, replace(found, bend=known.with_moves(slice(t, t + 1), start)), t)
    return found


def gain_by_bending(tracker: Tracker, torn: Torn, path: Body, starts: F64 | None, some: Sequence[int]) -> float:
    """Squared difference of what is taken for one or more rigid bodies as one that bends on a path, over that as it is
    taken, at those of some times at which it is explained worst, each by itself.

    Args:
        starts: as `bent`; None: on its path.
    """
    known = [float(_errors(tracker, (torn,), (t,))[0]) for t in some]
    some = [some[k] for k in sorted(np.argsort(known, kind="stable")[-WORST:])]
    none = Bend.none(tracker.means, len(path.offsets))
    found = replace(path, bend=none if starts is None else replace(none, moves=starts))
    for t in some:
        found = _trained(tracker, found, t)
    errors = _errors(tracker, (torn, found), some)
    return float(errors[1] / max(errors[0], 1e-9))


def bent_alone(tracker: Tracker, some: Sequence[int]) -> Body | None:
    """The displacements of what has no path, if they explain some times, and all that the first time shows of it."""
    still = Body.at_rest(tracker.pivot, len(tracker.seconds))
    found = bent(tracker, still)
    errors, areas = _errors(tracker, (still, found), some), [tracker.area(found, t) for t in (0, *some)]
    explained = errors[1] < EXPLAINS * errors[0] and min(areas[1:]) > HIDDEN * areas[0]
    return found if explained else None


def _errors(tracker: Tracker, bodies: Sequence[Placed], some: Sequence[int]) -> F64:
    """Squared difference of each body, at some times together."""
    return np.asarray(np.sum([tracker.errors_of(t, bodies)[0] for t in some], axis=0))


def _held(body: Body, t: int, since: int) -> Body:
    """The body with the displacements of an earlier time at a time."""
    assert body.bend is not None
    return replace(body, bend=body.bend.with_moves(slice(t, t + 1), body.bend.moves[since]))


def _trained(tracker: Tracker, body: Body, t: int) -> Body:
    """The body after training of its displacements at a time; the best of all steps."""
    bend, views = body.bend, tracker.views(body, t)
    assert bend is not None
    moves, best = bend.moves[t], (np.inf, bend.moves[t])
    first, second = np.zeros(moves.shape), np.zeros(moves.shape)
    shares = bend.shares(tracker.means).astype(np.float64)
    for k in range(1, STEPS + 1):
        now = replace(body, bend=bend.with_moves(slice(t, t + 1), moves))
        value, by_mean = tracker.pull(now, t, views)
        if value < best[0]:
            best = value, moves
        slope: F64 = shares.T @ by_mean
        first, second = 0.7 * first + 0.3 * slope, 0.9 * second + 0.1 * slope**2
        rate = RATE * bend.reach * LAST ** ((k - 1) / STEPS)
        size = np.sqrt(second / (1 - 0.9**k))
        moves = moves - rate * first / (1 - 0.7**k) / (size + 0.1 * np.sqrt((size**2).mean()) + 1e-12)
        moves = bend.together(moves, TOGETHER)
    return replace(body, bend=bend.with_moves(slice(t, t + 1), best[1]))
