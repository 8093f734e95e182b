"""Turn a brief into a layout problem: the room's size, items with sizes, and hard and soft wishes between them.

Groups of the brief become items, and its relations become wishes; the layout solver fulfils them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import count

import numpy as np

from ...gaussians.world.person import HEADROOM, HUNG_AT
from ..layout.problem import Item, Keepout, Problem, Wish
from ..rooms.node import Size
from . import knowledge, sizing
from .brief import Brief
from .furnishing import Bond, Furnishing, Group, chained, furnish, pairs
from .openings import beams, draped, openings
from .sentence import vocabulary

_PACKED = 0.5  # share of a top that small things may take by habit
_OVERHEAD = HEADROOM + 0.05  # metres under what hangs from the ceiling
_FLUSH = ("against_wall", "in_corner", "at_window")  # said of a counter, nobody works behind it


@dataclass(frozen=True)
class Posed:
    """A problem, and how it came about.

    Attributes:
        problem: for the layout solver.
        names: id of the brief's thing for each item that was asked for.
        remarks: what was added or left away, a sentence each.
    """

    problem: Problem
    names: dict[int, str]
    remarks: tuple[str, ...] = ()


def problem_of(brief: Brief, seed: int = 0, *, grow: float = 1.0) -> Posed:
    """The layout problem that a brief poses. The same brief and seed give the same problem.

    Args:
        brief: what is wanted.
        seed: draws sizes, colours and which habits are taken in.
        grow: how much longer each side of the room is made that the brief does not state.
    """
    made = furnish(brief, np.random.default_rng([seed, 0]), sizing.stated_area(brief))
    sized = sizing.sized(made, np.random.default_rng([seed, 1]))
    room = sizing.room_size(brief, sized, np.random.default_rng([seed, 2]), grow)
    return _Pose(brief, made, sized, room, seed).posed()


class _Pose:
    """Builds the problem."""

    def __init__(
        self, brief: Brief, made: Furnishing, sized: Sequence[tuple[Group, Size]], room: Size, seed: int
    ) -> None:
        self.brief, self.made, self.sized, self.room = brief, made, sized, room
        self.rng = np.random.default_rng([seed, 3])
        self.ids: Iterator[int] = count(1)
        self.items: list[Item] = []
        self.wishes: list[Wish] = []
        self.of: dict[str, list[int]] = {}  # ids of each group's items
        self.load: dict[int, float] = {}  # square metres taken on each top
        self.remarks = list(made.remarks)
        self.names: dict[int, str] = {}

    def posed(self) -> Posed:
        doors, windows = openings(self.brief, self.room, self.rng, self.ids)
        self.items += [*doors, *windows]
        self.of |= {"door": [_number(d) for d in doors], "window": [_number(w) for w in windows]}
        carried = [(g, s) for g, s in self.sized if self._carrier(g)]
        for group, size in [*((g, s) for g, s in self.sized if not self._carrier(g)), *carried]:
            self._place(group, size)
        for relation in self.brief.relations:
            if relation.subject in ("door", "window"):
                bond = Bond(relation.name, relation.objects, relation.wall, relation.hard)
                self._wish(relation.subject, bond)
        for group, _ in self.sized:
            for bond in group.bonds:
                self._wish(group.key, bond, group)
        free = (Keepout(name="dance floor", radius=round(min(1.4, 0.22 * min(self.room[:2])), 2)),)
        problem = Problem(
            size=self.room,
            items=tuple(self.items),
            wishes=tuple(dict.fromkeys(self.wishes)),
            free=free if "dance floor" in self.brief.features else (),
            open=("south",),
        )
        return Posed(problem, self.names, tuple(dict.fromkeys(self.remarks)))

    # ---- items -----------------------------------------------------------------------------------------------------

    def _carrier(self, group: Group) -> Group | None:
        """What a group stands on, if that is another group; what stands on a rug stands on the floor."""
        if group.thing.support:
            return None
        for bond in group.bonds:
            if bond.name == "on" and bond.objects:
                other = self.made.find(bond.objects[0])
                if other and other is not group and other.kind.size[2][1] > 0.05 and not self._circular(group, other):
                    return other
        return None

    def _circular(self, group: Group, other: Group) -> bool:
        """Whether a group would end up standing on itself."""
        seen = {group.key}
        at: Group | None = other
        while at is not None:
            if at.key in seen:
                return True
            seen.add(at.key)
            bond = next((b for b in at.bonds if b.name == "on" and b.objects), None)
            at = self.made.find(bond.objects[0]) if bond else None
        return False

    def _place(self, group: Group, size: Size) -> None:
        """Items of a group, as many as there is room for where they are only a habit."""
        color = sizing.color_of(group, self.brief.styles, self.rng, vocabulary.MATERIALS.get(group.thing.material, ""))
        if group.kind.name == "beam":
            number = group.count if group.count > 2 else max(3, round(self.room[1] / 1.3))
            made = beams(self.room, number, size, color, self.ids)
            self.items += made
            self._know(group, made)
            return
        hung: list[Item] = []
        if group.kind.name == "curtain" and group.thing.support in (None, "wall"):
            most = group.count if group.asked else len(self.items)
            self.items, hung = draped(self.items, most, size, self.room[2], color, self.ids)
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
            if top is None or self._takes(top, size, group)
        ]
        self.items += made
        self._know(group, [*hung, *made])

    def _know(self, group: Group, made: Sequence[Item]) -> None:
        self.of[group.key] = [_number(i) for i in made]
        if group.asked:
            self.names |= {_number(i): group.key for i in made}

    def _tops(self, carrier: Group, number: int) -> list[int]:
        tops = self.of.get(carrier.key, [])
        if number <= len(tops):
            return tops[:number]
        return [tops[i * len(tops) // number] for i in range(number)] if tops else []

    def _takes(self, top: int, size: Size, group: Group) -> bool:
        """Whether a top has room for one more; what was asked for is put there in any case."""
        item = next(i for i in self.items if i.id == top)
        small, large = sorted(size[:2]), sorted(item.size[:2])
        area = size[0] * size[1]
        taken = self.load.get(top, 0.0) + area
        fits = taken <= _PACKED * item.size[0] * item.size[1] and small[0] < large[0] - 0.02 and small[1] < large[1]
        if fits or group.asked:
            self.load[top] = taken
        return fits or group.asked

    def _fitted(self, group: Group, size: Size, support: str) -> Size:
        """A size that the room can hold, for what adapts to it: what hangs, and rugs that nobody measured."""
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
        return Item(
            id=next(self.ids),
            label=kind.name[:80],
            color=color,
            size=size,
            support=support,
            height=self._height(group, size) if support == "wall" else None,
            clear=kind.clear if floor else (0.0, 0.0, 0.0, 0.0),
            backed=kind.backed and floor,
            aisle=0.0 if any(b.hard and b.name in _FLUSH for b in group.bonds) else kind.aisle if floor else 0.0,
            optional=not group.asked,
        )

    def _height(self, group: Group, size: Size) -> float | None:
        """Of the underside of what hangs on a wall; None where a wish decides it."""
        if any(b.name in ("above", "below", "under", "on") and b.objects for b in group.bonds):
            return None
        top = self.room[2] - 0.05
        if group.kind.name == "curtain":
            return round(max(0.02, top - size[2]), 3)
        return round(max(min(HUNG_AT - size[2] / 2, top - size[2]), min(0.02, top)), 3) if size[2] < top else None

    # ---- wishes ----------------------------------------------------------------------------------------------------

    def _wish(self, key: str, bond: Bond, group: Group | None = None) -> None:
        """A bond between groups as wishes between items."""
        subjects = self.of.get(key, [])
        hard = bond.hard
        if bond.name == "at_window" and not self.of["window"]:
            if hard:
                self.remarks.append(f"there is no window for the {key} to stand at")
            return
        if not bond.objects:
            self.wishes += [Wish(subject=s, name=bond.name, hard=hard, wall=bond.wall) for s in subjects]
            return
        groups = [self._ids(o) for o in bond.objects]
        if bond.name == "between":
            self._between(subjects, groups, hard)
            return
        others = groups[0]
        if bond.name == "aligned_with" and others == subjects:
            self.wishes += [Wish(subject=a, name="aligned_with", objects=(b,), hard=hard) for a, b in chained(subjects)]
            return
        if bond.name == "on" and group and self._carrier(group) is None:
            self._rug(subjects, others, hard)
            return
        for one, other in self._paired(group, bond, subjects, others):
            self._one(one, bond.name, other, hard)

    def _paired(self, group: Group | None, bond: Bond, subjects: list[int], others: list[int]) -> list[tuple[int, int]]:
        """Which item of a group relates to which: what stands on something, to just that."""
        if bond.name != "on":
            return list(pairs(subjects, others))
        by_id = {i.id: i for i in self.items}
        return [(s, int(by_id[s].support)) for s in subjects if by_id[s].support in others]

    def _ids(self, name: str) -> list[int]:
        if name in self.of:
            return self.of[name]
        group = self.made.find(name)
        return self.of.get(group.key, []) if group else []

    def _between(self, subjects: list[int], groups: list[list[int]], hard: bool) -> None:
        flat = groups[0][:2] if len(groups) == 1 else [g[0] for g in groups if g]
        if len(flat) == 2:
            ends = (flat[0], flat[1])
            self.wishes += [Wish(subject=s, name="between", objects=ends, hard=hard) for s in subjects if s not in ends]

    def _rug(self, subjects: list[int], rugs: list[int], hard: bool) -> None:
        """Standing on a rug: the rug is under it."""
        for one, rug in pairs(subjects, rugs):
            self.wishes.append(Wish(subject=rug, name="under", objects=(one,), hard=hard))

    def _one(self, one: int, name: str, other: int, hard: bool) -> None:
        """One relation between two items; who sits at a desk looks where the desk is said to face."""
        if one == other:
            return
        if name == "facing" and hard and (sitter := self._sitter(one)):
            self.wishes.append(Wish(subject=sitter, name="facing", objects=(other,)))
            if other in self.of["window"]:
                self.wishes.append(Wish(subject=one, name="at_window"))
            return
        self.wishes.append(Wish(subject=one, name=name, objects=(other,), hard=hard))
        if name == "in_front_of" and hard and self._has_front(other):
            self.wishes.append(Wish(subject=other, name="facing", objects=(one,), hard=False))

    def _has_front(self, id: int) -> bool:
        kind = knowledge.thing(next(i.label for i in self.items if i.id == id))
        return bool(kind and kind.front and kind.support == "floor")

    def _sitter(self, id: int) -> int | None:
        """The chair at a desk."""
        label = next(i.label for i in self.items if i.id == id)
        kind = knowledge.thing(label)
        if not kind or kind.role != "desk":
            return None
        for group, _ in self.sized:
            for bond in group.bonds:
                if bond.name == "around" and group.kind.seats and id in self._ids(bond.objects[0]):
                    desks, chairs = self._ids(bond.objects[0]), self.of.get(group.key, [])
                    return next((c for c, d in pairs(chairs, desks) if d == id), None)
        return None


def _number(item: Item) -> int:
    """The id of an item made here, always a number."""
    assert isinstance(item.id, int)
    return item.id
