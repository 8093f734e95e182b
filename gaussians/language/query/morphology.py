"""Grow and shrink a selection by a distance: morphology of point sets.

Groups are not considered: a chair grown by 5 cm includes 5 cm of the floor.

With `S` a set of Gaussians, `-S` all others and `d` the distance of centres (Serra 1982, on a finite set):

    grow(S, r) = {x : d(x, S) <= r}        shrink(S, r) = {x in S : d(x, -S) > r} = -grow(-S, r)

so that for every r > 0: shrink(S) <= S <= grow(S); both keep the order of sets; grow(A) <= B exactly if A <= shrink(B);
S <= shrink(grow(S)) (closing fills holes) and grow(shrink(S)) <= S (opening removes specks), both idempotent. The
complement `-S` is `group_index.difference` from all ids.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...cloud import GaussianCloud
from ...errors import UserError

F64 = NDArray[np.float64]
Rows = NDArray[np.int64]


def grown(cloud: GaussianCloud, ids: Tensor, by: float) -> Tensor:
    """Ascending ids of the Gaussians within `by` scene units of any of `ids`, including these.

    Raises:
        UserError: the distance is not positive.
    """
    inside = _flags(cloud, ids, by)
    return _ids(cloud, inside | _near(cloud, inside, ~inside, by))


def shrunk(cloud: GaussianCloud, ids: Tensor, by: float) -> Tensor:
    """Ascending ids of those of `ids` that are farther than `by` scene units from every other Gaussian.

    Raises:
        UserError: the distance is not positive.
    """
    inside = _flags(cloud, ids, by)
    return _ids(cloud, inside & ~_near(cloud, ~inside, inside, by))


def _flags(cloud: GaussianCloud, ids: Tensor, by: float) -> NDArray[np.bool_]:
    from .selection import mask_of

    if not 0 < by < float("inf"):
        raise UserError(f"a selection grows or shrinks by a positive distance, not by {by:g}")
    return mask_of(cloud, ids).cpu().numpy()


def _ids(cloud: GaussianCloud, flags: NDArray[np.bool_]) -> Tensor:
    return cloud.ids[torch.from_numpy(flags).to(cloud.device)].sort().values


def _near(cloud: GaussianCloud, source: NDArray[np.bool_], among: NDArray[np.bool_], by: float) -> NDArray[np.bool_]:
    """Whether each row `[N]` is in `among` and within `by` of a row of `source`. Only rows near the smaller set are
    searched, by cells: the rest of a large scene costs a comparison of coordinates."""
    from scipy.spatial import cKDTree

    found = np.zeros(len(cloud), bool)
    points: NDArray[np.float32] = cloud.means.detach().cpu().numpy()
    own, other = np.flatnonzero(source), np.flatnonzero(among)
    if len(own) < len(other):
        other = _around(points, other, own, by)
        own = _around(points, own, other, by)
    else:
        own = _around(points, own, other, by)
        other = _around(points, other, own, by)
    if not len(own) or not len(other):
        return found
    # The search radius is slightly larger than `by`; the comparison is exact and symmetric in both sets.
    distance, _ = cKDTree(points[own]).query(points[other], distance_upper_bound=by * (1 + 1e-6) + 1e-12)
    found[other[distance <= by]] = True
    return found


def _around(points: NDArray[np.float32], rows: Rows, target: Rows, by: float) -> Rows:
    """The `rows` in cells of `target` or adjacent ones, with cells of side `by`: a superset of those within `by`."""
    if not len(target) or not len(rows):
        return rows[:0]
    reach = by * (1 + 1e-5) + 1e-6 * float(np.abs(points[target]).max())  # coordinates are single precision
    low, high = points[target].min(axis=0) - reach, points[target].max(axis=0) + reach
    rows = rows[((points[rows] >= low) & (points[rows] <= high)).all(axis=1)]
    side = max(reach, float((high - low).max()) / 256)  # a table of at most 258^3 flags, 17 MB
    shape = np.floor((high - low) / side).astype(np.int64) + 3
    table = np.zeros(tuple(shape), bool)
    x, y, z = (np.floor((points[target] - low) / side).astype(np.int64) + 1).T
    table[x, y, z] = True
    for axis in range(3):  # each cell and its neighbours
        ahead, behind = np.roll(table, 1, axis), np.roll(table, -1, axis)
        table = table | ahead | behind
    x, y, z = (np.floor((points[rows] - low) / side).astype(np.int64) + 1).T
    return rows[table[x, y, z]]
