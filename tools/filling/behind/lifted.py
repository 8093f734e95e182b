"""Complete what views show of a place that a thing hid, and lift the pixels to Gaussians.

    views -> open pixels -> colours by patches of the same view -> depths from what surrounds them -> Gaussians

This serves where no plane explains what lies behind: hedges, clutter, curved or noisily fitted ground. Each view fills
only what those before it left open, so that all of them show the same.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch
from scipy import ndimage, sparse
from scipy.sparse.linalg import spsolve

from ....gaussians.cloud import GaussianCloud, concat
from ....gaussians.harmonics import color_to_dc
from ....gaussians.rotations import from_matrix
from ..new_rows import FLAT, OPACITY
from ..planes import F64, Mask
from .patchwork import patched
from .views import CLEAR, SPECK, VOID, Place, View, seen_again

_SUPPORT, _GUESSED = (
    0.5,
    0.8,
)  # of the pixels around a hole that must show something behind the thing: in a photograph's
# view, and in one that nobody is known to have had
_BAND = 6  # pixels around a hole whose depth is continued into it
_TOLD = 0.5  # weight of the depth of such a pixel against that of its neighbours
_EDGE = 0.06  # difference of colours over which a surface may end, display space
_THROUGH = 1e-3  # least weight between neighbouring pixels
_STRETCHED = 2.5  # times the size of a pixel at its depth: how far a Gaussian reaches at most on slanted ground
_SEEN_PAST = 0.97  # of the depth that another view shows: what is nearer, or hardly farther, was seen by it
_COVER = 0.75  # standard deviation of a Gaussian over the side of a pixel at its depth: no gaps seen from aside
_SHOWN = 0.5  # alpha from which a view without the thing shows a surface
_TRIED = 20  # depths along a ray
_TURNS = 4  # of all views, at most: what one view fills may surround the hole of another that was refused before
_FARTHER = 1.3  # times the largest depth around a hole: that of the last
_UNCOVERED = 0.2  # of a pixel that the thing filled, below which what is behind it was seen
_OUTSIDE = 3.0  # times the thing's distance: what surrounds a hole and is farther away is the outside of a window
_TOLD_OF = 0.02  # of the pixels that the thing filled: a hole that stays open is told from this on
_ENDS = 0.3  # of what surrounds a hole that has to be nothing, so that a scene ends there
_GLASS = 0.5  # of what surrounds a hole, from which it is in a mirror or a window
GLASS = "a mirror or a window lies behind it, and what that shows there nobody saw"
NOTHING_BEHIND = "nothing is seen behind it that could be continued"
OUTSIDE = "what lies behind it is far away, as through a window"


@dataclass(frozen=True, eq=False)
class Hole:
    """A hole of a view that was filled, or could not be.

    Attributes:
        view: index of the view.
        pixels: `[H, W]`.
        cloud: the new Gaussians, empty if none were made.
        support: share of what surrounds it that shows something behind the thing.
        spread: standard deviation of the colours around it, display space.
        area: square scene units.
        corners: of the place, `[2, 3]`.
        reason: why nothing was made, "" if something was.
    """

    view: int
    pixels: Mask
    cloud: GaussianCloud
    support: float
    spread: float
    area: float
    corners: F64
    reason: str = ""


class _Told(NamedTuple):
    """The coefficients of a colour, and the groups of mirrors and windows."""

    bands: int
    glass: frozenset[int]


def holes_filled(cloud: GaussianCloud, place: Place, glass: frozenset[int] = frozenset()) -> list[Hole]:
    """The holes that views of a place show, each filled or with the reason why it stays; those that stay once.

    Args:
        cloud: the scene without the thing; what was filled by planes is part of it.
        glass: groups that show something else than themselves: mirrors and windows.
    """
    now, found, left = cloud, list[Hole](), dict[str, Hole]()
    told, started = _Told(cloud.sh.shape[1], glass), dict[int, GaussianCloud]()
    for k in itertools.chain.from_iterable([range(len(place.views))] * _TURNS):
        if started.get(k) is now:  # nothing was made since this view was looked at
            break
        view = place.views[k] if now is cloud else seen_again(place.views[k], now)
        started[k] = now
        open_ = view.open_pixels
        if not open_.any():
            continue
        made = _filled(view, k, open_, place, told)
        found += [h for h in made if not h.reason]
        for hole in (h for h in made if h.reason):  # every view tells of the same place
            left[hole.reason] = max(left.get(hole.reason, hole), hole, key=lambda h: h.area)
        new = [h.cloud for h in made if len(h.cloud)]
        if new:
            now = _joined(now, new)
    return [*found, *left.values()]


def _joined(cloud: GaussianCloud, new: Sequence[GaussianCloud]) -> GaussianCloud:
    first = int(cloud.ids.max()) + 1
    numbered = []
    for part in new:
        numbered.append(part.replace(ids=torch.arange(first, first + len(part), device=part.device)))
        first += len(part)
    return concat([cloud, *numbered])


def _filled(view: View, index: int, open_: Mask, place: Place, told: _Told) -> list[Hole]:
    """The holes of one view."""
    bands, glass = told
    behind = ~open_ & ~view.before & ((view.covers < 0.02) | (view.alpha > 0.5))
    known = behind & view.solid & ~ndimage.binary_dilation(open_, np.ones((3, 3)))
    area, count = ndimage.label(open_, np.ones((3, 3)))
    holes, refused = list[Mask](), list[Hole]()
    for k in range(1, count + 1):
        hole = np.asarray(area == k)
        hole |= ndimage.binary_dilation(hole, np.ones((3, 3))) & (view.covers > 0.0) & ~view.before & (area == 0)
        # Between a hole and what was clear of the thing there may be pixels of both.
        wide = ndimage.binary_propagation(hole, mask=hole | (~open_ & ~known & ~view.before & (view.covers > 0.0)))
        ring = ndimage.binary_dilation(wide, iterations=4) & ~ndimage.binary_dilation(wide, iterations=2) & ~open_
        ring &= ~view.before
        support = float((ring & known).sum()) / max(int(ring.sum()), 1)
        reason = _refusal(view, ring & known, support, glass)
        if reason:
            if _is_void(view, ring, place):
                continue
            if hole.sum() >= _TOLD_OF * (view.covers > 0.5).sum():
                refused.append(_hole(view, index, hole, bands, (support, reason)))
        else:
            holes.append(hole)
    if not holes:
        return refused
    every = np.asarray(np.logical_or.reduce(holes))
    soft = ndimage.binary_dilation(every, np.ones((3, 3))) & (view.covers > 0.0) & ~view.before
    rest = ~known & ~soft
    picture = np.where(rest[..., None], 0.0, view.rgb)
    colours = patched(picture, known & ~soft, soft | (open_ & ~every))
    depth = _depths(view, colours, every, known)
    depth = np.maximum(depth, np.where(view.front > 0, view.front, 0.0))
    depth, unseen = _unseen(view, every, depth, place)
    found = [
        _lifted(view, index, h & unseen, colours, depth, known, bands) for h in holes if (h & unseen).sum() >= SPECK
    ]
    return refused + found


def _refusal(view: View, ring: Mask, support: float, glass: frozenset[int]) -> str:
    """Why a hole must not be filled; "" if it may."""
    if support < (_SUPPORT if view.taken else _GUESSED) or not ring.any():
        return NOTHING_BEHIND
    if glass and np.isin(view.group[ring], list(glass)).mean() > _GLASS:
        return GLASS
    front = view.front[view.front > 0]
    if len(front) and np.median(view.depth[ring]) > _OUTSIDE * np.median(front):
        return OUTSIDE
    return ""


def _is_void(view: View, ring: Mask, place: Place) -> bool:
    """Whether the thing stood before the end of the scene: much of what is around the hole is nothing.

    Where no photograph shows the place, it may be unknown as well, and that is told.
    """
    nothing = (view.alpha < VOID) & (view.covers < CLEAR)
    most = _ENDS if view.taken else _ENDS / 2
    return any(v.taken for v in place.views) and bool(ring.any() and (ring & nothing).sum() > most * ring.sum())


def _depths(view: View, colours: F64, hole: Mask, known: Mask) -> F64:
    """`[H, W]` depth with that of a hole continued from around it.

    Its inverse, which is linear on planes, is as even as it may be, except where colours change.
    """
    band = ndimage.binary_dilation(hole, iterations=_BAND) & known
    cells = hole | band
    number = np.full(hole.shape, -1, np.int64)
    count = int(cells.sum())
    number[cells] = np.arange(count)
    inverse = np.where(view.depth > 0, 1 / np.maximum(view.depth, 1e-9), 0.0)
    soft = ndimage.gaussian_filter(colours, (1.0, 1.0, 0))
    told = np.where(band, _TOLD * view.alpha, 0.0)[cells]
    rows, columns, weights = [np.arange(count)], [np.arange(count)], [told]
    for axis in (0, 1):
        a, b = (np.s_[:-1], np.s_[1:]) if axis == 0 else (np.s_[:, :-1], np.s_[:, 1:])
        mine, theirs = number[a], number[b]
        both = (mine >= 0) & (theirs >= 0)
        apart = ((soft[a] - soft[b]) ** 2).sum(axis=2)
        weight = (np.exp(-apart / (2 * _EDGE**2)) + _THROUGH)[both]
        i, j = mine[both], theirs[both]
        rows += [i, j, i, j]
        columns += [i, j, j, i]
        weights += [weight, weight, -weight, -weight]
    where = np.concatenate(rows), np.concatenate(columns)
    table = sparse.csc_matrix((np.concatenate(weights), where), (count, count)) + 1e-9 * sparse.identity(count)
    middle = float(np.median(inverse[band])) if band.any() else 0.0
    right = told * inverse[cells] + 1e-9 * middle
    out = inverse.copy()
    out[cells] = np.where(hole[cells], spsolve(table.tocsc(), right), inverse[cells])
    return np.where(out > 1e-9, 1 / np.maximum(out, 1e-9), 0.0)


def _unseen(view: View, hole: Mask, depth: F64, place: Place) -> tuple[F64, Mask]:
    """`[H, W]` depths of a hole moved backward along its rays until no other view saw the point there, and it hides
    nothing that another view shows; and which pixels have such a depth. What another view saw is there already, or is
    known to be empty, and what is known behind the thing from one side is not hidden by a guess from another, but for
    what the thing stood on.
    """
    rays, eye = view.rays(hole), view.camera.position
    start = depth[hole]
    far = max(float(np.quantile(start, 0.98)) * _FARTHER, 1e-9)
    others = [w for w in place.witnesses if w.camera is not view.camera]
    beside = [v for v in place.views if v.camera is not view.camera]
    best, left = start.copy(), np.arange(len(start))
    for step in range(_TRIED):
        tried = start[left] * (np.maximum(far / start[left], 1.0)) ** (step / (_TRIED - 1))
        points = eye + rays[left] * tried[:, None]
        bad = _was_seen(points, others) | (_hides(points, beside) & ~place.under(points)) | place.span.outside(points)
        best[left[~bad]] = tried[~bad]
        left = left[bad]
        if not len(left):
            break
    out, kept = depth.copy(), hole.copy()
    out[hole] = best
    unseen = np.ones(len(start), bool)
    unseen[left] = False
    kept[hole] = unseen
    return out, kept


def _was_seen(points: F64, views: Sequence[View]) -> Mask:
    """Which points views saw: nothing of the thing is before them, nor anything else."""
    seen = np.zeros(len(points), bool)
    for view in views:
        at, away = view.camera.project(points)
        inside = view.camera.contains(at, away)
        x, y = (np.clip(np.floor(at[:, k]).astype(int), 0, view.alpha.shape[1 - k] - 1) for k in (0, 1))
        clear = (view.covers[y, x] < _UNCOVERED) & (view.alpha[y, x] > VOID)
        slack = 2 - _SEEN_PAST if view.taken else _SEEN_PAST  # what nobody is known to have seen may have to be made
        seen |= inside & clear & (away < slack * view.depth[y, x])
    return seen


def _hides(points: F64, views: Sequence[View]) -> Mask:
    """Which points stand before what views show without the thing."""
    before = np.zeros(len(points), bool)
    for view in views:
        at, away = view.camera.project(points)
        inside = view.camera.contains(at, away)
        x, y = (np.clip(np.floor(at[:, k]).astype(int), 0, view.alpha.shape[1 - k] - 1) for k in (0, 1))
        before |= inside & (view.alpha[y, x] > _SHOWN) & (away < _SEEN_PAST * view.depth[y, x])
    return before


def _lifted(view: View, index: int, hole: Mask, colours: F64, depth: F64, known: Mask, bands: int) -> Hole:
    """A Gaussian for each pixel of a hole."""
    height, width = hole.shape
    grown = np.where(hole, depth, np.where(view.depth > 0, view.depth, np.inf))
    every = view.rays(np.ones_like(hole)).reshape(height, width, 3)
    unit = depth / view.camera.fx
    steps = []
    for axis in (0, 1):
        change = np.zeros_like(depth)
        for sign in (1, -1):  # the gentler of both sides: edges of a surface are not stretched
            other = np.roll(grown, -sign, axis)
            one = np.where(np.isfinite(other), sign * (other - depth), 0.0)
            change = one if sign == 1 else np.where(np.abs(one) < np.abs(change), one, change)
        change = np.clip(change, -_STRETCHED * unit, _STRETCHED * unit)
        along = view.camera.world_to_camera[1 - axis, :3] * unit[..., None]
        steps.append((along + every * change[..., None])[hole])
    points = view.camera.position + every[hole] * depth[hole][:, None]
    groups = view.group[tuple(ndimage.distance_transform_edt(~known, return_distances=False, return_indices=True))]
    cloud = _discs(points, np.stack(steps, axis=1), np.clip(colours[hole], 0.0, 1.0), groups[hole], bands)
    ring = ndimage.binary_dilation(hole, iterations=_BAND) & known
    spread = float(view.rgb[ring].std(axis=0).mean()) if ring.any() else 0.0
    area = float((unit[hole] ** 2).sum())
    corners = np.stack([points.min(axis=0), points.max(axis=0)])
    return Hole(index, hole, cloud, 1.0, spread, area, corners)


def _discs(points: F64, steps: F64, rgb: F64, groups: np.ndarray, bands: int) -> GaussianCloud:
    """Flat Gaussians at points `[M, 3]` that span the steps to their neighbours `[M, 2, 3]`."""
    count = len(points)
    cover = _COVER**2 * np.einsum("mki,mkj->mij", steps, steps)
    values, axes = np.linalg.eigh(cover)
    values, axes = values[:, ::-1], axes[:, :, ::-1]  # the longest first
    axes = axes * np.where(np.linalg.det(axes) < 0, -1.0, 1.0)[:, None, None]
    longest = np.sqrt(np.maximum(values[:, 0], 1e-18)).astype(np.float32)
    scales = np.stack([longest, np.sqrt(np.maximum(values[:, 1], 1e-18)), FLAT * longest], axis=1)
    scales[:, 1] = np.maximum(scales[:, 1], scales[:, 2])
    sh = torch.zeros(count, bands, 3)
    sh[:, 0] = color_to_dc(torch.from_numpy(rgb.astype(np.float32)))
    return GaussianCloud.create(
        torch.from_numpy(points.astype(np.float32)), from_matrix(torch.from_numpy(axes.astype(np.float32))),
        torch.from_numpy(scales.astype(np.float32)), torch.full((count,), OPACITY), sh,
        torch.from_numpy(groups.astype(np.int32)),
    )  # fmt: skip


def _hole(view: View, index: int, hole: Mask, bands: int, told: tuple[float, str]) -> Hole:
    """A hole that stays."""
    front = view.front[hole & (view.front > 0)]
    away = float(np.median(front)) if len(front) else 0.0
    points = view.camera.position + view.rays(hole) * away
    empty = GaussianCloud.empty(int(np.sqrt(bands)) - 1)
    area = float(hole.sum()) * (away / view.camera.fx) ** 2
    return Hole(index, hole, empty, told[0], 0.0, area, np.stack([points.min(axis=0), points.max(axis=0)]), told[1])
