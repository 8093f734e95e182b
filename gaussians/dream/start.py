"""The Gaussians from which an object is dreamt: a sphere, or something that has the form already.

Yi et al. 2024, "GaussianDreamer": a form from elsewhere spares the optimisation the hardest part, and the object has
one front only.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ..cloud import GaussianCloud
from ..errors import UserError
from ..harmonics import color_to_dc, dc_to_color

F64 = NDArray[np.float64]

COUNT = 4_000  # Gaussians of a sphere
RADIUS = 0.5  # of it; the enclosing sphere of the views has 1
_OPACITY = 0.1  # of a sphere's Gaussians: light passes, so that all of them learn
_HELD = 0.7  # most opacity of a form that is given: what is quite opaque learns slowly
_PALER = 0.5  # how far its colours are drawn to grey: the words say which colours it gets
_INSIDE = 0.9  # of the enclosing sphere that a given form fills
_GREY = 0.5
_TRIMMED = 0.002  # of the Gaussians on each side that do not count as the form


@dataclass(frozen=True, eq=False)
class Start:
    """Gaussians around the origin within radius 1, and how they came there: `p * size + middle` is where they were."""

    cloud: GaussianCloud
    size: float = 1.0
    middle: tuple[float, float, float] = (0.0, 0.0, 0.0)


def sphere(rng: np.random.Generator, count: int = COUNT) -> Start:
    """Faint grey Gaussians, evenly inside a sphere."""
    points = rng.normal(size=(count, 3))
    points *= RADIUS * (rng.uniform(size=(count, 1)) ** (1 / 3)) / np.linalg.norm(points, axis=1, keepdims=True)
    spacing = RADIUS * (4 / 3 * math.pi / count) ** (1 / 3)
    rgb = np.clip(rng.normal(_GREY, 0.05, size=(count, 3)), 0, 1)
    return Start(
        GaussianCloud.create(
            torch.from_numpy(points.astype(np.float32)),
            torch.tensor([[1.0, 0.0, 0.0, 0.0]]).repeat(count, 1),
            torch.full((count, 3), float(np.float32(0.7 * spacing))),
            torch.full((count,), _OPACITY),
            color_to_dc(torch.from_numpy(rgb.astype(np.float32)))[:, None],
        )
    )


def form(cloud: GaussianCloud, most: int, rng: np.random.Generator) -> Start:
    """A form that is there, around the origin, with paler colours; of more than `most` Gaussians some are drawn.

    Args:
        cloud: upright, its front towards -y.

    Raises:
        UserError: it has no extent.
    """
    if len(cloud) > most:
        cloud = cloud[torch.from_numpy(np.sort(rng.choice(len(cloud), most, replace=False)))]
    points = cloud.means.to(torch.float64).numpy()
    if not len(points) or not np.isfinite(points).all():
        raise UserError("what to start from holds no finite Gaussians; start from a sphere (--from sphere)")
    low, high = np.quantile(points, [_TRIMMED, 1 - _TRIMMED], axis=0)
    middle, size = (low + high) / 2, float(np.linalg.norm(high - low)) / 2 / _INSIDE
    if not size > 0:
        raise UserError("what to start from has no extent; start from a sphere (--from sphere)")
    pale = dc_to_color(cloud.sh[:, 0]).clamp(0, 1) * (1 - _PALER) + _GREY * _PALER
    x, y, z = (float(v) for v in middle)
    return Start(
        GaussianCloud.create(
            torch.from_numpy(((points - middle) / size).astype(np.float32)),
            cloud.quats,
            (cloud.scales / size).clamp(min=1e-5),
            cloud.opacities.clamp(0.02, _HELD),
            color_to_dc(pale)[:, None],
        ),
        size,
        (x, y, z),
    )
