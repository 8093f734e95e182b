"""What agreement means: over everything, at the border as the members see it, and on both of its sides."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.benchmarks._iou import border, border_iou, contour, contour_iou, iou, trimap_iou

DISTANCE = 0.25


@st.composite
def masked_points(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, a truth and an answer."""
    count = draw(st.integers(1, 40))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    share = draw(st.sampled_from([0.0, 0.2, 0.5, 1.0]))
    return rng.random((count, 3)), rng.random(count) < 0.5, rng.random(count) < share


def slow_border(mask: np.ndarray, points: np.ndarray) -> np.ndarray:
    """The definition, pair by pair."""
    found = np.zeros(len(mask), bool)
    for i in np.flatnonzero(mask):
        for j in np.flatnonzero(~mask):
            found[i] |= np.linalg.norm(points[i] - points[j]) <= DISTANCE
    return found


@given(masked_points())
def test_the_border_is_what_the_definition_says(some: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    points, truth, answer = some
    edge, other = slow_border(truth, points), slow_border(answer, points)
    assert (border(truth, points, DISTANCE) == edge).all()
    expected = (edge & other).sum() / (edge | other).sum() if edge.any() else None
    assert border_iou(truth, answer, points, DISTANCE) == expected
    band = edge | slow_border(~truth, points)
    expected = (truth & answer & band).sum() / ((truth | answer) & band).sum() if band.any() else None
    assert trimap_iou(truth, answer, points, DISTANCE) == expected


@given(masked_points())
def test_agreement_is_a_share_symmetric_and_whole_only_for_equals(
    some: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> None:
    _, a, b = some
    assert 0 <= iou(a, b) == iou(b, a) <= 1
    assert (iou(a, b) == 1) == (bool(a.any()) and (a == b).all())


def test_a_refusal_is_no_agreement_even_at_the_border() -> None:
    points, truth = np.array([[0.0, 0, 0], [0.1, 0, 0]]), np.array([True, False])
    nothing = np.zeros(2, bool)
    assert border_iou(truth, nothing, points, DISTANCE) == 0 == trimap_iou(truth, nothing, points, DISTANCE)
    assert border_iou(np.ones(2, bool), nothing, points, DISTANCE) is None


@pytest.mark.parametrize("gap, near", [(DISTANCE, True), (np.nextafter(DISTANCE, 1), False)])
def test_the_distance_itself_is_near(gap: float, near: bool) -> None:
    points, truth = np.array([[0.0, 0, 0], [gap, 0, 0]]), np.array([True, False])
    assert border(truth, points, DISTANCE).any() == near


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.3, 0.8, 1.0]))
def test_the_contour_is_what_the_definition_says(seed: int, share: float) -> None:
    mask = np.random.default_rng(seed).random((7, 9)) < share
    width = 0.2 * np.hypot(7, 9)
    outside = [(y, x) for y in range(-1, 8) for x in range(-1, 10) if not (0 <= y < 7 and 0 <= x < 9 and mask[y, x])]
    slow = np.zeros_like(mask)
    for y, x in zip(*np.nonzero(mask), strict=True):
        slow[y, x] = min(np.hypot(y - v, x - u) for v, u in outside) <= width
    assert (contour(mask, 0.2) == slow).all()


def test_a_rim_that_bleeds_costs_more_than_the_whole() -> None:
    truth = np.zeros((100, 100), bool)
    truth[20:80, 20:80] = True
    bled = np.zeros_like(truth)
    bled[17:83, 17:83] = True
    assert contour_iou(truth, truth) == 1
    assert contour_iou(truth, bled) < 0.5 < iou(truth, bled)
    assert contour_iou(truth, np.zeros_like(truth)) == 0
