"""A black screen on a wall far behind a ball: fitted on black, it shows with low alpha, and is no hole."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.harmonics import color_to_dc
from scenewright.gaussians.scene import Frame, Scene
from scenewright.tools.filling.fill import patches_behind

EYES = [Camera.look_at([x, -3.0, 0.8], [0, 0, 0.6], [0, 0, 1], 160, 120) for x in np.linspace(-1.2, 1.2, 9)]


def _cloud(points: np.ndarray, opacity: np.ndarray, grey: float, size: float) -> GaussianCloud:
    n = len(points)
    return GaussianCloud.create(
        torch.from_numpy(points.astype(np.float32)),
        torch.tensor([1.0, 0, 0, 0]).expand(n, 4).contiguous(),
        torch.full((n, 3), size),
        torch.from_numpy(opacity.astype(np.float32)),
        color_to_dc(torch.full((n, 3), grey))[:, None],
    )


def _wall(screen: float) -> GaussianCloud:
    """A bumpy wall from 9 to 11 behind the ball, of which a part has another opacity."""
    x, z = (v.ravel() for v in np.meshgrid(np.arange(-8, 8, 0.14), np.arange(-3, 6, 0.14)))
    y = 10 + np.sin(2 * x) * np.cos(2 * z)
    inside = (np.abs(x) < 1.2) & (np.abs(z + 0.1) < 0.9)
    return _cloud(np.stack([x, y, z], axis=1), np.where(inside, screen, 0.9), 0.7, 0.12)


@pytest.mark.parametrize(("screen", "told"), [(0.05, False), (0.0, True)])
def test_a_dark_surface_that_photographs_see_past_the_thing_is_no_hole(screen: float, told: bool) -> None:
    wall = _wall(screen)
    wall = wall[wall.opacities > 0]
    way = np.random.default_rng(1).normal(size=(1500, 3))
    way *= 0.45 / np.linalg.norm(way, axis=1, keepdims=True)
    ball = _cloud(way + np.array([0.0, -0.4, 0.6]), np.full(1500, 0.9), 0.3, 0.03)
    ids = torch.arange(len(wall) + len(ball))
    both = concat([wall.replace(ids=ids[: len(wall)]), ball.replace(ids=ids[len(wall) :])])
    scene = Scene(both[: len(wall)], Frame((0, 0, 1), 0.0, 1.0, "given", "given"), cameras=tuple(EYES))
    left = [p for p in patches_behind(scene, both[len(wall) :]) if p.reason or len(p.cloud)]
    assert bool(left) is told
