"""Joins the groups that overlapping blocks found into groups of the whole scene (`join`).

Rows in the margin of a block lie in the tile of another block too, and both gave them a group. Two things are one if
they share most of the rows that both blocks saw of them. Each row then takes the group that the block of its own tile
gave it: there it lies deepest inside. Where two blocks disagree about a thing at their border, a remnant is left of it
on the side where less of it lies; its rows go to the things that the other block sees there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ..cloud import NO_GROUP
from ..language.field.language_field import LanguageField

SAME = 0.5  # intersection over union, in the rows that both blocks saw, from which two things are one
SAME_STRUCTURE = 0.5  # intersection over the smaller one, from which two floors, walls or ceilings are one
LEAST = 0.05  # of the smaller thing: the rows that they share at least; a tip at a border tells nothing
REMNANT = 0.5  # of the rows that a block gave to a thing: one that keeps fewer is a remnant

Ints = NDArray[np.int32]
Longs = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Piece:
    """What embedding found in a block.

    Attributes:
        field: its table.
        core: `[R]` the group of each row of its tile, ascending by id.
        tile, row, group: `[M]` where each row around the tile is stored, and the group that it got here.
    """

    field: LanguageField
    core: Ints
    tile: Ints
    row: Ints
    group: Ints


@dataclass(frozen=True, eq=False)
class Joined:
    """Groups of the whole scene, numbered as the groups of all pieces one after the other are: a group of the whole has
    the least number of those that it was joined from.

    Attributes:
        first: `[P]` number of the first group of each piece.
        whole: `[G]` the thing that each group belongs to: itself, the object that it is a part of, or what that was
            joined to.
        leaf: `[G]` the group that the rows of each group get.
        best: `[G]` the group that tells most of a group of the whole: of a thing what it was in the block that saw most
            of it.
        remnant: `[G]` whether a thing of the whole is a remnant.
    """

    first: Longs
    whole: Longs
    leaf: Longs
    best: Longs
    remnant: NDArray[np.bool_]

    def column(self, pieces: Sequence[Piece], number: int) -> Longs:
        """The group of the whole `[R]` of each row of a tile; `NO_GROUP` for none."""
        column = _mapped(self.leaf, self.first[number], pieces[number].core)
        left = np.zeros(len(column), bool)
        there = column >= 0
        left[there] = self.remnant[self.whole[column[there]]]
        for k in self._neighbours(pieces, number) if left.any() else ():
            mine = np.flatnonzero(pieces[k].tile == number)
            row, other = pieces[k].row[mine], _mapped(self.leaf, self.first[k], pieces[k].group[mine])
            good = left[row] & (other >= 0)
            good[good] = ~self.remnant[self.whole[other[good]]]
            column[row[good]], left[row[good]] = other[good], False
        return column

    def _neighbours(self, pieces: Sequence[Piece], number: int) -> list[int]:
        """The pieces that hold rows of a tile, most first."""
        counts = {k: int((piece.tile == number).sum()) for k, piece in enumerate(pieces) if k != number}
        return sorted((k for k, count in counts.items() if count), key=lambda k: (-counts[k], k))


@dataclass(frozen=True, eq=False)
class _Overlap:
    """Rows that two blocks saw: `n` `[K]` of them are of group `a` by the block of their own tile, which is block
    `home`, and of group `b` by another block, `guest`; `NO_GROUP` is none."""

    a: Longs
    b: Longs
    home: Longs
    guest: Longs
    n: Longs


@dataclass(frozen=True, eq=False)
class _Scores:
    """How many rows pairs of groups of two blocks share (`shared`), and how many rows that both blocks saw each has."""

    low: Longs
    high: Longs
    shared: Longs
    of_low: Longs
    of_high: Longs

    @property
    def smaller(self) -> NDArray[np.float64]:
        """Intersection over the smaller one."""
        return np.asarray(self.shared / np.minimum(self.of_low, self.of_high))

    @property
    def union(self) -> NDArray[np.float64]:
        """Intersection over union."""
        return np.asarray(self.shared / (self.of_low + self.of_high - self.shared))


def join(pieces: Sequence[Piece]) -> Joined:
    """The groups of the whole scene; `pieces[k]` is that of tile k."""
    counts = [len(piece.field.groups) for piece in pieces]
    first = np.cumsum([0, *counts])[:-1].astype(np.int64)
    groups = [group for piece in pieces for group in piece.field.groups]
    block = np.repeat(np.arange(len(pieces)), counts)
    parent = np.array([g.parent for g in groups], np.int64).reshape(-1)
    own = np.where(parent >= 0, parent + first[block], np.arange(len(groups)))  # the thing of each group in its block
    kept, seen = _held(pieces, first, own)
    found = _overlap(pieces, first)

    pairs = _scores(found, own, block)
    kind = np.array([g.label if g.level == "structure" else "" for g in groups], object).reshape(-1)
    alike = kind[pairs.low] == kind[pairs.high]
    thing = kind[pairs.low] == ""
    enough = pairs.shared >= LEAST * np.minimum(seen[pairs.low], seen[pairs.high])
    same = np.where(thing, (pairs.union >= SAME) & enough, pairs.smaller >= SAME_STRUCTURE)
    whole = _united(pairs, alike & same, len(groups))[own]

    pairs = _scores(found, np.arange(len(groups)), block)
    inner = (parent[pairs.low] >= 0) & (parent[pairs.high] >= 0) & (whole[pairs.low] == whole[pairs.high])
    leaf = np.where(parent >= 0, _united(pairs, inner & (pairs.union >= SAME), len(groups)), whole)
    largest, left = np.zeros(len(groups), np.int64), np.zeros(len(groups), np.int64)
    np.maximum.at(largest, whole, seen)
    np.add.at(left, whole, kept)
    best = np.arange(len(groups))
    order = np.lexsort((-best, seen))  # the last that is written counts: seen most, and of equals the first
    best[whole[order]] = np.where(parent[order] >= 0, best[whole[order]], order)
    return Joined(first, whole, leaf, best, (kind == "") & (left < REMNANT * largest))


def _mapped(table: Longs, first: int, group: Ints) -> Longs:
    """`table` of the groups of a piece, of which the first has the number `first`; none stays none."""
    found = np.full(len(group), NO_GROUP, np.int64)
    there = group >= 0
    found[there] = table[first + group[there]]
    return found


def _held(pieces: Sequence[Piece], first: Longs, own: Longs) -> tuple[Longs, Longs]:
    """`[G]` each: rows of each thing of each block that lie in the tile of the block, and all of its rows."""
    kept, seen = np.zeros(len(own), np.int64), np.zeros(len(own), np.int64)
    for start, piece in zip(first.tolist(), pieces, strict=True):
        count = len(piece.field.groups)
        inside, around = (np.bincount(column[column >= 0], minlength=count) for column in (piece.core, piece.group))
        np.add.at(kept, own[start : start + count], inside)
        np.add.at(seen, own[start : start + count], inside + around)
    return kept, seen


def _overlap(pieces: Sequence[Piece], first: Longs) -> _Overlap:
    found: list[NDArray[np.int64]] = [np.zeros((0, 5), np.int64)]
    for guest, piece in enumerate(pieces):
        tile, group = np.asarray(piece.tile), np.asarray(piece.group)
        for home in np.unique(tile).tolist():
            mine = tile == home
            a, b = np.asarray(pieces[home].core)[piece.row[mine]].astype(np.int64), group[mine].astype(np.int64)
            width = len(piece.field.groups) + 1
            code, n = np.unique((a + 1) * width + b + 1, return_counts=True)
            a, b = code // width - 1, code % width - 1
            a, b = np.where(a >= 0, a + first[home], -1), np.where(b >= 0, b + first[guest], -1)
            found.append(np.stack([a, b, np.full(len(n), home), np.full(len(n), guest), n], axis=1))
    return _Overlap(*np.concatenate(found).T)


def _scores(found: _Overlap, of: Longs, block: Longs) -> _Scores:
    """The pairs of groups of two blocks that share rows, after each group became `of` it."""
    blocks, count = int(block.max(initial=0)) + 1, len(of)
    a, b = (np.where(one >= 0, of[one], -1) if count else one for one in (found.a, found.b))
    keys = np.concatenate([(a * blocks + found.guest)[a >= 0], (b * blocks + found.home)[b >= 0]])
    key, size = _summed(keys, np.concatenate([found.n[a >= 0], found.n[b >= 0]]))
    both = (a >= 0) & (b >= 0)
    pair, shared = _summed(np.minimum(a, b)[both] * count + np.maximum(a, b)[both], found.n[both])
    low, high = pair // max(count, 1), pair % max(count, 1)
    sizes = [size[np.searchsorted(key, one * blocks + block[other])] for one, other in ((low, high), (high, low))]
    return _Scores(low, high, shared, *sizes)


def _summed(keys: Longs, n: Longs) -> tuple[Longs, Longs]:
    """Each key once, ascending, and the sum of its numbers."""
    key, place = np.unique(keys, return_inverse=True)
    return key, np.bincount(place, n, len(key)).astype(np.int64)


def _united(pairs: _Scores, same: NDArray[np.bool_], count: int) -> Longs:
    """`[count]` the least number of those that each group is one with."""
    links = coo_array((np.ones(int(same.sum()), bool), (pairs.low[same], pairs.high[same])), (count, count))
    label = connected_components(links, directed=False)[1] if count else np.zeros(0, np.int64)
    least = np.full(count, count, np.int64)
    np.minimum.at(least, label, np.arange(count))
    return least[label]
