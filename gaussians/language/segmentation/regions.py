"""The region adjacency graph: sums over regions and over borders, which merging two regions adds, and tree nodes.

All statistics are arrays with one row per region or border, so that `affinity.py` can judge many borders at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]


@dataclass(frozen=True)
class Node:
    """One node of the merge tree.

    Attributes:
        members: superpoints of the region.
        children: indices of the two nodes merged into it, () for a superpoint.
        affinity: probability that its two children are one object, 1 for a superpoint.
    """

    members: tuple[int, ...]
    children: tuple[int, ...]
    affinity: float


@dataclass(frozen=True)
class Regions:
    """Sums over the points of `R` regions, in the level frame; merging adds them.

    Attributes:
        count: `[R]` points.
        lab, lab_squared: `[R, 3]` sums of colours and of their squares.
        spread: `[R, 6]` sum of `p pᵀ` over points, upper triangle, about the scene's middle.
        place: `[R, 3]` sum of points about the scene's middle.
        turn: `[R, 6]` sum of `n nᵀ`, upper triangle.
        leaving: `[R]` links to all other regions, structure included.
        floor, wall: `[R]` links to floor and to wall.
        low, high: `[R, 3]` bounds; merging takes the outer ones.
    """

    count: F64
    lab: F64
    lab_squared: F64
    place: F64
    spread: F64
    turn: F64
    leaving: F64
    floor: F64
    wall: F64
    low: F64
    high: F64


@dataclass(frozen=True)
class Borders:
    """Sums over the pairs of points across `B` borders.

    Attributes:
        pairs: `[B]` number of pairs.
        touching: `[B]` number of pairs that are links; the others are ties across a gap.
        weight: `[B]` summed link weight.
        contrast: `[B]` summed colour difference of the two points, Lab.
        height: `[B]` summed height.
        level: `[B, 2]` summed |n_z| of the points in the first region and in the second.
        low, high: `[B, 2]` plan bounds of the points.
        gap: `[B]` shortest distance across, 0 where the regions touch.
    """

    pairs: F64
    touching: F64
    weight: F64
    contrast: F64
    height: F64
    level: F64
    low: F64
    high: F64
    gap: F64


class Graph:
    """Regions and borders under merging. A merged region gets a new number, so that outdated pairs are recognised."""

    def __init__(
        self, superpoint: I64, regions: Regions, ends: I64, borders: Borders, scale: float, haze: float = 0.0
    ) -> None:
        """Args:
        superpoint: `[R]` superpoint of each region.
        ends: `[B, 2]` regions of each border, the smaller number first.
        scale: typical size of a region, scene units.
        haze: of the scene, see `haze.py`.
        """
        count = len(superpoint)
        self.regions = Regions(*(_padded(a, max(2 * count - 1, 0)) for a in vars(regions).values()))
        self.borders = Borders(*(a.copy() for a in vars(borders).values()))
        self.scale, self.haze = scale, haze
        self.members: dict[int, tuple[int, ...]] = {i: (int(s),) for i, s in enumerate(superpoint)}
        self.around: dict[int, dict[int, int]] = {i: {} for i in self.members}
        self.next = count
        for row, (i, j) in enumerate(ends.tolist()):
            self.around[i][j] = self.around[j][i] = row

    def pairs(self) -> list[tuple[int, int]]:
        """All pairs of regions with a border, the smaller number first."""
        return [(i, j) for i, near in self.around.items() for j in near if i < j]

    def merge(self, i: int, j: int) -> int:
        """Merge regions i and j, which need not have a border; returns the number of the merged region."""
        new, self.next = self.next, self.next + 1
        r, between = self.regions, self.around[i].get(j)
        inner = 0.0 if between is None else self.borders.touching[between]
        for name, column in vars(r).items():
            if name not in ("low", "high"):
                column[new] = column[i] + column[j]
        r.leaving[new] -= 2 * inner
        r.low[new], r.high[new] = np.minimum(r.low[i], r.low[j]), np.maximum(r.high[i], r.high[j])
        self.members[new] = self.members.pop(i) + self.members.pop(j)
        near: dict[int, int] = {}
        for old in (i, j):
            for other, row in self.around.pop(old).items():
                if other in (i, j):
                    continue
                del self.around[other][old]
                if old < other:  # the merged region's number is the larger one: its side comes second
                    self.borders.level[row] = self.borders.level[row, ::-1].copy()
                near[other] = self._merge_rows(near[other], row) if other in near else row
        self.around[new] = near
        for other, row in near.items():
            self.around[other][new] = row
        return new

    def _merge_rows(self, row: int, other: int) -> int:
        """Add the border in row `other` to that in `row`, which both lead to the same region; returns `row`."""
        b = self.borders
        for name, column in vars(b).items():
            if name not in ("low", "high", "gap"):
                column[row] += column[other]
        b.low[row], b.high[row] = np.minimum(b.low[row], b.low[other]), np.maximum(b.high[row], b.high[other])
        b.gap[row] = min(b.gap[row], b.gap[other])
        return row


def _padded(rows: F64, count: int) -> F64:
    """A copy with zero rows appended, `count` rows in all."""
    grown = np.zeros((count, *rows.shape[1:]))
    grown[: len(rows)] = rows
    return grown
