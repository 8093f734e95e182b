"""What the page shows at one revision (`Shown`), and in which slots and columns two of them differ.

A column that no edit touched is the same tensor in both clouds, so most are told apart without looking at a number.
N: Gaussians; M: slots that changed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.cloud import GaussianCloud
from ...gaussians.scene import Scene
from ...tools.cloud_diff import marked, rows_apart
from .columns import I32, SOURCES, columns_of, owners
from .slots import EMPTY, I64, Slots

Changes = dict[str, I64]  # by column, its slots that changed, ascending
Side = tuple[GaussianCloud, I64 | None]  # a cloud, and its rows of the Gaussians that stay; None: all of them


@dataclass(frozen=True, eq=False)
class Shown:
    """A scene with its slots.

    Attributes:
        revision: counts the changes that were shown.
        scene: the scene.
        slots: where its Gaussians are.
    """

    revision: int
    scene: Scene
    slots: Slots

    @classmethod
    def first(cls, scene: Scene, revision: int = 0) -> Shown:
        """A scene that nothing was shown of before."""
        return cls(revision, scene, Slots.of(scene.cloud))

    def then(self, scene: Scene) -> Shown:
        """The same view of a changed scene, one revision later."""
        return Shown(self.revision + 1, scene, self.slots.moved_to(scene.cloud))

    @cached_property
    def owner(self) -> I32:
        """`[G + 1]`, see `columns.owners`."""
        return owners(self.scene)

    @property
    def degree(self) -> int:
        return self.scene.cloud.degree


def changes(before: Shown, after: Shown) -> Changes | None:
    """The slots of each column whose bytes may differ; None if the page needs everything anew.

    An empty slot is told by its opacity and its group; its other columns keep what they held.
    """
    if before.degree != after.degree:
        return None
    pairs = _pairs(before.slots, after.slots)
    old, new = ((s.scene.cloud, rows) for s, rows in zip((before, after), pairs or (None, None), strict=True))
    differing = {name: _differing(old, new, name) for name, _ in after.scene.cloud.columns()}
    stay = after.slots.slot if pairs is None else after.slots.slot[pairs[1]]
    found: Changes = {}
    for column in columns_of(after.degree):
        apart = [
            differing[name] if name != "sh" else _of_bands(column, old, new, differing[name], after.degree)
            for name in SOURCES[column]
        ]
        if column == "group":
            apart = [_of_owners(before, after, old, new, apart[0])]
        found[column] = stay[np.concatenate(apart)]
    if pairs is not None:
        was, now = (np.zeros(after.slots.count, bool) for _ in range(2))
        was[before.slots.slot] = True
        now[after.slots.slot] = True
        now_other = now.copy()
        now_other[stay] = False  # new, in an empty slot or in that of one that is gone
        gone = np.flatnonzero(was & ~now)
        for column in found:
            emptied = gone if column in ("color", "group") else gone[:0]
            found[column] = np.concatenate([found[column], np.flatnonzero(now_other), emptied])
    return {column: np.unique(slots) for column, slots in found.items() if len(slots)}


def _pairs(before: Slots, after: Slots) -> tuple[I64, I64] | None:
    """Rows `[K]` before and after of the Gaussians that stay; None if they are all rows, in the same order."""
    if before.slot is after.slot:
        return None
    where = np.full(max(before.count, after.count), EMPTY, np.int64)
    where[before.slot] = np.arange(len(before.slot))
    rows = where[after.slot]
    same = rows != EMPTY
    same[same] = before.ids.numpy()[rows[same]] == after.ids.numpy()[same]
    stay = np.flatnonzero(same)
    return rows[stay], stay


def _differing(old: Side, new: Side, name: str) -> I64:
    """Positions `[M]` among the Gaussians that stay at which a column of the clouds differs."""
    (a, kept), (b, others) = ((getattr(cloud, name), rows) for cloud, rows in (old, new))
    if a is b:
        return np.zeros(0, np.int64)
    if kept is None or others is None:
        return np.flatnonzero(rows_apart(a, b).numpy())
    return np.flatnonzero(marked(a, b, torch.from_numpy(kept), torch.from_numpy(others)).numpy())


def _of_bands(column: str, old: Side, new: Side, apart: I64, degree: int) -> I64:
    """Those of the positions `[M]` at which harmonics differ, at which those do that a column of the page holds."""
    if not degree or not len(apart):
        return apart
    bands = slice(0, 1) if column == "color" else slice(1, None)
    a, b = (_at(side, "sh", apart)[:, bands] for side in (old, new))
    return apart[(a != b).any(axis=(1, 2))]


def _of_owners(before: Shown, after: Shown, old: Side, new: Side, apart: I64) -> I64:
    """The positions `[M]` of the Gaussians that stay and belong to another thing; their groups differ at `apart`."""
    known = min(len(before.owner), len(after.owner))
    if not np.array_equal(before.owner[:known], after.owner[:known]):
        apart = np.arange(len(new[0]) if new[1] is None else len(new[1]))
    a, b = (s.owner[_at(side, "group", apart) + 1] for s, side in ((before, old), (after, new)))
    return apart[a != b]


def _at(side: Side, name: str, positions: I64) -> NDArray[Any]:
    """A column at some of the Gaussians that stay."""
    cloud, rows = side
    index = positions if rows is None else rows[positions]
    return getattr(cloud, name).index_select(0, torch.from_numpy(index)).numpy()
