"""Cropping and pruning: the right rows are kept, and pruning by contribution loses less than even sampling."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.motion.motion import Motion, Track
from scenewright.gaussians.reduce import MAX_PSNR, crop_box, crop_sphere, prune, psnr
from scenewright.gaussians.scene import Scene


def scattered(count: int = 400, seed: int = 0) -> Scene:
    g = torch.Generator().manual_seed(seed)
    cloud = GaussianCloud.create(
        torch.rand(count, 3, generator=g) * 2 - 1, torch.nn.functional.normalize(torch.randn(count, 4, generator=g)),
        torch.rand(count, 3, generator=g) ** 3 * 0.2 + 0.005, torch.rand(count, generator=g) * 0.9 + 0.05,
        torch.randn(count, 1, 3, generator=g),
    )  # fmt: skip
    return Scene(cloud)


EYES = [Camera.look_at(eye, (0, 0, 0), (0, 0, 1), 96, 96) for eye in ((3, 0, 1), (0, 3, 1), (-3, 1, 0), (1, -3, -1))]
corner = st.tuples(*[st.floats(-0.8, 0.3)] * 3)


@given(corner, st.tuples(*[st.floats(0.3, 1.0)] * 3))
def test_a_box_keeps_what_lies_in_it(low: tuple[float, float, float], size: tuple[float, float, float]) -> None:
    scene = scattered()
    high = (low[0] + size[0], low[1] + size[1], low[2] + size[2])
    means = scene.cloud.means.numpy().astype(np.float64)
    clear = (np.abs(means - low) > 1e-6).all(axis=1) & (np.abs(means - high) > 1e-6).all(axis=1)  # of the box's faces
    inside = ((means > low) & (means < high)).all(axis=1)
    try:
        kept = np.isin(np.arange(400), crop_box(scene, low, high).cloud.ids.numpy())
    except UserError:
        kept = np.zeros(400, bool)
    assert (kept == inside)[clear].all()


def test_a_sphere_keeps_what_lies_in_it() -> None:
    scene = scattered()
    kept = crop_sphere(scene, (0.2, 0.1, 0.0), 0.7).cloud.ids
    away = (scene.cloud.means - torch.tensor([0.2, 0.1, 0.0])).norm(dim=1)
    assert kept.tolist() == torch.nonzero(away <= 0.7)[:, 0].tolist() and 0 < len(kept) < 400


def test_nothing_left_is_said_with_where_the_scene_is() -> None:
    for crop in (lambda: crop_box(scattered(), (5, 5, 5), (6, 6, 6)), lambda: crop_sphere(scattered(), (9, 9, 9), 1)):
        with pytest.raises(UserError, match=r"scene spans x -"):
            crop()
    with pytest.raises(UserError, match="lower corner first"):
        crop_box(scattered(), (1, 0, 0), (0, 1, 1))
    for radius in (0.0, -1.0, math.nan):
        with pytest.raises(UserError, match="positive radius"):
            crop_sphere(scattered(), (0, 0, 0), radius)


def test_pruning_keeps_what_is_seen_in_its_order() -> None:
    scene = scattered()
    kept = prune(scene, 150, EYES).cloud
    assert len(kept) == 150 and (kept.ids.diff() > 0).all()
    even = scene.cloud[torch.arange(0, 400, 400 / 150).long()[:150]]
    assert (
        np.mean(psnr(scene.cloud, kept, EYES)) > np.mean(psnr(scene.cloud, even, EYES)) + 3
    )  # dB; any good order does
    assert prune(scene, 400, EYES) is scene


def test_what_is_hidden_goes_first() -> None:
    scene = scattered(20)
    means = scene.cloud.means.clone()
    means[7] = torch.tensor([0.0, 0.0, 500.0])  # above every eye, outside every picture
    scene = scene.replace(cloud=scene.cloud.replace(means=means))
    assert 7 not in prune(scene, 19, EYES).cloud.ids.tolist()


def test_pruning_needs_a_number_and_views() -> None:
    with pytest.raises(UserError, match="at least one"):
        prune(scattered(), 0, EYES)
    with pytest.raises(UserError, match="no view shows anything"):
        prune(scattered(), 10, [])


def test_equal_scenes_look_alike() -> None:
    cloud = scattered().cloud
    assert psnr(cloud, cloud, EYES) == (MAX_PSNR,) * len(EYES)


def test_what_is_seen_at_some_time_counts() -> None:
    """The first 40 Gaussians come into sight later; the others are not asked to move."""
    scene = scattered()
    away = torch.zeros(400, 3)
    away[:40, 2] = 50.0
    hidden = scene.replace(cloud=scene.cloud.replace(means=scene.cloud.means + away))
    coming = Motion((Track.slide(np.arange(40), [0, 1], [0, -50.0], (0, 0, 1)),), stop=1.0)
    still, moving = prune(hidden, 300, EYES), prune(hidden.replace(motion=coming), 300, EYES)
    assert not bool((still.cloud.ids < 40).any())
    there = int((prune(scene, 300, EYES).cloud.ids < 40).sum())
    assert int((moving.cloud.ids < 40).sum()) >= 0.7 * there > 0
    assert moving.motion is not None and len(moving.motion.tracks[0]) == int((moving.cloud.ids < 40).sum())
