"""Which places of a capture its pictures show: coarse depth maps of the viewer and of some cameras, from solid points.

A free place that no picture shows is free only because nothing is known of it: behind a wall, under a table's cloth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from ...gaussians.camera import Camera
from .bodies import Array

_WIDTH = 56  # pixels of a depth map
_EYES = 6  # cameras besides the viewer
_BEHIND = 1.04  # times the depth of what is seen, from which a point is hidden
_AT = (0.15, 0.5, 0.9)  # of a thing's height: where it has to be seen
_POINTS = 25_000
_UNSEEN, _UNKNOWN = 0.5, 1.0  # how much worse than out of the viewer's sight: seen by no camera, no floor seen


@dataclass(frozen=True, eq=False)
class Sight:
    """Depth maps.

    Attributes:
        views: the viewer first, then other cameras, each with its map `[H, W]`, scene units, infinite where nothing is.
    """

    views: tuple[tuple[Camera, Array], ...]

    @classmethod
    def of(cls, viewer: Camera, cameras: Sequence[Camera], solid: NDArray[np.float32]) -> Sight:
        """The maps of solid points `[M, 3]` seen by the viewer and by some of the cameras, evenly chosen."""
        some = cameras[:: max(1, -(-len(cameras) // _EYES))] if cameras else ()
        points = solid[:: max(1, len(solid) // _POINTS)].astype(np.float64)
        return cls(tuple((eye, _depths(eye, points)) for eye in map(_small, (viewer, *some))))

    def hidden(self, foot: Array, up: Array, height: float) -> Array:
        """How hidden a thing is that stands at places `[..., 3]`: 0 in full view of the viewer and of most cameras."""
        points = np.stack([foot + share * height * up for share in _AT], axis=-2)
        shown = [_shown(eye, depths, points).mean(axis=-1) for eye, depths in self.views]
        own = 1 - shown[0]
        if len(shown) == 1:
            return np.asarray(own)
        others = np.stack(shown[1:])
        return np.asarray(own + _UNSEEN * (1 - np.minimum(1.0, 2 * others.mean(axis=0))))


def _small(camera: Camera) -> Camera:
    return camera.resized(_WIDTH, max(8, round(_WIDTH * camera.height / camera.width)))


def _depths(camera: Camera, points: Array) -> Array:
    """`[H, W]` depth of the nearest points in each pixel, without single ones."""
    at, depth = camera.project(points)
    inside = camera.contains(at, depth)
    pixel = np.floor(at[inside]).astype(np.int64)
    found = np.full((camera.height, camera.width), np.inf)
    np.minimum.at(found, (pixel[:, 1], pixel[:, 0]), depth[inside])
    # Walls are few large Gaussians: between their points nothing is seen through.
    for size in (3, 5, 5):
        found = np.where(np.isfinite(found), found, scipy.ndimage.minimum_filter(found, size, mode="nearest"))
    return np.asarray(scipy.ndimage.median_filter(found, 3, mode="nearest"))


def _shown(camera: Camera, depths: Array, points: Array) -> Array:
    """`[...]` bool: which points `[..., 3]` lie in the picture and not behind what it shows."""
    flat = points.reshape(-1, 3)
    at, depth = camera.project(flat)
    inside = camera.contains(at, depth)
    shown = np.zeros(len(flat), bool)
    pixel = np.floor(at[inside]).astype(np.int64)
    shown[inside] = depth[inside] <= _BEHIND * depths[pixel[:, 1], pixel[:, 0]]
    return shown.reshape(points.shape[:-1])
