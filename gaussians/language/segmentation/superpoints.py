"""Over-segmentation of the surface points into a few hundred superpoints, and the links between touching points.

The greedy graph merge of Felzenszwalb & Huttenlocher (IJCV 2004) over nearest neighbours in 3D, by geometry and colour.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from .surface import Surface

SCALE = 3.0  # k of the paper, in units of edge weight times points: larger gives larger superpoints
MIN_POINTS = 40  # of a superpoint; anything smaller joins the neighbour it differs least from
COLOR_UNIT = 10.0  # Lab difference that counts as one edge unit
NORMAL_UNIT = 0.35  # 1 - |cos| that counts as one
NOISE = 3.0  # a scene whose neighbours typically differ (a noisy capture) gets units this many medians wide
LIGHTNESS = 0.6  # baked light changes L along one surface more than a and b
CONTACT = 4.0  # points farther apart than this many spacings do not touch


@dataclass(frozen=True)
class Links:
    """Neighbouring surface points that touch.

    Attributes:
        pairs: `[E, 2]` int32 indices of points.
        weight: `[E]` float32, dissimilarity of the two points, in noise units.
    """

    pairs: NDArray[np.int32]
    weight: NDArray[np.float32]


def links_of(surface: Surface) -> Links:
    """Links between neighbours close enough to touch, weighted by dissimilarity of colour and normal."""
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
    return Links(np.stack([a, b], axis=1), weight.astype(np.float32))


def _median(values: NDArray[np.floating]) -> float:
    return float(np.median(values)) if len(values) else 0.0


def superpoints(surface: Surface, links: Links, scale: float = SCALE, least: int = MIN_POINTS) -> NDArray[np.int32]:
    """Superpoint of each surface point `[M]`, numbered from 0."""
    labels = merge_regions(len(surface), links.pairs, links.weight, scale, least)
    return np.unique(labels, return_inverse=True)[1].astype(np.int32)


def merge_regions(
    count: int, pairs: NDArray[np.integer], weight: NDArray[np.floating], scale: float, least: int
) -> NDArray[np.int32]:
    """Merge `count` points over weighted pairs `[E, 2]`; each point's region `[count]`, named by one of its points.

    Args:
        scale: k of the paper.
        least: regions of fewer points are joined to the neighbour they differ least from.
    """
    order = np.argsort(weight, kind="stable")
    edges, sorted_weight = pairs[order].astype(np.int32), weight[order].astype(np.float32)
    labels: NDArray[np.int32] = _merge(count, edges, sorted_weight, np.float32(scale), least)
    return labels


def touching(labels: NDArray[np.int32], links: Links) -> dict[int, set[int]]:
    """The superpoints that each superpoint touches; those that touch none are left out."""
    ends = np.unique(labels[links.pairs], axis=0)
    near: dict[int, set[int]] = {}
    for a, b in ends[ends[:, 0] != ends[:, 1]].tolist():
        near.setdefault(a, set()).add(b)
        near.setdefault(b, set()).add(a)
    return near


@njit(cache=True, nogil=True)
def _has_reverse(neighbours: NDArray[np.int32]) -> NDArray[np.bool_]:  # pragma: no cover - compiled
    """Whether each neighbour `[M, K]` has this point among its own neighbours."""
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
    """Union-find over edges sorted by weight, then small regions are joined to the neighbour they differ least from."""
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
