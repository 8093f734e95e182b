"""The regions and costs of placements: where each relation allows the centre of a footprint, and what is best there.

Whether a position in a region is free is decided in place.py.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...gaussians.camera import Vec3
from ...gaussians.errors import InstructionError
from ...gaussians.language.field.measure import solid_points
from ...gaussians.world.box import Axes
from ...gaussians.world.relation_geometry import viewer_stand
from ...gaussians.world.relations import RelationKind, named
from ..operation import Placement
from .bodies import Array, Body, centimetre, front_of
from .occupancy import surface_heights
from .surroundings import Surroundings

Cost = Callable[[Array], Array]  # plan positions `[..., 2]` to costs `[...]`
# Largest offset across the requested direction, as a share of that along it: 45 degrees, within the relation's cone.
_MAX_LATERAL = 1.0
_FEW = 20  # points that make no surface


@dataclass(frozen=True)
class Region:
    """Allowed positions for the centre of a footprint on one support, and their cost.

    Attributes:
        low, high: `[2]` bounds of the centre along the horizontal axes, scene units.
        cost: `[..., 2]` plan positions to a cost `[...]`, infinite where forbidden.
        height: of the supporting surface, along up.
        surface: `[M, 3]` local points of the supporting surface; None if all of the bounds are supported.
        walled: whether the thing stays in the room; else anywhere, as where no room was seen.
        beside: whether the region is around a thing and not on or in it: any other surface there will do.
    """

    low: Array
    high: Array
    cost: Cost
    height: float
    surface: Array | None
    walled: bool = True
    beside: bool = False


def regions_of(
    around: Surroundings, size: Vec3, axes: Axes, place: Placement | None, anchors: Sequence[Body],
    start: Array | None,
) -> list[Region]:  # fmt: skip
    plan = np.array(axes[:2])
    if place is not None and place.offset is not None:
        start = _offset_point(around, place.offset, anchors)
    if place is None or not anchors:
        if place is not None and place.corner is not None:
            return [_corner_region(around, size, plan, place.corner)]
        return [_room_region(around, size, plan, place.relation if place is not None else "on", start)]
    kind, anchor = named(place.relation), anchors[0]
    if kind.region == "top":
        return _top_regions(around, size, plan, anchor, kind.name, start)
    if kind.region == "inside":
        return _inner_regions(around, size, plan, anchor)
    if kind.region == "under":
        return [_under_region(around, plan, anchor)]
    if kind.region == "between":
        if len(anchors) < 2:
            raise InstructionError(f"'{kind.name}' needs two things: name both")
        return [_between_region(around, size, plan, anchors[0], anchors[1])]
    if kind.region == "across":
        middle = sum(around.room_bounds) / 2 @ np.array(around.room_axes[:2])
        return [_room_region(around, size, plan, "on", 2 * middle - anchor.center)]
    return [beside_region(around, size, plan, anchor, kind, start)]


def _offset_point(around: Surroundings, offset: tuple[float, float], anchors: Sequence[Body]) -> Array:
    """`[3]` the point at an offset in metres from the middle of an anchor, or of the floor if there is no anchor."""
    middle = sum(around.room_bounds) / 2 @ np.array(around.room_axes[:2]) if not anchors else anchors[0].center
    way = np.array(offset) / (around.frame.metres_per_unit or 1.0)
    return np.asarray(middle + way @ around.frame.basis()[:2])


def _room_region(around: Surroundings, size: Vec3, plan: Array, relation: str, start: Array | None) -> Region:
    room = np.array(around.room_axes[:2])
    low, high, to_room = *around.bounds_for(size, plan), room @ plan.T
    middle = (low + high) / 2
    wanted = room @ start if start is not None else middle
    costs: dict[str, Cost] = {
        "center": lambda p: distance_to(p, middle),
        "corner": lambda p: np.asarray(
            4 * np.linalg.norm(np.minimum(p - low, high - p), axis=-1) + distance_to(p, wanted)
        ),
        "against": lambda p: 4 * _wall_distance(around, p, low, high) + distance_to(p, wanted),
    }

    def cost(p: Array) -> Array:
        local: Array = p @ to_room.T
        return costs[relation](local) if relation in costs else distance_to(local, wanted)

    corners = np.array([[x, y] for x in (low[0], high[0]) for y in (low[1], high[1])]) @ to_room
    return Region(corners.min(axis=0), corners.max(axis=0), cost, around.floor + around.lift, None)


def _corner_region(around: Surroundings, size: Vec3, plan: Array, corner: str) -> Region:
    """The floor, the best place the nearest to a corner of the room that the viewer names ("back left")."""
    room = np.array(around.room_axes[:2])
    low, high, to_room = *around.bounds_for(size, plan), room @ plan.T
    stand = viewer_stand(around.context.viewer, around.frame.up_vector, 1.0)
    depth, side = corner.split()
    way = (stand.forward if depth == "back" else -stand.forward) + (stand.right if side == "right" else -stand.right)
    wanted = np.where(room @ way > 0, high, low)

    def cost(p: Array) -> Array:
        return distance_to(p @ to_room.T, wanted)

    corners = np.array([[x, y] for x in (low[0], high[0]) for y in (low[1], high[1])]) @ to_room
    return Region(corners.min(axis=0), corners.max(axis=0), cost, around.floor + around.lift, None)


def _wall_distance(around: Surroundings, p: Array, low: Array, high: Array) -> Array:
    """Distance of a footprint from the wall behind it, or from the nearest wall if its back is not known."""
    if around.back is None:
        return np.asarray(np.minimum(p - low, high - p).min(axis=-1))
    way = np.array(around.room_axes[:2]) @ around.back
    return np.asarray(np.where(way > 0, high - p, p - low) @ np.abs(way))


def _top_regions(
    around: Surroundings, size: Vec3, plan: Array, anchor: Body, relation: str, start: Array | None
) -> list[Region]:
    points = solid_points(around.scene.cloud, anchor.rows)
    local = points @ plan.T
    low, high = np.quantile(local, [0.01, 0.99], axis=0)
    middle = (low + high) / 2
    wanted = plan @ start if start is not None else middle
    inside_start = bool(((wanted >= low) & (wanted <= high)).all())
    target = wanted if inside_start and relation == "on" else middle
    half = np.array(size[:2]) / 2

    def cost(p: Array) -> Array:
        if relation == "corner":
            return np.asarray(np.linalg.norm(np.minimum(p - low - half, high - half - p), axis=-1))
        return distance_to(p, target)

    regions = []
    for level, near in surface_heights(points @ around.up, local, around.tolerance(anchor)):
        surface = np.column_stack([local[near], np.full(int(near.sum()), level)])
        regions.append(Region(low, high, _within(anchor, plan, cost), level, surface))
    return regions


def _inner_regions(around: Surroundings, size: Vec3, plan: Array, anchor: Body) -> list[Region]:
    points = solid_points(around.scene.cloud, anchor.rows)
    local, heights = points @ plan.T, points @ around.up
    half = np.array(size[:2]) / 2
    low, high = local.min(axis=0) + half, local.max(axis=0) - half
    if (low > high).any():
        raise InstructionError(f"it does not fit inside {anchor.label or 'that'}: its footprint is too large")
    middle = (low + high) / 2
    tolerance = around.tolerance(anchor)
    counts, edges = np.histogram(heights, bins=max(8, int(np.ptp(heights) / max(2 * tolerance, 1e-9))))
    order = [
        i for i in np.argsort(-counts, kind="stable")[:12] if edges[i] + size[2] < anchor.box.top(around.up) + tolerance
    ]
    regions = []
    for i in order or [int(np.argmax(counts))]:
        near = (heights >= edges[i]) & (heights <= edges[i + 1])
        level = float(np.quantile(heights[near], 0.9)) if near.any() else anchor.box.bottom(around.up)
        surface = np.column_stack([local[near], np.full(int(near.sum()), level)])
        cost = _within(anchor, plan, lambda p: distance_to(p, middle))
        regions.append(Region(low, high, cost, level, surface))
    return regions


def _under_region(around: Surroundings, plan: Array, anchor: Body) -> Region:
    local = solid_points(around.scene.cloud, anchor.rows) @ plan.T
    low, high = np.quantile(local, [0.01, 0.99], axis=0)
    middle = (low + high) / 2
    height, surface = around.base_under(anchor, plan)
    return Region(low, high, _within(anchor, plan, lambda p: distance_to(p, middle)), height, surface)


def _within(anchor: Body, plan: Array, cost: Cost) -> Cost:
    """The cost, infinite outside the anchor's own footprint (whose axes may differ from `plan`)."""
    axes, half = np.array(anchor.box.axes[:2]), np.array(anchor.box.size[:2]) / 2
    turn, middle = axes @ plan.T, axes @ anchor.center

    def bounded(p: Array) -> Array:
        inside = (np.abs(p @ turn.T - middle) <= half).all(axis=-1)
        return np.asarray(np.where(inside, cost(p), np.inf))

    return bounded


def _between_region(around: Surroundings, size: Vec3, plan: Array, first: Body, second: Body) -> Region:
    a, b = plan @ first.center, plan @ second.center
    middle, reach = (a + b) / 2, max(float(np.linalg.norm(b - a)) / 2, max(size[:2]))
    lower = min(first, second, key=lambda body: body.box.bottom(around.up))
    height, surface = around.base_under(lower, plan)
    return Region(middle - reach, middle + reach, lambda p: distance_to(p, middle), height, surface, beside=True)


def beside_region(
    around: Surroundings, size: Vec3, plan: Array, anchor: Body, kind: RelationKind, start: Array | None
) -> Region:
    center = plan @ anchor.center
    anchor_half = np.array([anchor.box.extent(a) for a in plan]) / 2
    half = np.array(size[:2]) / 2
    gap = 100 * kind.gap * centimetre(around.frame, max(anchor.box.size))
    reach = anchor_half + half + gap + 0.75 * max(*anchor.box.size[:2], *size[:2])
    wanted = _wanted_side(around, anchor, plan, kind, start)
    height, surface = around.base_under(anchor, plan)

    def cost(p: Array) -> Array:
        apart = np.abs(p - center) - anchor_half - half
        clear = apart.max(axis=-1)
        lateral = np.linalg.norm(np.maximum(apart, 0), axis=-1)
        total = np.where(clear < gap * 0.5 - 1e-9, np.inf, 2 * np.abs(lateral - gap))
        offset = p - center
        along = offset @ wanted
        across = np.linalg.norm(offset - along[..., None] * wanted, axis=-1)
        if kind.aim:
            return np.where(across > _MAX_LATERAL * along, np.inf, total + across)
        return np.asarray(total + 0.3 * (np.linalg.norm(offset, axis=-1) - along))

    return Region(center - reach, center + reach, cost, height, surface, beside=True)


def other_supports(around: Surroundings, size: Vec3, plan: Array, region: Region) -> list[Region]:
    """A region around a thing on other surfaces than the one that the thing stands on: those below it that were seen
    there, the highest first, then the floor, whether or not a room was seen around it.

    What may hang in the air, as a copy of something that does, goes no lower than its own height: else it is level.
    """
    half = np.array(size[:2]) / 2
    slack = max(5 * centimetre(around.frame, max(size)), 0.02 * max(size))
    level = around.solid[around.heights < region.height + slack]
    local = level @ plan.T.astype(np.float32)
    near = ((local > region.low - half) & (local < region.high + half)).all(axis=1)
    points, found = local[near].astype(np.float64), list[Region]()
    tops = (level[near] @ around.up.astype(np.float32)).astype(np.float64)
    lowest = around.floor if around.frame.floor is not None else -np.inf
    if not around.rests:
        lowest = max(lowest, region.height - size[2] - slack)
    if len(points) >= _FEW:
        for height, at in surface_heights(tops, points, slack / 2):
            if height > lowest + slack and at.sum() >= _FEW:
                surface = np.column_stack([points[at], tops[at]])
                found.append(replace(region, height=height, surface=surface))
    found.sort(key=lambda r: -r.height)
    under = around.floor if around.frame.floor is not None and lowest == around.floor else region.height
    return [*found, replace(region, height=min(under, region.height), surface=None, walled=False)]


def _wanted_side(around: Surroundings, anchor: Body, plan: Array, kind: RelationKind, start: Array | None) -> Array:
    """`[2]` unit vector to the requested side, else to the side the thing is on now, else to the viewer's right.
    "Opposite" a thing whose front is unknown is on the viewer's side of it."""
    front = front_of(around.scene, anchor) if kind.own_frame else None
    viewer = viewer_stand(around.context.viewer, around.frame.up_vector, 1.0)
    direction = viewer.side(kind.aim or (1.0, 0.0)) if front is None else front
    if kind.aim is None and start is not None:
        direction = start - anchor.center
    level = plan @ direction
    length = float(np.linalg.norm(level))
    return level / length if length > 1e-9 else np.array([1.0, 0.0])


def distance_to(p: Array, wanted: Array) -> Array:
    return np.asarray(np.linalg.norm(p - wanted, axis=-1))
