"""Writes the rows of a scene in tiles that are kept as a folder of tiles of its own."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...language.field.language_field import LanguageField
from .. import files, tables
from ..making import written, written_homes
from ..records import TILE_COLUMNS, Head, State, Step, Tile
from ..store import HEAD, STATES, TABLES, TILES, Tiles


def write_kept(tiles: Tiles, kept: Sequence[NDArray[np.bool_]], folder: Path) -> NDArray[np.int64]:
    """Write the kept rows of each tile into a folder for tiles, in place of what is there; returns their ids in the
    scene. Their new ids count from zero, in the same order; groups keep their numbers, boxes and vectors.

    Args:
        kept: `[rows]` of each tile.

    Raises:
        FileError: a tile is torn, or a file cannot be written.
    """
    for part in (TILES, TABLES, STATES):
        shutil.rmtree(folder / part)
        (folder / part).mkdir()
    there = np.zeros(tiles.state.first_free, bool)  # a byte an id
    for number, rows in enumerate(kept):
        there[np.asarray(tiles.column(number, "ids", checked=False))[rows]] = True
    ids = np.flatnonzero(there)
    new: list[Tile] = []
    for number, rows in enumerate(kept):
        if rows.any():
            columns = {name: np.asarray(tiles.column(number, name))[rows] for name in TILE_COLUMNS}
            columns["ids"] = np.searchsorted(ids, columns["ids"]).astype("<i8")
            new.append(written(folder, str(len(new)), columns, 0))
    state = State(
        degree=tiles.state.degree, first_free=len(ids), listed=len(ids), homes=written_homes(folder, new, len(ids)),
        gone=files.write(folder / TABLES, "gone.0", np.zeros(0, "<i8")), missing=0, tiles=tuple(new),
        comments=tiles.state.comments, notes=tiles.state.notes,
    )  # fmt: skip
    _write_head(folder, state)
    if tiles.field is not None:
        table = recounted(tiles.field, Tiles.open(folder).sizes(len(tiles.field.groups)))
        _write_head(folder, state.model_copy(update={"table": tables.write_table(table, folder / TABLES, 0)}))
    return ids


def recounted(field: LanguageField, sizes: NDArray[np.int64]) -> LanguageField:
    """The field with other numbers of Gaussians; all else stays.

    Args:
        sizes: `[groups]`, of each group without its parts.
    """
    groups = tuple(replace(g, count=int(sizes[list(field.leaves(g.id))].sum())) for g in field.groups)
    return LanguageField(groups, field.embeddings, field.encoder, field.notes, field.making)


def _write_head(folder: Path, state: State) -> None:
    stored = files.write(folder / STATES, "0.json", state.model_dump_json().encode())
    (folder / HEAD).write_text(Head(present=Step(state=stored)).model_dump_json(), encoding="utf-8")
