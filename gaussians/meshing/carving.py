"""Which space a scene's Gaussians fill: all that views do not see to be free.

Every view has the depth of the surface that it sees. A point in front of it is free, as far as it lies in front; a
point behind it, or that no view sees, is filled. So a thing is filled inside, whatever its Gaussians leave hollow, and
what is open on all sides, as a wall or a leaf, is as thin as its Gaussians (compare Yu et al. 2024, "Gaussian Opacity
Fields", who take the least opacity over the views of a fit).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import compiled
from ..camera import Camera
from ..cloud import GaussianCloud
from ..compiled import exact, exact_helper
from ..render import cpu

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

WITNESSES = 2  # views that must agree that a point is free: one alone may look through a gap between Gaussians
STEEP = 3.0  # pixels' worth of depth between neighbouring pixels up to which they show one surface, seen face on
_STEPS = 12  # of a search along a line, before it is bisected
_HALVINGS = 6
_DEEP = 2  # steps beyond that must be filled too: less is a sheet, of which views agree on no inside


@dataclass(frozen=True, eq=False)
class Sight:
    """What `V` views of one size see.

    Attributes:
        poses: `[V, 16]` float64, rows of the rotation, translation, fx, fy, cx, cy.
        depth: `[V, H, W]` camera z of the surface, scene units, infinite where there is none.
        slant: `[V, H, W]` distance from the surface that a step of 1 in depth along the pixel's ray covers, at most
            about 1.
    """

    poses: F64
    depth: F32
    slant: F32

    @classmethod
    def of(cls, cloud: GaussianCloud, cameras: Sequence[Camera], level: float) -> Sight:
        """What cameras of one size see of a cloud; `level` is the share of light that ends at the surface."""
        maps = list(cpu.surface_depth(cloud, cameras, level))
        return cls(poses(cameras), np.stack([depth for depth, _ in maps]), np.stack([slant for _, slant in maps]))

    def widened(self, pixels: float) -> Sight:
        """The same views with every surface wider by some pixels on all sides, so that nothing is thinner than that."""
        depth, slant = np.empty_like(self.depth), np.empty_like(self.slant)
        reach = math.floor(pixels)
        compiled.run_alone(_widen, self.depth, self.slant, reach, pixels * pixels, depth, slant)
        return Sight(self.poses, depth, slant)

    def free(self, points: F64, reach: float) -> F64:
        """How far points `[M, 3]` lie in free space, `[M]`, scene units; negative behind the surface or unseen.

        Values are distances near the surface and are cut off at +-`reach`.
        """
        out = np.empty(len(points))
        compiled.run_alone(_free, points, self.poses, self.depth, self.slant, reach, out)
        return out

    def free_on(self, low: F64, step: float, shape: tuple[int, int, int], reach: float) -> F64:
        """`free` at the nodes of a grid, `[X, Y, Z]`, whose first node is `low` `[3]`."""
        out = np.empty(shape)
        compiled.run_alone(_free_on, low, step, self.poses, self.depth, self.slant, reach, out)
        return out

    def first_filled(self, points: F64, steps: F64, missing: float) -> F64:
        """How far along `steps` `[M, 3]` from `points` `[M, 3]` filled space begins, `[M]` in 0 to 1; `missing` where
        it does not."""
        out = np.empty(len(points))
        compiled.run_alone(_first_filled, points, steps, self.poses, self.depth, self.slant, missing, out)
        return out


def poses(cameras: Sequence[Camera]) -> F64:
    """`[V, 16]`: rows of the rotation, translation, fx, fy, cx, cy."""
    return np.stack(
        [np.concatenate([c.world_to_camera[:3, :3].ravel(), c.world_to_camera[:3, 3], [c.fx, c.fy, c.cx, c.cy]])
         for c in cameras]
    )  # fmt: skip


@exact
def _widen(depth, slant, reach, square, out_depth, out_slant):  # type: ignore[no-untyped-def]
    """Give each pixel the nearest surface within a disc of pixels."""
    views, height, width = depth.shape
    for v in range(views):
        for y in range(height):
            for x in range(width):
                best, by, bx = depth[v, y, x], y, x
                for j in range(max(0, y - reach), min(height, y + reach + 1)):
                    for i in range(max(0, x - reach), min(width, x + reach + 1)):
                        if depth[v, j, i] < best and (j - y) * (j - y) + (i - x) * (i - x) <= square:
                            best, by, bx = depth[v, j, i], j, i
                out_depth[v, y, x] = best
                out_slant[v, y, x] = slant[v, by, bx]


@exact
def _free(points, poses, depth, slant, reach, out):  # type: ignore[no-untyped-def]
    for m in range(points.shape[0]):
        out[m] = _free_at(points[m, 0], points[m, 1], points[m, 2], poses, depth, slant, reach)


@exact
def _free_on(low, step, poses, depth, slant, reach, out):  # type: ignore[no-untyped-def]
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            for k in range(out.shape[2]):
                x, y, z = low[0] + i * step, low[1] + j * step, low[2] + k * step
                out[i, j, k] = _free_at(x, y, z, poses, depth, slant, reach)


@exact
def _first_filled(points, steps, poses, depth, slant, missing, out):  # type: ignore[no-untyped-def]
    for m in range(points.shape[0]):
        x, y, z = points[m, 0], points[m, 1], points[m, 2]
        dx, dy, dz = steps[m, 0], steps[m, 1], steps[m, 2]
        out[m] = missing
        for k in range(1, _STEPS + 1):
            high = k / _STEPS
            if _free_at(x + high * dx, y + high * dy, z + high * dz, poses, depth, slant, 1e-9) <= 0.0:
                deep = high + _DEEP / _STEPS
                if _free_at(x + deep * dx, y + deep * dy, z + deep * dz, poses, depth, slant, 1e-9) > 0.0:
                    continue
                low = (k - 1) / _STEPS
                for _ in range(_HALVINGS):
                    middle = 0.5 * (low + high)
                    if _free_at(x + middle * dx, y + middle * dy, z + middle * dz, poses, depth, slant, 1e-9) <= 0.0:
                        high = middle
                    else:
                        low = middle
                out[m] = 0.5 * (low + high)
                break


@exact_helper
def _free_at(x, y, z, poses, depth, slant, reach):  # type: ignore[no-untyped-def]
    """The second largest distance by which a view sees the point in front of its surface, within -reach to reach."""
    first, second = -reach, -reach
    for v in range(poses.shape[0]):
        pz = poses[v, 6] * x + poses[v, 7] * y + poses[v, 8] * z + poses[v, 11]
        if pz <= 1e-9:
            continue
        px = (poses[v, 0] * x + poses[v, 1] * y + poses[v, 2] * z + poses[v, 9]) / pz * poses[v, 12] + poses[v, 14]
        py = (poses[v, 3] * x + poses[v, 4] * y + poses[v, 5] * z + poses[v, 10]) / pz * poses[v, 13] + poses[v, 15]
        if not (px >= 0.0 and py >= 0.0 and px < depth.shape[2] and py < depth.shape[1]):
            continue
        row, column = int(py), int(px)
        near = depth[v, row, column]
        if near == np.inf:
            gap = reach
        else:
            smooth = _between(depth, v, px - 0.5, py - 0.5, STEEP * pz / poses[v, 12] / max(slant[v, row, column], 0.1))
            gap = ((smooth if smooth > 0.0 else near) - pz) * slant[v, row, column]
        gap = min(gap, reach)
        if gap > first:
            first, second = gap, first
        elif gap > second:
            second = gap
        if second >= reach:
            return reach
    return second


@exact_helper
def _between(depth, v, px, py, most):  # type: ignore[no-untyped-def]
    """The depth between four pixels, bilinear; -1 where they show different surfaces."""
    x, y = math.floor(px), math.floor(py)
    if x < 0 or y < 0 or x + 1 >= depth.shape[2] or y + 1 >= depth.shape[1]:
        return -1.0
    a, b, c, d = depth[v, y, x], depth[v, y, x + 1], depth[v, y + 1, x], depth[v, y + 1, x + 1]
    high = max(max(a, b), max(c, d))
    if high == np.inf or high - min(min(a, b), min(c, d)) > most:
        return -1.0
    u, w = px - x, py - y
    return (a * (1.0 - u) + b * u) * (1.0 - w) + (c * (1.0 - u) + d * u) * w
