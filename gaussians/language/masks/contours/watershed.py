"""Divide a picture into small regions along its contours, and measure the contour between each two of them.

The watershed transform by flooding from seeds (Meyer 1994). A seed is a local minimum of contour strength minus a small
multiple of the distance from contours, so that a region ends at a narrow passage, even where its contour has a gap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import ndimage

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

SMOOTHING = 1.0  # pixels, of the contours in which seeds are searched
CONTOUR = 0.15  # strength from which a pixel counts as contour when distances are measured
REACH = 16.0  # pixels: distances from contours count up to here
DEPTH = 0.06  # contour strength that a distance of REACH is worth
LEVELS = 1024  # steps in which the flood rises
MIN_PIXELS = 16  # of a region; smaller ones join the neighbour with the weakest contour between them
MAX_REGIONS = 1500  # the regions with the weakest contours between them are merged down to this number


@dataclass(frozen=True, eq=False)
class Regions:
    """The finest regions of a picture and the contours between them.

    Attributes:
        labels: `[H, W]` int32: region of each pixel, numbered from 0 without gaps.
        pairs: `[E, 2]` int32: regions that touch, the smaller number first, ascending.
        total: `[E]` float64: contour strength summed over the pairs of adjacent pixels on their common border.
        length: `[E]` float64: number of these pairs of pixels.
    """

    labels: I32
    pairs: I32
    total: F64
    length: F64

    @property
    def count(self) -> int:
        """Number of regions."""
        return int(self.labels.max(initial=-1)) + 1


def regions_of(contour: F32, max_regions: int = MAX_REGIONS) -> Regions:
    """The regions that the contours `[H, W]` in [0, 1] bound; they partition the picture."""
    labels = _flood(_steps(contour), _seeds(contour))
    labels = _without_small(labels, contour)
    found = borders(labels, contour)
    excess = found.count - max_regions
    if excess > 0:
        mean = found.total / found.length
        order = np.lexsort((found.pairs[:, 1], found.pairs[:, 0], mean))
        labels = _merged(labels, found.pairs[order], excess)
        found = borders(labels, contour)
    return found


def borders(labels: I32, contour: F32) -> Regions:
    """The contours between the regions `[H, W]` of a picture. Of two adjacent pixels the stronger contour counts."""
    ends, strength = [], []
    for a, b in ((np.s_[:, :-1], np.s_[:, 1:]), (np.s_[:-1], np.s_[1:])):
        differ = labels[a] != labels[b]
        first, second = labels[a][differ], labels[b][differ]
        ends.append(np.stack([np.minimum(first, second), np.maximum(first, second)], axis=1))
        strength.append(np.maximum(contour[a], contour[b])[differ])
    pairs, values = np.concatenate(ends).astype(np.int64), np.concatenate(strength).astype(np.float64)
    count = int(labels.max(initial=-1)) + 1
    code, at = np.unique(pairs[:, 0] * count + pairs[:, 1], return_inverse=True)
    total = np.bincount(at, weights=values, minlength=len(code)).astype(np.float64)
    length = np.bincount(at, minlength=len(code)).astype(np.float64)
    both = np.stack([code // max(count, 1), code % max(count, 1)], axis=1).astype(np.int32)
    return Regions(labels, both, total, length)


def _seeds(contour: F32) -> I32:
    """`[H, W]` number of the seed at each pixel from 1, 0 for none."""
    smooth = ndimage.gaussian_filter(contour, SMOOTHING, mode="nearest")
    away = (
        ndimage.distance_transform_edt(smooth < CONTOUR) if (smooth >= CONTOUR).any() else np.full(smooth.shape, REACH)
    )
    height = smooth - DEPTH / REACH * np.minimum(away, REACH)
    height = np.round(height * (4 * LEVELS)).astype(np.int32)
    lowest = height == ndimage.minimum_filter(height, size=3, mode="nearest")
    found: I32 = ndimage.label(lowest, np.ones((3, 3)))[0].astype(np.int32)
    return found


def _steps(contour: F32) -> I32:
    """The contours in whole steps of the flood; a little smoothed, so that the flood meets on the crest."""
    smooth = ndimage.gaussian_filter(contour, 0.5 * SMOOTHING, mode="nearest")
    steps: I32 = np.clip(np.round(smooth * (LEVELS - 1)), 0, LEVELS - 1).astype(np.int32)
    return steps


def _flood(steps: I32, seeds: I32) -> I32:
    """Regions `[H, W]` grown from the seeds in the order of the steps, first come, first served, numbered from 0."""
    labels = seeds.copy()
    _grow(steps, labels, LEVELS)
    return labels - 1


def _without_small(labels: I32, contour: F32) -> I32:
    """The regions after those of fewer than MIN_PIXELS pixels joined the neighbour with the weakest contour between."""
    found = borders(labels, contour)
    size = np.bincount(labels.ravel()).astype(np.int64)
    mean = found.total / found.length
    order = np.lexsort((found.pairs[:, 1], found.pairs[:, 0], mean))
    joined = _join_small(found.pairs[order], size, MIN_PIXELS)
    renamed: I32 = np.unique(joined, return_inverse=True)[1].astype(np.int32)
    return renamed[labels]


def _merged(labels: I32, pairs: I32, merges: int) -> I32:
    """The regions after the first pairs that are not yet joined have been, `merges` times."""
    joined = _join_first(pairs, int(labels.max()) + 1, merges)
    renamed: I32 = np.unique(joined, return_inverse=True)[1].astype(np.int32)
    return renamed[labels]


@njit(cache=True, nogil=True)
def _grow(steps: I32, labels: I32, levels: int) -> None:  # pragma: no cover - compiled
    """Flood in place: one queue per level; a pixel enters the queue of its own level, or of the flood's if higher."""
    height, width = steps.shape
    count = height * width
    head, tail = np.full(levels, -1, np.int32), np.full(levels, -1, np.int32)
    following = np.full(count, -1, np.int32)
    flat_steps, flat = steps.ravel(), labels.ravel()
    waiting = np.zeros(count, np.bool_)
    for i in range(count):
        if flat[i] > 0:
            waiting[i] = True
            at = flat_steps[i]
            if tail[at] < 0:
                head[at] = i
            else:
                following[tail[at]] = i
            tail[at] = i
    level = 0
    while level < levels:
        i = head[level]
        if i < 0:
            level += 1
            continue
        head[level] = following[i]
        if head[level] < 0:
            tail[level] = -1
        y, x = i // width, i % width
        for k in range(4):
            v, u = y + (k == 0) - (k == 1), x + (k == 2) - (k == 3)
            if v < 0 or u < 0 or v >= height or u >= width:
                continue
            j = v * width + u
            if waiting[j]:
                continue
            waiting[j] = True
            flat[j] = flat[i]
            at = max(flat_steps[j], level)
            following[j] = -1
            if tail[at] < 0:
                head[at] = j
            else:
                following[tail[at]] = j
            tail[at] = j


@njit(cache=True, nogil=True)
def _root(parent: I32, i: int) -> int:  # pragma: no cover - compiled
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@njit(cache=True, nogil=True)
def _join_small(pairs: I32, size: NDArray[np.int64], least: int) -> I32:  # pragma: no cover - compiled
    parent = np.arange(len(size)).astype(np.int32)
    for e in range(len(pairs)):
        a, b = _root(parent, pairs[e, 0]), _root(parent, pairs[e, 1])
        if a != b and (size[a] < least or size[b] < least):
            parent[b] = a
            size[a] += size[b]
    for i in range(len(parent)):
        parent[i] = _root(parent, i)
    return parent


@njit(cache=True, nogil=True)
def _join_first(pairs: I32, count: int, merges: int) -> I32:  # pragma: no cover - compiled
    parent = np.arange(count).astype(np.int32)
    done = 0
    for e in range(len(pairs)):
        if done == merges:
            break
        a, b = _root(parent, pairs[e, 0]), _root(parent, pairs[e, 1])
        if a != b:
            parent[b] = a
            done += 1
    for i in range(count):
        parent[i] = _root(parent, i)
    return parent
