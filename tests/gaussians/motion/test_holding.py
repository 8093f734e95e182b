"""Spans in which a value holds, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.gaussians.motion.holding import common, grid, joined, lowest, rest, spans

EXACT = 1e-4  # seconds: a step halved nine times


@settings(max_examples=40, deadline=None)
@given(st.floats(0.3, 3.0), st.floats(-3.0, 3.0), st.floats(-0.9, 0.9))
def test_a_sine_holds_between_its_crossings(rate: float, phase: float, level: float) -> None:
    found = spans(lambda t: np.sin(rate * t + phase), grid(0.0, 6.0), level)
    rising = (np.arcsin(level) - phase + 2 * np.pi * np.arange(-3, 9)) / rate
    falling = (np.pi - np.arcsin(level) - phase + 2 * np.pi * np.arange(-3, 9)) / rate
    true = [(max(a, 0.0), min(b, 6.0)) for a, b in zip(rising, falling, strict=True) if b > 0 and a < 6.0]
    true = [s for s in true if s[1] - s[0] > 1e-3]
    found = [s for s in found if s[1] - s[0] > 1e-3]
    assert np.allclose(np.array(found).reshape(-1, 2), np.array(true).reshape(-1, 2), atol=EXACT)


@settings(max_examples=30, deadline=None)
@given(st.floats(0.1, 3.9), st.floats(2e-3, 0.05))
def test_a_peak_between_samples_is_found(middle: float, half: float) -> None:
    found = spans(lambda t: 1 - np.abs(t - middle) / half, grid(0.0, 4.0), 0.0)
    assert found == [pytest.approx((middle - half, middle + half), abs=EXACT)]


def test_what_stays_above_the_release_is_one_span_and_ends_where_it_crosses_the_hold() -> None:
    def value(t: np.ndarray) -> np.ndarray:
        return 1.0 - t / 4 - 0.1 * (np.sin(40 * t) > 0)  # falls from 1 to 0 and flickers by 0.1

    single, many = spans(value, grid(0.0, 4.0), 0.5, 0.35), spans(value, grid(0.0, 4.0), 0.5)
    assert len(single) == 1 < len(many)
    assert single[0][0] == 0.0 and single[0][1] == many[-1][1]


def test_sets_of_spans() -> None:
    a, b = [(0.0, 1.0), (2.0, 3.0)], [(0.5, 2.5)]
    assert common(a, b) == [(0.5, 1.0), (2.0, 2.5)]
    assert rest(a, 0.0, 4.0) == [(1.0, 2.0), (3.0, 4.0)]
    assert joined([(0.0, 1.0), (1.05, 2.0), (2.5, 3.0)], 0.1) == [(0.0, 2.0), (2.5, 3.0)]
    assert joined([(0.0, 5.0), (1.0, 2.0)], 0.1) == [(0.0, 5.0)]
    assert spans(lambda t: t, grid(0.0, 1.0), 2.0) == []
    assert spans(lambda t: np.ones_like(t), grid(3.0, 3.0), 0.5) == [(3.0, 3.0)]


@settings(max_examples=30, deadline=None)
@given(st.floats(0.0, 4.0))
def test_the_lowest_point_of_a_parabola(middle: float) -> None:
    assert lowest(lambda t: (t - middle) ** 2, 0.0, 4.0) == pytest.approx(middle, abs=1e-3)
