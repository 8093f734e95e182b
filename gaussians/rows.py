"""Rows of large columns: allocate and copy them, find them by id, by a mask, and by where their centres lie.

Every function takes one pass over a column of a million Gaussians and runs at the speed of memory; `tests` hold each of
them against a plain loop.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from .kept import Kept

_DENSE = 8  # ids in a range of at most this many times the rows and ids are looked up in a table


def empty(shape: Sequence[int], like: Tensor) -> Tensor:
    """A tensor of a shape with arbitrary values, of the type and on the device of `like`.

    A column of a million Gaussians has 192 MB. In pages of 4 kB the system maps and clears 47,000 of them when the
    column is first written, which takes three times as long as copying the values. numpy asks for huge pages where the
    system gives them to those who ask (Linux, `madvise`); torch does not.
    """
    if like.device.type != "cpu":
        return like.new_empty(tuple(shape))
    return torch.from_numpy(np.empty(tuple(shape), dtype=np.dtype(str(like.dtype).removeprefix("torch."))))


def copied(column: Tensor) -> Tensor:
    """A contiguous copy of a tensor."""
    return empty(column.shape, column).copy_(column)


def taken(column: Tensor, rows: Tensor) -> Tensor:
    """`[M, ...]`, a copy of the rows `[M]` of a tensor `[N, ...]`."""
    if column.requires_grad:
        return column.index_select(0, rows)
    return torch.index_select(column, 0, rows, out=empty((len(rows), *column.shape[1:]), column))


def rows_where(mask: Tensor) -> Tensor:
    """`[M]` int64 rows at which a mask `[N]` is set, ascending; ten times faster than `Tensor.nonzero` on a CPU."""
    if mask.device.type != "cpu":
        return mask.nonzero().squeeze(1)
    return torch.from_numpy(np.flatnonzero(mask.numpy()))


def rows_within(points: Tensor, low: NDArray[np.floating], high: NDArray[np.floating]) -> Tensor:
    """`[M]` int64 rows of points `[N, 3]` from the corner `low` to the corner `high` `[3]`, ascending.

    The corners are rounded outwards to float32.
    """
    lower = np.nextafter(np.asarray(low, dtype=np.float32), np.float32(-np.inf))
    upper = np.nextafter(np.asarray(high, dtype=np.float32), np.float32(np.inf))
    columns = points.detach().cpu().numpy().T
    found = np.flatnonzero((columns[0] >= lower[0]) & (columns[0] <= upper[0]))
    for axis in (1, 2):
        values = columns[axis][found]
        found = found[(values >= lower[axis]) & (values <= upper[axis])]
    return torch.from_numpy(found).to(points.device)


class Span(NamedTuple):
    """The smallest and the largest of some ids, and whether they ascend by one from row to row."""

    low: int
    high: int
    counted: bool


_spans: Kept[Span] = Kept(8)


def span_of(ids: Tensor) -> Span:
    """The span of a column of ids `[N]`, N > 0. Columns are never written in place, so it is measured once."""
    return _spans.get((ids,), lambda: _span(ids))


def _span(ids: Tensor) -> Span:
    low, high = (int(v) for v in torch.aminmax(ids))
    # N distinct ids within N numbers are counted if they ascend.
    return Span(low, high, high - low == len(ids) - 1 and _ascends(ids))


def mask_of_ids(column: Tensor, ids: Tensor) -> Tensor:
    """Whether each id of a column `[N]` is one of `ids` `[M]`, in any order; `[N]` bool.

    Ids are nearly always the row numbers of a file, in order, with the gaps that deletions leave.
    """
    found = torch.zeros(len(column), dtype=torch.bool, device=column.device)
    if not len(ids) or not len(column):
        return found
    ids, (low, high, counted) = ids.to(column.device), span_of(column)
    if not counted and high - low >= _DENSE * (len(column) + len(ids)):
        return torch.isin(column, ids)
    here = _between(ids, low, high) - low
    if counted:
        found[here] = True
        return found
    # A table of flags is 15 times faster than sorting.
    flags = torch.zeros(high - low + 1, dtype=torch.bool, device=column.device)
    flags[here] = True
    return flags[column - low]


def rows_of_ids(column: Tensor, ids: Tensor) -> Tensor:
    """`[K]` int64 rows of a column `[N]` whose id is one of `ids` `[M]`, ascending."""
    if len(ids) and len(column) and span_of(column).counted and _ascends(ids):
        low, high, _ = span_of(column)
        return _between(ids.to(column.device), low, high) - low
    return rows_where(mask_of_ids(column, ids))


def _between(ids: Tensor, low: int, high: int) -> Tensor:
    """Those of some ids, not empty, that lie between two numbers, these included."""
    least, most = (int(v) for v in torch.aminmax(ids))
    return ids if low <= least and most <= high else ids[(ids >= low) & (ids <= high)]


def _ascends(ids: Tensor) -> bool:
    return bool((ids[1:] > ids[:-1]).all())
