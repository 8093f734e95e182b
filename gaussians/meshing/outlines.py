"""Moves the vertices on a mesh's outlines to where the splats' outlines are.

Space that two views see to be free is carved, so a carved mesh is as small as the tightest of all outlines. Splats are
soft: each view ends them elsewhere. Here every vertex goes to the mean of the outlines that it lies on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..cloud import GaussianCloud
from ..render import render
from .raster import draw
from .shaping import Shape

F64 = NDArray[np.float64]
F32 = NDArray[np.float32]
Int = NDArray[np.int64]

FINER = 2  # times the pixels of the views that carve: splats are drawn no narrower than about a pixel
LEAST, MOST = 512, 768  # pixels of such a view
REACH = 1.2  # times the farthest move, in which the splats' outline is searched on each side
STEPS = 24  # of this search on each side
HALF = 0.5  # alpha at the splats' outline
INWARD = 1.5  # pixels, where an edge must be the nearest surface to be an outline that is seen
SURE = 3.0  # views from which a vertex follows them fully


@dataclass(frozen=True, eq=False)
class _Edges:
    """Edges of a closed surface: `ends` `[E, 2]`, and the two faces `[E, 2]` of each."""

    ends: Int
    faces: Int


def fitted(shape: Shape, cloud: GaussianCloud, cameras: Sequence[Camera], far: float) -> Shape:
    """A closed shape with its outlines at those of a cloud; no vertex moves farther than `far` (scene units)."""
    edges = _edges(shape)
    many = len(shape.vertices)
    total, count = np.zeros(many), np.zeros(many)
    for view in cameras:
        size = int(np.clip(FINER * view.width, LEAST, MOST))
        camera = view.resized(size, size)
        rows, offset = _offsets(shape, edges, camera, render(cloud, camera).alpha.numpy(), REACH * far)
        for end in range(2):
            total += np.bincount(edges.ends[rows, end], offset, many)
            count += np.bincount(edges.ends[rows, end], minlength=many)
    moves = np.clip(total / np.maximum(count, SURE), -far, far)
    return Shape(shape.vertices + moves[:, None] * shape.normals, shape.faces)


def _edges(shape: Shape) -> _Edges:
    f = shape.faces
    ends = np.sort(np.concatenate([f[:, [0, 1]], f[:, [1, 2]], f[:, [2, 0]]]), axis=1)
    order = np.lexsort((ends[:, 1], ends[:, 0]))  # the two of an edge become neighbours
    face = np.tile(np.arange(len(f)), 3)[order]
    return _Edges(ends[order][::2], face.reshape(-1, 2))


def _offsets(shape: Shape, edges: _Edges, camera: Camera, alpha: F32, reach: float) -> tuple[Int, F64]:
    """The edges `[R]` on the outline that a camera sees, and how far outside the splats' outline lies, scene units."""
    v = shape.vertices
    corners = v[shape.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    front = ((camera.position - corners[:, 0]) * normal).sum(axis=1) > 0
    rows = np.flatnonzero(front[edges.faces[:, 0]] != front[edges.faces[:, 1]])
    pixels, depth = camera.project(v)
    one, other = edges.ends[rows].T
    middle, along = (pixels[one] + pixels[other]) / 2, pixels[other] - pixels[one]
    length = np.linalg.norm(along, axis=1)
    # Outward on the picture: across the edge, away from the third corner of the face that is seen.
    seen = edges.faces[rows][np.arange(len(rows)), (~front[edges.faces[rows, 0]]).astype(int)]
    third = shape.faces[seen].sum(axis=1) - one - other
    across = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.maximum(length, 1e-9)[:, None]
    across *= np.where(((pixels[third] - middle) * across).sum(axis=1) > 0, -1.0, 1.0)[:, None]
    z = (depth[one] + depth[other]) / 2
    nearest = draw(v, shape.faces, camera).depth
    at = middle - INWARD * across
    inside = (at >= 0).all(axis=1) & (at < [camera.width, camera.height]).all(axis=1) & (length > 1e-6)
    column, row = np.clip(at.astype(int), 0, [camera.width - 1, camera.height - 1]).T
    visible = inside & (z > 0) & (np.abs(nearest[row, column] - z) < 3 * reach)
    offset = _crossing(alpha, middle, across * (reach * camera.fx / np.maximum(z, 1e-9))[:, None])
    kept = visible & np.isfinite(offset)
    return rows[kept], offset[kept] * reach


def _crossing(alpha: F32, middle: F64, across: F64) -> F64:
    """Multiples, -1 to 1, of `across` `[R, 2]` from `middle` `[R, 2]` (pixels) at which alpha falls through `HALF`, the
    nearest; NaN if there is none."""
    steps = np.linspace(-1, 1, 2 * STEPS + 1)
    inside = _sampled(alpha, middle[:, None] + steps[:, None] * across[:, None]) > HALF  # [R, S]
    falls = inside[:, :-1] & ~inside[:, 1:]
    distance = np.where(falls, np.abs(steps[:-1] + 0.5 / STEPS), np.inf)
    best = distance.argmin(axis=1)
    return np.where(falls.any(axis=1), steps[best] + 0.5 / STEPS, np.nan)


def _sampled(image: F32, at: F64) -> F64:
    """An image at places `[..., 2]` in pixels, bilinear; 0 outside."""
    height, width = image.shape
    x, y = at[..., 0] - 0.5, at[..., 1] - 0.5
    inside = (x >= 0) & (y >= 0) & (x <= width - 1) & (y <= height - 1)
    i, j = np.clip(np.floor(x), 0, width - 2).astype(int), np.clip(np.floor(y), 0, height - 2).astype(int)
    u, w = np.clip(x - i, 0, 1), np.clip(y - j, 0, 1)
    upper = image[j, i] * (1 - u) + image[j, i + 1] * u
    lower = image[j + 1, i] * (1 - u) + image[j + 1, i + 1] * u
    return np.where(inside, upper * (1 - w) + lower * w, 0.0)
