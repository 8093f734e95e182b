"""A layout problem prepared for the search: what carries what, what moves as one body, how much floor each thing needs.

Positions are chosen by the search, except for seats: those are fixed relative to their table here.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from ...gaussians.world import everyday, kinds, relations
from ...gaussians.world.box import YawBox, plan_penetration, to_world
from ...gaussians.world.person import HEADROOM, STEP
from ...gaussians.world.support import SHELL
from .lattice import EPSILON
from .problem import Item, Problem, Rigid, Wall

TABLE_GAP = 0.03  # metres between a table and what stands around it
_ELBOW = 0.08  # metres between neighbours at a table
_SWING = 0.9  # metres before a door that its leaf takes at most
_BEFORE = tuple(k.name for k in relations.KINDS if k.enters == "before")
_BESIDE = tuple(k.name for k in relations.KINDS if k.enters == "beside")
_BESIDE_WALL = tuple(k.name for k in relations.KINDS if k.at_wall)


class Member(NamedTuple):
    """One thing of a body: its item's index, and its position and yaw in the axes of the body's first thing."""

    item: int
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0


class Body(NamedTuple):
    """Things that move as one; the first defines the axes."""

    members: tuple[Member, ...]

    @property
    def first(self) -> int:
        return self.members[0].item


@dataclass(frozen=True, eq=False)
class Prepared:
    """A problem with ids replaced by indices.

    Attributes:
        problem: as stated.
        items: its items, with the supports that wishes imply.
        index: row of each id.
    """

    problem: Problem
    items: tuple[Item, ...]
    index: dict[int | str, int]

    @classmethod
    def of(cls, problem: Problem) -> Prepared:
        return cls(problem, tuple(_supported(problem)), {item.id: i for i, item in enumerate(problem.items)})

    @cached_property
    def carriers(self) -> tuple[tuple[int, ...], ...]:
        """For each item what it stands on, what that stands on, and so on; the chain may end in a cycle."""
        found = []
        for item in self.items:
            chain: list[int] = []
            at = item.support
            while at not in SHELL and self.index[at] not in chain:
                chain.append(self.index[at])
                at = self.items[chain[-1]].support
            found.append(tuple(chain))
        return tuple(found)

    @cached_property
    def roots(self) -> tuple[int, ...]:
        """For each item the last of its carriers, with which it moves; the item itself if it has none."""
        return tuple(chain[-1] if chain else i for i, chain in enumerate(self.carriers))

    def is_circular(self, i: int) -> bool:
        """Whether an item's chain of carriers ends in a cycle."""
        return self.items[self.roots[i]].support not in SHELL

    @cached_property
    def wishes_of(self) -> tuple[tuple[int, ...], ...]:
        """For each item the rows of the wishes that name it or something it carries."""
        found: list[dict[int, None]] = [{} for _ in self.items]
        for row, wish in enumerate(self.problem.wishes):
            for name in (wish.subject, *wish.objects):
                for i in (self.index[name], *self.carriers[self.index[name]]):
                    found[i][row] = None
        return tuple(tuple(rows) for rows in found)

    @cached_property
    def participants(self) -> tuple[tuple[int, ...], ...]:
        """For each wish its subject and objects as indices."""
        return tuple(tuple(self.index[n] for n in (w.subject, *w.objects)) for w in self.problem.wishes)

    @cached_property
    def related(self) -> frozenset[tuple[int, int]]:
        """Pairs of items that a wish puts close together: one may stand in the other's free space, except its front."""
        return self._pairs((*_BESIDE, *_BEFORE))

    @cached_property
    def related_in_front(self) -> frozenset[tuple[int, int]]:
        """Pairs of which one may also stand before the other's front: a stool at a piano, no side table at a sofa."""
        return self._pairs(_BEFORE)

    @cached_property
    def sheltered(self) -> frozenset[tuple[int, int]]:
        """Pairs, in both orders, of which one is to be under the other and fits between its legs or below its crown."""
        pairs = set[tuple[int, int]]()
        for wish, parts in zip(self.problem.wishes, self.participants, strict=True):
            if wish.name in ("under", "below"):
                one, other = self.items[parts[0]], self.items[parts[1]]
                if one.size[2] <= everyday.free_beneath(other.label, other.size[2]):
                    pairs |= {(parts[0], parts[1]), (parts[1], parts[0])}
        return frozenset(pairs)

    def _pairs(self, names: tuple[str, ...]) -> frozenset[tuple[int, int]]:
        pairs = set[tuple[int, int]]()
        for wish, (one, *others) in zip(self.problem.wishes, self.participants, strict=True):
            if wish.name in names:
                pairs |= {p for o in others for p in ((one, o), (o, one))}
        return frozenset(pairs)

    def may_enter(self, one: int, zone: YawBox, other: int) -> bool:
        """Whether `other` may stand in a use zone of `one`, given in the axes of `one`, because a wish relates them."""
        before = zone.y < 0 and zone.x == 0
        return (one, other) in (self.related_in_front if before else self.related)

    def wants_wall(self, i: int) -> bool:
        """Whether an item's back belongs against a wall."""
        return i in self._walled

    @cached_property
    def _walled(self) -> frozenset[int]:
        wished = {self.index[w.subject] for w in self.problem.wishes if w.name in _BESIDE_WALL}
        return frozenset(wished | {i for i, item in enumerate(self.items) if item.backed})

    @cached_property
    def named_walls(self) -> dict[int, frozenset[Wall]]:
        """For each item the walls that wishes name for it."""
        found = defaultdict[int, set[Wall]](set)
        for wish in self.problem.wishes:
            if wish.wall:
                found[self.index[wish.subject]].add(wish.wall)
        return {i: frozenset(walls) for i, walls in found.items()}

    @cached_property
    def zones_of(self) -> tuple[tuple[YawBox, ...], ...]:
        """For each item its use zones in its own axes: the space that must stay free to use it."""
        return tuple(tuple(self.zones(i)) for i in range(len(self.items)))

    def zones(self, i: int) -> tuple[YawBox, ...]:
        """The use zones of an item in its own axes; for a door, the space in which its leaf swings."""
        item = self.items[i]
        width, deep, height = item.size
        before, behind, left, right = item.clear
        if kinds.is_door(item.label) and not any(item.clear):
            before = behind = min(width, _SWING)
        low = 0.0 if item.support == "floor" else (item.height or 0.0)
        high = min(HEADROOM, low + max(height, 0.3))
        return tuple(
            YawBox(x, y, low + STEP, w, d, high - (low + STEP))
            for reach, x, y, w, d in (
                (before, 0.0, -(deep + before) / 2, width, before),
                (behind, 0.0, (deep + behind) / 2, width, behind),
                (left, -(width + left) / 2, 0.0, left, deep),
                (right, (width + right) / 2, 0.0, right, deep),
            )
            if reach > 0
        )

    def area(self, i: int) -> float:
        """Floor area of an item and its use zones, square metres."""
        width, deep, _ = self.items[i].size
        return width * deep + sum(z.w * z.d for z in self.zones(i))

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """The bodies: every free root item, a table together with what stands around it.

        Things that do not fit around their table become bodies of their own.
        """
        around = defaultdict[int, list[int]](list)
        taken = set[int]()
        for wish, parts in zip(self.problem.wishes, self.participants, strict=True):
            if wish.name == "around" and self._can_join(*parts) and parts[0] not in taken:
                around[parts[1]].append(parts[0])
                taken.add(parts[0])
        found = []
        bound = set[int]()
        for group in self.problem.rigid:
            body = self._rigid(group, around)
            if body is not None and not bound & {m.item for m in body.members}:
                bound |= {m.item for m in body.members}
                found.append(body)
        for i, item in enumerate(self.items):
            if item.stand is None and item.support in SHELL and i not in taken and i not in bound:
                found.append(Body(self._without_overlaps((Member(i), *self._seats(i, around[i])))))
        seated = {m.item for b in found for m in b.members}
        found += [Body((Member(i),)) for i in sorted(taken - seated)]
        return tuple(found)

    def _rigid(self, group: Rigid, around: Mapping[int, list[int]]) -> Body | None:
        """The body of a rigid group, with the seats around each of its things; None if a thing has a place already."""
        members: list[Member] = []
        own = {self.index[name] for name, *_ in group.members}
        for name, x, y, yaw in group.members:
            i = self.index[name]
            if self.items[i].stand is not None or self.items[i].support != "floor":
                return None
            members.append(Member(i, x, y, yaw))
            for seat in self._seats(i, [s for s in around.get(i, []) if s not in own]):
                sx, sy = to_world(x, y, yaw, seat.x, seat.y)
                members.append(Member(seat.item, sx, sy, seat.yaw + yaw))
        return Body(self._without_overlaps(tuple(members)))

    def box(self, member: Member) -> YawBox:
        """A member's box in the axes of its body, standing at height 0."""
        w, d, h = self.items[member.item].size
        return YawBox(member.x, member.y, 0.0, w, d, h, member.yaw)

    def _without_overlaps(self, members: tuple[Member, ...]) -> tuple[Member, ...]:
        """The members that do not overlap an earlier one."""
        kept: list[Member] = []
        for member in members:
            others = [o for o in kept if (member.item, o.item) not in self.sheltered]
            if not any(plan_penetration(self.box(member), self.box(other)) > EPSILON for other in others):
                kept.append(member)
        return tuple(kept)

    def swapped(self, members: tuple[Member, ...], i: int, j: int) -> tuple[Member, ...] | None:
        """Members with two of them in each other's seats, at the same distance from the table; None if they overlap."""
        a, b = members[i], members[j]
        deep_a, deep_b = self.items[a.item].size[1], self.items[b.item].size[1]
        ax, ay = to_world(a.x, a.y, a.yaw, 0.0, (deep_b - deep_a) / 2)
        bx, by = to_world(b.x, b.y, b.yaw, 0.0, (deep_a - deep_b) / 2)
        trial = list(members)
        trial[i], trial[j] = Member(b.item, ax, ay, a.yaw), Member(a.item, bx, by, b.yaw)
        return tuple(trial) if len(self._without_overlaps(tuple(trial))) == len(members) else None

    def _can_join(self, one: int, table: int) -> bool:
        """Whether a thing may form one body with the table it stands around."""
        a, b = self.items[one], self.items[table]
        grounded = a.support == b.support == "floor" and a.stand is None and b.stand is None
        parts = {p[0] for w, p in zip(self.problem.wishes, self.participants, strict=True) if w.name == "around"}
        return grounded and table not in parts

    def _seats(self, table: int, seated: list[int]) -> Iterator[Member]:
        """Seats around a table, in its axes, spread evenly over its sides; a side at a wall stays empty.

        A table with an aisle behind it has its seats there if more space is kept free there than before it, as at a
        teacher's desk.
        """
        width, deep, _ = self.items[table].size
        sides = {"front": width, "back": width, "left": deep, "right": deep}
        item = self.items[table]
        if item.aisle and item.clear[1] > item.clear[0]:
            sides = {"back": width}
        elif self.wants_wall(table):
            del sides["back"]
        on: dict[str, list[int]] = {s: [] for s in sides}
        for i in seated:
            need = self.items[i].size[0] + _ELBOW
            load = {s: (sum(self.items[j].size[0] + _ELBOW for j in on[s]) + need) / (sides[s] + _ELBOW) for s in on}
            if self.wants_wall(table) and load.get("front", 2.0) <= 1.0:
                on["front"].append(i)
            elif ((best := min(load, key=lambda s: load[s])) and load[best] <= 1.0) or not on[best]:
                on[best].append(i)
        for side, here in on.items():
            yield from self._row(side, here, sides[side], (width, deep))

    def _row(self, side: str, here: list[int], length: float, table: tuple[float, float]) -> Iterator[Member]:
        """The seats at one side of a table, spread evenly along it and turned to it."""
        pitch = length / max(len(here), 1)
        yaw = {"front": 180.0, "back": 0.0, "left": 90.0, "right": -90.0}[side]
        half = (table[1] if side in ("front", "back") else table[0]) / 2
        for k, i in enumerate(here):
            along = (k + 0.5) * pitch - length / 2
            away = half + TABLE_GAP + self.items[i].size[1] / 2
            x, y = to_world(0.0, 0.0, yaw, -along if side == "back" else along, away)
            yield Member(i, x, y, yaw)


def _supported(problem: Problem) -> Iterator[Item]:
    """The items, where a hard wish "on" or "inside" changes the support from the floor to the other item. The carrier
    of a required item becomes required too."""
    onto = {w.subject: w.objects[0] for w in reversed(problem.wishes) if w.hard and w.name in ("on", "inside")}
    items: dict[int | str, Item] = {}
    for item in problem.items:
        moved = item.id in onto and item.support == "floor" and item.stand is None and item.size[2] > STEP
        items[item.id] = item.model_copy(update={"support": onto[item.id]}) if moved else item
    for item in list(items.values()):
        known_spot = {item.id}
        while not item.optional and item.support in items and item.support not in known_spot:
            item = items[item.support].model_copy(update={"optional": False})
            items[item.id] = item
            known_spot.add(item.id)
    yield from items.values()
