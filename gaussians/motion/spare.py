"""Columns of earlier moments, written again for the next one when nobody holds them any more.

A moment shares most rows of a column with the scene, but a tensor is one piece of memory: for a thing that turns, 38 MB
of harmonics would be copied for each frame of 200,000 Gaussians. A spare column has those rows already, and only the
rows of what moves are written. It is a pool of memory, not a change in place: who holds a tensor keeps it as it is.
"""

from __future__ import annotations

import sys
import threading
from dataclasses import dataclass, field

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..kept import Kept

_MOST_BYTES = 1 << 26  # of a column that is kept spare

Rows = Tensor | slice


@dataclass(eq=False)
class _Spare:
    """Memory of a column: equal to the column but for the rows that were written last."""

    array: NDArray[np.float32]
    written: list[Rows] = field(default_factory=list)


def _references(spare: _Spare) -> int:
    return sys.getrefcount(spare.array)


_ALONE = _references(_Spare(np.empty(0, np.float32)))  # of memory that no tensor and no other array holds
_spares: Kept[_Spare] = Kept(3)  # means, rotations and harmonics of one scene
_lock = threading.Lock()


def like(column: Tensor, written_next: Rows | None = None) -> tuple[Tensor, list[Rows]]:
    """A float32 column of one's own with the values of `column`, and a list of rows, to which every row that is written
    into it is to be added.

    Args:
        written_next: rows that are all written next: their values are arbitrary.
    """
    if column.device.type != "cpu" or column.dtype != torch.float32 or column.requires_grad:
        return column.clone(), []
    if column.numel() * 4 > _MOST_BYTES:
        return _copied(column, np.empty(tuple(column.shape), np.float32), written_next), []
    with _lock:
        fresh = _Spare(np.empty(0, np.float32))
        spare = _spares.get((column,), lambda: fresh)
        if spare is not fresh and _references(spare) <= _ALONE:
            out = torch.from_numpy(spare.array)  # from here on the tensor's memory holds the array
            for rows in spare.written:
                if not _same(rows, written_next):
                    out[rows] = column[rows]
        else:
            spare.array = np.empty(tuple(column.shape), np.float32)
            out = _copied(column, spare.array, written_next)
        spare.written = []
        return out, spare.written


def _same(rows: Rows, others: Rows | None) -> bool:
    """Whether both are surely the same rows."""
    return rows is others or (isinstance(rows, slice) and isinstance(others, slice) and rows == others)


def _copied(column: Tensor, array: NDArray[np.float32], left_out: Rows | None) -> Tensor:
    out = torch.from_numpy(array)
    if not isinstance(left_out, slice):
        return out.copy_(column)
    out[: left_out.start] = column[: left_out.start]
    out[left_out.stop :] = column[left_out.stop :]
    return out
