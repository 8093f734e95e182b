"""Fill what is missing in a surface that is named: holes that its own Gaussians surround."""

from __future__ import annotations

import numpy as np
import scipy
import torch
from torch import Tensor

from ...gaussians.scene import Scene
from .charts import COVERED, chart_of, rows_in_slab, seen
from .fill import OPAQUE, Patch, Surface, as_photographed, continue_into, points_of, rows_between, spacing_of, spread
from .planes import F64, Mask, plane_through

_LARGEST = 0.35  # of the surface: a larger gap is no hole in it
_RIM = 0.55  # of a hole's border that must be of the surface; what lies outside the chart does not count
_FEWEST = 6  # cells
_SLAB = 3.0  # times the noise of a surface: how thick it is
_FILLED = 0.08  # of the surface's extent: what is as near as that before or behind a gap fills it
OPEN = "something is seen through it, as through a window or a door"


def patches_in(scene: Scene, rows: Tensor) -> list[Patch]:
    """The holes in the surface that some Gaussians form, continued; empty if it has none, or is not flat.

    Args:
        rows: `[M]` int64, the Gaussians of the surface.
    """
    solid = rows[scene.cloud.opacities[rows] > OPAQUE]
    if len(solid) < 50:
        return []
    points = points_of(scene.cloud, solid)
    low, high = np.quantile(points, [0.005, 0.995], axis=0)
    size = float((high - low).max())
    if size <= 0:
        return []
    plane = plane_through(spread(scene.cloud, solid, size), _inside(scene), scene.frame.up_vector, size)
    if plane is None:
        return []
    near = points[np.abs(plane.height(points)) < max(_SLAB * plane.noise, 0.01 * size)]
    first, last = np.quantile(plane.local(near)[:, :2], [0.002, 0.998], axis=0)
    every = rows_between(scene.cloud, near.min(axis=0) - 0.5 * size, near.max(axis=0) + 0.5 * size)
    thick = max(_SLAB * plane.noise, 0.005 * size)
    coarse = chart_of(plane, first, last, float((last - first).max()) / 100)
    slab = rows_in_slab(scene.cloud, every, coarse, thick, thick)
    chart = chart_of(plane, first, last, spacing_of(coarse, scene.cloud, slab))
    shown = seen(chart, as_photographed(scene, slab, plane))
    covered = shown.alpha > COVERED
    around = seen(chart, scene.cloud[rows_in_slab(scene.cloud, every, chart, _FILLED * size, _FILLED * size)])
    through = seen(chart, scene.cloud[rows_in_slab(scene.cloud, every, chart, size, -2 * thick)]).alpha > COVERED
    patches = []
    for hole, support in _holes(covered, ~covered & (around.alpha <= COVERED)):
        surface = Surface(chart, shown, covered, slab)
        reason = OPEN if through[hole].mean() > 0.5 else ""
        patches.append(continue_into(scene, surface, hole, support, None, reason))
    return patches


def _inside(scene: Scene) -> F64:
    """`[M, 3]` points of where the scene is seen from, else its middle: what a surface faces."""
    if scene.cameras:
        return np.stack([c.position for c in scene.cameras])
    rows = torch.arange(0, len(scene.cloud), max(1, len(scene.cloud) // 2000))
    return np.median(points_of(scene.cloud, rows), axis=0)[None]


def _holes(covered: Mask, empty: Mask) -> list[tuple[Mask, float]]:
    """The gaps that are holes, each with the share of its border that is of the surface."""
    area, count = scipy.ndimage.label(empty)
    found = []
    for k in range(1, count + 1):
        hole = area == k
        if not _FEWEST <= hole.sum() <= _LARGEST * covered.sum():
            continue
        rim = scipy.ndimage.binary_dilation(hole, iterations=2) & ~hole
        support = float((covered & rim).sum()) / max(int(rim.sum()), 1)
        if support >= _RIM:
            found.append((np.asarray(hole), support))
    return found
