"""Joins the groups that overlapping blocks found into groups of the whole scene (`join`).

Rows in the margin of a block are inside another one too, and both gave them a group. Two things are one if they share
most of the rows that both blocks saw of them. Each row then takes the group that the block gave it in which it is
inside and not in the margin: there most is seen around it. Where two blocks disagree about a thing at their border, a
remnant is left of it on the side where less of it lies; its rows go to the things that the other block sees there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ..cloud import NO_GROUP
from ..language.field.language_field import LanguageField

SAME = 0.6  # intersection over union, in the rows that both blocks saw, from which two things are one
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
        tile, row, group: `[M]` where each row is stored, and its group in that table.
        inside: `[M]` whether it is in the part of the block and not around it; each row of a scene is so in one block.
    """

    field: LanguageField
    tile: Ints
    row: Ints
    group: Ints
    inside: NDArray[np.bool_]

    @cached_property
    def tiles(self) -> frozenset[int]:
        """The tiles that its rows are stored in."""
        return frozenset(np.unique(self.tile).tolist())


@dataclass(frozen=True, eq=False)
class Joined:
    """Groups of the whole scene, numbered as the groups of all pieces one after the other are: a group of the whole has
    the least number of those that it was joined from.

    Attributes:
        pieces: that were joined.
        rows: of each tile.
        first: `[P]` number of the first group of each piece.
        whole: `[G]` the thing that each group belongs to: itself, the object that it is a part of, or what that was
            joined to.
        leaf: `[G]` the group that the rows of each group get.
        best: `[G]` the group that tells most of a group of the whole: of a thing what it was in the block that saw most
            of it.
        remnant: `[G]` whether a thing of the whole is a remnant.
    """

    pieces: Sequence[Piece]
    rows: Sequence[int]
    first: Longs
    whole: Longs
    leaf: Longs
    best: Longs
    remnant: NDArray[np.bool_]

    def column(self, number: int) -> Longs:
        """The group of the whole `[R]` of each row of a tile; `NO_GROUP` for none."""
        _, home = _homes(self.pieces, self.first, number, self.rows[number])
        column = _mapped(self.leaf, home)
        left = np.zeros(len(column), bool)
        there = column >= 0
        left[there] = self.remnant[self.whole[column[there]]]
        around = [k for k, piece in enumerate(self.pieces) if number in piece.tiles] if left.any() else []
        seen = {k: np.flatnonzero((self.pieces[k].tile == number) & ~self.pieces[k].inside) for k in around}
        for k in sorted(around, key=lambda k: (-len(seen[k]), k)):
            row = self.pieces[k].row[seen[k]]
            other = _mapped(self.leaf, _numbered(self.pieces[k].group[seen[k]], int(self.first[k])))
            good = left[row] & (other >= 0)
            good[good] = ~self.remnant[self.whole[other[good]]]
            column[row[good]], left[row[good]] = other[good], False
        return column


@dataclass(frozen=True, eq=False)
class _Overlap:
    """Rows that two blocks saw: `n` `[K]` of them are of group `a` by the block `home` in which they are inside, and of
    group `b` by another block, `guest`; `NO_GROUP` is none."""

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


def join(pieces: Sequence[Piece], rows: Sequence[int]) -> Joined:
    """The groups of the whole scene.

    Args:
        rows: of each tile.
    """
    counts = [len(piece.field.groups) for piece in pieces]
    first = np.cumsum([0, *counts])[:-1].astype(np.int64)
    groups = [group for piece in pieces for group in piece.field.groups]
    block = np.repeat(np.arange(len(pieces)), counts)
    parent = np.array([g.parent for g in groups], np.int64).reshape(-1)
    own = np.where(parent >= 0, parent + first[block], np.arange(len(groups)))  # the thing of each group in its block
    kept, seen = _held(pieces, first, own)
    found = _overlap(pieces, first, rows)

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
    return Joined(pieces, rows, first, whole, leaf, best, (kind == "") & (left < REMNANT * largest))


def _mapped(table: Longs, group: Longs) -> Longs:
    """`table` of some groups; none stays none."""
    return np.where(group >= 0, table[group], NO_GROUP) if len(table) else group


def _numbered(group: Ints, first: int) -> Longs:
    """Groups of a piece by their numbers among those of all pieces; none stays none."""
    found = np.asarray(group).astype(np.int64)
    return np.where(found >= 0, found + first, NO_GROUP)


def _homes(pieces: Sequence[Piece], first: Longs, number: int, rows: int) -> tuple[Longs, Longs]:
    """`[R]` each: the block in which each row of a tile is inside, and the group that it has there."""
    block, group = np.full(rows, -1, np.int64), np.full(rows, NO_GROUP, np.int64)
    for k, piece in enumerate(pieces):
        if number in piece.tiles:
            own = np.flatnonzero((piece.tile == number) & piece.inside)
            block[piece.row[own]] = k
            group[piece.row[own]] = _numbered(piece.group[own], int(first[k]))
    return block, group


def _held(pieces: Sequence[Piece], first: Longs, own: Longs) -> tuple[Longs, Longs]:
    """`[G]` each: rows of each thing of each block that are inside of the block, and all of its rows."""
    kept, seen = np.zeros(len(own), np.int64), np.zeros(len(own), np.int64)
    for start, piece in zip(first.tolist(), pieces, strict=True):
        count = len(piece.field.groups)
        there = piece.group >= 0
        for total, rows in ((kept, there & piece.inside), (seen, there)):
            np.add.at(total, own[start : start + count], np.bincount(piece.group[rows], minlength=count))
    return kept, seen


def _overlap(pieces: Sequence[Piece], first: Longs, rows: Sequence[int]) -> _Overlap:
    found: list[NDArray[np.int64]] = [np.zeros((0, 5), np.int64)]
    width = sum(len(piece.field.groups) for piece in pieces) + 1
    for number, count in enumerate(rows):
        block, group = _homes(pieces, first, number, count)
        for guest, piece in enumerate(pieces):
            if number not in piece.tiles:
                continue
            mine = np.flatnonzero((piece.tile == number) & ~piece.inside)
            row = piece.row[mine]
            pairs = (group[row] + 1) * width + _numbered(piece.group[mine], int(first[guest])) + 1
            code, n = np.unique(pairs * len(pieces) + block[row], return_counts=True)
            pairs, home = np.divmod(code, len(pieces))
            a, b = np.divmod(pairs, width)
            found.append(np.stack([a - 1, b - 1, home, np.full(len(n), guest), n], axis=1))
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
