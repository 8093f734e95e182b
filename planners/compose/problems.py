"""Turn a brief into a layout problem: the room's size, items with sizes, and hard and soft wishes between them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import count

import numpy as np

from ...gaussians.world import everyday
from ...gaussians.world.person import HEADROOM, HUNG_AT, STEP
from ..layout.problem import Item, Keepout, Problem, Wall, Wish
from ..rooms.node import Size
from . import knowledge, sizing
from .brief import Brief
from .formations import Formations, Formed
from .furnishing import ROOF, Furnishing, Group, GroupRelation, chained, furnish, pairs
from .openings import beams, hang_curtains, openings
from .sentence import vocabulary

_TOP_SHARE = 0.5  # share of a top that small things may take that nobody asked for
_OVERHEAD = HEADROOM + 0.05  # metres kept free under things that hang from the ceiling
# With a hard wish of these names a counter has no aisle, as nobody works behind it.
# Relations that hold for a row as a whole where they hold for its middle.
_AIMED = ("facing", "in_front_of", "behind", "left_of", "right_of", "next_to", "far_from", "aligned_with")
_CARRYING = ("on", "inside")  # relations of a thing to what carries it
_CORNERS: tuple[tuple[Wall, Wall], ...] = (
    ("north", "west"), ("north", "east"), ("south", "west"), ("south", "east"),
)  # fmt: skip
_WITHOUT_AISLE = ("against_wall", "in_corner", "at_window")


@dataclass(frozen=True)
class Posed:
    """A layout problem with its relation to the brief.

    Attributes:
        problem: for the layout solver.
        names: for each item that was asked for, its id to the id of the brief's thing.
        remarks: what was added or left out, a sentence each.
        stated: the wishes that the brief states, those of the members of formations included.
    """

    problem: Problem
    names: dict[int, str]
    remarks: tuple[str, ...] = ()
    stated: frozenset[Wish] = frozenset()


def problem_of(brief: Brief, seed: int = 0, *, grow: float = 1.0, shrink: float = 1.0) -> Posed:
    """The layout problem that a brief poses. The same brief and seed give the same problem.

    Args:
        brief: what is wanted.
        seed: draws sizes, colours and the habits that are added.
        grow: factor on each side of the room that the brief does not state.
        shrink: factor on the sizes of things that the brief does not state.
    """
    made = furnish(brief, np.random.default_rng([seed, 0]), sizing.stated_area(brief))
    sized = sizing.sized(made, np.random.default_rng([seed, 1]), shrink)
    room = sizing.room_size(brief, sized, np.random.default_rng([seed, 2]), grow)
    return _ProblemBuilder(brief, made, sized, room, seed).build()


class _ProblemBuilder:
    """The state of building one problem."""

    def __init__(
        self, brief: Brief, made: Furnishing, sized: Sequence[tuple[Group, Size]], room: Size, seed: int
    ) -> None:
        self.brief, self.made, self.sized, self.room = brief, made, sized, room
        self.rng = np.random.default_rng([seed, 3])
        self.ids: Iterator[int] = count(1)
        self.items: list[Item] = []
        self.wishes: list[Wish] = []
        self.item_ids: dict[str, list[int]] = {}  # by key of a group
        self.area_taken: dict[int, float] = {}  # square metres, by id of the item that carries
        self.remarks = list(made.remarks)
        self.names: dict[int, str] = {}
        self.formed = Formed((), frozenset())

    def build(self) -> Posed:
        beneath = [s for g, s in self.sized for r in g.relations if r.name == "under" and r.objects == ("window",)]
        doors, windows = openings(self.brief, self.room, self.rng, self.ids, beneath)
        self.items += [*doors, *windows]
        self.item_ids |= {"door": [_item_id(d) for d in doors], "window": [_item_id(w) for w in windows]}
        for group, size in sorted(self.sized, key=lambda sized: self._height_of_pile(sized[0])):
            self._place(group, size)
        self._form()
        for said in self.brief.relations:
            if said.subject in ("door", "window"):
                self._add_wishes(said.subject, GroupRelation(said.name, said.objects, said.wall, said.hard))
        stated = set(self.wishes)
        for group, _ in self.sized:
            for relation in group.relations:
                before = len(self.wishes)
                self._add_wishes(group.key, relation, group)
                told = relation.hard or (relation.said and relation.objects)
                names = {relation.name, "facing"} if relation.name == "around" else {relation.name}
                stated |= {w for w in self.wishes[before:] if told and w.name in names}
        free = (Keepout(name="dance floor", radius=round(min(1.4, 0.22 * min(self.room[:2])), 2)),)
        problem = Problem(
            size=self.room,
            items=tuple(self.items),
            wishes=tuple(dict.fromkeys(self.wishes)),
            free=free if "dance floor" in self.brief.features else (),
            open=("south",),
            rigid=self.formed.rigid,
            outdoor=knowledge.room(self.brief.kind).outdoor,
        )
        return Posed(problem, self.names, tuple(dict.fromkeys(self.remarks)), frozenset(stated))

    def _form(self) -> None:
        """Find the formations; what is in one stands as the formation says, not with its own back to a wall."""
        items = {_item_id(i): i for i in self.items}
        finder = Formations([g for g, _ in self.sized], self.item_ids, items, self._key_of)
        self.formed = finder.run()
        first = {_first(g.members[0][0]) for g in self.formed.rigid}
        loose = {"clear": (0.0,) * 4, "backed": False, "aisle": 0.0}
        self.items = [
            i.model_copy(update=loose) if i.id in self.formed.members and i.id not in first else i for i in self.items
        ]

    def _key_of(self, name: str) -> str:
        group = self.made.find(name)
        return group.key if group is not None else ""

    # ---- items -----------------------------------------------------------------------------------------------------

    def _height_of_pile(self, group: Group) -> int:
        """How many things one on another carry a group; what carries is placed before what it carries."""
        seen, at = [group.key], self._carrier(group)
        while at is not None and at.key not in seen:
            seen.append(at.key)
            at = self._carrier(at)
        return len(seen)

    def _carrier(self, group: Group) -> Group | None:
        """The group that a group stands on, or None. Things on a rug count as standing on the floor."""
        if group.thing.support:
            return None
        for relation in group.relations:
            if relation.name in _CARRYING and relation.objects:
                other = self.made.find(relation.objects[0])
                if relation.name == "inside" and group.kind.support != "surface" and other and not other.kind.holds:
                    continue
                if not other or other is group or other.kind.size[2][1] <= 0.05:
                    continue
                if not self._is_circular(group, other):
                    return other
        return None

    def _is_circular(self, group: Group, other: Group) -> bool:
        """Whether standing on `other` would make the group stand on itself."""
        seen = {group.key}
        at: Group | None = other
        while at is not None:
            if at.key in seen:
                return True
            seen.add(at.key)
            relation = next((b for b in at.relations if b.name in _CARRYING and b.objects), None)
            at = self.made.find(relation.objects[0]) if relation else None
        return False

    def _place(self, group: Group, size: Size) -> None:
        """Add the items of a group; of a habit, only as many as fit on their carriers."""
        color = sizing.color_of(group, self.brief.styles, self.rng, vocabulary.MATERIALS.get(group.thing.material, ""))
        if group.kind.name == "beam":
            number = group.count if group.count > 2 else max(3, round(self.room[1] / 1.3))
            made = beams(self.room, number, size, color, self.ids)
            self.items += made
            self._register(group, made)
            return
        hung: list[Item] = []
        placed = any(r.objects and r.objects[0] != "window" for r in group.relations)
        if group.kind.name == "curtain" and group.thing.support in (None, "wall") and not placed:
            most = group.count if group.asked else len(self.items)
            self.items, hung = hang_curtains(self.items, most, size, self.room[2], color, self.ids)
            if hung and len(hung) < group.count and group.asked:
                self.remarks.append("curtains hang in pairs, one pair before each window")
        carrier = self._carrier(group)
        support = group.thing.support or ("floor" if group.kind.support == "surface" else group.kind.support)
        size = self._fitted(group, size, support) if carrier is None else size
        number = 0 if hung else group.count
        tops = self._tops(carrier, number) if carrier else [None] * number
        made = [
            self._item(group, size, color, support if top is None else top)
            for top in tops
            if top is None or self._accepts(top, size, group)
        ]
        self.items += made
        self._register(group, [*hung, *made])

    def _register(self, group: Group, made: Sequence[Item]) -> None:
        self.item_ids[group.key] = [_item_id(i) for i in made]
        if group.asked:
            self.names |= {_item_id(i): group.key for i in made}

    def _tops(self, carrier: Group, number: int) -> list[int]:
        tops = self.item_ids.get(carrier.key, [])
        if number <= len(tops):
            return tops[:number]
        return [tops[i * len(tops) // number] for i in range(number)] if tops else []

    def _accepts(self, top: int, size: Size, group: Group) -> bool:
        """Whether one more thing goes on a top; things that were asked for always do."""
        item = next(i for i in self.items if i.id == top)
        small, large = sorted(size[:2]), sorted(item.size[:2])
        area = size[0] * size[1]
        taken = self.area_taken.get(top, 0.0) + area
        fits = taken <= _TOP_SHARE * item.size[0] * item.size[1] and small[0] < large[0] - 0.02 and small[1] < large[1]
        if fits or group.asked:
            self.area_taken[top] = taken
        return fits or group.asked

    def _fitted(self, group: Group, size: Size, support: str) -> Size:
        """The size, reduced to fit the room for hanging things, and for rugs without a stated width."""
        width, depth, height = size
        if support == "ceiling" and group.kind.name != "punching bag" and group.thing.height is None:
            height = round(max(min(height, self.room[2] - _OVERHEAD), 0.1), 3)
        flat = height < 0.05 and group.kind.support == "floor"
        if (flat or support in ("wall", "ceiling")) and group.thing.width is None:
            longest, shortest = max(self.room[:2]) - 0.3, min(self.room[:2]) - 0.3
            shrink = min(1.0, longest / max(width, depth), shortest / max(min(width, depth), 1e-3))
            if support == "wall":
                shrink = min(1.0, shortest / width)
                height = round(min(height, self.room[2] - 0.1), 3)
                return round(width * shrink, 3), depth, height
            return round(width * shrink, 3), round(depth * shrink, 3), height
        return size if support != "ceiling" else (width, depth, height)

    def _item(self, group: Group, size: Size, color: str, support: int | str) -> Item:
        kind = group.kind
        floor = support == "floor"
        flush = any(r.hard and r.name in _WITHOUT_AISLE and r.distance is None for r in group.relations)
        return Item(
            id=next(self.ids),
            label=self._label(group)[:80],
            color=color,
            size=size,
            support=support,
            height=self._height(group, size) if support == "wall" else None,
            clear=kind.clear if floor else (0.0, 0.0, 0.0, 0.0),
            backed=kind.backed and floor,
            aisle=kind.aisle if floor and not flush else 0.0,
            optional=not group.asked,
        )

    def _label(self, group: Group) -> str:
        """The name of the kind, or the noun that was said where two groups of one kind were named differently."""
        same = {g.thing.called for g, _ in self.sized if g.kind.name == group.kind.name and g.asked}
        return group.thing.called or group.kind.name if len(same) > 1 else group.kind.name

    def _height(self, group: Group, size: Size) -> float | None:
        """Height of the underside of a thing that hangs on a wall, metres; None where a wish decides it."""
        if any(b.name in ("above", "below", "under", "on") and b.objects for b in group.relations):
            return None
        top = self.room[2] - 0.05
        if group.kind.name == "curtain":
            return round(max(0.02, top - size[2]), 3)
        return round(max(min(HUNG_AT - size[2] / 2, top - size[2]), min(0.02, top)), 3) if size[2] < top else None

    # ---- wishes ----------------------------------------------------------------------------------------------------

    def _add_wishes(self, key: str, relation: GroupRelation, group: Group | None = None) -> None:
        """Add a relation between groups as wishes between their items."""
        subjects = self.item_ids.get(key, [])
        hard = relation.hard
        if relation.name == "at_window" and not self.item_ids["window"]:
            if hard:
                self.remarks.append(f"there is no window for the {key} to stand at")
            return
        if not relation.objects:
            if relation.name == "in_corner" and relation.sides:
                self._add_corners(subjects, hard)
                return
            walls: tuple[Wall | None, ...] = ("west", "east") if relation.sides else (relation.wall,)
            form = group.thing.arrangement if group is not None else None
            group_is_row = form is not None and form.form == "row" and relation.name == "against_wall"
            self.wishes += [
                Wish(subject=s, name=relation.name, hard=hard and (self._leads(s, subjects) or group_is_row),
                     wall=walls[k % len(walls)], distance=relation.distance)
                for k, s in enumerate(subjects)
            ]  # fmt: skip
            return
        groups = [self._ids(o) for o in relation.objects]
        if relation.name == "between":
            self._add_between(subjects, groups, hard)
            return
        others = groups[0]
        if relation.name == "aligned_with" and others == subjects:
            self.wishes += [Wish(subject=a, name="aligned_with", objects=(b,), hard=hard) for a, b in chained(subjects)]
            return
        if relation.name == "on" and group and self._carrier(group) is None:
            self._add_rug_wishes(group, subjects, others, hard)
            return
        aimed = relation.name in _AIMED
        for one, other in self._item_pairs(relation, subjects, others):
            if relation.name == "around" and one in self.formed.circled:
                gap = self.formed.circled[one]  # members of a circle that is placed singly keep it too
                self.wishes.append(Wish(subject=one, name="facing", objects=(other,), hard=hard, distance=gap))
                continue
            if relation.name == "far_from" and relation.distance is not None and one in self.formed.circled:
                continue  # the circle is that wide
            if relation.name in ("under", "below"):
                self._shelter_seats(one, other)
            leads = not aimed or self._leads(one, subjects)
            self._add_wish(one, relation.name, other, hard and leads, relation.distance)

    def _shelter_seats(self, table: int, roof: int) -> None:
        """Let the seats at a table that is under a roof be there too."""
        kind = knowledge.thing(next(i.label for i in self.items if i.id == roof))
        if kind is None or kind.under < ROOF:
            return
        loads = [_item_id(i) for i in self.items if i.support == table]
        self.wishes += [Wish(subject=i, name="under", objects=(roof,), hard=False) for i in loads]
        for group, _ in self.sized:
            for relation in group.relations:
                if relation.name == "around" and table in self._ids(relation.objects[0]):
                    seats = pairs(self.item_ids.get(group.key, []), self._ids(relation.objects[0]))
                    self.wishes += [Wish(subject=s, name="under", objects=(roof,), hard=False)
                                    for s, t in seats if t == table]  # fmt: skip

    def _add_corners(self, subjects: list[int], hard: bool) -> None:
        """Wishes that share things out over the corners of the room."""
        for k, one in enumerate(subjects):
            for wall in _CORNERS[k % len(_CORNERS)]:
                self.wishes.append(Wish(subject=one, name="in_corner", hard=hard, wall=wall))

    def _leads(self, one: int, subjects: list[int]) -> bool:
        """Whether a relation of a whole formation is asked of this member: of its middle one, the others follow."""
        if one not in self.formed.members or len(subjects) < 3:
            return True
        return one == subjects[len(subjects) // 2]

    def _item_pairs(self, relation: GroupRelation, subjects: list[int], others: list[int]) -> list[tuple[int, int]]:
        """Pairs of related items; for "on", each item with the item that carries it."""
        if (
            relation.name == "facing"
            and subjects == others
            and len(subjects) % 2 == 0
            and subjects[0] in self.formed.members
        ):
            half = len(subjects) // 2
            return [*zip(subjects, subjects[half:], strict=False), *zip(subjects[half:], subjects, strict=False)]
        if relation.name not in _CARRYING:
            return list(pairs(subjects, others))
        by_id = {i.id: i for i in self.items}
        return [(s, int(by_id[s].support)) for s in subjects if by_id[s].support in others]

    def _ids(self, name: str) -> list[int]:
        if name in self.item_ids:
            return self.item_ids[name]
        group = self.made.find(name)
        return self.item_ids.get(group.key, []) if group else []

    def _add_between(self, subjects: list[int], groups: list[list[int]], hard: bool) -> None:
        flat = groups[0][:2] if len(groups) == 1 else [g[0] for g in groups if g]
        if len(flat) == 2:
            ends = (flat[0], flat[1])
            self.wishes += [Wish(subject=s, name="between", objects=ends, hard=hard) for s in subjects if s not in ends]

    def _add_rug_wishes(self, group: Group, subjects: list[int], rugs: list[int], hard: bool) -> None:
        """Standing on a rug becomes the wish that the rug is under the thing; of chairs around a table, under that."""
        table = next((r for r in group.relations if r.name == "around" and r.objects), None)
        if table is not None and (others := self._ids(table.objects[0])):
            for one, rug in pairs(others, rugs):
                self.wishes.append(Wish(subject=rug, name="under", objects=(one,), hard=hard))
            hard = False
        for one, rug in pairs(subjects, rugs):
            self.wishes.append(Wish(subject=rug, name="under", objects=(one,), hard=hard))

    def _add_wish(self, one: int, name: str, other: int, hard: bool, distance: float | None = None) -> None:
        """Add one relation between two items. If a desk is said to face something, its chair faces that instead."""
        if one == other:
            return
        if name == "facing" and (sitter := self._chair_at(one)):
            self.wishes.append(Wish(subject=sitter, name="facing", objects=(other,), hard=hard))
            if other in self.item_ids["window"]:
                self.wishes.append(Wish(subject=one, name="at_window"))
            return
        if name in ("under", "below") and self._lacks_space(one, other):
            label = {i.id: i.label for i in self.items}
            self.remarks.append(f"there is no space under the {label[other]}; the {label[one]} stands next to it")
            self.wishes.append(Wish(subject=one, name="next_to", objects=(other,), hard=hard))
            return
        if self._hangs(other) and name in ("in_front_of", "behind"):  # a wall has no side but the one in the room
            self.wishes.append(Wish(subject=one, name="next_to", objects=(other,), hard=hard, distance=distance))
            if name == "in_front_of":
                self.wishes.append(Wish(subject=other, name="facing", objects=(one,), hard=hard))
            return
        self.wishes.append(Wish(subject=one, name=name, objects=(other,), hard=hard, distance=distance))
        if name == "in_front_of" and hard and self._has_front(other):
            self.wishes.append(Wish(subject=other, name="facing", objects=(one,), hard=False))

    def _lacks_space(self, one: int, other: int) -> bool:
        """Whether a thing on the floor does not fit under another one there."""
        items = {_item_id(i): i for i in self.items if i.id in (one, other)}
        upper, lower = items[other], items[one]
        on_floor = upper.support == lower.support == "floor" and lower.size[2] > STEP
        return on_floor and lower.size[2] > everyday.free_beneath(upper.label, upper.size[2])

    def _hangs(self, id: int) -> bool:
        return any(i.id == id and i.support == "wall" for i in self.items)

    def _has_front(self, id: int) -> bool:
        kind = knowledge.thing(next(i.label for i in self.items if i.id == id))
        return bool(kind and kind.front and kind.support == "floor")

    def _chair_at(self, id: int) -> int | None:
        """Id of the chair at a desk; None where the item is no desk or has no chair."""
        label = next(i.label for i in self.items if i.id == id)
        kind = knowledge.thing(label)
        if not kind or kind.role != "desk":
            return None
        for group, _ in self.sized:
            for relation in group.relations:
                if relation.name == "around" and group.kind.seats and id in self._ids(relation.objects[0]):
                    desks, chairs = self._ids(relation.objects[0]), self.item_ids.get(group.key, [])
                    return next((c for c, d in pairs(chairs, desks) if d == id), None)
        return None


def _first(name: int | str) -> int:
    assert isinstance(name, int)
    return name


def _item_id(item: Item) -> int:
    """The id of an item; items that are made here have numbers as ids."""
    assert isinstance(item.id, int)
    return item.id
