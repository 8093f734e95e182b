"""Crops of groups from photographs: the right group, alone on grey, from the photographs that show it best."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from painted_world import World
from PIL import Image

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import concat
from scenewright.gaussians.files.captures.capture import Capture, read_capture, to_transforms
from scenewright.gaussians.language.encoders.calibration import Calibration
from scenewright.gaussians.language.encoders.vocabulary import Vocabulary
from scenewright.gaussians.language.field.embed import embed
from scenewright.gaussians.language.field.group_table import renamed
from scenewright.gaussians.language.field.photograph_crops import BEST, crops_of
from scenewright.gaussians.lens import Lens
from scenewright.gaussians.render import render
from scenewright.gaussians.scene import Frame, Scene


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


class Named(MeanColor):
    """The same with names: what is red, green and blue, and what is no object, which looks grey."""

    vocabulary = Vocabulary({"tomato": (), "lime": (), "plum": ()}, {}, ("part of something",))
    calibration = Calibration(scale=20.0, threshold=0.3)

    def __init__(self, on_background: bool) -> None:
        super().__init__()
        self.on_background = on_background

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        names = list(self.vocabulary.names)
        grey = np.full(3, 3**-0.5, np.float32)
        rows = [np.eye(3, dtype=np.float32)[names.index(t)] if t in names else grey for t in texts]
        return np.stack(rows) if rows else np.zeros((0, 3), np.float32)

    def unknown_words(self, text: str) -> tuple[str, ...]:
        return tuple(w for w in text.split() if w not in self.vocabulary.names)

    def knows(self, text: str) -> bool:
        return bool(text) and not self.unknown_words(text)


@pytest.fixture
def two() -> Scene:
    """A red box and a blue one."""
    made = World().box("red", (-0.9, -0.3, 0), (-0.3, 0.3, 0.6), (0.8, 0.1, 0.1), 0.05)
    return Scene(made.box("blue", (0.3, -0.3, 0), (0.9, 0.3, 0.6), (0.1, 0.1, 0.8), 0.05).cloud())


@pytest.fixture
def room() -> Scene:
    """A red box and a blue one on a grey floor."""
    made = World().sheet("floor", (-1.5, -1, 0), (3, 0, 0), (0, 2, 0), (0.5, 0.5, 0.5), 0.06)
    made.box("red", (-0.9, -0.3, 0.02), (-0.4, 0.2, 0.5), (0.8, 0.1, 0.1), 0.04)
    made.box("blue", (0.4, -0.3, 0.02), (0.9, 0.2, 0.5), (0.1, 0.1, 0.8), 0.04)
    return Scene(made.cloud(), Frame(up_source="given", floor=0.0))


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


def repainted(capture: Capture) -> Capture:
    """The photographs with what is blue painted green, so that they can be told from renders of the scene."""
    for photo in capture.photos:
        rgb = np.asarray(Image.open(photo).convert("RGB"))
        blue = rgb[..., 2] > rgb[..., 0].astype(int) + 40
        Image.fromarray(np.where(blue[..., None], rgb[..., [0, 2, 1]], rgb)).save(photo)
    return capture


def names_of(scene: Scene) -> list[str]:
    assert scene.language is not None
    return sorted(g.label for g in scene.language.objects())


@pytest.mark.slow
def test_only_encoders_of_photographs_are_shown_them(tmp_path: Path, room: Scene) -> None:
    capture = repainted(capture_of(tmp_path, room))
    photographic, rendered = Named(on_background=True), Named(on_background=False)
    shown = embed(room, photographic, capture=capture)
    assert names_of(shown) == ["lime", "tomato"]
    assert shown.language is not None and shown.language.making is not None
    assert shown.language.making.photographs == 8
    assert any("from 8 photographs" in line for line in shown.language.making.lines())
    for scene in (embed(room, rendered, capture=capture), embed(room, photographic), renamed(shown, photographic)):
        assert names_of(scene) == ["plum", "tomato"]
        assert scene.language is not None and scene.language.making is not None
        assert scene.language.making.photographs == 0


def test_photographs_that_are_missing_leave_the_renders(tmp_path: Path, room: Scene) -> None:
    capture = repainted(capture_of(tmp_path, room))
    for photo in capture.photos:
        photo.unlink()
    scene = embed(room, Named(on_background=True), capture=capture)
    assert names_of(scene) == ["plum", "tomato"]
    assert scene.language is not None and scene.language.making is not None
    assert scene.language.making.photographs == 0


def test_what_no_photograph_shows_is_named_by_renders(tmp_path: Path, room: Scene) -> None:
    capture = repainted(capture_of(tmp_path, room))
    apart = room.cloud.replace(means=room.cloud.means + torch.tensor([12.0, 0.0, 0.0]))
    both = concat([room.cloud, apart.replace(ids=apart.ids + len(room.cloud))])
    scene = embed(room.replace(cloud=both), Named(on_background=True), capture=capture)
    assert names_of(scene) == ["lime", "plum", "tomato", "tomato"]
