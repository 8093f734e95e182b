"""Rows of a cloud moved by a rigid map, with their rotations and harmonics, into columns of one's own.

`carry` takes compiled kernels for float32 columns on the CPU; `carry_by_tensors` says the same in torch, on any device.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..harmonics import matrices, turned, turning
from ..rotations import from_matrix, multiply

F64 = NDArray[np.float64]
Pair = tuple[Tensor, Tensor]  # a column to read, and the one to write

_BLOCK = 1 << 13  # rows changed at a time: intermediates stay in a core's cache


def carry(rows: Tensor, means: Pair, quats: Pair, sh: Pair | None, turn: F64, shift: F64) -> None:
    """Read rows of columns and write them, moved by `x -> turn @ x + shift`, to the same rows of other columns.

    Other rows stay as they are, and both columns of a pair may be the same.

    Args:
        rows: `[M]` int64, all different.
        means: `[N, 3]`, scene units.
        quats: `[N, 4]`, wxyz.
        sh: `[N, K, 3]`; None if they do not depend on the view.
        turn: `[3, 3]` rotation.
        shift: `[3]`, scene units.

    Raises:
        UserError: `turn` is not a rotation.
    """
    pairs = [means, quats] if sh is None else [means, quats, sh]
    if not all(_plain(column) for pair in pairs for column in pair):
        carry_by_tensors(rows, means, quats, sh, turn, shift)
        return
    from ..render.cpu import carry as kernels  # loads the compiler

    empty = torch.zeros(0, 1, 3)
    sources, targets = (tuple(pair[side].numpy() for pair in (means, quats, sh or (empty, empty))) for side in (0, 1))
    found = matrices(turn, sources[2].shape[1])
    bands = np.concatenate([np.zeros(0), *(matrix.ravel() for matrix in found)]).astype(np.float32)
    spots = np.ascontiguousarray(rows.numpy())
    factors = np.ascontiguousarray(turn), np.ascontiguousarray(shift), _product(turn), np.repeat(bands, kernels.WIDE)
    kernels.run(kernels.carry, spots, sources, targets, *factors)


def shift_means(rows: Tensor, means: Pair, shift: F64) -> None:
    """As `carry`, of means that are moved by `shift` alone."""
    source, target = means
    if not (_plain(source) and _plain(target)):
        away = torch.from_numpy(shift).to(source.device)
        target.index_copy_(0, rows, (source.index_select(0, rows).double() + away).to(target.dtype))
        return
    from ..render.cpu import carry as kernels

    spots = np.ascontiguousarray(rows.numpy())
    kernels.run(kernels.shift_means, spots, source.numpy(), target.numpy(), np.ascontiguousarray(shift))


def carry_by_tensors(rows: Tensor, means: Pair, quats: Pair, sh: Pair | None, turn: F64, shift: F64) -> None:
    """As `carry`, in torch: the readable reference, and the way for other devices."""
    matrix, away = (torch.from_numpy(part).to(means[0].device) for part in (turn, shift))
    product = torch.from_numpy(_product(turn)).to(quats[0])
    harmonics = None if sh is None else turning(matrix, int(sh[0].shape[1])).to(sh[0])
    for block in torch.split(rows, _BLOCK):
        # float64: a point far from the origin is turned to the last bit of its float32
        there = means[0].index_select(0, block).double() @ matrix.T + away
        means[1].index_copy_(0, block, there.to(means[1].dtype))
        quats[1].index_copy_(0, block, quats[0].index_select(0, block) @ product)
        if sh is not None and harmonics is not None:
            sh[1].index_copy_(0, block, turned(sh[0].index_select(0, block), harmonics))


def _product(turn: F64) -> NDArray[np.float32]:
    """`[4, 4]`: the product of the turn's quaternion and another is linear in that one; row i is what it makes of the
    i-th basis quaternion."""
    quat = from_matrix(torch.from_numpy(turn))
    return multiply(quat, torch.eye(4, dtype=torch.float64)).numpy().astype(np.float32)


def _plain(column: Tensor) -> bool:
    """Whether kernels can take a column."""
    fits = column.device.type == "cpu" and column.dtype == torch.float32 and column.is_contiguous()
    return fits and not column.requires_grad
