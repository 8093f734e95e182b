"""Crops of groups from photographs: the right group, alone on grey, from the photographs that show it best."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.files.captures.capture import Capture, read_capture, to_transforms
from scenewright.gaussians.language.field.photograph_crops import BEST, crops_of
from scenewright.gaussians.lens import Lens
from scenewright.gaussians.render import render
from scenewright.gaussians.scene import Scene


class MeanColor:
    """An encoder whose vector is the mean colour of what is not grey, and which keeps the images."""

    fingerprint, dim, image_size = "mean:1", 3, 32

    def __init__(self) -> None:
        self.seen: list[NDArray[np.uint8]] = []
        self.fingerprint = f"mean:{id(self)}"  # so that cached vectors of another test are not used

    def encode_images(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        self.seen += list(images)
        away = images.astype(np.float32) - 127.5
        shown = (np.abs(away).max(axis=-1, keepdims=True) > 20) * images.astype(np.float32)
        total = shown.sum(axis=(1, 2)) + 1e-3
        rows: NDArray[np.float32] = (total / np.linalg.norm(total, axis=1, keepdims=True)).astype(np.float32)
        return rows


def stand_in() -> Any:
    """The encoder, of which crops need the image tower only."""
    return MeanColor()


@pytest.fixture
def two(world: Any) -> Scene:
    """A red box and a blue one."""
    made = world().box("red", (-0.9, -0.3, 0), (-0.3, 0.3, 0.6), (0.8, 0.1, 0.1), 0.05)
    return Scene(made.box("blue", (0.3, -0.3, 0), (0.9, 0.3, 0.6), (0.1, 0.1, 0.8), 0.05).cloud())


def capture_of(folder: Path, scene: Scene) -> Capture:
    (folder / "images").mkdir()
    cameras = []
    for i, angle in enumerate(np.linspace(0, 2 * np.pi, 8, endpoint=False)):
        eye = [3 * np.cos(angle), 3 * np.sin(angle), 1.5]
        cameras.append(Camera.look_at(eye, [0, 0, 0.3], [0, 0, 1], 160, 120, 45, f"view{i}"))
        Image.fromarray(render(scene.cloud, cameras[-1]).to_uint8()).save(folder / f"images/view{i}.png")
    told = to_transforms(cameras, [Lens()] * 8, [f"images/view{i}.png" for i in range(8)])
    (folder / "transforms.json").write_text(json.dumps(told))
    return read_capture(folder)


def test_each_group_is_cut_out_of_the_photographs(tmp_path: Path, two: Scene) -> None:
    capture, encoder = capture_of(tmp_path, two), stand_in()
    rgb = two.cloud.sh[:, 0].numpy()
    owner = np.where(rgb[:, 0] > rgb[:, 2], 0, 1).astype(np.int32)
    found = crops_of(two, owner, capture, encoder)
    assert found.photographs == 8 and (found.pixels > 500).all()
    assert found.vectors[0, 0] > 0.9 and found.vectors[1, 2] > 0.9  # red, and blue
    np.testing.assert_allclose(np.linalg.norm(found.vectors, axis=1), 1, atol=1e-5)
    images = [image for image in encoder.seen if image.any()]  # the cache fills its batches with black
    assert len(images) == 2 * BEST
    for image in images:
        assert np.abs(image[[0, 0, -1, -1], [0, -1, 0, -1]].astype(int) - 127).max() <= 2  # grey around it
    again = crops_of(two, owner, capture, stand_in())
    assert again.vectors.tobytes() == found.vectors.tobytes()


def test_what_no_photograph_shows_has_no_vector(tmp_path: Path, two: Scene) -> None:
    capture = capture_of(tmp_path, two)
    rgb = two.cloud.sh[:, 0].numpy()
    owner = np.where(rgb[:, 0] > rgb[:, 2], 0, 2).astype(np.int32)
    owner[np.flatnonzero(owner == 0)[0]] = 1  # one Gaussian is too little to be shown
    found = crops_of(two, owner, capture, stand_in())
    assert not found.vectors[1].any() and found.pixels[1] == 0 and found.vectors[0].any()


def test_an_encoder_without_an_image_tower_gets_nothing(tmp_path: Path, two: Scene) -> None:
    encoder = stand_in()
    encoder.image_size = 0
    found = crops_of(two, np.zeros(len(two.cloud), np.int32), capture_of(tmp_path, two), encoder)
    assert found.photographs == 0 and not found.vectors.any() and not encoder.seen
