"""Boxes against points spread through them, and the boxes of a room against those of a scene."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from scenewright.gaussians.world.box import (
    Box,
    Boxes,
    YawBox,
    distance,
    lattice,
    meet,
    overlap,
    penetration,
    plan_gap,
    plan_penetration,
    plan_share,
    shared_height,
    to_world,
)

CLOSE = 1e-9  # float64, coordinates of a few metres
turns = st.one_of(st.sampled_from([0.0, 90.0, 180.0, -90.0]), st.floats(-179.0, 180.0))
sides = st.floats(0.05, 2.0)
places = st.floats(-2.0, 2.0)
boxes = st.builds(YawBox, places, places, st.floats(0.0, 1.0), sides, sides, sides, turns)
GRID = lattice(7, 7)


def grid_of(box: Box) -> np.ndarray:
    return Boxes.of([box]).spread(GRID)[0]


@given(boxes)
def test_corners_and_extents_are_those_of_the_axes(one: YawBox) -> None:
    box = one.box
    corners = box.corners()
    assert np.allclose(np.abs(box.local(corners)), np.array(box.size) / 2, atol=CLOSE)
    assert np.allclose(corners[:4, 2], one.low, atol=CLOSE) and np.allclose(corners[4:, 2], one.high, atol=CLOSE)
    for axis in np.eye(3):
        assert box.extent(axis) == pytest.approx(np.ptp(corners @ axis), abs=CLOSE)
    assert box.bottom(np.array([0.0, 0.0, 1.0])) == pytest.approx(one.low, abs=CLOSE)
    assert box.top(np.array([0.0, 0.0, 1.0])) == pytest.approx(one.high, abs=CLOSE)
    assert box.covers(box.corners() * [1, 1, 0] * (1 - 1e-6) + np.array([*box.center[:2], 5.0]) * 1e-6).all()


@given(boxes)
def test_a_rooms_box_has_the_footprint_of_its_box(one: YawBox) -> None:
    plan = one.box.corners()[:4, :2]
    assert {tuple(p) for p in np.round(plan, 6) + 0.0} == {tuple(p) for p in np.round(one.corners(), 6) + 0.0}
    assert np.allclose(np.abs(one.corners() - [one.x, one.y]).max(axis=0), one.half, atol=CLOSE)
    assert np.allclose(one.local(*one.world(0.3, -0.2)), (0.3, -0.2), atol=CLOSE)
    x, y = to_world(one.x, one.y, one.yaw, 0.0, -1.0)
    assert np.allclose((x - one.x, y - one.y), one.front, atol=CLOSE)


@given(boxes, boxes)
def test_penetration_is_symmetric_and_moves_boxes_apart(a: YawBox, b: YawBox) -> None:
    one, other = a.box, b.box
    deep = penetration(one, other)
    assert deep == pytest.approx(penetration(other, one), abs=CLOSE)
    assert overlap(one, other) == max(0.0, deep)
    assert overlap(one, dataclasses.replace(other, center=(50.0, 0.0, 0.0))) == 0.0
    assert one.shifted(np.array([50.0, 0.0, 0.0])).center[0] == one.center[0] + 50.0
    step = deep * (1 + 1e-6) + 1e-6
    if deep > 0:  # somewhere at that distance it is free
        ways = [np.array(v) * sign * step for v in (*one.axes, *other.axes) for sign in (-1, 1)]
        assert any(overlap(one.shifted(way), other) == 0.0 for way in ways)


@given(boxes, boxes)
def test_a_point_of_one_box_in_the_other_proves_an_overlap(a: YawBox, b: YawBox) -> None:
    inside = (np.abs(b.box.local(grid_of(a.box))) < np.array(b.box.size) / 2 - 1e-6).all(axis=1)
    if inside.any():
        assert penetration(a.box, b.box) > 0 and meet(a, b, 0.0) and distance(a.box, b.box) == 0.0


@given(boxes, boxes)
def test_boxes_of_a_room_meet_where_their_boxes_overlap(a: YawBox, b: YawBox) -> None:
    """The formulas for many places at once, in plan and height, against the one for boxes of a scene."""
    rise = min(a.high - b.low, b.high - a.low)
    assert penetration(a.box, b.box) == pytest.approx(min(float(plan_penetration(a, b)), rise), abs=CLOSE)
    assume(abs(penetration(a.box, b.box)) > CLOSE)
    assert meet(a, b, 0.0) == (overlap(a.box, b.box) > 0.0)


@given(boxes, boxes)
def test_gaps_in_plan_are_no_more_than_the_distance(a: YawBox, b: YawBox) -> None:
    level = b._replace(low=a.low, h=a.h)
    exact = distance(a.box, level.box)
    assert float(plan_gap(a, level)) <= exact + 1e-6
    if a.yaw % 90 == 0 and b.yaw % 90 == 0:
        assert float(plan_gap(a, level)) == pytest.approx(exact, abs=1e-6)
    if shared_height(a, b) < 0:
        assert distance(a.box, b.box) == pytest.approx(math.hypot(exact, shared_height(a, b)), abs=1e-6)


@given(boxes, boxes)
def test_many_places_at_once_are_each_alone(a: YawBox, b: YawBox) -> None:
    xs = np.linspace(-2.0, 2.0, 5)
    many = a._replace(x=xs[:, None], y=xs[None, :])
    for measured in (plan_penetration, plan_gap, plan_share):
        together = np.broadcast_to(measured(many, b), (5, 5))
        for i, j in np.ndindex(5, 5):
            assert together[i, j] == pytest.approx(float(measured(a._replace(x=xs[i], y=xs[j]), b)), abs=CLOSE)
