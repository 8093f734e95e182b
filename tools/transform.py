"""Translate, rotate and scale Gaussians: centres, orientations, extents and harmonics together."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..gaussians.cloud import GaussianCloud
from ..gaussians.harmonics import rotate as rotate_harmonics
from ..gaussians.rotations import from_matrix, multiply, normalize, to_matrix
from .cloud_diff import Draft

Array = NDArray[np.float64]
_SWEEPS = 8  # Jacobi converges quadratically; float32 columns are orthogonal after 4 or 5
_ROWS = 1 << 13  # Gaussians decomposed at a time: their columns stay in a core's cache


def stretch_matrix(axis: Array | None, factor: float) -> Array:
    """`[3, 3]` float64 scaling by `factor` along a unit axis, or in all directions for None."""
    return np.eye(3) * factor if axis is None else np.eye(3) + (factor - 1) * np.outer(axis, axis)


def shift(draft: Draft, rows: Tensor, offset: Array) -> None:
    """Add `offset` `[3]` (scene units) to the centres."""
    draft.map("means", rows, lambda means: affine(means, np.eye(3), offset))


def turn(draft: Draft, rows: Tensor, rotation: Array, offset: Array) -> None:
    """`x -> rotation @ x + offset` for centres; orientations and harmonics turn along."""
    spin = from_matrix(torch.from_numpy(rotation)).to(torch.float32)
    draft.map("means", rows, lambda means: affine(means, rotation, offset))
    draft.map("quats", rows, lambda quats: normalize(multiply(spin.to(quats.device), quats)))
    if draft.read("sh", rows[:1]).shape[1] > 1:
        draft.map("sh", rows, lambda sh: rotate_harmonics(sh, torch.from_numpy(rotation)))


def stretch(draft: Draft, rows: Tensor, matrix: Array, offset: Array) -> None:
    """`x -> matrix @ x + offset` for centres; each covariance becomes `matrix Σ matrixᵀ`.

    A multiple of the identity only scales the extents; for any other matrix the covariances are decomposed again (see
    `stretched`). Colours stay.
    """
    draft.map("means", rows, lambda means: affine(means, matrix, offset))
    factor = float(matrix[0, 0])
    if np.array_equal(matrix, np.eye(3) * factor):
        draft.map("scales", rows, lambda scales: scales * factor)
        return
    for block in torch.split(rows, _ROWS):
        quats, scales = stretched(draft.read("quats", block), draft.read("scales", block), matrix)
        draft.write("quats", block, quats)
        draft.write("scales", block, scales)


def affine(means: Tensor, matrix: Array, offset: Array) -> Tensor:
    """`[M, 3]` float32 centres under an affine map, computed in float64."""
    m = torch.from_numpy(np.asarray(matrix, dtype=np.float64)).to(means.device)
    t = torch.from_numpy(np.asarray(offset, dtype=np.float64)).to(means.device)
    return (means.to(torch.float64) @ m.T + t).to(torch.float32)


def transformed(cloud: GaussianCloud, matrix: Array, offset: Array) -> GaussianCloud:
    """A whole cloud under a similarity `x -> matrix @ x + offset`, matrix = scale times rotation."""
    factor = float(np.cbrt(np.linalg.det(matrix)))
    draft, rows = Draft(cloud), torch.arange(len(cloud), device=cloud.device)
    turn(draft, rows, matrix / factor, np.zeros(3))
    stretch(draft, rows, np.eye(3) * factor, offset)
    return draft.done()


def stretched(quats: Tensor, scales: Tensor, matrix: Array) -> tuple[Tensor, Tensor]:
    """Orientations `[M, 4]` and extents `[M, 3]` of Gaussians under a linear map.

    With Σ = R S² Rᵀ, the new covariance is (A R S)(A R S)ᵀ; the singular vectors and values of A R S are wanted.
    One-sided Jacobi rotations (Hestenes 1958) make the columns of A R S orthogonal without squaring them, so the thin
    axis of a flat Gaussian keeps its precision, which the eigenvalues of A Σ Aᵀ in float32 would lose.
    """
    a = torch.from_numpy(np.asarray(matrix)).to(quats.device, torch.float32)
    # Component-major, so that every operation below runs over contiguous rows: three columns [3, M].
    columns = [c.contiguous() for c in ((a @ to_matrix(quats)) * scales[:, None, :]).permute(2, 1, 0)]
    for _ in range(_SWEEPS):
        worst = 0.0
        for i, j in ((0, 1), (0, 2), (1, 2)):
            columns[i], columns[j], off = _orthogonalize(columns[i], columns[j])
            worst = max(worst, off)
        if worst < 1e-6:  # cosine between columns: float32 cannot do better
            break
    stacked = torch.stack(columns)  # [3 columns, 3, M]
    lengths = torch.linalg.vector_norm(stacked, dim=1).clamp(min=1e-20)
    order = lengths.argsort(dim=0, descending=True)
    big, mid = (stacked.gather(0, order[k].expand(1, 3, -1)).squeeze(0) for k in range(2))
    # The two longest columns are the most accurate; the third direction follows and is right-handed by construction.
    first = big / torch.linalg.vector_norm(big, dim=0).clamp(min=1e-20)
    third = torch.linalg.cross(first, mid, dim=0)
    third = third / torch.linalg.vector_norm(third, dim=0).clamp(min=1e-20)
    axes = torch.stack([first, torch.linalg.cross(third, first, dim=0), third], dim=2)  # [3, M, 3 axes]
    return normalize(from_matrix(axes.transpose(0, 1).contiguous())), lengths.gather(0, order).T.contiguous()


def _orthogonalize(x: Tensor, y: Tensor) -> tuple[Tensor, Tensor, float]:
    """Rotate columns `[3, M]` in their plane until they are orthogonal; also the largest cosine between them before."""
    xx, yy, xy = (p[0] * q[0] + p[1] * q[1] + p[2] * q[2] for p, q in ((x, x), (y, y), (x, y)))
    cosine = float((xy.abs() * (xx * yy).clamp(min=1e-38).rsqrt()).max()) if x.shape[1] else 0.0
    apart = xy == 0
    zeta = (yy - xx) / (2 * xy).masked_fill(apart, 1.0)
    t = torch.copysign(1 / (zeta.abs() + torch.sqrt(1 + zeta * zeta)), zeta).masked_fill(apart, 0.0)
    c = torch.rsqrt(1 + t * t)
    s = c * t
    return c * x - s * y, s * x + c * y, cosine
