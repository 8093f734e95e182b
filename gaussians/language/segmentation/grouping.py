"""From superpoints to things: which nodes of the merge tree are whole objects, and which parts they have.

Knows the tree, its affinities and a score for "this looks like one whole thing". Refuses to know where that score
comes from.
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .regions import Node
from .superpoints import LIGHTNESS

F64 = NDArray[np.float64]

GEOMETRY = 1.0  # weight of a merge's log-odds against the encoder's
SETTLED, HOPELESS = 0.99, 0.01  # likelihoods of a merge from which, and below which, looks are not asked
CRUMB_SHARE = 0.03  # of a node: a side smaller than this says nothing about the rest
SAME_SHARE = 0.92  # a node that holds this much of another looks the same
PATCH_COLOR = 15.0  # Lab difference up to which touching patches of one object are one part
PATCH_POINTS = 30  # surface points; smaller patches join the touching one they resemble most
PATCH_SHARE = 0.01  # of the object, likewise


def alike(nodes: Sequence[Node], points: NDArray[np.int64]) -> NDArray[np.int64]:
    """For each node the largest node above it that is nearly the same thing, or itself: one portrait serves both."""
    same = np.arange(len(nodes))
    for i in range(len(nodes) - 1, -1, -1):
        for child in nodes[i].children:
            if points[child] >= SAME_SHARE * points[same[i]]:
                same[child] = same[i]
    return same


def in_question(nodes: Sequence[Node], points: NDArray[np.int64]) -> list[int]:
    """The nodes whose looks can change the cut: those that geometry neither settles nor rules out, and the whole ones
    that they are made of."""
    weakest = weakest_merges(nodes, points)
    wanted = np.zeros(len(nodes), bool)  # does anything above need this node's evidence?
    found = []
    for i in range(len(nodes) - 1, -1, -1):
        settled, hopeless = weakest[i] >= SETTLED, weakest[i] < HOPELESS
        if not hopeless and (wanted[i] or not settled):
            found.append(i)
        if not settled:
            wanted[list(nodes[i].children)] = wanted[i] or not hopeless
    return found[::-1]


def best_cut(
    nodes: Sequence[Node], points: NDArray[np.int64], evidence: dict[int, float], certain: int | None = None
) -> list[int]:
    """Disjoint nodes that cover every superpoint: the things the tree is made of.

    Bottom up, a node stays whole if its own evidence, plus what geometry says for the weakest merge inside it, is at
    least the mean evidence of the best cut below it, weighted by points. A mean, not a sum: two halves that each look
    like something must not outvote the one thing they make. The weakest merge, not the last: adding a crumb to a wrong
    merge does not make it right. Where geometry is certain, looks are not asked.

    Args:
        points: `[len(nodes)]` surface points of each node.
        evidence: log-odds of being one whole thing; 0 where none was asked for.
        certain: a node that is one thing whatever its parts look like.
    """
    value, whole = np.zeros(len(nodes)), np.ones(len(nodes), bool)
    weakest = weakest_merges(nodes, points)
    for i, node in enumerate(nodes):
        value[i] = evidence.get(i, 0.0)
        if node.children:
            below = sum(float(points[c]) * value[c] for c in node.children) / max(float(points[i]), 1.0)
            likely = value[i] + GEOMETRY * np.log(weakest[i] / (1 - weakest[i])) >= below
            whole[i] = i == certain or weakest[i] >= SETTLED or (likely and weakest[i] >= HOPELESS)
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
    """Affinity of the weakest merge inside each node, the node's own included; merges of crumbs count only for
    themselves, not for what is built on them."""
    inside, own = np.ones(len(nodes)), np.ones(len(nodes))
    for i, node in enumerate(nodes):
        if node.children:
            minor = min(points[c] for c in node.children) < CRUMB_SHARE * points[i]
            below = min(inside[c] for c in node.children)
            own[i] = min(below, node.affinity)
            inside[i] = below if minor else own[i]
    return np.clip(own, 1e-4, 1 - 1e-4)


def parts_of(
    members: Sequence[int], touching: dict[int, set[int]], lab: F64, count: NDArray[np.int64]
) -> list[list[int]]:
    """One object's superpoints as connected patches of one colour each, largest first.

    Args:
        members: superpoint ids.
        touching: superpoints that each superpoint touches.
        lab: `[S, 3]` mean colour of every superpoint.
        count: `[S]` points of every superpoint.
    """
    patches = _Patches(members, touching, lab, count)
    patches.join_alike()
    patches.join_crumbs(max(PATCH_POINTS, PATCH_SHARE * sum(int(count[s]) for s in members)))
    return sorted(patches.members.values(), key=lambda c: (-sum(int(count[s]) for s in c), c))


class _Patches:
    """Patches of one colour under merging; a merged patch gets a new number, so stale pairs are recognised."""

    def __init__(
        self, members: Sequence[int], touching: dict[int, set[int]], lab: F64, count: NDArray[np.int64]
    ) -> None:
        own = set(members)
        self.members = {s: [s] for s in members}
        self.lab = {s: lab[s] for s in members}
        self.size = {s: max(int(count[s]), 1) for s in members}
        self.near = {s: touching.get(s, set()) & own for s in members}
        self.next = max(members, default=0) + 1

    def join_alike(self) -> None:
        """Merge touching patches, the most alike first, while they are one colour."""
        heap = [(self.gap(s, t), s, t) for s in self.members for t in self.near[s] if s < t]
        heapq.heapify(heap)
        while heap and heap[0][0] <= PATCH_COLOR:
            _, s, t = heapq.heappop(heap)
            if s in self.members and t in self.members:
                new = self.join(s, t)
                for other in self.near[new]:
                    heapq.heappush(heap, (self.gap(new, other), other, new))

    def join_crumbs(self, least: float) -> None:
        """Give each patch smaller than `least`, smallest first, to the touching patch it resembles most."""
        while crumbs := [s for s in self.members if self.size[s] < least and self.near[s]]:
            crumb = min(crumbs, key=lambda s: (self.size[s], s))
            self.join(min(self.near[crumb], key=lambda t: (self.gap(crumb, t), t)), crumb)

    def gap(self, s: int, t: int) -> float:
        return float(np.linalg.norm((self.lab[s] - self.lab[t]) * np.array([LIGHTNESS, 1.0, 1.0])))

    def join(self, s: int, t: int) -> int:
        new, self.next = self.next, self.next + 1
        a, b = self.size.pop(s), self.size.pop(t)
        self.lab[new] = (self.lab.pop(s) * a + self.lab.pop(t) * b) / (a + b)
        self.size[new] = a + b
        self.members[new] = self.members.pop(s) + self.members.pop(t)
        self.near[new] = (self.near.pop(s) | self.near.pop(t)) - {s, t}
        for other in self.near[new]:
            self.near[other] = (self.near[other] - {s, t}) | {new}
        return new
