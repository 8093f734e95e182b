"""Reads a folder of tiles (`Tiles`): its present state, its tiles column by column, and the table of its groups.

HEAD.json           which state is the present one; replaced in one step (see `records.Head`)
states/0.json       a state: tiles, their files and bounds, table, frame
tiles/0.means.0     columns of a tile, plain little-endian arrays; the last number is that of the edit
tables/groups.0.json, tables/embeddings.0
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Self, TypeVar

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import BaseModel, ValidationError

from ..camera import Camera, Vec3
from ..cloud import GaussianCloud, concat
from ..errors import FileError
from ..files.formats import comments
from ..language.field.language_field import LanguageField
from ..scene import Frame, Scene
from . import files, tables
from .files import Array
from .records import TILE_COLUMNS, Head, State, Stored, Tile, column_type

HEAD = "HEAD.json"
STATES, TILES, TABLES = "states", "tiles", "tables"
PIECES = "pieces"  # what an embedding that is not done has found so far
SUFFIX = ".tiles"
_MOST_INDEX = 1 << 30  # bytes

R = TypeVar("R", bound=BaseModel)


def is_tiles(path: Path) -> bool:
    """Whether a path is a folder of tiles."""
    return (path / HEAD).is_file()


@dataclass(frozen=True, eq=False)
class Tiles:
    """A scene in tiles, in one state. Nothing of the tiles is read before it is asked for.

    Attributes:
        folder: where it lies.
        head: the present state and those that undo and redo reach.
        state: the present state.
    """

    folder: Path
    head: Head
    state: State

    @classmethod
    def open(cls, path: Path) -> Self:
        """The present state of a folder.

        Raises:
            FileError: it is no folder of tiles, or its index is damaged.
        """
        head = read_head(path)
        stored = files.content(path / STATES, head.present.state, _MOST_INDEX)
        return cls(path, head, _parsed(State, stored, path / STATES / head.present.state.file))

    def __len__(self) -> int:
        """Gaussians of the scene."""
        return self.state.rows

    @cached_property
    def field(self) -> LanguageField | None:
        """The table of groups of the whole scene, None before embedding; its Gaussians are told by `owners`.

        Raises:
            FileError: it is missing or damaged.
        """
        table = self.state.table
        return None if table is None else tables.read_table(table, self.folder / TABLES)

    @cached_property
    def _said(self) -> tuple[Frame, tuple[Camera, ...]]:
        frame, cameras, _ = comments.parse(self.state.comments)
        return frame, cameras

    @property
    def frame(self) -> Frame:
        return self._said[0]

    @property
    def cameras(self) -> tuple[Camera, ...]:
        return self._said[1]

    @cached_property
    def bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Corners `[3]` of the box of all centres, scene units."""
        there = [tile for tile in self.state.tiles if tile.rows]
        return np.min([t.low for t in there], axis=0), np.max([t.high for t in there], axis=0)

    def scene(self, cloud: GaussianCloud) -> Scene:
        """Some Gaussians of this scene, with its frame, cameras and table."""
        return Scene(cloud, self.frame, self.cameras, self.field, self.folder)

    # -- tiles ------------------------------------------------------------------------------------------------------

    def column(self, number: int, name: str, checked: bool = True) -> Array:
        """A column of a tile, mapped; see `files.mapped`.

        Raises:
            FileError: the tile is torn: a file is missing or damaged.
        """
        tile = self.state.tiles[number]
        kind, shape = column_type(name, self.state.degree)
        if name not in tile.columns:
            raise FileError(f"{self.folder}: the index has no {name} of tile {number}: {files.ADVICE}")
        return files.mapped(self.folder / TILES, tile.columns[name], kind, (tile.rows, *shape), checked)

    def cloud(self, number: int, rows: NDArray[np.int64] | None = None) -> GaussianCloud:
        """All Gaussians of a tile, or some of its rows, in memory.

        Raises:
            FileError: as `column`; or its ids do not ascend.
        """
        found = {}
        for name in TILE_COLUMNS:
            column = self.column(number, name)
            taken = np.array(column if rows is None else column[rows])
            found[name] = torch.from_numpy(taken.astype(taken.dtype.newbyteorder("="), copy=False))
        ids = found["ids"]
        if len(ids) > 1 and not bool((ids[1:] > ids[:-1]).all()):
            raise FileError(f"{self.folder}: the ids of tile {number} do not ascend: {files.ADVICE}")
        return GaussianCloud(**found, first_free=self.state.first_free, rest=None)

    def every_row(self) -> GaussianCloud:
        """All Gaussians, ascending by id, in memory."""
        return by_id([self.cloud(k) for k in range(len(self.state.tiles))])

    # -- groups -----------------------------------------------------------------------------------------------------

    def owners(self, number: int) -> NDArray[np.int64]:
        """`[M, 2]`: the groups that own rows of a tile, and how many.

        Raises:
            FileError: the file is missing or damaged.
        """
        stored = self.state.tiles[number].owners
        path = self.folder / TILES / stored.file
        count = path.stat().st_size // 8 if path.is_file() else 0
        return np.array(files.mapped(self.folder / TILES, stored, np.dtype("<i4"), (count, 2)), np.int64)

    @cached_property
    def _all_owners(self) -> NDArray[np.int64]:
        """`[M, 3]`: tile, group, rows."""
        found = [self.owners(k) for k in range(len(self.state.tiles))]
        numbers = np.repeat(np.arange(len(found)), [len(own) for own in found])
        return np.concatenate([numbers[:, None], np.concatenate(found)], axis=1)

    def holding(self, groups: Iterable[int]) -> tuple[int, ...]:
        """Numbers of the tiles in which rows of some groups lie."""
        every = self._all_owners
        return tuple(int(k) for k in np.unique(every[np.isin(every[:, 1], list(groups)), 0]))

    def count(self, groups: Iterable[int]) -> int:
        """Gaussians of some groups."""
        every = self._all_owners
        return int(every[np.isin(every[:, 1], list(groups)), 2].sum())

    def sizes(self, groups: int) -> NDArray[np.int64]:
        """Gaussians of each of so many groups, without those of its parts."""
        every = self._all_owners
        own = every[every[:, 1] >= 0]
        return np.bincount(own[:, 1], own[:, 2], groups).astype(np.int64)

    # -- the whole --------------------------------------------------------------------------------------------------

    def listed(self, checked: bool = True) -> Iterator[tuple[Path, str]]:
        """Each file of the state with its SHA-256, read anew from its bytes."""
        for folder, stored in stored_files(self.state):
            if checked:
                files.check(self.folder / folder, stored)
            yield Path(folder) / stored.file, stored.sha256

    def digest(self) -> str:
        """SHA-256 over the hashes of all tiles, whose bytes are compared with them; equal for equal tiles.

        Raises:
            FileError: a file is damaged.
        """
        total = hashlib.sha256()
        for path, sha256 in sorted(self.listed()):
            total.update(f"{path.parent}{sha256};".encode())
        return total.hexdigest()


def by_id(clouds: Sequence[GaussianCloud]) -> GaussianCloud:
    """The rows of some clouds, ascending by id."""
    joined = concat(list(clouds))
    ids = joined.ids
    if len(ids) < 2 or bool((ids[1:] > ids[:-1]).all()):
        return joined
    return joined[torch.from_numpy(np.argsort(ids.numpy(), kind="stable"))]


def read_head(folder: Path) -> Head:
    """The head of a folder.

    Raises:
        FileError: there is none, or it is damaged.
    """
    path = folder / HEAD
    try:
        if path.stat().st_size > _MOST_INDEX:
            raise FileError(f"{path} is larger than an index can be")
        return _parsed(Head, path.read_bytes(), path)
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}; is {folder} a folder of tiles?") from error


def _parsed(kind: type[R], stored: bytes, path: Path) -> R:
    try:
        return kind.model_validate_json(stored)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"][-4:]) or "the text"
        raise FileError(f"{path} is no index of tiles ({where}: {first['msg']}): {files.ADVICE}") from error


def stored_files(state: State) -> Iterator[tuple[str, Stored]]:
    """The files that a state names, with their folders."""
    for tile in state.tiles:
        yield from ((TILES, stored) for stored in (*tile.columns.values(), tile.owners))
    yield from ((TABLES, stored) for stored in (state.homes, state.gone))
    if state.table is not None:
        yield from ((TABLES, stored) for stored in (state.table.groups, state.table.embeddings))


def described(cloud: dict[str, Array]) -> tuple[Vec3, Vec3, float]:
    """Bounds of the centres and the largest standard deviation of some rows; zeros if there are none."""
    if not len(cloud["means"]):
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0
    low, high = cloud["means"].min(axis=0), cloud["means"].max(axis=0)
    return corner(low), corner(high), float(cloud["scales"].max())


def corner(point: NDArray[np.floating]) -> Vec3:
    """A point `[3]` as numbers."""
    x, y, z = (float(c) for c in point)
    return (x, y, z)


def write_owners(folder: Path, name: str, group: NDArray[np.int32]) -> Stored:
    """Write which groups own the rows of a tile."""
    owners, counts = np.unique(group, return_counts=True)
    return files.write(folder / TILES, name, np.stack([owners, counts], axis=1).astype("<i4"))


__all__ = ["HEAD", "STATES", "SUFFIX", "TABLES", "TILES", "Tile", "Tiles", "by_id", "is_tiles", "read_head"]
