"""The fast CPU renderer: numba kernels with explicit SIMD on all cores.

This module allocates the buffers and runs the stages: `project` computes footprints, `order` sorts them by depth and
into tiles, `blend` computes pixels. The same input gives the same bytes on any number of cores.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ... import compiled
from ...camera import Camera, Render, Vec3
from ...cloud import GaussianCloud
from .. import convention
from ..shares import Split, sum_pairs
from . import blend, layout, order, project, shares
from . import surface_depth as surface

Array = NDArray[Any]

LIMITS = (np.float32(convention.ALPHA_MAX), np.float32(convention.T_MIN), np.float32(layout.Q_MAX))
ALONE = 4096, 80 * 60  # Gaussians and pixels, up to which a picture is drawn by one thread
MAX_ENTRIES = 1 << 26  # (footprint, tile) pairs held at once (256 MB); an image with more is drawn in strips


@dataclass(frozen=True)
class Bins:
    """Footprints sorted into tiles: `entries[first[t]:first[t + 1]]` are the rows that touch tile t, nearest first.

    `view` is the camera they were projected with.
    """

    view: layout.View
    projected: project.Projected
    first: Array
    entries: Array

    @property
    def records(self) -> Array:
        """The footprints, by the rows of the cloud."""
        return self.projected.records


def render(cloud: GaussianCloud, camera: Camera, background: Vec3) -> Render:
    """See `scenewright.gaussians.render.render`."""
    out = make_image(camera)
    for _ in draw_strips(_columns(cloud), camera, background, out):
        pass
    return Render(*(torch.from_numpy(channel).to(cloud.device) for channel in out))


def make_image(camera: Camera) -> tuple[Array, ...]:
    """Allocate an image: rgb `[H, W, 3]`, alpha, depth `[H, W]` float32, group `[H, W]` int32."""
    h, w = camera.height, camera.width
    return (
        np.empty((h, w, 3), np.float32), np.empty((h, w), np.float32), np.empty((h, w), np.float32),
        np.empty((h, w), np.int32),
    )  # fmt: skip


def workers(rows: int, pixels: int) -> int:
    """Number of threads for a picture: a small one is done before a second thread has begun."""
    return 1 if rows <= ALONE[0] and pixels <= ALONE[1] else compiled.workers()


def draw_strips(
    columns: tuple[Array, ...], camera: Camera, background: Vec3, out: tuple[Array, ...]
) -> Iterator[tuple[int, int, Bins]]:
    """Draw into `out`, one strip of image rows after another.

    Yields:
        first row and end row of the strip, and its sorted footprints (the backward pass needs them).
    """
    colors = tuple(np.float32(channel) for channel in background)
    count = workers(len(columns[0]), camera.width * camera.height)
    scratch, only = blend.make_scratch(count), blend.only_group(columns[5])
    for top, bottom, bins in _strips(columns, camera, count, 0, camera.height):
        strip = tuple(channel[top:bottom] for channel in out)
        sorted_ = bins.first, bins.entries, bins.records, (camera.width, bottom - top), LIMITS
        compiled.run(blend.draw, count, *sorted_, colors, only, strip, scratch, _counter())
        yield top, bottom, bins


def contributions(cloud: GaussianCloud, camera: Camera) -> Tensor:
    """See `scenewright.gaussians.render.contributions`."""
    total, columns = np.zeros(len(cloud), np.float64), _columns(cloud)
    count = compiled.workers()
    scratch = blend.make_scratch(count)
    for top, bottom, bins in _strips(columns, camera, count, 0, camera.height):
        share = np.zeros(len(bins.entries), np.float32)
        sorted_ = bins.first, bins.entries, bins.records, (camera.width, bottom - top), LIMITS
        compiled.run(blend.weigh, count, *sorted_, share, scratch, _counter())
        compiled.run_alone(blend.collect, bins.entries, share, total)
    return torch.from_numpy(total.astype(np.float32)).to(cloud.device)


def split(cloud: GaussianCloud, camera: Camera, labels: Array) -> Split:
    """See `scenewright.gaussians.render.split`."""
    columns, count = _columns(cloud), compiled.workers()
    scratch = blend.make_scratch(count)
    parts: list[tuple[Array, ...]] = []
    for top, bottom, bins in _strips(columns, camera, count, 0, camera.height):
        strip = np.ascontiguousarray(labels[top:bottom], dtype=np.int32)
        local, many, names = shares.make_plan(strip)
        compiled.run_alone(shares.list_labels, strip, local, many, names)
        needed = np.diff(bins.first) * many
        plan = local, many, np.cumsum(needed) - needed
        share = np.zeros(int(needed.sum()), np.float32)
        sorted_ = bins.first, bins.entries, bins.records, (camera.width, bottom - top), LIMITS
        compiled.run(shares.split, count, *sorted_, plan, share, scratch, _counter())
        found = int(np.count_nonzero(share))
        part = np.empty(found, np.int64), np.empty(found, np.int32), np.empty(found, np.float32)
        compiled.run_alone(shares.gather, bins.first, bins.entries, plan, names, share, *part)
        parts.append(part)
    rows, of, weights = (np.concatenate(column) for column in zip(*parts, strict=True))
    return sum_pairs(len(cloud), rows, of, weights)


def surface_depth(
    cloud: GaussianCloud, cameras: Sequence[Camera], level: float = 0.5
) -> Iterator[tuple[NDArray[np.float32], NDArray[np.float32]]]:
    """For each camera the surface where the light along a pixel's ray falls to the share `level`, on the Gaussian that
    takes it there.

    Yields:
        depth: `[H, W]` camera z, scene units; infinite where the light stays above the share.
        slant: `[H, W]` distance from that Gaussian's plane that a step of 1 in depth along the ray covers: the cosine
            between ray and normal times the ray's length at depth 1; 1 where there is no surface.
    """
    columns, count = _columns(cloud), compiled.workers()
    shapes, rays = surface.make_shapes(*columns[:3]), np.empty((count, surface.MOST, 4), np.float32)
    for camera in cameras:
        depth, slant = (np.empty((camera.height, camera.width), np.float32) for _ in range(2))
        for top, bottom, bins in _strips(columns, camera, count, 0, camera.height):
            sorted_ = bins.first, bins.entries, bins.records, (camera.width, bottom - top), LIMITS
            rest = np.float32(level), rays, (depth[top:bottom], slant[top:bottom]), _counter()
            compiled.run(surface.draw, count, *sorted_, shapes, bins.view, *rest)
        yield depth, slant


def _columns(cloud: GaussianCloud) -> tuple[Array, ...]:
    """The columns as arrays on the CPU; CPU tensors share their memory."""
    columns = (cloud.means, cloud.quats, cloud.scales, cloud.opacities, cloud.sh, cloud.group)
    return tuple(column.detach().cpu().contiguous().numpy() for column in columns)


def _strips(
    columns: tuple[Array, ...], camera: Camera, count: int, top: int, bottom: int
) -> Iterator[tuple[int, int, Bins]]:
    """Divide the image rows from `top` to `bottom` into as few strips as memory allows; yields each with its bins."""
    bins = _bin(columns, camera, count, top, bottom)
    if bins is not None:
        yield top, bottom, bins
        return
    middle = top + (bottom - top) // (2 * layout.TILE) * layout.TILE
    yield from _strips(columns, camera, count, top, middle)
    yield from _strips(columns, camera, count, middle, bottom)


def _bin(columns: tuple[Array, ...], camera: Camera, count: int, top: int, bottom: int) -> Bins | None:
    """Project and sort for the image rows `top` to `bottom`; None if they need more than `MAX_ENTRIES` entries and can
    be divided."""
    size = camera.width, bottom - top
    sample = np.ascontiguousarray(columns[0][:: convention.sample_step(len(columns[0]))])
    view = layout.make_view(camera, convention.near_plane(sample), top, bottom)
    found = project.run(columns, view, count, order.divide(sample, view, count, len(columns[0])))
    records, spots = found.records, found.spots
    rows = order.by_depth(found.visible, found.found)
    wide, high = (-(-side // layout.TILE) for side in size)
    places = np.zeros((count, wide * high + wide + 2), np.int64)
    compiled.run(order.count_tiles, count, rows, records, spots, view, wide, places)
    first = np.empty(wide * high + 1, np.int64)
    total = compiled.run_alone(order.starts, places, first)
    if total > MAX_ENTRIES and high > 1:
        return None
    entries = np.empty(total, np.int32)
    compiled.run(order.fill_tiles, count, rows, records, spots, view, wide, places, entries)
    return Bins(view, found, first, entries)


def _counter() -> Array:
    """A shared work counter, starting at zero."""
    return np.zeros(1, np.int64)
