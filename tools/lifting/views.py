"""Views of what an edit revealed and nothing is known of: where the thing was, with its surroundings as context."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import ndimage
from torch import Tensor

from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud
from ...gaussians.render import render
from ...gaussians.rows import mask_of_ids
from ...gaussians.scene import Scene
from ...gaussians.world.core import core_of
from .target import Box, Mask, part_of, shares

VIEWS = 6
SIDE = 512  # px, longer side of a view
_PROBE = 160  # px, longer side of the pictures by which views are chosen
_MOST = 48  # cameras that are tried
_CONTEXT = 1.0  # of the hole's size: how much is shown on each side of it
_HID = 0.3  # blending weight of the thing from which it hid what is behind
_KNOWN = 0.7  # alpha without it from which what is behind is known
_FILLED = 0.3  # blending weight of a fill from which a pixel is part of the hole
_FEWEST = 60  # pixels of a hole, at `SIDE`
_WORTH = 0.3  # of the largest hole: a view that shows less of it is left out
_ELEVATIONS = (25.0, 50.0)  # degrees, of views of a scene without cameras
_AROUND = 8
_AWAY = 2.5  # times the thing's extent


@dataclass(frozen=True, eq=False)
class Revealed:
    """A place from which something was taken.

    Attributes:
        before: the Gaussians before.
        thing: `[N]` bool, those of `before` that left their place.
        rest: all others as they are now, without a fill.
        filled: the same with the fill.
        new: `[M]` bool, the fill's among `filled`.
    """

    before: GaussianCloud
    thing: Tensor
    rest: GaussianCloud
    filled: GaussianCloud
    new: Tensor

    @classmethod
    def of(cls, before: Scene, after: Scene, new: Tensor) -> Revealed:
        """What an edit revealed; `new` are the ids of its fill."""
        old, now = before.cloud, after.cloud
        thing = ~mask_of_ids(old.ids, now.ids)
        kept = (~thing).nonzero().squeeze(1)
        there = mask_of_ids(now.ids, old.ids).nonzero().squeeze(1)
        if bool((old.ids[kept] == now.ids[there]).all()):
            thing[kept[(old.means[kept] != now.means[there]).any(dim=1)]] = True
        own = mask_of_ids(now.ids, new)
        return cls(old, thing, now[~own], now, own)

    def hole(self, camera: Camera) -> Mask:
        """`[H, W]`: pixels where the thing hid what nothing else shows."""
        was = shares(self.before, (self.thing,), camera)[..., 0]
        hole = (was > _HID) & (render(self.rest, camera).alpha.cpu().numpy() < _KNOWN)
        if bool(self.new.any()):
            hole |= shares(self.filled, (self.new,), camera)[..., 0] > _FILLED
        return np.asarray(ndimage.binary_opening(ndimage.binary_closing(np.pad(hole, 2)))[2:-2, 2:-2])


@dataclass(frozen=True, eq=False)
class View:
    """A part of a picture around a hole `[H, W]`."""

    camera: Camera
    hole: Mask


def views_of(revealed: Revealed, cameras: Sequence[Camera], up: NDArray[np.float64]) -> list[View]:
    """At most `VIEWS` views that show most of the hole from different sides, the best first.

    Args:
        cameras: of the scene; views around the thing are made where there are none.
        up: of the scene.
    """
    rows = revealed.thing.nonzero().squeeze(1)
    if len(rows) < 4:
        return []
    solid = rows[torch.from_numpy(core_of(revealed.before, rows).solid).to(rows.device)]
    points = revealed.before.means[solid if len(solid) >= 4 else rows]
    pool = _showing(cameras, points) or around(points.to(torch.float64).cpu().numpy(), up)
    probed = [camera.resized(*_size(camera, _PROBE)) for camera in pool]
    count = np.array([revealed.hole(camera).sum() for camera in probed], np.float64)
    found = list[View]()
    for k in _chosen(pool, count, points.mean(dim=0).to(torch.float64).cpu().numpy()):
        if (view := _view(revealed.hole, pool[k])) is not None:
            found.append(view)
    return found


def views_showing(cloud: GaussianCloud, own: Tensor, cameras: Sequence[Camera], up: NDArray[np.float64]) -> list[View]:
    """At most `VIEWS` views that show some Gaussians from different sides, each cut to them; `hole` is where they show.

    Args:
        own: `[N]` bool.
    """
    rows = own.nonzero().squeeze(1)
    if len(rows) < 4:
        return []
    points = cloud.means[rows]
    pool = _showing(cameras, points) or around(points.to(torch.float64).cpu().numpy(), up)

    def shown(camera: Camera) -> Mask:
        return np.asarray(shares(cloud, (own,), camera)[..., 0] > _FILLED)

    count = np.array([shown(camera.resized(*_size(camera, _PROBE))).sum() for camera in pool], np.float64)
    found = list[View]()
    for k in _chosen(pool, count, points.mean(dim=0).to(torch.float64).cpu().numpy()):
        if (view := _view(shown, pool[k])) is not None:
            found.append(view)
    return found


def _showing(cameras: Sequence[Camera], points: Tensor) -> list[Camera]:
    """The cameras that show the most of some points, at most `_MOST`, evenly chosen."""
    sample = points[:: max(1, len(points) // 500)].to(torch.float64).cpu().numpy()
    inside = [c for c in cameras if c.contains(*c.project(sample)).mean() > 0.6]
    return [inside[i] for i in np.unique(np.linspace(0, len(inside) - 1, min(_MOST, len(inside))).round().astype(int))]


def around(points: NDArray[np.float64], up: NDArray[np.float64]) -> list[Camera]:
    """Cameras around some points `[M, 3]`, looking at their middle."""
    low, high = np.quantile(points, [0.02, 0.98], axis=0)
    middle, away = (low + high) / 2, _AWAY * float(np.linalg.norm(high - low)) + 1e-6
    side = np.cross(up, np.eye(3)[int(np.abs(up).argmin())])
    side /= np.linalg.norm(side)
    other, found = np.cross(up, side), list[Camera]()
    for k, elevation in enumerate(np.radians(_ELEVATIONS)):
        for turn in 2 * np.pi * (np.arange(_AROUND) + 0.5 * k) / _AROUND:
            level = np.cos(turn) * side + np.sin(turn) * other
            eye = middle + away * (np.cos(elevation) * level + np.sin(elevation) * up)
            found.append(Camera.look_at(eye, middle, up, SIDE, SIDE * 3 // 4, 50.0, f"around_{len(found):02d}"))
    return found


def _chosen(cameras: Sequence[Camera], count: NDArray[np.float64], middle: NDArray[np.float64]) -> list[int]:
    """The camera with the largest hole, then those that look from directions farthest from the ones chosen."""
    if not len(count) or count.max() <= 0:
        return []
    ways = np.stack([c.position - middle for c in cameras])
    ways /= np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 1e-12)
    usable = count >= _WORTH * count.max()
    chosen = [int(count.argmax())]
    while len(chosen) < VIEWS:
        apart = np.where(usable, 1 - (ways @ ways[chosen].T).max(axis=1), -1.0)
        apart[chosen] = -1.0
        if (best := int(apart.argmax())) in chosen or apart[best] < 0:
            break
        chosen.append(best)
    return chosen


def _view(shown: Callable[[Camera], Mask], camera: Camera) -> View | None:
    """The part of a picture around its hole, at most `SIDE` pixels a side; None if the hole is too small."""
    small = camera.resized(*_size(camera, SIDE))
    hole = shown(small)
    if hole.sum() < _FEWEST:
        return None
    scale = camera.width / small.width
    box = _box(hole, small)
    gain = min(scale, SIDE / max(box[2] - box[0], box[3] - box[1]))
    if gain > 1.05:  # a small hole: closer, as far as the camera's own pixels go
        closer = camera.resized(round(small.width * gain), round(small.height * gain))
        cut = part_of(closer, tuple(round(gain * side) for side in box))  # type: ignore[arg-type]
    else:
        cut = part_of(small, box)
    return View(cut, shown(cut))


def _box(hole: Mask, camera: Camera) -> Box:
    """The part around a hole with its context."""
    rows, columns = np.flatnonzero(hole.any(axis=1)), np.flatnonzero(hole.any(axis=0))
    pad = int(_CONTEXT * max(len(rows), len(columns))) + 8
    return (
        max(0, int(columns[0]) - pad), max(0, int(rows[0]) - pad),
        min(camera.width, int(columns[-1]) + 1 + pad), min(camera.height, int(rows[-1]) + 1 + pad),
    )  # fmt: skip


def _size(camera: Camera, side: int) -> tuple[int, int]:
    gain = min(1.0, side / max(camera.width, camera.height))
    return max(1, round(gain * camera.width)), max(1, round(gain * camera.height))
