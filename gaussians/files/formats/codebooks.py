"""Few values that stand for many: codebooks of numbers and palettes of vectors, by k-means (Lloyd 1982).

Knows arrays. Refuses to know what they mean. Equal input gives equal output: seeds are fixed, and products of
matrices run on one thread.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Labels = NDArray[np.int64]

_ROUNDS_SCALAR, _ROUNDS_VECTOR = 40, 6
_SAMPLE = 1 << 20  # numbers that a codebook is made from; more change it by less than its own step
_BLOCK = 1 << 12  # rows compared with all centres at a time
_LEAST = 64  # rows a branch of a palette has on average; fewer would be compared with too many branches
_SEED = 5


def codebook(numbers: Floats, size: int) -> Floats:
    """At most `size` sorted values that stand for `numbers` `[...]` with small squared error.

    Starts half from quantiles, which follow the mass, and half from even steps, which follow the ends.
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
    """Position in a sorted codebook of at most 256 values of the one nearest to each number, in its shape."""
    middles = (book[1:].astype(np.float64) + book[:-1]) / 2
    return np.searchsorted(middles, numbers).astype(np.uint8)


def palette(rows: Floats, size: int) -> tuple[Floats, Labels]:
    """At most `size` vectors that stand for `rows [N, D]`, and which one stands for each row, `[N]`.

    Two levels, each plain k-means: the square root of `size` branches, then in every branch its share of the palette
    by its number of rows. A row is compared with the branches and with the vectors of its own branch only, which makes
    a million rows and 65,536 vectors a matter of seconds.
    """
    distinct, inverse = _distinct(rows, size)
    if distinct is not None:
        return distinct, inverse
    threads = torch.get_num_threads()
    torch.set_num_threads(1)  # the products are small: handing them around takes ten times as long on a busy machine
    try:
        return _two_levels(rows, size)
    finally:
        torch.set_num_threads(threads)


def _two_levels(rows: Floats, size: int) -> tuple[Floats, Labels]:
    """See `palette`."""
    rng = np.random.default_rng(_SEED)
    branches, branch = _means(rows, max(1, min(int(np.sqrt(size)), len(rows) // _LEAST)), rng)
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
    """The different rows and where each went, if they all fit into a palette."""
    keys = np.ascontiguousarray(rows).view(np.dtype((np.void, rows.shape[1] * rows.itemsize)))[:, 0]
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    return (rows[first], inverse) if len(first) <= size else (None, inverse)


def _means(rows: Floats, size: int, rng: np.random.Generator) -> tuple[Floats, Labels]:
    """Plain k-means; centres that lose all their rows are dropped."""
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
    """Which centre is nearest to each row."""
    half = torch.from_numpy(np.einsum("ij,ij->i", centres, centres) / 2)
    across = torch.from_numpy(np.ascontiguousarray(centres.T))
    blocks = torch.split(torch.from_numpy(np.ascontiguousarray(rows)), _BLOCK)
    return torch.cat([torch.addmm(half, block, across, beta=-1).argmax(dim=1) for block in blocks]).numpy()
