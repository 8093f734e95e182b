"""Over-segmentation: surface points to a few hundred superpoints, and the graph of who touches whom.

The greedy graph merge of Felzenszwalb & Huttenlocher (IJCV 2004) over nearest neighbours in 3D. Knows geometry and
colour only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from .surface import Surface

SCALE = 3.0  # k of the paper, in units of edge weight times points: larger gives larger superpoints
MIN_POINTS = 12
COLOR_UNIT = 10.0  # Lab difference that counts as one edge unit
NORMAL_UNIT = 0.35  # 1 - |cos| that counts as one
NOISE = 3.0  # a scene whose neighbours typically differ (a noisy capture) gets units this many medians wide
LIGHTNESS = 0.6  # baked light changes L along one surface more than a and b
CONTACT = 4.0  # points farther apart than this many spacings do not touch


@dataclass(frozen=True)
class Contact:
    """Superpoints that touch, as parallel arrays over E pairs.

    Attributes:
        pairs: `[E, 2]` int32 superpoint ids, first < second.
        links: `[E]` int32, neighbour links across the border: how long it is.
        weight: `[E]` float32, mean edge weight across the border.
    """

    pairs: NDArray[np.int32]
    links: NDArray[np.int32]
    weight: NDArray[np.float32]


def edges_of(surface: Surface) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
    """Neighbour links `[E, 2]` that touch, and how unlike their ends are `[E]`."""
    m, k = surface.neighbours.shape
    first = np.repeat(np.arange(m, dtype=np.int32), k)
    second = surface.neighbours.ravel()
    local = surface.gaps[:, k // 2]
    reach = np.maximum(CONTACT * surface.spacing, 1.5 * np.minimum(local[first], local[second]))
    keep = (surface.gaps.ravel() <= reach) & (first != second)
    mutual = (first < second) | ~_has_reverse(surface.neighbours).ravel()
    pick = keep & mutual
    a, b = first[pick], second[pick]
    difference = surface.lab[a] - surface.lab[b]
    difference[:, 0] *= LIGHTNESS
    color = np.sqrt((difference**2).sum(1))
    both_flat = surface.flatness[a] * surface.flatness[b]
    turn = (1 - np.abs((surface.normals[a] * surface.normals[b]).sum(1))) * both_flat
    weight = color / max(COLOR_UNIT, NOISE * _median(color)) + turn / max(NORMAL_UNIT, NOISE * _median(turn))
    return np.stack([a, b], axis=1), weight.astype(np.float32)


def _median(values: NDArray[np.floating]) -> float:
    return float(np.median(values)) if len(values) else 0.0


def superpoints(surface: Surface, scale: float = SCALE) -> tuple[NDArray[np.int32], Contact]:
    """Superpoint of each surface point `[M]`, numbered from 0, and their contacts."""
    edges, weight = edges_of(surface)
    order = np.argsort(weight, kind="stable")
    labels = _merge(len(surface), edges[order], weight[order], np.float32(scale), MIN_POINTS)
    labels = np.unique(labels, return_inverse=True)[1].astype(np.int32)
    return labels, contacts(labels, edges, weight)


def contacts(labels: NDArray[np.int32], edges: NDArray[np.int32], weight: NDArray[np.float32]) -> Contact:
    """Who touches whom under a labelling of the points."""
    ends = np.sort(labels[edges], axis=1)
    across = ends[:, 0] != ends[:, 1]
    ends, crossing = ends[across], weight[across]
    count = int(labels.max(initial=-1)) + 1
    key, inverse, links = np.unique(
        ends[:, 0].astype(np.int64) * count + ends[:, 1], return_inverse=True, return_counts=True
    )
    mean = np.bincount(inverse, weights=crossing, minlength=len(key)) / np.maximum(links, 1)
    pairs = np.stack([key // max(count, 1), key % max(count, 1)], axis=1).astype(np.int32)
    return Contact(pairs, links.astype(np.int32), mean.astype(np.float32))


@njit(cache=True, nogil=True)
def _has_reverse(neighbours: NDArray[np.int32]) -> NDArray[np.bool_]:  # pragma: no cover - compiled
    """`[M, K]`: whether the neighbour also counts this point among its own."""
    m, k = neighbours.shape
    found = np.zeros((m, k), np.bool_)
    for i in range(m):
        for s in range(k):
            j = neighbours[i, s]
            for t in range(k):
                if neighbours[j, t] == i:
                    found[i, s] = True
                    break
    return found


@njit(cache=True, nogil=True)
def _root(parent: NDArray[np.int32], i: int) -> int:  # pragma: no cover - compiled
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@njit(cache=True, nogil=True)
def _merge(
    count: int, edges: NDArray[np.int32], weight: NDArray[np.float32], scale: np.float32, least: int
) -> NDArray[np.int32]:  # pragma: no cover - compiled
    """Union over edges sorted by weight, then small regions into the neighbour they differ least from."""
    parent = np.arange(count).astype(np.int32)
    size = np.ones(count, np.int32)
    limit = np.full(count, scale, np.float32)  # internal difference + scale / size
    for e in range(len(edges)):
        a, b = _root(parent, edges[e, 0]), _root(parent, edges[e, 1])
        if a != b and weight[e] <= min(limit[a], limit[b]):
            parent[b] = a
            size[a] += size[b]
            limit[a] = weight[e] + scale / size[a]
    for e in range(len(edges)):
        a, b = _root(parent, edges[e, 0]), _root(parent, edges[e, 1])
        if a != b and (size[a] < least or size[b] < least):
            parent[b] = a
            size[a] += size[b]
    for i in range(count):
        parent[i] = _root(parent, i)
    return parent
