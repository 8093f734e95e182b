"""Look at the place of a thing that is gone from where the scene was seen: which pixels show nothing any more."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import ndimage

from ....gaussians.camera import Camera
from ....gaussians.cloud import GaussianCloud, concat
from ....gaussians.harmonics import color_to_dc, to_color
from ....gaussians.render import render
from ..hidden import ring_of_directions
from ..planes import F64, Mask
from ..smooth import harmonic
from ..span import Span

MOST_VIEWS = 6
_WITNESSES, _SMALL = 16, 160  # photographs that tell what was seen, and pixels along their longer side
_UNHIDDEN, _PAST, _SEVERAL = 0.2, 1.02, 3  # share of the thing in a pixel, part of the depth shown there, photographs
_GLOSS = 6  # photographs over which colours are averaged
_FEW = 3  # photographs that look at the place, below which viewpoints around it are added
_SIDE = 72  # pixels along the longer side of the thing in a view
_MARGIN = 0.6  # of that side: what is seen around it
_NEAREST, _AWAY = 0.6, 2.4  # of the thing's extent: least distance of a view, and that of views that are added
_SHOWS = 0.3  # of the thing that nothing hides, so that an added view is one from where it can be seen
_COVERS = 0.05  # share of a pixel from which the thing covers it
CLEAR = 0.02  # share below which the pixel is not touched by it
_GONE = 0.5  # of the alpha around: a pixel with less shows nothing
VOID = 0.12  # alpha below which nothing is there: dark surfaces in captures on black reach no high alpha
SPECK = 5  # pixels of a hole
_FOOT = 0.05  # of the thing's extent: how high above its lowest point what it stands on may be
_BEFORE = 0.5  # of the thing's extent in depth: what is nearer than its front beside it by more hides a part of it
_BESIDE, _MEETS, _MET = 16, 3, 0.12  # pixels from the thing within which that is asked, within which it begins, and
# what share of it lies there at least


@dataclass(frozen=True, eq=False)
class View:
    """What a view shows of the place of a thing, without the thing.

    Attributes:
        camera: cut to the place.
        rgb: `[H, W, 3]` display space, over black.
        alpha, depth: `[H, W]`; depth along the view, scene units.
        group: `[H, W]` int32.
        covers: `[H, W]` share of each pixel that the thing filled.
        front: `[H, W]` depth of the thing, 0 where it is not.
        taken: whether a photograph was taken from here.
        dark: `[H, W]`, open pixels that are dark surfaces of the scene and no holes; None if that was not asked.
    """

    camera: Camera
    rgb: F64
    alpha: F64
    depth: F64
    group: NDArray[np.int32]
    covers: F64
    front: F64
    taken: bool
    dark: Mask | None = None

    def points(self, pixels: Mask) -> F64:
        """`[M, 3]` world points that some pixels show."""
        return np.asarray(self.camera.position + self.rays(pixels) * self.depth[pixels][:, None])

    def rays(self, pixels: Mask) -> F64:
        """`[M, 3]` world directions through the middles of some pixels, of length one along the view."""
        y, x = np.nonzero(pixels)
        c = self.camera
        local = np.stack([(x + 0.5 - c.cx) / c.fx, (y + 0.5 - c.cy) / c.fy, np.ones(len(x))], axis=1)
        return np.asarray(local @ c.world_to_camera[:3, :3])

    @cached_property
    def before(self) -> Mask:
        """`[H, W]` what hides a part of the thing: near it, and nearer than it is there."""
        there = self.front > 0
        if not there.any():
            return np.zeros(there.shape, bool)
        low, high = np.quantile(self.front[there], [0.05, 0.95])
        away, at = ndimage.distance_transform_edt(~there, return_indices=True)
        nearer = self.depth < self.front[tuple(at)] - _BEFORE * (high - low)
        nearer &= (away <= _BESIDE) & (self.covers < CLEAR) & (self.alpha > 0.5)
        # What the thing stands on is as far away as the thing is where they meet, and nearer only farther from it.
        area, count = ndimage.label(nearer)
        pixels = np.bincount(area.ravel(), minlength=count + 1)
        meets = np.bincount(area[away <= _MEETS], minlength=count + 1) >= _MET * pixels
        meets[0] = False
        return np.asarray(meets[area])

    @cached_property
    def solid(self) -> Mask:
        """`[H, W]` where something is; a dark gap between leaves is."""
        return np.asarray(ndimage.gaussian_filter(self.alpha, 1.5) > VOID)

    @cached_property
    def open_pixels(self) -> Mask:
        """`[H, W]` where the thing was and nothing is now, without specks."""
        hid = self.covers > _COVERS
        sure = (self.covers < CLEAR) & ~ndimage.binary_dilation(hid) & ~self.before
        if not hid.any() or not sure.any():
            return np.zeros(hid.shape, bool)
        around = harmonic(ndimage.median_filter(self.alpha, 3)[..., None], sure, ~sure)[..., 0]
        gone = hid & (self.alpha < _GONE * np.maximum(around, VOID))
        gone = ndimage.binary_closing(gone) & (self.covers > CLEAR)
        gone = gone if self.dark is None else gone & ~self.dark
        area, count = ndimage.label(gone)
        size = np.bincount(area.ravel(), minlength=count + 1)
        keep = size >= SPECK
        keep[0] = False
        return np.asarray(keep[area])


@dataclass(frozen=True, eq=False)
class Place:
    """The place of a thing that is gone.

    Attributes:
        views: of it, that from the middle of all first, then each as far as may be from the others.
        witnesses: views of the whole scene, with the thing, that tell what was seen, or the same views where there are
            no photographs.
        up: `[3]`, unit.
        bottom: height along it up to which the thing may have stood on something.
        span: how far the scene reaches.
    """

    views: tuple[View, ...]
    witnesses: tuple[View, ...]
    up: F64
    bottom: float
    span: Span

    def under(self, points: F64) -> Mask:
        """Which points `[M, 3]` are no higher than the bottom of the thing."""
        return np.asarray(points @ self.up <= self.bottom)


def place_of(
    cloud: GaussianCloud,
    thing: GaussianCloud,
    corners: tuple[F64, F64],
    cameras: Sequence[Camera],
    up: F64,
    span: Span,
    witnesses: Sequence[View] = (),
) -> Place:
    """Views of the place of a thing.

    Args:
        cloud: the scene without the thing.
        corners: of the thing, `[3]` each.
        cameras: of the photographs.
        span: how far the scene reaches.
        witnesses: see `witnesses_of`.
    """
    low, high = corners
    box = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    size = float((high - low).max())
    middle = (low + high) / 2
    there = [c for c in cameras if _looks_at(c, middle, size)]
    chosen = _apart([c for c in (_cut(c, box) for c in there) if c is not None], middle)
    both = labelled(cloud, thing)
    views = [_seen(cloud, thing, both, c, True) for c in chosen]
    if len(views) < _FEW:
        for camera in _around(middle, size, up):
            cut = _cut(camera, box)
            view = None if cut is None else _seen(cloud, thing, both, cut, False)
            if view is not None and view.covers.sum() > _SHOWS * float((view.front > 0).sum()):
                views.append(view)
    views = views[: 2 * MOST_VIEWS]
    if not any(v.open_pixels.any() for v in views):
        views = []
    bottom = float((box @ up).min()) + _FOOT * size
    return Place(tuple(views), tuple(witnesses) or tuple(views), up, bottom, span)


def witnesses_of(cloud: GaussianCloud, thing: GaussianCloud, cameras: Sequence[Camera]) -> list[View]:
    """What photographs from all around show of a scene with a thing, small; empty without photographs.

    Args:
        cloud: the scene without the thing.
    """
    both = labelled(cloud, thing)
    return [_witness(both, c) for c in _spread(cameras)]


def seen_past(points: F64, witnesses: Sequence[View]) -> Mask:
    """Which points `[M, 3]` several photographs saw: what is there is known, or that nothing is."""
    count = np.zeros(len(points), np.int64)
    for view in witnesses:
        at, away = view.camera.project(points)
        inside = view.camera.contains(at, away)
        x, y = (np.clip(np.floor(at[:, k]).astype(int), 0, view.alpha.shape[1 - k] - 1) for k in (0, 1))
        clear = (view.covers[y, x] < _UNHIDDEN) & (view.alpha[y, x] > 0.5)
        count += inside & clear & (away < _PAST * view.depth[y, x])
    return np.asarray(count >= _SEVERAL)


def without_gloss(cloud: GaussianCloud, cameras: Sequence[Camera]) -> GaussianCloud:
    """A cloud whose Gaussians have the colour from all sides that some photographs show of them on average."""
    if not cloud.degree or not len(cloud):
        return cloud
    chosen = _spread(cameras) if cameras else []
    if not chosen:
        return cloud.replace(sh=cloud.sh[:, :1])
    total = torch.zeros(len(cloud), 3, device=cloud.device)
    for camera in chosen[:_GLOSS]:
        eye = torch.from_numpy(camera.position.astype(np.float32)).to(cloud.device)
        total += to_color(cloud.sh, torch.nn.functional.normalize(cloud.means - eye, dim=1)).clamp(0, 1)
    return cloud.replace(sh=color_to_dc(total / len(chosen[:_GLOSS]))[:, None])


def _spread(cameras: Sequence[Camera]) -> list[Camera]:
    """At most `_WITNESSES` of some cameras, as far apart as may be."""
    if not cameras:
        return []
    eyes = np.array([c.position for c in cameras])
    chosen = [0]
    while len(chosen) < min(_WITNESSES, len(cameras)):
        away = np.linalg.norm(eyes[:, None] - eyes[chosen][None], axis=2).min(axis=1)
        chosen.append(int(away.argmax()))
    return [cameras[k] for k in chosen]


def _witness(both: GaussianCloud, camera: Camera) -> View:
    """What a photograph of the scene with the thing shows, small."""
    scale = _SMALL / max(camera.width, camera.height)
    small = camera.resized(max(8, round(camera.width * scale)), max(8, round(camera.height * scale)))
    shot = render(both, small)
    covers, alpha, depth = (x.cpu().numpy().astype(np.float64) for x in (shot.rgb[..., 0], shot.alpha, shot.depth))
    return View(small, shot.rgb.cpu().numpy(), alpha, depth, shot.group.cpu().numpy(), covers, 0 * depth, True)


def seen_again(view: View, cloud: GaussianCloud) -> View:
    """The same view of a scene to which something was added."""
    shot = render(cloud, view.camera)
    rgb, alpha, depth = (x.cpu().numpy().astype(np.float64) for x in (shot.rgb.clamp(0, 1), shot.alpha, shot.depth))
    return replace(view, rgb=rgb, alpha=alpha, depth=depth, group=shot.group.cpu().numpy())


def _seen(cloud: GaussianCloud, thing: GaussianCloud, both: GaussianCloud, camera: Camera, taken: bool) -> View:
    alone, share = render(thing, camera), render(both, camera)
    front = np.where(alone.alpha.cpu().numpy() > 0.5, alone.depth.cpu().numpy(), 0.0).astype(np.float64)
    covers = share.rgb[..., 0].clamp(0, 1).cpu().numpy().astype(np.float64)
    none = np.zeros(covers.shape)
    return seen_again(View(camera, none[..., None], none, none, none.astype(np.int32), covers, front, taken), cloud)


def labelled(cloud: GaussianCloud, thing: GaussianCloud) -> GaussianCloud:
    """The scene with the thing, it in red and all else black."""

    def plain(part: GaussianCloud, color: tuple[float, float, float]) -> GaussianCloud:
        dc = color_to_dc(torch.tensor(color, device=part.device)).expand(len(part), 3)
        return part.replace(sh=dc[:, None].contiguous())

    first = int(cloud.ids.max()) + 1 if len(cloud) else 0
    numbered = thing.replace(ids=torch.arange(first, first + len(thing), device=thing.device))
    return concat([plain(cloud, (0.0, 0.0, 0.0)), plain(numbered, (1.0, 0.0, 0.0))])


def _looks_at(camera: Camera, middle: F64, size: float) -> bool:
    away = float(np.linalg.norm(camera.position - middle))
    return bool(camera.contains(*camera.project(middle[None]))[0]) and away > _NEAREST * size


def _cut(camera: Camera, box: F64) -> Camera | None:
    """A camera cut to some points `[8, 3]` and what is around them, at the size of views; None if some are behind."""
    at, depth = camera.project(box)
    if depth.min() <= 1e-6:
        return None
    low, high = at.min(axis=0), at.max(axis=0)
    side = float((high - low).max())
    if side < 4:
        return None
    pad = _MARGIN * side
    low, high = low - pad, high + pad
    scale = min(_SIDE / side, 1.0) if side > _SIDE else min(2.0, _SIDE / side)
    w, h = (max(16, round(float(s) * scale)) for s in high - low)
    return Camera(
        camera.world_to_camera, camera.fx * scale, camera.fy * scale, (camera.cx - low[0]) * scale,
        (camera.cy - low[1]) * scale, w, h, camera.name,
    )  # fmt: skip


def _apart(cameras: Sequence[Camera], middle: F64) -> list[Camera]:
    """At most `MOST_VIEWS` of some cameras, that nearest to their mean direction first, then the farthest from all."""
    if not cameras:
        return []
    ways = np.array([c.position - middle for c in cameras])
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    chosen = [int((ways @ ways.mean(axis=0)).argmax())]
    while len(chosen) < min(MOST_VIEWS, len(cameras)):
        near = (ways @ ways[chosen].T).max(axis=1)
        near[chosen] = np.inf
        chosen.append(int(near.argmin()))
    return [cameras[k] for k in chosen]


def _around(middle: F64, size: float, up: F64) -> list[Camera]:
    """Viewpoints around a place."""
    return [
        Camera.look_at(middle + _AWAY * size * way, middle, up, 240, 240, 45.0, f"around {k}")
        for k, way in enumerate(ring_of_directions(up)[::3])
    ]
