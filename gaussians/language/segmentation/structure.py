"""Label the surface points of floor or ground, walls and ceiling.

The planes come from `planes.py`. Which points of a plane belong to it is decided by the colour and extent of the
superpoints in it: a rug lies in the plane of the floor and a painting in that of the wall, but their colour differs and
their extent is small, so they remain objects.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...scene import Frame
from .coplanar import PlaneSuperpoints, plane_superpoints
from .ground import Ground, ground_of
from .planes import CEILING, FLOOR, KINDS, NONE, WALL, Level, Plane, ceiling_of, level, walls_of
from .superpoints import LIGHTNESS
from .surface import Surface

NAMES = {FLOOR: "floor", WALL: "wall", CEILING: "ceiling"}

MIN_SURFACE = 200  # points; smaller surfaces are not searched for structure
SAME_COLOR = 11.0  # Lab difference up to which superpoints of a plane count as one colour
GRID = 40  # cells along each side of a plane
MAX_LEVELS = 12  # superpoints, broadest first, whose distance from the plane is tried as the plane's own
TIGHT = 0.3  # of the spacing: largest distance of a superpoint from a noise-free plane
PATTERN_EXTENT = 0.6  # a colour that spans this share of a plane in both directions belongs to its pattern


def structures(surface: Surface, labels: NDArray[np.int32], frame: Frame) -> NDArray[np.int8]:
    """Structure code of each surface point `[M]`; each wall has its own code, and `kind_of` gives the kind of a code.

    A superpoint whose points mostly lie in a plane is labelled as a whole.
    """
    flat = level(surface, frame)
    found = np.zeros(len(surface), np.int8)
    if len(surface) < MIN_SURFACE:
        return found
    terrain, planes = planes_of(surface, flat)
    found[terrain] = FLOOR
    found = np.where(surface.layer != NONE, surface.layer, found)
    first = int(found.max(initial=0)) // KINDS + 1
    for number, (kind, plane) in enumerate(planes):
        code = kind if kind != WALL else _known_wall(found[plane.near], WALL + KINDS * (first + number))
        found[_points_of_plane(surface, labels, flat, plane, found == NONE)] = code
    return found


def _known_wall(codes: NDArray[np.int8], new: int) -> int:
    """The code of the wall that is known to hold most of some points, or a new one if hardly any is known."""
    walls = codes[kind_of(codes) == WALL]
    return int(np.bincount(walls).argmax()) if len(walls) > 0.1 * len(codes) else new


def kind_of(codes: NDArray[np.int8]) -> NDArray[np.int8]:
    """The kind (NONE, FLOOR, WALL or CEILING) of each code."""
    return codes % KINDS


def planes_of(surface: Surface, flat: Level) -> tuple[NDArray[np.bool_], list[tuple[int, Plane]]]:
    """Points of terrain `[M]` (none where the ground is a flat floor), and the planes with their kinds."""
    ground = ground_of(surface, flat)
    planes: list[tuple[int, Plane]] = []
    terrain = np.zeros(len(surface), bool)
    if isinstance(ground, Ground):
        planes += [(FLOOR, plane) for plane in ground.planes(flat)]
    elif ground is not None:
        terrain = ground
    planes += [(WALL, p) for p in walls_of(surface, flat, ~terrain)]
    top = ceiling_of(surface, flat, ~terrain)
    return terrain, [*planes, (CEILING, top)] if top is not None else planes


def superpoints_near(surface: Surface, labels: NDArray[np.int32], flat: Level, plane: Plane) -> PlaneSuperpoints | None:
    """The superpoints near a plane, with a first guess of those that belong to it; None if none is near.

    The first guess is the colour of the broadest superpoint and all colours that extend over most of the plane. Walls
    are sampled more coarsely than what hangs on them, so breadth is counted in grid cells, not in points.
    """
    count = int(labels.max()) + 1
    near = np.flatnonzero(plane.near)
    own, along = labels[near], plane.along[near]
    cell = _plane_cells(along)
    off = plane.off[near] - _tilt(plane.off[near], along, cell)
    total = np.maximum(np.bincount(labels, minlength=count), 1)
    lab = np.stack([np.bincount(labels, weights=surface.lab[:, c], minlength=count) / total for c in range(3)], axis=1)
    breadth = np.bincount(np.unique(own.astype(np.int64) * GRID**2 + cell) // GRID**2, minlength=count)
    member = np.bincount(own, minlength=count) > 0.5 * total
    if not member.any():
        return None
    middle = _medians(off, own, count)
    main = _broadest_level(middle, np.where(member, breadth, 0), TIGHT * surface.spacing)
    spread = float(np.median(np.abs(off[own == main] - middle[main])))
    tight = TIGHT * surface.spacing
    member &= np.abs(middle - middle[main]) < max(4 * spread, tight)
    span = np.ptp(np.quantile(along, [0.02, 0.98], axis=0), axis=0)
    kept = np.zeros(count, bool)
    for piece in np.argsort(-np.where(member, breadth, -1), kind="stable"):
        if not member[piece] or kept[piece]:
            continue
        alike = member & (np.linalg.norm((lab - lab[piece]) * [LIGHTNESS, 1, 1], axis=1) < SAME_COLOR)
        reach = np.ptp(np.quantile(along[alike[own]], [0.02, 0.98], axis=0), axis=0)
        if piece == main or (reach > PATTERN_EXTENT * span).all():
            kept |= alike
        elif breadth[piece] < 0.01 * breadth.sum():
            break
    band = abs(float(middle[main])) + max(6 * spread, 1.5 * tight)
    facing = np.abs(flat.normals @ plane.normal)
    return PlaneSuperpoints(near, labels, cell, off, along, facing, kept, band, abs(float(plane.normal[2])) < 0.5)


def _points_of_plane(
    surface: Surface, labels: NDArray[np.int32], flat: Level, plane: Plane, free: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """The unlabelled points `[M]` that belong to a plane."""
    within = np.zeros(len(surface), bool)
    pieces = superpoints_near(surface, labels, flat, plane)
    if pieces is None:
        return within
    within[pieces.near[np.abs(pieces.off) < pieces.band]] = True
    return plane_superpoints(surface, pieces)[labels] & free & within


def _plane_cells(along: NDArray[np.float64]) -> NDArray[np.int64]:
    """Grid cell `[M]` in 0..GRID² of each point in the plane."""
    low, high = along.min(axis=0), along.max(axis=0)
    index = ((along - low) / (high - low + 1e-9) * GRID).astype(np.int64).clip(0, GRID - 1)
    cell: NDArray[np.int64] = index[:, 0] * GRID + index[:, 1]
    return cell


def _tilt(off: NDArray[np.float64], along: NDArray[np.float64], cell: NDArray[np.int64]) -> NDArray[np.float64]:
    """Correction of the distance at each point `[M]`: a trimmed linear fit to the medians of the cells. Medians of
    cells keep densely sampled objects on a sparsely sampled wall from pulling the fit towards them."""
    order = np.lexsort((off, cell))
    starts = np.flatnonzero(np.r_[True, np.diff(cell[order]) > 0])
    middle = order[starts + np.diff(np.r_[starts, len(order)]) // 2]
    design = np.column_stack([np.ones(len(middle)), along[middle]])
    values, keep = off[middle], np.ones(len(middle), bool)
    fit = np.array([float(np.median(values)), 0.0, 0.0])
    for _ in range(6):
        gap = np.abs(values - design @ fit)
        keep = gap <= max(2.5 * float(np.median(gap[keep])), 1e-4)
        if keep.sum() < 10:
            break
        fit = np.linalg.lstsq(design[keep], values[keep], rcond=None)[0]
    tilt: NDArray[np.float64] = np.column_stack([np.ones(len(along)), along]) @ fit
    return tilt


def _medians(off: NDArray[np.float64], own: NDArray[np.int32], count: int) -> NDArray[np.float64]:
    """Median distance from the plane `[S]` of each superpoint's points near it; infinite for those without any."""
    order = np.lexsort((off, own))
    middle = np.full(count, np.inf)
    starts = np.flatnonzero(np.r_[True, np.diff(own[order]) > 0])
    sizes = np.diff(np.r_[starts, len(order)])
    middle[own[order][starts]] = off[order][starts + sizes // 2]
    return middle


def _broadest_level(middle: NDArray[np.float64], breadth: NDArray[np.int64], tight: float) -> int:
    """The broadest superpoint at the distance from the plane at which most cells lie. The broadest superpoint alone
    does not decide: one plank of a floor is narrower than the rug on it."""
    candidates = [c for c in np.argsort(-breadth, kind="stable")[:MAX_LEVELS] if breadth[c] > 0]
    support = [int(breadth[np.abs(middle - middle[c]) < tight].sum()) for c in candidates]
    best = middle[candidates[int(np.argmax(support))]]
    return int(np.argmax(np.where(np.abs(middle - best) < tight, breadth, -1)))
