"""The scene at its start: Gaussians trained on the first frame of every camera (`start_scene`)."""

from __future__ import annotations

import numpy as np
import torch
from scipy.spatial import cKDTree

from ...cloud import GaussianCloud
from ...errors import UserError
from ...fit.densify import MCMCStrategy
from ...fit.initialize import initial_cloud
from ...fit.parameters import Parameters
from ...fit.photographs.photos import Photos
from ...fit.train import Schedule, Shot, Trainer
from ...harmonics import color_to_dc
from .stereo import points_of

SPACING = 2.0  # pixels, at the distance of the cameras' radius, between two points to start from
PIXELS = 12  # pixels of the first frames for each Gaussian
OPACITY = 0.6
ROOM = 1.1  # times the number of points: greatest number of Gaussians


def start_points(shots: list[Shot], radius: float, most: int, rng: np.random.Generator) -> GaussianCloud:
    """Gaussians at points whose depth pictures agree on; the best confirmed first, `most` at most.

    Raises:
        UserError: pictures agree on the depth of fewer than two points.
    """
    found = points_of([s.camera for s in shots], [s.colors for s in shots], radius)
    order = rng.permutation(len(found.means))
    order = order[np.argsort(-np.minimum(found.agreed[order], 4), kind="stable")]
    order = order[found.agreed[order] >= 1]
    cells = np.floor(found.means[order] / (SPACING * radius / shots[0].camera.fx)).astype(np.int64)
    _, first = np.unique(cells, axis=0, return_index=True)
    rows = order[np.sort(first)][: min(most, len(found.means) // PIXELS)]
    if len(rows) < 2:  # no distance to another one tells their size
        raise UserError(
            "the first frames of the film agree on no depths: check the poses, let the views of the cameras overlap, "
            "or give surveyed points"
        )
    means = found.means[rows]
    away, _ = cKDTree(means).query(means, k=min(4, len(means)))
    sizes = np.clip(np.sqrt((away[:, 1:] ** 2).mean(axis=1)), 1e-6 * radius, 0.1 * radius) * 0.7
    count = len(means)
    return GaussianCloud.create(
        torch.from_numpy(means).float(), torch.tensor([[1.0, 0.0, 0.0, 0.0]]).repeat(count, 1),
        torch.from_numpy(np.repeat(sizes[:, None], 3, axis=1)).float(), torch.full((count,), OPACITY),
        color_to_dc(torch.from_numpy(found.colors[rows]).float())[:, None],
    )  # fmt: skip


def trainer(shots: list[Shot], photos: Photos, most: int, schedule: Schedule, rng: np.random.Generator) -> Trainer:
    """A training on the first frames: from surveyed points where the capture has them, else from their own stereo."""
    surveyed = len(photos.points.means) > 0
    cloud = initial_cloud(photos, most, rng) if surveyed else start_points(shots, photos.extent, most, rng)
    budget = min(most, int(ROOM * len(cloud)) + 1)
    return Trainer(shots, Parameters.of(cloud), MCMCStrategy(budget, rng), photos.extent, schedule, rng)
