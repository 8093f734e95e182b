"""Find the planes of floor, walls and ceiling, or the height field of rough ground, from positions and normals.

Colours and superpoints are not used here. `structure.py` decides which of the points in a plane belong to it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ...scene import Frame
from .surface import Surface

UP = np.array([0.0, 0.0, 1.0])

CELLS = 64  # of the height map across the larger side
ROUGHNESS = 0.012  # ground whose height varies by more than this share of the scene is terrain, not a floor
MAX_BUMP = 0.03  # of the scene: bumps, stones and low plants up to this height are terrain
TALL_RATIO = 1.5  # a scene this many times as high as it is broad is one tall object without ground
MAX_BEHIND_WALL = 0.02  # share of the scene that may lie behind a wall
WALL_LENGTH = 0.3  # of the scene's extent: shorter upright planes are furniture
WALL_HEIGHT = 0.55  # likewise


@dataclass(frozen=True)
class Level:
    """Surface points `[M, 3]` (east, north, height) and normals `[M, 3]` in a frame whose third axis is up."""

    points: NDArray[np.float64]
    normals: NDArray[np.float64]


def level(surface: Surface, frame: Frame) -> Level:
    """The surface rotated so that up is the third axis."""
    basis = frame.basis()
    return Level(surface.points @ basis.T, surface.normals @ basis.T)


@dataclass(frozen=True)
class Plane:
    """Points near a plane `[M]` bool, their signed distance from it `[M]`, two coordinates along it `[M, 2]`, and its
    normal in the level frame."""

    near: NDArray[np.bool_]
    off: NDArray[np.float64]
    along: NDArray[np.float64]
    normal: NDArray[np.float64]


def ground_of(surface: Surface, flat: Level) -> Plane | NDArray[np.bool_] | None:
    """The plane of the floor, or the points `[M]` of rough terrain, or None where there is no ground."""
    extent = _extent(flat)
    if extent[2] > TALL_RATIO * max(extent[:2]):
        return None
    cell = max(extent[0], extent[1]) / CELLS
    low = np.quantile(flat.points[:, :2], 0.005, axis=0)
    index = np.clip(((flat.points[:, :2] - low) / cell).astype(np.int64), 0, CELLS - 1)
    lowest = np.full((CELLS, CELLS), np.nan)
    key = index[:, 0] * CELLS + index[:, 1]
    order = np.lexsort((flat.points[:, 2], key))
    starts = np.flatnonzero(np.r_[True, np.diff(key[order]) > 0])
    counts = np.diff(np.r_[starts, len(order)])
    lowest.ravel()[key[order][starts]] = flat.points[order[starts + counts // 20], 2]
    filled = _fill(lowest)
    window = max(3, CELLS // 4)
    base = ndimage.gaussian_filter(ndimage.grey_opening(filled, size=(window, window)), 1.0)
    above = flat.points[:, 2] - base[index[:, 0], index[:, 1]]
    is_level = np.abs(flat.normals[:, 2]) > 0.8
    close = np.abs(above) < 0.06 * max(extent)
    if not (close & is_level).any():
        return None
    weight = close & is_level
    rough = float(np.median(np.abs(above[weight] - np.median(above[weight]))))
    if rough > ROUGHNESS * max(extent) * 0.25:
        terrain: NDArray[np.bool_] = above < np.median(above[weight]) + min(
            max(3.0 * rough, MAX_BUMP * max(extent)), 0.08 * max(extent)
        )
        return terrain
    offset = _mode(flat.points[weight, 2], surface.area[weight])
    near = np.abs(flat.points[:, 2] - offset) < max(1.5 * surface.spacing, 0.003 * max(extent))
    if near.sum() < 0.02 * len(surface):
        return None
    return Plane(near, flat.points[:, 2] - offset, flat.points[:, :2], UP)


def walls_of(surface: Surface, flat: Level, free: NDArray[np.bool_]) -> list[Plane]:
    """Upright planes at the edge of the scene that are at least WALL_LENGTH long and WALL_HEIGHT high."""
    extent = _extent(flat)
    upright = (np.abs(flat.normals[:, 2]) < 0.25) & free & (surface.flatness > 0.3)
    planes: list[Plane] = []
    inside = flat.points[:: max(1, len(surface) // 20_000)]
    for angle in _azimuths(surface, flat, upright):
        normal = np.array([np.cos(angle), np.sin(angle), 0.0])
        tangent = np.array([-normal[1], normal[0], 0.0])
        facing = upright & (np.abs(flat.normals @ normal) > 0.9)
        if facing.sum() < 100:
            continue
        offset = _outermost(flat.points[facing] @ normal, surface.area[facing])
        tolerance = max(2.0 * surface.spacing, 0.004 * float(max(extent)))
        behind = float((inside @ normal > offset + 2 * tolerance).mean())
        before = float((inside @ normal < offset - 2 * tolerance).mean())
        near = np.abs(flat.points @ normal - offset) < tolerance
        along = np.stack([flat.points @ tangent, flat.points[:, 2]], axis=1)
        if min(behind, before) > MAX_BEHIND_WALL or not near.any():
            continue
        size = np.ptp(np.quantile(along[near & facing], [0.02, 0.98], axis=0), axis=0)
        if size[0] >= WALL_LENGTH * max(extent[:2]) and size[1] >= WALL_HEIGHT * extent[2]:
            planes.append(Plane(near, flat.points @ normal - offset, along, normal))
    return planes


def ceiling_of(surface: Surface, flat: Level, free: NDArray[np.bool_]) -> Plane | None:
    """The level plane at the top of the scene if it covers most of the floor plan, else None."""
    extent = _extent(flat)
    top = np.quantile(flat.points[:, 2], 0.995)
    near = (np.abs(flat.points[:, 2] - top) < max(2 * surface.spacing, 0.01 * extent[2])) & free
    near &= np.abs(flat.normals[:, 2]) > 0.8
    if near.sum() < 0.03 * len(surface):
        return None
    size = np.ptp(np.quantile(flat.points[near, :2], [0.05, 0.95], axis=0), axis=0)
    return Plane(near, flat.points[:, 2] - top, flat.points[:, :2], UP) if (size > 0.6 * extent[:2]).all() else None


def _extent(flat: Level) -> NDArray[np.float64]:
    """Robust size of the scene: east, north, height."""
    spread: NDArray[np.float64] = np.ptp(np.quantile(flat.points, [0.01, 0.99], axis=0), axis=0)
    return np.maximum(spread, 1e-9)


def _fill(grid: NDArray[np.float64]) -> NDArray[np.float64]:
    """The grid with each empty cell filled from the nearest full one."""
    index = ndimage.distance_transform_edt(np.isnan(grid), return_distances=False, return_indices=True)
    filled: NDArray[np.float64] = grid[tuple(index)]
    return filled


def _mode(values: NDArray[np.floating], weight: NDArray[np.floating]) -> float:
    """The mode of a weighted distribution: the median of the values near the fullest bin of its histogram."""
    bins = np.histogram_bin_edges(values, 200)
    share = np.histogram(values, bins, weights=weight)[0]
    peak = int(np.argmax(np.convolve(share, np.ones(3), mode="same")))
    near = (values >= bins[max(peak - 1, 0)]) & (values <= bins[min(peak + 2, len(bins) - 1)])
    return float(np.median(values[near]))


def _outermost(values: NDArray[np.floating], weight: NDArray[np.floating]) -> float:
    """The largest mode whose weight is at least a third of the strongest mode's."""
    bins = np.histogram_bin_edges(values, 200)
    share = np.convolve(np.histogram(values, bins, weights=weight)[0], np.ones(3), mode="same")
    last = int(np.flatnonzero(share >= share.max() / 3)[-1])
    near = (values >= bins[max(last - 2, 0)]) & (values <= bins[min(last + 2, len(bins) - 1)])
    return _mode(values[near], weight[near])


def _azimuths(surface: Surface, flat: Level, upright: NDArray[np.bool_]) -> list[float]:
    """Candidate outward directions of walls, radians: each strong azimuth of the normals and its opposite."""
    if not upright.any():
        return []
    angle = np.arctan2(flat.normals[upright, 1], flat.normals[upright, 0]) % np.pi
    share = np.histogram(angle, 90, range=(0, np.pi), weights=surface.area[upright])[0]
    smooth = share + np.roll(share, 1) + np.roll(share, -1)
    peaks: list[float] = []
    for _ in range(4):
        best = int(np.argmax(smooth))
        if smooth[best] < 0.08 * share.sum():
            break
        near = np.abs((angle - (best + 0.5) * np.pi / 90 + np.pi / 2) % np.pi - np.pi / 2) < np.radians(4)
        doubled = np.exp(2j * angle[near])
        peaks.append(float(np.angle((doubled * surface.area[upright][near]).sum()) / 2))
        smooth[np.arange(best - 7, best + 8) % 90] = 0
    return [a + turn for a in peaks for turn in (0.0, np.pi)]
