"""The similarity between two frames of the same photographs: found exactly, and not found where there is none."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.files.captures.capture import to_transforms
from scenewright.gaussians.fit import load_photos
from scenewright.gaussians.fit.photographs.frames import similarity
from scenewright.gaussians.lens import Lens
from scenewright.gaussians.rotations import to_matrix

_QUATS = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: sum(c * c for c in q) > 0.1)


def _ring(count: int = 12) -> dict[str, Camera]:
    turns = np.linspace(0, 5, count)
    return {
        f"{i}.png": Camera.look_at(
            [3 * np.cos(t), 3 * np.sin(t), 1 + 0.1 * i], [0, 0, 0], [0, 0, 1], 40, 30, name=str(i)
        )
        for i, t in enumerate(turns)
    }


def _moved(camera: Camera, scale: float, turn: np.ndarray, offset: np.ndarray) -> Camera:
    pose = np.eye(4)
    pose[:3, :3] = camera.world_to_camera[:3, :3] @ turn.T
    pose[:3, 3] = -pose[:3, :3] @ (scale * turn @ camera.position + offset)
    return Camera(pose, camera.fx, camera.fy, camera.cx, camera.cy, camera.width, camera.height, camera.name)


@settings(max_examples=25, deadline=None)
@given(quat=_QUATS, scale=st.floats(0.01, 100), offset=st.tuples(*[st.floats(-50, 50)] * 3), in_a_line=st.booleans())
def test_a_similarity_is_found_also_from_cameras_in_a_line(
    quat: tuple[float, ...], scale: float, offset: tuple[float, ...], in_a_line: bool
) -> None:
    import torch

    q = torch.tensor(quat, dtype=torch.float64)
    turn = to_matrix((q / q.norm())[None]).numpy()[0]
    cameras = _ring()
    if in_a_line:
        cameras = {f"{i}.png": Camera.look_at([i, 0, 0], [i, 5, 0], [0, 0, 1], 40, 30) for i in range(5)}
    moved = {name: _moved(c, scale, turn, np.array(offset)) for name, c in cameras.items()}
    found = similarity(cameras, moved)
    assert found is not None
    points = np.random.default_rng(0).normal(size=(5, 3))
    expected = scale * points @ turn.T + np.array(offset)
    np.testing.assert_allclose(found.apply(points), expected, atol=1e-6 * (scale + np.abs(offset).max() + 1))


def test_the_same_frame_is_the_identity_and_other_poses_are_none() -> None:
    cameras = _ring()
    same = similarity(cameras, cameras)
    assert same is not None and same.is_identity()
    names = list(cameras)
    mixed = {
        name: cameras[other] for name, other in zip(names, np.random.default_rng(1).permutation(names), strict=True)
    }
    assert similarity(cameras, mixed) is None
    assert similarity(cameras, {"0.png": cameras["0.png"]}) is None


def test_points_follow_poses_that_a_converter_turned_and_scaled(tmp_path: Path) -> None:
    """As instant-ngp's colmap2nerf writes them: axes exchanged and one negated, moved to the middle and scaled."""
    cameras = list(_ring().values())
    (tmp_path / "sparse/0").mkdir(parents=True)
    (tmp_path / "images").mkdir()
    rng = np.random.default_rng(2)
    lines = []
    for i, camera in enumerate(cameras):
        Image.fromarray(rng.integers(0, 256, (30, 40, 3), dtype=np.uint8)).save(tmp_path / "images" / f"{i}.png")
        quat = _quat(camera.world_to_camera[:3, :3])
        lines += [" ".join(map(str, (i + 1, *quat, *camera.world_to_camera[:3, 3], 1, f"{i}.png"))), ""]
    focal = cameras[0].fx
    (tmp_path / "sparse/0/cameras.txt").write_text(f"1 PINHOLE 40 30 {focal} {focal} 20 15\n")
    (tmp_path / "sparse/0/images.txt").write_text("\n".join(lines) + "\n")
    points = rng.uniform(-0.5, 0.5, (200, 3))
    rows = [f"{i + 1} {x} {y} {z} 90 90 90 0.5" for i, (x, y, z) in enumerate(points)]
    (tmp_path / "sparse/0/points3D.txt").write_text("\n".join(rows) + "\n")
    turn, scale, offset = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]]), 1.7, np.array([4.0, -2, 9])
    moved = [_moved(c, scale, turn, offset) for c in cameras]
    told = to_transforms(moved, [Lens()] * len(moved), [f"images/{i}.png" for i in range(len(moved))])
    (tmp_path / "transforms.json").write_text(json.dumps(told))
    photos = load_photos(tmp_path)
    assert len(photos.notes) == 1
    assert "different frames" in photos.notes[0] and "scaled by 1.7" in photos.notes[0]
    np.testing.assert_allclose(photos.points.means, scale * points @ turn.T + offset, atol=1e-5)


def _quat(turn: np.ndarray) -> list[float]:
    import torch

    from scenewright.gaussians.rotations import from_matrix

    return [float(c) for c in from_matrix(torch.from_numpy(turn.copy())[None])[0]]


@pytest.mark.parametrize("strict", [True, False])
def test_a_listing_of_photographs_that_are_not_there(tmp_path: Path, strict: bool) -> None:
    cameras = list(_ring().values())
    (tmp_path / "images").mkdir()
    rng = np.random.default_rng(2)
    for i in range(8):
        Image.fromarray(rng.integers(0, 256, (30, 40, 3), dtype=np.uint8)).save(tmp_path / "images" / f"{i}.png")
    told = to_transforms(cameras, [Lens()] * len(cameras), [f"images/{i}.png" for i in range(len(cameras))])
    (tmp_path / "transforms.json").write_text(json.dumps(told))
    if strict:
        with pytest.raises(Exception, match=r"8\.png is missing, and so are 3 more"):
            load_photos(tmp_path)
        return
    photos = load_photos(tmp_path, strict=False)
    assert photos.missing == ("8.png", "9.png", "10.png", "11.png")
    assert {int(s.camera.name) for s in (*photos.shots, *photos.held_out)} == set(range(8))
