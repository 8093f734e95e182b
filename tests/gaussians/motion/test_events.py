"""Events of moving blocks against closed forms of their motion."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.gaussians.errors import UserError
from scenewright.gaussians.motion import events
from scenewright.gaussians.motion.courses import course_of, courses
from scenewright.gaussians.motion.motion import Motion, Track
from scenewright.gaussians.scene import Scene
from tests.support.moving_blocks import blocks

CUBE = (0.2, 0.2, 0.2)
MS = 2e-3  # seconds: speeds are measured over two milliseconds
FLOOR = ((0.0, 0.0, -0.01), (8.0, 8.0, 0.02))


def sliding(way: float, start: float, stop: float, *more: tuple[str, object]) -> Scene:
    """A cube that slides along x at an even speed from 0 by `way`, over a rug from 1 to 2, to a post at 3."""
    things = {
        "cube": ((0.0, 0.0, 0.1), CUBE),
        "rug": ((1.5, 0.0, 0.005), (1.0, 1.0, 0.01)),
        "post": ((3.0, 0.0, 0.5), (0.2, 0.2, 1.0)),
        "wall": ((3.5, 0.0, 1.0), (0.02, 8.0, 2.0)),
        "floor": FLOOR,
    }
    return blocks(
        things, lambda ids: Track.slide(ids("cube"), [start, stop], [0.0, way], (1.0, 0.0, 0.0), smooth=False)
    )


@settings(max_examples=12, deadline=None)
@given(st.floats(2.3, 2.7), st.floats(0.05, 1.5), st.floats(0.8, 2.4))
@pytest.mark.slow
def test_when_a_sliding_cube_moves_touches_and_is_on(way: float, start: float, seconds: float) -> None:
    scene, stop, speed = sliding(way, start, start + seconds), start + seconds, way / seconds
    assert events.intervals(scene, 0, "moving") == [pytest.approx((start, stop), abs=MS)]
    assert events.intervals(scene, 0, "still") == [
        pytest.approx((0.0, start), abs=MS),
        pytest.approx((stop, 4.0), abs=MS),
    ]
    assert events.intervals(scene, 0, "touches", [2]) == []
    (on,) = events.intervals(scene, 0, "on", [1])
    assert on == pytest.approx((start + 1.0 / speed, start + 2.0 / speed), abs=MS)  # its middle is over the rug
    assert events.intervals(scene, 0, "touches", [4]) == [(0.0, 4.0)]
    assert events.first_contact(scene, 0, 2) is None and events.first_contact(scene, 0, 4) == 0.0
    course = course_of(scene, 0)
    assert events.path_length(course) == pytest.approx(way, abs=1e-6)
    middle = np.array([start + seconds / 2])
    assert events.speeds(course, middle)[0] == pytest.approx(speed, rel=1e-6)
    assert not events.falls(course) and events.turned(course) == pytest.approx(0.0, abs=1e-9)


def test_a_cube_touches_the_post_where_it_stops() -> None:
    scene = sliding(2.8, 0.5, 3.5)
    (touch,) = events.intervals(scene, 0, "touches", [2])
    assert touch[0] == pytest.approx(3.5 - events.SLIP * 3.0 / 2.8, abs=MS) and touch[1] == 4.0
    assert events.first_contact(scene, 0, 2) == touch[0] and events.first_contact(scene, 0, 4, after=0.0) is None


@settings(max_examples=10, deadline=None)
@given(st.floats(0.0, 0.012), st.floats(0.0, 3.0))
def test_contact_with_a_wall_does_not_flicker(shiver: float, phase: float) -> None:
    times = np.linspace(0.0, 4.0, 401)
    way = np.minimum(2.0 * times, 3.39) - shiver * (times > 1.7) * (1 + np.sin(37 * times + phase)) / 2
    things = {"cube": ((0.0, 0.0, 0.1), CUBE), "wall": ((3.5, 0.0, 1.0), (0.02, 8.0, 2.0)), "floor": FLOOR}
    scene = blocks(things, lambda ids: Track.slide(ids("cube"), times, way, (1.0, 0.0, 0.0), smooth=False))
    (touch,) = events.intervals(scene, 0, "touches", [1])
    assert touch[0] == pytest.approx(3.39 / 2.0, abs=0.012) and touch[1] == 4.0


@settings(max_examples=10, deadline=None)
@given(st.floats(0.5, 2.0), st.floats(0.1, 1.5))
def test_a_falling_block_falls_lands_and_leaves(height: float, start: float) -> None:
    seconds = math.sqrt(2 * height / 9.81)
    share = np.linspace(0.0, 1.0, 60)
    things = {"block": ((0.0, 0.0, height + 0.1), CUBE), "board": ((0.0, 0.5, height - 0.05), (0.9, 0.9, 0.1))}
    things["floor"] = FLOOR
    scene = blocks(
        things, lambda ids: Track.slide(ids("block"), start + seconds * share, -height * share**2, (0, 0, 1.0), False)
    )
    course = course_of(scene, 0)
    (fall,) = events.falls(course)
    assert fall == pytest.approx((start, start + seconds), abs=0.03)  # the first centimetre is slow
    assert events.path_length(course, fall) == pytest.approx(height, abs=0.01)
    (landed,) = events.intervals(scene, 0, "on", [2])
    assert landed[0] == pytest.approx(start + seconds, abs=0.005) and landed[1] == 4.0
    assert events.displacement(course)[2] == pytest.approx(-height, abs=1e-6)


@pytest.mark.parametrize("rate", [-1.0, 0.5, 7.0])
def test_turns_of_a_spin_are_counted_and_its_middle_stays(rate: float) -> None:
    scene = blocks(
        {"fan": ((0.0, 0.0, 2.0), (1.0, 0.2, 0.1)), "floor": FLOOR},
        lambda ids: Track.spin(ids("fan"), rate, (0, 0, 1.0), (0.0, 0.0, 2.0)),
    )
    course = course_of(scene, 0)
    assert events.turned(course) == pytest.approx(2 * math.pi * abs(rate) * 4, rel=1e-3)
    assert events.yawed(course, (1.0, 2.0)) == pytest.approx(2 * math.pi * rate, rel=1e-3)
    assert events.path_length(course) == pytest.approx(0.0, abs=1e-6)
    assert events.movements(course) == [(0.0, 4.0)]


def test_the_way_along_an_arc_and_of_a_bobbing_walk() -> None:
    times = np.linspace(0.0, 4.0, 81)
    things = {"cube": ((1.0, 0.0, 0.1), CUBE), "floor": FLOOR}
    angle = np.pi / 2 * times / 4
    path = np.stack([np.cos(angle), np.sin(angle), 0.02 * np.sin(8 * times) ** 2], axis=1)
    scene = blocks(things, lambda ids: Track.along(ids("cube"), times, path))
    course = course_of(scene, 0)
    assert events.path_length(course) == pytest.approx(np.pi / 2, rel=1e-3)
    assert float(np.linalg.norm(events.displacement(course))) == pytest.approx(math.sqrt(2), rel=2e-3)
    assert events.speeds(course, np.array([2.0]))[0] == pytest.approx(np.pi / 8, rel=0.05)


def test_a_short_rest_is_no_stop_and_noise_no_movement() -> None:
    def scene(times: list[float], way: list[float]) -> Scene:
        things = {"cube": ((0.0, 0.0, 0.1), CUBE), "floor": FLOOR}
        return blocks(things, lambda ids: Track.slide(ids("cube"), times, way, (1, 0, 0), smooth=False))

    paused = events.movements(course_of(scene([0.5, 1.0, 1.1, 2.0], [0, 1, 1, 2]), 0))
    stopped = events.movements(course_of(scene([0.5, 1.0, 1.5, 2.0], [0, 1, 1, 2]), 0))
    assert len(paused) == 1 and len(stopped) == 2
    assert events.movements(course_of(scene([0.5, 1.0, 1.5, 2.0], [0, 1e-3, 0, 1e-3]), 0)) == []


def test_a_part_that_moves_does_not_make_its_whole_move() -> None:
    scene = blocks(
        {"cube": ((0.0, 0.0, 0.1), CUBE)}, lambda ids: Track.slide(ids("cube")[:40], [0, 1], [0, 1], (1, 0, 0))
    )
    course = courses(scene)[0]
    assert not course.moves and course.moving_share == pytest.approx(40 / 125)
    assert events.movements(course) == [pytest.approx((0.0, 1.0), abs=0.02)]


def test_static_scenes_and_wrong_questions() -> None:
    scene = sliding(2.8, 0.5, 3.0).replace(motion=None)
    assert courses(scene) == {} and events.intervals(scene, 0, "moving") == []
    assert events.intervals(scene, 0, "touches", [4]) == [(0.0, 0.0)]
    assert events.intervals(scene.replace(motion=Motion()), 0, "left_of", [2]) == [(0.0, 0.0)]
    with pytest.raises(UserError, match="needs 1 of them"):
        events.intervals(scene, 0, "touches", [1, 2])
    with pytest.raises(UserError, match="is none of"):
        events.intervals(scene, 0, "loves", [1])
    with pytest.raises(UserError, match="no language field"):
        events.intervals(scene.replace(language=None), 0, "moving")


def test_sides_follow_a_moving_thing() -> None:
    scene = sliding(2.8, 0.0, 4.0)
    (before,) = events.intervals(scene, 0, "left_of", [1])
    (after,) = events.intervals(scene, 0, "right_of", [1])
    assert before == pytest.approx((0.0, 1.5 * 4 / 2.8), abs=MS) and after == pytest.approx(
        (1.5 * 4 / 2.8, 4.0), abs=MS
    )
    time, gap = events.nearest_time(scene, 0, 2)
    assert time == pytest.approx(4.0, abs=1e-3) and gap == pytest.approx(0.0, abs=1e-6)
