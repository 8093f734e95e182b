"""A small film of cameras that stand."""

import numpy as np
import pytest

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.fit.train import Shot
from scenewright.gaussians.harmonics import SH_C0
from scenewright.gaussians.motion.fitting.bodies import Body, Line, placed
from scenewright.gaussians.motion.fitting.footage import Footage
from scenewright.gaussians.render.cpu import gradient


@pytest.fixture(scope="module")
def swinging():
    """A leaf of many colours before a gray wall, which swings on a hinge: columns, labels, the true body, footage."""
    rng, times = np.random.default_rng(5), np.linspace(0, 1, 6)
    x, z = np.meshgrid(np.linspace(-0.5, 0.5, 11), np.linspace(-0.5, 0.5, 11))
    leaf = np.stack([x, np.zeros_like(x), z], axis=-1).reshape(-1, 3)
    x, z = np.meshgrid(np.linspace(-1.5, 1.5, 16), np.linspace(-1.5, 1.5, 16))
    wall = np.stack([x, np.full_like(x, 0.6), z], axis=-1).reshape(-1, 3)
    means, count = np.concatenate([leaf, wall]).astype(np.float32), len(leaf) + len(wall)
    colors = np.concatenate([rng.uniform(0.1, 0.9, (len(leaf), 3)), np.full((len(wall), 3), 0.5)])
    columns = (
        means, np.tile(np.float32([1, 0, 0, 0]), (count, 1)),
        np.repeat(np.r_[np.full(len(leaf), 0.05), np.full(len(wall), 0.12)], 3).reshape(-1, 3).astype(np.float32),
        np.full(count, 0.9, np.float32), ((colors - 0.5) / SH_C0).astype(np.float32)[:, None],
    )  # fmt: skip
    labels = np.r_[np.ones(len(leaf)), np.zeros(len(wall))].astype(np.int32)
    line = Line("hinge", np.array([0, 0, 1.0]), np.array([-0.5, 0, 0]), np.array([0, 0, -0.3, -0.6, -0.9, -0.9]))
    body = Body.at_rest(np.zeros(3), 6).on(line)
    cameras = [Camera.look_at((a, -2.4, 0.4), (0, 0, 0), (0, 0, 1), 40, 32, 60) for a in (-1.4, 0.0, 1.4)]
    shots, seconds = [], []
    for t in range(6):
        for at in cameras:
            drawn = gradient.draw(placed(columns, labels, [body], t), at, (0.0, 0.0, 0.0)).rgb
            shots.append(Shot(at, (drawn.clip(0, 1) * 255).round().astype(np.uint8), times[t]))
            seconds.append(times[t])
    return columns, labels, body, Footage.of(shots, seconds)
