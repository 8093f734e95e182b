"""Boxes of flat Gaussians: what a mesh of them must be is known."""

from __future__ import annotations

import itertools

import numpy as np
import torch

from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.harmonics import color_to_dc

Point = tuple[float, float, float]


def box(low: Point, high: Point, rgb: Point, across: int = 16, opacity: float = 0.97) -> GaussianCloud:
    """The six sides of a box, `across` by `across` Gaussians each."""
    corner, span = np.array(low), np.array(high) - np.array(low)
    step = (np.arange(across) + 0.5) / across
    means, scales = [], []
    for axis, end in itertools.product(range(3), (0.0, 1.0)):
        at = np.stack(np.meshgrid(step, step, indexing="ij"), axis=-1).reshape(-1, 2)
        means.append(corner + span * np.insert(at, axis, end, axis=1))
        scales.append(np.tile(np.where(np.arange(3) == axis, 1e-4, 0.45 * span / across), (across**2, 1)))
    count = 6 * across**2
    return GaussianCloud.create(
        torch.from_numpy(np.concatenate(means).astype(np.float32)),
        torch.tensor([[1.0, 0.0, 0.0, 0.0]]).repeat(count, 1),
        torch.from_numpy(np.concatenate(scales).astype(np.float32)),
        torch.full((count,), opacity),
        color_to_dc(torch.tensor(rgb)).to(torch.float32).repeat(count, 1)[:, None],
    )


def joined(*clouds: GaussianCloud) -> GaussianCloud:
    """One cloud whose ids are row numbers."""
    starts = np.cumsum([0, *(len(cloud) for cloud in clouds)])
    return concat([c.replace(ids=c.ids + int(start)) for c, start in zip(clouds, starts[:-1], strict=True)])
