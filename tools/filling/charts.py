"""A surface seen straight from above, as pictures over its own coordinates: colour, coverage, height, groups."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud
from ...gaussians.render import render
from .planes import F64, Plane

MOST_CELLS, LEAST_CELLS = 160, 24  # along the longer side of a chart
COVERED = 0.5  # alpha from which a cell is covered
_FAR = 60.0  # times the chart's extent: distance of the eye, so that the view is nearly parallel
_FINE = 0.75  # of the spacing of the surface's Gaussians: side of a cell


@dataclass(frozen=True, eq=False)
class Chart:
    """A rectangle of a plane, cut into cells.

    Attributes:
        plane: the surface.
        low: `[2]`, its lowest corner in the plane's coordinates.
        cell: side of a cell, scene units.
        shape: cells along the plane's second and first axis, `(H, W)`.
    """

    plane: Plane
    low: F64
    cell: float
    shape: tuple[int, int]

    def centres(self) -> F64:
        """`[H, W, 2]` plane coordinates of the middle of each cell."""
        h, w = self.shape
        x = self.low[0] + (np.arange(w) + 0.5) * self.cell
        y = self.low[1] + (np.arange(h) + 0.5) * self.cell
        return np.stack(np.meshgrid(x, y), axis=2)

    def points(self, height: F64 | None = None) -> F64:
        """`[H, W, 3]` world points of the middle of each cell, at a height `[H, W]` above the plane."""
        flat = self.centres()
        z = np.zeros((*self.shape, 1)) if height is None else height[..., None]
        return self.plane.world(np.concatenate([flat, z], axis=2))

    def camera(self) -> Camera:
        """The eye far above the middle that sees each cell as one pixel, rows along the plane's second axis."""
        h, w = self.shape
        away = _FAR * max(h, w) * self.cell
        middle = self.low + np.array([w, h]) * self.cell / 2
        u, v, n = self.plane.axes
        pose = np.eye(4)
        pose[:3, :3] = np.stack([-u, v, -n])  # right-handed: columns run against the plane's first axis
        eye = self.plane.world(np.array([*middle, away]))
        pose[:3, 3] = -pose[:3, :3] @ eye
        focal = away / self.cell
        return Camera(pose, focal, focal, w / 2, h / 2, w, h, "chart")


@dataclass(frozen=True, eq=False)
class Seen:
    """What a chart shows.

    Attributes:
        rgb: `[H, W, 3]`, not weighted by alpha; zero where nothing is.
        alpha: `[H, W]`.
        height: `[H, W]` above the plane, scene units.
        group: `[H, W]` int32, -1 where nothing is.
    """

    rgb: F64
    alpha: F64
    height: F64
    group: NDArray[np.int32]


def chart_of(plane: Plane, low: F64, high: F64, spacing: float) -> Chart:
    """The chart of the rectangle between two corners `[2]`; `spacing` is that of the surface's Gaussians."""
    extent = float((high - low).max())
    cell = float(np.clip(_FINE * spacing, extent / MOST_CELLS, extent / LEAST_CELLS))
    w, h = (max(4, math.ceil(float(s) / cell)) for s in high - low)
    return Chart(plane, low, cell, (h, w))


def seen(chart: Chart, cloud: GaussianCloud) -> Seen:
    """What the Gaussians show in a chart, seen along its normal."""
    if not len(cloud):
        h, w = chart.shape
        return Seen(np.zeros((h, w, 3)), np.zeros((h, w)), np.zeros((h, w)), np.full((h, w), -1, np.int32))
    camera = chart.camera()
    shot = render(cloud, camera)
    images = (x.cpu().numpy()[:, ::-1] for x in (shot.rgb, shot.alpha, shot.depth, shot.group))
    rgb, alpha, depth, group = (np.ascontiguousarray(x) for x in images)
    alpha = alpha.astype(np.float64)
    away = float(chart.plane.height(camera.position[None])[0])
    height = np.where(alpha > 0, away - depth, 0.0)
    return Seen(rgb.astype(np.float64) / np.maximum(alpha, 1e-3)[..., None], alpha, height, group)


def rows_in_slab(cloud: GaussianCloud, rows: Tensor, chart: Chart, below: float, above: float) -> Tensor:
    """Those of some rows whose centres lie over a chart, from `below` under its plane to `above` over it."""
    points = cloud.means[rows].to(torch.float64).cpu().numpy()
    local = chart.plane.local(points)
    h, w = chart.shape
    pad = 2 * chart.cell
    high = chart.low + np.array([w, h]) * chart.cell
    inside = ((local[:, :2] > chart.low - pad) & (local[:, :2] < high + pad)).all(axis=1)
    inside &= (local[:, 2] > -below) & (local[:, 2] < above)
    return rows[torch.from_numpy(inside).to(rows.device)]
