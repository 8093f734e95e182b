"""What is measured of a group of Gaussians: its upright box, its colour, and the points that one could touch.

Embedding fills the table of groups with these boxes and colours and editing keeps it true with them, so that a scene
says the same of a thing whether it was embedded before an edit or after.
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
from ...rotations import to_matrix
from ...scene import Frame
from ...world.box import Axes, Box

F64 = NDArray[np.float64]

LIT = 0.8  # quantile of lightness that stands for an object's lit faces
TRIM = 0.01  # of the Gaussians on each side may lie outside the box
SOLID = 0.05  # below this opacity a Gaussian does not widen a box
OPAQUE = 0.3  # below this a Gaussian is haze rather than something one could touch
ANGLES = np.radians(np.arange(0.0, 90.0, 3.0))
_SAMPLE = 1 << 13  # rows a colour is measured on: its mean is then known to about 1/90 of the spread
_EXTENT = 20_000  # rows a box is measured on
_PAD = 1 << 12  # rows the typical reach of a Gaussian beyond its centre is measured on


@dataclass(frozen=True, eq=False)
class Sample:
    """An evenly spread sample of some rows.

    Attributes:
        rgb: `[M, 3]` float64 display colour of the constant band (the average over all directions), not clamped.
        weight: `[M]` float64, opacity times footprint, summing to one.
    """

    rgb: Tensor
    weight: Tensor

    @cached_property
    def lab(self) -> Tensor:
        """`[M, 3]` of the colours as shown (clamped to the display)."""
        return rgb_to_lab(self.rgb.clamp(0, 1))


def sample(cloud: GaussianCloud, rows: Tensor | None = None, size: int = _SAMPLE) -> Sample:
    """At most `size` of the rows (None: of all), evenly spaced, with their weights.

    A weight is the product of the two largest extents and the opacity. It is clipped at its 95th percentile so that
    a few huge splats do not speak for the whole object.
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
    """CIE Lab of the Gaussians (of some rows of them), as `lit_lab` takes it; black if there are none."""
    lightness, a, b = lit_lab(sample(cloud, rows)).tolist()
    return (min(lightness, 100.0), a, b)  # the standard's rounded matrix takes white a few millionths too far


def lit_lab(taken: Sample) -> Tensor:
    """`[3]` float64, what people call its colour: weighted medians, but for the lightness an upper quantile.

    Light falls off on an object's sides and in its folds; its name is that of its lit faces.
    """
    return lit_of(taken.weight, taken.lab)


def lit_of(weight: Tensor, lab: Tensor) -> Tensor:
    """`lit_lab` of Lab colours `[..., M, 3]` that share weights `[M]` summing to one; `[..., 3]`, zero if M is 0."""
    if not len(weight):
        return lab.new_zeros((*lab.shape[:-2], 3))
    by_channel = lab.transpose(-1, -2).contiguous()  # [..., 3, M]
    ordered, order = by_channel.sort(dim=-1)
    total = weight[order].cumsum(dim=-1)
    shares = torch.tensor([LIT, 0.5, 0.5], dtype=total.dtype, device=total.device)
    wanted = (shares[:, None] * total[..., -1:]).contiguous()  # [..., 3, 1]
    index = torch.searchsorted(total, wanted).clamp(max=len(weight) - 1)
    return ordered.gather(-1, index).squeeze(-1)


def box_of(cloud: GaussianCloud, frame: Frame, rows: Tensor | None = None, axes: Axes | None = None) -> Box:
    """The upright box around the centres and a standard deviation of each, but for the outermost 1 %.

    Args:
        rows: `[M]` int64, which of the Gaussians; None takes all.
        axes: two level axes and up the box lies along; None finds those of the smallest box.
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
    """Two level axes and up: those of the smallest box around world points `[M, 3]`, to three degrees."""
    basis = frame.basis()
    yaw = _yaw(points @ basis[:2].T)
    c, s = np.cos(yaw), np.sin(yaw)
    return as_axes(np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ basis)


def as_axes(rows: F64) -> Axes:
    """The rows of `[3, 3]` as a box holds them."""
    first, second, third = (_vec(r) for r in rows)
    return first, second, third


def mean_lab(taken: Sample) -> Tensor:
    """`[3]` float64, weighted mean in CIE Lab of the colours as shown."""
    return (taken.weight[:, None] * taken.lab).sum(dim=0)


def lightness_spread(taken: Sample) -> float:
    """Weighted standard deviation of Lab lightness: how much shading and texture there is."""
    lightness = taken.lab[:, 0]
    mean = (taken.weight * lightness).sum()
    return float((taken.weight * (lightness - mean) ** 2).sum().sqrt())


def centroid(cloud: GaussianCloud, rows: Tensor) -> F64:
    """`[3]`, plain mean of the centres, scene units."""
    means: F64 = cloud.means[rows].to(torch.float64).mean(dim=0).cpu().numpy()
    return means


def solid_points(cloud: GaussianCloud, rows: Tensor) -> F64:
    """`[M, 3]` centres of those rows that are opaque enough to touch; all of them if none is."""
    points: F64 = cloud.means[rows].to(torch.float64).cpu().numpy()
    solid = (cloud.opacities[rows] >= OPAQUE).cpu().numpy()
    return points[solid] if solid.any() else points


def reach(values: F64) -> tuple[float, float]:
    """Lowest and highest of `[M]`, a thousandth of them left out at each end (stray splats), none below 1000."""
    if not len(values):
        return 0.0, 0.0
    skip = len(values) // 1000
    ordered = np.partition(values, (skip, len(values) - 1 - skip))
    return float(ordered[skip]), float(ordered[len(values) - 1 - skip])


def _solid(cloud: GaussianCloud, rows: Tensor | None) -> Tensor:
    """The rows a box is measured on: those that can be seen, or all if none can; thinned evenly."""
    opaque = cloud.opacities > SOLID if rows is None else cloud.opacities[rows] > SOLID
    if bool(opaque.any()):
        seen = opaque.nonzero().squeeze(1)
        rows = seen if rows is None else rows[seen]
    return _thinned(cloud, rows, _EXTENT)


def _thinned(cloud: GaussianCloud, rows: Tensor | None, size: int) -> Tensor:
    """At most `size` of the rows, evenly spaced."""
    count = len(cloud) if rows is None else len(rows)
    step = max(1, -(-count // size))
    return torch.arange(0, count, step, device=cloud.device) if rows is None else rows[::step]


def _typical_reach(cloud: GaussianCloud, rows: Tensor, axes: Axes) -> F64:
    """`[3]`, median standard deviation of the Gaussians along each axis, scene units."""
    rows = _thinned(cloud, rows, _PAD)
    turned = torch.tensor(axes, dtype=torch.float32, device=cloud.device) @ to_matrix(cloud.quats[rows])  # [M, 3, 3]
    along = torch.linalg.vector_norm(turned * cloud.scales[rows][:, None, :], dim=2)
    reach: F64 = along.median(dim=0).values.to(torch.float64).cpu().numpy()
    return reach


def _yaw(plan: F64) -> float:
    """Turn (radians, in [-45°, 45°)) that makes the plan's box smallest; 0 unless another saves over 2 %."""
    areas = []
    for angle in ANGLES:
        c, s = np.cos(angle), np.sin(angle)
        turned = plan @ np.array([[c, -s], [s, c]])
        areas.append(float(np.prod(np.ptp(np.quantile(turned, [TRIM, 1 - TRIM], axis=0), axis=0) + 1e-9)))
    best = int(np.argmin(areas))
    if areas[best] > 0.98 * areas[0]:
        return 0.0
    angle = float(ANGLES[best])
    return angle if angle < np.pi / 4 else angle - np.pi / 2


def _vec(values: NDArray[np.floating]) -> Vec3:
    x, y, z = (float(v) for v in values)
    return (x, y, z)
