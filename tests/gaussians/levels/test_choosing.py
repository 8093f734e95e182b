"""Levels are chosen by what they move on the screen, and how far they move Gaussians is what was measured."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import torch

from scenewright.agent.options import LOD_PIXELS
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.files.formats import streamed_sog_writing
from scenewright.gaussians.files.formats.streamed_sog import Leaf, Streamed
from scenewright.gaussians.levels import choosing
from scenewright.gaussians.levels.choosing import choose, moved
from scenewright.gaussians.levels.making import make
from scenewright.gaussians.scene import Scene

SIDE = 0.2


@pytest.fixture
def squares() -> Scene:
    """64 squares of four Gaussians, 10 apart: a level merges each into one, half a diagonal from its corners."""
    corners = torch.cartesian_prod(torch.tensor([0.0, SIDE]), torch.tensor([0.0, SIDE]), torch.zeros(1))
    places = 10 * torch.cartesian_prod(*[torch.arange(4.0)] * 3)
    means = (places[:, None] + corners).reshape(-1, 3)
    count = len(means)
    quats, sizes = torch.tensor([1.0, 0, 0, 0]).expand(count, 4).contiguous(), torch.full((count, 3), 0.1)
    return Scene(GaussianCloud.create(means, quats, sizes, torch.full((count,), 0.5), torch.zeros(count, 1, 3)))


@pytest.fixture
def streamed(squares: Scene, tmp_path: Path) -> Streamed:
    streamed_sog_writing.save(make(squares, 3, (), leaf_rows=32), tmp_path / "a.lod")
    return Streamed.open(tmp_path / "a.lod")


def seen_from(distance: float) -> Camera:
    return Camera.look_at([15, 15 - distance, 15], [15, 15, 15], [0, 0, 1], 300, 200)


def test_how_far_a_level_moves_gaussians(squares: Scene, streamed: Streamed) -> None:
    made = make(squares, 3, (), leaf_rows=32)
    assert made.moved is not None and made.moved.shape == (8, 3)
    assert np.allclose(made.moved[:, 0], 0)
    assert np.allclose(made.moved[:, 1], SIDE / math.sqrt(2), rtol=1e-4)
    assert (made.moved[:, 2] > 1).all()  # two squares, which are 10 apart, became one
    told = [[moved(leaf, k) for k in range(3)] for leaf in streamed.leaves]
    assert np.allclose(told, made.moved, rtol=1e-6)


def test_the_coarsest_level_that_moves_little_enough(streamed: Streamed) -> None:
    for distance in (40.0, 100.0, 400.0, 5000.0, 1e5):
        camera = seen_from(distance)
        for leaf, level in zip(streamed.leaves, choose(streamed, camera, 0.5), strict=True):
            box = np.array([leaf.low, leaf.high])
            nearest = np.linalg.norm(camera.position - np.clip(camera.position, *box))
            on_screen = [moved(leaf, k) * camera.fx / nearest for k in range(3)]
            assert on_screen[level] <= 0.5 and all(wider > 0.5 for wider in on_screen[level + 1 :])
    assert choose(streamed, seen_from(1e5)) == [2] * 8
    assert set(choose(streamed, seen_from(16.0))) == {0}


def test_more_pixels_never_choose_finer(streamed: Streamed) -> None:
    camera = seen_from(60.0)
    found = [choose(streamed, camera, pixels) for pixels in (0.0, 0.1, 0.5, 1.0, 10.0, 1e6)]
    assert found[0] == [0] * 8 and found[-1] == [2] * 8
    assert all(a <= b for fine, coarse in pairwise(found) for a, b in zip(fine, coarse, strict=True))


def test_what_is_beside_or_behind_the_picture_is_coarsest(streamed: Streamed) -> None:
    inside = Camera.look_at([15, 15, 15], [40, 15, 15], [0, 0, 1], 200, 200, fov_y=30)
    for leaf, level in zip(streamed.leaves, choose(streamed, inside), strict=True):
        assert level == (0 if leaf.low[0] > 15 else 2)
    away = Camera.look_at([15, -20, 15], [15, -60, 15], [0, 0, 1], 300, 200)
    assert choose(streamed, away) == [2] * 8


def test_a_leaf_around_the_eye_is_finest(squares: Scene, tmp_path: Path) -> None:
    streamed_sog_writing.save(make(squares, 3, ()), tmp_path / "one.lod")
    one = Streamed.open(tmp_path / "one.lod")
    assert choose(one, Camera.look_at([15, 15, 15], [40, 15, 15], [0, 0, 1], 200, 200), 100.0) == [0]


def test_files_that_do_not_say_it_are_judged_by_their_spacing(streamed: Streamed) -> None:
    leaf = streamed.leaves[0]
    plain = replace(leaf, runs={k: run.model_copy(update={"moved": None}) for k, run in leaf.runs.items()})
    assert moved(plain, 0) == 0 < moved(plain, 1) < moved(plain, 2)
    fewer = leaf.runs[1].count / leaf.runs[2].count
    assert moved(plain, 2) == pytest.approx(math.sqrt(fewer) * moved(plain, 1))
    flat = Leaf((0, 0, 0), (8, 8, 0), {1: plain.runs[1].model_copy(update={"count": 64})})
    assert moved(flat, 1) == choosing.SPACINGS


def test_an_empty_level_is_not_chosen(streamed: Streamed) -> None:
    leaf = replace(streamed.leaves[0], runs={1: streamed.leaves[0].runs[1]})
    only = replace(streamed, leaves=(leaf,))
    assert choose(only, seen_from(16.0)) == choose(only, seen_from(1e6)) == [1]


def test_the_option_alone_means_the_default() -> None:
    assert LOD_PIXELS == choosing.PIXELS
