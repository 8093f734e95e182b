"""The state of the search: a partial layout with its boxes, use zones, walkable floor and total cost."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from ...gaussians.world import kinds
from ...gaussians.world.box import YawBox, plan_penetration, shared_height, to_world, wrapped
from ...gaussians.world.person import STEP
from ...gaussians.world.support import is_stepped_on
from .bodies import Body, Member, Prepared
from .lattice import EPSILON
from .measures import behind_gap, measure, walls_gaps
from .problem import Stand
from .walkable_grid import walkable_grids

# Costs; the unit is about a metre away from the ideal.
MISSING_REQUIRED, MISSING_OPTIONAL = 4000.0, 300.0  # a required or an optional thing is left out
BROKEN_HARD, BROKEN_SOFT = 1000.0, 12.0  # a hard or a soft wish does not hold
UNREACHED = 400.0  # nobody can walk up to a thing
BLOCKED_USE = 60.0  # something stands in a use zone
NOT_AT_WALL = 60.0  # a back that belongs at a wall is away from it
AT_OPEN_WALL, HUNG_AT_OPEN_WALL = 45.0, 250.0  # a thing stands before an open wall, or hangs on it
MAX_BACK_GAP = 0.02  # metres between a back and the wall behind it
# Metres: lower things never block the view into the room, taller ones block it at any yaw, within this distance.
_LOW_THING, _TALL, _NEAR = 0.4, 1.4, 0.6
_NARROW_ACCESS = 25.0  # cost of a thing that is accessible only by a passage narrower than the walkway


class State:
    """A partial layout, to which bodies are added and from which they are removed.

    Attributes:
        spots: box of each item in the room; None if it is not placed.
        zones: use zones of each placed item, in the room.
        grids: the walkable floor, for the walkway's width and for the checker's.
        discs: x, y and radius of each disc of floor that is kept free, None if it has no place.
    """

    def __init__(self, prepared: Prepared) -> None:
        self.prepared = prepared
        problem = prepared.problem
        self.size = problem.size
        self.spots: list[YawBox | None] = [None] * len(prepared.items)
        self.zones: list[tuple[YawBox, ...]] = [()] * len(prepared.items)
        self.grids = walkable_grids((self.size[0], self.size[1]), (problem.walkway, 0.0))
        self.windows = [
            self._fixed(i) for i, item in enumerate(prepared.items) if item.stand and "window" in item.label.lower()
        ]
        for i, item in enumerate(prepared.items):
            if item.stand is not None:
                self.put(i, self._fixed(i))
        self.discs: list[tuple[float, float, float] | None] = [
            None if k.center is None else (*k.center, k.radius) for k in problem.free
        ]

    def _fixed(self, i: int) -> YawBox:
        item = self.prepared.items[i]
        assert item.stand is not None
        (x, y, z), yaw = item.stand.position, item.stand.yaw
        return YawBox(x, y, z - item.size[2] / 2, *item.size, yaw)

    def spot(self, member: Member, x: float, y: float, yaw: float, low: float) -> YawBox:
        """Box of a member of a body whose first thing is at (x, y), yaw and underside height `low`."""
        mx, my = to_world(x, y, yaw, member.x, member.y)
        w, d, h = self.prepared.items[member.item].size
        return YawBox(mx, my, low, w, d, h, yaw + member.yaw)

    def put(self, i: int, spot: YawBox) -> None:
        """Place one item."""
        item = self.prepared.items[i]
        self.spots[i] = spot
        self.zones[i] = tuple(placed(z, spot) for z in self.prepared.zones_of[i])
        for floor in self.grids:
            solid = item.support == "floor" and item.size[2] > STEP
            floor.put(i, spot, required=solid, door=kinds.is_door(item.label))

    def take(self, i: int) -> None:
        """Remove one item."""
        if self.spots[i] is not None:
            self.spots[i], self.zones[i] = None, ()
            for floor in self.grids:
                floor.take(i)

    def place(self, body: Body, x: float, y: float, yaw: float, low: float) -> None:
        """Place a whole body."""
        for member in body.members:
            self.put(member.item, self.spot(member, x, y, yaw, low))

    def remove(self, body: Body) -> None:
        """Remove a whole body."""
        for member in body.members:
            self.take(member.item)

    def is_flat(self, i: int) -> bool:
        """Whether other things may stand on an item as on a rug; such an item collides with nothing."""
        item = self.prepared.items[i]
        return is_stepped_on(item.support, item.size[2])

    def solids(self, but: set[int]) -> Iterator[tuple[int, YawBox]]:
        """The placed items that can collide, without `but`, and their boxes."""
        for i, spot in enumerate(self.spots):
            if spot is not None and i not in but and not self.is_flat(i):
                yield i, spot

    def access_cost(self) -> float:
        """Cost of the things that are not accessible, or only by a narrow passage."""
        wide = self.grids[0].unreached()
        if not wide:
            return 0.0
        slim = self.grids[-1].unreached() if len(self.grids) > 1 else wide
        return _NARROW_ACCESS * len(wide) + UNREACHED * len(slim)

    def known_spot(self, i: int) -> YawBox | None:
        """Box of an item, or else of the thing that will carry it; None if neither is placed."""
        for k in (i, *self.prepared.carriers[i]):
            if (spot := self.spots[k]) is not None:
                return spot
        return None

    def holds(self, row: int) -> tuple[bool, float]:
        """Whether a wish holds, and its distance from ideal; a wish about a thing without a place does not hold."""
        wish, parts = self.prepared.problem.wishes[row], self.prepared.participants[row]
        spots = [self.spots[p] for p in parts]
        if any(s is None for s in spots):
            return False, 4.0
        if wish.name in ("on", "inside") and parts[1] in self.prepared.carriers[parts[0]]:
            return True, 0.0
        one, *others = (s for s in spots if s is not None)
        kept, cost = measure(wish.name, self.size, one, others, self.windows, wish.wall, wish.distance)
        return bool(kept), float(cost)

    def cost(self) -> float:
        """Total cost: missing and inaccessible things, broken wishes, blocked use zones and views, backs off walls."""
        total = self.access_cost() + sum(BROKEN_HARD for d in self.discs if d is None)
        for i, item in enumerate(self.prepared.items):
            if self.spots[i] is None:
                total += MISSING_OPTIONAL if item.optional else MISSING_REQUIRED
        for row, wish in enumerate(self.prepared.problem.wishes):
            kept, cost = self.holds(row)
            total += (2.0 if wish.hard else 1.5) * min(cost, 10.0)
            total += 0.0 if kept else (BROKEN_HARD if wish.hard else BROKEN_SOFT)
        return (
            total
            + BLOCKED_USE * len(self.blocked_use())
            + NOT_AT_WALL * len(self.away_from_wall())
            + sum(self.view_cost(i) for i in self.blocking_view())
        )

    def unreached_count(self) -> int:
        """Number of things that are not accessible."""
        return len(self.grids[-1].unreached())

    def blocking_view(self) -> list[int]:
        """Items that the solver placed so that they block the view through an open wall (`Problem.open`)."""
        return [
            i
            for i, (item, spot) in enumerate(zip(self.prepared.items, self.spots, strict=True))
            if spot is not None and item.stand is None and bool(self.blocks_view(i, spot))
        ]

    def view_cost(self, i: int) -> float:
        """Cost of an item that blocks the view through an open wall; higher if it hangs, as no wall is built there."""
        return HUNG_AT_OPEN_WALL if self.prepared.items[i].support == "wall" else AT_OPEN_WALL

    def blocks_view(self, i: int, spot: YawBox) -> Any:
        """Whether an item blocks the view through an open wall, at one position or at many."""
        item, hidden = self.prepared.items[i], np.zeros(np.shape(spot.x), bool)
        if item.support not in ("floor", "wall") or (item.support == "floor" and item.size[2] < _LOW_THING):
            return hidden
        backed = item.support == "wall" or self.prepared.wants_wall(i)
        fx, fy = spot.front
        back = (("west", fx), ("east", -fx), ("south", fy), ("north", -fy))
        gaps = dict(zip(("west", "east", "south", "north"), walls_gaps(spot, self.size), strict=True))
        for wall, along in back:
            if wall in self.prepared.problem.open and wall not in self.prepared.named_walls.get(i, ()):
                turned = (along > 0.7 and backed) or item.size[2] > _TALL
                hidden = hidden | (np.asarray(gaps[wall] < _NEAR + item.aisle) & turned)
        return hidden

    def away_from_wall(self) -> list[int]:
        """Free things on the floor that belong at a wall and are not at one."""
        return [
            i
            for i, (item, spot) in enumerate(zip(self.prepared.items, self.spots, strict=True))
            if spot is not None and item.stand is None and item.support == "floor" and self.prepared.wants_wall(i)
            if not abs(behind_gap(spot, self.size) - item.aisle) <= MAX_BACK_GAP
        ]

    def blocked_use(self) -> list[int]:
        """The item of each use zone that something stands in."""
        chains = self.prepared.carriers
        found, solids = list[int](), list(self.solids(set()))
        for i, zones in enumerate(self.zones):
            for local, zone in zip(self.prepared.zones_of[i], zones, strict=False):
                if any(
                    j != i
                    and not self.prepared.may_enter(i, local, j)
                    and i not in chains[j]
                    and shared_height(zone, s) > EPSILON
                    and math.hypot(zone.x - s.x, zone.y - s.y) < math.hypot(zone.w, zone.d) + math.hypot(s.w, s.d)
                    and plan_penetration(zone, s) > EPSILON
                    for j, s in solids
                ):
                    found.append(i)
        return found

    def stand(self, i: int) -> Stand | None:
        """Pose of an item, rounded to a tenth of a millimetre; a fixed one as given. None if it is not placed."""
        spot = self.spots[i]
        if spot is None:
            return None
        if (given := self.prepared.items[i].stand) is not None:
            return given
        middle = (float(spot.x), float(spot.y), spot.low + spot.h / 2)
        x, y, z = (float(np.round(c, 4)) + 0.0 for c in middle)
        return Stand(position=(x, y, z), yaw=wrapped(round(spot.yaw, 4)))

    def copy(self) -> tuple[list[YawBox | None], list[tuple[float, float, float] | None]]:
        """A copy of the placed boxes and discs, for `restore`."""
        return list(self.spots), list(self.discs)

    def restore(self, kept: tuple[list[YawBox | None], list[tuple[float, float, float] | None]]) -> None:
        """Return to the state of a copy."""
        spots, self.discs = list(kept[0]), list(kept[1])
        for i, spot in enumerate(spots):
            if spot is not self.spots[i]:
                self.take(i)
                if spot is not None:
                    self.put(i, spot)


def placed(zone: YawBox, spot: YawBox) -> YawBox:
    """A box given in the axes of another, in the room's frame."""
    x, y = to_world(spot.x, spot.y, spot.yaw, zone.x, zone.y)
    return zone._replace(x=x, y=y, yaw=spot.yaw + zone.yaw)
