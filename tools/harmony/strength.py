"""How dark the contact shadows of a scene are, told by those that its things cast already.

A thing takes a share of the light from the surface that carries it (`filling.occlusion`). The logarithm of the
brightness of the surface falls with that share, by a factor that the light of the scene gives and that is much the same
for all things. It is measured on several things, and the median is taken.
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
from ...gaussians.language.field.group_index import index_groups
from ...gaussians.language.field.language_field import LanguageField
from ...gaussians.scene import Scene
from ..color_map import LUMA
from ..filling.occlusion import depth_of
from .carrier import Carried, carried

F64 = NDArray[np.float64]
FAINT = 1.65  # strength where no shadow of the scene can be measured
MOST = 2.6  # strength of the darkest shadows
_ROWS = 8_000  # Gaussians of the surface around a thing that it is measured on
_THINGS = 6  # that are measured, the largest that are no room
_LEAST = 150  # Gaussians of a thing that is measured
_WIDE = 0.4  # of the scene's extent: what is larger is no thing
_NEAR, _NONE = 0.06, 0.01  # shares of light from which a Gaussian lies in the shadow, and below which it lies in none
_FEW = 25  # Gaussians of each that are needed
_ROUNDS = 5
_ERROR = 0.25  # largest standard error of a strength that counts
_APART = 6.0  # Gaussians of a pattern that vary together: how many fewer there are for the error
_ENOUGH = 5  # measures that tell the strength alone
_FLAT = 0.06  # strength below which things cast no shadow


@dataclass(frozen=True)
class Strength:
    """How dark contact shadows are.

    Attributes:
        value: factor in the exponent: a surface's colours are multiplied by `exp(-value * depth_of(share))`.
        measured: on how many things it was measured; 0: it is the default.
        lit: whether anything in the scene is shaded, else it has no shadows either.
    """

    value: float
    measured: int
    lit: bool = True


_known: Kept[Strength] = Kept(4)


def strength_of(scene: Scene) -> Strength:
    """The strength of a scene's contact shadows; the last few are kept."""
    cloud = scene.cloud
    return _known.get((cloud.means, cloud.sh, cloud.group), lambda: _measured(scene))


def _measured(scene: Scene) -> Strength:
    from .shading import shading_of

    found = []
    for rows in _things(scene):
        place = carried(scene, rows, most=_ROWS)
        if place is not None and place.level and (one := fitted(scene.cloud, place)) is not None:
            found.append(one)
    lit = shading_of(scene).lit
    if not lit:
        return Strength(0.0, len(found), False)
    # Few measures are drawn to what is usual: of a capture, the darkest places below things are not seen.
    value = float(np.clip(np.median([*found, *[FAINT] * max(0, _ENOUGH - len(found))]), 0.0, MOST))
    return Strength(value if value >= _FLAT else 0.0, len(found))


def _things(scene: Scene) -> list[Tensor]:
    """Rows of the things that are measured, the largest first."""
    field = scene.language
    if field is None:
        return []
    index = index_groups(scene.cloud)
    whole = _extent(field)
    told = [g for g in field.objects() if g.count >= _LEAST and not g.inserted and max(g.box.size) < _WIDE * whole]
    told.sort(key=lambda g: (-g.count, g.id))
    return [torch.from_numpy(index.rows(field.leaves(g.id))) for g in told[:_THINGS]]


def _extent(field: LanguageField) -> float:
    corners = np.concatenate([g.box.corners() for g in field.groups if g.count])
    return float(np.ptp(np.quantile(corners, [0.05, 0.95], axis=0), axis=0).max())


def fitted(cloud: GaussianCloud, place: Carried) -> float | None:
    """The strength of a thing's shadow; None if too little of the surface is seen, or its pattern hides the shadow."""
    share = place.share(cloud)
    near, none = share > _NEAR, share < _NONE
    if min(near.sum(), none.sum()) < _FEW:
        return None
    use = near | none | (share > 0)
    rows = place.rows[torch.from_numpy(use).to(place.rows.device)]
    rgb = dc_to_color(cloud.sh[rows, 0]).clamp(0, 1).to(torch.float64).cpu().numpy()
    luma = rgb @ np.array(LUMA)
    chart = place.shade.chart
    at = chart.plane.local(cloud.means[rows].to(torch.float64).cpu().numpy())[:, :2]
    at = (at - at.mean(axis=0)) / max(float(np.ptp(at, axis=0).max()), 1e-12)
    tint = rgb[:, ::2] / np.maximum(rgb.mean(axis=1, keepdims=True), 0.02) - 1
    table = np.column_stack([depth_of(share[use]), np.ones(len(at)), at, tint])
    return _slope(table, -np.log(np.maximum(luma, 0.02)))


def _slope(table: F64, values: F64) -> float | None:
    """The first coefficient of a robust linear fit; None where its standard error is large."""
    weight = np.ones(len(values))
    for _ in range(_ROUNDS):
        root = np.sqrt(weight)[:, None]
        best, *_ = np.linalg.lstsq(table * root, values * root[:, 0], rcond=None)
        rest = values - table @ best
        spread = 1.48 * float(np.median(np.abs(rest))) + 1e-3
        weight = 1 / (1 + (rest / (2 * spread)) ** 2)
    normal = np.linalg.pinv((table * weight[:, None]).T @ table)
    error = spread * float(np.sqrt(max(normal[0, 0], 0.0) * _APART))
    return float(best[0]) if error <= _ERROR else None
