"""The public functions that scripts begin with: a scene is loaded with its saved field, and drawn as it is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

import scenewright as sw
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.language.field.language_field import LanguageField
from scenewright.gaussians.language.field.store import save_field


def _scene() -> sw.Scene:
    room = sw.make("stool", 0)
    cloud: GaussianCloud = room.cloud
    return sw.Scene(cloud.replace(group=torch.full((len(cloud),), -1, dtype=torch.int32)))


def _field() -> LanguageField:
    """A field of no groups."""
    return LanguageField((), np.zeros((0, 2), np.float32), "test:1")


def test_load_takes_the_saved_field_of_exactly_this_file(tmp_path: Path) -> None:
    scene = _scene()
    sw.save(scene, tmp_path / "a.ply")
    assert sw.load(tmp_path / "a.ply").language is None
    save_field(scene.replace(language=_field()), tmp_path / "a.ply")
    loaded = sw.load(str(tmp_path / "a.ply"))
    assert loaded.language is not None and loaded.language.encoder == "test:1"
    sw.save(scene.replace(cloud=scene.cloud[5:]), tmp_path / "a.ply", force=True)  # the field is of another file now
    assert sw.load(tmp_path / "a.ply").language is None


def test_what_is_saved_with_names_is_loaded_with_them(tmp_path: Path) -> None:
    scene = _scene().replace(language=_field())
    assert sw.save(scene, tmp_path / "a.ply") == tmp_path / "a.ply.field.safetensors"
    loaded = sw.load(tmp_path / "a.ply")
    assert loaded.language is not None and loaded.language.encoder == "test:1"


def test_groups_that_the_field_does_not_have_are_refused_before_anything_is_written(tmp_path: Path) -> None:
    scene = _scene()
    other = scene.cloud.replace(group=torch.full((len(scene.cloud),), 3, dtype=torch.int32))
    with pytest.raises(sw.UserError, match="language=None"):
        sw.save(sw.Scene(other, language=_field()), tmp_path / "a.ply")
    assert not list(tmp_path.iterdir())


def test_a_motion_of_other_gaussians_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    scene = _scene()
    far = sw.Motion((sw.Track.slide([10**6], [0, 1], [0, 1], (0, 0, 1), name="car"),), stop=1.0)
    with pytest.raises(sw.UserError, match="motion holds no Gaussian of this scene"):
        sw.save(scene.replace(motion=far), tmp_path / "a.ply")
    hidden = sw.Motion((), (sw.Look([10**6], 0, 1, None, [0.0]),), stop=1.0)
    with pytest.raises(sw.UserError, match="motion holds no Gaussian of this scene"):
        sw.save(scene.replace(motion=hidden), tmp_path / "a.ply")
    assert not list(tmp_path.iterdir())
    gone = sw.Track.slide([10**6], [0, 1], [0, 1], (1, 0, 0))
    partly = sw.Motion((sw.Track.slide([3, 10**6], [0, 1], [0, 1], (0, 0, 1)), gone), stop=1.0)
    sw.save(scene.replace(motion=partly), tmp_path / "a.ply")  # as after a removal
    kept = sw.load(tmp_path / "a.ply").motion
    assert kept is not None and kept.tracks[0].ids.tolist() == [3]


def test_a_scene_is_drawn_as_its_cloud_is() -> None:
    scene = _scene()
    camera = sw.Camera.look_at([1, -2, 1], [0, 0, 0.3], [0, 0, 1], 64, 48)
    assert torch.equal(sw.render(scene, camera).rgb, sw.render(scene.cloud, camera).rgb)
