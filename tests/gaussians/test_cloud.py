"""Laws of the Gaussian cloud: columns stay aligned, nothing is written in place, equality is bit for bit."""

from __future__ import annotations

import dataclasses

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.gaussians.cloud import NO_GROUP, GaussianCloud, concat
from scenewright.gaussians.errors import UserError


def make(n: int, degree: int = 0, seed: int = 0, first_id: int = 0) -> GaussianCloud:
    """A random cloud whose columns encode the number of their row."""
    g = torch.Generator().manual_seed(seed)
    ids = torch.arange(first_id, first_id + n, dtype=torch.int64)
    means = torch.randn(n, 3, generator=g)
    means[:, 0] = ids
    quats = torch.nn.functional.normalize(torch.randn(n, 4, generator=g), dim=1)
    sh = torch.randn(n, (degree + 1) ** 2, 3, generator=g)
    sh[:, 0, 0] = ids
    scales = torch.rand(n, 3, generator=g) + 0.01
    scales[:, 0] = ids + 1
    return GaussianCloud.create(means, quats, scales, torch.rand(n, generator=g) * 0.9 + 0.05, sh, ids.int(), ids)


def aligned(cloud: GaussianCloud) -> bool:
    """Whether every column of `make` is still aligned with the ids."""
    ids = cloud.ids
    return bool(
        (cloud.means[:, 0] == ids).all()
        and (cloud.sh[:, 0, 0] == ids).all()
        and (cloud.scales[:, 0] == ids + 1).all()
        and (cloud.group == ids).all()
    )


sizes = st.integers(0, 40)


@given(sizes, st.data())
def test_masks_indices_and_slices_agree_and_keep_columns_aligned(n: int, data: st.DataObject) -> None:
    cloud = make(n)
    mask = torch.tensor(data.draw(st.lists(st.booleans(), min_size=n, max_size=n)), dtype=torch.bool)
    by_mask, by_index = cloud[mask], cloud[mask.nonzero().squeeze(1)]
    assert by_mask.digest() == by_index.digest() and aligned(by_mask)
    assert len(by_mask) + len(cloud[~mask]) == n
    low, high = sorted(data.draw(st.tuples(sizes, sizes)))
    assert aligned(cloud[low:high]) and cloud[low:high].digest() == cloud[torch.arange(n)[low:high]].digest()


@given(sizes, sizes, st.integers(0, 3), st.integers(0, 3))
def test_concat_keeps_rows_and_pads_harmonics(n: int, m: int, low: int, high: int) -> None:
    a, b = make(n, low), make(m, high, seed=1, first_id=n)
    joined = concat([a, b])
    assert len(joined) == n + m and joined.degree == max(low, high) and aligned(joined)
    assert joined[:n].with_degree(low).digest() == a.digest()
    assert joined[n:].with_degree(high).digest() == b.digest()


@given(st.integers(1, 20), st.integers(0, 19))
def test_concat_refuses_shared_ids_and_only_those(n: int, shift: int) -> None:
    a = make(n)
    if shift < n:
        with pytest.raises(UserError, match="share an id"):
            concat([a, make(3, first_id=shift)])
    evens, odds = a[0::2], a[1::2]  # interleaved ranges without a common id
    assert sorted(concat([evens, odds]).ids.tolist()) == a.ids.tolist()


def test_concat_of_nothing_is_refused_and_of_one_is_itself() -> None:
    with pytest.raises(UserError):
        concat([])
    assert concat([make(5)]).digest() == make(5).digest()


@settings(max_examples=20)
@given(st.integers(1, 10), st.integers(0, 3), st.integers(0, 6), st.integers(0, 31))
def test_digest_sees_a_single_bit_of_any_column(n: int, degree: int, column: int, bit: int) -> None:
    cloud = make(n, degree)
    name, values = cloud.columns()[column]
    words = values.clone().view(torch.int64 if values.dtype == torch.int64 else torch.int32)
    words.view(-1)[0] ^= (1 << bit) if bit < 31 else -(2**31)
    changed = cloud.replace(**{name: words.view(values.dtype)})
    assert changed.digest() != cloud.digest() == make(n, degree).digest()


def test_digest_tells_shapes_apart_even_without_rows() -> None:
    assert len({GaussianCloud.empty(degree).digest() for degree in range(4)}) == 4


@given(st.integers(0, 5), st.integers(0, 3), st.integers(0, 3))
def test_degree_up_and_down_again_is_identity(n: int, degree: int, other: int) -> None:
    cloud = make(n, degree)
    changed = cloud.with_degree(other)
    assert changed.degree == other
    if other >= degree:
        assert changed.with_degree(degree).digest() == cloud.digest()
        assert not changed.sh[:, (degree + 1) ** 2 :].any()


def test_frozen_and_sharing() -> None:
    cloud = make(4)
    with pytest.raises(dataclasses.FrozenInstanceError):
        cloud.means = cloud.means  # type: ignore[misc]
    darker = cloud.replace(sh=cloud.sh * 0.5)
    assert darker.means is cloud.means and darker.sh is not cloud.sh
    assert cloud.digest() == make(4).digest()


def test_defaults_are_no_group_and_row_numbers() -> None:
    c = make(3)
    plain = GaussianCloud.create(c.means, c.quats, c.scales, c.opacities, c.sh)
    assert plain.group.tolist() == [NO_GROUP] * 3 and plain.ids.tolist() == [0, 1, 2]
    assert plain.nbytes == 3 * (4 * (3 + 4 + 3 + 1 + 3) + 4 + 8)
    assert len(GaussianCloud.empty()) == 0 and GaussianCloud.empty(2).degree == 2


@pytest.mark.parametrize(
    ("column", "value", "message"),
    [
        ("means", torch.zeros(3, 2), "means"),
        ("means", torch.zeros(()), "means"),
        ("quats", torch.zeros(2, 4), "quats"),
        ("scales", torch.zeros(3, 3, dtype=torch.float64), "float64"),
        ("opacities", torch.zeros(3, 1), "opacities"),
        ("sh", torch.zeros(3, 5, 3), "1, 4, 9 or 16"),
        ("sh", torch.zeros(3, 3), "sh"),
        ("group", torch.zeros(3, dtype=torch.int64), "group"),
        ("ids", torch.zeros(3, dtype=torch.int32), "ids"),
        ("ids", torch.zeros(3, dtype=torch.int64, device="meta"), "meta"),
    ],
)
def test_misshapen_columns_are_named(column: str, value: torch.Tensor, message: str) -> None:
    with pytest.raises(UserError, match=message):
        make(3).replace(**{column: value})


def test_indexing_that_would_misalign_is_refused() -> None:
    with pytest.raises(UserError, match="mask"):
        make(3)[torch.ones(4, dtype=torch.bool)]
    with pytest.raises(UserError):
        make(3)[torch.tensor(1)]
    with pytest.raises(UserError):
        make(3).with_degree(4)
