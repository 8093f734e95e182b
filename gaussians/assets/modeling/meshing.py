"""Turns Gaussians into a closed triangle mesh with vertex colours: a grid of what they fill, and naive surface nets.

Gibson, "Constrained Elastic Surface Nets" (1998): one vertex in each cell that the surface crosses, one quad for each
edge of the grid that it crosses.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.spatial import cKDTree

from ...cloud import GaussianCloud
from ...errors import UserError
from ...harmonics import dc_to_color
from ...rotations import to_matrix

F64 = NDArray[np.float64]

CELLS = 88  # of the grid, along the longest side
_MARGIN = 4  # empty cells around the Gaussians
_REACH = 1.3  # standard deviations at which a Gaussian is sampled along each axis, besides its centre
_SPACING = 0.8  # standard deviations that a cell is wide at least, so that no cell between two samples stays empty
_SMOOTH = 0.9  # cells, standard deviation by which what is filled is smoothed
_FILLED = 0.35  # optical depth of a cell from which it is filled
_NEAR = 6  # Gaussians that colour a vertex


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles with coloured vertices.

    Attributes:
        vertices: `[V, 3]`, scene units, world.
        faces: `[F, 3]` int64, counter-clockwise seen from outside.
        colors: `[V, 3]`, display space, 0 to 1.
    """

    vertices: F64
    faces: NDArray[np.int64]
    colors: F64


def mesh_of(cloud: GaussianCloud, cells: int = CELLS) -> Mesh:
    """The surface of what Gaussians fill.

    Raises:
        UserError: there are no Gaussians, or they fill nothing.
    """
    if not len(cloud):
        raise UserError("there are no Gaussians to make a mesh of")
    means = cloud.means.cpu().numpy().astype(np.float64)
    opacity = cloud.opacities.cpu().numpy().astype(np.float64)
    low, high = (np.quantile(means, q, axis=0) for q in (0.002, 0.998))
    wide = (
        float(cloud.scales.sort(dim=1).values[:, 1].quantile(0.7)) if len(cloud) < 1 << 24 else 0.0
    )  # the limit of `quantile`
    cell = max(float((high - low).max()) / cells, _SPACING * wide, 1e-9)
    origin = low - _MARGIN * cell
    shape = tuple(int(n) + 2 * _MARGIN + 1 for n in np.ceil((high - low) / cell))
    solid = _filled(cloud, means, opacity, origin, cell, shape)
    if not solid.any():
        raise UserError("these Gaussians are too faint to make a mesh of")
    field = ndimage.gaussian_filter(solid.astype(np.float64), _SMOOTH) - 0.5
    points, faces = surface_net(field)
    vertices = origin + (points + 0.5) * cell
    return Mesh(vertices, faces, _colors(cloud, means, opacity, vertices))


def surface_net(field: F64) -> tuple[F64, NDArray[np.int64]]:
    """Vertices `[V, 3]` in cells and triangles `[F, 3]` of the surface where `field [X, Y, Z]` is zero; its border must
    be negative (outside)."""
    inside = field > 0
    corners = list(itertools.product((0, 1), repeat=3))
    span = tuple(n - 1 for n in field.shape)
    part = {c: tuple(slice(c[i], c[i] + span[i]) for i in range(3)) for c in corners}
    total, count = np.zeros((*span, 3)), np.zeros(span)
    for a, b in itertools.combinations(corners, 2):
        if sum(abs(x - y) for x, y in zip(a, b, strict=True)) != 1:
            continue
        fa, fb = field[part[a]], field[part[b]]
        crossed = inside[part[a]] != inside[part[b]]
        share = np.where(crossed, fa / np.where(crossed, fa - fb, 1.0), 0.0)[..., None]
        total += np.where(crossed[..., None], np.array(a) + share * (np.array(b) - np.array(a)), 0.0)
        count += crossed
    used = count > 0
    index = np.full(span, -1, np.int64)
    index[used] = np.arange(int(used.sum()))
    vertices = np.argwhere(used) + total[used] / count[used][:, None]
    return vertices, np.concatenate([_quads(inside, index, axis) for axis in range(3)])


def _quads(inside: NDArray[np.bool_], index: NDArray[np.int64], axis: int) -> NDArray[np.int64]:
    """Triangles across the edges of the grid along one axis where the field changes its sign."""
    ahead = np.roll(inside, -1, axis)
    crossed = np.argwhere(inside != ahead)
    leaves = inside[tuple(crossed.T)]
    u, v = np.eye(3, dtype=np.int64)[(axis + 1) % 3], np.eye(3, dtype=np.int64)[(axis + 2) % 3]
    a, b, c, d = (index[tuple((crossed - step).T)] for step in (u + v, v, 0 * u, u))
    front = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    out = np.concatenate([leaves, leaves])
    return np.where(out[:, None], front, front[:, ::-1])


def _filled(
    cloud: GaussianCloud, means: F64, opacity: F64, origin: F64, cell: float, shape: tuple[int, ...]
) -> NDArray[np.bool_]:
    """`[X, Y, Z]`, whether a cell is filled, hollows without an opening included."""
    axes = to_matrix(cloud.quats).cpu().numpy() * cloud.scales.cpu().numpy()[:, None, :]
    depth = np.zeros(int(np.prod(shape)))
    for steps in itertools.product((-_REACH, 0.0, _REACH), repeat=3):
        at = np.floor((means + axes @ np.array(steps) - origin) / cell).astype(np.int64)
        ok = ((at >= 1) & (at < np.array(shape) - 1)).all(axis=1)
        flat = np.ravel_multi_index(tuple(at[ok].T), shape)
        depth += np.bincount(flat, opacity[ok], len(depth))
    smooth = ndimage.gaussian_filter(depth.reshape(shape), 0.7)
    solid = ndimage.binary_closing(smooth > _FILLED, iterations=2)
    return np.asarray(ndimage.binary_fill_holes(solid))


def _colors(cloud: GaussianCloud, means: F64, opacity: F64, vertices: F64) -> F64:
    rgb = dc_to_color(cloud.sh[:, 0].cpu().double()).numpy()
    near = min(_NEAR, len(means))
    distance, rows = cKDTree(means).query(vertices, k=near)
    distance, rows = distance.reshape(-1, near), rows.reshape(-1, near)
    weight = opacity[rows] / (distance + distance.mean() * 0.1 + 1e-12)
    return np.clip((weight[..., None] * rgb[rows]).sum(axis=1) / weight.sum(axis=1, keepdims=True), 0, 1)
