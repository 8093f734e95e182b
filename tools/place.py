"""Where to put something: a free, supported spot that fulfils a placement, found on a grid over the support.

Knows geometry. Refuses to know what is being placed beyond its box. One exact search over a grid replaces trial and
error: a cell is possible when the thing's footprint around it is carried by the support, stays within the allowed
region and meets no solid point up to the thing's height; of the possible cells the one nearest to what was asked wins.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..gaussians.camera import Vec3
from ..gaussians.errors import InstructionError
from ..gaussians.language.field import Box
from ..gaussians.scene import Frame, Scene
from .base import Context, Direction, Placement
from .grid import Bool, grown, histogram, levels, obstacle_points, window_sum
from .measure import OPAQUE
from .space import Array, Body, as_vec, bodies_of, centimetre, extent_along, heading, neighbours

Cost = Callable[[Array], Array]  # plan positions `[..., 2]` to costs `[...]`
_SAMPLE = 50_000  # points on which extents of the room are measured
_CELLS = 220  # most cells along a side of the grid
_FOOT_CELLS = 10  # cells along the shorter side of a footprint, if the region is small enough
_CARRIED = 0.75  # share of the footprint that must lie over the support's surface
FLOOR_WORDS = frozenset({"floor", "ground", "carpet", "room"})
WALL_WORDS = frozenset({"wall", "walls"})
SIDES: dict[str, Direction] = {"left_of": "left", "right_of": "right", "in_front_of": "backward", "behind": "forward"}


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
    axes: tuple[Vec3, Vec3, Vec3]
    notes: tuple[str, ...] = ()


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


@dataclass(eq=False)
class Placer:
    """Finds spots in one scene for one viewer; what was placed before counts as taken once it is given to `take`.

    Attributes:
        scene: with everything in it that may be in the way.
        context: viewer and resolver.
        moving: `[N]` bool, Gaussians that are being moved and so are not in the way.
        moving_groups: their groups.
        back: `[3]` where the thing's back points, which "against a wall" then brings to the wall; None takes any side.
        lift: height above the floor of what hangs on a wall or from the ceiling, scene units.
    """

    scene: Scene
    context: Context
    moving: Tensor | None = None
    moving_groups: frozenset[int] = frozenset()
    back: Array | None = None
    lift: float = 0.0
    taken: list[Box] = field(default_factory=list)

    @cached_property
    def frame(self) -> Frame:
        return self.scene.frame

    @cached_property
    def up(self) -> Array:
        return self.frame.up_vector

    @cached_property
    def solid(self) -> NDArray[np.float32]:
        """`[M, 3]` world points one could bump into."""
        return obstacle_points(self.scene.cloud, self.moving)

    def take(self, points: Array, box: Box) -> None:
        """From now on these world points `[M, 3]` and this box are in the way, too."""
        self.solid = np.concatenate([self.solid, points.astype(np.float32)])
        self.taken.append(box)

    @cached_property
    def thin(self) -> NDArray[np.float32]:
        """An even sample of the solid points, for extents and middles."""
        return self.solid[:: max(1, len(self.solid) // _SAMPLE)]

    @cached_property
    def room_axes(self) -> tuple[Vec3, Vec3, Vec3]:
        """Level axes of the floor if the field knows it, else of the frame."""
        if self.scene.language is not None:
            floors = [g for g in self.scene.language.groups if g.level == "structure" and g.label in FLOOR_WORDS]
            if floors:
                return max(floors, key=lambda g: g.box.size[0] * g.box.size[1]).box.axes
        east, north, up = self.frame.basis()
        return as_vec(east), as_vec(north), as_vec(up)

    @cached_property
    def floor(self) -> float:
        """Height of the floor along up; where the frame has none, the lowest height that much of the scene lies at."""
        if self.frame.floor is not None:
            return self.frame.floor
        heights = self.thin @ self.up.astype(np.float32)
        if not len(heights):
            return 0.0
        low, high = np.quantile(heights, [0.005, 0.6])
        counts, edges = np.histogram(heights, bins=60, range=(float(low), float(high) + 1e-9))
        lowest = int(np.argmax(counts >= 0.5 * counts.max()))
        return float((edges[lowest] + edges[lowest + 1]) / 2)

    def anchors(self, place: Placement) -> list[Body]:
        """The things a placement names, resolved; empty if it is about the room itself.

        Raises:
            AbsentError, AmbiguousError: an anchor is not there or not unique.
        """
        found: list[Body] = []
        for query in place.anchors:
            word = query.text.lower()
            room = place.relation in ("on", "center", "corner") and word in FLOOR_WORDS
            if room or (place.relation == "against" and word in WALL_WORDS):
                continue
            selection = self.context.resolve(self.scene, query).require()
            found.extend(bodies_of(self.scene, selection))
        return found

    def find(self, size: Vec3, axes: tuple[Vec3, Vec3, Vec3], place: Placement | None, start: Array | None) -> Spot:
        """A spot for a box of `size` along `axes`.

        Args:
            start: where the thing is now, or where one would expect it; ties are broken toward it.

        Raises:
            InstructionError: there is no free spot; the message says what is in the way.
        """
        anchors = self.anchors(place) if place is not None else []
        regions = self._regions(size, axes, place, anchors, start)
        crowded = False
        for region in regions:
            foot, blocked = self._search(size, axes, region, anchors)
            if foot is not None:
                return Spot(foot, region.height, axes)
            crowded |= blocked
        where = place.describe() if place is not None else "on the floor"
        why = "everything there is taken" if crowded else "there is no surface there large enough to carry it"
        raise InstructionError(f"there is no room {where}: {why}; make it smaller, clear a spot or name another place")

    def beside(self, body: Body) -> Spot:
        """A free spot next to a thing for another like it.

        Raises:
            InstructionError: there is none.
        """
        region = self._beside_region(body.box.size, np.array(body.box.axes[:2]), body, "next_to", None)
        return self._only(body.box.size, body.box.axes, region, f"next to the {body.label or 'thing'}")

    def near(self, size: Vec3, axes: tuple[Vec3, Vec3, Vec3], body: Body) -> Spot:
        """Where a thing that goes away stands, or the free spot nearest to it, on what it stands on.

        Raises:
            InstructionError: there is none within its own size.
        """
        plan = np.array(axes[:2])
        middle, reach = plan @ body.center, 0.75 * np.array(size[:2]) + 0.5 * max(body.box.size[:2])
        height, surface = self._base(body, plan)
        if surface is not None:  # what it covered carries, too, though nothing of it was ever seen
            under = np.stack(np.meshgrid(*[np.linspace(-0.5, 0.5, 15)] * 2), axis=-1).reshape(-1, 2)
            extents = np.array([extent_along(body.box, a) for a in plan])
            covered = np.column_stack([middle + under * extents, np.full(len(under), height)])
            surface = np.concatenate([surface, covered])
        region = Region(middle - reach, middle + reach, lambda p: _far(p, middle), height, surface)
        return self._only(size, axes, region, f"where the {body.label or 'thing'} stands")

    def _only(self, size: Vec3, axes: tuple[Vec3, Vec3, Vec3], region: Region, where: str) -> Spot:
        foot, crowded = self._search(size, axes, region, ())
        if foot is None:
            why = "everything there is taken" if crowded else "no surface there is large enough to carry it"
            raise InstructionError(f"there is no room {where}: {why}; clear a spot or name another place")
        return Spot(foot, region.height, axes)

    # -- regions ----------------------------------------------------------------------------------------------------

    def _regions(
        self, size: Vec3, axes: tuple[Vec3, Vec3, Vec3], place: Placement | None, anchors: Sequence[Body],
        start: Array | None,
    ) -> list[Region]:  # fmt: skip
        plan = np.array(axes[:2])
        if place is None or not anchors:
            return [self._room_region(size, plan, place.relation if place is not None else "on", start)]
        relation, anchor = place.relation, anchors[0]
        if relation in ("on", "center", "corner"):
            return self._top_regions(size, plan, anchor, relation, start)
        if relation == "inside":
            return self._inner_regions(size, plan, anchor)
        if relation == "under":
            return [self._under_region(plan, anchor)]
        if relation == "between":
            if len(anchors) < 2:
                raise InstructionError("'between' needs two things: name both")
            return [self._between_region(size, plan, anchors[0], anchors[1])]
        return [self._beside_region(size, plan, anchor, relation, start)]

    def _room_region(self, size: Vec3, plan: Array, relation: str, start: Array | None) -> Region:
        room = np.array(self.room_axes[:2])
        low, high, to_room = *self._room_for(size, plan), room @ plan.T
        middle = (low + high) / 2
        wanted = room @ start if start is not None else middle
        costs: dict[str, Cost] = {
            "center": lambda p: _far(p, middle),
            "corner": lambda p: np.asarray(
                4 * np.linalg.norm(np.minimum(p - low, high - p), axis=-1) + _far(p, wanted)
            ),
            "against": lambda p: 4 * self._to_wall(p, low, high) + _far(p, wanted),
        }

        def cost(p: Array) -> Array:
            local: Array = p @ to_room.T
            return costs[relation](local) if relation in costs else _far(local, wanted)

        corners = np.array([[x, y] for x in (low[0], high[0]) for y in (low[1], high[1])]) @ to_room
        return Region(corners.min(axis=0), corners.max(axis=0), cost, self.floor + self.lift, None)

    def _to_wall(self, p: Array, low: Array, high: Array) -> Array:
        """Distance of a footprint from the nearest wall, or from the wall behind it."""
        if self.back is None:
            return np.asarray(np.minimum(p - low, high - p).min(axis=-1))
        way = np.array(self.room_axes[:2]) @ self.back
        return np.asarray(np.where(way > 0, high - p, p - low) @ np.abs(way))

    def _room_for(self, size: Vec3, plan: Array) -> tuple[Array, Array]:
        """Bounds, along the room's axes, of the centre of a footprint along `plan` that stays in the room."""
        low, high = self._room_bounds
        turn = np.abs(np.array(self.room_axes[:2]) @ plan.T)
        half = turn @ np.array(size[:2]) / 2
        low, high = low + half, high - half
        tight = low > high
        return np.where(tight, (low + high) / 2, low), np.where(tight, (low + high) / 2, high)

    @cached_property
    def _room_bounds(self) -> tuple[Array, Array]:
        """Extent along the room's axes of what lies about floor height, stray points left out."""
        plan = np.array(self.room_axes[:2])
        heights = self.thin @ self.up.astype(np.float32)
        span = float(np.ptp(np.quantile(heights, [0.01, 0.99]))) if len(heights) else 1.0
        near = self.thin[np.abs(heights - self.floor) < 0.05 * span]
        points = (near if len(near) > 100 else self.thin) @ plan.T.astype(np.float32)
        if not len(points):
            return np.full(2, -1.0), np.full(2, 1.0)
        low, high = np.quantile(points, [0.004, 0.996], axis=0)
        return low.astype(np.float64), high.astype(np.float64)

    def _top_regions(self, size: Vec3, plan: Array, anchor: Body, relation: str, start: Array | None) -> list[Region]:
        points = self._points_of(anchor)
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
            return _far(p, target)

        regions = []
        for level, near in levels(points @ self.up, local, self._tolerance(anchor)):
            surface = np.column_stack([local[near], np.full(int(near.sum()), level)])
            regions.append(Region(low, high, self._within(anchor, plan, cost), level, surface))
        return regions

    def _inner_regions(self, size: Vec3, plan: Array, anchor: Body) -> list[Region]:
        points = self._points_of(anchor)
        local, heights = points @ plan.T, points @ self.up
        half = np.array(size[:2]) / 2
        low, high = local.min(axis=0) + half, local.max(axis=0) - half
        if (low > high).any():
            raise InstructionError(f"it does not fit inside {anchor.label or 'that'}: its footprint is too large")
        middle = (low + high) / 2
        tolerance = self._tolerance(anchor)
        counts, edges = np.histogram(heights, bins=max(8, int(np.ptp(heights) / max(2 * tolerance, 1e-9))))
        order = [
            i for i in np.argsort(-counts, kind="stable")[:12] if edges[i] + size[2] < anchor.top(self.up) + tolerance
        ]
        regions = []
        for i in order or [int(np.argmax(counts))]:
            near = (heights >= edges[i]) & (heights <= edges[i + 1])
            level = float(np.quantile(heights[near], 0.9)) if near.any() else anchor.bottom(self.up)
            surface = np.column_stack([local[near], np.full(int(near.sum()), level)])
            cost = self._within(anchor, plan, lambda p: _far(p, middle))
            regions.append(Region(low, high, cost, level, surface))
        return regions

    def _under_region(self, plan: Array, anchor: Body) -> Region:
        local = self._points_of(anchor) @ plan.T
        low, high = np.quantile(local, [0.01, 0.99], axis=0)
        middle = (low + high) / 2
        height, surface = self._base(anchor, plan)
        return Region(low, high, self._within(anchor, plan, lambda p: _far(p, middle)), height, surface)

    def _within(self, anchor: Body, plan: Array, cost: Cost) -> Cost:
        """A cost that forbids what is outside the anchor's own footprint (which need not run along `plan`)."""
        axes, half = np.array(anchor.box.axes[:2]), np.array(anchor.box.size[:2]) / 2
        turn, middle = axes @ plan.T, axes @ anchor.center

        def bounded(p: Array) -> Array:
            inside = (np.abs(p @ turn.T - middle) <= half).all(axis=-1)
            return np.asarray(np.where(inside, cost(p), np.inf))

        return bounded

    def _between_region(self, size: Vec3, plan: Array, first: Body, second: Body) -> Region:
        a, b = plan @ first.center, plan @ second.center
        middle, reach = (a + b) / 2, max(float(np.linalg.norm(b - a)) / 2, max(size[:2]))
        lower = min(first, second, key=lambda body: body.bottom(self.up))
        height, surface = self._base(lower, plan)
        return Region(middle - reach, middle + reach, lambda p: _far(p, middle), height, surface)

    def _beside_region(self, size: Vec3, plan: Array, anchor: Body, relation: str, start: Array | None) -> Region:
        center = plan @ anchor.center
        anchor_half = np.array([extent_along(anchor.box, a) for a in plan]) / 2
        half = np.array(size[:2]) / 2
        gap = 3 * centimetre(self.frame, max(anchor.box.size)) * (0 if relation == "against" else 1)
        reach = anchor_half + half + gap + 0.75 * max(*anchor.box.size[:2], *size[:2])
        wanted = self._wanted_side(anchor, plan, relation, start)
        height, surface = self._base(anchor, plan)

        def cost(p: Array) -> Array:
            apart = np.abs(p - center) - anchor_half - half
            clear = apart.max(axis=-1)
            lateral = np.linalg.norm(np.maximum(apart, 0), axis=-1)
            total = np.where(clear < gap * 0.5 - 1e-9, np.inf, 2 * np.abs(lateral - gap))
            offset = p - center
            along = offset @ wanted
            across = np.linalg.norm(offset - along[..., None] * wanted, axis=-1)
            if relation in SIDES:  # within 45 degrees of the asked side
                return np.where(across > along, np.inf, total + across)
            return np.asarray(total + 0.3 * (np.linalg.norm(offset, axis=-1) - along))

        return Region(center - reach, center + reach, cost, height, surface)

    def _wanted_side(self, anchor: Body, plan: Array, relation: str, start: Array | None) -> Array:
        """`[2]` unit: the side that was asked for, or the side the thing is on, or the viewer's right."""
        direction = heading(self.context.viewer, self.frame, SIDES.get(relation, "right"))
        if relation not in SIDES and start is not None:
            direction = start - anchor.center
        level = plan @ direction
        length = float(np.linalg.norm(level))
        return level / length if length > 1e-9 else np.array([1.0, 0.0])

    def _base(self, anchor: Body, plan: Array) -> tuple[float, Array | None]:
        """What a thing stands on: the floor, or the surface just under it with its points."""
        bottom = anchor.bottom(self.up)
        tolerance = max(self._tolerance(anchor), 5 * centimetre(self.frame, max(anchor.box.size)))
        if abs(bottom - self.floor) <= tolerance and self.frame.floor is not None:
            return self.floor, None
        heights = self.solid @ self.up.astype(np.float32)
        near = (np.abs(heights - bottom) <= tolerance) & ~self._inside(anchor)
        if near.sum() < 20:
            return bottom, None
        local = self.solid[near].astype(np.float64)
        level = float(np.median(heights[near]))
        return level, np.column_stack([local @ plan.T, heights[near]])

    def _inside(self, body: Body) -> Bool:
        """Which solid points lie within a body's footprint."""
        local = np.abs(body.box.local(self.solid))
        return np.asarray((local[:, :2] <= np.array(body.box.size[:2]) / 2).all(axis=1))

    def _points_of(self, body: Body) -> Array:
        cloud = self.scene.cloud
        points = cloud.means[body.rows].to(torch.float64).cpu().numpy()
        solid = (cloud.opacities[body.rows] >= OPAQUE).cpu().numpy()
        return points[solid] if solid.any() else points

    def _tolerance(self, anchor: Body) -> float:
        """How uneven a surface may be: 3 % of its owner's height, between 1 and 4 centimetres."""
        cm = centimetre(self.frame, max(anchor.box.size))
        return float(np.clip(0.03 * anchor.box.size[2], cm, 4 * cm))

    # -- the search -------------------------------------------------------------------------------------------------

    def _search(
        self, size: Vec3, axes: tuple[Vec3, Vec3, Vec3], region: Region, anchors: Sequence[Body]
    ) -> tuple[Array | None, bool]:
        """The best possible foot position on one support, and whether obstacles (rather than the support) ruled."""
        basis = np.array(axes)
        half = np.array(size[:2]) / 2
        span = np.maximum(region.high - region.low, 0) + 2 * half
        cell = max(float(min(size[:2])) / _FOOT_CELLS, float(span.max()) / _CELLS, 1e-9)
        shape = np.maximum(np.ceil(span / cell).astype(int) + 1, 1)
        origin = region.low - half
        clear = self._clear(size)
        blocked = self._occupied(basis, origin, cell, shape, (region.height + clear, region.height + size[2]))
        blocked = grown(blocked, max(1, round(centimetre(self.frame, max(size)) / cell)))  # things do not touch
        foot = np.maximum(np.ceil(2 * half / cell).astype(int), 1)  # cells of the footprint
        counts = [np.maximum(s - f + 1, 1) for s, f in zip(shape, foot, strict=True)]
        corner = np.stack(np.meshgrid(*(np.arange(c) for c in counts), indexing="ij"), axis=-1)
        centers = origin + (corner + foot / 2) * cell
        possible = (centers >= region.low - cell).all(axis=-1) & (centers <= region.high + cell).all(axis=-1)
        if region.surface is not None:
            carried = histogram(region.surface[:, :2], origin, cell, shape) > 0
            share = window_sum(grown(carried, self._reach(region.surface, cell)).astype(np.int64), foot, counts)
            possible &= share / float(foot.prod()) >= _CARRIED
        else:
            low, high = self._room_for(size, basis[:2])
            placed = centers @ (np.array(self.room_axes[:2]) @ basis[:2].T).T
            possible &= ((placed >= low - cell) & (placed <= high + cell)).all(axis=-1)
        some = bool(possible.any())
        possible &= window_sum(blocked.astype(np.int64), foot, counts) == 0
        cost = np.where(possible, region.cost(centers), np.inf)
        cost = cost + self._crowding(size, basis, centers, region.height, clear, anchors)
        best = np.unravel_index(int(np.argmin(cost)), cost.shape)
        if not np.isfinite(cost[best]):
            return None, some
        return centers[best] @ basis[:2] + region.height * self.up, some

    def _reach(self, surface: Array, cell: float) -> int:
        """Cells by which points of a surface are grown so that they close: their spacing, but for sparse ones."""
        area = float(np.prod(np.ptp(surface[:, :2], axis=0))) if len(surface) > 1 else 0.0
        return int(np.clip(np.ceil((area / max(len(surface), 1)) ** 0.5 / cell), 1, 6))

    def _clear(self, size: Vec3) -> float:
        """Height above the support below which points do not count: rugs, unevenness, the support's own thickness."""
        cm = centimetre(self.frame, max(size))
        return float(np.clip(0.15 * size[2], 0.5 * cm, 4 * cm))

    def _occupied(
        self, basis: Array, origin: Array, cell: float, shape: NDArray[np.int_], heights: tuple[float, float]
    ) -> Bool:
        """Cells with a solid point in the height range; single points without any neighbour are floaters."""
        up = self.solid @ basis[2].astype(np.float32)
        points = self.solid[(up > heights[0]) & (up < heights[1])] @ basis[:2].T.astype(np.float32)
        counts = histogram(points.astype(np.float64), origin, cell, shape)
        around = window_sum(np.pad(counts, 1), np.array([3, 3]), list(shape))
        occupied: Bool = (counts > 0) & (around > 1)
        return occupied

    def _crowding(
        self, size: Vec3, basis: Array, centers: Array, height: float, clear: float, anchors: Sequence[Body]
    ) -> Array:
        """A large cost where the box would stand in another object's box, though no point is there (under a table)."""
        total = np.zeros(centers.shape[:-1])
        own = {a.group for a in anchors if a.group >= 0} | self.moving_groups
        for box in [*(box for _, box in neighbours(self.scene, own)), *self.taken]:
            middle = float(np.array(box.center) @ basis[2])
            if middle - box.size[2] / 2 > height + size[2] or middle + box.size[2] / 2 < height + clear:
                continue
            reach = np.array([extent_along(box, a) for a in basis[:2]]) / 2 + np.array(size[:2]) / 2
            within = (np.abs(centers - basis[:2] @ np.array(box.center)) < 0.98 * reach).all(axis=-1)
            total += np.where(within, 1e3, 0.0)
        return total


def _far(p: Array, wanted: Array) -> Array:
    return np.asarray(np.linalg.norm(p - wanted, axis=-1))
