"""Initial Gaussians of a training: one isotropic Gaussian at every surveyed (SfM) point, or at random points."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..cloud import GaussianCloud
from ..harmonics import color_to_dc
from .photographs.photos import Photos

INIT_OPACITY = 0.5
RANDOM_POINTS = 30_000  # initial Gaussians without surveyed points
MIN_POINTS = 100  # surveyed points; with fewer, random ones are used
OUTLIER = 1e4  # points more than this many times as far away as the median one are ignored


def initial_cloud(photos: Photos, max_gaussians: int, rng: np.random.Generator) -> GaussianCloud:
    """At most `max_gaussians` Gaussians of degree 0, with the RMS distance to the three nearest neighbours as scale."""
    means, colors = _surveyed_points(photos)
    if len(means) < MIN_POINTS:
        means, colors = _random_points(photos, min(RANDOM_POINTS, max_gaussians), rng)
    if len(means) > max_gaussians:
        chosen = np.sort(rng.choice(len(means), max_gaussians, replace=False))
        means, colors = means[chosen], colors[chosen]
    distances, _ = cKDTree(means).query(means, k=min(4, len(means)))
    scales = np.sqrt((distances[:, 1:] ** 2).mean(axis=1)) if len(means) > 1 else np.full(1, photos.extent / 100)
    scales = np.clip(scales, 1e-6 * photos.extent, photos.extent)
    quats = rng.normal(size=(len(means), 4))
    tensors = (means, quats / np.linalg.norm(quats, axis=1, keepdims=True), np.repeat(scales[:, None], 3, axis=1))
    mean, quat, scale = (torch.from_numpy(np.ascontiguousarray(t, np.float32)) for t in tensors)
    color = torch.from_numpy(colors.astype(np.float32))
    return GaussianCloud.create(mean, quat, scale, torch.full((len(mean),), INIT_OPACITY), color_to_dc(color)[:, None])


def _surveyed_points(photos: Photos) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Positions and colours of the surveyed points, without duplicates and extreme outliers."""
    means = photos.points.means
    if not len(means):
        return means, photos.points.colors
    away = np.abs(means - np.median(means, axis=0)).max(axis=1)  # maximum norm: squares may overflow
    near = np.flatnonzero(away <= OUTLIER * max(float(np.median(away)), photos.extent))
    _, first = np.unique(means[near], axis=0, return_index=True)
    kept = near[np.sort(first)]
    return means[kept], photos.points.colors[kept]


def _random_points(
    photos: Photos, count: int, rng: np.random.Generator
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points on random pixel rays of random cameras, 0.1 to 4 times the extent deep, with the colour of the pixel."""
    means, colors = np.zeros((count, 3)), np.zeros((count, 3))
    for i, index in enumerate(rng.integers(len(photos.shots), size=count)):
        shot = photos.shots[index]
        camera = shot.camera
        x, y = int(rng.integers(camera.width)), int(rng.integers(camera.height))
        ray = np.array([(x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1.0])
        depth = photos.extent * 10 ** rng.uniform(-1, 0.6)
        means[i] = camera.position + camera.world_to_camera[:3, :3].T @ ray * depth
        colors[i] = shot.photo[y, x] / 255
    return means, colors
