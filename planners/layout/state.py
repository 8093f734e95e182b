"""A layout in the making: what stands where, and what that takes of the floor.

Knows spots and obstacles. Refuses to know how a place is chosen.
"""

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
from .problem import Keepout, Stand
from .walkable_grid import floors

HARD, SOFT, USED, WALLED, OPEN, HUNG, LOST = (
    1000.0,
    12.0,
    60.0,
    60.0,
    45.0,
    250.0,
    400.0,
)  # prices; the unit is about a metre off
LEFT_OUT, SPARED = 4000.0, 300.0  # of leaving out what must be there, and what may be absent
BACKED = 0.02  # metres between a back and the wall behind it
_LOW, _HIDING, _NEAR = 0.4, 1.4, 0.6  # metres: what hides no room, what does however it is turned, and how near
_TIGHT = 25.0  # price of a thing that one gets to only by squeezing through


class State:
    """Spots of all items, None for what has none yet; grows and shrinks by bodies.

    Attributes:
        spots: of each item.
        discs: x, y and radius of the floor that is kept free, None where there was no room for it.
    """

    def __init__(self, prepared: Prepared) -> None:
        self.prepared = prepared
        problem = prepared.problem
        self.size = problem.size
        self.spots: list[YawBox | None] = [None] * len(prepared.items)
        self.zones: list[tuple[YawBox, ...]] = [()] * len(prepared.items)
        self.ways = floors((self.size[0], self.size[1]), (problem.walkway, 0.0))
        self.windows = [
            self._fixed(i) for i, item in enumerate(prepared.items) if item.stand and "window" in item.label.lower()
        ]
        for i, item in enumerate(prepared.items):
            if item.stand is not None:
                self.put(i, self._fixed(i))
        self.discs: list[tuple[float, float, float] | None] = [_disc(k) for k in problem.free]

    def _fixed(self, i: int) -> YawBox:
        item = self.prepared.items[i]
        assert item.stand is not None
        (x, y, z), yaw = item.stand.position, item.stand.yaw
        return YawBox(x, y, z - item.size[2] / 2, *item.size, yaw)

    def spot(self, member: Member, x: float, y: float, yaw: float, low: float) -> YawBox:
        """Where a member of a body stands when the body's first thing stands so."""
        mx, my = to_world(x, y, yaw, member.x, member.y)
        w, d, h = self.prepared.items[member.item].size
        return YawBox(mx, my, low, w, d, h, yaw + member.yaw)

    def put(self, i: int, spot: YawBox) -> None:
        """Place one item."""
        item = self.prepared.items[i]
        self.spots[i] = spot
        self.zones[i] = tuple(placed(z, spot) for z in self.prepared.zones_of[i])
        for floor in self.ways:
            solid = item.support == "floor" and item.size[2] > STEP
            floor.put(i, spot, asked=solid, door=kinds.is_door(item.label))

    def take(self, i: int) -> None:
        """Remove one item."""
        if self.spots[i] is not None:
            self.spots[i], self.zones[i] = None, ()
            for floor in self.ways:
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
        """Whether an item is stood upon: it meets nothing."""
        item = self.prepared.items[i]
        return is_stepped_on(item.support, item.size[2])

    def solids(self, but: set[int]) -> Iterator[tuple[int, YawBox]]:
        """What is placed and meets others, apart from some items."""
        for i, spot in enumerate(self.spots):
            if spot is not None and i not in but and not self.is_flat(i):
                yield i, spot

    def crowded(self) -> float:
        """Price of what cannot be walked up to."""
        wide = self.ways[0].unreached()
        if not wide:
            return 0.0
        slim = self.ways[-1].unreached() if len(self.ways) > 1 else wide
        return _TIGHT * len(wide) + LOST * len(slim)

    def seen(self, i: int) -> YawBox | None:
        """Where an item is, or where the thing is that will carry it."""
        for k in (i, *self.prepared.carriers[i]):
            if (spot := self.spots[k]) is not None:
                return spot
        return None

    def holds(self, row: int) -> tuple[bool, float]:
        """Whether a wish holds, and how far it is from ideal; nothing holds of what is not there."""
        wish, parts = self.prepared.problem.wishes[row], self.prepared.parties[row]
        spots = [self.spots[p] for p in parts]
        if any(s is None for s in spots):
            return False, 4.0
        if wish.name in ("on", "inside") and parts[1] in self.prepared.carriers[parts[0]]:
            return True, 0.0
        one, *others = (s for s in spots if s is not None)
        kept, cost = measure(wish.name, self.size, one, others, self.windows, wish.wall)
        return bool(kept), float(cost)

    def price(self) -> float:
        """What is wrong with the layout as a whole: left out, unreached, wishes not kept, room for use taken."""
        total = self.crowded() + sum(HARD for d in self.discs if d is None)
        for i, item in enumerate(self.prepared.items):
            if self.spots[i] is None:
                total += SPARED if item.optional else LEFT_OUT
        for row, wish in enumerate(self.prepared.problem.wishes):
            kept, cost = self.holds(row)
            total += (2.0 if wish.hard else 1.5) * min(cost, 10.0)
            total += 0.0 if kept else (HARD if wish.hard else SOFT)
        return (
            total
            + USED * len(self.used())
            + WALLED * len(self.unbacked())
            + sum(self.exposure(i) for i in self.hiding())
        )

    def lost(self) -> int:
        """How many things nobody gets to."""
        return len(self.ways[-1].unreached())

    def hiding(self) -> list[int]:
        """What the solver hung on, or turned with a tall back to, a wall that the room is looked at through."""
        return [
            i
            for i, (item, spot) in enumerate(zip(self.prepared.items, self.spots, strict=True))
            if spot is not None and item.stand is None and bool(self.hides(i, spot))
        ]

    def exposure(self, i: int) -> float:
        """Price of an item at a wall that the room is looked at through: what hangs there hangs in the air."""
        return HUNG if self.prepared.items[i].support == "wall" else OPEN

    def hides(self, i: int, spot: YawBox) -> Any:
        """Whether an item would hide the room from who looks in, at one place or at many."""
        item, hidden = self.prepared.items[i], np.zeros(np.shape(spot.x), bool)
        if item.support not in ("floor", "wall") or (item.support == "floor" and item.size[2] < _LOW):
            return hidden
        backed = item.support == "wall" or self.prepared.wants_wall(i)
        fx, fy = spot.front
        back = (("west", fx), ("east", -fx), ("south", fy), ("north", -fy))
        gaps = dict(zip(("west", "east", "south", "north"), walls_gaps(spot, self.size), strict=True))
        for wall, along in back:
            if wall in self.prepared.problem.open and wall not in self.prepared.named.get(i, ()):
                turned = (along > 0.7 and backed) or item.size[2] > _HIDING
                hidden = hidden | (np.asarray(gaps[wall] < _NEAR + item.aisle) & turned)
        return hidden

    def unbacked(self) -> list[int]:
        """Free things on the floor that want a wall behind them and have none."""
        return [
            i
            for i, (item, spot) in enumerate(zip(self.prepared.items, self.spots, strict=True))
            if spot is not None and item.stand is None and item.support == "floor" and self.prepared.wants_wall(i)
            if not abs(behind_gap(spot, self.size) - item.aisle) <= BACKED
        ]

    def used(self) -> list[int]:
        """Whose room for use something stands in: an item for each such zone."""
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
        """Where an item is, as the problem says it: to a tenth of a millimetre."""
        spot = self.spots[i]
        if spot is None:
            return None
        if (given := self.prepared.items[i].stand) is not None:
            return given
        middle = (float(spot.x), float(spot.y), spot.low + spot.h / 2)
        x, y, z = (float(np.round(c, 4)) + 0.0 for c in middle)
        return Stand(position=(x, y, z), yaw=wrapped(round(spot.yaw, 4)))

    def copy(self) -> tuple[list[YawBox | None], list[tuple[float, float, float] | None]]:
        """What is needed to come back here."""
        return list(self.spots), list(self.discs)

    def restore(self, kept: tuple[list[YawBox | None], list[tuple[float, float, float] | None]]) -> None:
        """Come back to a copy."""
        spots, self.discs = list(kept[0]), list(kept[1])
        for i, spot in enumerate(spots):
            if spot is not self.spots[i]:
                self.take(i)
                if spot is not None:
                    self.put(i, spot)


def placed(zone: YawBox, spot: YawBox) -> YawBox:
    """A box given in the axes of another, in the world."""
    x, y = to_world(spot.x, spot.y, spot.yaw, zone.x, zone.y)
    return zone._replace(x=x, y=y, yaw=spot.yaw + zone.yaw)


def _disc(keepout: Keepout) -> tuple[float, float, float] | None:
    return None if keepout.center is None else (*keepout.center, keepout.radius)
