"""Vector quantisation by k-means (Lloyd 1982): codebooks of numbers and palettes of vectors.

Equal input gives equal output: seeds are fixed, and matrix products run on one thread.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Labels = NDArray[np.int64]

_ROUNDS_SCALAR, _ROUNDS_VECTOR = 40, 6
_SAMPLE = 1 << 20  # numbers that a codebook is fitted to; more change it by less than its own step
_BLOCK = 1 << 12  # rows compared with all centres at a time
_MIN_BRANCH_ROWS = 64  # average rows per branch of a palette; with fewer, rows are compared with too many branches
_SEED = 5


def codebook(numbers: Floats, size: int) -> Floats:
    """At most `size` sorted values that approximate `numbers` `[...]` with small squared error.

    Half of the initial centres are quantiles, which follow the density; half are even steps, which cover the range.
    """
    flat = np.sort(numbers.ravel()[:: -(-numbers.size // _SAMPLE)]).astype(np.float64)
    first, last = float(numbers.min()), float(numbers.max())
    distinct = np.unique(flat)
    if len(distinct) < size and flat.size == numbers.size:
        return distinct.astype(np.float32)
    half = size // 2
    centres = np.sort(
        np.concatenate([np.quantile(flat, (np.arange(half) + 0.5) / half), np.linspace(first, last, size - half)])
    )
    sums = np.concatenate([[0.0], np.cumsum(flat)])
    for _ in range(_ROUNDS_SCALAR):
        cuts = np.concatenate([[0], np.searchsorted(flat, (centres[1:] + centres[:-1]) / 2), [flat.size]])
        counts = np.diff(cuts)
        centres = np.where(counts > 0, np.diff(sums[cuts]) / np.maximum(counts, 1), centres)
    return np.unique(centres.astype(np.float32))


def nearest(numbers: Floats, book: Floats) -> NDArray[np.uint8]:
    """Index of the nearest value in a sorted codebook of at most 256 values, for each of `numbers` (same shape)."""
    middles = (book[1:].astype(np.float64) + book[:-1]) / 2
    return np.searchsorted(middles, numbers).astype(np.uint8)


def palette(rows: Floats, size: int) -> tuple[Floats, Labels]:
    """At most `size` vectors that approximate `rows [N, D]`, and the index `[N]` of each row's vector.

    Two levels of plain k-means: first about sqrt(`size`) branches, then in every branch a share of the palette in
    proportion to its rows. A row is compared only with the branches and with the vectors of its own branch, so a
    million rows and 65,536 vectors take seconds.
    """
    distinct, inverse = _distinct(rows, size)
    if distinct is not None:
        return distinct, inverse
    threads = torch.get_num_threads()
    torch.set_num_threads(1)  # the products are small: distributing them takes ten times as long on a busy machine
    try:
        return _two_levels(rows, size)
    finally:
        torch.set_num_threads(threads)


def _two_levels(rows: Floats, size: int) -> tuple[Floats, Labels]:
    """The two k-means levels of `palette`."""
    rng = np.random.default_rng(_SEED)
    branches, branch = _means(rows, max(1, min(int(np.sqrt(size)), len(rows) // _MIN_BRANCH_ROWS)), rng)
    order = np.argsort(branch, kind="stable")
    counts = np.bincount(branch, minlength=len(branches))
    ends = np.cumsum(counts)
    shares = np.diff(np.concatenate([[0], np.floor(ends * (size / len(rows)) + 1e-9)])).astype(int)
    centres: list[Floats] = []
    labels, made = np.empty(len(rows), np.int64), 0
    for end, count, share in zip(ends, counts, shares, strict=True):
        own = order[end - count : end]
        if not count:
            continue
        found, label = _means(rows[own], max(1, share), rng)
        labels[own] = label + made
        centres.append(found)
        made += len(found)
    return np.concatenate(centres), labels


def _distinct(rows: Floats, size: int) -> tuple[Floats | None, Labels]:
    """The distinct rows (None if more than `size`) and the index of each row among them."""
    keys = np.ascontiguousarray(rows).view(np.dtype((np.void, rows.shape[1] * rows.itemsize)))[:, 0]
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    return (rows[first], inverse) if len(first) <= size else (None, inverse)


def _means(rows: Floats, size: int, rng: np.random.Generator) -> tuple[Floats, Labels]:
    """Plain k-means: centres and the label of each row; centres without rows are dropped."""
    centres = rows[np.sort(rng.choice(len(rows), min(size, len(rows)), replace=False))]
    label = _assign(rows, centres)
    for _ in range(_ROUNDS_VECTOR):
        order = np.argsort(label, kind="stable")
        counts = np.bincount(label, minlength=len(centres))
        kept = counts > 0
        starts = (np.cumsum(counts) - counts)[kept]
        centres = (np.add.reduceat(rows[order], starts, axis=0) / counts[kept, None]).astype(np.float32)
        label = _assign(rows, centres)
    return centres, label


def _assign(rows: Floats, centres: Floats) -> Labels:
    """Index of the nearest centre for each row."""
    half = torch.from_numpy(np.einsum("ij,ij->i", centres, centres) / 2)
    across = torch.from_numpy(np.ascontiguousarray(centres.T))
    blocks = torch.split(torch.from_numpy(np.ascontiguousarray(rows)), _BLOCK)
    return torch.cat([torch.addmm(half, block, across, beta=-1).argmax(dim=1) for block in blocks]).numpy()
