"""Writes what an operation changed in a window back into its tiles, and undoes it.

Only columns of tiles with a changed row get new files, beside the old ones; the head then names the new state in one
step. A stop at any point before leaves the old state, whose files are all there; files that no state names are removed
when the folder is changed the next time.
"""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..cloud import GaussianCloud
from ..errors import FileError, UserError
from ..files.atomic import writing
from ..files.formats import comments
from ..language.field.language_field import LanguageField
from ..scene import Frame, Scene
from . import files, tables
from .locking import locked
from .making import written
from .records import MOST_ROWS, TILE_COLUMNS, Head, State, Step, Tile, column_type
from .store import HEAD, STATES, TABLES, TILES, Tiles, described, read_head, stored_files, write_owners
from .window import Window, everything, merged

KEPT = 100  # states that undo reaches


@dataclass(frozen=True, eq=False)
class _Changes:
    """How the rows of a cloud differ from those of the cloud before, by id.

    Attributes:
        removed: `[M]` bool over the cloud before.
        changed: by column, `[M]` bool over the cloud before: rows that remained and differ in any bit.
        now: `[M]` int64, the row of the cloud after of each that remained; -1 for those that were removed.
        added: `[K]` int64 rows of the cloud after, ascending by id.
    """

    removed: NDArray[np.bool_]
    changed: dict[str, NDArray[np.bool_]]
    now: NDArray[np.int64]
    added: NDArray[np.int64]


def change(window: Window, after: Scene, text: str) -> Tiles:
    """The scene in tiles after its window became `after`; the folder has it when this returns.

    Args:
        text: the instruction, for the history.

    Raises:
        FileError: another program changed the folder meanwhile, a tile is torn, or a file cannot be written; the scene
            is then as it was.
        UserError: the window has other harmonics now.
    """
    tiles = window.tiles
    if after.cloud.degree != tiles.state.degree:
        raise UserError(f"a scene in tiles keeps harmonics of degree {tiles.state.degree}; convert it to a .ply first")
    if after.motion is not None:
        raise UserError("a scene in tiles stands still: it keeps no motion; convert it to a .ply first")
    with locked(tiles.folder):
        head = read_head(tiles.folder)
        if head.present != tiles.head.present:
            raise FileError(f"{tiles.folder} was changed by another program meanwhile; give the instruction again")
        _swept(tiles.folder, head)
        return _committed(tiles, head, _changed(window, after, head.written), text)


def _committed(tiles: Tiles, head: Head, state: State, text: str) -> Tiles:
    """The scene in a new state, whose files are written, after `head`; the folder has it when this returns."""
    stored = files.write(
        tiles.folder / STATES, f"{head.written}.json", state.model_dump_json(exclude_defaults=True).encode()
    )
    for folder in (TILES, TABLES, STATES):
        files.sync(tiles.folder / folder)
    past = (*head.past, head.present)[-KEPT:]
    head = Head(past=past, present=Step(state=stored, text=text), written=head.written + 1)
    _switch(tiles.folder, head)
    _swept(tiles.folder, head)
    return Tiles(tiles.folder, head, state)


def regroup(
    tiles: Tiles,
    columns: Iterable[NDArray[np.int32]],
    table: Callable[[], LanguageField],
    frame: Frame,
    text: str,
) -> Tiles:
    """The scene with other groups; nothing else of its Gaussians changes. The caller has the lock.

    Args:
        columns: of each tile, the group of each of its rows.
        table: of the whole scene; called after the last column.
        text: what was done, for the history.

    Raises:
        FileError: a file cannot be written; the scene is then as it was.
    """
    head = read_head(tiles.folder)
    _swept(tiles.folder, head)
    number, new = head.written, []
    for k, (tile, column) in enumerate(zip(tiles.state.tiles, columns, strict=True)):
        stored = files.write(tiles.folder / TILES, f"{k}.group.{number}", column.astype("<i4"))
        owners = write_owners(tiles.folder, f"{k}.owners.{number}", column)
        new.append(tile.model_copy(update={"columns": {**tile.columns, "group": stored}, "owners": owners}))
    scene = tiles.scene(tiles.cloud(0, np.zeros(0, np.int64))).replace(frame=frame)
    update = {
        "tiles": tuple(new), "comments": comments.describe(scene),
        "table": tables.write_table(table(), tiles.folder / TABLES, number, tiles.state.table),
    }  # fmt: skip
    return _committed(tiles, head, tiles.state.model_copy(update=update), text)


def embed(tiles: Tiles, embedded: Scene, text: str) -> Tiles:
    """The scene in tiles with the table of `embedded`, which is all of it with its groups.

    Raises:
        FileError, UserError: as `change`.
    """
    return change(everything(tiles, sys.maxsize), embedded, text)


def undo(folder: Path) -> tuple[Tiles, str]:
    """The scene before its last edit, which is there again when this returns; and the words of that edit.

    Raises:
        UserError: there is nothing to undo.
        FileError: the folder cannot be changed.
    """
    with locked(folder):
        head = read_head(folder)
        if not head.past:
            raise UserError("there is nothing to undo")
        text = head.present.text
        new = head.model_copy(
            update={"past": head.past[:-1], "present": head.past[-1], "future": (*head.future, head.present)}
        )
        _switch(folder, new)
    return Tiles.open(folder), text


def redo(folder: Path) -> tuple[Tiles, str]:
    """The scene after the edit that was undone last, and the words of that edit.

    Raises:
        UserError: there is nothing to redo.
        FileError: the folder cannot be changed.
    """
    with locked(folder):
        head = read_head(folder)
        if not head.future:
            raise UserError("there is nothing to redo")
        new = head.model_copy(
            update={"past": (*head.past, head.present), "present": head.future[-1], "future": head.future[:-1]}
        )
        _switch(folder, new)
    return Tiles.open(folder), new.present.text


def _switch(folder: Path, head: Head) -> None:
    with writing(folder / HEAD, force=True) as file:
        file.write(head.model_dump_json().encode())


def _swept(folder: Path, head: Head) -> None:
    """Remove files that no state of the head names: of an edit that was stopped, or of states out of reach."""
    named = {(STATES, step.state.file) for step in head.steps}
    try:
        for step in head.steps:
            state = State.model_validate_json(files.content(folder / STATES, step.state, 1 << 30))
            named |= {(part, stored.file) for part, stored in stored_files(state)}
    except (FileError, ValueError):
        return  # a damaged state of the history tells no longer which files are its own: all stay
    for part in (STATES, TILES, TABLES):
        for path in (folder / part).iterdir():
            if (part, path.name) not in named:
                with contextlib.suppress(OSError):
                    path.unlink()


def _changed(window: Window, after: Scene, number: int) -> State:
    """The state after, whose new files are written under the number of the edit."""
    before, tiles = window.scene.cloud, window.tiles
    found = _compared(before, after.cloud)
    now = {name: column.numpy() for name, column in after.cloud.columns()}
    touched = found.removed.copy()
    for mask in found.changed.values():
        touched |= mask
    new = list(tiles.state.tiles)
    ids = before.ids.numpy()
    for k in np.unique(window.homes[touched]).tolist():
        mine = window.homes == k
        writes = {name: (ids[mine & mask], now[name][found.now[mine & mask]]) for name, mask in found.changed.items()}
        gone = ids[mine & found.removed]
        new[k] = _rewritten(tiles, k, {n: w for n, w in writes.items() if len(w[0])}, gone, number)
    if len(found.added):
        homes = window.homes[touched] if touched.any() else window.homes
        new = _with_added(tiles, new, {n: c[found.added] for n, c in now.items()}, homes, number)
    state, folder = tiles.state, tiles.folder / TABLES
    gone = np.asarray(files.mapped(folder, state.gone, np.dtype("<i8"), (state.missing,)))
    first_free = max(state.first_free, after.cloud.first_free, int(now["ids"].max(initial=-1)) + 1)
    skipped = np.setdiff1d(np.arange(state.first_free, first_free), now["ids"])
    every = np.union1d(np.union1d(gone, ids[found.removed]), skipped)
    update = {
        "tiles": tuple(new), "first_free": first_free, "missing": len(every), "table": state.table,
        "gone": state.gone if len(every) == len(gone) else files.write(folder, f"gone.{number}", every.astype("<i8")),
        "comments": comments.describe(after),
    }  # fmt: skip
    if after.language is not None and (state.table is None or after.language is not tiles.field):
        table = after.language if tiles.field is None else merged(window, after.language)
        update["table"] = tables.write_table(table, folder, number, state.table)
    return state.model_copy(update=update)


def _compared(before: GaussianCloud, after: GaussianCloud) -> _Changes:
    old, new = before.ids.numpy(), after.ids.numpy()
    order = np.argsort(new, kind="stable")
    place = np.searchsorted(new[order], old)
    there = place < len(new)
    there[there] = new[order][place[there]] == old[there]
    now = np.full(len(old), -1, np.int64)
    now[there] = order[place[there]]
    changed = {}
    for name, column in before.columns():
        if (column is getattr(after, name)) or name == "ids":
            continue
        was = np.ascontiguousarray(column.numpy()[there]).reshape(int(there.sum()), -1)
        is_ = np.ascontiguousarray(getattr(after, name).numpy()[now[there]]).reshape(int(there.sum()), -1)
        mask = np.zeros(len(old), bool)
        mask[there] = (was.view(np.uint8) != is_.view(np.uint8)).any(axis=1)
        if mask.any():
            changed[name] = mask
    fresh = np.ones(len(new), bool)
    fresh[now[there]] = False
    added = np.flatnonzero(fresh)
    return _Changes(~there, changed, now, added[np.argsort(new[added], kind="stable")])


def _rewritten(
    tiles: Tiles, k: int, writes: dict[str, tuple[NDArray[np.int64], files.Array]], gone: NDArray[np.int64], number: int
) -> Tile:
    """A tile with some values written and some rows removed: new files for the columns that differ."""
    tile, folder = tiles.state.tiles[k], tiles.folder
    ids = tiles.column(k, "ids")
    kept = np.ones(tile.rows, bool)
    kept[np.searchsorted(ids, gone)] = False
    columns, made = dict(tile.columns), {}
    for name in TILE_COLUMNS if len(gone) else writes:
        column = np.array(tiles.column(k, name))
        if name in writes:
            column[np.searchsorted(ids, writes[name][0])] = writes[name][1]
        made[name] = column[kept]
        columns[name] = files.write(folder / TILES, f"{k}.{name}.{number}", made[name])
    update: dict[str, object] = {"columns": columns, "rows": int(kept.sum())}
    if "means" in made or "scales" in made:
        both = {name: made.get(name, tiles.column(k, name)) for name in ("means", "scales")}
        update["low"], update["high"], update["largest"] = described(both)
    if "group" in made:
        update["owners"] = write_owners(folder, f"{k}.owners.{number}", made["group"])
    return tile.model_copy(update=update)


def _with_added(
    tiles: Tiles, new: list[Tile], added: dict[str, files.Array], homes: NDArray[np.int64], number: int
) -> list[Tile]:
    """The tiles with added rows: in the tile that was touched most if it has room, else in tiles of their own."""
    count = len(added["ids"])
    best = int(np.bincount(homes).argmax()) if len(homes) else len(new)
    if best < len(new) and new[best].rows + count <= MOST_ROWS:
        tile = new[best]
        read = {
            name: files.mapped(
                tiles.folder / TILES, tile.columns[name], column_type(name, tiles.state.degree)[0],
                (tile.rows, *column_type(name, tiles.state.degree)[1]),
            )
            for name in TILE_COLUMNS
        }  # fmt: skip
        whole = {name: np.concatenate([read[name], added[name]]) for name in TILE_COLUMNS}
        new[best] = written(tiles.folder, str(best), whole, number)
        return new
    for piece in np.array_split(np.arange(count), -(-count // MOST_ROWS)):
        part = {name: column[piece] for name, column in added.items()}
        new.append(written(tiles.folder, str(len(new)), part, number))
    return new
