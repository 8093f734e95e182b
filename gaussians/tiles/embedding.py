"""Embeds a scene in tiles block by block (`embed_tiles`): a part of it with what is around is embedded as any scene is,
and the groups of overlapping blocks are joined into one table.

What is found in a block is kept in the folder until all is done, so that an embedding that was stopped goes on where it
stopped.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import shutil
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import ValidationError

from ..camera import Vec3
from ..cloud import NO_GROUP, GaussianCloud
from ..errors import FileError
from ..language.encoders import Encoder
from ..language.field.embed import embed
from ..language.field.exposure import exposed, gain_of
from ..language.field.group_index import index_groups
from ..language.field.group_table import named
from ..language.field.language_field import LanguageField
from ..language.field.making import package_version, rules_digest
from ..language.field.measure import box_of, lab_of_cloud
from ..language.segmentation.orient import estimate_frame
from ..language.segmentation.surface import surface_of
from ..scene import Frame, Scene
from ..world.box import Box
from . import changing, files, tables
from .blocks import Parts, block_of, divided, margin_of, sampled
from .joining import Joined, Piece, join
from .locking import locked
from .records import Count, Record, Stored, Table
from .store import PIECES, Tiles, by_id, read_head

BYTES = 1200  # that embedding takes for a Gaussian of a block, on top of the program
_SAMPLE = 300_000  # rows by which up, floor and margins are estimated
_MEASURED = 100_000  # rows of a group that its box and colour are measured on
_STRUCTURE = ("floor", "wall", "ceiling")
Progress = Callable[[str, float], None]


class _Kept(Record):
    """A piece on the disk; see `joining.Piece`."""

    table: Table
    rows: Stored
    count: Count


@dataclass(frozen=True)
class _Work:
    """What all blocks are embedded with.

    Attributes:
        folder: where pieces are kept; it has the name of the work, so that pieces of another one are not taken for it.
        most: rows of a block.
    """

    folder: Path
    parts: Parts
    encoder: Encoder
    frame: Frame
    margin: float
    most: int


def fits_whole(tiles: Tiles, memory: int) -> bool:
    """Whether a scene may be embedded at once: it is one tile, and that fits into the memory."""
    return len(tiles.state.tiles) == 1 and len(tiles) * BYTES <= memory


def embed_tiles(
    tiles: Tiles,
    encoder: Encoder,
    memory: int,
    frame: Frame | None = None,
    margin: float | None = None,
    progress: Progress = lambda stage, share: None,
) -> Tiles:
    """The scene with groups and a table, which its folder has when this returns; no Gaussian changes otherwise.

    Args:
        memory: bytes that a block and the work on it may take.
        frame: as the user gives it; the scene's own without. Up and floor are estimated if it does not tell them.
        margin: how far around its part a block reaches, scene units; None: `blocks.margin_of`.

    Raises:
        UserError: a part does not fit into the memory.
        FileError: another program changes the folder, a tile is torn, or a file cannot be written; the scene is then as
            it was, and the next call goes on where this one stopped.
    """
    with locked(tiles.folder):
        if read_head(tiles.folder).present != tiles.head.present:
            raise FileError(f"{tiles.folder} was changed by another program meanwhile; embed it again")
        progress("up and floor", 0.0)
        sample = sampled(tiles, _SAMPLE)
        frame = _framed(tiles, by_id(sample), frame or tiles.frame)
        margin = margin_of(sample, frame.metres_per_unit) if margin is None else margin
        parts = divided(tiles, sample, margin)
        del sample
        folder = _folder(tiles, encoder, frame, margin)
        work = _Work(folder, parts, encoder, frame, margin, memory // BYTES)
        count = len(parts)
        pieces = []
        for number in range(count):

            def told(stage: str, share: float, number: int = number) -> None:
                progress(f"block {number + 1} of {count}: {stage}", (number + share) / (count + 1))

            pieces.append(_found(tiles, number, work, told))
        progress("joining groups", count / (count + 1))
        whole = _Whole(tiles, join(pieces, [tile.rows for tile in tiles.state.tiles]), frame)
        done = changing.regroup(tiles, whole.columns(), lambda: whole.table(encoder), frame, "embed")
        shutil.rmtree(folder.parent, ignore_errors=True)
    return done


def _framed(tiles: Tiles, cloud: GaussianCloud, frame: Frame) -> Frame:
    """The frame with up and floor, as embedding estimates them."""
    lit = exposed(cloud, gain_of(cloud))
    return estimate_frame(surface_of(lit), tiles.cameras, frame)


def _folder(tiles: Tiles, encoder: Encoder, frame: Frame, margin: float) -> Path:
    """The folder for pieces of this work; those of other work are removed."""
    said = [tiles.head.present.state.sha256, encoder.fingerprint, asdict(frame), margin]
    mark = hashlib.sha256(json.dumps([*said, package_version(), rules_digest()]).encode()).hexdigest()[:16]
    folder = tiles.folder / PIECES / mark
    for other in (tiles.folder / PIECES).glob("*"):
        if other.name != mark:
            shutil.rmtree(other, ignore_errors=True)
    folder.mkdir(parents=True, exist_ok=True)
    return folder


# -- pieces -----------------------------------------------------------------------------------------------------------


def _found(tiles: Tiles, number: int, work: _Work, progress: Progress) -> Piece:
    """What is found in a block: read if it was found before, else embedded and kept."""
    record = work.folder / f"{number}.json"
    with contextlib.suppress(OSError, FileError, ValidationError):  # of a work that was stopped while it was written
        return _read(work.folder, _Kept.model_validate_json(record.read_bytes()))
    block = block_of(tiles, work.parts, number, work.margin, work.most)
    scene = embed(Scene(block.cloud, work.frame), work.encoder, progress)
    assert scene.language is not None
    rows = np.stack([block.tile, block.row, scene.cloud.group.numpy(), block.inside.astype(np.int32)])
    kept = _Kept(
        table=tables.write_table(scene.language, work.folder, number),
        rows=files.write(work.folder, f"rows.{number}", rows.astype("<i4")), count=rows.shape[1],
    )  # fmt: skip
    files.write(work.folder, record.name, kept.model_dump_json().encode())
    return _read(work.folder, kept)


def _read(folder: Path, kept: _Kept) -> Piece:
    """A piece, its columns mapped."""
    tile, row, group, inside = files.mapped(folder, kept.rows, np.dtype("<i4"), (4, kept.count))
    return Piece(tables.read_table(kept.table, folder), tile, row, group, inside == 1)


# -- the whole --------------------------------------------------------------------------------------------------------


class _Whole:
    """Columns and table of the whole scene. The table is measured while the columns are made, tile by tile."""

    def __init__(self, tiles: Tiles, joined: Joined, frame: Frame) -> None:
        self._tiles, self._pieces, self._joined, self._frame = tiles, joined.pieces, joined, frame
        self._groups = [g for piece in joined.pieces for g in piece.field.groups]
        counts = np.zeros(len(self._groups), np.int64)
        for number in range(len(tiles.state.tiles)):
            column = joined.column(number)
            counts += np.bincount(column[column >= 0], minlength=len(counts))
        self._rows = self._numbered(counts)  # (number among all pieces, parent, Gaussians) of each group of the table
        self._id = np.full(len(self._groups) + 1, NO_GROUP, np.int32)  # the last is for rows without a group
        for new, (old, _, _) in enumerate(self._rows):
            self._id[old] = new
        for leaf in np.flatnonzero(counts).tolist():
            if self._id[leaf] == NO_GROUP:  # the only part of its object
                self._id[leaf] = self._id[joined.whole[leaf]]
        self._measured: dict[int, tuple[Box, Vec3]] = {}
        self._waiting: dict[int, list[GaussianCloud]] = {}
        self._left = [count for _, _, count in self._rows]
        self._loose = 0

    def _numbered(self, counts: NDArray[np.int64]) -> list[tuple[int, int, int]]:
        """The groups of the table in order: floor, walls, ceiling, then objects, largest first, and after each its
        parts."""
        whole = self._joined.whole
        leaves: dict[int, list[int]] = {}
        for leaf in np.flatnonzero(counts).tolist():
            leaves.setdefault(int(whole[leaf]), []).append(leaf)
        size = {thing: int(counts[own].sum()) for thing, own in leaves.items()}

        def place(thing: int) -> tuple[int, int, int]:
            group = self._groups[thing]
            built = group.level == "structure"
            return _STRUCTURE.index(group.label) if built else len(_STRUCTURE), 0 if built else -size[thing], thing

        rows: list[tuple[int, int, int]] = []
        for thing in sorted(leaves, key=place):
            parent, parts = len(rows), [leaf for leaf in leaves[thing] if leaf != thing]
            rows.append((thing, -1, size[thing]))
            if len(leaves[thing]) > 1:
                rows += [(part, parent, int(counts[part])) for part in parts]
        return rows

    def columns(self) -> Iterator[NDArray[np.int32]]:
        """The column of groups of each tile."""
        for number in range(len(self._tiles.state.tiles)):
            column = self._id[self._joined.column(number)]
            self._loose += int((column == NO_GROUP).sum())
            self._measure(self._tiles.cloud(number).replace(group=torch.from_numpy(column)))
            yield column

    def _measure(self, cloud: GaussianCloud) -> None:
        """Measure the groups of which a tile holds the last rows; keep the rows of the others, or an even sample."""
        members = index_groups(cloud)
        inner: dict[int, list[int]] = {}
        for group in np.unique(cloud.group.numpy()).tolist():
            if group != NO_GROUP:
                inner.setdefault(group, []).append(group)
                if (parent := self._rows[group][1]) >= 0:
                    inner.setdefault(parent, []).append(group)
        for group, leaves in inner.items():
            rows = members.rows(leaves)
            step = -(-self._rows[group][2] // _MEASURED)
            parts = [*self._waiting.pop(group, ()), cloud[torch.from_numpy(rows[::step])]]
            self._left[group] -= len(rows)
            if self._left[group]:
                self._waiting[group] = parts
            else:
                held = by_id(parts)
                self._measured[group] = box_of(held, self._frame), lab_of_cloud(held)

    def table(self, encoder: Encoder) -> LanguageField:
        """The table, once all columns were made."""
        groups, vectors = [], np.zeros((len(self._rows), encoder.dim), np.float32)
        every = np.concatenate([piece.field.embeddings for piece in self._pieces])
        for new, (old, parent, count) in enumerate(self._rows):
            best = int(self._joined.best[old])
            vectors[new] = every[best]
            box, lab = self._measured[new]
            made = replace(self._groups[best], id=new, parent=parent, box=box, lab=lab, count=count)
            groups.append(made)
        fields = [piece.field for piece in self._pieces if piece.field.making is not None]
        making = fields[0].making if fields else None
        field = LanguageField(tuple(groups), vectors, encoder.fingerprint, self._notes(), making)
        return named(field, encoder, self._frame, rests_known=True)

    def _notes(self) -> tuple[str, ...]:
        notes = [f"embedded in {len(self._pieces)} blocks, whose groups were joined where they overlap"]
        if self._frame.up_source == "estimated":
            notes.append("up was estimated from the scene; say --up if it is wrong")
        loose = self._loose / max(len(self._tiles), 1)
        if loose > 0.01:
            notes.append(f"{loose:.0%} of the Gaussians belong to no group (floaters and residue)")
        return tuple(notes)
