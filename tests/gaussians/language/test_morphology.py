"""Growing, shrinking and inverting selections: laws of morphology on point sets, and a slow reference."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from amounts import some
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.language.field.group_index import difference, index_groups
from scenewright.gaussians.language.query.morphology import grown, shrunk

Sets = tuple[GaussianCloud, set[int], set[int]]


def cloud_of(points: np.ndarray, ids: np.ndarray) -> GaussianCloud:
    n = len(points)
    return GaussianCloud.create(
        torch.from_numpy(points).float(), torch.tensor([[1.0, 0, 0, 0]]).repeat(n, 1), torch.full((n, 3), 0.01),
        torch.full((n,), 0.9), torch.zeros(n, 1, 3), ids=torch.from_numpy(ids),
    )  # fmt: skip


@st.composite
def clouds(draw: st.DrawFn) -> Sets:
    """Clumps of Gaussians, some at the very same place, ids in no order, and two subsets."""
    rng = np.random.default_rng(draw(st.integers(0, 2**31 - 1)))
    n = draw(st.integers(1, 60))
    points = rng.integers(0, 5, (n, 3)) * 0.3 + rng.normal(0, 0.05, (n, 3)) * rng.integers(0, 2, (n, 1))
    points = points * draw(st.sampled_from([1.0, 0.01, 100.0]))
    ids = rng.permutation(n * 3)[:n].astype(np.int64)
    a, b = (set(ids[rng.random(n) < share].tolist()) for share in (0.3, 0.6))
    return cloud_of(points, ids), a, b


distances = st.sampled_from([1e-3, 0.05, 0.3, 0.31, 1.0, 40.0])


def t(ids: set[int]) -> torch.Tensor:
    return torch.tensor(sorted(ids), dtype=torch.int64)


def grow(cloud: GaussianCloud, ids: set[int], by: float) -> set[int]:
    return set(grown(cloud, t(ids), by).tolist())


def shrink(cloud: GaussianCloud, ids: set[int], by: float) -> set[int]:
    return set(shrunk(cloud, t(ids), by).tolist())


def invert(cloud: GaussianCloud, ids: set[int]) -> set[int]:
    return set(difference(index_groups(cloud).every_id, t(ids)).tolist())


@given(clouds(), distances)
@settings(max_examples=some(40))
def test_growing_is_what_every_distance_compared_says(made: Sets, by: float) -> None:
    cloud, a, _ = made
    points, ids = cloud.means.double().numpy(), cloud.ids.tolist()
    inside = np.array([i in a for i in ids])
    if not inside.any():
        assert grow(cloud, a, by) == set()
        return
    gaps = np.linalg.norm(points[:, None] - points[None, inside], axis=2).min(axis=1)
    clear = np.abs(gaps - by) > 1e-9 * (1 + by)  # at the very rim rounding decides
    found = grow(cloud, a, by)
    assert all((i in found) == bool(g <= by) for i, g, sure in zip(ids, gaps, clear, strict=True) if sure)


@given(clouds(), distances)
@settings(max_examples=some(40))
def test_shrinking_grows_the_rest(made: Sets, by: float) -> None:
    cloud, a, _ = made
    assert shrink(cloud, a, by) == invert(cloud, grow(cloud, invert(cloud, a), by))
    assert shrink(cloud, a, by) <= a <= grow(cloud, a, by)
    assert invert(cloud, invert(cloud, a)) == a


@given(clouds(), distances)
@settings(max_examples=some(40))
def test_both_keep_the_order_of_sets_and_are_each_others_adjoint(made: Sets, by: float) -> None:
    cloud, a, b = made
    assert grow(cloud, a & b, by) <= grow(cloud, b, by) and shrink(cloud, a & b, by) <= shrink(cloud, b, by)
    assert (grow(cloud, a, by) <= b) == (a <= shrink(cloud, b, by))
    inner = shrink(cloud, b, by)
    assert grow(cloud, inner, by) <= b


@given(clouds(), distances)
@settings(max_examples=some(25))
def test_there_and_back_fills_holes_or_removes_specks_once_and_for_all(made: Sets, by: float) -> None:
    cloud, a, _ = made
    closed = shrink(cloud, grow(cloud, a, by), by)
    opened = grow(cloud, shrink(cloud, a, by), by)
    assert opened <= a <= closed
    assert shrink(cloud, grow(cloud, closed, by), by) == closed
    assert grow(cloud, shrink(cloud, opened, by), by) == opened


def test_everything_and_nothing_stay_what_they_are() -> None:
    cloud = cloud_of(np.random.default_rng(0).normal(0, 1, (20, 3)), np.arange(20))
    every = set(range(20))
    assert grow(cloud, every, 0.1) == shrink(cloud, every, 0.1) == every and invert(cloud, every) == set()
    assert grow(cloud, set(), 0.1) == shrink(cloud, set(), 0.1) == set() and invert(cloud, set()) == every


@pytest.mark.parametrize("by", [0.0, -0.1, float("inf"), float("nan")])
def test_a_distance_that_is_none_is_refused(by: float) -> None:
    cloud = cloud_of(np.zeros((1, 3)), np.arange(1))
    with pytest.raises(UserError, match="positive distance"):
        grown(cloud, t({0}), by)
