"""Blocks: a tile with what lies around it as a cloud in memory, for work that has to see whole things."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ..cloud import NO_GROUP, GaussianCloud, concat
from ..errors import UserError
from .store import Tiles

METRES = 2.0  # margin where the scale is known: few things are larger that are no part of a building
SHARE = 0.35  # margin otherwise, of the typical side of a tile
SHRINK = 0.75  # of a margin whose rows do not fit into the memory
LEAST = 0.2  # of the margin, below which it holds no whole thing
_CELLS = 2  # to a margin
_MOST_CELLS = 1 << 20  # along an axis: three axes fit in 64 bits
_TRIM = 0.05  # share of the rows of a tile beyond its typical side: floaters


@dataclass(frozen=True, eq=False)
class Block:
    """A tile and what lies around it.

    Attributes:
        number: of the tile.
        cloud: all of its rows and those around, ascending by id, without groups.
        tile, row: `[N]` int32, where each row is stored.
        margin: how far around the tile it reaches at least, scene units.
    """

    number: int
    cloud: GaussianCloud
    tile: NDArray[np.int32]
    row: NDArray[np.int32]
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


def block_of(tiles: Tiles, number: int, margin: float, most: int) -> Block:
    """A tile with the rows within a margin of it; with a narrower one where these are too many.

    Args:
        margin: scene units.
        most: rows that it may hold.

    Raises:
        UserError: the tile alone, with hardly a margin, has more rows.
        FileError: a tile is torn.
    """
    wanted = margin
    while True:
        taken = _taken(tiles, number, margin)
        rows = sum(len(found) for found in taken.values())
        if rows <= most:
            break
        margin *= SHRINK
        if margin < LEAST * wanted:
            raise UserError(
                f"tile {number} of {tiles.folder} and what is around it are {rows:,} Gaussians, and only {most:,} at a "
                "time fit into the memory; allow more with --memory, or tile the scene again with less in a tile"
            )
    joined = concat([tiles.cloud(k, found) for k, found in taken.items()])
    tile = np.repeat(np.array(list(taken), np.int32), [len(found) for found in taken.values()])
    row = np.concatenate(list(taken.values())).astype(np.int32)
    order = np.argsort(joined.ids.numpy(), kind="stable")
    cloud = joined[torch.from_numpy(order)]
    bare = cloud.replace(group=torch.full_like(cloud.group, NO_GROUP))
    return Block(number, bare, tile[order], row[order], margin)


def _taken(tiles: Tiles, number: int, margin: float) -> dict[int, NDArray[np.int64]]:
    """The rows of each tile that a block holds."""
    means = np.asarray(tiles.column(number, "means"))
    low, high = means.min(axis=0) - margin, means.max(axis=0) + margin
    cell = margin / _CELLS
    near = np.unique((_offsets() + np.unique(_cells(means, low, cell), axis=0)[:, None]).reshape(-1, 3), axis=0)
    codes = np.sort(_codes(near))
    taken = {number: np.arange(len(means))}
    for k, tile in enumerate(tiles.state.tiles):
        if k == number or not tile.rows or (tile.low > high).any() or (tile.high < low).any():
            continue
        others = np.asarray(tiles.column(k, "means"))
        inside = np.flatnonzero(((others >= low) & (others <= high)).all(axis=1))
        code = _codes(_cells(others[inside], low, cell))
        place = np.minimum(np.searchsorted(codes, code), len(codes) - 1)
        if len(found := inside[codes[place] == code]):
            taken[k] = found
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
