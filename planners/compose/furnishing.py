"""Choose the things of a room: those that the brief asks for, and those that are usual in a room of its kind.

The choice depends on styles, on the number of seats, and on which things replace others. `sizing` gives the sizes, and
`problems` makes the items of the layout problem.
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

_FEWEST, _MOST = 8, 22  # fewest and most objects of a room without a stated size
_PER_AREA = 0.9  # objects for each square metre of a stated size
_FOCI = ("altar", "stage", "blackboard", "whiteboard", "projector screen", "lectern", "pulpit", "podium", "screen")
_AUDIENCE = 4  # so many seats without another place face what an audience looks at
_NAMED, _EXTRAS = 4, 4  # from so many named things on a room gets at most so many others
ROOF = 0.55  # share of its height that is free under a roof at least
_HUNG_HEIGHT = 0.6  # metres, tallest thing that hangs from the ceiling and usually stands
_BEHIND = 0.65  # metres between a counter and what is behind it
_SKIPPED = 0.15  # probability that a habit is left out, so that rooms of one kind differ
_SCREEN = ((0.9, 1.2), (0.06, 0.06), (1.7, 1.8))  # size of a curtain that parts a room
_PLAIN = Kind(name="thing", size=((0.5, 0.5), (0.5, 0.5), (0.5, 0.5)))


@dataclass(frozen=True)
class GroupRelation:
    """A relation of a group to other groups, which are named by their keys."""

    name: WishName
    objects: tuple[str, ...] = ()
    wall: Wall | None = None
    hard: bool = False
    distance: float | None = None
    sides: bool = False
    said: bool = False  # whether the brief states it, as a wish or as a suggestion


@dataclass
class Group:
    """Identical things of one kind."""

    key: str
    thing: Thing
    kind: Kind
    relations: list[GroupRelation] = field(default_factory=list)

    @property
    def asked(self) -> bool:
        return not self.thing.optional

    @property
    def count(self) -> int:
        return self.thing.count


class Furnishing:
    """The groups of a room. A group is found by its key, by the name of its kind, or by its role."""

    def __init__(self, brief: Brief, rng: np.random.Generator) -> None:
        self.brief, self.rng = brief, rng
        self.room = knowledge.room(brief.kind)
        self.groups: list[Group] = []
        self.remarks: list[str] = []
        self.pending: list[tuple[Group, Sequence[str]]] = []  # wishes whose object is not in the room yet
        self.without = {_role(w) for w in brief.without} | set(brief.without)

    def find(self, name: str) -> Group | None:
        """The group with this name or key, else a group that was asked for and has the same role."""
        named = next((g for g in self.groups if g.key == name), None)
        named = named or next((g for g in self.groups if g.kind.name == name), None)
        kind = knowledge.things().get(name)
        if named or not kind:
            return named
        return next((g for g in self.groups if g.asked and kind.role == g.kind.role), None)

    def count(self) -> int:
        """The number of things without single seats and beams, of which a room has many."""
        return sum(g.count for g in self.groups if g.kind.seats != 1 and g.kind.name != "beam")

    def ask(self) -> None:
        """Add the things and relations of the brief."""
        for thing in self.brief.things:
            if thing.name in ("door", "window"):
                continue
            kind = knowledge.thing(thing.name) or replace(_PLAIN, name=thing.name)
            parted = any(r.subject == thing.id and r.name in ("around", "next_to", "between", "in_front_of")
                         and r.objects != ("window",) and r.objects for r in self.brief.relations)  # fmt: skip
            if kind.name == "curtain" and parted and thing.support is None:
                kind = replace(kind, support="floor", size=_SCREEN)  # a curtain round a bed stands as a screen
            if self.room.outdoor and kind.support == "wall" and thing.support is None:
                kind = replace(kind, support="floor")  # a chalkboard at a stall stands; there is no wall
            self.groups.append(Group(thing.id, thing, kind))
        known = {g.key: g for g in self.groups}
        for said in self.brief.relations:
            if said.subject in known:
                known[said.subject].relations.append(
                    GroupRelation(said.name, said.objects, said.wall, said.hard, said.distance, said.sides, True)
                )

    def hang(self) -> None:
        """Hang up things that are said to be above another and usually stand: a shelf above the desk, on the wall; a
        lamp above a table in the room, from the ceiling."""
        for group in self.groups:
            over = [r for r in group.relations if r.hard and r.name == "above" and r.objects]
            if not over or group.thing.support in ("ceiling", "floor") or group.kind.support == "ceiling":
                continue
            lower = self.find(over[0].objects[0])
            if lower is not None and lower is not group and group.kind.under >= ROOF and group.kind.support == "floor":
                group.relations = [r for r in group.relations if r is not over[0]]
                lower.relations.append(replace(over[0], name="under", objects=(group.key,)))  # a parasol stands
                continue
            if lower is not None and not self._is_at_wall(lower) and group.thing.support is None:
                self._hang_from_ceiling(group)
                continue
            if group.thing.support or group.kind.support not in ("floor", "surface"):
                continue
            if group.kind.role in ("shelf", "bookshelf"):
                group.kind = replace(knowledge.things()["wall shelf"], name=group.kind.name, like=group.kind.role)
            (wide, deep, tall), depth = group.kind.size, min(group.kind.size[1][1], 0.35)
            flat = (wide, (min(deep[0], depth), depth), (min(tall[0], 0.6), min(tall[1], 0.6)))
            group.kind = replace(group.kind, support="wall", size=flat, backed=False, aisle=0.0)

    def _is_at_wall(self, group: Group) -> bool:
        """Whether things of a group stand or hang at a wall, so that something can hang on it above them."""
        names = {r.name for r in group.relations if r.hard}
        if names & {"against_wall", "in_corner", "at_window"}:
            return True
        if self.room.outdoor or names & {"in_center", "between", "around"} or group.thing.arrangement:
            return False
        for relation in group.relations:
            if relation.name == "on" and relation.objects and (under := self.find(relation.objects[0])) is not None:
                return under is not group and under.kind.support == "floor" and under.kind.backed
        return group.kind.backed or group.kind.support == "wall"

    def _hang_from_ceiling(self, group: Group) -> None:
        if group.kind.role in ("table lamp", "floor lamp", "desk lamp", "lamp", "wall lamp"):
            plain = group.kind.name in ("table lamp", "floor lamp", "desk lamp", "lamp", "wall lamp")
            pendant = knowledge.things()["pendant lamp"]
            group.kind = pendant if plain else replace(pendant, name=group.kind.name, like="pendant lamp")
            return
        wide, deep, tall = group.kind.size
        tall = (min(tall[0], _HUNG_HEIGHT), min(tall[1], _HUNG_HEIGHT))
        group.kind = replace(group.kind, support="ceiling", size=(wide, deep, tall), backed=False, aisle=0.0)

    def settle_places(self) -> None:
        """Resolve stated places that exclude each other only for things as they usually stand: what hangs on a wall
        stands if it is next to something in the middle of the room; what nothing fits beneath hangs."""
        for group in self.groups:
            for relation in [r for r in group.relations if r.hard and r.objects]:
                other = self.find(relation.objects[0])
                if other is None or other is group:
                    continue
                beside = relation.name in ("next_to", "left_of", "right_of", "in_front_of", "behind", "around")
                inner = any(r.hard and r.name in ("in_center", "around", "between") for r in other.relations)
                if beside and inner and group.kind.support == "wall" and group.thing.support is None:
                    group.kind = replace(group.kind, support="floor")
                elif relation.name in ("under", "below") and other.kind.role == "coat rack":
                    size = (other.kind.size[0], (0.12, 0.12), (0.3, 0.3))
                    other.kind = replace(other.kind, support="wall", size=size, backed=False)
            self._settle_counter(group)

    def _settle_counter(self, group: Group) -> None:
        """Let a counter at a wall leave an aisle where things are said to be behind it."""
        behind = [g for g in self.groups for r in g.relations if r.hard and r.name == "behind" and r.objects
                  and self.find(r.objects[0]) is group and g.kind.support == "floor"]  # fmt: skip
        if not behind:
            return
        for k, relation in enumerate(group.relations):
            if relation.name == "against_wall" and relation.distance is None:
                deep = max(g.thing.depth or g.kind.size[1][1] for g in behind)
                group.relations[k] = replace(relation, distance=round(deep + _BEHIND, 2))
                self.remarks.append(f"the {group.kind.name} stands {deep + _BEHIND:.1f} m from the wall, with the "
                                    f"{behind[0].kind.name} behind it")  # fmt: skip

    def add(self, habit: knowledge.Habit, most: int | None = None) -> bool:
        """Add a habit, unless the room has it, the brief excludes it, or a thing that it needs is missing.

        Returns whether it was added; `most` limits the number of things.
        """
        kind = knowledge.things()[habit.thing]
        if {kind.name, kind.role} & self.without or self._is_present(kind):
            return False
        if self.room.outdoor and kind.support in ("wall", "ceiling"):
            return False
        low, high = habit.count
        number = int(self.rng.integers(low, high + 1))
        if habit.each is not None:
            others = self.find(habit.each)
            if others is None:
                return False
            number *= others.count
        number = min(number, 60 if most is None else max(most, 1))
        wishes = [(w, self._relation(w)) for w in habit.wishes]
        relations = [b for _, b in wishes if b]
        if kind.support == "surface" and not any(b.name == "on" for b in relations) and not self.carrier(kind, True):
            return False
        thing = Thing(id=self._key(kind.name), name=kind.name, count=number, optional=True)
        self.groups.append(Group(thing.id, thing, kind, relations))
        self.pending += [(self.groups[-1], w) for w, b in wishes if b is None]
        return True

    def settle(self) -> None:
        """Add relations of habits to things that were added after them."""
        for group, wish in self.pending:
            relation = self._relation(wish)
            if relation is not None and relation.name != "on":
                group.relations.append(relation)
        self.pending = []

    def _is_present(self, kind: Kind) -> bool:
        """Whether the room has this kind, or the brief asked for a kind of the same role or for "lamps" of any sort."""
        return any(
            g.kind.name == kind.name or (g.asked and (g.kind.role == kind.role or _covers(g, kind)))
            for g in self.groups
        )

    def _relation(self, wish: Sequence[str]) -> GroupRelation | None:
        """A habit's wish as a relation to groups of the room; None while its object is missing."""
        name = wish[0]
        if len(wish) == 1:
            return GroupRelation(name)
        if wish[1] in ("door", "window"):
            return GroupRelation(name, (wish[1],))
        other = self.find(wish[1])
        if name == "aligned_with" and other is None:
            return GroupRelation(name, (wish[1],))
        return GroupRelation(name, (other.key,)) if other else None

    def _key(self, name: str) -> str:
        used = {g.key for g in self.groups}
        return name if name not in used else next(k for i in range(2, 99) if (k := f"{name} {i}") not in used)

    def carrier(self, kind: Kind, usual: bool = False) -> Group | None:
        """The group that a small thing is put on; with `usual`, only a group of a kind that usually carries it."""
        for name in kind.on:
            if (found := self.find(name)) and (found.kind.top or found.kind.name in kind.on):
                return found
        if usual:
            return None
        return next((g for g in self.groups if g.kind.top and g.kind.support == "floor"), None)

    def seat(self) -> None:
        """Add seats for the number of people in the brief."""
        if self.brief.seats is None:
            return
        left = self.brief.seats - sum(g.count * g.kind.seats for g in self.groups if _is_for_people(g))
        for seat in self.room.seats:
            if left <= 0:
                break
            habit = next((h for h in self.room.habits if h.thing == seat.thing), None)
            habit = habit or knowledge.Habit(thing=seat.thing, count=(1, seat.most))
            number = min(seat.most, max(1, left // seat.holds) if seat is not self.room.seats[-1] else left)
            asked = self.find(habit.each) if habit.each else None
            if habit.each and asked is None:
                tables = next(h for h in self.room.habits if h.thing == habit.each)
                share = max(habit.count[1], 1)
                self._require(tables, ceil(number / share))
            self._require(habit, number)
            left -= number * seat.holds
        if left > 0:
            self.remarks.append(f"there are no seats for {left} of {self.brief.seats} people")

    def _require(self, habit: knowledge.Habit, number: int) -> None:
        """Add a habit that the brief's people need, in the given number, as a thing that was asked for."""
        wanted = knowledge.Habit(thing=habit.thing, count=(number, number), wishes=habit.wishes)
        if number > 0 and self.add(wanted):
            last = self.groups[-1]
            last.thing = last.thing.model_copy(update={"optional": False})

    def fill(self, area: float | None) -> None:
        """Add habits and the things that styles add, up to the number that `_goal` gives."""
        if not self.brief.habits:
            return
        asked = len(self.groups)
        if self.brief.kind == "room" and asked >= _NAMED:
            return  # the sentence names no kind of room, but what is in it
        self._usual_places()
        goal = self._goal(area)
        if asked >= _NAMED:
            goal = min(goal, self.count() + _EXTRAS)
        chosen = [knowledge.styles()[s] for s in self.brief.styles if s in knowledge.styles()]
        for habit in (*(() if self.room.outdoor and asked > 1 else self.room.must), *self._companions()):
            self.add(habit)
        adds = [n for s in chosen for n in s.adds if not self.room.outdoor]
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

    def _usual_places(self) -> None:
        """Give things that were asked for, without a word on where, their usual relations in such a room."""
        for group in list(self.groups):
            habit = next((h for h in self.room.habits if h.thing == group.kind.name), None)
            if habit is None or group.relations or group.thing.arrangement:
                continue
            self.pending += [(group, w) for w in habit.wishes if w[0] not in ("on", "in_center", "aligned_with")]
        focus = next((g for g in self.groups if g.asked and g.kind.name in _FOCI), None)
        for group in self.groups if focus is not None else ():
            many = group.asked and group.kind.seats and group.count >= _AUDIENCE
            if many and focus is not None and not any(r.name in ("facing", "around") for r in group.relations):
                group.relations.append(GroupRelation("facing", (focus.key,)))

    def _companions(self) -> list[knowledge.Habit]:
        """Habits that belong to things that were asked for: a chair to a desk."""
        return [h for h in self.room.usual if h.each and (g := self.find(h.each)) and g.asked]

    def _goal(self, area: float | None) -> int:
        """The number of things to fill the room with."""
        styled = [knowledge.styles()[s].share for s in self.brief.styles if s in knowledge.styles()]
        share = float(np.prod(styled)) if styled else 1.0
        size = {"tiny": 0.6, "small": 0.75, "normal": 1.0, "large": 1.25, "huge": 1.4}[self.brief.scale]
        usual = 17 * size if area is None else min(max(_PER_AREA * area, 2.0), _MOST)
        return max(_FEWEST if area is None else 0, round(usual * share))

    def _stands(self, group: Group) -> bool:
        """Whether what is said of a small thing puts it on the floor: a vase in the corner."""
        return any(_stands_on_floor(r) for r in group.relations)

    def _shared_carrier(self, group: Group) -> Group | None:
        """What carries the thing that a small thing is said to be next to."""
        for relation in group.relations:
            other = self.find(relation.objects[0]) if relation.hard and relation.objects else None
            if other is not None and (on := next((r for r in other.relations if r.name == "on" and r.objects), None)):
                return self.find(on.objects[0])
        return None

    def support_small(self) -> None:
        """Put every small thing on a carrier, which is added if it is missing; without one it stands on the floor."""
        for group in list(self.groups):
            if group.kind.support != "surface" or group.thing.support or _carried(group):
                continue
            if self._stands(group):
                group.thing = group.thing.model_copy(update={"support": "floor"})
                continue
            carrier = self._shared_carrier(group) or self.carrier(group.kind)
            if carrier is None and group.kind.on and not self.room.outdoor:
                name = group.kind.on[0]
                thing = Thing(id=self._key(name), name=name)
                carrier = Group(thing.id, thing, knowledge.things()[name])
                self.groups.append(carrier)
                self.remarks.append(f"added a {name} for the {group.kind.name} to stand on")
            if carrier is not None:
                group.relations.append(GroupRelation("on", (carrier.key,)))
            else:
                group.thing = group.thing.model_copy(update={"support": "floor"})


def _stands_on_floor(relation: GroupRelation) -> bool:
    return relation.hard and relation.name in ("in_corner", "against_wall", "in_center", "around", "under", "below")


def _covers(group: Group, kind: Kind) -> bool:
    """Whether the noun that was said for a group is the head of the name of a kind: "lamp" covers a floor lamp."""
    said = group.thing.called or group.kind.name
    return kind.name.endswith(f" {said}") or group.kind.name == kind.name


def _role(name: str) -> str:
    kind = knowledge.thing(name)
    return kind.role if kind else name


def _carried(group: Group) -> bool:
    return any(b.name in ("on", "inside") for b in group.relations)


def _is_for_people(group: Group) -> bool:
    return group.asked and group.kind.seats > 0


def furnish(brief: Brief, rng: np.random.Generator, area: float | None) -> Furnishing:
    """All groups of a room.

    Args:
        brief: what is wanted.
        rng: the source of randomness.
        area: floor area in square metres, None where the brief states no size.
    """
    made = Furnishing(brief, rng)
    made.ask()
    made.hang()
    made.settle_places()
    made.seat()
    made.fill(area)
    made.settle()
    made.support_small()
    return made


def pairs(subjects: Sequence[int], objects: Sequence[int]) -> Iterable[tuple[int, int]]:
    """Pair subjects with objects evenly and in order: of four chairs at two tables, two go to each.

    If both sequences are equal, each element is paired with its neighbour.
    """
    if not subjects or not objects:
        return []
    if subjects == objects:
        return [(a, objects[i ^ 1]) for i, a in enumerate(subjects) if i ^ 1 < len(objects)]
    if len(subjects) >= len(objects):
        return [(s, objects[i * len(objects) // len(subjects)]) for i, s in enumerate(subjects)]
    return list(zip(subjects, objects, strict=False))


def chained(items: Sequence[int]) -> list[tuple[int, int]]:
    """Each item paired with the item before it."""
    return [(b, a) for a, b in pairwise(items)]
