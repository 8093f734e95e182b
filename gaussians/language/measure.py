"""What is measured of a group: its upright box and its colour. Knows numbers only."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

from ..camera import Vec3
from ..cloud import GaussianCloud
from ..scene import Frame
from .field import Box
from .surface import base_lab

LIT = 0.8  # quantile of lightness that stands for an object's lit faces
TRIM = 0.01  # of the Gaussians on each side may lie outside the box
ANGLES = np.radians(np.arange(0.0, 90.0, 3.0))


def box_of(cloud: GaussianCloud, frame: Frame) -> Box:
    """The smallest upright box around the centres and a standard deviation of each, but for the outermost 1 %."""
    basis = frame.basis()
    if not len(cloud):
        zero = (0.0, 0.0, 0.0)
        return Box(zero, tuple(_vec(r) for r in basis), zero)  # type: ignore[arg-type]
    solid = cloud[cloud.opacities > 0.05] if bool((cloud.opacities > 0.05).any()) else cloud
    step = max(1, len(solid) // 20_000)
    local = solid.means[::step].double().numpy() @ basis.T
    pad = float(solid.scales[::step].median())
    yaw = _yaw(local[:, :2])
    turn = np.array([[np.cos(yaw), np.sin(yaw), 0], [-np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    axes = turn @ basis
    low, high = np.quantile(local @ turn.T, [TRIM, 1 - TRIM], axis=0)
    low, high = low - pad, high + pad
    return Box(_vec((low + high) / 2 @ axes), tuple(_vec(a) for a in axes), _vec(high - low))  # type: ignore[arg-type]


def _yaw(plan: NDArray[np.float64]) -> float:
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


def lab_of_cloud(cloud: GaussianCloud) -> Vec3:
    """CIE Lab of the Gaussians, weighted by footprint and opacity: medians, but for the lightness an upper quantile.

    Light falls off on an object's sides and in its folds; what people call its colour is that of its lit faces.
    """
    if not len(cloud):
        return (0.0, 0.0, 0.0)
    step = max(1, len(cloud) // 20_000)
    part = cloud[::step]
    lab = base_lab(part)
    ordered = part.scales.sort(dim=1, descending=True).values
    weight = ordered[:, 0] * ordered[:, 1] * part.opacities
    weight = weight.clamp(max=float(torch.quantile(weight, 0.95)))
    return _vec([_weighted_quantile(lab[:, c], weight, q) for c, q in enumerate((LIT, 0.5, 0.5))])


def _weighted_quantile(values: torch.Tensor, weight: torch.Tensor, share: float) -> float:
    order = values.argsort()
    total = weight[order].cumsum(0)
    return float(values[order[int(torch.searchsorted(total, total[-1] * share).clamp(max=len(order) - 1))]])


def _vec(values: NDArray[np.float64] | list[float]) -> Vec3:
    x, y, z = (float(v) for v in values)
    return (x, y, z)
