"""Blending weight per (Gaussian, label) pair of a label image: what lifts 2-D masks to Gaussians."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix


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
    names, column = np.unique(labels, return_inverse=True)
    sizes = (count, max(len(names), 1))
    table = csr_matrix((weights.astype(np.float64), (rows, column)), shape=sizes)  # constructing it adds duplicates
    table.sort_indices()
    kept = table.data > 0
    row = np.repeat(np.arange(count), np.diff(table.indptr))[kept]
    return Split(row, names[table.indices[kept]].astype(np.int32), table.data[kept].astype(np.float32))
