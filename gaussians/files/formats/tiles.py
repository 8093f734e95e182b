"""Reads a folder of tiles into memory, for all that works on a whole scene; see `gaussians.tiles`."""

from __future__ import annotations

import math
from pathlib import Path

from ...errors import FileError
from ...scene import Scene
from ...tiles.budget import VARIABLE, memory
from ...tiles.records import row_bytes
from ...tiles.store import SUFFIX, Tiles, is_tiles
from ..format import Format, Report

NAME = "tiles"
_COPIES = 3  # of the columns that reading takes for a moment


def recognises(path: Path, head: bytes) -> bool:
    """Whether the path is a folder of tiles."""
    return is_tiles(path)


def read(path: Path) -> tuple[Scene, Report]:
    """Read all tiles, with the language field that is stored with them; rows ascend by id, as in the files that were
    tiled.

    Raises:
        FileError: a tile is torn, or the scene does not fit into the memory that is allowed.
    """
    tiles = Tiles.open(path)
    size = len(tiles) * row_bytes(tiles.state.degree) * _COPIES
    if size > memory():
        raise FileError(
            f"{path} holds {len(tiles):,} Gaussians, which take about {size / 1e9:.1f} GB in memory, and this needs "
            f"all of them; allow more with {VARIABLE}={math.ceil(size / 1e9)}GB, or use select, edit and render"
        )
    scene = tiles.scene(tiles.every_row())
    return scene, Report(NAME, len(scene.cloud), len(scene.cloud), tiles.state.notes)


FORMAT = Format(NAME, (SUFFIX,), recognises, read, made_by="tile SCENE -o")
