"""Laws of the harmonics: orthonormal, rotated with the object, in the original order and signs."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import sph_harm_y
from torch import Tensor

from scenewright.gaussians import harmonics, rotations
from scenewright.gaussians.errors import UserError

# float64: a band matrix solves a well-conditioned system (condition number near one) of values near one.
TOLERANCE = {"atol": 1e-11, "rtol": 0}


def random_case(seed: int, degree: int) -> tuple[Tensor, Tensor]:
    """Coefficients `[50, K, 3]` and unit directions `[50, 3]`, float64."""
    g = torch.Generator().manual_seed(seed)
    sh = torch.randn(50, (degree + 1) ** 2, 3, generator=g, dtype=torch.float64)
    return sh, torch.nn.functional.normalize(torch.randn(50, 3, generator=g, dtype=torch.float64), dim=1)


def random_rotation(seed: int) -> Tensor:
    g = torch.Generator().manual_seed(seed)
    return rotations.to_matrix(rotations.normalize(torch.randn(4, generator=g, dtype=torch.float64)))


degrees = st.integers(0, 3)
seeds = st.integers(0, 2**31)


@settings(max_examples=30)
@given(seeds, seeds, degrees)
def test_turned_colour_seen_from_turned_direction_is_the_same(seed: int, turn: int, degree: int) -> None:
    (sh, directions), rotation = random_case(seed, degree), random_rotation(turn)
    turned = harmonics.evaluate(harmonics.rotate(sh, rotation), directions @ rotation.T)
    assert torch.allclose(turned, harmonics.evaluate(sh, directions), **TOLERANCE)


@settings(max_examples=30)
@given(seeds, seeds, seeds, degrees)
def test_two_turns_are_one(seed: int, first: int, second: int, degree: int) -> None:
    sh, _ = random_case(seed, degree)
    a, b = random_rotation(first), random_rotation(second)
    assert torch.allclose(harmonics.rotate(harmonics.rotate(sh, a), b), harmonics.rotate(sh, b @ a), **TOLERANCE)


@given(seeds, degrees)
def test_no_turn_changes_nothing_and_the_constant_band_never_changes(seed: int, degree: int) -> None:
    sh, _ = random_case(seed, degree)
    assert torch.allclose(harmonics.rotate(sh, torch.eye(3)), sh, **TOLERANCE)
    sh[0, 0] = -0.0
    constant = harmonics.rotate(sh, random_rotation(seed))[:, 0]
    assert torch.equal(constant.contiguous().view(torch.int64), sh[:, 0].contiguous().view(torch.int64))


def test_no_rows_turn_into_no_rows() -> None:
    assert harmonics.rotate(torch.zeros(0, 16, 3), random_rotation(0)).shape == (0, 16, 3)


@given(seeds, st.integers(1, 3))
def test_band_matrices_are_orthogonal(seed: int, degree: int) -> None:
    turn = harmonics.band_matrix(random_rotation(seed), degree)
    assert torch.allclose(turn @ turn.T, torch.eye(2 * degree + 1, dtype=torch.float64), **TOLERANCE)


def test_order_and_signs_agree_with_the_complex_harmonics() -> None:
    """Slow reference: real harmonics from scipy's complex ones (Condon-Shortley phase), with m from -l to l.

    Kerbl et al. evaluate the real basis with its (-1)^m kept: band 1 is (-y, z, -x).
    """
    _, directions = random_case(1, 3)
    x, y, z = directions.numpy().T
    polar, azimuth = np.arccos(z), np.arctan2(y, x)
    expected = []
    for band in range(4):
        for m in range(-band, band + 1):
            value = sph_harm_y(band, abs(m), polar, azimuth)
            expected.append((value.imag if m < 0 else value.real) * (math.sqrt(2) if m else 1))
    reference = torch.from_numpy(np.stack(expected, axis=1))
    assert torch.allclose(harmonics.basis(directions, 3), reference, **TOLERANCE)


def test_basis_is_orthonormal_on_the_sphere() -> None:
    """Gauss-Legendre in z times equal steps in azimuth integrates products up to degree 6 exactly."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    azimuth = np.arange(16) * (2 * math.pi / 16)
    ring = np.sqrt(1 - nodes**2)
    points = np.stack(
        [np.outer(ring, np.cos(azimuth)), np.outer(ring, np.sin(azimuth)), np.outer(nodes, np.ones(16))], axis=-1
    )
    basis = harmonics.basis(torch.from_numpy(points.reshape(-1, 3)), 3)
    area = torch.from_numpy(np.outer(weights, np.full(16, 2 * math.pi / 16)).ravel())
    assert torch.allclose(basis.T @ (basis * area[:, None]), torch.eye(16, dtype=torch.float64), **TOLERANCE)


def test_colour_of_a_constant_is_the_same_from_everywhere_and_never_negative() -> None:
    _, directions = random_case(3, 0)
    rgb = torch.tensor([0.25, 0.5, 0.75], dtype=torch.float64)
    sh = harmonics.color_to_dc(rgb).expand(50, 1, 3)
    assert torch.allclose(harmonics.to_color(sh, directions), rgb.expand(50, 3), **TOLERANCE)
    assert torch.allclose(harmonics.dc_to_color(harmonics.color_to_dc(rgb)), rgb, **TOLERANCE)
    assert harmonics.to_color(sh * 100, directions).min() == 0


def test_float32_stays_float32_and_keeps_its_argument() -> None:
    sh, directions = (t.float() for t in random_case(4, 3))
    before, rotation = sh.clone(), random_rotation(5)
    turned = harmonics.rotate(sh, rotation.float())
    assert turned.dtype == torch.float32 and torch.equal(sh, before)
    # 15 float32 terms of size up to about 4: a few units in the sixth decimal.
    seen = harmonics.evaluate(turned, directions @ rotation.float().T)
    assert torch.allclose(seen, harmonics.evaluate(sh, directions), atol=2e-5, rtol=0)


@pytest.mark.parametrize(
    "bad", [torch.eye(3) * 2, torch.diag(torch.tensor([1.0, 1, -1])), torch.full((3, 3), math.nan), torch.eye(4)]
)
def test_only_rotations_turn(bad: Tensor) -> None:
    with pytest.raises(UserError, match="proper 3x3 rotation"):
        harmonics.rotate(torch.zeros(1, 4, 3), bad)
