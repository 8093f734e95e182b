"""Sets of stable ids as sorted, disjoint intervals `[R, 2]` of [start, stop): a body of a million Gaussians that lie
side by side in a file is two numbers."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import UserError

I64 = NDArray[np.int64]


def whole_numbers(ids: ArrayLike) -> None:
    """Check the ids of a motion; raises UserError if they are no whole numbers."""
    given = np.asarray(ids)
    if given.size and (given.dtype.kind not in "iuf" or (given != np.floor(given)).any()):
        raise UserError("the ids of a motion must be whole numbers, as those of `session.select(...)` are")


def runs_of(ids: ArrayLike) -> I64:
    """The intervals `[R, 2]` of some ids, in any order.

    Raises:
        UserError: they are no whole numbers.
    """
    whole_numbers(ids)
    ordered = np.unique(np.asarray(ids).astype(np.int64).reshape(-1))
    if not len(ordered):
        return np.zeros((0, 2), dtype=np.int64)
    breaks = np.flatnonzero(np.diff(ordered) > 1)
    starts = ordered[np.concatenate([[0], breaks + 1])]
    stops = ordered[np.concatenate([breaks, [len(ordered) - 1]])] + 1
    return np.stack([starts, stops], axis=1)


def ids_of(runs: I64) -> I64:
    """The ids `[M]` in some intervals, ascending."""
    lengths = runs[:, 1] - runs[:, 0]
    before = np.cumsum(lengths) - lengths  # ids in earlier intervals
    ids: I64 = np.arange(int(lengths.sum()), dtype=np.int64) + np.repeat(runs[:, 0] - before, lengths)
    return ids


def held_by(runs: I64, ids: I64) -> NDArray[np.bool_]:
    """`[M]`: whether each of some ids lies in an interval."""
    place = np.searchsorted(runs[:, 0], ids, side="right") - 1
    held: NDArray[np.bool_] = (place >= 0) & (ids < np.append(runs[:, 1], 0)[place])
    return held


def checked_runs(runs: ArrayLike) -> I64:
    """Intervals as an array `[R, 2]`.

    Raises:
        UserError: they are not sorted and disjoint intervals of ids from 0 on.
    """
    found = np.asarray(runs, dtype=np.int64).reshape(-1, 2)
    edges = found.reshape(-1)
    if len(edges) and (edges[0] < 0 or not (found[:, 1] > found[:, 0]).all() or not (np.diff(edges) >= 0).all()):
        raise UserError("the ids of a motion must be sorted, disjoint intervals [start, stop) from 0 on")
    return found
