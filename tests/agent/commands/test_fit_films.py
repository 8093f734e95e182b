"""`scenewright fit` on frames with times: what is said where nothing moves, and how much time is left then."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from scenewright.agent.commands import fit as command
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.files.captures.capture import to_transforms
from scenewright.gaussians.fit import Settings
from scenewright.gaussians.fit.photographs.photos import load_photos
from scenewright.gaussians.lens import Lens
from scenewright.gaussians.motion.fitting import fit as films


@pytest.fixture
def film(tmp_path: Path) -> Path:
    """Frames of one camera that goes along a wall of squares, in which nothing moves."""
    rng = np.random.default_rng(0)
    squares = np.kron(rng.integers(30, 220, (14, 24, 3)), np.ones((8, 8, 1))).astype(np.uint8)
    cameras, times = [], []
    for k in range(14):
        place = np.array([0.25 * k, -4.0, 0.0])
        cameras.append(
            Camera.look_at(place, place + np.array([0, 1, 0]), (0, 0, 1), 48, 36, 2 * math.degrees(math.atan(0.375)))
        )
        times.append(0.1 * k)
        x = round(0.25 * k * 48 / 4)  # 12 pixels for each unit at the wall's distance of 4
        Image.fromarray(squares[30 : 30 + 36, x : x + 48]).save(tmp_path / f"{k:02d}.png")
    told: dict[str, Any] = to_transforms(cameras, [Lens()] * 14, [f"{k:02d}.png" for k in range(14)])
    for frame, time in zip(told["frames"], times, strict=True):
        frame["time"] = time
    (tmp_path / "transforms.json").write_text(json.dumps(told))
    return tmp_path


@pytest.mark.slow
def test_a_film_in_which_nothing_moves_is_fitted_as_photographs(call: Any, film: Path) -> None:
    answer = call("fit", film, "-o", film / "a.ply", "--steps", "20", "--sh-degree", "1", "--json")
    assert answer.code == 0, answer.err
    assert "a film of 14 times by a moving camera: looking for what moves" in answer.err
    assert (
        "nothing that moves was found: the frames are fitted as photographs of a scene that stands still" in answer.err
    )
    assert "Gaussians start where frames agree on a depth" in answer.err
    assert answer.data["sh_degree"] == 1 and answer.data["steps"] == 20 and "tracks" not in answer.data


def test_a_checkpoint_of_photographs_is_gone_on_from_without_another_look(
    call: Any, film: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(films, "fit_what_moves", lambda *_, **__: pytest.fail("looked again"))
    (film / "a.ply.checkpoint").write_bytes(b"broken")
    answer = call("fit", film, "-o", film / "a.ply", "--steps", "20")
    assert answer.code != 0 and "a.ply.checkpoint" in answer.err


def test_a_search_that_was_given_up_says_that_more_time_is_needed(film: Path) -> None:
    photos = load_photos(film)
    said = command._still(films.Still(photos, 12.3, 0, True), "")
    assert "given up after 12 s" in said and "with more --minutes" in said and "as photographs" in said
    said = command._still(films.Still(photos, 12.3, 2, False), ", on the GPU")
    assert "no path was found" in said and "only what rests for a while" in said and said.endswith(", on the GPU")


def test_photographs_get_the_time_that_is_left() -> None:
    assert command._shortened(Settings(seconds=60), 10).seconds == 50
    assert command._shortened(Settings(seconds=60), 59).seconds == 60 * command.LEAST_LEFT
    assert command._shortened(Settings(steps=60), 59).steps == 60
