"""Numbering and ordering by tables: the same as by sorting."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from scenewright.gaussians.language.query.color import numbering
from scenewright.gaussians.language.query.color.numbering import dense, numbered, ranked, stable_order

codes = st.lists(st.integers(0, 40), max_size=30).map(lambda values: np.array(values, np.int64))


@given(codes, st.sampled_from([0, 1 << 25]))
def test_numbers_are_those_of_a_sort(code: NDArray[np.int64], table: int) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(numbering, "TABLE", table)
        number, first = numbered(code)
        assert np.array_equal(ranked(code, 41), number)
    _, wanted_first, wanted = np.unique(code, return_index=True, return_inverse=True)
    assert np.array_equal(number, wanted) and np.array_equal(first, wanted_first)


@given(st.lists(st.tuples(*[st.integers(-3, 3)] * 3), min_size=1, max_size=30))
def test_keys_are_numbered_by_their_coordinates_in_turn(keys: list[tuple[int, int, int]]) -> None:
    ranks = {key: i for i, key in enumerate(sorted(set(keys)))}
    assert dense(np.array(keys, np.int64)).tolist() == [ranks[key] for key in keys]


@given(codes)
def test_the_order_by_counting_is_that_of_a_stable_sort(code: NDArray[np.int64]) -> None:
    found = stable_order(code.astype(np.int32), 41)
    assert np.array_equal(found, np.argsort(code, kind="stable"))
