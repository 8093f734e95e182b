"""Where a placement allows the centre of a footprint, and what is best there: on, in, under, beside, between, against.

Knows what each relation means in numbers. Refuses to know whether a place is free (place.py), and how the things that a
placement names are found.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...gaussians.camera import Vec3
from ...gaussians.errors import InstructionError
from ...gaussians.world.box import Axes
from ...gaussians.world.relation_geometry import viewer_stand
from ...gaussians.world.relations import RelationKind, named
from ..operation import Placement
from .bodies import Array, Body, centimetre, front_of
from .occupancy import levels
from .surroundings import Surroundings

Cost = Callable[[Array], Array]  # plan positions `[..., 2]` to costs `[...]`
_ASIDE = 1.0  # how far off the asked direction, as a share of the way along it: 45 degrees, well within its cone


@dataclass(frozen=True)
class Region:
    """Where the centre of the footprint may be, and what is best there, on one support.

    Attributes:
        low, high: `[2]` bounds of the centre along the level axes, scene units.
        cost: `[..., 2]` plan positions to a cost `[...]`, infinite where forbidden.
        height: of the supporting surface.
        surface: `[M, 3]` local points of the supporting surface; None if it carries everywhere within bounds.
    """

    low: Array
    high: Array
    cost: Cost
    height: float
    surface: Array | None


def regions_of(
    around: Surroundings, size: Vec3, axes: Axes, place: Placement | None, anchors: Sequence[Body],
    start: Array | None,
) -> list[Region]:  # fmt: skip
    plan = np.array(axes[:2])
    if place is not None and place.offset is not None:
        start = _off(around, place.offset, anchors)
    if place is None or not anchors:
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


def _off(around: Surroundings, offset: tuple[float, float], anchors: Sequence[Body]) -> Array:
    """`[3]` a point that far from the middle of an anchor, or of the floor where there is none."""
    middle = sum(around.room_bounds) / 2 @ np.array(around.room_axes[:2]) if not anchors else anchors[0].center
    way = np.array(offset) / (around.frame.metres_per_unit or 1.0)
    return np.asarray(middle + way @ around.frame.basis()[:2])


def _room_region(around: Surroundings, size: Vec3, plan: Array, relation: str, start: Array | None) -> Region:
    room = np.array(around.room_axes[:2])
    low, high, to_room = *around.bounds_for(size, plan), room @ plan.T
    middle = (low + high) / 2
    wanted = room @ start if start is not None else middle
    costs: dict[str, Cost] = {
        "center": lambda p: far(p, middle),
        "corner": lambda p: np.asarray(4 * np.linalg.norm(np.minimum(p - low, high - p), axis=-1) + far(p, wanted)),
        "against": lambda p: 4 * _to_wall(around, p, low, high) + far(p, wanted),
    }

    def cost(p: Array) -> Array:
        local: Array = p @ to_room.T
        return costs[relation](local) if relation in costs else far(local, wanted)

    corners = np.array([[x, y] for x in (low[0], high[0]) for y in (low[1], high[1])]) @ to_room
    return Region(corners.min(axis=0), corners.max(axis=0), cost, around.floor + around.lift, None)


def _to_wall(around: Surroundings, p: Array, low: Array, high: Array) -> Array:
    """Distance of a footprint from the nearest wall, or from the wall behind it."""
    if around.back is None:
        return np.asarray(np.minimum(p - low, high - p).min(axis=-1))
    way = np.array(around.room_axes[:2]) @ around.back
    return np.asarray(np.where(way > 0, high - p, p - low) @ np.abs(way))


def _top_regions(
    around: Surroundings, size: Vec3, plan: Array, anchor: Body, relation: str, start: Array | None
) -> list[Region]:
    points = around.points_of(anchor)
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
        return far(p, target)

    regions = []
    for level, near in levels(points @ around.up, local, around.tolerance(anchor)):
        surface = np.column_stack([local[near], np.full(int(near.sum()), level)])
        regions.append(Region(low, high, _within(anchor, plan, cost), level, surface))
    return regions


def _inner_regions(around: Surroundings, size: Vec3, plan: Array, anchor: Body) -> list[Region]:
    points = around.points_of(anchor)
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
        cost = _within(anchor, plan, lambda p: far(p, middle))
        regions.append(Region(low, high, cost, level, surface))
    return regions


def _under_region(around: Surroundings, plan: Array, anchor: Body) -> Region:
    local = around.points_of(anchor) @ plan.T
    low, high = np.quantile(local, [0.01, 0.99], axis=0)
    middle = (low + high) / 2
    height, surface = around.base_under(anchor, plan)
    return Region(low, high, _within(anchor, plan, lambda p: far(p, middle)), height, surface)


def _within(anchor: Body, plan: Array, cost: Cost) -> Cost:
    """A cost that forbids what is outside the anchor's own footprint (which need not run along `plan`)."""
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
    return Region(middle - reach, middle + reach, lambda p: far(p, middle), height, surface)


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
            return np.where(across > _ASIDE * along, np.inf, total + across)
        return np.asarray(total + 0.3 * (np.linalg.norm(offset, axis=-1) - along))

    return Region(center - reach, center + reach, cost, height, surface)


def _wanted_side(around: Surroundings, anchor: Body, plan: Array, kind: RelationKind, start: Array | None) -> Array:
    """`[2]` unit: the side that was asked for, or the side the thing is on, or the viewer's right.

    Opposite a thing that faces nowhere is on the viewer's side of it.
    """
    front = front_of(around.scene, anchor) if kind.own_frame else None
    viewer = viewer_stand(around.context.viewer, around.frame.up_vector, 1.0)
    direction = viewer.side(kind.aim or (1.0, 0.0)) if front is None else front
    if kind.aim is None and start is not None:
        direction = start - anchor.center
    level = plan @ direction
    length = float(np.linalg.norm(level))
    return level / length if length > 1e-9 else np.array([1.0, 0.0])


def far(p: Array, wanted: Array) -> Array:
    return np.asarray(np.linalg.norm(p - wanted, axis=-1))
