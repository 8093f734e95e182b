"""Blocks: parts of a scene in tiles with what lies around them as clouds in memory, for work that has to see whole
things.

Parts are independent of tiles: a tree over a sample divides space where it is emptiest, between rooms that stand apart
for instance, into parts that are some times as wide as the margin around them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray

from ..cloud import NO_GROUP, GaussianCloud, concat
from ..errors import UserError
from ..levels.tree import Node, Tree
from .store import Tiles

METRES = 1.0  # margin where the scale is known; more reaches through walls into other rooms, and hides the walls
SHARE = 0.35  # margin otherwise, of the typical side of a tile
ROWS = 100_000  # of a part, unless it is narrow: about a room
NARROW = 3.0  # margins: a part is not divided across a side that is shorter
SHRINK = 0.75  # of a margin whose rows do not fit into the memory
LEAST = 0.2  # of the margin, below which it holds no whole thing
_MIDDLE = (0.3, 0.7)  # quantiles between which a part is divided
_BINS = 16  # to a margin, in which rows are counted to find the emptiest place
_GAP = 4  # bins that are counted together: of the width of a gap between rooms
_CELLS = 2  # to a margin
_MOST_CELLS = 1 << 20  # along an axis: three axes fit in 64 bits
_TRIM = 0.05  # share of the rows beyond a side: floaters


@dataclass(frozen=True, eq=False)
class Parts:
    """A scene divided in space.

    Attributes:
        tree: its leaves are the parts.
        held: `[tiles, parts]` rows of each tile in each part.
    """

    tree: Tree
    held: NDArray[np.int64]

    def __len__(self) -> int:
        return self.tree.leaves


@dataclass(frozen=True, eq=False)
class Block:
    """A part and what lies around it.

    Attributes:
        cloud: all of its rows and those around, ascending by id; without groups, unless it is a part alone.
        tile, row: `[N]` int32, where each row is stored.
        inside: `[N]` bool, whether it is of the part.
        margin: how far around the part it reaches at least, scene units.
    """

    cloud: GaussianCloud
    tile: NDArray[np.int32]
    row: NDArray[np.int32]
    inside: NDArray[np.bool_]
    margin: float


def sampled(tiles: Tiles, most: int) -> list[GaussianCloud]:
    """At most so many rows of a scene, evenly spaced within each tile.

    Raises:
        FileError: a tile is torn.
    """
    step = max(1, -(-len(tiles) // most))
    return [tiles.cloud(k, np.arange(0, tile.rows, step)) for k, tile in enumerate(tiles.state.tiles)]


def margin_of(clouds: list[GaussianCloud], metres_per_unit: float | None) -> float:
    """How far around a tile a block should reach, scene units: further than most things.

    Args:
        clouds: a sample of each tile.
    """
    if metres_per_unit is not None:
        return METRES / metres_per_unit
    spreads = [
        np.ptp(np.quantile(cloud.means.numpy().astype(np.float64), [_TRIM, 1 - _TRIM], axis=0), axis=0)
        for cloud in clouds
        if len(cloud)
    ]
    return SHARE * float(np.median([np.sort(spread)[1] for spread in spreads]))


def divided(
    tiles: Tiles, clouds: list[GaussianCloud], margin: float, rows: int | None = None, narrow: float | None = None
) -> Parts:
    """The parts of a scene.

    Args:
        clouds: a sample of each tile.
        rows: about so many a part holds at most, unless it is narrow; `ROWS` without.
        narrow: margins; a part is not divided across a side that is shorter; `NARROW` without.

    Raises:
        FileError: a tile is torn.
    """
    means = np.concatenate([cloud.means.numpy() for cloud in clouds])
    most = max(1, (ROWS if rows is None else rows) * len(means) // max(len(tiles), 1))
    least = (NARROW if narrow is None else narrow) * margin
    leaves = 0

    def node(own: NDArray[np.int64]) -> Node:
        nonlocal leaves
        if len(own) > most:
            low, high = np.quantile(means[own], [_TRIM, 1 - _TRIM], axis=0)
            axis = int(np.argmax(high - low))
            if high[axis] - low[axis] > least:
                position = _emptiest(means[own, axis], margin)
                below = means[own, axis] < position
                if below.any() and not below.all():
                    return Node(axis, position, (node(own[below]), node(own[~below])))
        leaves += 1
        return Node(leaf=leaves - 1)

    tree = Tree(node(np.arange(len(means))), leaves)
    numbers = range(len(tiles.state.tiles))
    found = (np.bincount(tree.leaf_of(np.asarray(tiles.column(k, "means"))), minlength=tree.leaves) for k in numbers)
    return Parts(tree, np.stack(list(found)))


def _emptiest(along: NDArray[np.float32], margin: float) -> float:
    """The place near the middle of some coordinates around which fewest lie; of several the one nearest the middle."""
    low, middle, high = np.quantile(along.astype(np.float64), [_MIDDLE[0], 0.5, _MIDDLE[1]])
    bins = int(np.clip((high - low) / margin * _BINS, 2, 1 << 12))
    count, edges = np.histogram(along, bins, (low, high))
    near = np.convolve(count, np.ones(min(_GAP, bins)), mode="same")
    places = (edges[:-1] + edges[1:]) / 2
    best = np.flatnonzero(near == near.min())
    return float(places[best[np.argmin(np.abs(places[best] - middle))]])


def block_of(tiles: Tiles, parts: Parts, number: int, margin: float, most: int) -> Block:
    """A part with the rows within a margin of it; with a narrower one where these are too many.

    Args:
        margin: scene units.
        most: rows that it may hold.

    Raises:
        UserError: the part alone, with hardly a margin, has more rows.
        FileError: a tile is torn.
    """
    wanted = margin
    while True:
        taken = _taken(tiles, parts, number, margin)
        rows = sum(len(found) for found, _ in taken.values())
        if rows <= most:
            break
        margin *= SHRINK
        if margin < LEAST * wanted:
            raise UserError(
                f"a part of {tiles.folder} and what is around it are {rows:,} Gaussians, and only {most:,} at a time "
                "fit into the memory; allow more with --memory"
            )
    inside = np.concatenate([own for _, own in taken.values()])
    found = _gathered(tiles, {k: own for k, (own, _) in taken.items()}, inside, margin)
    return replace(found, cloud=found.cloud.replace(group=torch.full_like(found.cloud.group, NO_GROUP)))


def part_of(tiles: Tiles, parts: Parts, number: int) -> Block:
    """A part alone, with its groups.

    Raises:
        FileError: a tile is torn.
    """
    taken = {}
    for k in np.flatnonzero(parts.held[:, number]).tolist():
        taken[k] = np.flatnonzero(parts.tree.leaf_of(np.asarray(tiles.column(k, "means"))) == number)
    return _gathered(tiles, taken, np.ones(sum(map(len, taken.values())), bool), 0.0)


def _gathered(tiles: Tiles, taken: dict[int, NDArray[np.int64]], inside: NDArray[np.bool_], margin: float) -> Block:
    """Some rows of some tiles, ascending by id."""
    joined = concat([tiles.cloud(k, rows) for k, rows in taken.items()])
    tile = np.repeat(np.array(list(taken), np.int32), [len(rows) for rows in taken.values()])
    row = np.concatenate(list(taken.values())).astype(np.int32)
    order = np.argsort(joined.ids.numpy(), kind="stable")
    return Block(joined[torch.from_numpy(order)], tile[order], row[order], inside[order], margin)


def _taken(
    tiles: Tiles, parts: Parts, number: int, margin: float
) -> dict[int, tuple[NDArray[np.int64], NDArray[np.bool_]]]:
    """The rows of each tile that a block holds, and which of them are of the part."""
    own = {}
    for k in np.flatnonzero(parts.held[:, number]).tolist():
        column = np.asarray(tiles.column(k, "means"))
        own[k] = parts.tree.leaf_of(column) == number
    means = np.concatenate([np.asarray(tiles.column(k, "means", checked=False))[rows] for k, rows in own.items()])
    low, high = means.min(axis=0) - margin, means.max(axis=0) + margin
    cell = margin / _CELLS
    near = (_offsets() + np.unique(_cells(means, low, cell), axis=0)[:, None]).reshape(-1, 3)
    codes = np.unique(_codes(near))
    taken = {}
    for k, tile in enumerate(tiles.state.tiles):
        if not tile.rows or (k not in own and ((tile.low > high).any() or (tile.high < low).any())):
            continue
        others = np.asarray(tiles.column(k, "means"))
        held = np.flatnonzero(((others >= low) & (others <= high)).all(axis=1))
        code = _codes(_cells(others[held], low, cell))
        place = np.minimum(np.searchsorted(codes, code), len(codes) - 1)
        if len(found := held[codes[place] == code]):
            taken[k] = found, own[k][found] if k in own else np.zeros(len(found), bool)
    return taken


def _cells(means: NDArray[np.float32], low: NDArray[np.float32], cell: float) -> NDArray[np.int64]:
    """The cell `[N, 3]` of each centre; those of the box that starts at `low` are counted from `_CELLS`."""
    found: NDArray[np.int64] = np.clip((means - low) / cell, 0, _MOST_CELLS).astype(np.int64) + _CELLS
    return found


def _codes(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    codes: NDArray[np.int64] = (cells[:, 0] << 42) | (cells[:, 1] << 21) | cells[:, 2]
    return codes


def _offsets() -> NDArray[np.int64]:
    """`[K, 3]` steps from a cell to those within a margin of it."""
    along = np.arange(-_CELLS, _CELLS + 1)
    return np.stack(np.meshgrid(along, along, along, indexing="ij"), axis=-1).reshape(-1, 3)
