"""Reads Streamed SOG version 1 (PlayCanvas): a folder of `lod-meta.json` and SOG chunks, with several levels of detail.

The specification is developer.playcanvas.com/user-manual/gaussian-splatting/formats/streamed-sog: a binary tree divides
space; each leaf has a run of rows at each level, in chunks that are SOG folders of their own (`sog`). Level 0 is the
finest, and what `read` gives; `Streamed` gives any level of any leaf. Writing is in `streamed_sog_writing`.
The index is untrusted: chunks outside its folder, and counts that fit neither leaves, chunks nor bytes are refused.

What the format has no field for stands in fields that other programs skip: of a run, `moved`; of the index,

    "extras": {"scenewright": {"comments": [...], "psnr": [[mean, least], ...]}}

with frame and cameras as the comments of a .ply (`comments`), and what each level keeps, in dB. Both may be missing.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
import torch
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from ...camera import Camera
from ...cloud import GaussianCloud, concat
from ...errors import FileError
from ...scene import Frame, Scene
from ..format import Format, Report
from . import comments, sog

NAME = "Streamed SOG"
SUFFIX = ".lod"  # of the folder, by our own convention: the format names only the index
INDEX = "lod-meta.json"

_INDEX_LIMIT = 1 << 26  # bytes; a leaf of ten thousand Gaussians takes some 400
_MOST_LEVELS = 32
_MOST_COMMENTS = 100_000

ChunkName = Annotated[str, Field(pattern=r"^([^/\\:\x00]+/)*[^/\\:\x00]+$", max_length=1024)]
Count = Annotated[int, Field(ge=0, le=1 << 40)]
Length = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="ignore")


class Run(_Part):
    """Rows `offset` to `offset + count` of chunk number `file`.

    Attributes:
        moved: how far the Gaussians of level 0 are from those that stand for them here (see `levels.levels.Levels`),
            scene units; None in files of other programs.
    """

    file: Count
    offset: Count
    count: Count
    moved: Length | None = None


class _Bound(_Part):
    min: sog.Triple
    max: sog.Triple

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if any(low > high for low, high in zip(self.min, self.max, strict=True)):
            raise ValueError("a box ends before it begins")
        return self


class _Node(_Part):
    bound: _Bound
    children: tuple[_Node, _Node] | None = None
    lods: dict[Annotated[str, Field(pattern=r"^(0|[1-9]\d?)$")], Run] | None = None


class _Index(_Part):
    version: Literal[1] | None = None  # absent before the format had versions
    counts: tuple[Count, ...] | None = None
    levels: Annotated[int, Field(alias="lodLevels", ge=1, le=_MOST_LEVELS)]
    filenames: Annotated[tuple[ChunkName, ...], Field(min_length=1, max_length=1 << 20)]
    environment: ChunkName | None = None
    extras: Any = None
    tree: _Node


class _Extras(_Part):
    """What this program writes into `extras`."""

    comments: Annotated[tuple[str, ...], Field(max_length=_MOST_COMMENTS)] = ()
    psnr: Annotated[tuple[tuple[Finite, Finite], ...], Field(max_length=_MOST_LEVELS)] = ()


@dataclass(frozen=True)
class Leaf:
    """A part of space.

    Attributes:
        low, high: corners of the box that its Gaussians lie in, world frame, scene units.
        runs: its rows by level; a level at which it is empty is missing.
    """

    low: sog.Triple
    high: sog.Triple
    runs: Mapping[int, Run]


@dataclass(frozen=True)
class Chunk:
    """A SOG folder.

    Attributes:
        path: of its own index.
        rows: its Gaussians, as the leaves say; None in the environment, which no leaf names.
        level: of all its rows; -1 in the environment, and in a chunk that no leaf names.
    """

    path: Path
    rows: int | None
    level: int = -1

    @property
    def size(self) -> int:
        """Bytes on disk."""
        return sum(part.stat().st_size for part in self.path.parent.iterdir() if part.is_file())


@dataclass(eq=False)
class Streamed:
    """A scene in levels of detail. A chunk is read when its rows are first asked for, and kept.

    Attributes:
        folder: where the index lies.
        levels: number of levels; 0 is the finest.
        chunks: by the numbers that runs name.
        leaves: in the order of the tree.
        environment: rows that belong to no level (sky); none or one chunk.
        frame, cameras: of the scene that was written; the format itself has neither.
        psnr: of each level in dB, mean and least of the views it was measured from when it was written; empty if the
            file does not say it.
        notes: what was repaired in the index and in the chunks read so far.
    """

    folder: Path
    levels: int
    chunks: tuple[Chunk, ...]
    leaves: tuple[Leaf, ...]
    environment: tuple[Chunk, ...] = ()
    frame: Frame = field(default_factory=Frame)
    cameras: tuple[Camera, ...] = ()
    psnr: tuple[tuple[float, float], ...] = ()
    notes: list[str] = field(default_factory=list)
    _clouds: dict[Path, tuple[GaussianCloud, int]] = field(default_factory=dict, repr=False)
    _room: float = sog.FREE_GAUSSIANS  # Gaussians that chunks may claim besides what their bytes allow

    @classmethod
    def open(cls, path: Path) -> Self:
        """The scene in a folder, or of its index. Reads no chunk.

        Raises:
            FileError: the index is missing, damaged or of another version, or contradicts itself.
        """
        folder = scene_folder(path)
        index = _read_index(folder)
        leaves = tuple(_leaves(index.tree))
        environment = () if index.environment is None else (Chunk(_inside(folder, index.environment), None),)
        extras, notes = _extras(index)
        frame, cameras, unusable = comments.parse(extras.comments)
        found = cls(
            folder, index.levels, _chunks(folder, index, leaves), leaves, environment, frame, cameras, extras.psnr,
            [*notes, *unusable],
        )  # fmt: skip
        if index.counts is not None and index.counts != found.counts:
            raise FileError(f"{folder}: {INDEX} says {index.counts} Gaussians a level, its leaves {found.counts}")
        if not any(found.counts):
            raise FileError(f"{folder}: {INDEX} holds zero Gaussians")
        return found

    @property
    def counts(self) -> tuple[int, ...]:
        """Gaussians of each level, without the environment."""
        return tuple(sum(chunk.rows or 0 for chunk in self.of_level(k)) for k in range(self.levels))

    def of_level(self, level: int) -> tuple[Chunk, ...]:
        """The chunks of a level, by their numbers."""
        return tuple(chunk for chunk in self.chunks if chunk.level == level)

    def level(self, level: int) -> tuple[GaussianCloud, int]:
        """All Gaussians of one level, chunk by chunk, and the environment, with row numbers of these files as ids; and
        the number of rows with the damaged ones, which are left out.

        Raises:
            FileError: a chunk is missing or damaged, or has other rows than the leaves say.
        """
        parts, base = [], 0
        for chunk in (*self.of_level(level), *self.environment):
            cloud, rows = self._read(chunk)
            parts.append(cloud.replace(ids=cloud.ids + base))
            base += rows
        return concat(parts), base

    def scene(self) -> tuple[Scene, int]:
        """The finest level that holds anything, as a scene, and its number of rows as `level` counts them.

        Raises:
            FileError: as `level`.
        """
        cloud, rows = self.level(next(k for k, count in enumerate(self.counts) if count))
        return Scene(cloud, self.frame, self.cameras, path=self.folder), rows

    def chosen(self, levels: Sequence[int]) -> GaussianCloud:
        """The Gaussians of each leaf at its level of `levels`, leaf by leaf, and the environment. Ids are row numbers
        of this cloud. Only chunks with such rows are read.

        Raises:
            FileError: as `level`.
        """
        runs = [leaf.runs[k] for leaf, k in zip(self.leaves, levels, strict=True) if k in leaf.runs]
        parts = [_rows(self._read(self.chunks[run.file])[0], run) for run in runs]
        parts += [self._read(chunk)[0] for chunk in self.environment]
        ends = np.cumsum([len(part) for part in parts])
        return concat([p.replace(ids=torch.arange(end - len(p), end)) for p, end in zip(parts, ends, strict=True)])

    def _read(self, chunk: Chunk) -> tuple[GaussianCloud, int]:
        """The sound Gaussians of a chunk, with row numbers as ids, and the number of its rows."""
        if chunk.path not in self._clouds:
            name = chunk.path.relative_to(self.folder)
            if not chunk.path.is_file():
                raise FileError(f"{self.folder}: its part {name} is missing; copy the whole folder")
            self._room += chunk.size / sog.MIN_BYTES_A_GAUSSIAN - (chunk.rows or 0)
            if self._room < 0:
                raise FileError(f"{self.folder}: {chunk.rows:,} Gaussians do not fit into the bytes of {name}")
            scene, report = sog.read(chunk.path)
            if chunk.rows not in (None, report.rows):
                raise FileError(
                    f"{self.folder}: {name} holds {report.rows:,} Gaussians, the leaves of {INDEX} say {chunk.rows:,}"
                )
            self.notes += [f"{note} in {name.parent}" for note in report.notes]
            self._clouds[chunk.path] = scene.cloud, report.rows
        return self._clouds[chunk.path]


def _rows(cloud: GaussianCloud, run: Run) -> GaussianCloud:
    """The Gaussians of a run; damaged rows of the file are missing in the cloud, so ids say where it begins."""
    start, end = torch.searchsorted(cloud.ids, torch.tensor([run.offset, run.offset + run.count])).tolist()
    return cloud[start:end]


def _read_index(folder: Path) -> _Index:
    path = folder / INDEX
    if not path.is_file():
        raise FileError(f"{folder}: the index {INDEX} is missing")
    if path.stat().st_size > _INDEX_LIMIT:
        raise FileError(f"{path}: larger than an index can be")
    try:
        return _Index.model_validate_json(path.read_bytes())
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"][-4:]) or "the text"
        raise FileError(f"{path}: not a {NAME} index of version 1: {where}: {first['msg']}") from error


def _extras(index: _Index) -> tuple[_Extras, tuple[str, ...]]:
    """What this program wrote into the index, and a note if it cannot be used: pictures do not need it."""
    ours = index.extras.get("scenewright", {}) if isinstance(index.extras, dict) else {}
    try:
        found = _Extras.model_validate(ours)
    except ValidationError as error:
        where = ".".join(str(part) for part in error.errors()[0]["loc"][:1]) or "extras"
        return _Extras(), (f"frame, cameras and PSNR in {INDEX} were ignored: {where}: {error.errors()[0]['msg']}",)
    if len(found.psnr) not in (0, index.levels):
        return found.model_copy(update={"psnr": ()}), (f"the PSNR in {INDEX} was ignored: it is not of each level",)
    return found, ()


def _inside(folder: Path, name: str) -> Path:
    """The path of a chunk; links may not lead out of the folder either."""
    path = folder / name
    if ".." in name.split("/") or not path.resolve().is_relative_to(folder.resolve()):
        raise FileError(f"{folder}: {INDEX} names the chunk {name!r} outside its folder")
    return path


def _leaves(tree: _Node) -> Iterator[Leaf]:
    """The leaves below a node in the order of the tree."""
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        waiting += reversed(node.children or ())
        if node.lods:
            yield Leaf(node.bound.min, node.bound.max, {int(k): run for k, run in node.lods.items() if run.count})


def _chunks(folder: Path, index: _Index, leaves: Sequence[Leaf]) -> tuple[Chunk, ...]:
    """The chunks, checked: each is named once, and runs of one level divide its rows."""
    paths = [_inside(folder, name) for name in index.filenames]
    if len({path.resolve() for path in paths}) < len(paths):
        raise FileError(f"{folder}: {INDEX} names a chunk twice")
    runs: list[list[tuple[int, int, int]]] = [[] for _ in paths]
    for leaf in leaves:
        for level, run in leaf.runs.items():
            if level >= index.levels or run.file >= len(paths):
                raise FileError(
                    f"{folder}: {INDEX} has a leaf with level {level} in chunk {run.file}, but {index.levels} levels "
                    f"and {len(paths)} chunks"
                )
            runs[run.file].append((run.offset, run.offset + run.count, level))
    chunks = []
    for path, found in zip(paths, runs, strict=True):
        starts, ends, levels = zip(*sorted(found), strict=True) if found else ((0,), (0,), (-1,))
        if starts != (0, *ends[:-1]) or len(set(levels)) > 1:
            raise FileError(
                f"{folder}: the leaves of {INDEX} do not divide {path.relative_to(folder)} into rows of one level"
            )
        chunks.append(Chunk(path, ends[-1], levels[0]))
    return tuple(chunks)


def scene_folder(path: Path) -> Path:
    """The folder of an index, which alone does not tell one scene from another; any other path as it is."""
    return path.parent if path.name == INDEX else path


def recognises(path: Path, head: bytes) -> bool:
    """Whether the path is such a folder, or its index."""
    return path.name == INDEX or (path / INDEX).is_file()


def read(path: Path) -> tuple[Scene, Report]:
    """Read the finest level that holds anything, and the environment.

    Raises:
        FileError: the index or a chunk of this level is missing, damaged, or contradicts another.
    """
    streamed = Streamed.open(path)
    scene, rows = streamed.scene()
    return scene.replace(path=path), Report(NAME, rows, len(scene.cloud), tuple(streamed.notes))


FORMAT = Format(NAME, (SUFFIX,), recognises, read, made_by="convert SCENE")
