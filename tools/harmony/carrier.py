"""What carries a thing: the level surface under it, or the wall behind it, and that surface's Gaussians near it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.language.field.measure import reach, solid_points
from ...gaussians.render import contributions
from ...gaussians.rows import rows_within
from ...gaussians.scene import Frame, Scene
from ..filling.charts import Chart
from ..filling.fill import spread
from ..filling.occlusion import Blocked, blocked, reach_of
from ..filling.planes import Mask, Plane
from .falling import taken

F64 = NDArray[np.float64]
_CELLS = 72  # along the longer side of a chart
_DEEP, _ROUGH, _HAZE = 0.5, 0.1, 0.3  # of its extent: how deep a surface's layers go, how high it and its haze rise
_SEEN_FROM, _SOLID = 0.02, 0.1  # opacity from which a Gaussian counts at all, and as a part of the surface
_CLEAR, _SHOWS = 0.5, 0.02  # opacity below which a Gaussian is haze; cells of a chart that it must fill to be seen
_FEW = 4_000  # Gaussians of a surface that tell whether it is seen
_POINTS = 12_000  # of a thing, from which its occlusion is measured
_SLAB = 0.05  # of a thing's extent: how far from its underside the surface that carries it may be
_NOISE = 3.0  # times the median distance of a surface's points from it: how thick it is
_RING = 12  # cells along each side of the place in which a surface must be seen
_SEEN = 0.3  # share of those around the footprint
_FACES = 0.5  # of that, for a wall


@dataclass(frozen=True, eq=False)
class Carried:
    """A thing on the surface that carries it.

    Attributes:
        shade: the light that it takes from the surface.
        rows: `[M]` the Gaussians of the surface around it.
        level: whether the surface is level, else it is a wall.
        table: `[H, W]` the share of the scene's light that it takes.
    """

    shade: Blocked
    rows: Tensor
    level: bool
    table: F64

    def share(self, cloud: GaussianCloud) -> F64:
        """`[M]` the light that the thing takes from each of the surface's Gaussians, averaged over what it covers."""
        return self.share_of(cloud[self.rows])

    def share_of(self, cloud: GaussianCloud) -> F64:
        """`[M]` likewise, of other Gaussians on the surface: all of a cloud."""
        return _averaged(self.shade, self.table, cloud)

    def at(self, points: Tensor) -> F64:
        """`[M]` likewise, at points `[M, 3]` (world)."""
        chart = self.shade.chart
        at = (chart.plane.local(points.to(torch.float64).cpu().numpy())[:, :2] - chart.low) / chart.cell - 0.5
        return np.asarray(scipy.ndimage.map_coordinates(self.table, at[:, ::-1].T, order=1, mode="nearest"))


def carried(
    scene: Scene,
    thing: Tensor,
    without: Tensor | None = None,
    most: int | None = None,
    layers: bool = False,
    lit: Scene | None = None,
) -> Carried | None:
    """The surface that carries a thing; None if it hangs in the air, or no surface was seen there.

    Args:
        thing: rows `[M]` of the scene's cloud, ascending.
        without: `[N]` bool, Gaussians that are no surface: other things that are put there. None: there are none.
        most: Gaussians of the surface that are wanted, about; None: all.
        layers: whether what is seen of a level surface above and below its middle is wanted too.
        lit: the scene whose light falls there; None: this one.
    """
    cloud = scene.cloud
    points = solid_points(cloud, thing)
    if len(points) < 4:
        return None
    extent = float(np.ptp(points, axis=0).max())
    if extent <= 0:
        return None
    near = rows_within(cloud.means, points.min(axis=0) - extent, points.max(axis=0) + extent)
    own = torch.isin(near, thing)
    own = own if without is None else own | without[near]
    near = near[~own & (cloud.opacities[near] > _SEEN_FROM)]
    if len(near) < 8:
        return None
    body = _body(cloud, thing, extent)
    for level, plane in _planes(scene.frame, points):
        found = _on(cloud, near, plane, body, extent, layers)
        if found is not None:
            shade, rows = found
            some = rows if most is None else rows[:: max(1, len(rows) // most)]
            return Carried(shade, some, level, taken(lit or scene, shade, level))
    return None


def _body(cloud: GaussianCloud, thing: Tensor, extent: float) -> F64:
    """Points that a thing's Gaussians cover, at most about `_POINTS`."""
    solid = thing[cloud.opacities[thing] > 0.3]
    solid = solid if len(solid) > 8 else thing
    return spread(cloud, solid[:: max(1, -(-len(solid) // _POINTS))], extent)


def _planes(frame: Frame, points: F64) -> list[tuple[bool, Plane]]:
    """The planes that a thing may rest on: below it, then behind each of its upright sides."""
    east, north, up = frame.basis()
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    found = []
    for normal, across, level in (
        (up, east, True), (-north, east, False), (north, -east, False), (-east, -north, False), (east, north, False),
    ):  # fmt: skip
        low, _ = reach(points @ normal)
        origin = middle + normal * (low - float(middle @ normal))
        second = north if level else np.cross(normal, across)
        found.append((level, Plane(origin, np.stack([across, second, normal]), 0.0, True, level)))
    return found


def _on(
    cloud: GaussianCloud, near: Tensor, plane: Plane, body: F64, extent: float, layers: bool
) -> tuple[Blocked, Tensor] | None:
    """The light that a thing takes from the surface at a plane, and the surface's rows; None if there is no surface."""
    local = plane.local(body)
    low, high = np.quantile(local[:, :2], [0.002, 0.998], axis=0)
    wide = float((high - low).max())
    beyond = reach_of(wide, float(np.quantile(local[:, 2], 0.98)))
    low, high = low - 1.3 * beyond, high + 1.3 * beyond
    points = plane.local(cloud.means[near].to(torch.float64).cpu().numpy())
    within = ((points[:, :2] > low) & (points[:, :2] < high)).all(axis=1)
    solid = (cloud.opacities[near] > _SOLID).cpu().numpy()
    inside = within & solid & (np.abs(points[:, 2]) < _SLAB * extent)
    if inside.sum() < 8:
        return None
    middle = float(np.median(points[inside, 2]))
    noise = float(np.median(np.abs(points[inside, 2] - middle)))
    thick = max(_NOISE * 1.48 * noise, 0.2 * _SLAB * extent)
    flat = inside & (points[:, 2] - middle < thick) & (points[:, 2] - middle > -2 * thick)
    plane = Plane(plane.origin + plane.normal * middle, plane.axes, noise, plane.last, plane.carries)
    rows = near[torch.from_numpy(flat)]
    if not _is_seen(spread(cloud, rows[:: max(1, len(rows) // _FEW)], extent), plane, body, low, high):
        return None
    cell = float((high - low).max()) / _CELLS
    w, h = (max(4, int(np.ceil(s / cell))) for s in high - low)
    chart = Chart(plane, low, cell, (h, w))
    if layers and plane.carries:
        seen = _layers(cloud[near], points[:, 2] - middle, within, chart, extent)
        rows = near[torch.from_numpy(flat | seen)]
    return blocked(body, chart, beyond), rows


def _layers(near: GaussianCloud, height: F64, within: NDArray[np.bool_], chart: Chart, extent: float) -> Mask:
    """`[M]` which Gaussians one sees who looks down on a surface: fitted ground is haze over layers at many depths,
    and a shadow that falls on one of them alone hardly shows.

    Args:
        height: `[M]` above the surface, scene units.
        within: `[M]` those over the chart.
    """
    clear = (near.opacities < _CLEAR).cpu().numpy()
    use = within & (height > -_DEEP * extent) & (height < np.where(clear, _HAZE, _ROUGH) * extent)
    rows = torch.from_numpy(np.flatnonzero(use))
    found = np.zeros(len(near), bool)
    if len(rows):
        shown = contributions(near[rows], chart.camera()).cpu().numpy()
        found[rows.numpy()[shown > _SHOWS]] = True
    return found


def _is_seen(points: F64, plane: Plane, body: F64, low: F64, high: F64) -> bool:
    """Whether a surface's points fill enough of the place around a thing's footprint."""

    def cells(at: F64) -> NDArray[np.bool_]:
        index = ((plane.local(at)[:, :2] - low) / np.maximum(high - low, 1e-12) * _RING).astype(np.int64)
        index = index[((index >= 0) & (index < _RING)).all(axis=1)]
        filled = np.zeros((_RING, _RING), bool)
        filled[index[:, 0], index[:, 1]] = True
        return filled

    around = ~cells(body)
    share = float(cells(points)[around].mean()) if around.any() else 1.0
    return share >= (_SEEN if plane.carries else _FACES)


def _averaged(shade: Blocked, table: F64, cloud: GaussianCloud) -> F64:
    """`[M]` a chart's values at the Gaussians of a cloud, around the middle of those wider than a cell."""
    chart = shade.chart
    centre = cloud.means.to(torch.float64).cpu().numpy()
    wide = cloud.scales.amax(dim=1).to(torch.float64).cpu().numpy() / chart.cell
    at = (chart.plane.local(centre)[:, :2] - chart.low) / chart.cell - 0.5
    found = np.asarray(scipy.ndimage.map_coordinates(table, at[:, ::-1].T, order=1, mode="nearest"))
    large = wide > 1
    total = found[large]
    for step in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        place = (at[large] + np.array(step) * wide[large, None])[:, ::-1].T
        total = total + scipy.ndimage.map_coordinates(table, place, order=1, mode="nearest")
    found[large] = total / 5
    return found
