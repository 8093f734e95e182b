"""Find a free, supported spot that fulfils a placement, by a search over a grid on the supporting surface.

The search is exhaustive. A cell is possible if the thing's footprint around it lies on the support, stays within the
allowed region and meets no solid point up to the thing's height. The possible cell of the lowest cost is chosen.
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
from .bodies import Array, Body, bodies_of, centimetre, neighbours, told_length
from .occupancy import Bool, dilated, histogram, window_sum
from .regions import Region, beside_region, distance_to, other_supports, regions_of
from .surroundings import FLOOR_WORDS, Surroundings

_CELLS = 220  # most cells along a side of the grid
_FOOT_CELLS = 10  # cells along the shorter side of a footprint, unless the region is too large for that
_ASIDE = 0.3  # of the longer side of what is replaced: how far aside the new thing may stand in a capture
_CROWDED = 0.4  # share of the footprint of what replaces a thing that others may reach into
_CRAMPED = 0.12  # likewise, of what is put into a capture that has no free place for it
_NEAR_BY = 0.5  # of its height: how much lower a free spot may be before a crowded one is better
_LEAST_SUPPORTED = 0.4  # likewise, of its footprint that must lie over the support
_MIN_SUPPORTED = 0.75  # share of the footprint that must lie over the support's surface
_CLEARANCE = 0.15  # of a thing's height, up to which points are ignored
_HAZE = 0.1  # of the points of as much floor of a capture: fewer over it are noise and no thing
_IN_BOX = 0.5  # of its size: what it costs a thing in a capture to stand in another's box
_PLACES = 1_500  # on a floor that are looked at
_FAR = 3.0  # of a room's extent: what a place on its floor costs that nobody sees
_CORNER, _UNDER = 0.45, 0.3  # of a thing's sides: where its corners stand, and how far the floor may be from one
_FLOOR_SEEN, _FLOOR_POINTS = 200, 8_000  # points of a floor that was seen, and most that are compared
WALL_WORDS = frozenset({"wall", "walls"})


@dataclass(frozen=True)
class Spot:
    """A free spot.

    Attributes:
        foot: position of the centre of the underside, world frame, scene units.
        support: height along up of the surface there.
        axes: of the box that the search assumed; horizontal axes and up.
        notes: for the receipt.
        touches: whether other things reach into its place, as no free one is near; the notes tell.
    """

    foot: Array
    support: float
    axes: Axes
    notes: tuple[str, ...] = ()
    touches: bool = False


def anchors_of(around: Surroundings, place: Placement) -> list[Body]:
    """The things that a placement names, resolved; empty if it is relative to the room itself.

    Raises:
        AbsentError, AmbiguousError: an anchor is not in the scene or not unique.
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
    """A free spot for a box of `size` along `axes`.

    Args:
        start: present or expected position of the thing; ties are broken toward it.

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
    for region in regions:
        if (spot := _elsewhere(around, size, axes, region, anchors)) is not None:
            return spot
    for region in regions if around.sight is not None else ():
        foot, _ = _search(around, size, axes, region, anchors, _CRAMPED)
        if foot is not None:
            return Spot(foot, region.height, axes, ("there is little room: it touches what stands around it",), True)
    why = "everything there is taken" if crowded else "there is no surface there large enough to carry it"
    raise InstructionError(f"there is no room {where}: {why}; make it smaller, clear a spot or name another place")


def hanging_spot(around: Surroundings, size: Vec3, place: Placement, region: Region, axes: Axes) -> Spot:
    """A free spot in a region where a thing hangs (see overhead.py).

    Raises:
        InstructionError: there is none.
    """
    return _spot_in(around, size, axes, region, place.describe())


def spot_beside(around: Surroundings, body: Body) -> Spot:
    """A free spot next to a thing for a copy of it.

    Raises:
        InstructionError: there is none.
    """
    region = beside_region(around, body.box.size, np.array(body.box.axes[:2]), body, named("next_to"), None)
    return _spot_in(around, body.box.size, body.box.axes, region, f"next to the {body.label or 'thing'}")


def spot_near(around: Surroundings, size: Vec3, axes: Axes, body: Body) -> Spot:
    """The spot of a thing that is removed, or the nearest free one on the same support.

    In a scene of unknown scale, which is a capture, remains and neighbours hardly leave an old place free: what is not
    near it is not taken.

    Raises:
        InstructionError: there is none within its own size.
    """
    plan = np.array(axes[:2])
    middle, reach = plan @ body.center, 0.75 * np.array(size[:2]) + 0.5 * max(body.box.size[:2])
    height, surface = around.base_under(body, plan)
    if surface is not None:  # the surface it covered counts as support too, though no camera saw it
        under = np.stack(np.meshgrid(*[np.linspace(-0.5, 0.5, 15)] * 2), axis=-1).reshape(-1, 2)
        extents = np.array([body.box.extent(a) for a in plan])
        covered = np.column_stack([middle + under * extents, np.full(len(under), height)])
        surface = np.concatenate([surface, covered])
    region = Region(middle - reach, middle + reach, lambda p: distance_to(p, middle), height, surface, beside=True)
    where = f"where the {body.label or 'thing'} stands"
    if around.frame.metres_per_unit is not None:
        return _spot_in(around, size, axes, region, where, _CROWDED)
    try:
        spot: Spot | None = _spot_in(around, size, axes, region, where, _CROWDED)
    except InstructionError:
        spot = None
    if spot is not None and distance_to((plan @ spot.foot)[None], middle)[0] <= _ASIDE * max(body.box.size[:2]):
        return spot
    foot = body.foot(around.up) + around.up * (height - float(body.foot(around.up) @ around.up))
    return Spot(foot, height, axes, ("there is little room: it touches what stands around it",), True)


def _spot_in(around: Surroundings, size: Vec3, axes: Axes, region: Region, where: str, most_taken: float = 0.0) -> Spot:
    """A free spot in a region, or one of whose footprint at most the share `most_taken` is taken by others."""
    foot, crowded = _search(around, size, axes, region, ())
    if foot is not None:
        return Spot(foot, region.height, axes)
    spot = _elsewhere(around, size, axes, region, ())
    near = spot is not None and region.height - spot.support <= _NEAR_BY * size[2]
    if most_taken and not near:
        foot, _ = _search(around, size, axes, region, (), most_taken)
        if foot is not None:
            return Spot(foot, region.height, axes, ("there is little room: it touches what stands around it",), True)
    if spot is not None:
        return spot
    why = "everything there is taken" if crowded else "no surface there is large enough to carry it"
    raise InstructionError(f"there is no room {where}: {why}; clear a spot or name another place")


def _elsewhere(around: Surroundings, size: Vec3, axes: Axes, region: Region, anchors: Sequence[Body]) -> Spot | None:
    """A spot around a thing whose own support has no room: on a surface below it, or on the floor; None if there is
    none, or the region is on or in a thing.

    Where no floor was seen either, it is at the height of the thing's underside, which the note tells.
    """
    if not region.beside:
        return None
    for other in other_supports(around, size, np.array(axes[:2]), region):
        foot, _ = _search(around, size, axes, other, anchors)
        if foot is None:
            continue
        drop = region.height - other.height
        if other.surface is not None:
            notes = (f"it stands {told_length(around.frame, drop)} lower, on what was seen there",) if drop > 0 else ()
        elif around.frame.floor is not None and other.height == around.floor:
            notes = ("no room was seen around it: it stands on the floor",)
        else:
            notes = ("nothing was seen there to carry it: it is level with what it was put beside",)
        return Spot(foot, other.height, axes, notes)
    return None


def _search(
    around: Surroundings, size: Vec3, axes: Axes, region: Region, anchors: Sequence[Body], most_taken: float = 0.0
) -> tuple[Array | None, bool]:
    """The best foot position on one support (None if there is none), and whether the support alone allowed one; of the
    footprint at most the share `most_taken` may be taken."""
    basis = np.array(axes)
    half = np.array(size[:2]) / 2
    span = np.maximum(region.high - region.low, 0) + 2 * half
    cell = max(float(min(size[:2])) / _FOOT_CELLS, float(span.max()) / _CELLS, 1e-9)
    shape = np.maximum(np.ceil(span / cell).astype(int) + 1, 1)
    origin = region.low - half
    clear = _clearance(around, size)
    blocked = _occupied(around, basis, origin, cell, shape, (region.height + clear, region.height + size[2]))
    if around.sight is None:  # noise has widened what captures show already
        blocked = dilated(blocked, max(1, round(centimetre(around.frame, max(size)) / cell)))  # things do not touch
    foot = np.maximum(np.ceil(2 * half / cell).astype(int), 1)  # cells of the footprint
    counts = [np.maximum(s - f + 1, 1) for s, f in zip(shape, foot, strict=True)]
    corner = np.stack(np.meshgrid(*(np.arange(c) for c in counts), indexing="ij"), axis=-1)
    centers = origin + (corner + foot / 2) * cell
    possible = (centers >= region.low - cell).all(axis=-1) & (centers <= region.high + cell).all(axis=-1)
    if region.surface is not None:
        carried = histogram(region.surface[:, :2], origin, cell, shape) > 0
        share = window_sum(dilated(carried, _closing_cells(region.surface, cell)).astype(np.int64), foot, counts)
        possible &= share / float(foot.prod()) >= (_LEAST_SUPPORTED if most_taken else _MIN_SUPPORTED)
    elif region.walled:
        low, high = around.bounds_for(size, basis[:2])
        placed = centers @ (np.array(around.room_axes[:2]) @ basis[:2].T).T
        possible &= ((placed >= low - cell) & (placed <= high + cell)).all(axis=-1)
    some = bool(possible.any())
    taken = window_sum(blocked.astype(np.int64), foot, counts) / float(foot.prod())
    possible &= taken <= most_taken
    cost = np.where(possible, region.cost(centers) + 2 * max(size[:2]) * taken, np.inf)
    if around.sight is not None and possible.any():
        cost = cost + _hidden_cost(around, size, basis, centers, region, possible)
    cost = cost + _overlap_cost(around, size, basis, centers, region.height, clear, anchors)
    best = np.unravel_index(int(np.argmin(cost)), cost.shape)
    if not np.isfinite(cost[best]):
        return None, some
    return centers[best] @ basis[:2] + region.height * around.up, some


def _hidden_cost(
    around: Surroundings, size: Vec3, basis: Array, centers: Array, region: Region, possible: Bool
) -> Array:
    """A cost for places of a capture that its pictures do not show: large on the floor of a room, where any place will
    do, small beside and on a thing."""
    from scipy.spatial import cKDTree

    assert around.sight is not None
    open_floor = region.walled and region.surface is None and not region.beside
    weight = _FAR * float(np.linalg.norm(region.high - region.low)) if open_floor else _ASIDE * max(size[:2])
    cost = np.zeros(possible.shape)
    chosen = np.argwhere(possible)
    step = max(1, len(chosen) // _PLACES) if open_floor else 1
    chosen = chosen[::step]
    if step > 1:
        cost[possible] = np.inf
    places = centers[tuple(chosen.T)]
    feet = places @ basis[:2] + region.height * around.up
    hidden = around.sight.hidden(feet, around.up, size[2])
    if open_floor and len(floor := around.floor_points) >= _FLOOR_SEEN:
        tree = cKDTree(floor[:: max(1, len(floor) // _FLOOR_POINTS)] @ basis[:2].T.astype(np.float32))
        # All of its corners stand on the floor, and not beyond its edge.
        for corner in np.array([[0, 0], [1, 1], [1, -1], [-1, 1], [-1, -1]]) * np.array(size[:2]) * _CORNER:
            hidden = hidden + (tree.query(places + corner)[0] > _UNDER * max(size[:2]))
    cost[tuple(chosen.T)] = weight * hidden
    return cost


def _closing_cells(surface: Array, cell: float) -> int:
    """Cells by which a surface's points are dilated to close its gaps: their mean spacing, between 1 and 6 cells."""
    area = float(np.prod(np.ptp(surface[:, :2], axis=0))) if len(surface) > 1 else 0.0
    return int(np.clip(np.ceil((area / max(len(surface), 1)) ** 0.5 / cell), 1, 6))


def _clearance(around: Surroundings, size: Vec3) -> float:
    """Height above the support up to which points are ignored: rugs, unevenness, the support's own thickness."""
    cm = centimetre(around.frame, max(size))
    most = _CLEARANCE * size[2] if around.sight is not None else 4 * cm  # floors of captures are noisy
    return float(np.clip(_CLEARANCE * size[2], 0.5 * cm, most))


def _occupied(
    around: Surroundings,
    basis: Array,
    origin: Array,
    cell: float,
    shape: NDArray[np.int_],
    heights: tuple[float, float],
) -> Bool:
    """Cells with a solid point in the height range; single points without a neighbour are ignored as floaters."""
    level = np.flatnonzero((around.heights > heights[0]) & (around.heights < heights[1]))
    for axis, low, high in zip(basis[:2].astype(np.float32), origin - cell, origin + (shape + 1) * cell, strict=True):
        place = around.solid[level] @ axis
        level = level[(place > low) & (place < high)]
    points = around.solid[level] @ basis[:2].T.astype(np.float32)
    counts = histogram(points.astype(np.float64), origin, cell, shape)
    nearby = window_sum(np.pad(counts, 1), np.array([3, 3]), list(shape))
    occupied: Bool = (counts > 0) & (nearby > max(1.0, _HAZE * 9 * cell**2 * around.floor_density))
    return occupied


def _overlap_cost(
    around: Surroundings, size: Vec3, basis: Array, centers: Array, height: float, clear: float, anchors: Sequence[Body]
) -> Array:
    """A large cost where the box would overlap another object's box, though no point is there (under a table)."""
    total = np.zeros(centers.shape[:-1])
    # Things of captures are found in pieces and with strays: their boxes reach over free floor, and points tell more.
    weight = 1e3 if around.sight is None else _IN_BOX * max(size)
    own = {a.group for a in anchors if a.group >= 0} | around.moving_groups
    for box in [*(box for _, box in neighbours(around.scene, own)), *around.placed]:
        middle = float(np.array(box.center) @ basis[2])
        if middle - box.size[2] / 2 > height + size[2] or middle + box.size[2] / 2 < height + clear:
            continue
        reach = np.array([box.extent(a) for a in basis[:2]]) / 2 + np.array(size[:2]) / 2
        within = (np.abs(centers - basis[:2] @ np.array(box.center)) < 0.98 * reach).all(axis=-1)
        total += np.where(within, weight, 0.0)
    return total
