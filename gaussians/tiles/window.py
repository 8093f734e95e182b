"""Takes what an operation needs of a scene in tiles into an ordinary scene in memory (`Window`).

A window holds whole groups, ascending by id as in the files: the groups that are asked for and, where an operation
looks at what is around them, every group whose box comes near, and the rows without a group that lie there. Its table
is that of the whole scene, so that names, relations and places mean the same in it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..cloud import NO_GROUP, GaussianCloud, concat
from ..errors import FileError, UserError
from ..language.field.language_field import LanguageField
from ..scene import Scene
from . import files
from .records import TILE_COLUMNS, column_type, row_bytes
from .store import TABLES, TILES, Tiles

WORKING = 12  # copies of the columns that an operation may hold besides the scene itself
_AROUND = 3.0  # times the extent of a thing: what may support it, touch it or lie behind it
_METRES = 1.5  # at least so far around it
_FEW = 2048  # rows of a tile up to which they are read one by one

Region = NDArray[np.float64]  # [B, 2, 3] corners of boxes, world frame, scene units


@dataclass(frozen=True, eq=False)
class Window:
    """Rows of a scene in tiles.

    Attributes:
        tiles: the scene.
        scene: the window as a scene.
        homes: `[N]` int64, the tile of each row of its cloud.
        whole: groups of which every row is in it.
        tiles_read: the tiles that it was read from.
    """

    tiles: Tiles
    scene: Scene
    homes: NDArray[np.int64]
    whole: frozenset[int]
    tiles_read: tuple[int, ...]


def everything(tiles: Tiles, memory: int) -> Window:
    """The whole scene as a window.

    Raises:
        UserError: it does not fit into the memory.
        FileError: a tile is torn.
    """
    if not fits(tiles, len(tiles), memory):
        raise UserError(
            f"this needs all {len(tiles):,} Gaussians in memory, about "
            f"{needed(tiles, len(tiles)) / 1e9:.1f} GB; name things that are in one place, or give --memory"
        )
    return _window(tiles, {k: None for k in range(len(tiles.state.tiles))}, range(-1, _groups(tiles)))


def of_groups(tiles: Tiles, groups: Iterable[int], memory: int) -> Window:
    """All rows of some groups and their parts.

    Raises:
        UserError: they do not fit into the memory.
        FileError: a tile is torn.
    """
    leaves = with_parts(tiles, groups)
    _require(tiles, tiles.count(leaves), memory)
    taken = {k: _rows_of(tiles, k, leaves) for k in tiles.holding(leaves)}
    return _window(tiles, taken, leaves)


def around(tiles: Tiles, groups: Iterable[int], memory: int, alone: Iterable[int] = ()) -> Window:
    """All rows of some groups, of the groups around them, and the rows without a group there.

    Args:
        alone: groups that are in the window without what is around them.

    Raises:
        UserError: they do not fit into the memory.
        FileError: a tile is torn.
    """
    asked = set(groups)
    field = tiles.field
    assert field is not None
    boxes = region_of(tiles, asked)
    near = {g.id for g, hit in zip(field.groups, _meets(_bounds(field), boxes), strict=True) if hit and g.count}
    leaves = with_parts(tiles, {*asked, *near, *alone})
    _require(tiles, tiles.count(leaves), memory)
    taken: dict[int, NDArray[np.int64]] = {}
    loose = {k for k in tiles.holding([NO_GROUP]) if _meets(_tile_box(tiles, k), boxes).any()}
    for k in sorted({*tiles.holding(leaves), *loose}):
        group = tiles.column(k, "group")
        mine = np.isin(group, sorted(leaves))
        if k in loose:
            free = np.flatnonzero(group == NO_GROUP)
            mine[free[_inside(np.asarray(tiles.column(k, "means"))[free], boxes)]] = True
        taken[k] = np.flatnonzero(mine)
    return _window(tiles, taken, leaves)


def needed(tiles: Tiles, rows: int) -> int:
    """Bytes that an operation on a window of so many rows may take."""
    return rows * row_bytes(tiles.state.degree) * WORKING


def fits(tiles: Tiles, rows: int, memory: int) -> bool:
    """Whether an operation on a window of so many rows stays within the memory."""
    return needed(tiles, rows) <= memory


def with_parts(tiles: Tiles, groups: Iterable[int]) -> frozenset[int]:
    """Groups with their parts."""
    field = tiles.field
    return frozenset(leaf for g in groups for leaf in (field.leaves(g) if field is not None else (g,)))


def region_of(tiles: Tiles, groups: Iterable[int]) -> Region:
    """The boxes around things within which an operation on them may look."""
    field = tiles.field
    assert field is not None
    least = _METRES / (tiles.frame.metres_per_unit or 1.0)
    found = []
    for g in groups:
        corners = field.groups[g].box.corners()
        pad = max(_AROUND * max(field.groups[g].box.size), least)
        if field.groups[g].level == "structure":
            pad = least
        found.append([corners.min(axis=0) - pad, corners.max(axis=0) + pad])
    return np.array(found, np.float64).reshape(-1, 2, 3)


def _require(tiles: Tiles, rows: int, memory: int) -> None:
    if not fits(tiles, rows, memory):
        raise UserError(
            f"that takes {rows:,} Gaussians in memory, about {needed(tiles, rows) / 1e9:.1f} GB; name fewer things, "
            "or give --memory"
        )


def _groups(tiles: Tiles) -> int:
    return 0 if tiles.field is None else len(tiles.field.groups)


def _rows_of(tiles: Tiles, number: int, groups: frozenset[int]) -> NDArray[np.int64]:
    return np.flatnonzero(np.isin(tiles.column(number, "group"), sorted(groups)))


def _bounds(field: LanguageField) -> Region:
    """`[G, 2, 3]` corners of the boxes of all groups along the axes of the world."""
    corners = np.array([g.box.corners() for g in field.groups], np.float64).reshape(-1, 8, 3)
    return np.stack([corners.min(axis=1), corners.max(axis=1)], axis=1)


def _meets(boxes: Region, others: Region) -> NDArray[np.bool_]:
    """`[A]`: which of the boxes `[A, 2, 3]` meet one of the others `[B, 2, 3]`."""
    hit = np.zeros(len(boxes), bool)
    for low, high in others:
        hit |= ((boxes[:, 0] <= high) & (boxes[:, 1] >= low)).all(axis=1)
    return hit


def _inside(points: NDArray[np.float32], boxes: Region) -> NDArray[np.bool_]:
    hit = np.zeros(len(points), bool)
    for low, high in boxes:
        hit |= ((points >= low) & (points <= high)).all(axis=1)
    return hit


def _tile_box(tiles: Tiles, number: int) -> Region:
    tile = tiles.state.tiles[number]
    return np.array([[tile.low, tile.high]])


def _window(tiles: Tiles, taken: dict[int, NDArray[np.int64]] | dict[int, None], whole: Iterable[int]) -> Window:
    """The window of some rows of some tiles (None: all rows of a tile)."""
    numbers = [k for k, rows in taken.items() if rows is None or len(rows)]
    clouds = [tiles.cloud(k, taken[k]) for k in numbers]
    joined = concat(clouds) if clouds else GaussianCloud.empty(tiles.state.degree)
    homes = np.repeat(np.array(numbers, np.int64), [len(c) for c in clouds])
    order = np.argsort(joined.ids.numpy(), kind="stable")
    cloud = joined if (order[1:] > order[:-1]).all() else joined[torch.from_numpy(order)]
    cloud = cloud.replace(first_free=tiles.state.first_free)
    if len(cloud) < len(tiles):
        cloud = cloud.replace(rest=Beyond(tiles, cloud.ids, cloud.group.numpy()))
    return Window(tiles, tiles.scene(cloud), homes[order], frozenset(whole), tuple(numbers))


@dataclass(frozen=True, eq=False)
class Beyond:
    """The scene around a window: a `cloud.Rest`.

    Attributes:
        tiles: the whole scene, as it was when the window was taken.
        ids: `[N]`, the rows that the window had then, ascending.
        groups: `[N]` int32, their groups.
    """

    tiles: Tiles
    ids: Tensor
    groups: NDArray[np.int32]

    def count(self, cloud: GaussianCloud) -> int:
        """See `Rest`."""
        return len(self.tiles) + len(cloud) - len(self.ids)

    def owned(self, groups: int) -> Tensor:
        """See `Rest`."""
        return torch.from_numpy(np.pad(self._owned, (0, groups - len(self._owned))))

    @cached_property
    def _owned(self) -> NDArray[np.int64]:
        count = _groups(self.tiles)
        return self.tiles.sizes(count) - np.bincount(self.groups[self.groups >= 0], minlength=count)

    def evenly(self, cloud: GaussianCloud, step: int, near: tuple[Tensor, float] | None = None) -> GaussianCloud:
        """See `Rest`. Rows of the whole scene follow each other by id, as those of a file do."""
        now = np.sort(cloud.ids.numpy())
        lost = np.setdiff1d(self.ids.numpy(), now, assume_unique=True)
        ids = nth_ids(self.tiles, np.arange(0, self.count(cloud), step), lost)
        ids = np.concatenate([ids, self._added(now, ids, cloud, step)])
        inside = np.isin(ids, now)
        outer = self._outer(ids[~inside], near)
        own = torch.from_numpy(np.isin(cloud.ids.numpy(), ids[inside]))
        parts = concat([cloud[own], outer])
        return parts[torch.from_numpy(np.argsort(parts.ids.numpy(), kind="stable"))]

    def _added(
        self, now: NDArray[np.int64], old: NDArray[np.int64], cloud: GaussianCloud, step: int
    ) -> NDArray[np.int64]:
        """Ids of the added rows among each `step`-th of all, which come last."""
        added = now[now >= self.tiles.state.first_free]
        every = np.arange(0, self.count(cloud), step)
        return added[every[len(old) :] - (self.count(cloud) - len(added))]

    def _outer(self, ids: NDArray[np.int64], near: tuple[Tensor, float] | None) -> GaussianCloud:
        """The rows outside of the window with some ids."""
        homes = homes_of(self.tiles, ids)
        found = [GaussianCloud.empty(self.tiles.state.degree)]
        for k in np.unique(homes).tolist():
            if near is None or _distance(self.tiles, k, near[0]) <= near[1]:
                found.append(rows_with(self.tiles, k, ids[homes == k]))
        return concat(found)


def _distance(tiles: Tiles, number: int, point: Tensor) -> float:
    """Distance of a point `[3]` from the box of a tile, rounded down, scene units."""
    (low, high), place = _tile_box(tiles, number)[0], point.double().numpy()
    return float(np.linalg.norm(np.maximum(np.maximum(low - place, place - high), 0))) * (1 - 1e-5)


def nth_ids(tiles: Tiles, rows: NDArray[np.int64], lost: NDArray[np.int64]) -> NDArray[np.int64]:
    """The ids of the rows with some numbers `[M]`, ascending, in a scene without the ids `lost`; numbers beyond its end
    are left out."""
    state = tiles.state
    gone = np.asarray(files.mapped(tiles.folder / TABLES, state.gone, np.dtype("<i8"), (state.missing,)))
    gone = np.union1d(gone, lost)
    rows = rows[rows < state.first_free - len(gone)]
    # Of the ids that are gone the k-th has `gone[k] - k` present ones before it.
    return rows + np.searchsorted(gone - np.arange(len(gone)), rows, side="right")


def homes_of(tiles: Tiles, ids: NDArray[np.int64]) -> NDArray[np.int64]:
    """The tile of each of some ids that are present."""
    state, out = tiles.state, np.full(len(ids), -1, np.int64)
    early = np.flatnonzero(ids < state.listed)
    out[early] = files.rows(tiles.folder / TABLES, state.homes, np.dtype("<u4"), (), ids[early])
    late = np.flatnonzero(ids >= state.listed)
    for k in range(len(state.tiles)) if len(late) else ():
        own = tiles.column(k, "ids", checked=False)
        if len(own) and own[-1] >= state.listed:
            out[late[np.isin(ids[late], own)]] = k
    if (out < 0).any() or (out >= len(state.tiles)).any():
        raise FileError(f"{tiles.folder}: its list of homes does not fit its tiles: {files.ADVICE}")
    return out


def rows_with(tiles: Tiles, number: int, ids: NDArray[np.int64]) -> GaussianCloud:
    """The rows of a tile with some ids, ascending; few of them are read one by one.

    Raises:
        FileError: the tile is torn, or lacks one of them.
    """
    own = tiles.column(number, "ids", checked=False)
    rows = np.searchsorted(own, ids)
    if (rows >= len(own)).any() or (np.asarray(own[np.minimum(rows, len(own) - 1)]) != ids).any():
        raise FileError(f"{tiles.folder}: tile {number} lacks rows that the index says are in it: {files.ADVICE}")
    del own
    if len(ids) > _FEW:
        return tiles.cloud(number, rows)
    tile, found = tiles.state.tiles[number], {}
    for name in TILE_COLUMNS:
        column = files.rows(tiles.folder / TILES, tile.columns[name], *column_type(name, tiles.state.degree), rows)
        found[name] = torch.from_numpy(np.array(column))
    return GaussianCloud(**found, first_free=tiles.state.first_free, rest=None)


def centres(tiles: Tiles, step: int) -> NDArray[np.float32]:
    """`[M, 3]` the centres of each `step`-th row of the scene."""
    ids = nth_ids(tiles, np.arange(0, len(tiles), step), np.zeros(0, np.int64))
    homes, found = homes_of(tiles, ids), np.empty((len(ids), 3), np.float32)
    for k in np.unique(homes).tolist():
        mine = homes == k
        rows = np.searchsorted(tiles.column(k, "ids", checked=False), ids[mine])
        stored = tiles.state.tiles[k].columns["means"]
        found[mine] = files.rows(tiles.folder / TILES, stored, *column_type("means", tiles.state.degree), rows)
    return found


def outline(tiles: Tiles, rows: int = 50_000) -> Scene:
    """The scene with about so many of its rows, evenly spaced, each grown to cover what the others did: for views."""
    step = max(1, -(-len(tiles) // rows))
    empty = GaussianCloud.empty(tiles.state.degree)
    cloud = Beyond(tiles, empty.ids, empty.group.numpy()).evenly(empty, step)
    return tiles.scene(cloud.replace(scales=cloud.scales * float(np.sqrt(step))))


def things(tiles: Tiles, memory: int, most: int) -> Scene:
    """The scene with a sample of each thing, for what is measured on such samples: of the n rows of an object with its
    parts each `max(1, n // most)`-th by id, and of floor, walls and ceiling about as many; none without a group.

    Raises:
        UserError: they do not fit into the memory.
        FileError: a tile is torn.
    """
    field = tiles.field
    assert field is not None
    whole = np.array([*(g.parent if g.parent >= 0 else g.id for g in field.groups), NO_GROUP], np.int64)
    count, tiles_of = np.zeros(len(field.groups), np.int64), np.zeros(len(field.groups), np.int64)
    np.add.at(count, whole[:-1], tiles.sizes(len(field.groups)))
    numbers = range(len(tiles.state.tiles))
    for k in numbers:
        here = np.unique(whole[tiles.owners(k)[:, 0]])
        tiles_of[here[here >= 0]] += 1
    step = np.maximum(1, count // most)
    _require(tiles, int((count // step).sum()), memory)
    alone = (tiles_of == 1) | np.array([g.level == "structure" for g in field.groups], bool)
    taken, divided = {}, dict[int, list[NDArray[np.int64]]]()
    for k in numbers:
        thing = whole[np.asarray(tiles.column(k, "group"))]
        order = np.argsort(thing, kind="stable")
        starts = np.searchsorted(thing[order], thing[order])
        rank = np.empty(len(thing), np.int64)
        rank[order] = np.arange(len(thing)) - starts
        there = thing >= 0
        taken[k] = np.flatnonzero(there & alone[thing] & (rank % step[thing] == 0))
        ids = np.asarray(tiles.column(k, "ids"))
        for g in np.unique(thing[there & ~alone[thing]]).tolist():
            divided.setdefault(g, []).append(ids[thing == g])
    wanted = [np.sort(np.concatenate(parts))[:: step[g]] for g, parts in divided.items()]
    every = np.sort(np.concatenate([np.zeros(0, np.int64), *wanted]))
    for k in tiles.holding([leaf for g in divided for leaf in field.leaves(g)]):
        taken[k] = np.union1d(taken[k], np.flatnonzero(np.isin(tiles.column(k, "ids"), every)))
    return _window(tiles, taken, ()).scene


def merged(window: Window, after: LanguageField) -> LanguageField:
    """The table of the whole scene after its window's became `after`: of groups that do not lie in the window only the
    counts are taken."""
    before = window.tiles.field
    assert before is not None
    groups = list(after.groups)
    for old in before.groups:
        if not all(leaf in window.whole for leaf in before.leaves(old.id)):
            groups[old.id] = replace(old, count=groups[old.id].count)
    return replace(after, groups=tuple(groups))
