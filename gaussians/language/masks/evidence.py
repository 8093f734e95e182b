"""Log-odds "one object" of regions from all sources of masks, and how they add up while regions grow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from .lifting import Lifted
from .reliability import REPEATS, Reliability, chooses_objects, describe
from .statements import Counts, Cover, cover

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

CHANCE = 0.03  # share of the views of a floor or wall in which a mask of an object covers it
PART_INDEX = 0.7  # Jaccard index of the masks of two regions below which they are different parts
PART_ALONE = 0.3  # share of those masks without any mask over the other region, above which it is chance
PART_CERTAINTY = 0.5  # of a source from which it divides parts
MOST_FOUND = 0.95  # largest share of the views of an object in which a source is taken to have a mask of it


@dataclass(frozen=True, eq=False)
class Witness:
    """One source of masks over some regions."""

    cover: Cover
    reliability: Reliability

    def between(self, first: I64, second: I64) -> F64:
        """Log-odds `[E]` that pairs of regions are one object."""
        return self.reliability.log_odds(self.cover.between(first, second))

    def within_structure(self, codes: NDArray[np.integer], size: F64) -> F64:
        """Log-odds `[R]` that regions which geometry takes for floor or wall belong to it; 0 for the others.

        A source that chooses objects covers them in a share of the views, which is estimated from what geometry takes
        for objects, and floors and walls hardly ever. One that divides whole pictures is asked whether a region is
        together with the rest of its floor or wall.

        Args:
            codes: `[R]` structure of each region, 0 for none.
            size: `[R]` number of points of each region.
        """
        trust = chooses_objects(self.cover)
        return trust * self._uncovered(codes, size) + (1 - trust) * self._with_rest(codes, size)

    def _uncovered(self, codes: NDArray[np.integer], size: F64) -> F64:
        views = self.cover.seen.sum(axis=1).astype(np.float64)
        share = self.cover.covered.sum(axis=1) / np.maximum(views, 1e-9)
        things = (codes == 0) & (views > 0)
        found = float(np.average(share[things], weights=size[things])) if things.any() else 0.0
        found = float(np.clip(found, 2 * CHANCE, MOST_FOUND))
        per_view = share * np.log(CHANCE / found) + (1 - share) * np.log((1 - CHANCE) / (1 - found))
        a = self.reliability.agreement
        return np.where(codes > 0, REPEATS * views * a / np.maximum(1 + (views - 1) * a, 1e-9) * per_view, 0.0)

    def _with_rest(self, codes: NDArray[np.integer], size: F64) -> F64:
        odds = np.zeros(len(codes))
        for code in sorted(set(codes[codes > 0].tolist())):
            own = np.flatnonzero(codes == code)
            weight = np.outer(size[own], size[own]).astype(np.float32)
            np.fill_diagonal(weight, 0)
            whole = self.cover.rows(own).of_all()
            summed = Counts(*((getattr(whole, f.name) * weight).sum(axis=1) for f in fields(whole)))
            odds[own] = self.reliability.log_odds(summed, np.maximum(weight.sum(axis=1, dtype=np.float64), 1e-9))
        return odds


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
        self.geometry, self.known = geometry, known
        self.slot = {i: i for i in range(len(superpoint))}
        self.size = size.astype(np.float64)
        self.leaves = np.ones(len(superpoint))
        scale = np.outer(size, size).astype(np.float32)
        self.tables: list[tuple[Reliability, Counts]] = []
        for one in known:
            whole = one.cover.of_all().at(np.ix_(superpoint, superpoint))
            self.tables.append((one.reliability, Counts(*(getattr(whole, f.name) * scale for f in fields(whole)))))

    def joined(self, region: int, others: Sequence[int], geometry: F64) -> F64:
        """Log-odds `[E]` that a region and each of some others are one object, from geometry and from all sources.

        The more certainly sources speak of a pair, the closer geometry's log-odds are bounded: its rule was fitted on
        other rooms and may be wrong here. Where no view says anything, it has the word alone.

        Args:
            geometry: `[E]` geometry's log-odds.
        """
        a, b = self.slot[region], np.array([self.slot[o] for o in others], np.int64)
        pairs = self.size[a] * self.size[b]
        total, silent = np.zeros(len(b)), np.ones(len(b))
        several = 2 - 1 / np.minimum(self.leaves[a], self.leaves[b])
        for reliability, counts in self.tables:
            odds, certainty = reliability.judge(counts.at((a, b)), pairs)
            total += odds
            silent *= 1 - certainty
        bound = self.geometry / np.maximum(1 - silent, 1e-3)
        return np.clip(geometry, -bound, bound) + several * total

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


def divided(known: Sequence[Witness], first: I64, second: I64) -> NDArray[np.bool_]:
    """Pairs of regions `[E]` that a source shows as different parts: masks cover both, and few of them both at once."""
    found = np.zeros(len(first), bool)
    for one in known:
        index, alone, certainty = describe(one.cover.between(first, second), 1.0, one.reliability.agreement)
        found |= (index < PART_INDEX) & (alone < PART_ALONE) & (certainty > PART_CERTAINTY)
    return found
