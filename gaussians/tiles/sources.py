"""Scene files as streams of rows (`Source`), for tiling: an INRIA .ply is never held whole, other formats are."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import torch

from ..cloud import GaussianCloud
from ..errors import FileError
from ..files import load_with_report
from ..files.format import HEAD_BYTES
from ..files.formats import inria_ply, values
from ..files.motion_file import motion_path
from ..language.field.language_field import LanguageField
from ..language.field.store import column_fits, load_field, sliced_field
from ..scene import Scene

BLOCK_ROWS = 1 << 17  # about 20 MB in a .ply of degree 0, 60 of degree 3
_SAMPLE_ROWS = 1 << 12  # of a block of a sample: files often follow space, so that many small blocks tell more


@dataclass(eq=False)
class Source:
    """A scene file that is read block by block.

    Attributes:
        path: the file.
        scene: frame and cameras of the file and table of its saved field, without Gaussians.
        rows: rows of the file, those that will be dropped included.
        degree: of its harmonics.
        blocks: a generator of its sound rows, with row numbers as ids and with their groups; given a number, of only
            each so many-th block, without groups.
        notes: what was repaired, known when all blocks were read.
    """

    path: Path
    scene: Scene
    rows: int
    degree: int
    blocks: Callable[[int], Iterator[GaussianCloud]]
    notes: list[str] = field(default_factory=list)

    @property
    def table(self) -> LanguageField | None:
        return self.scene.language


def open_source(path: Path) -> Source:
    """A file as a source.

    Raises:
        FileError: it cannot be read, or its saved field is damaged.
    """
    head = b""
    if path.is_file():
        with open(path, "rb") as file:
            head = file.read(HEAD_BYTES)
    return _streamed(path) if inria_ply.recognises(path, head) else _whole(path)


def _streamed(path: Path) -> Source:
    scene, rows, degree = inria_ply.outline(path)
    saved = sliced_field(path, rows)
    if saved is not None:
        frame = scene.frame if scene.frame.up_source == "given" else saved.frame
        scene = scene.replace(language=saved.table, frame=frame)

    def blocks(every: int) -> Iterator[GaussianCloud]:
        loaded = turned = 0
        for cloud, fixed in inria_ply.blocks(path, BLOCK_ROWS if every == 1 else _SAMPLE_ROWS, every):
            if saved is not None and every == 1:
                column = saved.column(loaded, loaded + len(cloud))
                if len(column) != len(cloud) or not column_fits(column, saved.table):
                    raise FileError(f"the language field of {path} does not fit it; embed the scene again")
                cloud = cloud.replace(group=torch.from_numpy(column.astype("int32")))
            loaded, turned = loaded + len(cloud), turned + fixed
            yield cloud
        if every == 1:
            if saved is not None and saved.rows != loaded:
                raise FileError(f"the language field of {path} does not fit it; embed the scene again")
            source.notes += [f"{path.name}: {note}" for note in values.repairs(rows, loaded, turned)]

    source = Source(path, scene, rows, degree, blocks)
    if motion_path(path).is_file():
        source.notes.append(f"{path.name}: its motion was left out: tiles stand still")
    return source


def _whole(path: Path) -> Source:
    loaded, report = load_with_report(path)
    loaded = load_field(loaded, path) or loaded

    def blocks(every: int) -> Iterator[GaussianCloud]:
        size = BLOCK_ROWS if every == 1 else _SAMPLE_ROWS
        for start in range(0, len(loaded.cloud), size * every):
            block = loaded.cloud[start : start + size]  # tiles that were edited have ids with gaps
            yield block.replace(ids=torch.arange(start, start + len(block)), first_free=0)

    empty = loaded.replace(cloud=GaussianCloud.empty(loaded.cloud.degree))
    notes = [f"{path.name}: {note}" for note in report.notes]
    return Source(path, empty, report.rows, loaded.cloud.degree, blocks, notes)


def common_table(sources: Sequence[Source]) -> tuple[list[int], str]:
    """How many groups stand before those of each source in a table for all of them, and why there is none: empty, and
    a sentence that says so; "" if no source has a field."""
    tables = [source.table for source in sources]
    if all(table is None for table in tables):
        return [], ""
    missing = [source.path.name for source in sources if source.table is None]
    if missing:
        return [], f"the things have no names here, as {missing[0]} has no language field: embed each file, then tile"
    encoders = sorted({table.encoder for table in tables if table is not None})
    if len(encoders) > 1:
        return [], f"the things have no names here, as their fields are of other encoders: {', '.join(encoders)}"
    starts, total = [], 0
    for table in tables:
        starts.append(total)
        total += len(table.groups) if table is not None else 0
    return starts, ""
