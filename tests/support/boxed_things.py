"""Gaussians of things that are boxes, a group for each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch

from scenewright.gaussians.camera import Vec3
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.world.box import Box

AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

Thing = tuple[str, Vec3, Vec3]  # name, middle of its underside, size


def box_of(thing: Thing) -> Box:
    """The box that a thing fills."""
    _, (x, y, z), size = thing
    return Box((x, y, z + size[2] / 2), AXES, size)


def cloud_of(things: Sequence[Thing], each: int) -> GaussianCloud:
    """So many Gaussians of each thing, anywhere in its box; the i-th thing is group i."""
    rng = np.random.default_rng(0)
    means = [rng.uniform(-0.5, 0.5, (each, 3)) * np.array(t[2]) + np.array(box_of(t).center) for t in things]
    count = len(things) * each
    return GaussianCloud.create(
        torch.from_numpy(np.concatenate(means)).float(), torch.tensor([[1.0, 0, 0, 0]]).repeat(count, 1),
        torch.full((count, 3), 0.02), torch.full((count,), 0.9), torch.zeros(count, 1, 3),
        torch.arange(len(things), dtype=torch.int32).repeat_interleave(each),
    )  # fmt: skip
