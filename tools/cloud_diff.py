"""Rows of a cloud: find them by id, write some of them, and compare two clouds bit for bit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import torch
from torch import Tensor

from ..gaussians.cloud import GaussianCloud
from ..gaussians.kept import Kept
from ..gaussians.language.query.selection import Selection, mask_of
from ..gaussians.rows import copied, empty, rows_of_ids, rows_where, span_of

_ROWS = 1 << 13  # rows written at a time: intermediates stay in a core's cache, whatever the cloud's size
_BYTES = 1 << 19  # bytes compared at a time: they stay in a core's cache

_apart: Kept[Tensor] = Kept(4)


def rows_of(cloud: GaussianCloud, ids: Tensor) -> Tensor:
    """`[M]` int64 rows of `cloud` that have one of these ids, ascending."""
    return rows_of_ids(cloud.ids, ids)


def fresh_ids(cloud: GaussianCloud, count: int) -> Tensor:
    """`[count]` int64 ids above every id of `cloud`, those of deleted Gaussians included."""
    first = _first_free(cloud)
    return torch.arange(first, first + count, dtype=torch.int64, device=cloud.device)


def without(cloud: GaussianCloud, gone: Tensor) -> GaussianCloud:
    """The rows of a cloud outside the mask `gone` `[N]`, whose ids are given to nothing else."""
    return cloud[~gone].replace(first_free=_first_free(cloud), rest=cloud.rest)


def _first_free(cloud: GaussianCloud) -> int:
    return max(cloud.first_free, span_of(cloud.ids).high + 1 if len(cloud) else 0)


def selection_of(selection: Selection, ids: Tensor, groups: tuple[int, ...], reason: str) -> Selection:
    """A selection of other Gaussians with the verdict "found" that keeps the query of `selection`."""
    return Selection(selection.query, "found", ids.sort().values, groups, (), reason)


def joined(cloud: GaussianCloud, without: Tensor | None, added: list[GaussianCloud]) -> GaussianCloud:
    """The rows of a cloud outside the mask `without` `[N]`, then the added clouds; each column is written once.

    The added clouds have the cloud's degree and ids above its own (see `fresh_ids`).
    """
    keep = None if without is None else rows_where(~without)
    n = len(cloud) if keep is None else len(keep)
    columns: dict[str, Tensor] = {}
    for name, column in cloud.columns():
        out = empty((n + sum(len(c) for c in added), *column.shape[1:]), column)
        if keep is None:
            out[:n] = column
        else:
            torch.index_select(column, 0, keep, out=out[:n])
        torch.cat([getattr(c, name) for c in added], out=out[n:])
        columns[name] = out
    return GaussianCloud(**columns, first_free=max(_first_free(c) for c in (cloud, *added)), rest=cloud.rest)


class Draft:
    """A cloud being edited, copy on write: a column is copied the first time it is written and shared otherwise.

    The cloud it was made from is never written to.
    """

    def __init__(self, cloud: GaussianCloud) -> None:
        self._cloud = cloud
        self._written: dict[str, Tensor] = {}

    def read(self, name: str, rows: Tensor) -> Tensor:
        """A copy of some rows of a column, as they are now."""
        return self._column(name).index_select(0, rows)

    def write(self, name: str, rows: Tensor, values: Tensor) -> None:
        """Set rows `[M]` of a column to `[M, ...]`."""
        if name not in self._written:
            self._written[name] = copied(getattr(self._cloud, name))
        self._written[name].index_copy_(0, rows, values.to(self._written[name].dtype))

    def map(self, name: str, rows: Tensor, change: Callable[[Tensor], Tensor]) -> None:
        """Replace rows of a column by `change` of them, a block at a time so that intermediates stay small."""
        if len(rows) == len(self._cloud) and bool((rows == torch.arange(len(rows), device=rows.device)).all()):
            self._map_all(name, change)
            return
        for block in torch.split(rows, _ROWS):
            self.write(name, block, change(self.read(name, block)))

    def _map_all(self, name: str, change: Callable[[Tensor], Tensor]) -> None:
        """Replace a whole column, a block at a time: no row is looked up, and nothing is copied first."""
        column = self._column(name)
        out = empty(column.shape, column)
        for start in range(0, len(column), _ROWS):
            out[start : start + _ROWS] = change(column[start : start + _ROWS])
        self._written[name] = out

    def done(self) -> GaussianCloud:
        """The edited cloud."""
        return self._cloud.replace(**self._written) if self._written else self._cloud

    def _column(self, name: str) -> Tensor:
        column: Tensor = self._written.get(name, getattr(self._cloud, name))
        return column


@dataclass(frozen=True)
class Difference:
    """How a cloud differs from the one before, row by row.

    Attributes:
        outside: number of rows that were not allowed to change and changed in any bit of any column, or were removed.
        columns: columns in which some remaining row changed.
        bad_ids: number of added rows whose id is not above every earlier id, or is not unique.
        kept: `[K]` int64 rows of the cloud before that were not removed; None: all of them.
        changed: by column that changed, `[K]` bool: which of the kept rows did.
    """

    outside: int
    columns: tuple[str, ...]
    bad_ids: int
    kept: Tensor | None = None
    changed: Mapping[str, Tensor] = field(default_factory=dict)


def difference(before: GaussianCloud, after: GaussianCloud, allowed: Tensor, removed: Tensor) -> Difference:
    """Compare two clouds bit for bit. Remaining rows must keep their order; added rows must come last.

    Args:
        allowed: `[N]` bool over `before`, rows that may change or be removed.
        removed: ids that were removed.
    """
    gone = mask_of(before, removed)
    kept = None if not bool(gone.any()) else rows_where(~gone)
    n = len(before) if kept is None else len(kept)
    if len(after) < n:
        return Difference(int((~allowed).sum()), ("ids",), 0)
    differs = torch.zeros(n, dtype=torch.bool, device=before.device)
    changed: dict[str, Tensor] = {}
    for name, column in before.columns():
        other = getattr(after, name)
        if column is other:
            continue
        mask = rows_apart(column, other) if kept is None else marked(column, other, kept)
        if bool(mask.any()):
            changed[name] = mask
            differs |= mask
    where = rows_where(differs)
    outside = int((~allowed[where if kept is None else kept[where]]).sum())
    lost = int((gone & ~allowed).sum())
    added = after.ids[n:]
    top = span_of(before.ids).high if len(before) else -1
    bad_ids = int((added <= top).sum()) + len(added) - len(torch.unique(added))
    return Difference(lost + outside, tuple(changed), bad_ids, kept, changed)


def rows_apart(column: Tensor, other: Tensor) -> Tensor:
    """`[K]` bool: in which of its rows a column differs from the first K of another in any bit. Measured once: columns
    are never written in place, and neither is this."""
    return _apart.get((column, other), lambda: marked(column, other))


def marked(column: Tensor, other: Tensor, kept: Tensor | None = None, others: Tensor | None = None) -> Tensor:
    """`[K]` bool: where the rows of two columns differ in any bit.

    Args:
        kept: `[K]` int64, the rows of `column` that are compared; None: all.
        others: `[K]` int64, the rows of `other` that they are compared with; None: the first K.
    """
    differs = torch.zeros(len(column) if kept is None else len(kept), dtype=torch.bool, device=column.device)
    if column.shape[1:] != other.shape[1:]:
        return differs.fill_(True)
    step = max(1, _BYTES // (column.element_size() * max(1, column[0].numel() if len(column) else 1)))
    for start in range(0, len(differs), step):
        end = min(start + step, len(differs))
        a = column[start:end] if kept is None else column.index_select(0, kept[start:end])
        b = other[start:end] if others is None else other.index_select(0, others[start:end])
        a, b = _bits(a), _bits(b)
        if not torch.equal(a, b):
            apart = (a != b).reshape(end - start, -1)
            if apart.shape[1] % 8 == 0:  # eight flags at a time
                apart = apart.view(torch.int64)
            differs[start:end] = apart.any(dim=1)
    return differs


def _bits(values: Tensor) -> Tensor:
    """Floats as integers, so that NaN equals itself and -0 differs from 0."""
    return values.view(torch.int32) if values.dtype == torch.float32 else values
