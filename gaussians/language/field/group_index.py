"""An index from groups to rows of a cloud, and set operations on sorted ids.

The rows of a cloud are sorted by group when it is first queried (0.06 s for a million Gaussians, 6 bytes each); every
later query takes a slice. A cloud is frozen, so the index stays valid; an edit that keeps groups and ids shares these
columns and with them the index.
"""

from __future__ import annotations

import weakref
from collections import OrderedDict
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...cloud import GaussianCloud

_DENSE = 8  # ids in a range of at most this many times their number are combined in a table of flags
_TABLE = 1 << 22  # flags; a table up to this size takes less time than sorting many ids
_SCAN_SHARE = 1 / 32  # of the rows, from which a scan of all rows is faster than sorting the slices
_IDS_KEPT = 2_000_000  # ids of selections that are kept, 8 bytes each
_KEPT = 4  # clouds whose index is cached: the present one, those of undo, and some for comparison


@dataclass(frozen=True, eq=False)
class GroupIndex:
    """The rows of a cloud by group.

    Attributes:
        column: `[N]` integer, the group of each row plus one: 0 is none.
        order: `[N]` int32, rows sorted by group, ascending within one.
        starts: `[G + 2]`, start of group g in `order` at `starts[g + 1]`, of the rows without a group at `starts[0]`.
        ids: `[N]` int64, `cloud.ids`.
    """

    column: NDArray[np.int16] | NDArray[np.int32]
    order: NDArray[np.int32]
    starts: NDArray[np.int64]
    ids: Tensor

    @cached_property
    def ascending(self) -> bool:
        """Whether ids ascend with the rows, as in a loaded file."""
        return len(self.ids) < 2 or bool((self.ids[1:] > self.ids[:-1]).all())

    @cached_property
    def every_id(self) -> Tensor:
        """`[N]` int64, all ids in ascending order."""
        return self.ids if self.ascending else self.ids.sort().values

    def rows(self, groups: Iterable[int]) -> NDArray[np.int64]:
        """Rows `[M]` int64 of some groups, ascending; `NO_GROUP` stands for the rows without a group."""
        wanted = [g + 1 for g in sorted(set(groups)) if g + 2 < len(self.starts)]
        if sum(int(self.starts[w + 1] - self.starts[w]) for w in wanted) >= _SCAN_SHARE * len(self.order):
            table = np.zeros(len(self.starts) - 1, bool)
            table[wanted] = True
            return np.flatnonzero(table[self.column])
        slices = [self.order[self.starts[w] : self.starts[w + 1]] for w in wanted]
        if len(slices) < 2:
            return slices[0].astype(np.int64) if slices else np.zeros(0, np.int64)
        return np.sort(np.concatenate(slices)).astype(np.int64)

    def ids_of(self, groups: Iterable[int]) -> Tensor:
        """Ids `[M]` int64 of the Gaussians of some groups, ascending; those of the groups asked last are kept."""
        key = tuple(sorted(set(groups)))
        if key in self._asked:
            self._asked.move_to_end(key)
            return self._asked[key]
        found = self.ids_at(self.rows(key))
        self._asked[key] = found
        while len(self._asked) > 1 and sum(map(len, self._asked.values())) > _IDS_KEPT:
            self._asked.popitem(last=False)
        return found

    @cached_property
    def _asked(self) -> OrderedDict[tuple[int, ...], Tensor]:
        return OrderedDict()

    def ids_but(self, groups: Iterable[int]) -> Tensor:
        """Ids `[M]` int64 of all Gaussians except those of some groups, ascending."""
        table = np.ones(len(self.starts) - 1, bool)
        table[[g + 1 for g in set(groups) if g + 2 < len(self.starts)]] = False
        return self.ids_at(np.flatnonzero(table[self.column]))

    def ids_at(self, rows: NDArray[np.int64]) -> Tensor:
        """Ids `[M]` int64 of ascending rows, ascending."""
        index = torch.from_numpy(rows).to(self.ids.device)
        if self._consecutive:
            return index + self.ids[:1]
        found = self.ids[index]
        return found if self.ascending else found.sort().values

    def present(self, ids: Tensor) -> Tensor:
        """The subset of some ascending ids that the cloud contains."""
        if not len(self.ids) or not len(ids):
            return ids[:0]
        if self._consecutive:
            first, last = int(self.ids[0]), int(self.ids[-1])
            if int(ids[0]) >= first and int(ids[-1]) <= last:
                return ids
        every, asked = self.every_id.cpu().numpy(), ids.cpu().numpy()
        place = np.minimum(np.searchsorted(every, asked), len(every) - 1)
        return ids[torch.from_numpy(every[place] == asked).to(ids.device)]

    @cached_property
    def _consecutive(self) -> bool:
        """Whether ids are consecutive in row order, so that they are row numbers plus an offset."""
        return self.ascending and len(self.ids) > 0 and int(self.ids[-1] - self.ids[0]) == len(self.ids) - 1


_known: OrderedDict[tuple[int, int], tuple[weakref.ref[Tensor], weakref.ref[Tensor], GroupIndex]] = OrderedDict()


def index_groups(cloud: GaussianCloud) -> GroupIndex:
    """The index of a cloud's groups, built on the first call for its `group` and `ids` columns."""
    key = (id(cloud.group), id(cloud.ids))
    if (known := _known.get(key)) is not None and known[0]() is cloud.group and known[1]() is cloud.ids:
        _known.move_to_end(key)
        return known[2]
    made = _build(cloud)
    _known[key] = (weakref.ref(cloud.group), weakref.ref(cloud.ids), made)
    while len(_known) > _KEPT:
        _known.popitem(last=False)
    return made


def _build(cloud: GaussianCloud) -> GroupIndex:
    column = cloud.group.cpu().numpy() + 1
    groups = int(column.max(initial=0)) + 1
    narrow = column.astype(np.int16) if groups < np.iinfo(np.int16).max else column  # radix sort for 16 bits
    order = np.argsort(narrow, kind="stable").astype(np.int32)
    counts = np.bincount(column, minlength=groups)
    return GroupIndex(narrow, order, np.concatenate([[0], np.cumsum(counts)]), cloud.ids)


def union(a: Tensor, b: Tensor) -> Tensor:
    """Union `[K]` of two ascending sets of ids without repeats, ascending."""
    if not len(a) or not len(b):
        return b if not len(a) else a
    one, other, low, width = _aligned(a, b)
    if width >= max(_DENSE * (len(a) + len(b)), _TABLE):
        both = np.sort(np.concatenate([one, other]))
        return torch.from_numpy(both[np.append(True, both[1:] != both[:-1])]).to(a.device)
    flags = np.zeros(width, bool)
    flags[one - low] = True
    flags[other - low] = True
    return torch.from_numpy(np.flatnonzero(flags) + low).to(a.device)


def difference(a: Tensor, b: Tensor) -> Tensor:
    """Ids `[K]` of `a` that are not in `b`, ascending; both are ascending sets without repeats."""
    if not len(a) or not len(b):
        return a
    one, other, low, width = _aligned(a, b)
    if width >= max(_DENSE * (len(a) + len(b)), _TABLE):
        place = np.minimum(np.searchsorted(other, one), len(other) - 1)
        return torch.from_numpy(one[other[place] != one]).to(a.device)
    flags = np.zeros(width, bool)
    flags[one - low] = True
    flags[other - low] = False
    return torch.from_numpy(np.flatnonzero(flags) + low).to(a.device)


def _aligned(a: Tensor, b: Tensor) -> tuple[NDArray[np.int64], NDArray[np.int64], int, int]:
    """Both as arrays, the smallest id of either, and the length of the range of ids."""
    low, high = min(int(a[0]), int(b[0])), max(int(a[-1]), int(b[-1]))
    return a.cpu().numpy(), b.cpu().numpy(), low, high - low + 1
