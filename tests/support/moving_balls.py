"""Three balls of which one turns and is carried off, one slides and looks different for a while, and one stays."""

from __future__ import annotations

import math

import numpy as np
import torch

from scenewright.gaussians.motion.motion import Look, Motion, Residual, Track
from scenewright.gaussians.scene import Scene

from .three_balls import balls


def moving(degree: int = 1, count: int = 150) -> Scene:
    """The balls over 4 seconds, with every kind of motion but a spin."""
    scene = balls(count, degree)
    ids = [scene.cloud.ids[scene.cloud.group == i].numpy() for i in range(3)]
    tracks = (
        Track.hinge(ids[0], [0, 2], [0, 2.0], (1, 1, 0), (-1.2, 0, 0.5), name="rolling"),
        Track.slide(ids[1], [1, 2], [0, 1.5], (0, 1, 0)),
        Track.along(ids[0], [0, 4], [[0, 0, 0], [3, 0, 1]]),
    )
    blue = torch.zeros(len(ids[1]), (degree + 1) ** 2, 3)
    blue[:, 0, 2] = 1.7
    hidden = torch.full((len(ids[1]),), 0.5)
    hidden[::3] = 0
    looks = (Look(ids[1], 1.5, math.inf, blue), Look(ids[1], 2.5, 3.0, None, hidden))
    weights = np.full((len(ids[0][::2]), 1, 3), 0.1, np.float32)
    waving = Residual(ids[0][::2], np.array([0.0, 1, 2]), np.array([[0.0], [1], [0]]), weights)
    return scene.replace(motion=Motion(tracks, looks, (waving,), 0.0, 4.0))
