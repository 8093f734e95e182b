"""Measurements of a group of Gaussians: its upright box, its colour, and its solid points.

Both embedding and editing fill the table of groups with these, so the table does not depend on whether a scene was
embedded before an edit or after it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...camera import Vec3
from ...cloud import GaussianCloud
from ...color import rgb_to_lab
from ...harmonics import dc_to_color
from ...kept import Kept
from ...rotations import to_matrix
from ...rows import rows_where
from ...scene import Frame
from ...world.box import Axes, Box
from ...world.core import core_of

F64 = NDArray[np.float64]

LIT_QUANTILE = 0.8  # of lightness: that of an object's lit faces
TRIM = 0.01  # share of the Gaussians on each side that may lie outside the box
MIN_BOX_OPACITY = 0.05  # Gaussians below it do not extend a box
ANGLES = np.radians(np.arange(0.0, 90.0, 3.0))
_SAMPLE = 1 << 13  # rows for a colour: the error of the mean is then about 1/90 of the standard deviation
_EXTENT = 20_000  # rows for a box
_PAD = 1 << 12  # rows for the typical extent of a Gaussian beyond its centre


@dataclass(frozen=True, eq=False)
class Sample:
    """An evenly spaced sample of some rows.

    Attributes:
        rgb: `[M, 3]` float64 display colour of the constant SH band (the mean over all directions), not clamped.
        weight: `[M]` float64, opacity times footprint, summing to one.
    """

    rgb: Tensor
    weight: Tensor

    @cached_property
    def lab(self) -> Tensor:
        """CIE Lab `[M, 3]` of the colours, clamped to the display."""
        return rgb_to_lab(self.rgb.clamp(0, 1))


def sample(cloud: GaussianCloud, rows: Tensor | None = None, size: int = _SAMPLE) -> Sample:
    """At most `size` of the rows (None: of all), evenly spaced, with their weights.

    A weight is the product of the two largest extents and the opacity. It is clipped at its 95th percentile so that
    a few very large splats do not dominate.
    """
    rows = _thinned(cloud, rows, size)
    extents = cloud.scales[rows].to(torch.float64).sort(dim=1).values
    weight = extents[:, 1] * extents[:, 2] * cloud.opacities[rows].to(torch.float64)
    if len(weight):
        weight = weight.clamp(max=float(torch.quantile(weight, 0.95)))
    total = float(weight.sum())
    even = torch.full_like(weight, 1 / max(len(weight), 1))
    return Sample(dc_to_color(cloud.sh[rows, 0].to(torch.float64)), weight / total if total > 0 else even)


def lab_of_cloud(cloud: GaussianCloud, rows: Tensor | None = None) -> Vec3:
    """Colour of a cloud, or of some of its rows, by `lit_lab`; black if there are none."""
    lightness, a, b = lit_lab(sample(cloud, rows)).tolist()
    return (min(lightness, 100.0), a, b)  # the standard's rounded matrix puts white a few millionths above 100


def lit_lab(taken: Sample) -> Tensor:
    """Perceived colour `[3]` float64 in CIE Lab: weighted medians of a and b, and the LIT_QUANTILE of the lightness.

    Sides and folds of an object are darker; people name the colour of its lit faces.
    """
    return lit_of(taken.weight, taken.lab)


def lit_of(weight: Tensor, lab: Tensor) -> Tensor:
    """`lit_lab` of Lab colours `[..., M, 3]` that share weights `[M]` summing to one; `[..., 3]`, zero if M is 0."""
    if not len(weight):
        return lab.new_zeros((*lab.shape[:-2], 3))
    by_channel = lab.transpose(-1, -2).contiguous()  # [..., 3, M]
    ordered, order = by_channel.sort(dim=-1)
    total = weight[order].cumsum(dim=-1)
    shares = torch.tensor([LIT_QUANTILE, 0.5, 0.5], dtype=total.dtype, device=total.device)
    wanted = (shares[:, None] * total[..., -1:]).contiguous()  # [..., 3, 1]
    index = torch.searchsorted(total, wanted).clamp(max=len(weight) - 1)
    return ordered.gather(-1, index).squeeze(-1)


def box_of(cloud: GaussianCloud, frame: Frame, rows: Tensor | None = None, axes: Axes | None = None) -> Box:
    """The upright box of the centres, padded by a typical standard deviation, without the outermost 1 %.

    Args:
        rows: `[M]` int64 rows of the Gaussians; None for all.
        axes: axes of the box, two level ones and up; None for those of the smallest box.
    """
    basis = frame.basis()
    rows = _solid(cloud, rows)
    if not len(rows):
        zero = (0.0, 0.0, 0.0)
        return Box(zero, axes or as_axes(basis), zero)
    points: F64 = cloud.means[rows].to(torch.float64).cpu().numpy()
    if axes is None:
        axes = level_axes(points, frame)
    local = points @ np.array(axes).T
    pad = _typical_reach(cloud, rows, axes)
    low, high = np.quantile(local, [TRIM, 1 - TRIM], axis=0)
    return box_along(axes, low - pad, high + pad)


def box_along(axes: Axes, low: F64, high: F64) -> Box:
    """The box from `low` to `high`, `[3]` coordinates along `axes`."""
    return Box(_vec((low + high) / 2 @ np.array(axes)), axes, _vec(high - low))


def level_axes(points: F64, frame: Frame) -> Axes:
    """Axes of the smallest upright box around world points `[M, 3]`, to three degrees: two level ones and up."""
    basis = frame.basis()
    yaw = _yaw(points @ basis[:2].T)
    c, s = np.cos(yaw), np.sin(yaw)
    return as_axes(np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ basis)


def as_axes(rows: F64) -> Axes:
    """The rows of a matrix `[3, 3]` as the axes of a box."""
    first, second, third = (_vec(r) for r in rows)
    return first, second, third


def mean_lab(taken: Sample) -> Tensor:
    """Weighted mean `[3]` float64 of the colours in CIE Lab."""
    return (taken.weight[:, None] * taken.lab).sum(dim=0)


def mean_chroma(taken: Sample) -> float:
    """Weighted mean of the Lab chroma of the colours."""
    return float((taken.weight * torch.linalg.vector_norm(taken.lab[:, 1:], dim=1)).sum())


def lightness_spread(taken: Sample) -> float:
    """Weighted standard deviation of Lab lightness, a measure of shading and texture."""
    lightness = taken.lab[:, 0]
    mean = (taken.weight * lightness).sum()
    return float((taken.weight * (lightness - mean) ** 2).sum().sqrt())


def centroid(cloud: GaussianCloud, rows: Tensor) -> F64:
    """Mean `[3]` of the centres of the solid Gaussians of a thing, without haze and strays, scene units."""
    mean: F64 = solid_points(cloud, rows).mean(axis=0)
    return mean


def solid_points(cloud: GaussianCloud, rows: Tensor) -> F64:
    """Centres `[M, 3]` of the solid Gaussians of a thing, without haze and strays (see `world.core`)."""
    return _solid_points.get((cloud.means, cloud.scales, cloud.opacities, rows), lambda: _points(cloud, rows))


_solid_points: Kept[F64] = Kept(8)  # an edit and its checks ask for the same


def _points(cloud: GaussianCloud, rows: Tensor) -> F64:
    points: F64 = cloud.means[rows].to(torch.float64).cpu().numpy()[core_of(cloud, rows).solid]
    points.flags.writeable = False
    return points


def reach(values: F64) -> tuple[float, float]:
    """Minimum and maximum of values `[M]` without the outermost thousandth at each end (stray splats)."""
    if not len(values):
        return 0.0, 0.0
    skip = len(values) // 1000
    ordered = np.partition(values, (skip, len(values) - 1 - skip))
    return float(ordered[skip]), float(ordered[len(values) - 1 - skip])


def _solid(cloud: GaussianCloud, rows: Tensor | None) -> Tensor:
    """The rows that a box is measured on: the visible ones, or all if none is visible; subsampled evenly."""
    opaque = cloud.opacities > MIN_BOX_OPACITY if rows is None else cloud.opacities[rows] > MIN_BOX_OPACITY
    if bool(opaque.any()):
        seen = rows_where(opaque)
        rows = seen if rows is None else rows[seen]
    return _thinned(cloud, rows, _EXTENT)


def _thinned(cloud: GaussianCloud, rows: Tensor | None, size: int) -> Tensor:
    """At most `size` of the rows, evenly spaced."""
    count = len(cloud) if rows is None else len(rows)
    step = max(1, -(-count // size))
    return torch.arange(0, count, step, device=cloud.device) if rows is None else rows[::step]


def _typical_reach(cloud: GaussianCloud, rows: Tensor, axes: Axes) -> F64:
    """Median standard deviation `[3]` of the Gaussians along each axis, scene units."""
    rows = _thinned(cloud, rows, _PAD)
    turned = torch.tensor(axes, dtype=torch.float32, device=cloud.device) @ to_matrix(cloud.quats[rows])  # [M, 3, 3]
    along = torch.linalg.vector_norm(turned * cloud.scales[rows][:, None, :], dim=2)
    reach: F64 = along.median(dim=0).values.to(torch.float64).cpu().numpy()
    return reach


def _yaw(plan: F64) -> float:
    """Rotation (radians, in [-45°, 45°)) of the plan with the smallest box; 0 unless it saves over 2 % of the area."""
    turned = np.empty((len(ANGLES), 2, len(plan)))
    for place, angle in zip(turned, ANGLES, strict=True):
        c, s = np.cos(angle), np.sin(angle)
        place[:] = (plan @ np.array([[c, -s], [s, c]])).T
    low, high = np.quantile(turned, [TRIM, 1 - TRIM], axis=-1)  # one call: hundreds of groups are measured
    areas = np.prod(high - low + 1e-9, axis=1)
    best = int(np.argmin(areas))
    if areas[best] > 0.98 * areas[0]:
        return 0.0
    angle = float(ANGLES[best])
    return angle if angle < np.pi / 4 else angle - np.pi / 2


def _vec(values: NDArray[np.floating]) -> Vec3:
    x, y, z = (float(v) for v in values)
    return (x, y, z)
