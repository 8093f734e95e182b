"""Fast passes over columns give what plain loops give; kept results are those of the very same objects."""

from __future__ import annotations

import gc
import weakref

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.kept import Kept
from scenewright.gaussians.rows import copied, empty, mask_of_ids, rows_of_ids, rows_where, rows_within, span_of, taken

COLUMNS = {
    "of a file": torch.arange(40),
    "with gaps": torch.tensor([0, 1, 2, 5, 6, 9, 12, 13]),
    "out of order": torch.tensor([3, 1, 2, 0, 4]),
    "far apart": torch.tensor([7, 10_000_000, 5, 123_456]),
    "from a hundred": torch.arange(100, 130),
    "empty": torch.zeros(0, dtype=torch.int64),
}
WANTED = st.lists(st.integers(-5, 140) | st.sampled_from([123_456, 10_000_000, 99_999_999]), max_size=30)


@pytest.mark.parametrize("name", COLUMNS)
@given(wanted=WANTED)
def test_ids_are_found_as_by_a_loop(name: str, wanted: list[int]) -> None:
    """Any ids, in any order, twice or not in the column at all."""
    column, ids = COLUMNS[name], torch.tensor(wanted, dtype=torch.int64)
    plain = [int(i) in wanted for i in column]
    assert mask_of_ids(column, ids).tolist() == plain
    rows = [row for row, found in enumerate(plain) if found]
    assert rows_of_ids(column, ids).tolist() == rows
    assert rows_of_ids(column, ids.unique()).tolist() == rows  # ascending ids have a way of their own


def test_a_span_says_whether_ids_are_counted() -> None:
    assert span_of(torch.arange(3, 9)) == (3, 8, True)
    assert span_of(torch.tensor([1, 0, 2])) == (0, 2, False)
    assert span_of(torch.tensor([0, 1, 3])) == (0, 3, False)


@given(st.lists(st.booleans(), max_size=50))
def test_set_rows_ascend(mask: list[bool]) -> None:
    assert rows_where(torch.tensor(mask, dtype=torch.bool)).tolist() == [i for i, m in enumerate(mask) if m]


def test_rows_within_a_box_are_those_of_a_loop() -> None:
    """Points on the faces of the box count."""
    g = torch.Generator().manual_seed(0)
    points = torch.randint(-8, 9, (3000, 3), generator=g) / 4
    low, high = np.array([-1.0, -0.5, 0.0]), np.array([1.0, 0.75, 1.25])
    plain = [i for i, p in enumerate(points.tolist()) if all(a <= x <= b for a, x, b in zip(low, p, high, strict=True))]
    assert len(plain) > 100
    assert rows_within(points, low, high).tolist() == plain


@pytest.mark.parametrize("dtype", [torch.float32, torch.int32, torch.int64, torch.bool])
def test_copies_equal_and_share_nothing(dtype: torch.dtype) -> None:
    column = (torch.rand(50, 4, 3, generator=torch.Generator().manual_seed(1)) * 9).to(dtype)
    copy, rows = copied(column), torch.tensor([4, 4, 0, 49])
    assert torch.equal(copy, column) and copy.dtype == dtype and copy.data_ptr() != column.data_ptr()
    assert torch.equal(taken(column, rows), column[rows])
    assert empty((2, 5), column).dtype == dtype


def test_taken_rows_pass_gradients() -> None:
    column = torch.ones(4, 3, requires_grad=True)
    taken(column, torch.tensor([1, 1])).sum().backward()
    assert column.grad is not None and column.grad[:, 0].tolist() == [0, 2, 0, 0]


def test_a_cloud_takes_rows_counted_from_the_end() -> None:
    one = torch.ones(5, 3)
    cloud = GaussianCloud.create(one, torch.ones(5, 4), one, torch.full((5,), 0.5), one[:, None])
    assert cloud[torch.tensor([-1, 0])].ids.tolist() == [4, 0]


def test_results_are_kept_for_the_same_objects_only() -> None:
    made: Kept[int] = Kept(2)
    a, b = torch.zeros(3), torch.zeros(3)
    counter = iter(range(10))
    assert [made.get((x,), lambda: next(counter)) for x in (a, b, a, b)] == [0, 1, 0, 1]
    assert made.get((a, b), lambda: next(counter)) == 2  # the third set of objects: the one that was asked first goes
    assert made.get((a,), lambda: next(counter)) == 3


def test_kept_results_keep_nothing_alive() -> None:
    made: Kept[int] = Kept(2)
    column = torch.zeros(3)
    made.get((column,), lambda: 1)
    gone = weakref.ref(column)
    del column
    gc.collect()
    assert gone() is None
