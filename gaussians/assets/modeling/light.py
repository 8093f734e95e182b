"""Bakes soft lighting into colours: a sky, one large lamp, self-shadowing and occlusion at the ground.

Deterministic and without rays: occlusion is read from blurred occupancy a few steps away from the surface (as in cone
tracing, Crassin et al. 2011, with one level).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
SUN = np.array([-0.45, -0.60, 0.66])  # from the viewer's left, in front and above, for an object that faces -y
STEPS = (1.2, 2.2, 3.6)  # distances, in cells, at which occlusion is probed


@dataclass(frozen=True, eq=False)
class Occupancy:
    """An occupancy grid: `cells [X, Y, Z]` in [0, 1], `origin` of the corner of cell 0, `step` metres per cell."""

    cells: NDArray[np.float32]
    origin: Array
    step: float

    def at(self, points: Array) -> Array:
        """Occupancy `[N]` at points `[N, 3]`, by trilinear interpolation between cell centres, 0 outside."""
        from scipy.ndimage import map_coordinates

        index = (points - self.origin) / self.step - 0.5
        return np.asarray(map_coordinates(self.cells, index.T, order=1, mode="constant", cval=0.0))


def occupancy(points: Array, across: int = 22, step: float | None = None) -> Occupancy:
    """Occupancy of surface samples, blurred once by a 3-cell box in each axis."""
    low, high = points.min(axis=0), points.max(axis=0)
    step = step or max(float((high - low).max()) / across, 1e-4)
    origin = low - 2.5 * step
    shape = tuple(((high - origin) / step).astype(int) + 3)
    index = ((points - origin) / step).astype(np.int64)
    cells = np.zeros(shape, dtype=np.float32)
    cells[index[:, 0], index[:, 1], index[:, 2]] = 1.0
    for axis in range(3):
        cells = (np.roll(cells, 1, axis) + 2 * cells + np.roll(cells, -1, axis)) / 4
    return Occupancy(cells, origin, step)


def bake(
    points: Array, normals: Array, space: Occupancy, sun: Array = SUN, two_sided: NDArray[np.bool_] | None = None
) -> Array:
    """Brightness `[N]`, about 0.45 in the dark and 1.1 in full light, 0.9 on average.

    Args:
        points: `[N, 3]` on the surface; the lowest lie on the ground.
        normals: `[N, 3]`, outward.
        space: the occluders.
        sun: direction towards the lamp, any length, in the frame of the points.
        two_sided: `[N]` bool, samples that are lit from both sides.
    """
    toward = sun / np.linalg.norm(sun)
    facing = normals @ toward
    if two_sided is not None:
        facing = np.where(two_sided, np.maximum(facing, -0.6 * facing), facing)
    blocked = np.zeros(len(points))
    for k, reach in enumerate(STEPS):
        probe = points + normals * (reach * space.step)
        blocked += space.at(probe) * (0.5, 0.3, 0.2)[k]
    shadow = np.zeros(len(points))
    start = points + normals * (1.3 * space.step)
    for reach in (1.0, 2.2, 3.6, 5.5, 8.0):
        shadow = np.maximum(shadow, space.at(start + toward * (reach * space.step)))
    up = 0.5 + 0.5 * normals[:, 2]
    height = points[:, 2] - points[:, 2].min()
    ground = np.exp(-height / 0.12) * (1 - up)
    sky = (0.70 + 0.14 * up) * (1 - 0.60 * np.clip(1.6 * blocked - 0.1, 0, 1)) * (1 - 0.30 * ground)
    lamp = 0.40 * np.clip(facing + 0.15, 0, None) / 1.15 * (1 - 0.75 * np.clip(1.8 * shadow, 0, 1))
    return np.asarray(sky + lamp)
