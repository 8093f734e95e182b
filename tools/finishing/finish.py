"""Give some Gaussians the pigments of a texture, and keep the light on them.

Shading is the low frequency of the thing's own luma relative to its lit faces (see `coloring.shading`), with a share of
its fine contrast, so that creases and edges stay; its old pattern goes. Gaussians over which the texture varies are
split first, all to about one size, so that no part is finer than another; how many there are is limited.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.harmonics import SH_C0, dc_to_color
from ...gaussians.rotations import to_matrix
from ..color_map import LUMA
from ..coloring.quantiles import quantile
from ..coloring.shading import Shading
from .noise import F32
from .subdivide import counts_for, subdivided
from .surface import Chart, normals_of, spots_of
from .textures import Spots

Pattern = Callable[[Spots], F32]  # display colours [N, 3] in good neutral light at points of a surface

_VARIES = 0.02  # display colour by which a texture varies over a Gaussian, from which it is split
_FINEST = 0.45  # of the texture's finest feature: standard deviation that children have at most
_NEW, _MORE = 60_000, 4.0  # Gaussians after splitting: at most so many more, or so many times as many
_STEPS = 12  # of the search for the size of children
_FAINT = 0.05  # opacity below which a Gaussian is not split
_REACH = 1.1  # standard deviations from the middle at which the texture is compared with that in the middle
_FINE = 0.15  # exponent of the thing's own fine contrast
_COARSE, _BRIGHT = 0.9, 0.5  # exponents of low frequencies below and above the lit faces
_RANGE = (0.06, 2.5)  # of the shading
_LIT = 0.7  # quantile of the light by area that lit faces have
_PLACES = 8192  # at which a texture's mean colour is taken
_LEAST = 0.02  # luma of lit faces: below it a thing is too dark to have shading
_WEIGHTS = torch.tensor(LUMA, dtype=torch.float32)


@dataclass(frozen=True, eq=False)
class Paint:
    """What a surface is painted with.

    Attributes:
        pattern: the texture.
        white: `[3]` display colour of white where the surface is.
        lit: luma of the surface's lit faces before.
        detail: size of the texture's finest feature, metres.
        shine: share of its change with the direction that the surface keeps, 0 to 1.
    """

    pattern: Pattern
    white: Tensor
    lit: float
    detail: float
    shine: float


@dataclass(frozen=True, eq=False)
class Painted:
    """Painted Gaussians.

    Attributes:
        kept: `[K]` int64 rows of the cloud before that were painted and not split.
        sh: `[K, B, 3]` their new harmonics.
        split: `[S]` int64 rows that were split.
        children: the Gaussians in their place, painted, with the ids of their parents.
    """

    kept: Tensor
    sh: Tensor
    split: Tensor
    children: GaussianCloud


def mean_pigment(pattern: Pattern) -> Tensor:
    """`[3]` float64 mean display colour of a texture over five metres of surface that faces all ways."""
    rng = np.random.default_rng(0)
    places = rng.uniform(0, 5, (_PLACES, 2)).astype(np.float32)
    xyz = np.stack([places[:, 0], np.zeros(_PLACES), places[:, 1]], axis=1).astype(np.float32)
    facing = rng.normal(size=(_PLACES, 3))
    facing[:, 2] = np.abs(facing[:, 2])
    facing /= np.linalg.norm(facing, axis=1, keepdims=True)
    spots = Spots(xyz, places, facing.astype(np.float32), np.full(_PLACES, 1e-4, np.float32), 0)
    return torch.from_numpy(pattern(spots)).double().mean(dim=0)


def painted(cloud: GaussianCloud, rows: Tensor, chart: Chart, paint: Paint, most: int | None = None) -> Painted:
    """Paint some rows `[M]` of a cloud, M > 0; the rest of the cloud is not looked at.

    Args:
        most: how many Gaussians splitting may add; None: the usual limit.
    """
    normals = normals_of(chart, cloud, rows)
    own = cloud[rows]
    light = _light(own, Shading.of(cloud, rows).at(own.means), paint.lit)
    counts = _counts(own, normals, chart, paint, max(_NEW, _MORE * len(own)) if most is None else most)
    whole = (counts == 1).all(dim=1)
    kept, divided = whole.nonzero().squeeze(1), (~whole).nonzero().squeeze(1)
    children, parents = subdivided(own[divided], counts[divided])
    sh = _harmonics(own[kept], normals[kept.numpy()], light[kept], chart, paint)
    from_parents = divided[parents]
    painted_children = children.replace(
        sh=_harmonics(children, normals[from_parents.numpy()], light[from_parents], chart, paint)
    )
    return Painted(rows[kept], sh, rows[divided], painted_children)


def _counts(own: GaussianCloud, normals: F32, chart: Chart, paint: Paint, most: float) -> Tensor:
    """`[M, 2]` int64: into how many each Gaussian is split along its longest and its second axis."""
    ordered = own.scales.sort(dim=1, descending=True)
    sides = ordered.values[:, :2] * chart.metres
    finest = _FINEST * paint.detail
    counts = torch.ones(len(own), 2, dtype=torch.int64)
    if most <= 0:
        return counts
    coarse = ((sides[:, 0] > finest) & (own.opacities > _FAINT)).nonzero().squeeze(1)
    if not len(coarse):
        return counts
    gains = _varies(own[coarse], ordered.indices[coarse], normals[coarse.numpy()], chart, paint)
    coarse = coarse[gains > _VARIES]
    opacities = own.opacities[coarse]
    limit = len(own) + most
    low, high = finest, max(finest, float(sides.max()))  # the finest size that keeps to the limit, by bisection
    wanted = low
    for _ in range(_STEPS):
        made = torch.stack([counts_for(sides[coarse, k], opacities, wanted) for k in (0, 1)], dim=1)
        if len(own) + int((made.prod(dim=1) - 1).sum()) <= limit:
            if wanted == finest:
                break
            high = wanted
        else:
            low = wanted
        wanted = (low * high) ** 0.5
    else:
        made = torch.stack([counts_for(sides[coarse, k], opacities, high) for k in (0, 1)], dim=1)
    counts[coarse] = made
    return counts


def _varies(own: GaussianCloud, order: Tensor, normals: F32, chart: Chart, paint: Paint) -> Tensor:
    """`[M]` how much finer Gaussians would show of the texture: its largest difference of colour between the middle of
    a Gaussian and points beside it, display values."""
    axes = to_matrix(own.quats)
    fine = torch.full((len(own),), _FINEST * paint.detail / chart.metres)
    middle = torch.from_numpy(paint.pattern(spots_of(chart, own.means, normals, fine)))
    most = torch.zeros(len(own))
    for k in (0, 1):
        along = axes.gather(2, order[:, k, None, None].expand(-1, 3, 1)).squeeze(2)
        side = own.scales.gather(1, order[:, k, None])
        for sign in (-_REACH, _REACH):
            spots = spots_of(chart, own.means + sign * side * along, normals, fine)
            most = most.maximum((torch.from_numpy(paint.pattern(spots)) - middle).abs().amax(dim=1))
    return most


def _light(own: GaussianCloud, shading: Tensor, lit: float) -> Tensor:
    """`[M]` the light on Gaussians relative to that on the lit faces of the surface, whose luma is `lit`.

    Args:
        shading: `[M]` low frequencies of the luma.
    """
    luma = dc_to_color(own.sh[:, 0]).clamp(0, 1) @ _WEIGHTS
    low = (shading.float() / max(lit, _LEAST)).clamp(*_RANGE)
    fine = ((luma + 0.05) / (shading.float() + 0.05)).clamp(0.25, 2.0) ** _FINE
    light = torch.where(low < 1, low**_COARSE, low**_BRIGHT) * fine
    # Fine contrast of an old pattern shifts the mean: the lit faces stay at 1.
    area = own.scales.sort(dim=1).values[:, 1:].prod(dim=1) * own.opacities
    return light / max(quantile(light, area / area.sum().clamp(min=1e-30), _LIT), _LEAST)


def _harmonics(own: GaussianCloud, normals: F32, light: Tensor, chart: Chart, paint: Paint) -> Tensor:
    """`[M, B, 3]` the harmonics of Gaussians with the pigments of the texture.

    Args:
        light: `[M]` as `_light` finds it.
    """
    if not len(own):
        return own.sh
    blur = own.scales.sort(dim=1).values[:, 1:].prod(dim=1).sqrt()
    pigment = torch.from_numpy(paint.pattern(spots_of(chart, own.means, normals, blur)))
    color = (pigment * paint.white.float() * light[:, None]).clamp(0, 1)
    sh = torch.zeros_like(own.sh)
    sh[:, 0] = (color - 0.5) / SH_C0
    if own.sh.shape[1] > 1 and paint.shine > 0:
        luma = dc_to_color(own.sh[:, 0]).clamp(0, 1) @ _WEIGHTS
        gain = paint.shine * ((color @ _WEIGHTS + 0.05) / (luma + 0.05)).clamp(max=1.5)
        grey = own.sh[:, 1:] @ _WEIGHTS
        sh[:, 1:] = (gain[:, None] * grey)[:, :, None] * paint.white.float()
    return sh
