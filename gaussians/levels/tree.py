"""A binary tree that divides space into leaves of about equally many Gaussians (k-d tree, Bentley 1975)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LEAF_ROWS = 16_384  # most Gaussians of a leaf: rooms of a hundred thousand have some ten leaves at different distances
_OUTER = 0.02  # share of the Gaussians at either end that do not count for the width of a part: floaters


@dataclass(frozen=True)
class Node:
    """A part of space. An inner node has an axis (0 to 2), a position on it, and two children: what lies below the
    position, and the rest. A leaf has a number instead, counted in the order of the tree."""

    axis: int = -1
    position: float = 0.0
    children: tuple[Node, ...] = ()
    leaf: int = -1


@dataclass(frozen=True)
class Tree:
    """The root, and the number of leaves below it."""

    root: Node
    leaves: int

    def leaf_of(self, means: NDArray[np.float32]) -> NDArray[np.int64]:
        """Number `[M]` of the leaf that each position `[M, 3]` lies in."""
        found = np.empty(len(means), np.int64)
        waiting = [(self.root, np.arange(len(means)))]
        while waiting:
            node, rows = waiting.pop()
            if not node.children:
                found[rows] = node.leaf
                continue
            below = means[rows, node.axis] < node.position
            waiting += [(node.children[0], rows[below]), (node.children[1], rows[~below])]
        return found


def build(means: NDArray[np.float32], leaf_rows: int = LEAF_ROWS) -> Tree:
    """The tree of Gaussians at `means` `[N, 3]`: each part is halved across its widest axis until it holds at most
    `leaf_rows`, or all that it holds lies in one place."""
    leaves = 0

    def node(rows: NDArray[np.int64]) -> Node:
        nonlocal leaves
        if len(rows) > leaf_rows:
            axis, position = _cut(means[rows])
            below = means[rows, axis] < position
            if below.any():
                return Node(axis, position, (node(rows[below]), node(rows[~below])))
        leaves += 1
        return Node(leaf=leaves - 1)

    root = node(np.arange(len(means)))
    return Tree(root, leaves)


def _cut(means: NDArray[np.float32]) -> tuple[int, float]:
    """The axis on which positions `[M, 3]` spread most, and their median on it, which lies above the smallest."""
    low, high = np.quantile(means, [_OUTER, 1 - _OUTER], axis=0)
    axis = int(np.argmax(high - low))
    along = means[:, axis]
    middle = np.partition(along, len(along) // 2)[len(along) // 2]
    if middle == along.min() and (above := along[along > middle]).size:  # at least half lie at the smallest
        middle = above.min()
    return axis, float(middle)
