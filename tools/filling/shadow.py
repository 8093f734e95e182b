"""The contact shadow that a thing casts on a surface: estimated as a ratio of colours against the surface around it,
divided out where the thing stood. What it casts where it is put is in `harmony.shadows`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.harmonics import SH_C0
from .charts import Chart
from .occlusion import LOBES, Blocked, depth_of
from .planes import F64, Mask
from .texture import continued_far

REACH = 0.3  # of the thing's extent: how far a contact shadow reaches beyond what it covers
_COMPACT = 2.0  # times the root of the area that a thing covers: extent from which the reach is measured at most
_DARKEST = 0.35  # ratio of colours that a contact shadow goes down to
_SEEN = 0.96  # ratio above which nothing is changed
_PART = 0.2  # of the cells near a thing, its darkest, that tell whether there is a shadow: it may stand on legs
_CLEAR = 0.9  # ratio there above which there is none
_GLOW = 1.05  # of the brightest of the surface around: what nothing may exceed
_TINT = 0.3  # difference of two colours of the same mean from which they are two materials
_BRIGHTER, _FEW = 0.15, 0.12  # by how much, and in which share of its reach, a shadow may be brighter
_FADES = 0.035  # by how much it is darker near the thing than where it ends, on average
_BEYOND, _UNEVEN = 1.5, 0.16  # its darkness over the spread of ratios where it ends, and the largest such spread
_SMOOTH = 1.5  # cells over which the ratio is averaged at least
_COARSE, _COARSEST = 0.1, 2.5  # of the shadow's reach, and cells at most: by how much more
_NONE, _DEEP = 0.004, 0.06  # shares of the light below which nothing is in shadow, and from which it is dark
_BESIDE = 6  # cells around a shadow that are compared with it
_FEWEST = 20  # cells of each
_EVENER = 0.97  # of a surface's unevenness that may be left by taking a shadow off
_FAINTEST = 0.03  # logarithm of a shadow that is not worth taking off
_APART = 9.0  # cells of a pattern that vary together
_SEEN_MODEL, _DARKEST_LOG = 0.99, 2.0  # ratio above which nothing is changed, and logarithm of the darkest
_RIDGE, _ROUNDS, _CELLS = 0.004, 5, 4_000  # of the fit, and most cells that it takes
_CORRECTED, _BRIGHT = 1.2, 0.98  # by which a ratio is corrected at most, and quantile of the brightness around
_OUTSIDE = 0.2  # how far from one the ratio may be where the shadow ends, which then counts as one


@dataclass(frozen=True, eq=False)
class Shadow:
    """A contact shadow on a chart.

    Attributes:
        ratio: `[H, W]` colour in the shadow over colour without it, in (0, 1].
        depth: mean darkening under and close to the thing, in [0, 1).
    """

    ratio: F64
    depth: float


def zone_of(footprint: Mask, chart: Chart, size: float) -> Mask:
    """The cells that the contact shadow of a thing may reach.

    Args:
        footprint: `[H, W]`, the cells below the thing.
        size: extent of the thing, scene units.
    """
    # What is spread thin, as grass, casts no wide shadow for its extent.
    reach = REACH * min(size, _COMPACT * float(np.sqrt(footprint.sum())) * chart.cell)
    return np.asarray(scipy.ndimage.distance_transform_edt(~footprint) * chart.cell <= reach)


def most_even(rgb: F64, known: Mask, footprint: Mask, zone: Mask, shade: Blocked) -> Shadow | None:
    """The shadow that a thing cast on a surface, told in the way that leaves the surface most even; None if there is
    none, or nothing to tell it by.

    One way takes any smooth ratio to the surface around it (`estimated`). The other takes what the thing's shape blocks
    of the light (`modelled`): it tells shadows on patterned ground, and those that were cast by the same rule.

    Args:
        shade: the light that the thing takes from the surface; the others as in `estimated`.
    """
    near = known & (shade.shares[0] > _NONE)
    around = near | (known & scipy.ndimage.binary_dilation(shade.shares[0] > _NONE, iterations=_BESIDE))
    smooth, shaped = estimated(rgb, known, footprint, zone), modelled(rgb, known, shade)
    if near.sum() < _FEWEST or (around & ~near).sum() < _FEWEST:
        return smooth or shaped
    # What the smooth ratio leaves, the shape may tell, and the other way round.
    both = None if smooth is None else _with(smooth, modelled(rgb / smooth.ratio[..., None], known, shade))
    best, left = None, _unevenness(rgb, around, np.ones(known.shape))
    for one in (smooth, shaped, both):
        least = _EVENER if best is None or one is both else 1.0
        if one is not None and (spread := _unevenness(rgb, around, one.ratio)) < least * left:
            best, left = one, spread
    if best is None:
        return None
    more = _with(best, estimated(rgb / best.ratio[..., None], known, footprint, zone)) if best is shaped else None
    if more is not None and _unevenness(rgb, around, more.ratio) < _EVENER * left:
        best = more
    return _levelled(rgb, known, around, best)


def _levelled(rgb: F64, known: Mask, around: Mask, shadow: Shadow) -> Shadow:
    """The shadow with its ratio corrected by what it leaves too bright or too dark, where that makes the surface more
    even; nothing becomes brighter than the surface is around the shadow. What differs by more than a residual may, on
    average, is another surface, and stays.

    Args:
        around: `[H, W]`, the shadow and what it is compared with.
    """
    inside = known & (shadow.ratio < _SEEN_MODEL)
    outside = around & ~inside
    if inside.sum() < _FEWEST or outside.sum() < _FEWEST:
        return shadow
    picture = rgb / shadow.ratio[..., None]
    clear = continued_far(picture, known & ~inside, inside)
    rest = _ratio(picture, clear, inside, _SMOOTH)
    other = float((np.log(rest[inside]) ** 2).mean()) > np.log(_CORRECTED) ** 2
    rest = np.clip(rest, 1 / _CORRECTED, _CORRECTED)
    ratio = np.where(inside, np.minimum(shadow.ratio * rest, 1.0), shadow.ratio)
    if other or _unevenness(rgb, around, ratio) >= _EVENER * _unevenness(rgb, around, shadow.ratio):
        ratio = shadow.ratio
    bright = _GLOW * max(float(np.quantile(rgb[outside].mean(axis=1), _BRIGHT)), 1e-3)
    ratio = np.where(inside, np.maximum(ratio, np.minimum(rgb.mean(axis=2) / bright, 1.0)), ratio)
    return Shadow(ratio, float(1 - ratio[inside].mean()))


def _with(first: Shadow, second: Shadow | None) -> Shadow | None:
    return None if second is None else Shadow(first.ratio * second.ratio, max(first.depth, second.depth))


def modelled(rgb: F64, known: Mask, shade: Blocked) -> Shadow | None:
    """The shadow that a thing of this shape casts, as dark and leaning as fits the surface best; None if that is not
    dark, or the surface's pattern hides it."""
    near, none = known & (shade.shares[0] > _DEEP), known & (shade.shares[0] <= _NONE)
    if min(int(near.sum()), int(none.sum())) < _FEWEST:
        return None
    table, values = _table(rgb, known), -_log(rgb[known])
    deep = depth_of(shade.shares)
    step = max(1, len(values) // _CELLS)
    weights, rest = _fitted(np.column_stack([deep[:, known].T, table])[::step], values[::step])
    dark = np.tensordot(weights, deep, 1)
    share = dark[near] > 0.5 * float(dark[near].max())
    if not dark[near].max() or dark[near][share].mean() < max(_FAINTEST, 0.5 * rest / np.sqrt(share.sum() / _APART)):
        return None
    ratio = np.where(known & (dark > -np.log(_SEEN_MODEL)), np.exp(-np.minimum(dark, _DARKEST_LOG)), 1.0)
    return Shadow(ratio, float(1 - ratio[near].mean()))


def _log(rgb: F64) -> F64:
    return np.asarray(np.log(np.maximum(rgb.mean(axis=-1), 0.02)))


def _table(rgb: F64, cells: Mask) -> F64:
    """`[M, 5]` what the logarithm of a surface's brightness may depend on besides shadow: where a cell is, its hue."""
    h, w = cells.shape
    y, x = np.nonzero(cells)
    tint = rgb[cells][:, ::2] / np.maximum(rgb[cells].mean(axis=1, keepdims=True), 0.02) - 1
    return np.column_stack([np.ones(len(x)), x / w - 0.5, y / h - 0.5, tint])


def _fitted(table: F64, values: F64) -> tuple[F64, float]:
    """The weights `[LOBES]` of the first columns of a robust fit, none below zero, and the spread of what is left."""
    from scipy.optimize import lsq_linear

    columns = table.shape[1]
    ridge = np.eye(LOBES, columns) * _RIDGE * np.sqrt(len(values))
    low = np.concatenate([np.zeros(LOBES), np.full(columns - LOBES, -np.inf)])
    weight, spread, best = np.ones(len(values)), 0.0, np.zeros(columns)
    for _ in range(_ROUNDS):
        root = np.sqrt(weight)
        rows = np.concatenate([table * root[:, None], ridge])
        best = lsq_linear(rows, np.concatenate([values * root, np.zeros(LOBES)]), (low, np.inf), method="bvls").x
        rest = values - table @ best
        spread = 1.48 * float(np.median(np.abs(rest))) + 1e-3
        weight = 1 / (1 + (rest / (2 * spread)) ** 2)
    return best[:LOBES], spread


def _unevenness(rgb: F64, cells: Mask, ratio: F64) -> float:
    """How much a surface varies after a shadow is divided out, besides its hue and a slope; logarithm of brightness."""
    values = _log(rgb[cells]) - np.log(ratio[cells])
    table = _table(rgb, cells)
    best, *_ = np.linalg.lstsq(table, values, rcond=None)
    return float(np.abs(values - table @ best).mean())


def estimated(rgb: F64, known: Mask, footprint: Mask, zone: Mask) -> Shadow | None:
    """The shadow that a thing cast on a surface; None if there is none, or nothing to tell it by.

    The surface without the shadow is continued into the zone from around it, with its texture.

    Args:
        rgb: `[H, W, 3]` of the surface, valid where known.
        known: `[H, W]`.
        footprint, zone: `[H, W]`, below the thing, and where its shadow may reach.
    """
    inside = known & zone
    outside = _alike(rgb, known & ~zone, inside)
    if outside.sum() < 0.5 * inside.sum() or inside.sum() < 20:
        return None
    away = scipy.ndimage.distance_transform_edt(~footprint)
    end = float(away[zone].max())
    clear = continued_far(rgb, outside, zone)
    ratio = _ratio(rgb, np.minimum(clear, _brightest(rgb, outside)), inside, _SMOOTH + min(_COARSE * end, _COARSEST))
    rim = inside & (away > 0.7 * end)
    base = float(np.median(ratio[rim])) if rim.any() else 1.0
    if abs(base - 1) > _OUTSIDE:
        return None  # what does not fade outward is another surface, or the light of the room
    ratio = np.where(inside, ratio / base, 1.0)
    close = inside & (away <= max(1.0, 0.25 * end))
    if not close.any() or not rim.any() or not _is_shadow(ratio, close, rim, inside):
        return None
    fade = np.clip((end - away) / max(0.3 * end, 1e-9), 0.0, 1.0)
    ratio = 1 - fade * (1 - np.clip(ratio, _DARKEST, 1.0))
    # Nothing becomes brighter than the surface is elsewhere: a bright board beside a dark picture keeps its colour.
    ratio = np.maximum(ratio, rgb.max(axis=2) / (_GLOW * max(float(_brightest(rgb, outside).max()), 1e-3)))
    ratio = np.where(inside & (ratio < _SEEN) & _grey(rgb, clear), ratio, 1.0)
    return Shadow(ratio, float(1 - ratio[close].mean()))


def _is_shadow(ratio: F64, close: Mask, rim: Mask, inside: Mask) -> bool:
    """Whether ratios are those of a contact shadow: darker and not brighter, fading outward, and by more than the
    surface's own pattern varies where the shadow ends. A meadow or a patterned rug has none that could be told."""
    dark = float(np.quantile(ratio[close], _PART))
    uneven = float(ratio[rim].std())
    brighter = float((ratio[inside] > 1 + _BRIGHTER).mean())
    fades = float(ratio[rim].mean() - ratio[close].mean())
    return dark <= min(_CLEAR, 1 - _BEYOND * uneven) and brighter <= _FEW and fades >= _FADES and uneven <= _UNEVEN


def _alike(rgb: F64, outside: Mask, inside: Mask) -> Mask:
    """Those of the cells outside a shadow that are of the surface inside it: of its hue, and not far brighter or darker
    than most."""
    if not outside.any() or not inside.any():
        return outside
    light = rgb.mean(axis=2)
    tint = rgb / np.maximum(light, 0.02)[..., None]
    middle, spread = np.median(light[outside]), 1.48 * np.median(np.abs(light[outside] - np.median(light[outside])))
    far = np.abs(light - middle) > max(3 * float(spread), 0.12)
    typical = np.median(tint[inside], axis=0)
    usual = 1.48 * float(np.median(np.abs(tint[inside] - typical).max(axis=1)))
    other = np.abs(tint - typical).max(axis=2) > max(4 * usual, 0.2)
    return np.asarray(outside & ~far & ~other)


def _grey(rgb: F64, clear: F64) -> Mask:
    """Where a picture has the hue that it would have without the shadow."""
    soft = [scipy.ndimage.gaussian_filter(p, (_SMOOTH, _SMOOTH, 0)) for p in (rgb, clear)]
    tints = [p / np.maximum(p.mean(axis=2, keepdims=True), 0.02) for p in soft]
    return np.asarray(np.abs(tints[0] - tints[1]).max(axis=2) < _TINT)


def _brightest(rgb: F64, outside: Mask) -> F64:
    """`[3]` the colour that a surface without shadow does not exceed."""
    return np.asarray(np.quantile(rgb[outside], 0.9, axis=0))


def _ratio(rgb: F64, clear: F64, inside: Mask, sigma: float) -> F64:
    """`[H, W]` local factor by which the picture is darker than it would be without the shadow; one outside."""
    weight = inside.astype(np.float64)

    def smooth(values: F64) -> F64:
        return np.asarray(scipy.ndimage.gaussian_filter(values * weight, sigma, mode="constant"))

    both, own = (rgb * clear).sum(axis=2), (clear * clear).sum(axis=2)
    return np.where(inside, smooth(both) / np.maximum(smooth(own), 1e-9), 1.0)


def rows_and_factors(cloud: GaussianCloud, rows: Tensor, chart: Chart, factor: F64) -> tuple[Tensor, Tensor]:
    """The rows of a surface whose colour changes, and by what it is multiplied, `[M]` each.

    Args:
        rows: the Gaussians of the surface.
        factor: `[H, W]` on the chart.
    """
    points = chart.plane.local(cloud.means[rows].to(torch.float64).cpu().numpy())[:, :2]
    at = (points - chart.low) / chart.cell - 0.5
    values = scipy.ndimage.map_coordinates(factor, at[:, ::-1].T, order=1, mode="nearest")
    changed = torch.from_numpy(np.abs(values - 1) > 1e-3)
    return rows[changed.to(rows.device)], torch.from_numpy(values.astype(np.float32))[changed].to(rows.device)


def multiplied(sh: Tensor, factor: Tensor) -> Tensor:
    """Harmonics `[M, K, 3]` of colours multiplied by `[M]`."""
    out = sh * factor[:, None, None]
    out[:, 0] = ((sh[:, 0] * SH_C0 + 0.5) * factor[:, None] - 0.5) / SH_C0
    return out
