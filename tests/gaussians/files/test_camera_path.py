"""Camera paths in files: our format, nerfstudio's, and invalid content."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import FileError
from scenewright.gaussians.files.captures.camera_path import read_camera_path

UP = (0.0, 0.0, 1.0)
A = {"position": [3, 0, 1], "target": [0, 0, 0]}
B = {"position": [0, 3, 1], "target": [0, 0, 0]}
POSE = [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]


def written(tmp_path: Path, told: Any) -> Path:
    path = tmp_path / "path.json"
    path.write_text(json.dumps(told))
    return path


def test_keyframes_with_their_own_and_shared_words(tmp_path: Path) -> None:
    told = {"fov": 40, "fps": 30, "size": [640, 360], "keyframes": [
        {**A, "time": 1}, {**B, "time": 2.5, "fov": 60, "up": [0, 1, 0]}]}  # fmt: skip
    path = read_camera_path(written(tmp_path, told), UP)
    assert (path.fps, path.size, path.seconds) == (30, (640, 360), 1.5)
    first, second = path.keyframes
    assert first.up == UP and second.up == (0, 1, 0) and first.target == (0, 0, 0)
    assert np.allclose(first.camera.position, (3, 0, 1))
    fovs = [2 * np.degrees(np.arctan(0.5 * k.camera.height / k.camera.fy)) for k in path.keyframes]
    assert fovs == pytest.approx([40, 60])


def test_a_matrix_is_a_keyframe_and_times_may_be_left_out(tmp_path: Path) -> None:
    camera = Camera.look_at((1, 2, 3), (0, 0, 0), UP)
    told = {"keyframes": [{"world_to_camera": camera.world_to_camera.tolist()}, A]}
    path = read_camera_path(written(tmp_path, told), UP)
    assert np.allclose(path.keyframes[0].camera.world_to_camera, camera.world_to_camera)
    assert path.keyframes[0].target is None and path.seconds > 0


def test_nerfstudio(tmp_path: Path) -> None:
    """Its axes are OpenGL's: at the identity it looks along -z with +y up."""
    there = np.eye(4)
    there[:3, 3] = (1, 2, 3)
    pictures = [{"camera_to_world": there.reshape(-1).tolist(), "fov": 50, "aspect": 1.5} for _ in range(3)]
    told = {"camera_type": "perspective", "render_width": 300, "render_height": 200, "fps": 12, "seconds": 0.25,
            "camera_path": pictures, "keyframes": ["whatever the viewer keeps"]}  # fmt: skip
    path = read_camera_path(written(tmp_path, told), UP)
    assert (path.fps, path.size, path.seconds) == (12, (300, 200), pytest.approx(2 / 12))
    camera = path.keyframes[0].camera
    assert np.allclose(camera.position, (1, 2, 3)) and np.allclose(camera.forward, (0, 0, -1))
    assert np.allclose(camera.world_to_camera[1, :3], (0, -1, 0))


@pytest.mark.parametrize(
    ("told", "says"),
    [
        ([], "not a camera path"),
        ({}, "not a camera path"),
        ({"keyframes": []}, "1 to"),
        ({"keyframes": [A] * 20_001}, "1 to"),
        ({"keyframes": {}}, "1 to"),
        ({"keyframes": [3]}, "keyframe 0"),
        ({"keyframes": [A, {"position": [0, 0, 0]}]}, "keyframe 1 has no target"),
        ({"keyframes": [{**A, "position": [0, 0]}]}, "three numbers"),
        ({"keyframes": [{**A, "position": ["1", 0, 0]}]}, "position must be a number"),
        ({"keyframes": [{**A, "position": [True, 0, 0]}]}, "position must be a number"),
        ({"keyframes": [{**A, "position": [float("nan"), 0, 0]}]}, "position must be a number"),
        ({"keyframes": [{**A, "position": [10**400, 0, 0]}]}, "position must be a number"),
        ({"keyframes": [{**A, "position": [0, 0, 0]}]}, "same point"),
        ({"keyframes": [{**A, "fov": 180}]}, "field of view"),
        ({"keyframes": [{**A, "up": [0, 0, 0]}]}, "up must be a direction"),
        ({"keyframes": [{**A, "time": 0}, B]}, "no time"),
        ({"keyframes": [{**A, "time": 1}, {**B, "time": 1}]}, "ascend"),
        ({"keyframes": [{**A, "time": float("inf")}]}, "time must be a number"),
        ({"keyframes": [{**A, "world_to_camera": POSE}]}, "not both"),
        ({"keyframes": [{"world_to_camera": [[2, 0, 0, 0], *POSE[1:]]}]}, "rigid"),
        ({"keyframes": [{"world_to_camera": [1, 2, 3]}]}, "4x4"),
        ({"keyframes": [{"world_to_camera": [[[1]]] * 16}]}, "must be a number"),
        ({"keyframes": [{"world_to_camera": POSE, "fov": 0}]}, "field of view"),
        ({"keyframes": [A], "fps": 0}, "fps"),
        ({"keyframes": [A], "size": [0, 10]}, "size"),
        ({"keyframes": [A], "size": [1.5, 10]}, "size"),
        ({"keyframes": [A], "size": 7}, "size"),
        ({"camera_path": []}, "1 to"),
        ({"camera_path": [{"fov": 50}]}, "picture 0 has no camera_to_world"),
        ({"camera_path": [{"camera_to_world": [1] * 16, "fov": 50}]}, "rigid"),
        ({"camera_path": [{"camera_to_world": [1] * 15, "fov": 50}]}, "4x4"),
        ({"camera_path": [1], "render_width": 10}, "render_height"),
        ({"camera_path": [1], "camera_type": "fisheye"}, "fisheye"),
    ],
)
def test_a_broken_file_is_one_error_that_says_where(tmp_path: Path, told: Any, says: str) -> None:
    with pytest.raises(FileError, match=says):
        read_camera_path(written(tmp_path, told), UP)


def test_a_missing_file_and_no_json(tmp_path: Path) -> None:
    for content in (None, b"", b"\xff\xfe", b"[" * 100_000):
        path = tmp_path / "path.json"
        if content is not None:
            path.write_bytes(content)
        with pytest.raises(FileError):
            read_camera_path(path, UP)


json_ = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=4),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(
        st.sampled_from(["position", "target", "up", "fov", "time", "world_to_camera", "camera_to_world"]), inner),
    max_leaves=12,
)  # fmt: skip


@given(st.dictionaries(st.sampled_from(["keyframes", "camera_path", "fps", "size", "up", "fov", "camera_type"]), json_))
def test_whatever_is_in_the_file_it_is_a_path_or_a_file_error(tmp_path_factory: Any, told: Any) -> None:
    path = written(tmp_path_factory.getbasetemp(), told)
    try:
        read = read_camera_path(path, UP)
    except FileError:
        return
    cameras = read.cameras([0.0, read.seconds], 8, 8)
    assert all(np.isfinite(camera.world_to_camera).all() for camera in cameras)
