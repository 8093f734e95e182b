"""Blending weight shared out among the masks of a picture: what is needed to carry masks from pixels to Gaussians.

Knows rows, labels and weights. Refuses to know how a back end finds them, and what a label stands for.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix


@dataclass(frozen=True, eq=False)
class Split:
    """Summed blending weight of each (Gaussian, label) pair that has any, ordered by row, then by label.

    Attributes:
        rows: `[E]` int64, row in the cloud.
        labels: `[E]` int32, the pixels' label.
        weights: `[E]` float32 > 0, blending weight of the row summed over the pixels of the label.
    """

    rows: NDArray[np.int64]
    labels: NDArray[np.int32]
    weights: NDArray[np.float32]


def summed(count: int, rows: NDArray[np.integer], labels: NDArray[np.int32], weights: NDArray[np.floating]) -> Split:
    """Add up what pairs got in several places, in the order in which it is given; `count` is the cloud's length."""
    names, column = np.unique(labels, return_inverse=True)
    sizes = (count, max(len(names), 1))
    table = csr_matrix((weights.astype(np.float64), (rows, column)), shape=sizes)  # constructing it adds duplicates
    table.sort_indices()
    kept = table.data > 0
    row = np.repeat(np.arange(count), np.diff(table.indptr))[kept]
    return Split(row, names[table.indices[kept]].astype(np.int32), table.data[kept].astype(np.float32))
