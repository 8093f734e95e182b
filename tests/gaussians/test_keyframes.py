"""Laws of camera paths: they pass every keyframe, stay near the chords between them, and rest at equal keyframes."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.viewpoints.keyframes import CameraPath, Keyframe, spline

UP = (0.0, 0.0, 1.0)
coordinate = st.floats(-10, 10).map(lambda v: round(v, 3))
steps = st.lists(st.floats(0.001, 100), min_size=1, max_size=6)
NUMERIC = 1e-7  # float64; speeds of up to 20 / 0.001 are multiplied with intervals of up to 100


def keyframe(time: float, eye: tuple[float, float, float], aimed: bool = True, fov: float = 50.0) -> Keyframe:
    camera = Camera.look_at(eye, (0, 0, 0), UP, 100, 100, fov)
    return Keyframe(time, camera, (0.0, 0.0, 0.0) if aimed else None, UP)


@st.composite
def knots(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray]:
    times = np.concatenate([[0.0], np.cumsum(draw(steps))])
    values = [[draw(coordinate) for _ in range(3)] for _ in times]
    return times, np.array(values)


@given(knots())
def test_a_spline_goes_through_its_knots_and_never_far_beyond_them(given_: tuple[np.ndarray, np.ndarray]) -> None:
    times, values = given_
    assert np.allclose(spline(times, values, times), values, atol=NUMERIC)
    for i, (a, b) in enumerate(itertools.pairwise(times)):
        between = spline(times, values, np.linspace(a, b, 20))
        chord = float(np.linalg.norm(values[i + 1] - values[i]))
        # A cubic with end speeds of at most 1.5 chords an interval strays by at most 2 * 1.5 * 4/27 of the chord.
        on = values[i] + np.linspace(0, 1, 20)[:, None] * (values[i + 1] - values[i])
        off = np.linalg.norm(between - on, axis=1)
        assert off.max() <= (2 * 1.5 * 4 / 27 + 0.2) * chord + NUMERIC  # 0.2: smooth in and out along the chord


@given(knots(), coordinate)
def test_where_two_knots_are_equal_the_spline_rests(given_: tuple[np.ndarray, np.ndarray], more: float) -> None:
    times, values = given_
    times = np.append(times, times[-1] + 1)
    values = np.append(values, values[-1:], axis=0)
    times, values = np.append(times, times[-1] + 1), np.append(values, [[more, 0, 0]], axis=0)
    resting = spline(times, values, np.linspace(times[-3], times[-2], 9))
    assert np.allclose(resting, values[-2], atol=NUMERIC)


@given(st.lists(st.tuples(coordinate, coordinate, coordinate), min_size=2, max_size=5), steps, st.booleans())
def test_every_keyframe_is_passed_as_it_was_given(
    eyes: list[tuple[float, float, float]], gaps: list[float], aimed: bool
) -> None:
    eyes = [(x, y - 20, z) for x, y, z in eyes]  # all in front of the target, so that it is never flown spline
    times = np.concatenate([[3.0], 3.0 + np.cumsum((gaps * 5)[: len(eyes) - 1])])
    path = CameraPath(tuple(keyframe(t, eye, aimed) for t, eye in zip(times.tolist(), eyes, strict=True)))
    cameras = path.cameras((times - 3.0).tolist(), 120, 80)
    for made, known in zip(cameras, path.keyframes, strict=True):
        assert np.allclose(made.world_to_camera, known.camera.world_to_camera, atol=1e-5)
        assert (made.width, made.height) == (120, 80) and made.fy == pytest.approx(
            40 / np.tan(np.radians(25)), rel=1e-6
        )


def test_a_camera_with_targets_never_looks_away_from_them() -> None:
    eyes = [(4.0, 0.0, 1.0), (0.0, 4.0, 1.0), (-4.0, 0.0, 1.0), (0.0, -4.0, 1.0)]
    path = CameraPath(tuple(keyframe(float(i), eye) for i, eye in enumerate(eyes)))
    for camera in path.cameras(np.linspace(0, 3, 31).tolist(), 100, 100):
        pixels, depth = camera.project(np.zeros((1, 3)))
        assert np.allclose(pixels, 50, atol=1e-6) and depth[0] > 2


@given(st.lists(st.floats(-180, 180), min_size=2, max_size=6), st.lists(st.floats(0.01, 50), min_size=5, max_size=5))
def test_turns_are_never_undefined(degrees: list[float], gaps: list[float]) -> None:
    """Also half turns, and keyframes in very uneven time: the spline of quaternions stays away from zero."""
    frames, time = [], 0.0
    for angle, gap in zip(degrees, [*gaps, 1.0], strict=False):
        a = np.radians(angle)
        frames.append(Keyframe(time, Camera.look_at((0, 0, 0), (np.cos(a), np.sin(a), 0.1), UP)))
        time += gap
    for camera in CameraPath(tuple(frames)).cameras(np.linspace(0, time, 60).tolist(), 10, 10):
        assert np.isfinite(camera.world_to_camera).all() and np.allclose(camera.position, 0, atol=1e-9)


def test_one_keyframe_is_a_still_and_before_and_after_a_path_are_its_ends() -> None:
    still = CameraPath((keyframe(5.0, (3, 0, 1)),))
    assert still.seconds == 0
    a, b = still.cameras([0.0, 9.0], 10, 10)
    assert np.array_equal(a.world_to_camera, b.world_to_camera)
    path = CameraPath((keyframe(0.0, (3, 0, 1)), keyframe(1.0, (0, 3, 1))))
    first, last = path.cameras([-5.0, 5.0], 10, 10)
    assert np.allclose(first.position, (3, 0, 1)) and np.allclose(last.position, (0, 3, 1))


def test_the_field_of_view_moves_too() -> None:
    path = CameraPath((keyframe(0.0, (3, 0, 1), fov=20), keyframe(1.0, (3, 0, 1), fov=60)))
    wide = [2 * np.degrees(np.arctan(50 / c.fy)) for c in path.cameras([0, 0.5, 1], 100, 100)]
    assert wide == pytest.approx([20, 40, 60])


@pytest.mark.parametrize("times", [(), (1.0, 1.0), (2.0, 1.0), (0.0, float("nan")), (float("inf"),)])
def test_times_must_ascend(times: tuple[float, ...]) -> None:
    with pytest.raises(UserError):
        CameraPath(tuple(keyframe(t, (3, 0, 1)) for t in times))
