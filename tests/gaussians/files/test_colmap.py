"""COLMAP models, binary and text, and lens distortion: hand-made files with known content, and randomly broken ones."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import FileError
from scenewright.gaussians.files.captures import colmap
from scenewright.gaussians.files.captures.capture import read_capture
from scenewright.gaussians.lens import Lens, undistort

QUAT, OFFSET = (np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0), (0.1, -0.2, 3.0)  # a quarter turn about y


def binary(folder: Path) -> Path:
    """Two photographs by an OPENCV and a SIMPLE_RADIAL camera, three points, one of them not finite."""
    folder.mkdir(parents=True)
    (folder / "cameras.bin").write_bytes(
        struct.pack("<Q", 2)
        + struct.pack("<IiQQ8d", 1, 4, 80, 60, 70, 71, 40, 30, 0.1, -0.02, 0.001, -0.002)
        + struct.pack("<IiQQ4d", 7, 2, 80, 60, 75, 40, 30, 0.05)
    )
    image = b"".join(
        struct.pack("<I7dI", i, *QUAT, *OFFSET, camera) + name + b"\0" + struct.pack("<Q", 2) + bytes(48)
        for i, camera, name in ((1, 7, b"b.jpg"), (2, 1, b"a.jpg"))
    )
    (folder / "images.bin").write_bytes(struct.pack("<Q", 2) + image)
    points = b"".join(
        struct.pack("<Q3d3BdQ", i, x, 2.0, 3.0, 255, 0, 51, 0.5, 1) + bytes(8)
        for i, x in ((1, 1.0), (2, float("nan")), (3, -1.0))
    )
    (folder / "points3D.bin").write_bytes(struct.pack("<Q", 3) + points)
    return folder


def text(folder: Path) -> Path:
    """The same model as text files."""
    folder.mkdir(parents=True)
    (folder / "cameras.txt").write_text(
        "# cameras\n1 OPENCV 80 60 70 71 40 30 0.1 -0.02 0.001 -0.002\n7 SIMPLE_RADIAL 80 60 75 40 30 0.05\n"
    )
    pose = " ".join(str(float(n)) for n in (*QUAT, *OFFSET))
    (folder / "images.txt").write_text(f"# images\n1 {pose} 7 b.jpg\n1 2 -1\n2 {pose} 1 a.jpg\n\n")
    (folder / "points3D.txt").write_text(
        "1 1 2 3 255 0 51 0.5 1 0\n2 nan 2 3 255 0 51 0.5 1 0\n3 -1 2 3 255 0 51 0.5 1 0\n"
    )
    return folder


@pytest.mark.parametrize("write", [binary, text])
def test_a_model_is_read_as_it_was_written(tmp_path: Path, write: object) -> None:
    folder = write(tmp_path / "sparse" / "0")  # type: ignore[operator]
    assert colmap.find(tmp_path) == folder
    a, b = colmap.read_views(folder)
    assert (a.name, b.name) == ("a.jpg", "b.jpg") and (a.camera.fx, a.camera.fy, b.camera.fy) == (70, 71, 75)
    assert a.lens == Lens(0.1, -0.02, 0.0, 0.001, -0.002) and b.lens == Lens(0.05)
    # world x goes to the camera's -z, world z to its x: wxyz (sqrt 1/2, 0, sqrt 1/2, 0) is +90 degrees about y
    wanted = [[0, 0, 1, 0.1], [0, 1, 0, -0.2], [-1, 0, 0, 3.0], [0, 0, 0, 1]]
    assert np.allclose(a.camera.world_to_camera, wanted, atol=1e-12)
    points = colmap.read_points(folder)
    assert np.array_equal(points.means, [[1, 2, 3], [-1, 2, 3]]) and np.allclose(points.colors, [[1, 0, 0.2]] * 2)


def test_a_capture_may_be_a_model_with_photographs(tmp_path: Path) -> None:
    binary(tmp_path / "sparse" / "0")
    taken = read_capture(tmp_path)
    assert [p.relative_to(tmp_path).as_posix() for p in taken.photos] == ["images/a.jpg", "images/b.jpg"]
    assert [c.name for c in taken.cameras] == ["a", "b"] and not taken.lenses[0].is_identity


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=150)
@given(st.sampled_from(["cameras", "images", "points3D"]), st.data())
def test_broken_models_are_file_errors(
    tmp_path_factory: pytest.TempPathFactory, name: str, data: st.DataObject
) -> None:
    folder = binary(tmp_path_factory.mktemp("model") / "sparse")
    path = folder / f"{name}.bin"
    whole = bytearray(path.read_bytes())
    if data.draw(st.booleans()):
        del whole[data.draw(st.integers(0, len(whole) - 1)) :]
    else:
        whole[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(whole)
    try:
        colmap.read_views(folder)
        colmap.read_points(folder)
    except FileError as error:
        assert str(tmp_path_factory.getbasetemp()) in str(error)


@pytest.mark.parametrize(
    ("file", "line", "told"),
    [
        ("cameras.txt", "1 FISHEYE 80 60 70 40 30 0.1", "camera model FISHEYE is not known"),
        ("cameras.txt", "1 PINHOLE 80 60 70 71", "has 2 parameters, PINHOLE has 4"),
        ("cameras.txt", "1 PINHOLE 80 60 x 71 40 30", "could not convert"),
        ("images.txt", "1 1 0 0 0 0 0 0 9 a.jpg", "was taken by camera 9, which is not listed"),
        ("images.txt", "1 0 0 0 0 0 0 0 1 a.jpg", "a.jpg is invalid"),
        ("images.txt", "1 1 0 0 0 nan 0 0 1 a.jpg", "not finite"),
        ("images.txt", "1 1 0 0 0", "has 5 entries"),
        ("images.txt", "", "lists no photographs"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, file: str, line: str, told: str) -> None:
    folder = text(tmp_path / "sparse")
    (folder / file).write_text(line + "\n")
    with pytest.raises(FileError, match=told):
        colmap.read_views(folder)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    folder = text(tmp_path / "sparse")
    (folder / "points3D.txt").unlink()
    with pytest.raises(FileError, match=r"no points3D\.bin or points3D\.txt"):
        colmap.read_points(folder)


def test_an_undistorted_photograph_shows_each_point_where_the_pinhole_camera_projects_it() -> None:
    """Draw soft dots at their distorted positions; after undistortion they must be at the pinhole positions."""
    camera, lens = Camera(np.eye(4), 90, 92, 60, 45, 120, 90), Lens(-0.15, 0.03, 0.0, 0.004, -0.003)
    rows, columns = np.mgrid[0:90, 0:120] + 0.5
    for x, y in ((0.0, 0.0), (0.4, 0.3), (-0.45, 0.1), (0.2, -0.35)):
        bent_x, bent_y = lens.distort(np.array(x), np.array(y))
        dot = np.exp(-((columns - 90 * bent_x - 60) ** 2 + (rows - 92 * bent_y - 45) ** 2) / 8)
        photo = np.repeat((255 * dot)[..., None], 3, axis=2).astype(np.uint8)
        flat = undistort(photo, camera, lens)[..., 0].astype(float)
        seen = np.array([(flat * columns).sum(), (flat * rows).sum()]) / flat.sum()
        assert np.abs(seen - [90 * x + 60, 92 * y + 45]).max() < 0.15  # px: 8 bits and a dot that is bent itself


def test_an_identity_lens_leaves_the_photograph_as_it_is() -> None:
    photo = np.random.default_rng(0).integers(0, 256, (8, 9, 3), dtype=np.uint8)
    assert undistort(photo, Camera(np.eye(4), 9, 9, 4, 4, 9, 8), Lens()) is photo
