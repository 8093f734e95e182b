"""Blending weight per (Gaussian, label) pair of a label image: what lifts 2-D masks to Gaussians."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

DENSE_LABELS = 1_000_000  # range of labels up to which they are counted and not sorted


@dataclass(frozen=True, eq=False)
class Split:
    """Summed blending weight of each (Gaussian, label) pair with weight above zero, ordered by row, then by label.

    Attributes:
        rows: `[E]` int64, row in the cloud.
        labels: `[E]` int32, label of the pixels.
        weights: `[E]` float32 > 0, blending weight of the row summed over the pixels of the label.
    """

    rows: NDArray[np.int64]
    labels: NDArray[np.int32]
    weights: NDArray[np.float32]


def sum_pairs(count: int, rows: NDArray[np.integer], labels: NDArray[np.int32], weights: NDArray[np.floating]) -> Split:
    """Add up the weights of equal (row, label) pairs, in the order given; `count` is the number of Gaussians."""
    from scipy.sparse import csr_matrix

    names, column = _numbered(labels)
    sizes = (count, max(len(names), 1))
    table = csr_matrix((weights.astype(np.float64), (rows, column)), shape=sizes)  # constructing it adds duplicates
    table.sort_indices()
    kept = table.data > 0
    row = np.repeat(np.arange(count), np.diff(table.indptr))[kept]
    return Split(row, names[table.indices[kept]].astype(np.int32), table.data[kept].astype(np.float32))


def _numbered(labels: NDArray[np.int32]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The different labels, ascending, and the place of each label among them; without sorting if they are dense."""
    low, high = (int(labels.min()), int(labels.max())) if len(labels) else (0, 0)
    if high - low > max(len(labels), DENSE_LABELS):
        names, place = np.unique(labels, return_inverse=True)
        return names.astype(np.int64), place
    shifted = labels.astype(np.int64) - low
    there = np.bincount(shifted, minlength=1) > 0
    return np.flatnonzero(there) + low, (np.cumsum(there) - 1)[shifted]
