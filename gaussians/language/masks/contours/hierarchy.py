"""Merge the regions of a picture into a hierarchy: the two with the weakest contour between them first.

The contour between two regions is the mean strength along their common border, whatever it consisted of before, times a
factor that is less than one where the smaller of them is small: speckles have strong contours and are not objects. Both
only grow as regions merge, so the strength of successive merges never falls. Drawn on the borders, these strengths are
the ultrametric contour map of Arbelaez et al. (TPAMI 2011). Cuts at several strengths give layers of regions, each a
union of those before.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from .watershed import Regions

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

FULL_SIZE = 0.01  # of the picture: a region from this size has the whole strength of its contour
SIZE_POWER = 0.3  # of the share of FULL_SIZE that a smaller region has, as a factor of its strength


@dataclass(frozen=True, eq=False)
class Hierarchy:
    """A binary tree over R regions: node i < R is a region, node R + k is made by merge k.

    Attributes:
        parent: `[2R - 1]` int32, the node that each node merges into; -1 for the last.
        height: `[R - 1]` float64, ascending: strength of the contour that each merge removes.
    """

    parent: I32
    height: F64

    @property
    def count(self) -> int:
        """Number of regions R."""
        return len(self.height) + 1 if len(self.parent) else 0

    def nodes_after(self, merges: int) -> I32:
        """The node that each region `[R]` belongs to after the first `merges` merges."""
        count = self.count
        top = np.arange(count + merges, dtype=np.int32)
        for node in range(count + merges - 1, -1, -1):
            above = self.parent[node]
            if 0 <= above < count + merges:
                top[node] = top[above]
        return top[:count]

    def saliency(self) -> F64:
        """`[2R - 1]`: contour strength that bounds each node where it is weakest: the height of the merge into its
        parent; 0 for the last."""
        above = self.parent - self.count
        return np.where(above >= 0, self.height[np.maximum(above, 0)] if len(self.height) else 0.0, 0.0)


def merge(regions: Regions) -> Hierarchy:
    """The hierarchy of some regions.

    Of merges of equal strength, that of the lowest two nodes' first regions comes first. Regions without a contour to
    any other, which a picture does not have, would merge last, with strength 1.
    """
    count = regions.count
    if count == 0:
        return Hierarchy(np.zeros(0, np.int32), np.zeros(0))
    size = np.bincount(regions.labels.ravel(), minlength=count).astype(np.float64)
    full = FULL_SIZE * float(regions.labels.size)
    parent, height = _merge(size, regions.pairs, regions.total, regions.length, full, SIZE_POWER)
    return Hierarchy(parent, np.maximum.accumulate(height))


@njit(cache=True, nogil=True)
def _nearest(total: F64, length: F64, gain: F64, alive: NDArray[np.bool_], i: int) -> tuple[float, int]:
    """The weakest contour between row i and a later row, and that row; 2 and -1 if none touches it."""
    best, at = 2.0, -1  # pragma: no cover - compiled
    for j in range(i + 1, len(alive)):
        if alive[j] and length[i, j] > 0:
            strength = total[i, j] / length[i, j] * min(gain[i], gain[j])
            if strength < best:
                best, at = strength, j
    return best, at


@njit(cache=True, nogil=True)
def _merge(
    size: F64, pairs: I32, totals: F64, lengths: F64, full: float, power: float
) -> tuple[I32, F64]:  # pragma: no cover - compiled
    """Agglomeration over dense tables; each row keeps its weakest contour to a later row, recomputed when it changes.

    A contour of a row that has not been merged only grows, so the weakest of a row changes only where it led to one of
    the two rows that were merged, or where the second of the two led to it.
    """
    count = len(size)
    total, length = np.zeros((count, count)), np.zeros((count, count))
    for e in range(len(pairs)):
        a, b = pairs[e, 0], pairs[e, 1]
        total[a, b] = total[b, a] = totals[e]
        length[a, b] = length[b, a] = lengths[e]
    size = size.copy()
    gain = np.minimum(size / full, 1.0) ** power
    alive = np.ones(count, np.bool_)
    node = np.arange(count).astype(np.int32)
    parent, height = np.full(2 * count - 1, -1, np.int32), np.zeros(count - 1)
    weakest, partner = np.empty(count), np.empty(count, np.int64)
    for i in range(count):
        weakest[i], partner[i] = _nearest(total, length, gain, alive, i)
    for step in range(count - 1):
        a, b = -1, -1
        for i in range(count):
            if alive[i] and partner[i] >= 0 and (a < 0 or weakest[i] < weakest[a]):
                a = i
        if a >= 0:
            b, height[step] = partner[a], weakest[a]
        else:  # nothing touches: the first two that are left
            height[step] = 1.0
            for i in range(count):
                if alive[i] and a < 0:
                    a = i
                elif alive[i] and b < 0:
                    b = i
        parent[node[a]] = parent[node[b]] = count + step
        node[a] = count + step
        alive[b] = False
        size[a] += size[b]
        gain[a] = min(size[a] / full, 1.0) ** power
        for k in range(count):
            if alive[k] and k != a and length[b, k] > 0:
                total[a, k] += total[b, k]
                length[a, k] += length[b, k]
                total[k, a], length[k, a] = total[a, k], length[a, k]
        for k in range(b):
            if not alive[k] or k == a:
                continue
            if partner[k] == a or partner[k] == b:
                weakest[k], partner[k] = _nearest(total, length, gain, alive, k)
            elif k < a and length[k, a] > 0:
                strength = total[k, a] / length[k, a] * min(gain[k], gain[a])
                if strength < weakest[k] or (strength == weakest[k] and a < partner[k]):
                    weakest[k], partner[k] = strength, a
        weakest[a], partner[a] = _nearest(total, length, gain, alive, a)
    return parent, height
