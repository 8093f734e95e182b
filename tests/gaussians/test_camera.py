"""Laws of the pinhole camera: a rigid pose, `look_at` aims at its target, resizing scales pixels in proportion."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import assume, given
from hypothesis import strategies as st

from scenewright.gaussians.camera import Camera, Render
from scenewright.gaussians.errors import UserError

coordinate = st.floats(-10, 10).map(lambda v: round(v, 4))
points = st.tuples(coordinate, coordinate, coordinate).map(np.array)
NUMERIC = 1e-9  # float64, coordinates up to ten, a dozen operations


@given(points, points, points, st.floats(10, 120))
def test_look_at(eye: np.ndarray, target: np.ndarray, up: np.ndarray, fov: float) -> None:
    assume(np.linalg.norm(target - eye) > 0.01 and np.linalg.norm(up) > 0.01)
    camera = Camera.look_at(eye, target, up, 640, 480, fov)
    rotation = camera.world_to_camera[:3, :3]
    assert np.allclose(rotation @ rotation.T, np.eye(3), atol=NUMERIC) and np.linalg.det(rotation) > 0
    assert np.allclose(camera.position, eye, atol=NUMERIC)
    pixels, depth = camera.project(target[None])
    assert np.allclose(pixels, [[320, 240]], atol=1e-5)  # a target 0.01 away magnifies rounding by f / depth
    assert depth[0] == pytest.approx(np.linalg.norm(target - eye))
    assert camera.world_to_camera[1, :3] @ up <= NUMERIC * 10  # the image's down is never up
    # A point half a field of view above the axis falls on the upper edge.
    edge = camera.position + camera.forward - camera.world_to_camera[1, :3] * math.tan(math.radians(fov) / 2)
    assert np.allclose(camera.project(edge[None])[0], [[320, 0]], atol=1e-5)


@given(points, points, st.integers(1, 2000), st.integers(1, 2000))
def test_resizing_moves_pixels_in_proportion(eye: np.ndarray, point: np.ndarray, width: int, height: int) -> None:
    camera = Camera.look_at(eye, eye + np.array([0, 1, 0]), (0, 0, 1), 640, 480)
    before, depth = camera.project(point[None])
    assume(depth[0] > 0.1)
    resized = camera.resized(width, height)
    after, depth_after = resized.project(point[None])
    assert np.allclose(after, before * (width / 640, height / 480)) and depth_after == depth
    assert (resized.width, resized.height) == (width, height)


@given(points)
def test_axes_are_right_down_forward(eye: np.ndarray) -> None:
    camera = Camera.look_at(eye, eye + np.array([0, 2, 0]), (0, 0, 1))
    assert np.allclose(camera.right, (1, 0, 0)) and np.allclose(camera.forward, (0, 1, 0))
    ahead = eye + np.array([[0.1, 1, 0], [0, 1, 0.1], [0, -1, 0]])
    pixels, depth = camera.project(ahead)
    assert pixels[0, 0] > camera.cx and pixels[1, 1] < camera.cy and depth[2] < 0


def test_looking_straight_down_still_works() -> None:
    camera = Camera.look_at((0, 0, 3), (0, 0, 0), (0, 0, 1))
    assert np.allclose(camera.forward, (0, 0, -1)) and abs(np.linalg.det(camera.world_to_camera)) == pytest.approx(1)


def test_the_pose_cannot_be_written() -> None:
    pose = np.eye(4)
    camera = Camera(pose, 1, 1, 0, 0, 2, 2)
    pose[0, 3] = 5
    assert camera.world_to_camera[0, 3] == 0
    with pytest.raises(ValueError, match="read-only"):
        camera.world_to_camera[0, 0] = 2


@pytest.mark.parametrize(
    "wrong",
    [
        {"world_to_camera": np.eye(3)},
        {"world_to_camera": np.full((4, 4), np.nan)},
        {"world_to_camera": np.diag([2.0, 1, 1, 1])},
        {"world_to_camera": np.diag([1.0, 1, -1, 1])},
        {"world_to_camera": np.diag([1.0, 1, 1, 2])},
        {"fx": 0},
        {"fy": -1},
        {"fx": math.nan},
        {"fx": math.inf},
        {"cx": math.nan},
        {"width": 0},
    ],
)
def test_impossible_cameras_are_refused(wrong: dict[str, Any]) -> None:
    fields = {"world_to_camera": np.eye(4), "fx": 1.0, "fy": 1.0, "cx": 0.0, "cy": 0.0, "width": 2, "height": 2}
    with pytest.raises(UserError, match="Camera"):
        Camera(**{**fields, **wrong})


@pytest.mark.parametrize("fov", [0, -20, 180, 400, math.nan])
def test_impossible_fields_of_view_are_refused(fov: float) -> None:
    with pytest.raises(UserError, match="field of view"):
        Camera.look_at((0, 0, 0), (1, 0, 0), (0, 0, 1), fov_y=fov)


def test_eye_and_target_must_differ() -> None:
    with pytest.raises(UserError, match="same point"):
        Camera.look_at((1, 2, 3), (1, 2, 3), (0, 0, 1))


def test_pictures_are_clipped_and_rounded() -> None:
    rgb = torch.tensor([[[-0.5, 0.5, 1.5]]])
    render = Render(rgb, torch.ones(1, 1), torch.ones(1, 1), torch.zeros(1, 1, dtype=torch.int32))
    assert render.to_uint8().tolist() == [[[0, 128, 255]]]
