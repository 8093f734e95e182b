"""Choose the nodes of the merge tree that are whole objects, and split objects into parts of one colour.

The choice combines the merge probabilities with a score "this looks like one whole object" for each node, which the
caller supplies.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from .regions import Node
from .superpoints import LIGHTNESS

F64 = NDArray[np.float64]

GEOMETRY_WEIGHT = 1.0  # weight of a merge's log-odds against the encoder's
CERTAIN, RULED_OUT = 0.99, 0.01  # merge probabilities from which, and below which, the encoder is not asked
MINOR_SHARE = 0.03  # of a node's points: a child smaller than this says nothing about the rest
SAME_SHARE = 0.92  # of a node's points: a child that holds this much looks the same as the node
PATCH_COLOR = 15.0  # Lab difference up to which touching patches of one object are one part
PATCH_DIVIDED = 25.0  # Lab difference that a border counts for which masks divide surely
PATCH_POINTS = 30  # surface points; smaller patches join the touching one they resemble most
PATCH_SHARE = 0.01  # of the object's points; smaller patches are joined likewise


def nearly_same_ancestor(nodes: Sequence[Node], points: NDArray[np.int64]) -> NDArray[np.int64]:
    """For each node its largest ancestor that holds nearly the same points, or itself; both share one render."""
    same = np.arange(len(nodes))
    for i in range(len(nodes) - 1, -1, -1):
        for child in nodes[i].children:
            if points[child] >= SAME_SHARE * points[same[i]]:
                same[child] = same[i]
    return same


def undecided_nodes(nodes: Sequence[Node], points: NDArray[np.int64]) -> list[int]:
    """The nodes whose evidence can change the cut: those that geometry neither confirms nor rules out, and the
    possible objects below them."""
    weakest = weakest_merges(nodes, points)
    wanted = np.zeros(len(nodes), bool)  # whether an ancestor needs this node's evidence
    found = []
    for i in range(len(nodes) - 1, -1, -1):
        certain, ruled_out = weakest[i] >= CERTAIN, weakest[i] < RULED_OUT
        if not ruled_out and (wanted[i] or not certain):
            found.append(i)
        if not certain:
            wanted[list(nodes[i].children)] = wanted[i] or not ruled_out
    return found[::-1]


def best_cut(
    nodes: Sequence[Node], points: NDArray[np.int64], evidence: dict[int, float], certain: int | None = None
) -> list[int]:
    """The best cut of the merge tree: disjoint nodes that cover every superpoint, each taken for one object.

    From the leaves upwards, a node stays whole if its evidence plus the log-odds of the weakest merge inside it is at
    least the mean evidence of the best cut below it, weighted by points. The mean is used instead of the sum because
    two halves that each look like an object must not defeat the one object that they make. The weakest merge is used
    instead of the last because a wrong merge does not become right when a small region is added to it. Where geometry
    is certain, the evidence is ignored.

    Args:
        points: `[len(nodes)]` number of surface points of each node.
        evidence: log-odds that a node is one whole object; 0 where missing.
        certain: a node that is one object regardless of its evidence.
    """
    value, whole = np.zeros(len(nodes)), np.ones(len(nodes), bool)
    weakest = weakest_merges(nodes, points)
    for i, node in enumerate(nodes):
        value[i] = evidence.get(i, 0.0)
        if node.children:
            below = sum(float(points[c]) * value[c] for c in node.children) / max(float(points[i]), 1.0)
            likely = value[i] + GEOMETRY_WEIGHT * np.log(weakest[i] / (1 - weakest[i])) >= below
            whole[i] = i == certain or weakest[i] >= CERTAIN or (likely and weakest[i] >= RULED_OUT)
            value[i] = value[i] if whole[i] else below
    children = {c for node in nodes for c in node.children}
    chosen: list[int] = []
    stack = [i for i in range(len(nodes)) if i not in children]
    while stack:
        i = stack.pop()
        if whole[i]:
            chosen.append(i)
        else:
            stack.extend(nodes[i].children)
    return sorted(chosen)


def weakest_merges(nodes: Sequence[Node], points: NDArray[np.int64]) -> F64:
    """Affinity of the weakest merge inside each node, the node's own included.

    A merge with a child below MINOR_SHARE counts only for that node, not for its ancestors.
    """
    inside, own = np.ones(len(nodes)), np.ones(len(nodes))
    for i, node in enumerate(nodes):
        if node.children:
            minor = min(points[c] for c in node.children) < MINOR_SHARE * points[i]
            below = min(inside[c] for c in node.children)
            own[i] = min(below, node.affinity)
            inside[i] = below if minor else own[i]
    return np.clip(own, 1e-4, 1 - 1e-4)


Divided = Mapping[tuple[int, int], float]  # two touching superpoints, the lower number first, and a number in [0, 1]
NOT_DIVIDED: Divided = MappingProxyType({})


def parts_of(
    members: Sequence[int], touching: dict[int, set[int]], lab: F64, count: NDArray[np.int64],
    divided: Divided = NOT_DIVIDED,
) -> list[list[int]]:  # fmt: skip
    """The superpoints of one object as connected patches, each of one colour and in the same masks, largest first.

    Args:
        members: superpoint ids.
        touching: superpoints that each superpoint touches.
        lab: `[S, 3]` mean colour of every superpoint.
        count: `[S]` number of points of every superpoint.
        divided: how surely masks divide two touching superpoints; 0 where left out.
    """
    patches = _Patches(members, touching, lab, count, divided)
    patches.join_similar()
    patches.join_small(max(PATCH_POINTS, PATCH_SHARE * sum(int(count[s]) for s in members)))
    return sorted(patches.members.values(), key=lambda c: (-sum(int(count[s]) for s in c), c))


_WEIGHTS = np.array([LIGHTNESS, 1.0, 1.0])


class _Patches:
    """Patches under merging. A merged patch gets a new number, so that outdated pairs are recognised."""

    def __init__(
        self, members: Sequence[int], touching: dict[int, set[int]], lab: F64, count: NDArray[np.int64],
        divided: Divided,
    ) -> None:  # fmt: skip
        own = set(members)
        self.members = {s: [s] for s in members}
        self.lab = {s: lab[s] for s in members}
        self.size = {s: max(int(count[s]), 1) for s in members}
        self.near = {  # the touching patches, and how surely masks divide this one from each
            s: {t: divided.get((min(s, t), max(s, t)), 0.0) for t in touching.get(s, set()) & own} for s in members
        }
        self.next = max(members, default=0) + 1

    def join_similar(self) -> None:
        """Merge touching patches, the most similar first, while the gap between them is at most PATCH_COLOR."""
        heap = [(self.gap(s, t), s, t) for s in self.members for t in self.near[s] if s < t]
        heapq.heapify(heap)
        while heap and heap[0][0] <= PATCH_COLOR:
            _, s, t = heapq.heappop(heap)
            if s in self.members and t in self.members:
                new = self.join(s, t)
                for other in self.near[new]:
                    heapq.heappush(heap, (self.gap(new, other), other, new))

    def join_small(self, least: float) -> None:
        """Give each patch smaller than `least`, smallest first, to the touching patch it resembles most."""
        while small := [s for s in self.members if self.size[s] < least and self.near[s]]:
            smallest = min(small, key=lambda s: (self.size[s], s))
            self.join(min(self.near[smallest], key=lambda t: (self.gap(smallest, t), t)), smallest)

    def gap(self, s: int, t: int) -> float:
        """Difference of the colours of two touching patches, and of what masks say about them."""
        apart = (self.lab[s] - self.lab[t]) * _WEIGHTS
        color = math.sqrt(float(apart.dot(apart)))  # as np.linalg.norm computes it, in a third of the time
        return color + PATCH_DIVIDED * self.near[s][t]

    def join(self, s: int, t: int) -> int:
        new, self.next = self.next, self.next + 1
        a, b = self.size.pop(s), self.size.pop(t)
        self.lab[new] = (self.lab.pop(s) * a + self.lab.pop(t) * b) / (a + b)
        self.size[new] = a + b
        self.members[new] = self.members.pop(s) + self.members.pop(t)
        first, second = self.near.pop(s), self.near.pop(t)
        self.near[new] = {}
        for other in sorted((first.keys() | second.keys()) - {s, t}):
            said = [(w, near[other]) for w, near in ((a, first), (b, second)) if other in near]
            divided = sum(w * d for w, d in said) / sum(w for w, _ in said)
            self.near[new][other] = divided
            beside = self.near[other]
            beside.pop(s, None)
            beside.pop(t, None)
            beside[new] = divided
        return new
