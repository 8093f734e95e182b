"""Log-odds "one object" of regions from all sources of masks, and how they add up while regions grow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from .lifting import Lifted
from .reliability import Reliability
from .statements import Counts, Cover, cover

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Witness:
    """One source of masks over some regions."""

    cover: Cover
    reliability: Reliability

    def between(self, first: I64, second: I64) -> F64:
        """Log-odds `[E]` that pairs of regions are one object."""
        return self.reliability.log_odds(self.cover.between(first, second))

    def within_structure(self, regions: I64, size: F64) -> F64:
        """Log-odds `[K]` that each region of a floor or wall is one thing with all the others together.

        Masks of objects leave floors and walls out. So here, and only here, two regions that a view leaves out are
        together.

        Args:
            size: `[K]` number of points of each region.
        """
        own = self.cover.rows(regions)
        weight = np.outer(size, size).astype(np.float32)
        np.fill_diagonal(weight, 0)
        said, out = own.of_all(), (own.seen - own.covered) @ (own.seen - own.covered).T
        whole = Counts(said.common + out, said.either + out, said.alone, own.seen @ own.seen.T)
        summed = Counts(*((getattr(whole, f.name) * weight).sum(axis=1) for f in fields(whole)))
        return self.reliability.log_odds(summed, weight.sum(axis=1, dtype=np.float64))


def witnesses(
    sources: Sequence[Lifted], labels: NDArray[np.int32], count: int, worth: Sequence[Reliability]
) -> list[Witness]:
    """The sources as witnesses about the regions of some points.

    Args:
        labels: `[P]` region of each point, in 0..count.
    """
    return [Witness(cover(s, labels, count), r) for s, r in zip(sources, worth, strict=True)]


class Ledger:
    """The log-odds of all pairs of regions under merging. Regions have the numbers of `segmentation.regions.Graph`."""

    def __init__(self, known: Sequence[Witness], superpoint: I64, size: F64, geometry: float) -> None:
        """Args:
        superpoint: `[R]` superpoint of each region.
        size: `[R]` number of points of each region: large ones have more say in what they merge into.
        geometry: bound of geometry's log-odds where masks say something.
        """
        self.geometry = geometry
        self.slot = {i: i for i in range(len(superpoint))}
        self.size = size.astype(np.float64)
        self.leaves = np.ones(len(superpoint))
        scale = np.outer(size, size).astype(np.float32)
        self.tables: list[tuple[Reliability, Counts]] = []
        for one in known:
            whole = one.cover.of_all().at(np.ix_(superpoint, superpoint))
            self.tables.append((one.reliability, Counts(*(getattr(whole, f.name) * scale for f in fields(whole)))))

    def log_odds(self, region: int, others: Sequence[int]) -> F64:
        """Log-odds that a region and each of some others are one object, bounded by what the sources are worth."""
        a, b = self.slot[region], np.array([self.slot[o] for o in others], np.int64)
        pairs = self.size[a] * self.size[b]
        total = np.zeros(len(b))
        several = 2 - 1 / np.minimum(self.leaves[a], self.leaves[b])
        for reliability, counts in self.tables:
            total += reliability.log_odds(counts.at((a, b)), pairs)
        return several * total

    def all_pairs(self) -> F64:
        """The same `[R, R]` for the first regions."""
        pairs = np.outer(self.size, self.size)
        return sum((r.log_odds(c, pairs) for r, c in self.tables), np.zeros_like(pairs))

    def merge(self, first: int, second: int, new: int) -> None:
        """Regions `first` and `second` have become region `new`."""
        a, b = self.slot.pop(first), self.slot.pop(second)
        self.slot[new] = a
        for _, counts in self.tables:
            for f in fields(counts):
                table = getattr(counts, f.name)
                table[a] += table[b]
                table[:, a] = table[a]
        self.size[a] += self.size[b]
        self.leaves[a] += self.leaves[b]
