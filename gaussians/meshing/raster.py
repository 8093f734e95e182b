"""Draws triangles from a pinhole camera: which triangle each pixel shows, where on it, and how far away."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import compiled
from ..camera import Camera
from ..compiled import exact

F64 = NDArray[np.float64]

NEAR = 1e-6  # scene units; a triangle with a corner nearer than this is not drawn


@dataclass(frozen=True, eq=False)
class Seen:
    """What each pixel's centre shows.

    Attributes:
        face: `[H, W]` int32, -1 where there is none.
        weights: `[H, W, 3]` float32, barycentric, of the triangle's corners.
        depth: `[H, W]` float32 camera z, scene units; infinite where there is none.
    """

    face: NDArray[np.int32]
    weights: NDArray[np.float32]
    depth: NDArray[np.float32]


def draw(vertices: F64, faces: NDArray[np.int64], camera: Camera) -> Seen:
    """Draw triangles `faces [F, 3]` of `vertices [V, 3]` (world) from both sides; the nearest wins, of equal ones the
    first."""
    local = vertices @ camera.world_to_camera[:3, :3].T + camera.world_to_camera[:3, 3]
    size = camera.height, camera.width
    seen = Seen(np.full(size, -1, np.int32), np.zeros((*size, 3), np.float32), np.full(size, np.inf, np.float32))
    lens = np.array([camera.fx, camera.fy, camera.cx, camera.cy])
    compiled.run_alone(_draw, local, faces, lens, NEAR, seen.face, seen.weights, seen.depth)
    return seen


@exact
def _draw(local, faces, lens, nearest, face, weights, depth):  # type: ignore[no-untyped-def]
    height, width = face.shape
    for n in range(faces.shape[0]):
        a, b, c = faces[n, 0], faces[n, 1], faces[n, 2]
        za, zb, zc = local[a, 2], local[b, 2], local[c, 2]
        if not (za > nearest and zb > nearest and zc > nearest):
            continue
        xa, ya = lens[0] * local[a, 0] / za + lens[2], lens[1] * local[a, 1] / za + lens[3]
        xb, yb = lens[0] * local[b, 0] / zb + lens[2], lens[1] * local[b, 1] / zb + lens[3]
        xc, yc = lens[0] * local[c, 0] / zc + lens[2], lens[1] * local[c, 1] / zc + lens[3]
        twice = (xb - xa) * (yc - ya) - (xc - xa) * (yb - ya)
        if twice == 0.0:
            continue
        left, right = min(xa, min(xb, xc)), max(xa, max(xb, xc))
        top, bottom = min(ya, min(yb, yc)), max(ya, max(yb, yc))
        if not (right >= 0.5 and bottom >= 0.5 and left <= width - 0.5 and top <= height - 0.5):
            continue
        for y in range(max(0, int(np.ceil(top - 0.5))), min(height - 1, int(np.floor(bottom - 0.5))) + 1):
            for x in range(max(0, int(np.ceil(left - 0.5))), min(width - 1, int(np.floor(right - 0.5))) + 1):
                px, py = x + 0.5, y + 0.5
                u = ((xb - px) * (yc - py) - (xc - px) * (yb - py)) / twice
                v = ((xc - px) * (ya - py) - (xa - px) * (yc - py)) / twice
                w = 1.0 - u - v
                if u < 0.0 or v < 0.0 or w < 0.0:
                    continue
                z = 1.0 / (u / za + v / zb + w / zc)
                if z < depth[y, x]:
                    depth[y, x] = z
                    face[y, x] = n
                    weights[y, x, 0], weights[y, x, 1], weights[y, x, 2] = u * z / za, v * z / zb, w * z / zc
