"""Real spherical harmonics up to degree 3: evaluation, rotation, and conversion between colour and the constant band.

Band order and signs are those of Kerbl et al. 2023 (the polynomials of Sloan, "Stupid Spherical Harmonics Tricks",
2008, with the Condon-Shortley signs): band l holds 2l + 1 coefficients; band 1 is (-y, z, -x).
Coefficients are `[..., K, 3]`, K = (degree + 1)^2; directions run from the eye to the Gaussian, world frame.
"""

from __future__ import annotations

import functools
import math

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from .cloud import SH_BANDS
from .errors import UserError

SH_C0 = 0.28209479177387814  # sqrt(1 / 4 pi)
_C1 = 0.4886025119029199  # sqrt(3 / 4 pi)
_C2 = (
    1.0925484305920792,
    0.31539156525252005,
    0.5462742152960396,
)  # sqrt(15 / 4 pi), sqrt(5 / 16 pi), sqrt(15 / 16 pi)
# sqrt(35 / 32 pi), sqrt(105 / 4 pi), sqrt(21 / 32 pi), sqrt(7 / 16 pi), sqrt(105 / 16 pi)
_C3 = (0.5900435899266435, 2.890611442640554, 0.4570457994644658, 0.3731763325901154, 1.445305721320277)


def basis(directions: Tensor, degree: int) -> Tensor:
    """The basis functions at unit directions `[..., 3]`, as `[..., K]` with K = (degree + 1)^2."""
    x, y, z = directions.unbind(-1)
    values = [torch.full_like(x, SH_C0)]
    if degree >= 1:
        values += [-_C1 * y, _C1 * z, -_C1 * x]
    if degree >= 2:
        xx, yy, zz = x * x, y * y, z * z
        values += [
            _C2[0] * x * y, -_C2[0] * y * z, _C2[1] * (2 * zz - xx - yy), -_C2[0] * x * z, _C2[2] * (xx - yy),
        ]  # fmt: skip
    if degree >= 3:
        values += [
            -_C3[0] * y * (3 * xx - yy),
            _C3[1] * x * y * z,
            -_C3[2] * y * (4 * zz - xx - yy),
            _C3[3] * z * (2 * zz - 3 * xx - 3 * yy),
            -_C3[2] * x * (4 * zz - xx - yy),
            _C3[4] * z * (xx - yy),
            -_C3[0] * x * (xx - 3 * yy),
        ]
    return torch.stack(values, dim=-1)


def evaluate(sh: Tensor, directions: Tensor) -> Tensor:
    """Sum of coefficients times basis, `[..., 3]`, without the 0.5 offset and the clamp (see `to_color`).

    Args:
        sh: `[..., K, 3]`.
        directions: `[..., 3]`, unit, eye to Gaussian; broadcasts against the leading axes of `sh`.
    """
    return torch.einsum("...k,...kc->...c", basis(directions, SH_BANDS[int(sh.shape[-2])]), sh)


def to_color(sh: Tensor, directions: Tensor) -> Tensor:
    """Display colour `max(0, 0.5 + sum)`, `[..., 3]`, as a renderer shows it from these directions."""
    return (evaluate(sh, directions) + 0.5).clamp(min=0)


def color_to_dc(rgb: Tensor) -> Tensor:
    """The constant coefficient `[..., 3]` that, without other bands, gives the display colour `rgb` `[..., 3]`."""
    return (rgb - 0.5) / SH_C0


def dc_to_color(dc: Tensor) -> Tensor:
    """The display colour `[..., 3]` that constant coefficients `[..., 3]` give without other bands; not clamped."""
    return dc * SH_C0 + 0.5


def rotate(sh: Tensor, rotation: Tensor) -> Tensor:
    """Rotate view-dependent colour with its object: `evaluate(rotate(sh, R), R @ d) == evaluate(sh, d)`.

    Args:
        sh: `[N, K, 3]`.
        rotation: `[3, 3]` proper rotation, world frame.

    Returns:
        A new `[N, K, 3]`; the constant band is copied bit for bit.

    Raises:
        UserError: `rotation` is not a rotation (mirrored, scaled or not finite).
    """
    return turned(sh, turning(rotation, int(sh.shape[-2])).to(sh.device, sh.dtype))


def turning(rotation: Tensor, bands: int) -> Tensor:
    """`[3 K, 3 K]` float64 matrix by which `turned` rotates K = `bands` coefficients of three channels.

    Raises:
        UserError: as `rotate`.
    """
    matrix = _checked(rotation)
    # One product over all bands and channels is three times as fast as a small one for each band.
    return torch.kron(_all_bands(tuple(matrix.flatten().tolist()), bands), torch.eye(3, dtype=torch.float64))


def _checked(rotation: Tensor) -> Tensor:
    """The rotation `[3, 3]` in float64 on the CPU. Raises UserError as `rotate`."""
    matrix = rotation.detach().to("cpu", torch.float64)
    if tuple(matrix.shape) != (3, 3) or not _is_rotation(matrix):
        raise UserError("harmonics can only be rotated by a proper 3x3 rotation; remove scale and mirroring first")
    return matrix


def turned(sh: Tensor, turn: Tensor) -> Tensor:
    """`rotate` of harmonics `[N, K, 3]` by a matrix of `turning`: one for many blocks of a cloud."""
    out = (sh.flatten(-2) @ turn.T).reshape(sh.shape)
    out[..., 0, :] = sh[..., 0, :]
    return out


@functools.lru_cache(maxsize=4)  # clouds are rotated block by block
def _all_bands(rotation: tuple[float, ...], bands: int) -> Tensor:
    """`[K, K]` float64 matrix that rotates K = `bands` coefficients; `rotation` row by row."""
    turn = torch.eye(bands, dtype=torch.float64)
    for degree, matrix in enumerate(matrices(np.array(rotation).reshape(3, 3), bands), start=1):
        band = slice(degree**2, (degree + 1) ** 2)
        turn[band, band] = torch.from_numpy(matrix)
    return turn


def matrices(rotation: NDArray[np.float64], bands: int) -> list[NDArray[np.float64]]:
    """The matrices of `band_matrix` for bands 1, 2, ... of K = `bands` coefficients.

    Raises:
        UserError: as `rotate`.
    """
    checked = _checked(torch.from_numpy(np.ascontiguousarray(rotation)))
    return [band_matrix(checked, degree).numpy() for degree in range(1, SH_BANDS[bands] + 1)]


def band_matrix(rotation: Tensor, degree: int) -> Tensor:
    """`[2l + 1, 2l + 1]` float64 orthogonal matrix that rotates the coefficients of band l = `degree`.

    The functions of a band span a space that rotations map to itself: `y(R d) = D(R) y(d)` for every d. D is solved
    from evenly spread directions. This needs no recurrence and always agrees with `basis` in order and sign.
    """
    directions, inverse = _samples(degree)
    turned = basis(directions @ rotation.to(torch.float64).T, degree)[:, degree**2 :]
    return (inverse @ turned).T


@functools.cache
def _samples(degree: int) -> tuple[Tensor, Tensor]:
    """Directions `[64, 3]` on a Fibonacci sphere and the pseudo-inverse `[2l + 1, 64]` of one band at them."""
    index = torch.arange(64, dtype=torch.float64)
    z = 1 - (2 * index + 1) / 64
    turn = index * (math.pi * (3 - math.sqrt(5)))
    ring = torch.sqrt(1 - z * z)
    directions = torch.stack([ring * torch.cos(turn), ring * torch.sin(turn), z], dim=-1)
    return directions, torch.linalg.pinv(basis(directions, degree)[:, degree**2 :])


def _is_rotation(matrix: Tensor) -> bool:
    """Whether a float64 `[3, 3]` is orthogonal and not mirrored; 1e-4 allows for float32 products of many rotations."""
    m = matrix.numpy()
    return bool(np.isfinite(m).all() and np.allclose(m @ m.T, np.eye(3), atol=1e-4) and np.linalg.det(m) > 0)
