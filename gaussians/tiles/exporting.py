"""Writes a scene in tiles to an INRIA .ply without holding it: each tile's rows go to their places in the file."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ..files.atomic import writing
from ..files.formats import comments, inria_ply
from ..language.field.store import save_table
from . import files
from .store import TABLES, Tiles

_ROWS = 1 << 17  # rows of a tile that are packed at a time
Progress = Callable[[str, float], None]


def is_streamed(path: Path) -> bool:
    """Whether a file of this name is written without the scene in memory."""
    return path.suffix.lower() == ".ply" and ".compressed" not in [suffix.lower() for suffix in path.suffixes]


def write_field(tiles: Tiles, path: Path) -> Path | None:
    """Write the table and the groups of a scene beside the .ply that it was written to, so that its things have names
    there; returns where, None for a scene that has no names. Takes four bytes a Gaussian, some three times.

    Raises:
        FileError: a tile is torn, or the field cannot be written.
    """
    if tiles.field is None:
        return None
    gone = _gone(tiles)
    group = np.empty(len(tiles), np.int32)
    for number in range(len(tiles.state.tiles)):
        ids = np.asarray(tiles.column(number, "ids"))
        group[ids - np.searchsorted(gone, ids)] = tiles.column(number, "group")
    return save_table(tiles.field, torch.from_numpy(group), tiles.frame, path)


def write_ply(tiles: Tiles, path: Path, force: bool = False, progress: Progress = lambda stage, share: None) -> None:
    """Write the scene as `files.save` would write all of it: rows ascend by id.

    Raises:
        UserError: the file exists and `force` is not set.
        FileError: a tile is torn, or the file cannot be written; an existing file is then unchanged.
    """
    scene = tiles.scene(tiles.cloud(0, np.zeros(0, np.int64)))
    head = inria_ply.header(len(tiles), tiles.state.degree, comments.describe(scene))
    state, gone = tiles.state, _gone(tiles)
    with writing(path, force) as file:
        file.write(head)
        for number, tile in enumerate(state.tiles):
            progress(f"writing {path.name}", number / len(state.tiles))
            cloud = tiles.cloud(number)
            ids = cloud.ids.numpy()
            places = ids - np.searchsorted(gone, ids)
            for start in range(0, tile.rows, _ROWS):
                span = slice(start, start + _ROWS)
                packed = io.BytesIO()
                inria_ply.write_rows(cloud[span], packed)
                _placed(file, len(head), places[span], packed.getbuffer())


def _gone(tiles: Tiles) -> NDArray[np.int64]:
    """Ids that no row has, ascending."""
    state = tiles.state
    return np.asarray(files.mapped(tiles.folder / TABLES, state.gone, np.dtype("<i8"), (state.missing,)))


def _placed(file: Any, start: int, places: NDArray[np.int64], packed: memoryview) -> None:
    """Write rows to their places in a file whose rows begin at `start`; neighbours are written at once."""
    size = len(packed) // len(places)
    ends = np.append(np.flatnonzero(np.diff(places) != 1) + 1, len(places))
    first = 0
    for end in ends.tolist():
        file.seek(start + int(places[first]) * size)
        file.write(packed[first * size : end * size])
        first = end
