"""Where to put something: a free, supported spot that fulfils a placement, found on a grid over the support.

One exact search over a grid replaces trial and error: a cell is possible when the thing's footprint
around it is carried by the support, stays within the allowed region and meets no solid point up to the thing's height;
of the possible cells the one nearest to what was asked wins.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...gaussians.camera import Vec3
from ...gaussians.errors import InstructionError
from ...gaussians.world.box import Axes
from ...gaussians.world.relations import named
from ..operation import Placement
from .bodies import Array, Body, bodies_of, centimetre, neighbours
from .occupancy import Bool, grown, histogram, window_sum
from .regions import Region, beside_region, far, regions_of
from .surroundings import FLOOR_WORDS, Surroundings

_CELLS = 220  # most cells along a side of the grid
_FOOT_CELLS = 10  # cells along the shorter side of a footprint, if the region is small enough
_CARRIED = 0.75  # share of the footprint that must lie over the support's surface
WALL_WORDS = frozenset({"wall", "walls"})


@dataclass(frozen=True)
class Spot:
    """A solution.

    Attributes:
        foot: where the centre of the underside goes, world, scene units.
        support: height along up of the surface there.
        axes: of the box the search assumed; level axes and up.
        notes: for the receipt.
    """

    foot: Array
    support: float
    axes: Axes
    notes: tuple[str, ...] = ()


def anchors_of(around: Surroundings, place: Placement) -> list[Body]:
    """The things a placement names, resolved; empty if it is about the room itaround.

    Raises:
        AbsentError, AmbiguousError: an anchor is not there or not unique.
    """
    found: list[Body] = []
    for query in place.anchors:
        word = query.text.lower()
        room = place.relation in ("on", "center", "corner") and word in FLOOR_WORDS
        if room or (place.relation == "against" and word in WALL_WORDS):
            continue
        selection = around.context.resolve(around.scene, query).require()
        found.extend(bodies_of(around.scene, selection))
    return found


def free_spot(around: Surroundings, size: Vec3, axes: Axes, place: Placement | None, start: Array | None) -> Spot:
    """A spot for a box of `size` along `axes`.

    Args:
        start: where the thing is now, or where one would expect it; ties are broken toward it.

    Raises:
        InstructionError: there is no free spot; the message says what is in the way.
    """
    anchors = anchors_of(around, place) if place is not None else []
    regions = regions_of(around, size, axes, place, anchors, start)
    crowded = False
    for region in regions:
        foot, blocked = _search(around, size, axes, region, anchors)
        if foot is not None:
            return Spot(foot, region.height, axes)
        crowded |= blocked
    where = place.describe() if place is not None else "on the floor"
    why = "everything there is taken" if crowded else "there is no surface there large enough to carry it"
    raise InstructionError(f"there is no room {where}: {why}; make it smaller, clear a spot or name another place")


def spot_to_hang(around: Surroundings, size: Vec3, place: Placement, region: Region, axes: Axes) -> Spot:
    """A free spot in a region where something hangs (see overhead.py).

    Raises:
        InstructionError: there is none.
    """
    return _only(around, size, axes, region, place.describe())


def spot_beside(around: Surroundings, body: Body) -> Spot:
    """A free spot next to a thing for another like it.

    Raises:
        InstructionError: there is none.
    """
    region = beside_region(around, body.box.size, np.array(body.box.axes[:2]), body, named("next_to"), None)
    return _only(around, body.box.size, body.box.axes, region, f"next to the {body.label or 'thing'}")


def spot_near(around: Surroundings, size: Vec3, axes: Axes, body: Body) -> Spot:
    """Where a thing that goes away stands, or the free spot nearest to it, on what it stands on.

    Raises:
        InstructionError: there is none within its own size.
    """
    plan = np.array(axes[:2])
    middle, reach = plan @ body.center, 0.75 * np.array(size[:2]) + 0.5 * max(body.box.size[:2])
    height, surface = around.base_under(body, plan)
    if surface is not None:  # what it covered carries, too, though nothing of it was ever seen
        under = np.stack(np.meshgrid(*[np.linspace(-0.5, 0.5, 15)] * 2), axis=-1).reshape(-1, 2)
        extents = np.array([body.box.extent(a) for a in plan])
        covered = np.column_stack([middle + under * extents, np.full(len(under), height)])
        surface = np.concatenate([surface, covered])
    region = Region(middle - reach, middle + reach, lambda p: far(p, middle), height, surface)
    return _only(around, size, axes, region, f"where the {body.label or 'thing'} stands")


def _only(around: Surroundings, size: Vec3, axes: Axes, region: Region, where: str) -> Spot:
    foot, crowded = _search(around, size, axes, region, ())
    if foot is None:
        why = "everything there is taken" if crowded else "no surface there is large enough to carry it"
        raise InstructionError(f"there is no room {where}: {why}; clear a spot or name another place")
    return Spot(foot, region.height, axes)


def _search(
    around: Surroundings, size: Vec3, axes: Axes, region: Region, anchors: Sequence[Body]
) -> tuple[Array | None, bool]:
    """The best possible foot position on one support, and whether obstacles (rather than the support) ruled."""
    basis = np.array(axes)
    half = np.array(size[:2]) / 2
    span = np.maximum(region.high - region.low, 0) + 2 * half
    cell = max(float(min(size[:2])) / _FOOT_CELLS, float(span.max()) / _CELLS, 1e-9)
    shape = np.maximum(np.ceil(span / cell).astype(int) + 1, 1)
    origin = region.low - half
    clear = _clear(around, size)
    blocked = _occupied(around, basis, origin, cell, shape, (region.height + clear, region.height + size[2]))
    blocked = grown(blocked, max(1, round(centimetre(around.frame, max(size)) / cell)))  # things do not touch
    foot = np.maximum(np.ceil(2 * half / cell).astype(int), 1)  # cells of the footprint
    counts = [np.maximum(s - f + 1, 1) for s, f in zip(shape, foot, strict=True)]
    corner = np.stack(np.meshgrid(*(np.arange(c) for c in counts), indexing="ij"), axis=-1)
    centers = origin + (corner + foot / 2) * cell
    possible = (centers >= region.low - cell).all(axis=-1) & (centers <= region.high + cell).all(axis=-1)
    if region.surface is not None:
        carried = histogram(region.surface[:, :2], origin, cell, shape) > 0
        share = window_sum(grown(carried, _reach(region.surface, cell)).astype(np.int64), foot, counts)
        possible &= share / float(foot.prod()) >= _CARRIED
    else:
        low, high = around.bounds_for(size, basis[:2])
        placed = centers @ (np.array(around.room_axes[:2]) @ basis[:2].T).T
        possible &= ((placed >= low - cell) & (placed <= high + cell)).all(axis=-1)
    some = bool(possible.any())
    possible &= window_sum(blocked.astype(np.int64), foot, counts) == 0
    cost = np.where(possible, region.cost(centers), np.inf)
    cost = cost + _crowding(around, size, basis, centers, region.height, clear, anchors)
    best = np.unravel_index(int(np.argmin(cost)), cost.shape)
    if not np.isfinite(cost[best]):
        return None, some
    return centers[best] @ basis[:2] + region.height * around.up, some


def _reach(surface: Array, cell: float) -> int:
    """Cells by which points of a surface are grown so that they close: their spacing, but for sparse ones."""
    area = float(np.prod(np.ptp(surface[:, :2], axis=0))) if len(surface) > 1 else 0.0
    return int(np.clip(np.ceil((area / max(len(surface), 1)) ** 0.5 / cell), 1, 6))


def _clear(around: Surroundings, size: Vec3) -> float:
    """Height above the support below which points do not count: rugs, unevenness, the support's own thickness."""
    cm = centimetre(around.frame, max(size))
    return float(np.clip(0.15 * size[2], 0.5 * cm, 4 * cm))


def _occupied(
    around: Surroundings,
    basis: Array,
    origin: Array,
    cell: float,
    shape: NDArray[np.int_],
    heights: tuple[float, float],
) -> Bool:
    """Cells with a solid point in the height range; single points without any neighbour are floaters."""
    up = around.solid @ basis[2].astype(np.float32)
    points = around.solid[(up > heights[0]) & (up < heights[1])] @ basis[:2].T.astype(np.float32)
    counts = histogram(points.astype(np.float64), origin, cell, shape)
    nearby = window_sum(np.pad(counts, 1), np.array([3, 3]), list(shape))
    occupied: Bool = (counts > 0) & (nearby > 1)
    return occupied


def _crowding(
    around: Surroundings, size: Vec3, basis: Array, centers: Array, height: float, clear: float, anchors: Sequence[Body]
) -> Array:
    """A large cost where the box would stand in another object's box, though no point is there (under a table)."""
    total = np.zeros(centers.shape[:-1])
    own = {a.group for a in anchors if a.group >= 0} | around.moving_groups
    for box in [*(box for _, box in neighbours(around.scene, own)), *around.taken]:
        middle = float(np.array(box.center) @ basis[2])
        if middle - box.size[2] / 2 > height + size[2] or middle + box.size[2] / 2 < height + clear:
            continue
        reach = np.array([box.extent(a) for a in basis[:2]]) / 2 + np.array(size[:2]) / 2
        within = (np.abs(centers - basis[:2] @ np.array(box.center)) < 0.98 * reach).all(axis=-1)
        total += np.where(within, 1e3, 0.0)
    return total
