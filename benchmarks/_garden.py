"""Loads the garden points of gsplat's tests as Gaussians: much overlap, and no order in memory.

The file has positions, colours and cameras only, so rotations, scales and opacities are random, as in those tests. The
picture does not look like the garden, but its rendering load is that of a real scene.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import torch

from ..gaussians.camera import Camera
from ..gaussians.cloud import GaussianCloud
from ..gaussians.harmonics import color_to_dc

FILE = "test_garden.npz"
LARGEST = 0.02  # scene units, of a standard deviation
FAINTEST = 1e-3  # opacities lie strictly between 0 and 1
NOTE = (
    f"garden: surveyed points and their colours; rotations of any direction, scales up to {LARGEST:g} and opacities "
    "drawn evenly at random, seen by the first of its own cameras, resized"
)


def load(path: Path, seed: int) -> tuple[GaussianCloud, Camera]:
    """The Gaussians (harmonics of degree 0) and the first of the cameras."""
    with np.load(path, allow_pickle=False) as data:
        means, colors = data["means3d"], data["colors"]
        pose, k, width, height = data["viewmats"][0], data["Ks"][0], int(data["width"]), int(data["height"])
    rng, count = np.random.default_rng(seed), len(means)
    quats = rng.normal(size=(count, 4))
    columns = (
        means,
        quats / np.linalg.norm(quats, axis=1, keepdims=True),
        rng.uniform(0, LARGEST, (count, 3)).clip(1e-6),
        rng.uniform(FAINTEST, 1 - FAINTEST, count),
    )
    shown = (torch.tensor(colors, dtype=torch.float32) + 0.5) / 256  # black itself is where gradients end
    sh = color_to_dc(shown)[:, None]
    places, turns, widths, opacities = (torch.tensor(column, dtype=torch.float32) for column in columns)
    cloud = GaussianCloud.create(places, turns, widths, opacities, sh)
    fx, fy, cx, cy = (float(k[place]) for place in ((0, 0), (1, 1), (0, 2), (1, 2)))
    return cloud, Camera(pose.astype(np.float64), fx, fy, cx, cy, width, height)
