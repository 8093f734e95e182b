"""Rotations as unit quaternions in wxyz order, batched over leading axes; and as a matrix about an axis.

A quaternion and its negative are the same rotation. All functions return new tensors. Harmonics are rotated by
`harmonics.rotate`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from .errors import UserError

IDENTITY = (1.0, 0.0, 0.0, 0.0)


def axis_rotation(axis: NDArray[np.float64], degrees: float) -> NDArray[np.float64]:
    """`[3, 3]` float64 rotation about an axis, counter-clockwise seen from its tip (Rodrigues)."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = math.radians(degrees)
    return np.asarray(np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross)


def normalize(quats: Tensor) -> Tensor:
    """`[..., 4]` scaled to unit length; rows that are zero or not finite become the identity."""
    length = torch.linalg.vector_norm(quats, dim=-1, keepdim=True)
    # A denormal or infinite length has no usable direction; 1e-30 leaves room for float32 squares below it.
    usable = torch.isfinite(length) & (length > 1e-30)
    identity = quats.new_tensor(IDENTITY).expand_as(quats)
    return torch.where(usable, quats / torch.where(usable, length, torch.ones_like(length)), identity)


def multiply(left: Tensor, right: Tensor) -> Tensor:
    """Hamilton product `[..., 4]`: the rotation that applies `right` first, then `left`. Broadcasts."""
    w1, x1, y1, z1 = left.unbind(-1)
    w2, x2, y2, z2 = right.unbind(-1)
    return torch.stack(
        [
            w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2,
            w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2,
            w1 * y2 - x1 * z2 + y1 * w2 + z1 * x2,
            w1 * z2 + x1 * y2 - y1 * x2 + z1 * w2,
        ],
        dim=-1,
    )


def to_matrix(quats: Tensor) -> Tensor:
    """Rotation matrices `[..., 3, 3]` (column vectors: `x_world = M @ x_local`) of unit quaternions `[..., 4]`."""
    w, x, y, z = quats.unbind(-1)
    rows = [
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
    ]  # fmt: skip
    return torch.stack(rows, dim=-1).reshape(*quats.shape[:-1], 3, 3)


def from_matrix(matrices: Tensor) -> Tensor:
    """Unit quaternions `[..., 4]` with w >= 0 of rotation matrices `[..., 3, 3]`.

    Each component gives one way to recover the others; the largest one is used, so no half-turn loses precision
    (Shepperd 1978).
    """
    m = matrices
    xx, yy, zz = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    four_squares = torch.stack([1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz], dim=-1)
    wx, wy, wz = m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]
    xy, xz, yz = m[..., 0, 1] + m[..., 1, 0], m[..., 0, 2] + m[..., 2, 0], m[..., 1, 2] + m[..., 2, 1]
    # Row i is 4 * q_i * (w, x, y, z).
    ww, qx, qy, qz = four_squares.unbind(-1)
    table = torch.stack(
        [
            torch.stack([ww, wx, wy, wz], dim=-1),
            torch.stack([wx, qx, xy, xz], dim=-1),
            torch.stack([wy, xy, qy, yz], dim=-1),
            torch.stack([wz, xz, yz, qz], dim=-1),
        ],
        dim=-2,
    )
    best = four_squares.argmax(dim=-1)
    picked = torch.take_along_dim(table, best[..., None, None].expand(*best.shape, 1, 4), dim=-2).squeeze(-2)
    quats = normalize(picked)
    return torch.where(quats[..., :1] < 0, -quats, quats)


def from_axis_angle(axis: Tensor | Sequence[float], radians: Tensor | float) -> Tensor:
    """Unit quaternions `[..., 4]` of a rotation by `radians` about `axis` `[..., 3]`, counter-clockwise from its tip.

    Raises:
        UserError: an axis is zero or not finite.
    """
    axis_ = torch.as_tensor(axis, dtype=None if isinstance(axis, Tensor) else torch.float64)
    half = torch.as_tensor(radians, dtype=axis_.dtype, device=axis_.device)[..., None] / 2
    length = torch.linalg.vector_norm(axis_, dim=-1, keepdim=True)
    if not bool((torch.isfinite(length) & (length > 0)).all()):
        raise UserError(f"a rotation axis must be finite and not zero, got {axis_.tolist()}")
    half = half + torch.zeros_like(length)  # broadcast: one angle per axis
    return torch.cat([torch.cos(half), torch.sin(half) * (axis_ / length)], dim=-1)
