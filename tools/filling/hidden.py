"""Which cells of a surface a thing hid: rays from where the scene was seen meet the thing first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from ...gaussians.camera import Camera
from .planes import F64, Mask

VOXELS = 40  # along the longest side of the space around the thing
_VIEWS = 16  # viewpoints that are asked at most
_FEW = 6  # photographs that look at the place, below which viewpoints around it are added
_ELEVATIONS = (18.0, 40.0, 65.0)  # degrees, of viewpoints that are added
_MOST_FREE = 0.35  # of the views that nothing else blocks: a cell that more of them see was not hidden
_STEP = 0.7  # voxels between two points of a ray
_CELLS = 4000  # cells that are asked at a time

FREE, GONE, KEPT = 0, 1, 2


@dataclass(frozen=True, eq=False)
class Space:
    """What fills the space around a thing.

    Attributes:
        low: `[3]`, the lowest corner.
        voxel: side, scene units.
        what: `[X, Y, Z]` int8: FREE, GONE (the thing) or KEPT (anything else).
    """

    low: F64
    voxel: float
    what: NDArray[np.int8]

    def at(self, points: F64) -> NDArray[np.int8]:
        """What is at points `[..., 3]`; -1 outside."""
        cell = np.floor((points - self.low) / self.voxel).astype(np.int64) + 1
        for axis, length in enumerate(self.what.shape):
            np.clip(cell[..., axis], 0, length + 1, out=cell[..., axis])
        return np.asarray(self._padded[cell[..., 0], cell[..., 1], cell[..., 2]])

    @cached_property
    def _padded(self) -> NDArray[np.int8]:
        """`what` in a shell of -1."""
        return np.pad(self.what, 1, constant_values=-1)


def space_of(thing: F64, kept: F64, low: F64, high: F64) -> Space:
    """The space between two corners `[3]` filled by a thing's points `[K, 3]`, and by others `[M, 3]`."""
    voxel = float((high - low).max()) / VOXELS
    shape = np.maximum(np.ceil((high - low) / voxel).astype(int), 1)
    what = np.zeros(shape, np.int8)
    for points, name in ((kept, KEPT), (thing, GONE)):
        cell = np.floor((points - low) / voxel).astype(np.int64)
        cell = cell[((cell >= 0) & (cell < shape)).all(axis=1)]
        count = np.zeros(shape, np.int32)
        np.add.at(count, tuple(cell.T), 1)
        full = count > 0
        if name == GONE:  # a body seen from outside is hollow, and its surface has gaps of a voxel
            full = scipy.ndimage.binary_closing(np.pad(full, 2), iterations=2)[2:-2, 2:-2, 2:-2]
        what[full] = name
    return Space(low, voxel, what)


def hidden(points: F64, normal: F64, space: Space, cameras: Sequence[Camera], up: F64) -> tuple[Mask, Mask]:
    """Which points `[M, 3]` of a surface were hidden by the thing, and which were seen, `[M]` each.

    A point that other things hide is neither.

    Args:
        normal: `[3]` of the surface, toward the thing.
        cameras: where the scene was seen from; viewpoints around the thing are added where they are few.
    """
    blocked, free = np.zeros(len(points), np.int64), np.zeros(len(points), np.int64)
    for first in range(0, len(points), _CELLS):
        part = slice(first, first + _CELLS)
        for way, asked in _ways(points[part], normal, cameras, up):
            met = _met(points[part] + normal * 1.2 * space.voxel, way, space)
            blocked[part] += asked & (met == GONE)
            free[part] += asked & (met == FREE)
    was = (blocked > 0) & (free <= _MOST_FREE * (blocked + free))
    return was, ~was & (free > 0)


def _ways(points: F64, normal: F64, cameras: Sequence[Camera], up: F64) -> list[tuple[F64, Mask]]:
    """Unit directions `[M, 3]` from points to viewpoints before the surface, and which points each of them asks."""
    middle = points.mean(axis=0)
    looking = [c for c in cameras if c.contains(*c.project(middle[None]))[0] and (c.position - middle) @ normal > 0]
    found: list[tuple[F64, Mask]] = []
    for camera in looking[:: max(1, -(-len(looking) // _VIEWS))]:
        way = camera.position - points
        length = np.linalg.norm(way, axis=1)
        ahead = (way @ normal > 0.05 * length) & camera.contains(*camera.project(points))
        found.append((way / np.maximum(length, 1e-12)[:, None], ahead))
    if len(found) >= _FEW:
        return found
    for way in ring_of_directions(up):
        if way @ normal > 0.15:
            found.append((np.broadcast_to(way, points.shape), np.ones(len(points), bool)))
    return found


def ring_of_directions(up: F64) -> F64:
    """`[V, 3]` unit directions in rings above the horizon."""
    side = np.cross(up, np.eye(3)[int(np.abs(up).argmin())])
    side /= np.linalg.norm(side)
    other = np.cross(up, side)
    ways = []
    for k, elevation in enumerate(np.radians(_ELEVATIONS)):
        for turn in np.radians(np.arange(0.0, 360.0, 36.0) + 12.0 * k):
            level = np.cos(turn) * side + np.sin(turn) * other
            ways.append(np.cos(elevation) * level + np.sin(elevation) * up)
    return np.array(ways)


def _met(starts: F64, way: F64, space: Space) -> NDArray[np.int8]:
    """What rays from points `[M, 3]` along directions `[M, 3]` meet first: GONE, KEPT, or FREE for nothing."""
    met = np.zeros(len(starts), np.int8)
    alive = np.arange(len(starts))
    at = starts.copy()
    for _ in range(int(2 * VOXELS / _STEP)):
        here = space.at(at[alive])
        hit = here > 0
        met[alive[hit]] = here[hit]
        alive = alive[here == 0]
        if not len(alive):
            break
        at[alive] += way[alive] * (_STEP * space.voxel)
    return met
