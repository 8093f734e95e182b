"""How the brightness of a scene's surfaces depends on the way they face: harmonics of degree one of its light.

Surfaces differ by their colour more than by their light. So each thing is compared with itself: the logarithm of its
brightness, less the thing's mean, is fitted by a linear function of the normal, less the thing's mean normal. Light
that comes from above and from a side makes things brighter there, whatever their colours are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.harmonics import dc_to_color
from ...gaussians.kept import Kept
from ...gaussians.rotations import to_matrix
from ...gaussians.scene import Scene
from ..color_map import LUMA

F64 = NDArray[np.float64]
_SAMPLE = 30_000  # Gaussians that are compared
_OPAQUE = 0.3
_FLAT = 0.6  # shortest over middle side of a Gaussian up to which it has a normal
_LEAST = 30  # Gaussians of a thing
_STEEPEST = 0.8  # largest slope: surfaces that face the light over those across it, logarithm
_PRIOR = 6.0  # things that are taken to be lit from above as usual
_USUAL = 0.12  # slope of light from above
_SIGNED = 0.98  # share of the Gaussians of an asset whose third axis is the shortest
_UNLIT = 0.02  # deviation of the logarithm of brightness within things, about, below which nothing is shaded


@dataclass(frozen=True, eq=False)
class Shading:
    """Light by the way surfaces face.

    Attributes:
        slope: `[3]` world frame: the logarithm of brightness grows by `slope @ normal`.
        things: on how many things it was measured.
        lit: whether anything is shaded.
    """

    slope: F64
    things: int
    lit: bool


_known: Kept[Shading] = Kept(4)


def shading_of(scene: Scene) -> Shading:
    """The shading of a scene; the last few are kept."""
    cloud = scene.cloud
    return _known.get((cloud.means, cloud.quats, cloud.sh, cloud.group), lambda: _measured(scene))


def _measured(scene: Scene) -> Shading:
    up = scene.frame.up_vector
    rows = (scene.cloud.opacities > _OPAQUE).nonzero().squeeze(1)
    rows = rows[:: max(1, -(-len(rows) // _SAMPLE))]
    normals, flat = normals_of(scene.cloud, rows)
    normals, rows = normals[flat], rows[torch.from_numpy(flat).to(rows.device)]
    points = scene.cloud.means[rows].to(torch.float64).cpu().numpy()
    owner = scene.cloud.group[rows].cpu().numpy().astype(np.int64)
    normals = _outward(scene, normals, points, owner)
    values = np.log(np.maximum(lumas(scene.cloud, rows), 0.02))
    keep = values > np.log(0.03)  # what no photograph saw is black
    return solved(normals[keep], values[keep], owner[keep], up)


def solved(normals: F64, values: F64, owner: NDArray[np.int64], up: F64) -> Shading:
    """The slope that things agree on, drawn to light from above where few tell it."""
    tables, sides, spreads = [], [], []
    for name in np.unique(owner):
        own = owner == name
        if name < 0 and len(np.unique(owner)) > 1:
            continue
        if own.sum() < _LEAST:
            continue
        n, v = normals[own] - normals[own].mean(axis=0), values[own] - np.median(values[own])
        spread = 1.48 * float(np.median(np.abs(v)))
        spreads.append(float(v.std()))
        v = np.clip(v, -2.5 * spread, 2.5 * spread)  # parts of another colour
        scale = len(n) * max(spread, 0.1)  # each thing counts alike, one of many colours less
        tables.append(n.T @ n / scale)
        sides.append(n.T @ v / scale)
    if not tables:
        return Shading(_USUAL * up, 0, True)
    prior = _PRIOR * np.eye(3) / 3
    slope = np.linalg.solve(np.sum(tables, axis=0) + prior, np.sum(sides, axis=0) + prior @ (_USUAL * up))
    length = float(np.linalg.norm(slope))
    lit = bool(np.median(spreads) >= _UNLIT)
    return Shading(slope * min(1.0, _STEEPEST / max(length, 1e-12)), len(tables), lit)


def normals_of(cloud: GaussianCloud, rows: Tensor) -> tuple[F64, NDArray[np.bool_]]:
    """`[M, 3]` shortest axes of some Gaussians, of either sign, and which of them are flat enough to have a normal."""
    scales, order = cloud.scales[rows].sort(dim=1)
    axes = to_matrix(cloud.quats[rows]).gather(2, order[:, None, :1].expand(-1, 3, -1)).squeeze(2)
    flat = scales[:, 0] < _FLAT * scales[:, 1]
    return axes.to(torch.float64).cpu().numpy(), flat.cpu().numpy()


def is_signed(cloud: GaussianCloud) -> bool:
    """Whether the shortest axes point outward, as those of assets made from surfaces do: it is the third of nearly
    all."""
    return len(cloud) > 0 and float((cloud.scales.argmin(dim=1) == 2).float().mean()) > _SIGNED


def lumas(cloud: GaussianCloud, rows: Tensor) -> F64:
    """`[M]` display luma of some Gaussians."""
    rgb = dc_to_color(cloud.sh[rows, 0]).clamp(0, 1).to(torch.float64).cpu().numpy()
    return np.asarray(rgb @ np.array(LUMA))


def _outward(scene: Scene, normals: F64, points: F64, owner: NDArray[np.int64]) -> F64:
    """Normals turned to the side that is seen: to the nearest camera, else away from the middle of their thing."""
    if scene.cameras:
        from scipy.spatial import cKDTree

        eyes = np.stack([c.position for c in scene.cameras])
        toward = eyes[cKDTree(eyes).query(points)[1]] - points
    else:
        names, at = np.unique(owner, return_inverse=True)
        count = np.bincount(at, minlength=len(names))
        middle = np.stack([np.bincount(at, points[:, k], len(names)) / count for k in range(3)], axis=1)
        toward = points - middle[at]
    sign = np.where(np.einsum("ij,ij->i", normals, toward) < 0, -1.0, 1.0)
    return np.asarray(normals * sign[:, None])
