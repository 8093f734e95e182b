"""Laws of wxyz quaternions: the group axioms, and agreement with matrices made another way."""

from __future__ import annotations

import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from torch import Tensor

from scenewright.gaussians import rotations
from scenewright.gaussians.errors import UserError

# float64 throughout, so that tolerances measure the formulas: a dozen operations on values near one.
TOLERANCE = {"atol": 1e-12, "rtol": 0}

numbers = st.floats(-1, 1).map(lambda v: round(v, 6))
quats = (
    st.tuples(numbers, numbers, numbers, numbers)
    .filter(lambda q: sum(c * c for c in q) > 1e-4)
    .map(lambda q: rotations.normalize(torch.tensor(q, dtype=torch.float64)))
)
vectors = st.tuples(numbers, numbers, numbers).map(lambda v: torch.tensor(v, dtype=torch.float64))


def same_turn(a: Tensor, b: Tensor) -> bool:
    return bool(torch.allclose(rotations.to_matrix(a), rotations.to_matrix(b), **TOLERANCE))


@given(quats, quats, quats)
def test_multiplication_is_a_group(a: Tensor, b: Tensor, c: Tensor) -> None:
    one = torch.tensor(rotations.IDENTITY, dtype=torch.float64)
    left = rotations.multiply(rotations.multiply(a, b), c)
    right = rotations.multiply(a, rotations.multiply(b, c))
    assert torch.allclose(left, right, **TOLERANCE)
    assert torch.equal(rotations.multiply(a, one), a)
    inverse = a * a.new_tensor([1.0, -1.0, -1.0, -1.0])  # the conjugate
    assert torch.allclose(rotations.multiply(a, inverse), one, **TOLERANCE)


@given(quats, quats)
def test_product_is_product_of_matrices(a: Tensor, b: Tensor) -> None:
    product = rotations.to_matrix(rotations.multiply(a, b))
    assert torch.allclose(product, rotations.to_matrix(a) @ rotations.to_matrix(b), **TOLERANCE)


@given(quats)
def test_matrix_round_trip(q: Tensor) -> None:
    back = rotations.from_matrix(rotations.to_matrix(q))
    assert same_turn(back, q) and back[0] >= 0


@given(quats, vectors)
def test_agrees_with_scipy(q: Tensor, v: Tensor) -> None:
    w, x, y, z = q.tolist()
    expected = Rotation.from_quat([x, y, z, w]).apply(v.numpy())
    assert torch.allclose(rotations.to_matrix(q) @ v, torch.from_numpy(expected), **TOLERANCE)


@pytest.mark.parametrize("axis", [(1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0)])
def test_half_turns_survive_the_matrix(axis: tuple[float, float, float]) -> None:
    """Where w is zero, the naive formula divides by it."""
    q = rotations.from_axis_angle(axis, math.pi)
    assert same_turn(rotations.from_matrix(rotations.to_matrix(q)), q)


def test_a_quarter_turn_about_up_is_counter_clockwise() -> None:
    quarter = rotations.to_matrix(rotations.from_axis_angle((0, 0, 2), math.pi / 2))
    east = torch.tensor([1, 0, 0], dtype=torch.float64)
    assert torch.allclose(quarter @ east, torch.tensor([0, 1, 0], dtype=torch.float64), **TOLERANCE)


def test_batches_broadcast() -> None:
    many = rotations.from_axis_angle(torch.eye(3), torch.tensor([0.1, 0.2, 0.3]))
    assert many.shape == (3, 4) and rotations.from_axis_angle((0, 0, 1), torch.ones(5)).shape == (5, 4)
    one = rotations.from_axis_angle((0, 0, 1.0), 0.5).float()
    assert rotations.multiply(one, many).shape == (3, 4)
    assert rotations.from_matrix(rotations.to_matrix(many)).shape == (3, 4)


@pytest.mark.parametrize("bad", [[0, 0, 0, 0], [math.nan, 0, 0, 1], [math.inf, 0, 0, 0]])
def test_normalizing_what_has_no_direction_gives_no_rotation(bad: list[float]) -> None:
    rows = torch.tensor([bad, [0, 3, 0, 4]], dtype=torch.float32)
    assert rotations.normalize(rows).tolist() == [[1, 0, 0, 0], [0, pytest.approx(0.6), 0, pytest.approx(0.8)]]
    assert rows[1].tolist() == [0, 3, 0, 4]  # the argument is untouched


@pytest.mark.parametrize("axis", [(0, 0, 0), (math.nan, 0, 1), (math.inf, 0, 0)])
def test_an_axis_must_point_somewhere(axis: tuple[float, float, float]) -> None:
    with pytest.raises(UserError, match="axis"):
        rotations.from_axis_angle(axis, 1.0)
