"""Fitted and composed rooms of training: photographs, the true objects that are carried over, and the cache."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from scenewright.gaussians.files.captures.capture import read_capture
from scenewright.gaussians.fit import load_photos
from scenewright.gaussians.render import render
from scenewright.training import fitted_rooms
from scenewright.training.composed_rooms import composed_room
from scenewright.training.fitted_rooms import HELD_OUT, ROOMS, FittedRoom, carried_over, fitted_room, known_room

SMALL = FittedRoom("small", "furnished", 9200, 3, 300, 64, 0.01, photographs=9, points=250)


@pytest.fixture(scope="module")
def true() -> tuple[Any, Any]:
    return known_room(SMALL)


@pytest.fixture
def quick(true: tuple[Any, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fitted_rooms, "known_room", lambda recipe: true)


@pytest.mark.slow
def test_objects_are_carried_over_to_the_same_place_and_not_far_away(true: tuple[Any, Any]) -> None:
    scene, objects = true
    assert (carried_over(scene, objects, scene) == objects).mean() > 0.999  # Gaussians at one place may swap objects
    far = scene.replace(cloud=scene.cloud.replace(means=scene.cloud.means + 20))
    assert (carried_over(scene, objects, far) == -1).all()
    moved = scene.replace(cloud=scene.cloud.replace(means=scene.cloud.means + 0.003))
    assert (carried_over(scene, objects, moved) == objects).mean() > 0.9


@pytest.mark.usefixtures("quick")
def test_a_fit_is_kept_until_its_recipe_changes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scene, objects = fitted_room(SMALL, tmp_path)
    assert len(objects) == len(scene.cloud) > 100 and set(objects.tolist()) > {-1}
    calls = []
    monkeypatch.setattr(fitted_rooms, "fit", lambda *_: calls.append(1) or pytest.fail("fitted again"))
    again, same = fitted_room(SMALL, tmp_path)
    assert not calls and np.array_equal(same, objects) and torch.equal(again.cloud.means, scene.cloud.means)
    with pytest.raises(pytest.fail.Exception, match="fitted again"):
        fitted_room(replace(SMALL, steps=4), tmp_path)


@pytest.mark.usefixtures("quick")
def test_photographs_show_the_room_where_their_poses_say(true: tuple[Any, Any], tmp_path: Path) -> None:
    fitted_rooms.photograph(*true, SMALL, tmp_path)
    capture, photos = read_capture(tmp_path), load_photos(tmp_path)
    assert len(capture.cameras) == SMALL.photographs and len(photos.points.means) == SMALL.points
    for shot in (*photos.shots, *photos.held_out):
        clean = render(true[0].cloud, shot.camera).rgb.numpy()
        # Exposure, noise and JPEG at 64 pixels; a wrong pose differs by 0.2 on average.
        assert np.abs(clean - np.asarray(shot.photo) / 255).mean() < 0.08


def test_recipes_have_names_of_their_own_and_no_held_out_room_trains() -> None:
    recipes = (*ROOMS, *HELD_OUT)
    assert len({r.name for r in recipes}) == len(recipes)
    assert not {(r.room, r.seed) for r in ROOMS} & {(r.room, r.seed) for r in HELD_OUT}


@pytest.mark.slow
def test_composed_rooms_count_parts_as_their_object_and_hide_their_field() -> None:
    scene, objects = composed_room("closet", 1)
    assert scene.language is None and (scene.cloud.group == -1).all() and len(objects) == len(scene.cloud)
    count = int(objects.max()) + 1
    assert count > 5 and set(objects.tolist()) == set(range(-1, count))
    low, high = (scene.cloud.means.numpy()[objects < 0].round(1).min(0), scene.cloud.means.numpy()[objects < 0].max(0))
    assert (high - low > 2).all()  # floor and walls surround the room
