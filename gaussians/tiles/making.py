"""Makes a folder of tiles of scene files (`make`): a sample divides space, one pass over the files fills the tiles.

The rows of a tile follow each other by id, as in the files; the tiles follow each other along a Morton curve. Memory
holds one block of a file and the rows that wait to be appended to their tiles.
"""

from __future__ import annotations

import contextlib
import hashlib
import shutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from .. import morton
from ..cloud import NO_GROUP, GaussianCloud
from ..errors import FileError
from ..files.atomic import writing_folder
from ..files.formats import comments
from . import files, tables
from .locking import NAME as LOCK
from .locking import locked
from .records import MOST_ROWS, TILE_COLUMNS, Head, State, Step, Stored, Table, Tile, column_type, row_bytes
from .sources import BLOCK_ROWS, Source, common_table, open_source
from .store import HEAD, PIECES, STATES, TABLES, TILES, Tiles, corner, described, is_tiles, write_owners

AIM = 800_000  # rows of a tile: edits may add some, and a sample does not divide exactly
_SAMPLE = 1_000_000  # rows of it
_APART = 16  # of how many of its blocks one is read at least
_BITS = 16  # of a Morton cell along each axis
_TRIM = 1e-3  # share of the sample beyond the grid at each end: a floater far away does not coarsen all cells
_LEAST, _MOST = 1 << 25, 1 << 29  # bytes of rows that wait
Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class Grid:
    """Cubic cells in space, and the cells of the Morton curve at which a new tile begins.

    Attributes:
        low: `[3]`, its corner, scene units.
        cell: side of a cell.
        starts: `[T - 1]` uint64, ascending codes.
    """

    low: NDArray[np.float64]
    cell: float
    starts: NDArray[np.uint64]

    def codes(self, means: NDArray[np.float32]) -> NDArray[np.uint64]:
        """Morton codes `[N]` of centres `[N, 3]`; those beyond the grid count to its border cells."""
        cells = np.clip((means - self.low) / self.cell, 0, (1 << _BITS) - 1)
        return morton.codes(cells.astype(np.int64))

    def tiles(self, means: NDArray[np.float32]) -> NDArray[np.int64]:
        """The tile `[N]` of each centre."""
        return np.searchsorted(self.starts, self.codes(means), side="right")


@dataclass(eq=False)
class _Bucket:
    """A tile that is being filled: rows that wait, and hashes and bounds of those on disk."""

    digests: dict[str, Any]  # hashlib's
    rows: int = 0
    waiting: list[dict[str, files.Array]] = field(default_factory=list)
    low: NDArray[np.float64] = field(default_factory=lambda: np.full(3, np.inf))
    high: NDArray[np.float64] = field(default_factory=lambda: np.full(3, -np.inf))
    largest: float = 0.0


def make(
    paths: Sequence[Path],
    output: Path,
    *,
    memory: int = 4 << 30,
    force: bool = False,
    most: int = MOST_ROWS,
    progress: Progress = lambda stage, share: None,
) -> Tiles:
    """Write a folder of tiles of one or several scene files; ids count the rows of all files, one after the other.

    Args:
        memory: bytes that this may hold, roughly.
        most: rows of a tile at most.

    Raises:
        UserError: `output` exists and `force` is not set, or it is something else.
        FileError: a file cannot be read, holds no usable Gaussian, or the disk has too little room.
    """
    sources = [open_source(path) for path in paths]
    degree = max(source.degree for source in sources)
    require_room(output, sum(source.rows for source in sources) * (row_bytes(degree) + 8))
    starts, untold = common_table(sources)
    with new_folder(output, force) as folder:
        progress("dividing space", 0.0)
        grid = _divided(sources, min(AIM, most * 4 // 5))
        filling = _Filling(folder / TILES, degree, len(grid.starts) + 1, min(max(memory // 8, _LEAST), _MOST))
        gone = _filled(filling, grid, sources, starts, progress)
        progress("closing the tiles", 0.95)
        tiles = [tile for number in range(len(filling.buckets)) for tile in filling.closed(number, grid, most)]
        tiles = [_renamed(tile, folder / TILES, k) for k, tile in enumerate(tiles)]
        if not tiles:
            raise FileError(f"{paths[0]}: none of its Gaussians is usable: every row holds NaN or infinite values")
        notes = [note for source in sources for note in source.notes]
        state = _state(folder, sources, tiles, gone, degree, (*notes, *([untold] if untold else [])))
        stored = files.write(folder / STATES, "0.json", state.model_dump_json().encode())
        (folder / HEAD).write_text(Head(present=Step(state=stored)).model_dump_json(), encoding="utf-8")
    return Tiles.open(output)


@contextlib.contextmanager
def new_folder(output: Path, force: bool) -> Iterator[Path]:
    """A folder for tiles, which has the name `output` when the block succeeds; see `files.atomic.writing_folder`."""
    earlier = locked(output) if force and is_tiles(output) else contextlib.nullcontext()
    with earlier, writing_folder(output, force, _ours) as folder:
        for part in (STATES, TILES, TABLES):
            (folder / part).mkdir()
        yield folder


def _ours(path: Path) -> bool:
    """Whether a file of a folder is of those that are written here."""
    return str(path) in (HEAD, LOCK) or path.parts[0] in (STATES, TILES, TABLES, PIECES)


def require_room(output: Path, wanted: int) -> None:
    """Check that the disk has room for the tiles. Raises FileError."""
    if not output.absolute().parent.is_dir():
        return  # told when it is written
    free = shutil.disk_usage(output.absolute().parent).free
    if wanted > free:
        raise FileError(
            f"the tiles take about {wanted / 1e9:.1f} GB and {output.absolute().parent} has {free / 1e9:.1f} GB left; "
            "make room, or write them to another disk"
        )


def _divided(sources: Sequence[Source], aim: int) -> Grid:
    """The grid, and where on its curve tiles of about `aim` rows begin, by a sample of blocks over all sources."""
    rows = sum(source.rows for source in sources)
    apart = min(max(1, rows // _SAMPLE), _APART)
    step = max(1, rows // (apart * _SAMPLE))
    means = np.concatenate([cloud.means.numpy()[::step] for source in sources for cloud in source.blocks(apart)])
    if not len(means):
        means = np.zeros((1, 3), np.float32)
    low, high = np.quantile(means.astype(np.float64), [_TRIM, 1 - _TRIM], axis=0)
    cell = max(float((high - low).max()) / ((1 << _BITS) - 1), 1e-12)
    codes = np.sort(Grid(low, cell, np.zeros(0, np.uint64)).codes(means))
    count = -(-rows // aim)
    return Grid(low, cell, np.unique(codes[[k * len(codes) // count for k in range(1, count)]]))


def _filled(
    filling: _Filling, grid: Grid, sources: Sequence[Source], starts: Sequence[int], progress: Progress
) -> NDArray[np.int64]:
    """Append the rows of all sources to their tiles; the ids of those that were dropped."""
    first = done = 0
    gone: list[NDArray[np.int64]] = []
    rows = sum(source.rows for source in sources)
    for number, source in enumerate(sources):
        expected = first
        for cloud in source.blocks(1):
            group = cloud.group
            group = (
                torch.where(group >= 0, group + starts[number], NO_GROUP)
                if starts
                else torch.full_like(group, NO_GROUP)
            )
            cloud = cloud.replace(ids=cloud.ids + first, group=group.to(torch.int32))
            filling.add(cloud, grid)
            if len(cloud):
                last = int(cloud.ids[-1]) + 1
                gone.append(np.setdiff1d(np.arange(expected, last), cloud.ids.numpy(), assume_unique=True))
                expected = last
            done += len(cloud)
            progress(f"tiling {source.path.name}", 0.05 + 0.9 * done / rows)
        gone.append(np.arange(expected, first + source.rows))
        first += source.rows
    filling.flush()
    return np.concatenate(gone).astype(np.int64)


class _Filling:
    """The tiles while they are filled. Files are opened for an append and closed again: there may be thousands."""

    def __init__(self, folder: Path, degree: int, count: int, room: int) -> None:
        self._folder, self._degree, self._room = folder, degree, room
        self.buckets = [_Bucket({name: hashlib.sha256() for name in TILE_COLUMNS}) for _ in range(count)]
        self._waiting = 0

    def add(self, cloud: GaussianCloud, grid: Grid) -> None:
        """Add some rows, which come after all before by id."""
        columns = {name: c.numpy() for name, c in cloud.with_degree(self._degree).columns()}
        tiles = grid.tiles(columns["means"])
        order = np.argsort(tiles, kind="stable")
        ends = np.searchsorted(tiles[order], np.arange(len(self.buckets)), side="right")
        start = 0
        for bucket, end in zip(self.buckets, ends.tolist(), strict=True):
            if end > start:
                bucket.waiting.append({name: column[order[start:end]] for name, column in columns.items()})
            start = end
        self._waiting += cloud.nbytes
        if self._waiting > self._room:
            self.flush()

    def flush(self) -> None:
        """Append the rows that wait to their files."""
        for number, bucket in enumerate(self.buckets):
            if bucket.waiting:
                self._append(number, bucket)
        self._waiting = 0

    def _append(self, number: int, bucket: _Bucket) -> None:
        parts, bucket.waiting = bucket.waiting, []
        for name in TILE_COLUMNS:
            kind, _ = column_type(name, self._degree)
            data = np.concatenate([part[name] for part in parts]).astype(kind, copy=False)
            if name == "means":
                bucket.rows += len(data)
                bucket.low = np.minimum(bucket.low, data.min(axis=0))
                bucket.high = np.maximum(bucket.high, data.max(axis=0))
            if name == "scales":
                bucket.largest = max(bucket.largest, float(data.max()))
            with open(self._folder / f"part{number}.{name}", "ab") as file:
                file.write(data.reshape(-1).view(np.uint8).data)
            bucket.digests[name].update(np.ascontiguousarray(data).reshape(-1).view(np.uint8).data)

    def closed(self, number: int, grid: Grid, most: int) -> Iterator[Tile]:
        """The tiles that a bucket becomes: none if it is empty, several if it holds too many rows."""
        bucket = self.buckets[number]
        if not bucket.rows:
            return
        columns = {
            name: Stored(file=f"part{number}.{name}", sha256=digest.hexdigest())
            for name, digest in bucket.digests.items()
        }
        read = {
            name: files.mapped(
                self._folder, stored, column_type(name, self._degree)[0],
                (bucket.rows, *column_type(name, self._degree)[1]), checked=False,
            )
            for name, stored in columns.items()
        }  # fmt: skip
        if bucket.rows <= most:
            owners = write_owners(self._folder.parent, f"part{number}.owners", read["group"])
            yield Tile(
                rows=bucket.rows, low=corner(bucket.low), high=corner(bucket.high), largest=bucket.largest,
                columns=columns, owners=owners,
            )  # fmt: skip
            return
        order = np.argsort(grid.codes(read["means"]), kind="stable")  # some 24 bytes a row
        for piece, rows in enumerate(np.array_split(order, -(-bucket.rows // (most * 4 // 5)))):
            part = {name: np.asarray(column[np.sort(rows)]) for name, column in read.items()}
            yield written(self._folder.parent, f"part{number}-{piece}", part, 0)
        for stored in columns.values():
            (self._folder / stored.file).unlink()


def written(folder: Path, name: str, columns: dict[str, files.Array], number: int) -> Tile:
    """A new tile of some columns, in a folder of tiles.

    Args:
        name: of its files, before that of the column.
        number: of the edit, after it.

    Raises:
        FileError: it cannot be written.
    """
    stored = {
        column: files.write(folder / TILES, f"{name}.{column}.{number}", columns[column]) for column in TILE_COLUMNS
    }
    low, high, largest = described(columns)
    owners = write_owners(folder, f"{name}.owners.{number}", columns["group"])
    return Tile(rows=len(columns["ids"]), low=low, high=high, largest=largest, columns=stored, owners=owners)


def _renamed(tile: Tile, folder: Path, number: int) -> Tile:
    """The tile with files that are named after its number."""

    def moved(stored: Stored, column: str) -> Stored:
        target = f"{number}.{column}.0"
        (folder / stored.file).rename(folder / target)
        return Stored(file=target, sha256=stored.sha256)

    columns = {name: moved(stored, name) for name, stored in tile.columns.items()}
    return tile.model_copy(update={"columns": columns, "owners": moved(tile.owners, "owners")})


def _state(
    folder: Path, sources: Sequence[Source], tiles: Sequence[Tile], gone: NDArray[np.int64], degree: int,
    notes: Sequence[str],
) -> State:  # fmt: skip
    """The first state of a folder whose tiles are written."""
    listed = sum(source.rows for source in sources)
    return State(
        degree=degree, first_free=listed, listed=listed,
        homes=written_homes(folder, tiles, listed),
        gone=files.write(folder / TABLES, "gone.0", gone.astype("<i8")), missing=len(gone),
        tiles=tuple(tiles), table=_table(folder, sources), comments=comments.describe(sources[0].scene),
        notes=tuple(notes),
    )  # fmt: skip


def written_homes(folder: Path, tiles: Sequence[Tile], listed: int) -> Stored:
    """A new file with the tile of each of so many ids, in a folder whose tiles are written."""
    homes = files.allocated(folder / TABLES / "homes.0", np.dtype("<u4"), (listed,))
    for number, tile in enumerate(tiles):
        homes[files.mapped(folder / TILES, tile.columns["ids"], np.dtype("<i8"), (tile.rows,), checked=False)] = number
    if isinstance(homes, np.memmap):
        homes.flush()
    digest = hashlib.sha256()
    for start in range(0, listed, BLOCK_ROWS):
        digest.update(np.ascontiguousarray(homes[start : start + BLOCK_ROWS]).view(np.uint8).data)
    return Stored(file="homes.0", sha256=digest.hexdigest())


def _table(folder: Path, sources: Sequence[Source]) -> Table | None:
    if not common_table(sources)[0]:
        return None
    found = tables.joined([source.table for source in sources if source.table is not None])
    return tables.write_table(found, folder / TABLES, 0)
