"""The index of a folder of tiles as data: what `HEAD.json` and the files under `states/` hold.

A state is the whole scene after one edit. It names column files, which never change once they are written, with their
SHA-256; states share the files of tiles that an edit did not touch. `HEAD.json` names the present state, those before
it and those that were undone. All of it is untrusted when it is read.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

VERSION = 1
MOST_ROWS = 1_000_000  # of a tile
TILE_COLUMNS = ("means", "quats", "scales", "opacities", "sh", "group", "ids")

Name = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9.-]*$", max_length=100)]  # of a file in its own folder
Sha256 = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
Count = Annotated[int, Field(ge=0, le=1 << 40)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Triple = tuple[Finite, Finite, Finite]


class Record(BaseModel):
    """The base of all records; later versions may add fields."""

    model_config = ConfigDict(frozen=True, extra="ignore")


class Stored(Record):
    """A file and the SHA-256 of its bytes."""

    file: Name
    sha256: Sha256


class Tile(Record):
    """Rows of a part of space, ascending by id.

    Attributes:
        rows: how many; at most `MOST_ROWS`.
        low, high: corners of a box that holds their centres, scene units.
        largest: their largest standard deviation, scene units.
        columns: the file of each of `TILE_COLUMNS`.
        owners: `[M, 2]` int32, each group that owns rows here and how many; group -1 is none.
    """

    rows: Annotated[int, Field(ge=0, le=MOST_ROWS)]
    low: Triple
    high: Triple
    largest: Annotated[float, Field(ge=0, allow_inf_nan=False)]
    columns: dict[str, Stored]
    owners: Stored


class Table(Record):
    """The language field without its column of groups.

    Attributes:
        groups: JSON of the groups, in a file of its own, as an edit changes them.
        embeddings: `[count, width]` float32.
    """

    groups: Stored
    embeddings: Stored
    count: Count
    width: Count
    encoder: str
    notes: tuple[str, ...] = ()
    making: dict[str, Any] | None = None


class State(Record):
    """A scene.

    Attributes:
        degree: of the harmonics.
        first_free: the least id that no Gaussian has had.
        listed: number of ids of which `homes` names the tile; those above were added by edits.
        homes: `[listed]` uint32, the tile of each id; which tile that is never changes.
        gone: `[M]` int64, ascending: ids below `first_free` that no row has.
        comments: frame and cameras, as the comment lines of a .ply.
        notes: what was repaired while the sources were read.
    """

    version: Literal[1] = 1
    degree: Annotated[int, Field(ge=0, le=3)]
    first_free: Count
    listed: Count
    homes: Stored
    gone: Stored
    missing: Count
    tiles: Annotated[tuple[Tile, ...], Field(max_length=1 << 20)]
    table: Table | None = None
    comments: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def rows(self) -> int:
        """Gaussians of the scene."""
        return sum(tile.rows for tile in self.tiles)


class Step(Record):
    """A state and the instruction that led to it, "" for the first."""

    state: Stored
    text: str = ""


class Head(Record):
    """The present state, those that led to it (oldest first), and those that were undone (the next redo last)."""

    version: Literal[1] = 1
    past: tuple[Step, ...] = ()
    present: Step
    future: tuple[Step, ...] = ()
    written: Count = 1  # states so far: names of new files are made from it

    @property
    def steps(self) -> tuple[Step, ...]:
        """All states that can be reached."""
        return (*self.past, self.present, *self.future)


def column_type(name: str, degree: int) -> tuple[np.dtype[Any], tuple[int, ...]]:
    """The little-endian type of a column and the shape of one row."""
    shapes: dict[str, tuple[str, tuple[int, ...]]] = {
        "means": ("<f4", (3,)),
        "quats": ("<f4", (4,)),
        "scales": ("<f4", (3,)),
        "opacities": ("<f4", ()),
        "sh": ("<f4", ((degree + 1) ** 2, 3)),
        "group": ("<i4", ()),
        "ids": ("<i8", ()),
    }
    kind, shape = shapes[name]
    return np.dtype(kind), shape


def row_bytes(degree: int) -> int:
    """Bytes of a row in all its columns."""
    found = (column_type(name, degree) for name in TILE_COLUMNS)
    return sum(kind.itemsize * int(np.prod(shape, dtype=np.int64)) for kind, shape in found)
