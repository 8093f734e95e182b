"""The public functions that scripts begin with: a scene is loaded with its saved field, and drawn as it is."""

from __future__ import annotations

from pathlib import Path

import torch

import scenewright as sw
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.language.field.language_field import LanguageField
from scenewright.gaussians.language.field.store import save_field


def _scene() -> sw.Scene:
    room = sw.make("stool", 0)
    cloud: GaussianCloud = room.cloud
    return sw.Scene(cloud.replace(group=torch.full((len(cloud),), -1, dtype=torch.int32)))


def test_load_takes_the_saved_field_of_exactly_this_file(tmp_path: Path) -> None:
    import numpy as np

    scene = _scene()
    sw.save(scene, tmp_path / "a.ply")
    assert sw.load(tmp_path / "a.ply").language is None
    field = LanguageField((), np.zeros((0, 2), np.float32), "test:1")
    save_field(scene.replace(language=field), tmp_path / "a.ply")
    loaded = sw.load(str(tmp_path / "a.ply"))
    assert loaded.language is not None and loaded.language.encoder == "test:1"
    sw.save(scene.replace(cloud=scene.cloud[5:]), tmp_path / "a.ply", force=True)  # the field is of another file now
    assert sw.load(tmp_path / "a.ply").language is None


def test_a_scene_is_drawn_as_its_cloud_is() -> None:
    scene = _scene()
    camera = sw.Camera.look_at([1, -2, 1], [0, 0, 0.3], [0, 0, 1], 64, 48)
    assert torch.equal(sw.render(scene, camera).rgb, sw.render(scene.cloud, camera).rgb)
