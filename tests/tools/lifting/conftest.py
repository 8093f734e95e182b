"""A chequered floor with a red stripe that a box hides from some sides: photographs, and the scene fitted to them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.files.captures.capture import read_capture, to_transforms
from scenewright.gaussians.harmonics import color_to_dc
from scenewright.gaussians.lens import Lens
from scenewright.gaussians.render import render
from scenewright.gaussians.scene import Scene
from scenewright.tools.filling.new_rows import FLAT
from scenewright.tools.lifting.behind import Photographs

STEP = 0.05
FLOOR, BOX = 0, 1
SIZE = (192, 144)


def sheet(points: np.ndarray, normal: int, rgb: np.ndarray, group: int) -> GaussianCloud:
    """Flat Gaussians at points `[N, 3]`."""
    scales = np.full((len(points), 3), 0.6 * STEP, np.float32)
    scales[:, normal] = 0.1 * 0.6 * STEP
    return GaussianCloud.create(
        torch.from_numpy(points.astype(np.float32)), torch.tensor([1.0, 0, 0, 0]).repeat(len(points), 1),
        torch.from_numpy(scales), torch.full((len(points),), 0.95),
        color_to_dc(torch.from_numpy(rgb.astype(np.float32)))[:, None],
        torch.full((len(points),), group, dtype=torch.int32),
    )  # fmt: skip


def _grid(low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    a = np.arange(low, high, STEP) + STEP / 2
    x, y = np.meshgrid(a, a, indexing="ij")
    return x.ravel(), y.ravel()


def floor() -> GaussianCloud:
    x, y = _grid(-1.2, 1.2)
    grey = 0.4 + 0.15 * ((np.floor(x / 0.2) + np.floor(y / 0.2)) % 2)
    rgb = np.where((np.abs(y - 0.3) < 0.1)[:, None], [0.8, 0.15, 0.1], grey[:, None])
    return sheet(np.stack([x, y, 0 * x], 1), 2, rgb, FLOOR)


def box(size: float = 0.4) -> GaussianCloud:
    a, b = _grid(-size / 2, size / 2)
    blue, middle = np.tile([0.2, 0.3, 0.8], (len(a), 1)), np.array([0, 0, size / 2 + STEP / 2])
    return numbered([
        sheet(np.insert(np.stack([a, b], 1), axis, end, axis=1) + middle, axis, blue, BOX)
        for axis in range(3)
        for end in (-size / 2, size / 2)
    ])  # fmt: skip


def ring(count: int) -> list[Camera]:
    """Cameras from all sides."""
    turns = 2 * np.pi * np.arange(count) / count
    eyes = np.stack([1.9 * np.cos(turns), 1.9 * np.sin(turns), np.full(count, 1.3)], 1)
    return [Camera.look_at(e, [0, 0, 0.1], [0, 0, 1], *SIZE, 50.0, f"photo_{k:02d}") for k, e in enumerate(eyes)]


@dataclass(frozen=True, eq=False)
class Room:
    """
    Attributes:
        fitted: the scene with the box, and with a hole in the floor; the floor's Gaussians come first.
        filled: without the box, with a grey fill.
        new: ids of the fill.
        photographs: that show the floor as it is, and the box.
        truth: the floor as it is.
    """

    fitted: Scene
    filled: Scene
    new: torch.Tensor
    photographs: Photographs
    truth: GaussianCloud


def numbered(clouds: list[GaussianCloud]) -> GaussianCloud:
    """The clouds as one, with ids from 0."""
    cloud = concat([c.replace(ids=torch.arange(len(c)) + 1_000_000 * k) for k, c in enumerate(clouds)])
    return cloud.replace(ids=torch.arange(len(cloud)))


def write_capture(folder: Path, cloud: GaussianCloud, cameras: list[Camera]) -> Path:
    """Photographs of a cloud with a `transforms.json`."""
    (folder / "images").mkdir(parents=True)
    for camera in cameras:
        Image.fromarray(render(cloud, camera).to_uint8()).save(folder / "images" / f"{camera.name}.png")
    names = [f"images/{c.name}.png" for c in cameras]
    (folder / "transforms.json").write_text(json.dumps(to_transforms(cameras, [Lens()] * len(cameras), names)))
    return folder


@pytest.fixture(scope="session")
def room(tmp_path_factory: pytest.TempPathFactory) -> Room:
    """The hole reaches from under the box to behind it, with a part of the stripe."""
    means = floor().means
    missing = (means[:, 0].abs() < 0.3) & (means[:, 1] > -0.2) & (means[:, 1] < 0.45)
    return _room(tmp_path_factory.mktemp("capture"), missing)


def _room(folder: Path, missing: torch.Tensor) -> Room:
    whole, thing = floor(), box()
    fitted = numbered([whole[~missing], thing])
    capture = read_capture(write_capture(folder / "taken", numbered([whole, thing]), ring(12)))
    scene = Scene(fitted, cameras=capture.cameras)
    guess = whole[missing]
    grey = color_to_dc(torch.full((len(guess), 3), 0.47))[:, None]
    proportions = torch.tensor([1.0, 1.0, FLAT]) * 0.6 * STEP
    new = guess.replace(
        sh=grey, scales=proportions.expand(len(guess), 3).clone(), ids=torch.arange(len(guess)) + len(fitted)
    )
    filled = scene.replace(cloud=concat([fitted[fitted.group == FLOOR], new]))
    return Room(scene, filled, new.ids, Photographs(capture, fitted), whole)
