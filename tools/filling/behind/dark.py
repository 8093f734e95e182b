"""Which open pixels are dark surfaces of the scene and no holes: photographs that look past the thing show them open.

A scene that is fitted to photographs on black shows a black surface, as a switched-off screen, with low alpha.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy import ndimage

from ....gaussians.camera import Camera
from ....gaussians.cloud import GaussianCloud
from ....gaussians.render import render
from ..planes import F64, Mask
from .views import VOID, Place, View, labelled

_ASKED = 3  # photographs beside that of a view, those nearest to it
_POINTS, _BODY = 60, 400  # points of a surface, and of the thing, that tell which photographs look past the thing
_CELLS = 80  # of a picture's longer side, in which that is told
_PAST = 0.5  # of the points that a photograph must see past the thing
_PAD, _SIDE = 6, 64  # pixels around a surface in such a picture, and along its longer side at most
_CLEAR = 0.1  # share of the thing in a pixel below which it is seen past
_DARK = 0.5  # alpha below which a pixel is as open as a hole
_SAME = 0.25  # of its depth: how far apart it may be found from two places, as it is mixed with what is behind it
_FARTHER = 1.15  # times the depth around: what is farther away is seen through the hole of a nearer surface
_MOST = 0.7  # of the pixels of an area that photographs see past the thing, which must be dark there
_FEWEST = 4  # such pixels


def without_dark(place: Place, cloud: GaussianCloud, thing: GaussianCloud, cameras: Sequence[Camera]) -> Place:
    """A place whose views count no dark surface as open; without any view if none shows a hole.

    Args:
        cloud: the scene without the thing.
        cameras: of the photographs.
    """
    if not cameras or not place.views:
        return place
    both = labelled(cloud, thing)
    body: F64 = thing.means[:: max(1, len(thing) // _BODY)].double().cpu().numpy()
    views = [_told(v, _dark(v, both, body, cameras)) for v in place.views]
    return replace(place, views=tuple(views) if any(v.open_pixels.any() for v in views) else ())


def _told(view: View, dark: Mask) -> View:
    return replace(view, dark=dark) if dark.any() else view


def _dark(view: View, both: GaussianCloud, body: F64, cameras: Sequence[Camera]) -> Mask:
    """`[H, W]`, the areas of open pixels of a view that are dark surfaces."""
    open_ = view.open_pixels
    area, count = ndimage.label(open_, np.ones((3, 3)))
    out = np.zeros_like(open_)
    for k in range(1, count + 1):
        part = np.asarray(area == k)
        ring = ndimage.binary_dilation(part, iterations=4) & ~open_ & view.solid
        if np.median(view.alpha[part]) <= VOID or not ring.any():
            continue  # nothing of a surface is seen there
        shown = part & (view.alpha > VOID) & (view.depth < _FARTHER * np.quantile(view.depth[ring], 0.9))
        if 2 * shown.sum() > part.sum() and _found_dark(view.points(shown), view.camera, both, body, cameras):
            out |= part
    return out


def _found_dark(points: F64, own: Camera, both: GaussianCloud, body: F64, cameras: Sequence[Camera]) -> bool:
    """Whether photographs that see points `[M, 3]` past the thing show them as open as a hole."""
    some = points[:: max(1, len(points) // _POINTS)]
    others = [c for c in cameras if not np.array_equal(c.position, own.position)]
    others.sort(key=lambda c: float(np.linalg.norm(c.position - own.position)))
    past = (c for c in others if _past(c, some, body))
    seen, dark = 0, 0
    for camera in itertools.islice(past, _ASKED):
        part = _cut(camera, points)
        shot = render(both, part)
        covers, alpha, depth = (x.cpu().numpy() for x in (shot.rgb[..., 0], shot.alpha, shot.depth))
        at, away = part.project(points)
        x, y = (np.clip(np.floor(at[:, k]).astype(int), 0, alpha.shape[1 - k] - 1) for k in (0, 1))
        clear = part.contains(at, away) & (covers[y, x] < _CLEAR) & (np.abs(depth[y, x] - away) < _SAME * away)
        seen += int(clear.sum())
        dark += int((clear & (alpha[y, x] < _DARK)).sum())
        if seen >= _FEWEST and dark < _MOST * seen:
            return False
    return seen >= _FEWEST


def _past(camera: Camera, points: F64, body: F64) -> bool:
    """Whether a camera sees most of some points and nothing of a body before them."""
    at, away = camera.project(points)
    inside = camera.contains(at, away)
    if inside.mean() < _PAST:
        return False
    side = max(camera.width, camera.height) / _CELLS
    taken = np.zeros((_CELLS + 2, _CELLS + 2), bool)
    seen, depth = camera.project(body)
    seen = seen[camera.contains(seen, depth)]
    taken[tuple((seen[:, ::-1] / side).astype(int).T)] = True
    taken = ndimage.binary_dilation(taken)
    return bool((~taken[tuple((at[inside][:, ::-1] / side).astype(int).T)]).sum() >= _PAST * len(points))


def _cut(camera: Camera, points: F64) -> Camera:
    """A camera cut to points, small."""
    at, depth = camera.project(points)
    at = at[camera.contains(at, depth)]
    low, high = at.min(axis=0), at.max(axis=0)
    scale = min(1.0, _SIDE / max(float((high - low).max()), 1.0))
    low, high = low - _PAD / scale, high + _PAD / scale
    w, h = (max(16, round(float(s) * scale)) for s in high - low)
    return replace(
        camera, fx=camera.fx * scale, fy=camera.fy * scale, cx=(camera.cx - low[0]) * scale,
        cy=(camera.cy - low[1]) * scale, width=w, height=h,
    )  # fmt: skip
