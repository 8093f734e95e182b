"""The adjacency graph of regions: which superpoints touch, which are close without touching, and their sums.

Connected bodies that touch no other are tied to near ones: a lamp's shade hangs a hand's breadth above its pole, and
leaves float beside their stem.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from .regions import F64, I64, Borders, Graph, Regions
from .superpoints import Links

TIE_REACH = 20.0  # spacings within which separate bodies are tied
TIES_PER_REGION = 3  # nearest regions of other bodies that each region is tied to
MIN_BODY_POINTS = 12  # smaller bodies are noise and are not tied
MAX_PROBES = 200  # points of a region from which distances are measured


def build_graph(
    labels: NDArray[np.int32], points: F64, lab: F64, normals: F64, links: Links,
    kind_of: NDArray[np.int8], spacing: float, haze: float = 0.0,
) -> Graph:  # fmt: skip
    """The adjacency graph of the superpoints that are not structure.

    Args:
        labels: `[M]` superpoint of each point.
        points, normals: `[M, 3]` in the level frame.
        lab: `[M, 3]`.
        links: which points touch.
        kind_of: `[S]` structure kind of each superpoint, 0 for none.
        spacing: of the surface, scene units.
        haze: of the scene, see `haze.py`.
    """
    chosen = np.flatnonzero(kind_of == 0)
    number = np.full(len(kind_of), -1)
    number[chosen] = np.arange(len(chosen))
    regions = _regions(labels, points, lab, normals, links, kind_of, chosen)
    scale = max(float(np.median((regions.high - regions.low).max(1))) if len(chosen) else 1.0, 1e-9)
    own = number[labels]  # region of each point, -1 on structure
    ends = own[links.pairs]
    inner = (ends >= 0).all(1) & (ends[:, 0] != ends[:, 1])
    tied, gap = _ties(own, points, ends[inner], regions, spacing)
    pairs = np.concatenate([links.pairs[inner], tied])
    distance = np.concatenate([np.zeros(int(inner.sum())), gap])
    weight = np.concatenate([links.weight[inner], np.zeros(len(gap))])
    key, borders = _borders(own[pairs], pairs, weight, distance, points, lab, normals)
    return Graph(chosen, regions, key, borders, scale, haze)


def _regions(
    labels: NDArray[np.int32], points: F64, lab: F64, normals: F64, links: Links,
    kind_of: NDArray[np.int8], chosen: I64,
) -> Regions:  # fmt: skip
    count = len(kind_of)

    def total(values: F64) -> F64:
        sums = [np.bincount(labels, weights=v, minlength=count) for v in values.T]
        return np.stack(sums, axis=1)[chosen].astype(np.float64)

    upper = np.triu_indices(3)
    centred = points - points.mean(axis=0) if len(points) else points
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, labels, points)
    np.maximum.at(high, labels, points)
    ends = labels[links.pairs]
    across = ends[ends[:, 0] != ends[:, 1]]
    both = np.concatenate([across, across[:, ::-1]])

    def touching(kind: int) -> F64:
        return np.bincount(both[kind_of[both[:, 1]] == kind, 0], minlength=count)[chosen].astype(np.float64)

    return Regions(
        count=np.bincount(labels, minlength=count)[chosen].astype(np.float64),
        lab=total(lab),
        lab_squared=total(lab**2),
        place=total(centred),
        spread=total(centred[:, upper[0]] * centred[:, upper[1]]),
        turn=total(normals[:, upper[0]] * normals[:, upper[1]]),
        leaving=np.bincount(both[:, 0], minlength=count)[chosen].astype(np.float64),
        floor=touching(1),
        wall=touching(2),
        low=low[chosen],
        high=high[chosen],
    )


def _ties(own: I64, points: F64, ends: I64, regions: Regions, spacing: float) -> tuple[I64, F64]:
    """Nearest pairs of points `[T, 2]` of near regions of separate bodies, and their distances `[T]`."""
    count = len(regions.count)
    none = np.zeros((0, 2), np.int64), np.zeros(0)
    if count < 2:
        return none
    body = connected_components(coo_matrix((np.ones(len(ends)), ends.T), shape=(count, count)), directed=False)[1]
    mass = np.bincount(body, weights=regions.count)
    rows = np.flatnonzero(own >= 0)
    order = rows[np.argsort(own[rows], kind="stable")]
    parts = np.split(order, np.searchsorted(own[order], np.arange(1, count)))
    reach = TIE_REACH * spacing
    apart = np.maximum(regions.low[:, None] - regions.high[None], regions.low[None] - regions.high[:, None]).max(2)
    near = (apart < reach) & (body[:, None] != body[None]) & (mass[body] >= MIN_BODY_POINTS)[:, None]
    near &= mass[body] >= MIN_BODY_POINTS
    found: dict[tuple[int, int], tuple[float, int, int]] = {}
    trees: dict[int, cKDTree] = {}
    for i, j in np.argwhere(np.triu(near)).tolist():
        a, b = (i, j) if len(parts[i]) <= len(parts[j]) else (j, i)
        probe = parts[a][:: max(1, len(parts[a]) // MAX_PROBES)]
        if b not in trees:
            trees[b] = cKDTree(points[parts[b]])
        gap, at = trees[b].query(points[probe], distance_upper_bound=reach)
        k = int(np.argmin(gap))
        if np.isfinite(gap[k]):
            from_a, from_b = int(probe[k]), int(parts[b][at[k]])
            found[i, j] = (float(gap[k]), from_a, from_b)
    kept: set[tuple[int, int]] = set()
    for i in range(count):
        mine = sorted((v[0], key) for key, v in found.items() if i in key)
        kept.update(key for _, key in mine[:TIES_PER_REGION])
    if not kept:
        return none
    chosen = [found[key] for key in sorted(kept)]
    return np.array([c[1:] for c in chosen], np.int64), np.array([c[0] for c in chosen])


def _borders(
    ends: I64, pairs: I64, weight: F64, distance: F64, points: F64, lab: F64, normals: F64
) -> tuple[I64, Borders]:
    """Regions `[B, 2]` and border sums of every two regions that pairs of points connect."""
    swap = ends[:, 0] > ends[:, 1]
    ends = np.where(swap[:, None], ends[:, ::-1], ends)
    pairs = np.where(swap[:, None], pairs[:, ::-1], pairs)
    many = int(ends.max(initial=0)) + 1
    key, group = np.unique(ends[:, 0] * many + ends[:, 1], return_inverse=True)
    level, place = np.abs(normals[:, 2]), points[pairs].mean(axis=1)
    low, high = np.full((len(key), 2), np.inf), np.full((len(key), 2), -np.inf)
    np.minimum.at(low, group, place[:, :2])
    np.maximum.at(high, group, place[:, :2])
    gap = np.full(len(key), np.inf)
    np.minimum.at(gap, group, distance)

    def total(values: F64) -> F64:
        return np.asarray(np.bincount(group, weights=values, minlength=len(key)), np.float64)

    return np.stack([key // many, key % many], axis=1), Borders(
        pairs=total(np.ones(len(ends))),
        touching=total((distance == 0).astype(np.float64)),
        weight=total(weight),
        contrast=total(np.linalg.norm(lab[pairs[:, 0]] - lab[pairs[:, 1]], axis=1)),
        height=total(place[:, 2]),
        level=np.stack([total(level[pairs[:, 0]]), total(level[pairs[:, 1]])], axis=1),
        low=low,
        high=high,
        gap=gap,
    )
