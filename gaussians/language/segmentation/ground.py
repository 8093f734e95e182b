"""Fit the floor: its plane, which may be tilted, its further levels, and the noise of its points; or rough terrain.

Nothing lies beneath a floor, so the points beneath its plane measure its noise, whatever stands on it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from .planes import Level, Plane, extent_of, mode, outer_layers, walls_of
from .surface import Surface

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
Mask = NDArray[np.bool_]

CELLS = 64  # of the height map across the larger side
COARSE = 8  # cells of the height map along one side of a coarse cell, in which noise averages out
ROUGHNESS = 0.003  # ground whose coarse cells vary in height by more than this share of the scene is terrain,
UNEVEN = 1.0  # if this is also more than this share of the deviation of all its points
COHERENT = 0.3  # share of the variance of heights between cells from which ground is rough and not noisy
MAX_BUMP = 0.03  # of the scene: bumps, stones and low plants up to this height are terrain
TALL_RATIO = 1.5  # a scene this many times as high as it is broad is one tall object without ground
NEAR_GROUND = 0.06  # of the scene: height above the lowest points within which a floor is searched
MAX_NOISE = 0.025  # of the scene, standard deviation
MIN_SHARE = 0.02  # of the surface points that a floor must have
TILTS = (0.4, 14.0)  # degrees between which a floor may be tilted; less is corrected by the fit of each plane
TILT_GAIN = 1.15  # cells of a tilted plane over those of a level one, from which the floor is tilted
TRIALS = 300  # triples of cells through which a tilted plane is laid
UNDERSIDE = 0.8  # of the cells of a lower level that a slab's upper side covers
STEP_SPAN = 0.85  # of the plan's extent that a further level must have in its longest direction
STEP_SHARE = 0.1  # of the plan's cells that a further level must have
STEP_HEIGHT = 0.2  # of the scene's height: largest step between levels
KERNEL = 0.5  # of the noise: width of the kernel that finds the densest height
MEDIAN_OF_HALF_NORMAL = 0.6745


@dataclass(frozen=True)
class Ground:
    """The floor of a scene in the level frame.

    Attributes:
        slope: `[3]` height of its plane: `slope[0] + slope[1] east + slope[2] north`.
        noise: standard deviation of its points across it, scene units.
        levels: heights of its levels above the plane; 0 first, the others only where the floor has steps.
        reach: distance from a level within which a point may belong to it, scene units.
    """

    slope: F64
    noise: float
    levels: tuple[float, ...]
    reach: float

    @property
    def normal(self) -> F64:
        """`[3]` unit, upward."""
        normal = np.array([-self.slope[1], -self.slope[2], 1.0])
        return normal / float(np.linalg.norm(normal))

    def off(self, points: F64) -> F64:
        """Signed distance `[M]` of points `[M, 3]` from the plane of the first level."""
        above = points[:, 2] - self.slope[0] - points[:, :2] @ self.slope[1:]
        result: F64 = above * self.normal[2]
        return result

    def planes(self, flat: Level) -> list[Plane]:
        """The plane of each level with the points near it."""
        off = self.off(flat.points)
        along = flat.points[:, :2]
        return [Plane(np.abs(off - at) < self.reach, off - at, along, self.normal) for at in self.levels]


@dataclass(frozen=True)
class _Map:
    """The plan in cells.

    Attributes:
        cell: `[M]` cell of each point.
        lowest: `[CELLS * CELLS]` height of the lowest points of each cell, NaN where it is empty.
        centre: `[CELLS * CELLS, 2]`.
        above: `[M]` height of each point above the smoothed lowest points.
    """

    cell: I64
    lowest: F64
    centre: F64
    above: F64


def ground_of(surface: Surface, flat: Level) -> Ground | Mask | None:
    """The floor, or the points `[M]` of rough terrain, or None where there is no ground."""
    extent = extent_of(flat)
    broad = float(max(extent))
    if extent[2] > TALL_RATIO * max(extent[:2]):
        return None
    plan = _map(flat, float(max(extent[:2])))
    is_level = np.abs(flat.normals[:, 2]) > 0.8
    close = np.abs(plan.above) < NEAR_GROUND * broad
    if not (close & is_level).any():
        return None
    slope = _tilt(plan, max(surface.spacing, 0.004 * broad))
    ground = Ground(slope, 0.0, (0.0,), 0.0)
    off = ground.off(flat.points)
    weight = is_level & (close if not slope[1:].any() else np.abs(off) < NEAR_GROUND * broad)
    height = mode(off[weight], surface.area[weight]) if weight.any() else 0.0
    height += _upper_side(plan, off - height, weight, broad)
    height, noise = layer(off, surface.area, height, broad)
    off = off - height
    reach = max(1.5 * surface.spacing, 0.003 * broad)
    uneven = _unevenness(plan, off, noise) > max(ROUGHNESS * broad, UNEVEN * noise)
    if uneven or _is_rough(surface, flat, plan, off, noise):
        bump = float(np.median(np.abs(plan.above[weight] - np.median(plan.above[weight]))))
        limit = min(max(3.0 * bump, MAX_BUMP * broad), 0.08 * broad)
        terrain: Mask = plan.above < np.median(plan.above[weight]) + limit
        return terrain
    if (np.abs(off) < max(reach, 3 * noise)).sum() < MIN_SHARE * len(surface):
        return None
    slope = slope + np.array([height / ground.normal[2], 0.0, 0.0])
    levels = (0.0, *_steps(plan, slope, reach + 1.5 * noise, STEP_HEIGHT * float(extent[2])))
    return Ground(slope, noise, levels, reach)


def _map(flat: Level, width: float) -> _Map:
    cell = width / CELLS
    low = np.quantile(flat.points[:, :2], 0.005, axis=0)
    index = np.clip(((flat.points[:, :2] - low) / cell).astype(np.int64), 0, CELLS - 1)
    key = index[:, 0] * CELLS + index[:, 1]
    order = np.lexsort((flat.points[:, 2], key))
    starts = np.flatnonzero(np.r_[True, np.diff(key[order]) > 0])
    counts = np.diff(np.r_[starts, len(order)])
    lowest = np.full(CELLS * CELLS, np.nan)
    lowest[key[order][starts]] = flat.points[order[starts + counts // 20], 2]
    window = max(3, CELLS // 4)
    opened = ndimage.grey_opening(_fill(lowest.reshape(CELLS, CELLS)), size=(window, window))
    base = ndimage.gaussian_filter(opened, 1.0)
    corner = np.stack(np.meshgrid(np.arange(CELLS), np.arange(CELLS), indexing="ij"), axis=-1).reshape(-1, 2)
    return _Map(key, lowest, low + (corner + 0.5) * cell, flat.points[:, 2] - base.ravel()[key])


def _fill(grid: F64) -> F64:
    """The grid with each empty cell filled from the nearest full one."""
    index = ndimage.distance_transform_edt(np.isnan(grid), return_distances=False, return_indices=True)
    filled: F64 = grid[tuple(index)]
    return filled


def _tilt(plan: _Map, tolerance: float) -> F64:
    """`[3]` the plane through most of the lowest points of the cells, if it is tilted; else zeros.

    Laid through random triples of cells (RANSAC: Fischler & Bolles 1981) and fitted to the cells near it.
    """
    full = np.flatnonzero(np.isfinite(plan.lowest))
    level: F64 = np.zeros(3)
    if len(full) < 30:
        return level
    design = np.column_stack([np.ones(len(full)), plan.centre[full]])
    heights = plan.lowest[full]
    order = np.sort(heights)
    flat = int((np.searchsorted(order, order + 2 * tolerance) - np.arange(len(order))).max())
    triples = np.random.default_rng(0).integers(len(full), size=(TRIALS, 3))
    best = level
    most = TILT_GAIN * flat
    for triple in triples:
        if abs(np.linalg.det(design[triple])) < 1e-9:
            continue
        slope: F64 = np.linalg.solve(design[triple], heights[triple])
        if not TILTS[0] < np.degrees(np.arctan(np.linalg.norm(slope[1:]))) < TILTS[1]:
            continue
        gap = heights - design @ slope
        inside = int((np.abs(gap) < tolerance).sum())
        # a ramp through the tops of furniture has floor beneath it
        if inside > most and (gap < -2 * tolerance).sum() < 0.1 * inside:
            best, most = slope, inside
    for _ in range(5 * bool(best.any())):
        near = np.abs(heights - design @ best) < tolerance
        best = np.asarray(np.linalg.lstsq(design[near], heights[near], rcond=None)[0], np.float64)
    return best


def _upper_side(plan: _Map, off: F64, weight: Mask, broad: float) -> float:
    """Height of the upper side of a slab whose lower side lies at 0: a level above it that covers nearly the same
    cells; 0 where there is none."""
    thin = 0.004 * broad
    lower = np.unique(plan.cell[weight & (np.abs(off) < thin)])
    above = weight & (off > 2 * thin) & (off < NEAR_GROUND * broad)
    if len(lower) < 50 or above.sum() < 50:
        return 0.0
    height = mode(off[above], np.ones(int(above.sum())))
    upper = np.unique(plan.cell[weight & (np.abs(off - height) < thin)])
    return height if len(np.intersect1d(lower, upper)) > UNDERSIDE * len(lower) else 0.0


def layer(off: F64, area: NDArray[np.floating], height: float, broad: float) -> tuple[float, float]:
    """The height of the floor's layer and the standard deviation of its points, each from the other in turn.

    Args:
        off: `[M]` heights of points above a plane.
        area: `[M]` weights.
        height: first guess.
        broad: size of the scene.
    """
    noise = 0.004 * broad
    for _ in range(10):  # the window grows with the noise, so that the underside of a slab stays out of it
        below = height - off[(off < height) & (off > height - 6 * noise)]
        if not len(below):
            return height, 0.0
        noise = min(float(np.median(below)) / MEDIAN_OF_HALF_NORMAL, MAX_NOISE * broad)
        near = np.abs(off - height) < KERNEL * 3 * noise
        if noise < 0.0002 * broad or near.sum() < 100:
            break  # the mode is exact where the points have no noise
        # a mean shift to the densest height; a narrow kernel is little affected by what stands on the floor
        weight = area[near] * np.exp(-0.5 * ((off[near] - height) / (KERNEL * noise)) ** 2)
        step = (1 + KERNEL**-2) * float(np.average(off[near] - height, weights=weight))
        height += float(np.clip(step, -noise, noise)) / 2
    return height, noise


def _unevenness(plan: _Map, off: F64, noise: float) -> float:
    """Standard deviation of the ground's height from one coarse cell to another: 1.48 median deviations.

    The noise of a floor averages out within a coarse cell; the bumps of a terrain do not.
    """
    near = np.abs(off) < 2.5 * noise
    coarse = (plan.cell[near] // CELLS // COARSE) * CELLS + plan.cell[near] % CELLS // COARSE
    order = np.lexsort((off[near], coarse))
    starts = np.flatnonzero(np.r_[True, np.diff(coarse[order]) > 0])
    sizes = np.diff(np.r_[starts, len(order)])
    many = sizes >= 8
    if many.sum() < 8:
        return 0.0
    middle = off[near][order[starts + sizes // 2]][many]
    return 1.48 * float(np.median(np.abs(middle - np.median(middle))))


def _is_rough(surface: Surface, flat: Level, plan: _Map, off: F64, noise: float) -> bool:
    """Whether the ground is rough and lies in the open: stones and plants move neighbouring points alike, noise moves
    each by itself. The floor of a room is never rough: what moves its points alike is a bad fit."""
    if noise < ROUGHNESS * float(max(extent_of(flat))) or _coherence(plan.cell, off, noise) < COHERENT:
        return False
    closed = walls_of(surface, flat, np.ones(len(surface), bool))
    return not closed and not outer_layers(flat, surface.area, surface.spacing, noise, layer)


def _coherence(cell: I64, off: F64, noise: float) -> float:
    """Share of the variance of heights that lies between cells and not within them (the intraclass correlation)."""
    near = np.abs(off) < 2.5 * noise
    count, total, squares = (
        np.bincount(cell[near], weights=w, minlength=CELLS * CELLS) for w in (None, off[near], off[near] ** 2)
    )
    full = count >= 2
    n, first, second = count[full].astype(np.float64), total[full], squares[full]
    points, cells = float(n.sum()), len(n)
    if cells < 30:
        return 0.0
    within = float((second - first**2 / n).sum()) / max(points - cells, 1.0)
    spread = float((n * (first / n - first.sum() / points) ** 2).sum()) / (cells - 1)
    typical = (points - float((n**2).sum()) / points) / (cells - 1)
    between = max((spread - within) / typical, 0.0)
    return between / max(between + within, 1e-20)


def _steps(plan: _Map, slope: F64, reach: float, highest: float) -> list[float]:
    """Heights of further levels of the floor: broad level areas without floor beneath them that span the plan."""
    full = np.flatnonzero(np.isfinite(plan.lowest))
    off = plan.lowest[full] - slope[0] - plan.centre[full] @ slope[1:]
    found: list[float] = []
    left = (np.abs(off) > 2 * reach) & (np.abs(off) < highest)
    while left.sum() > STEP_SHARE * len(full):
        order = np.sort(off[left])
        inside = np.searchsorted(order, order + 2 * reach) - np.arange(len(order))
        first = int(np.argmax(inside))
        at = float(np.median(order[first : first + inside[first]]))
        own = left & (np.abs(off - at) < reach)
        if own.sum() < STEP_SHARE * len(full):
            break
        if _spans(plan.centre[full], plan.centre[full[own]]):
            found.append(at)
        left &= ~own
    return found


def _spans(plan: F64, part: F64) -> bool:
    """Whether cells `part` reach across `plan` in some direction, as a platform does and a bed does not."""
    angles = np.radians(np.arange(0, 180, 15))
    lines = np.stack([np.cos(angles), np.sin(angles)])
    whole, own = (np.ptp(np.quantile(p @ lines, [0.02, 0.98], axis=0), axis=0) for p in (plan, part))
    return bool((own > STEP_SPAN * whole).any())
