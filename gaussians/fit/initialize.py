"""What training starts from: one round Gaussian at every surveyed point, or scattered where the cameras look.

Knows points and cameras. Refuses to know photographs.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..cloud import GaussianCloud
from ..harmonics import color_to_dc
from .photographs.photos import Photos

OPACITY = 0.5
SCATTERED = 30_000  # Gaussians, where no points were surveyed
FEWEST = 100  # surveyed points, below which they are no start
FARTHEST = 1e4  # times as far as the middle one of them: what lies there is no survey's


def start(photos: Photos, most: int, rng: np.random.Generator) -> GaussianCloud:
    """At most `most` Gaussians of degree 0, each as wide as the mean distance to its three nearest neighbours."""
    means, colors = _distinct(photos)
    if len(means) < FEWEST:
        means, colors = _scattered(photos, min(SCATTERED, most), rng)
    if len(means) > most:
        chosen = np.sort(rng.choice(len(means), most, replace=False))
        means, colors = means[chosen], colors[chosen]
    apart, _ = cKDTree(means).query(means, k=min(4, len(means)))
    scales = np.sqrt((apart[:, 1:] ** 2).mean(axis=1)) if len(means) > 1 else np.full(1, photos.extent / 100)
    scales = np.clip(scales, 1e-6 * photos.extent, photos.extent)
    quats = rng.normal(size=(len(means), 4))
    tensors = (means, quats / np.linalg.norm(quats, axis=1, keepdims=True), np.repeat(scales[:, None], 3, axis=1))
    mean, quat, scale = (torch.from_numpy(np.ascontiguousarray(t, np.float32)) for t in tensors)
    color = torch.from_numpy(colors.astype(np.float32))
    return GaussianCloud.create(mean, quat, scale, torch.full((len(mean),), OPACITY), color_to_dc(color)[:, None])


def _distinct(photos: Photos) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The surveyed points, each place once, without what is absurdly far off."""
    means = photos.points.means
    if not len(means):
        return means, photos.points.colors
    away = np.abs(means - np.median(means, axis=0)).max(axis=1)  # of any size: no squares
    near = np.flatnonzero(away <= FARTHEST * max(float(np.median(away)), photos.extent))
    _, first = np.unique(means[near], axis=0, return_index=True)
    kept = near[np.sort(first)]
    return means[kept], photos.points.colors[kept]


def _scattered(photos: Photos, count: int, rng: np.random.Generator) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points along random rays of random cameras, at depths from a tenth of the extent to four of it, each of the
    colour of its pixel."""
    means, colors = np.zeros((count, 3)), np.zeros((count, 3))
    for i, of in enumerate(rng.integers(len(photos.shots), size=count)):
        shot = photos.shots[of]
        camera = shot.camera
        x, y = int(rng.integers(camera.width)), int(rng.integers(camera.height))
        ray = np.array([(x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1.0])
        depth = photos.extent * 10 ** rng.uniform(-1, 0.6)
        means[i] = camera.position + camera.world_to_camera[:3, :3].T @ ray * depth
        colors[i] = shot.photo[y, x] / 255
    return means, colors
