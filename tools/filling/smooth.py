"""Continue values into the unknown cells of a grid: the membrane (harmonic) solution, and averages of known cells."""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

_BLOCKS = 4  # cells along a side of the blocks that a large unknown area is solved on first


def harmonic(values: F64, known: Mask, unknown: Mask) -> F64:
    """The values with those of unknown cells replaced by the solution of Laplace's equation.

    Cells that are neither known nor unknown, and the border of the grid, are walls without flux. An unknown area
    that touches no known cell keeps the mean of the known cells.

    Args:
        values: `[H, W, C]`.
        known: `[H, W]`, cells whose values hold.
        unknown: `[H, W]`, cells to solve for; disjoint from `known`.
    """
    from scipy import sparse
    from scipy.sparse.linalg import spsolve

    out = values.astype(np.float64, copy=True)
    if not unknown.any() or not known.any():
        return out
    out[unknown] = values[known].mean(axis=0)
    reached = _reached(known, unknown)
    count = int(reached.sum())
    if not count:
        return out
    number = np.full(known.shape, -1, np.int64)
    number[reached] = np.arange(count)
    degree, right = np.zeros(count), np.zeros((count, values.shape[2]))
    rows, columns = list[NDArray[np.int64]](), list[NDArray[np.int64]]()
    for axis in (0, 1):
        a, b = (slice(None, -1), slice(1, None)) if axis == 0 else (np.s_[:, :-1], np.s_[:, 1:])
        for here, there in ((a, b), (b, a)):
            mine, theirs = number[here], number[there]
            inner = (mine >= 0) & (theirs >= 0)
            edge = (mine >= 0) & known[there]
            rows.append(mine[inner])
            columns.append(theirs[inner])
            np.add.at(degree, mine[inner], 1.0)
            np.add.at(degree, mine[edge], 1.0)
            np.add.at(right, mine[edge], values[there][edge])
    row, column = np.concatenate(rows), np.concatenate(columns)
    table = sparse.csc_matrix((-np.ones(len(row)), (row, column)), shape=(count, count)) + sparse.diags(degree)
    solved = spsolve(table.tocsc(), right)
    out[reached] = solved.reshape(count, -1)
    return out


def _reached(known: Mask, unknown: Mask) -> Mask:
    """The unknown cells of areas that touch a known cell."""
    area, _ = scipy.ndimage.label(unknown)
    touched = np.unique(area[scipy.ndimage.binary_dilation(known) & unknown])
    return np.asarray(np.isin(area, touched[touched > 0]) & unknown)


def averaged(values: F64, weight: F64, sigma: float) -> F64:
    """Gaussian averages `[H, W, C]` of values `[H, W, C]` with weights `[H, W]`; where no weight is near, the mean."""
    total = scipy.ndimage.gaussian_filter(weight, sigma, mode="nearest")
    filled = np.stack([scipy.ndimage.gaussian_filter(values[..., c] * weight, sigma, mode="nearest")
                       for c in range(values.shape[2])], axis=2)  # fmt: skip
    mean = (values * weight[..., None]).sum(axis=(0, 1)) / max(float(weight.sum()), 1e-12)
    return np.asarray(np.where(total[..., None] > 1e-6, filled / np.maximum(total, 1e-6)[..., None], mean))
