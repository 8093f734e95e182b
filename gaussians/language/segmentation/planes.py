"""Find the planes of walls and ceiling from positions and normals; `ground.py` finds the floor.

Colours and superpoints are not used here. `structure.py` decides which of the points in a plane belong to it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...scene import Frame
from .surface import Surface

NONE, FLOOR, WALL, CEILING = 0, 1, 2, 3
KINDS = 4
UP = np.array([0.0, 0.0, 1.0])

MAX_BEHIND_WALL = 0.02  # share of the scene that may lie behind a wall
WALL_LENGTH = 0.3  # of the scene's extent: shorter upright planes are furniture
WALL_HEIGHT = 0.55  # likewise
MAX_WALLS = 6
MIN_LAYER = 0.02  # of the scene's area that a wall must hold, where it is found by positions alone
SQUARE = 0.35  # sine of twice the angle by which walls that are found by positions alone may miss a right angle
THICK = 4.0  # times the noise of the floor, from which a layer is no wall
SHEET_CELLS = 10  # along each side of a wall
SHEET_FILL = 0.5  # of its cells that must hold points


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


def walls_of(surface: Surface, flat: Level, free: NDArray[np.bool_]) -> list[Plane]:
    """Upright planes at the edge of the scene that are at least WALL_LENGTH long and WALL_HEIGHT high."""
    extent = extent_of(flat)
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
    extent = extent_of(flat)
    top = np.quantile(flat.points[:, 2], 0.995)
    near = (np.abs(flat.points[:, 2] - top) < max(2 * surface.spacing, 0.01 * extent[2])) & free
    near &= np.abs(flat.normals[:, 2]) > 0.8
    if near.sum() < 0.03 * len(surface):
        return None
    size = np.ptp(np.quantile(flat.points[near, :2], [0.05, 0.95], axis=0), axis=0)
    return Plane(near, flat.points[:, 2] - top, flat.points[:, :2], UP) if (size > 0.6 * extent[:2]).all() else None


def outer_layers(
    flat: Level, area: NDArray[np.float32], spacing: float, floor_noise: float,
    layer: Callable[[NDArray[np.float64], NDArray[np.floating], float, float], tuple[float, float]],
) -> list[tuple[NDArray[np.float64], float, float]]:  # fmt: skip
    """Walls and ceiling found by positions alone: planes at the edge of the scene in which points concentrate.

    Returns the normal `[3]` into the room, the offset along it and the noise of each.

    Args:
        area: `[M]` weights.
        floor_noise: standard deviation of the floor's points, scene units. A fit leaves all planes about as noisy; what
            is much thicker than the floor is things in a row.
        layer: measures height and noise of a layer from heights, weights, a first height and the scene's size.
    """
    extent = extent_of(flat)
    broad = float(extent.max())
    height = np.quantile(flat.points[:, 2], 0.01) + extent[2] * np.array([0.1, 0.95])
    standing = np.flatnonzero((flat.points[:, 2] > height[0]) & (flat.points[:, 2] < height[1]))
    standing = standing[:: max(1, len(standing) // 20_000)]
    if len(standing) < 200:
        return []
    points, weight = flat.points[standing], np.minimum(area[standing], np.quantile(area[standing], 0.9))

    def peak(angle: float) -> tuple[float, float]:
        """Share of the strongest layer at the edge in one direction, and its offset."""
        off = points[:, :2] @ [np.cos(angle), np.sin(angle)]
        low, high = np.quantile(off, [0.6, 0.998])
        share, bins = np.histogram(off, 40, (low, high + 0.02 * broad), weights=weight)
        smooth = np.convolve(share, np.ones(3), mode="same") / weight.sum()
        best = int(np.argmax(smooth))
        return float(smooth[best]), float(bins[best : best + 2].mean())

    angles = np.radians(np.arange(0, 360, 4.0))
    strength = np.array([peak(a)[0] for a in angles])
    found: list[tuple[NDArray[np.float64], float, float]] = []
    while strength.max() > MIN_LAYER and len(found) < MAX_WALLS:
        best = angles[int(np.argmax(strength))]
        strength[np.abs((angles - best + np.pi) % (2 * np.pi) - np.pi) < np.radians(25)] = 0
        best = max(best + np.radians(np.arange(-4, 4.1, 0.5)), key=lambda a: peak(a)[0])
        if found and abs(np.sin(2 * (best - np.arctan2(found[0][0][1], found[0][0][0])))) > SQUARE:
            continue  # positions alone do not tell a wall from a slice through a corner
        outward = np.array([np.cos(best), np.sin(best), 0.0])
        across = np.array([-outward[1], outward[0], 0.0])
        off = peak(best)[1] - flat.points @ outward
        middle, noise = layer(off, area, 0.0, broad)
        off -= middle
        along = np.stack([flat.points @ across, flat.points[:, 2]], axis=1)
        least = np.array([WALL_LENGTH * extent[:2].max(), WALL_HEIGHT * extent[2]])
        if noise < THICK * floor_noise and _is_sheet(off, along, max(2 * noise, 2 * spacing, 0.004 * broad), least):
            found.append((-outward, float((flat.points @ -outward - off).mean()), noise))
    off = float(np.quantile(flat.points[:, 2], 0.98)) - flat.points[:, 2]
    middle, noise = layer(off, area, 0.0, broad)
    off -= middle
    if noise < THICK * floor_noise and _is_sheet(
        off, flat.points[:, :2], max(2 * noise, 2 * spacing), 0.6 * extent[:2]
    ):
        found.append((-UP, float((-flat.points[:, 2] - off).mean()), noise))
    return found


def _is_sheet(off: NDArray[np.float64], along: NDArray[np.float64], reach: float, least: NDArray[np.float64]) -> bool:
    """Whether points near a plane fill a large sheet with hardly anything behind it."""
    near = np.abs(off) < reach
    if near.sum() < 200 or float((off < -2 * reach).mean()) > 2 * MAX_BEHIND_WALL:
        return False
    low, high = np.quantile(along[near], [0.02, 0.98], axis=0)
    cell = ((along[near] - low) / (high - low + 1e-9) * SHEET_CELLS).astype(np.int64)
    cell = cell[((cell >= 0) & (cell < SHEET_CELLS)).all(axis=1)]
    full = len(np.unique(cell[:, 0] * SHEET_CELLS + cell[:, 1])) / SHEET_CELLS**2
    return bool((high - low >= least).all() and full > SHEET_FILL)


def extent_of(flat: Level) -> NDArray[np.float64]:
    """Robust size of the scene: east, north, height."""
    spread: NDArray[np.float64] = np.ptp(np.quantile(flat.points, [0.01, 0.99], axis=0), axis=0)
    return np.maximum(spread, 1e-9)


def mode(values: NDArray[np.floating], weight: NDArray[np.floating]) -> float:
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
    return mode(values[near], weight[near])


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
