"""Regions of the surface that grow by merging: their statistics, the features of a border, and the merge tree.

Knows geometry and colour. What makes two touching regions one thing is a small network over border features, fitted
 on furnished rooms with known objects (`train/affinity.py`).
"""

from __future__ import annotations

import heapq
import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from .superpoints import Links

F64 = NDArray[np.float64]

FEATURES = (
    "color", "lightness", "border color", "shared border", "border length", "rests on", "resting footprint",
    "height overlap", "plan overlap", "size ratio", "box growth", "smaller size", "larger size", "plan ratio",
    "contact height", "contact at edge", "contact footprint", "contact level", "smaller flat", "larger flat",
)  # fmt: skip


@dataclass
class Region:
    """Running statistics of one region; sums, so that merging is addition.

    Attributes:
        members: superpoints it is made of.
        count: surface points.
        lab: `[3]` sum of colours.
        low, high: `[3]` level-frame bounds (robust, from superpoints), scene units.
        perimeter: neighbour links to all other regions, structure included.
    """

    members: tuple[int, ...]
    count: float
    lab: F64
    low: F64
    high: F64
    perimeter: float

    @property
    def size(self) -> F64:
        return np.maximum(self.high - self.low, 1e-6)


@dataclass
class Border:
    """Sums over the links between two regions.

    Attributes:
        links: how many.
        weight: summed edge weight.
        height: summed height of the link ends.
        level: summed |n_z| of the first region's and of the second's ends.
        low, high: `[2]` plan bounds of the link ends.
    """

    links: float
    weight: float
    height: float
    level: tuple[float, float]
    low: F64
    high: F64

    def flipped(self) -> Border:
        return Border(self.links, self.weight, self.height, (self.level[1], self.level[0]), self.low, self.high)

    def plus(self, other: Border) -> Border:
        return Border(
            self.links + other.links,
            self.weight + other.weight,
            self.height + other.height,
            (self.level[0] + other.level[0], self.level[1] + other.level[1]),
            np.minimum(self.low, other.low),
            np.maximum(self.high, other.high),
        )


@dataclass(frozen=True)
class Node:
    """A node of the merge tree.

    Attributes:
        members: superpoints.
        children: indices of the two nodes merged into it, () for a superpoint.
        affinity: probability that its two children are one thing, 1 for a superpoint.
    """

    members: tuple[int, ...]
    children: tuple[int, ...]
    affinity: float


def describe(a: Region, b: Region, border: Border, scale: float) -> F64:
    """Features `[len(FEATURES)]` of a border, the same whichever region comes first. `scale`: typical object size."""
    first_small = a.count <= b.count
    small, large = (a, b) if first_small else (b, a)
    level_small, level_large = border.level if first_small else border.level[::-1]
    gap = a.lab / a.count - b.lab / b.count
    contact = border.height / border.links
    rests = max(_rests(a, b, contact, border.level[1] / border.links),
                _rests(b, a, contact, border.level[0] / border.links))  # fmt: skip
    overlap = np.minimum(a.high, b.high) - np.maximum(a.low, b.low)
    share = np.clip(overlap / np.minimum(a.size, b.size), 0, 1)
    grown = np.maximum(a.high, b.high) - np.minimum(a.low, b.low)
    growth = np.log(np.prod(grown) / (np.prod(a.size) + np.prod(b.size)) + 1e-3)
    plan = float(share[0] * share[1])
    middle = (border.low + border.high) / 2
    aside = np.abs(middle - (large.low + large.high)[:2] / 2) / (large.size[:2] / 2 + 1e-6)
    footprint = np.prod(border.high - border.low + 1e-3) / np.prod(small.size[:2] + 1e-3)
    return np.array(
        [
            min(float(np.linalg.norm(gap[1:])) / 20, 3.0),
            min(abs(float(gap[0])) / 30, 2.0),
            min(border.weight / border.links, 6.0),
            border.links / max(min(a.perimeter, b.perimeter), 1.0),
            np.log(border.links / np.sqrt(small.count)),
            rests,
            rests * plan,
            float(share[2]),
            plan,
            np.log(large.count / small.count),
            float(np.clip(growth, -1, 3)),
            np.log(float(small.size.max()) / scale + 1e-3),
            np.log(float(large.size.max()) / scale + 1e-3),
            float(np.log(np.prod(large.size[:2] + 1e-3) / np.prod(small.size[:2] + 1e-3))),
            float(np.clip((contact - large.low[2]) / large.size[2], -0.5, 1.5)),
            float(np.clip(aside.max(), 0, 2)),
            float(np.clip(footprint, 0, 1.5)),
            (level_small - level_large) / border.links,
            np.log(float(small.size[2] / small.size[:2].max()) + 1e-2),
            np.log(float(large.size[2] / large.size[:2].max()) + 1e-2),
        ]
    )


def _rests(upper: Region, lower: Region, contact: float, level: float) -> float:
    """How much it looks as if `upper` stood on a level surface of `lower`: contact at its foot, body above."""
    height = upper.high[2] - upper.low[2]
    if height < 1e-6 or upper.high[2] <= contact:
        return 0.0
    foot = np.clip(1 - abs(contact - upper.low[2]) / (0.15 * height + 1e-6), 0, 1)
    return float(foot * level * (upper.high[2] - contact > 0.8 * height))


@dataclass(frozen=True)
class Rule:
    """A small network over standardised features: one hidden layer of tanh units."""

    mean: F64
    spread: F64
    inner: F64
    inner_bias: F64
    outer: F64
    outer_bias: float

    def probability(self, features: F64) -> F64:
        """`[..., F]` to `[...]`."""
        hidden = np.tanh((features - self.mean) / self.spread @ self.inner + self.inner_bias)
        result: F64 = 1 / (1 + np.exp(-np.clip(hidden @ self.outer + self.outer_bias, -30, 30)))
        return result


@cache
def _rule() -> Rule:
    table = json.loads((files(__package__) / "affinity.json").read_text())
    assert tuple(table["features"]) == FEATURES, "affinity.json was fitted for other features"
    arrays = {name: np.array(table[name]) for name in ("mean", "spread", "inner", "inner_bias", "outer")}
    return Rule(**arrays, outer_bias=float(table["outer_bias"]))


def affinity(features: F64) -> F64:
    """Probability `[...]` that the regions on both sides are one thing, of features `[..., F]`."""
    return _rule().probability(features)


class Graph:
    """Regions and borders under merging."""

    def __init__(self, regions: list[Region], borders: dict[tuple[int, int], Border], scale: float) -> None:
        self.regions: dict[int, Region] = dict(enumerate(regions))
        self.around: dict[int, dict[int, Border]] = {i: {} for i in self.regions}
        self.scale = scale
        for (i, j), border in borders.items():
            self.around[i][j] = border
            self.around[j][i] = border.flipped()

    def features(self, i: int, j: int) -> F64:
        return describe(self.regions[i], self.regions[j], self.around[i][j], self.scale)

    def merge(self, i: int, j: int, new: int) -> None:
        """Replace regions i and j by one called `new`."""
        a, b = self.regions.pop(i), self.regions.pop(j)
        inner = self.around[i][j].links
        self.regions[new] = Region(
            a.members + b.members, a.count + b.count, a.lab + b.lab, np.minimum(a.low, b.low),
            np.maximum(a.high, b.high), a.perimeter + b.perimeter - 2 * inner,
        )  # fmt: skip
        near: dict[int, Border] = {}
        for old in (i, j):
            for other, border in self.around.pop(old).items():
                if other in (i, j):
                    continue
                near[other] = near[other].plus(border) if other in near else border
                del self.around[other][old]
        self.around[new] = near
        for other, border in near.items():
            self.around[other][new] = border.flipped()


def merge_tree(graph: Graph) -> list[Node]:
    """Merge the likeliest border first until nothing touches; nodes in order, children before parents."""
    nodes = [Node(r.members, (), 1.0) for _, r in sorted(graph.regions.items())]
    heap: list[tuple[float, int, int]] = []

    def offer(pairs: list[tuple[int, int]]) -> None:
        if pairs:
            likely = affinity(np.stack([graph.features(i, j) for i, j in pairs]))
            for (i, j), p in zip(pairs, likely, strict=True):
                heapq.heappush(heap, (-float(p), i, j))

    offer([(i, j) for i, near in graph.around.items() for j in near if i < j])
    while heap:
        negative, i, j = heapq.heappop(heap)
        if i not in graph.regions or j not in graph.regions:
            continue
        new = len(nodes)
        graph.merge(i, j, new)
        nodes.append(Node(graph.regions[new].members, (i, j), -negative))
        offer([(other, new) for other in graph.around[new]])
    return nodes


def build_graph(
    labels: NDArray[np.int32], points: F64, lab: F64, normals: F64, links: Links, free: NDArray[np.bool_]
) -> Graph:
    """The graph of the free superpoints.

    Args:
        labels: `[M]` superpoint of each point.
        points, normals: `[M, 3]` in the level frame.
        lab: `[M, 3]`.
        links: which points touch.
        free: `[S]` superpoints that are no structure.
    """
    count = len(free)
    total = np.maximum(np.bincount(labels, minlength=count), 1)
    sums = np.stack([np.bincount(labels, weights=lab[:, c], minlength=count) for c in range(3)], axis=1)
    low, high = _bounds(labels, points, count)
    ends = labels[links.pairs]
    across = ends[:, 0] != ends[:, 1]
    perimeter = np.bincount(ends[across].ravel(), minlength=count)
    chosen = np.flatnonzero(free)
    number = np.full(count, -1)
    number[chosen] = np.arange(len(chosen))
    scale = float(np.median(np.max(high[chosen] - low[chosen], axis=1))) if len(chosen) else 1.0
    regions = [Region((int(s),), float(total[s]), sums[s], low[s], high[s], float(perimeter[s])) for s in chosen]
    inner = across & free[ends].all(axis=1)
    borders = _borders(number[ends[inner]], links.pairs[inner], links.weight[inner], points, normals)
    return Graph(regions, borders, max(scale, 1e-9))


def _bounds(labels: NDArray[np.int32], points: F64, count: int) -> tuple[F64, F64]:
    """Lower and upper corner `[S, 3]` of each superpoint."""
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, labels, points)
    np.maximum.at(high, labels, points)
    return low, high


def _borders(
    ends: NDArray[np.int64], pairs: NDArray[np.int32], weight: NDArray[np.float32], points: F64, normals: F64
) -> dict[tuple[int, int], Border]:
    """Sums over the links of each touching pair."""
    swap = ends[:, 0] > ends[:, 1]
    ends = np.where(swap[:, None], ends[:, ::-1], ends)
    pairs = np.where(swap[:, None], pairs[:, ::-1], pairs)
    many = int(ends.max(initial=0)) + 1
    key, group = np.unique(ends[:, 0] * many + ends[:, 1], return_inverse=True)
    level, place = np.abs(normals[:, 2]), points[pairs].mean(axis=1)
    sums = [
        np.bincount(group, weights=w, minlength=len(key))
        for w in (np.ones(len(ends)), weight, place[:, 2], level[pairs[:, 0]], level[pairs[:, 1]])
    ]
    low, high = np.full((len(key), 2), np.inf), np.full((len(key), 2), -np.inf)
    np.minimum.at(low, group, place[:, :2])
    np.maximum.at(high, group, place[:, :2])
    return {
        (int(k // many), int(k % many)): Border(float(n), float(w), float(h), (float(a), float(b)), low[e], high[e])
        for e, (k, n, w, h, a, b) in enumerate(zip(key, *sums, strict=True))
    }
