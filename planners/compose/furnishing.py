"""Choose the things of a room: those that the brief asks for, and those that such a room usually has besides.

The choice follows styles, seats, and which things replace others. sizing.py gives the sizes, and problems.py makes the
items of the layout problem.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import ceil

import numpy as np

from ...gaussians.world.kinds import Kind
from ...gaussians.world.relations import WishName
from ..layout.problem import Wall
from . import knowledge
from .brief import Brief, Thing

_FEWEST, _MOST = 8, 22  # objects that a room without a stated size is filled to
_PER_AREA = 0.9  # objects for each square metre of a stated size
_SKIPPED = 0.15  # share of habits that chance leaves out, so that not every living room is the same
_PLAIN = Kind(name="thing", size=((0.5, 0.5), (0.5, 0.5), (0.5, 0.5)))


@dataclass(frozen=True)
class Bond:
    """A relation of a group to other groups, by their keys."""

    name: WishName
    objects: tuple[str, ...] = ()
    wall: Wall | None = None
    hard: bool = False


@dataclass
class Group:
    """Things of one kind, all alike."""

    key: str
    thing: Thing
    kind: Kind
    bonds: list[Bond] = field(default_factory=list)

    @property
    def asked(self) -> bool:
        return not self.thing.optional

    @property
    def count(self) -> int:
        return self.thing.count


class Furnishing:
    """The groups of a room, found by key or by what they stand in for."""

    def __init__(self, brief: Brief, rng: np.random.Generator) -> None:
        self.brief, self.rng = brief, rng
        self.room = knowledge.room(brief.kind)
        self.groups: list[Group] = []
        self.remarks: list[str] = []
        self.pending: list[tuple[Group, Sequence[str]]] = []  # wishes to things that are not there yet
        self.without = {_role(w) for w in brief.without} | set(brief.without)

    def find(self, name: str) -> Group | None:
        """The group of this name, else one that stands in for it."""
        named = next((g for g in self.groups if g.kind.name == name or g.key == name), None)
        kind = knowledge.things().get(name)
        if named or not kind:
            return named
        return next((g for g in self.groups if g.asked and kind.role == g.kind.role), None)

    def count(self) -> int:
        """How many things there are, without what comes in numbers: chairs and beams."""
        return sum(g.count for g in self.groups if g.kind.seats != 1 and g.kind.name != "beam")

    def ask(self) -> None:
        """What the brief wants."""
        for thing in self.brief.things:
            if thing.name in ("door", "window"):
                continue
            kind = knowledge.thing(thing.name) or replace(_PLAIN, name=thing.name)
            self.groups.append(Group(thing.id, thing, kind))
        known = {g.key: g for g in self.groups}
        for said in self.brief.relations:
            if said.subject in known:
                known[said.subject].bonds.append(Bond(said.name, said.objects, said.wall, said.hard))

    def add(self, habit: knowledge.Habit, most: int | None = None) -> bool:
        """Take a habit in, unless it is there already, unwanted, or nothing it needs is there."""
        kind = knowledge.things()[habit.thing]
        if {kind.name, kind.role} & self.without or self._there(kind):
            return False
        low, high = habit.count
        number = int(self.rng.integers(low, high + 1))
        if habit.each is not None:
            others = self.find(habit.each)
            if others is None:
                return False
            number *= others.count
        number = min(number, 60 if most is None else max(most, 1))
        wishes = [(w, self._bond(w)) for w in habit.wishes]
        bonds = [b for _, b in wishes if b]
        if kind.support == "surface" and not any(b.name == "on" for b in bonds) and not self.carrier(kind, True):
            return False
        thing = Thing(id=self._key(kind.name), name=kind.name, count=number, optional=True)
        self.groups.append(Group(thing.id, thing, kind, bonds))
        self.pending += [(self.groups[-1], w) for w, b in wishes if b is None]
        return True

    def settle(self) -> None:
        """Relations of habits to things that were taken in after them."""
        for group, wish in self.pending:
            bond = self._bond(wish)
            if bond is not None and bond.name != "on":
                group.bonds.append(bond)
        self.pending = []

    def _there(self, kind: Kind) -> bool:
        """Whether the brief asked for it or its like, or the room has it already."""
        return any(g.kind.name == kind.name or (g.asked and g.kind.role == kind.role) for g in self.groups)

    def _bond(self, wish: Sequence[str]) -> Bond | None:
        """A habit's wish to the groups that are there."""
        name = wish[0]
        if len(wish) == 1:
            return Bond(name)
        if wish[1] in ("door", "window"):
            return Bond(name, (wish[1],))
        other = self.find(wish[1])
        if name == "aligned_with" and other is None:
            return Bond(name, (wish[1],))
        return Bond(name, (other.key,)) if other else None

    def _key(self, name: str) -> str:
        used = {g.key for g in self.groups}
        return name if name not in used else next(k for i in range(2, 99) if (k := f"{name} {i}") not in used)

    def carrier(self, kind: Kind, usual: bool = False) -> Group | None:
        """The group that a small thing is put on; only one that it is usually found on, if `usual`."""
        for name in kind.on:
            if (found := self.find(name)) and (found.kind.top or found.kind.name in kind.on):
                return found
        if usual:
            return None
        return next((g for g in self.groups if g.kind.top and g.kind.support == "floor"), None)

    def seat(self) -> None:
        """Seats for as many people as were spoken of."""
        if self.brief.seats is None:
            return
        left = self.brief.seats - sum(g.count * g.kind.seats for g in self.groups if _is_for_people(g))
        for seat in self.room.seats:
            if left <= 0:
                break
            habit = next(h for h in self.room.habits if h.thing == seat.thing)
            number = min(seat.most, max(1, left // seat.holds) if seat is not self.room.seats[-1] else left)
            asked = self.find(habit.each) if habit.each else None
            if habit.each and asked is None:
                tables = next(h for h in self.room.habits if h.thing == habit.each)
                share = max(habit.count[1], 1)
                self._force(tables, ceil(number / share))
            self._force(habit, number)
            left -= number * seat.holds
        if left > 0:
            self.remarks.append(f"{left} of {self.brief.seats} people find no seat here")

    def _force(self, habit: knowledge.Habit, number: int) -> None:
        """A habit that the brief's people need: asked for, in a number of its own."""
        wanted = knowledge.Habit(thing=habit.thing, count=(number, number), wishes=habit.wishes)
        if number > 0 and self.add(wanted):
            last = self.groups[-1]
            last.thing = last.thing.model_copy(update={"optional": False})

    def fill(self, area: float | None) -> None:
        """Habits and the styles' own things up to a sensible number."""
        if not self.brief.habits:
            return
        goal = self._goal(area)
        chosen = [knowledge.styles()[s] for s in self.brief.styles if s in knowledge.styles()]
        for habit in (*self.room.must, *self._companions()):
            self.add(habit)
        adds = [n for s in chosen for n in s.adds]
        usual = sorted(self.room.usual, key=lambda h: h.thing not in adds)
        for habit in usual:
            if self.count() >= goal:
                break
            if habit.thing in adds or self.rng.random() >= _SKIPPED:
                self.add(habit, most=goal - self.count())
        for name in adds:
            if self.count() < goal + 2:
                self.add(knowledge.Habit(thing=name, count=(1, 1)))
        for habit in self.room.usual:
            if self.count() < min(_FEWEST, goal):
                self.add(habit)

    def _companions(self) -> list[knowledge.Habit]:
        """What comes with things that were asked for: a chair with a desk."""
        return [h for h in self.room.usual if h.each and (g := self.find(h.each)) and g.asked]

    def _goal(self, area: float | None) -> int:
        """How many things make this room full enough."""
        styled = [knowledge.styles()[s].share for s in self.brief.styles if s in knowledge.styles()]
        share = float(np.prod(styled)) if styled else 1.0
        size = {"tiny": 0.6, "small": 0.75, "normal": 1.0, "large": 1.25, "huge": 1.4}[self.brief.scale]
        usual = 17 * size if area is None else min(max(_PER_AREA * area, 2.0), _MOST)
        return max(_FEWEST if area is None else 0, round(usual * share))

    def support_small(self) -> None:
        """Something to stand on for every small thing that was asked for."""
        for group in list(self.groups):
            if group.kind.support != "surface" or group.thing.support or _carried(group):
                continue
            carrier = self.carrier(group.kind)
            if carrier is None and group.kind.on:
                name = group.kind.on[0]
                thing = Thing(id=self._key(name), name=name)
                carrier = Group(thing.id, thing, knowledge.things()[name])
                self.groups.append(carrier)
                self.remarks.append(f"added a {name} for the {group.kind.name} to stand on")
            if carrier is not None:
                group.bonds.append(Bond("on", (carrier.key,)))
            else:
                group.thing = group.thing.model_copy(update={"support": "floor"})


def _role(name: str) -> str:
    kind = knowledge.thing(name)
    return kind.role if kind else name


def _carried(group: Group) -> bool:
    return any(b.name == "on" for b in group.bonds)


def _is_for_people(group: Group) -> bool:
    return group.asked and group.kind.seats > 0


def furnish(brief: Brief, rng: np.random.Generator, area: float | None) -> Furnishing:
    """All groups of a room.

    Args:
        brief: what is wanted.
        rng: decides what chance decides.
        area: of the room, square metres, where its size is stated.
    """
    made = Furnishing(brief, rng)
    made.ask()
    made.seat()
    made.fill(area)
    made.settle()
    made.support_small()
    return made


def pairs(subjects: Sequence[int], objects: Sequence[int]) -> Iterable[tuple[int, int]]:
    """Subjects shared out evenly over objects, in order: four chairs at two tables are two at each.

    Within one and the same sequence: each with its neighbour.
    """
    if not subjects or not objects:
        return []
    if subjects == objects:
        return [(a, objects[i ^ 1]) for i, a in enumerate(subjects) if i ^ 1 < len(objects)]
    if len(subjects) >= len(objects):
        return [(s, objects[i * len(objects) // len(subjects)]) for i, s in enumerate(subjects)]
    return list(zip(subjects, objects, strict=False))


def chained(items: Sequence[int]) -> list[tuple[int, int]]:
    """Each with the one before."""
    return [(b, a) for a, b in pairwise(items)]
