"""Formations: rows, grids, circles, pairs that face each other, and things on both sides of another one.

Each becomes a rigid group of the layout problem, with the places of its members worked out here. Lengths are metres; a
thing's front is its -y side at yaw 0.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import atan2, ceil, cos, degrees, pi, sin, sqrt, tan
from types import MappingProxyType

from ...gaussians.world import everyday
from ...gaussians.world.box import YawBox, plan_gap
from ...gaussians.world.person import STEP
from ..layout.problem import Item, Rigid
from .furnishing import Group, GroupRelation, pairs

Place = tuple[int, float, float, float]  # id, x, y, yaw
_PASSAGE = 0.62  # between rows, to walk through
_AISLE = 0.9  # between two columns of benches
_TALK = 1.2  # between two that face each other
_KNEES = 0.45  # between a seat and the table before it
_SEAT_GAP = 0.03  # between a table and its chairs
_IN_REACH = 0.75  # from outside a circle to what is in its middle, over the things in the circle
_OPENING = 0.65  # in a circle, to walk in
_TRUNK = 0.07  # of a tree's width: radius of its trunk
_MOST_AT_ROUND = 4  # seats that the four sides of a round table hold


@dataclass(frozen=True)
class Formed:
    """The rigid groups, the ids of the things in them, and the gaps, metres, to the thing in their middle of those that
    stand in a circle around one."""

    rigid: tuple[Rigid, ...]
    members: frozenset[int]
    circled: Mapping[int, float] = field(default_factory=dict)


class Formations:
    """Finds the formations among the groups of a room.

    Args:
        groups: all groups.
        ids: ids of the items of each group, by its key.
        items: by id.
        find: the key of the group that a relation names, "" if there is none.
    """

    def __init__(
        self,
        groups: Sequence[Group],
        ids: Mapping[str, Sequence[int]],
        items: Mapping[int, Item],
        find: Callable[[str], str],
    ) -> None:
        self.groups, self.ids, self.items, self.find = groups, ids, items, find
        self.bound: set[int] = set()
        self.circled: dict[int, float] = {}

    def run(self) -> Formed:
        """All formations; a thing belongs to one at most."""
        found = list[Rigid]()
        for finder in (self._arranged, self._facing, self._flanked, self._circled, self._between, self._beneath):
            for group in self.groups:
                for places in finder(group):
                    own = {p[0] for p in places}
                    if len(places) > 1 and not own & self.bound and all(map(self._is_free, own)):
                        self.bound |= own
                        found.append(Rigid(members=tuple(_from_first(places))))
        return Formed(tuple(found), frozenset(self.bound), MappingProxyType(self.circled))

    def _is_free(self, id: int) -> bool:
        item = self.items[id]
        return item.support == "floor" and item.stand is None and item.size[2] > STEP

    def _objects(self, relation: GroupRelation) -> list[int]:
        return list(self.ids.get(self.find(relation.objects[0]), ())) if relation.objects else []

    # ---- rows, grids, circles --------------------------------------------------------------------------------------

    def _arranged(self, group: Group) -> Iterator[list[Place]]:
        said, own = group.thing.arrangement, list(self.ids.get(group.key, ()))
        if (
            said is None
            or len(own) < 2
            or (said.form == "grid" and said.rows in (None, 2) and self._faces_itself(group))
        ):
            return
        if said.form == "circle" and len(own) > 2:
            middle = self._middle(group)
            if middle is None and any(r.name == "facing" and r.objects for r in group.relations):
                yield self._arc(own)
            else:
                yield self._ring(own, middle, said.gap, self._stated_gap(group, middle))
        elif said.form == "back_to_back":
            yield self._back_to_back(own)
        elif said.form in ("row", "grid"):
            rows = 1 if said.form == "row" else said.rows or max(2, round(sqrt(len(own) / 1.5)))
            columns = said.columns or ceil(len(own) / rows)
            yield self._grid(group, own, columns, said.gap)

    def _faces_itself(self, group: Group) -> bool:
        own = list(self.ids.get(group.key, ()))
        return len(own) % 2 == 0 and any(r.name == "facing" and self._objects(r) == own for r in group.relations)

    def _middle(self, group: Group) -> int | None:
        """The single thing on the floor that a circle is around."""
        for relation in group.relations:
            others = self._objects(relation)
            single = len(others) == 1 and others[0] not in self.bound and self._is_free(others[0])
            if relation.name in ("around", "facing") and single:
                return others[0]
        return None

    def _stated_gap(self, group: Group, middle: int | None) -> float | None:
        """The metres from a circle to what is in its middle, where stated."""
        said = (r.distance for r in group.relations if r.distance is not None and self._objects(r) == [middle])
        return next(said, None)

    def _arc(self, own: Sequence[int]) -> list[Place]:
        """Things in an arc, turned to its middle, where what they face stands elsewhere."""
        across, span = self.items[own[0]].size[0] + 0.1, pi / 2
        radius = max(_TALK, (len(own) - 1) * across / span)
        turns = [(k - (len(own) - 1) / 2) * across / radius for k in range(len(own))]
        return [(id, radius * sin(a), radius * (cos(a) - 1.0), -degrees(a)) for id, a in zip(own, turns, strict=True)]

    def _ring(
        self, own: Sequence[int], middle: int | None, gap: float | None = None, away: float | None = None
    ) -> list[Place]:
        """Things in a circle, turned to its middle; a wide one around something has an opening to walk in.

        Args:
            own: ids of the things.
            middle: id of the thing in their middle, if there is one.
            gap: metres between neighbours, where stated.
            away: metres from that thing, where stated.
        """
        width, depth, _ = self.items[own[0]].size
        across = width + (0.08 if gap is None else gap)
        inner = across / (2 * tan(pi / len(own))) if len(own) > 2 else 0.3
        places, pitch, start = list[Place](), 2 * pi / len(own), -pi / 2
        if middle is not None:
            w, d, _ = self.items[middle].size
            half = sqrt(w * w + d * d) / 2
            inner = max(inner, half + 0.12 if away is None else max(w, d) / 2 + away)
            if inner - half + depth > _IN_REACH and 2 * pi * inner - len(own) * across < _OPENING:
                inner = 1.05 * (len(own) * across + _OPENING) / (2 * pi)
                pitch = 2 * atan2(across / 2, inner)
                start += (2 * pi - (len(own) - 1) * pitch) / 2
            places = [(middle, 0.0, 0.0, 0.0)]
        for k, id in enumerate(own):
            turn = start + k * pitch
            x, y = (inner + depth / 2) * cos(turn), (inner + depth / 2) * sin(turn)
            places.append((id, x, y, degrees(atan2(-cos(turn), sin(turn)))))
            if middle is not None:
                box, inside = YawBox(x, y, 0.0, width, depth, 1.0, places[-1][3]), self.items[middle].size
                self.circled[id] = round(float(plan_gap(box, YawBox(0.0, 0.0, 0.0, *inside, 0.0))), 3)
        return places

    def _grid(self, group: Group, own: Sequence[int], columns: int, gap: float | None) -> list[Place]:
        """Things in rows one behind the other, all turned the same way; the first row is in front."""
        width, depth, _ = self.items[own[0]].size
        aside, before, behind = self._seat_space(group, own[0])
        apart = gap if gap is not None else self._gap(group, columns)
        pitch_x, pitch_y = width + 2 * aside + apart, depth + before + behind + max(gap or 0.0, _PASSAGE)
        return [(id, (k % columns) * pitch_x, (k // columns) * pitch_y, 0.0) for k, id in enumerate(own)]

    def _gap(self, group: Group, columns: int) -> float:
        kind = group.kind
        if kind.seats > 1:
            return _AISLE if columns == 2 else 0.25
        return 0.08 if kind.seats == 1 else 0.62 if kind.top else 0.3

    def _seat_space(self, group: Group, id: int) -> tuple[float, float, float]:
        """Metres that the seats at a thing take at its sides, before and behind it."""
        chairs = [g for g in self.groups for r in g.relations if r.name == "around" and id in self._objects(r)]
        count = sum(len(self.ids.get(g.key, ())) for g in chairs) / max(len(self.ids[group.key]), 1)
        if not chairs or not count:
            return 0.0, 0.0, 0.0
        ids = [i for g in chairs for i in self.ids.get(g.key, ())]
        deep = max((self.items[i].size[1] for i in ids), default=0.0) + _SEAT_GAP
        return (deep if count > 2 else 0.0), deep, (deep if count > 1 else 0.0)

    def _back_to_back(self, own: Sequence[int]) -> list[Place]:
        """Two rows whose backs touch."""
        half = ceil(len(own) / 2)
        width, depth, _ = self.items[own[0]].size
        front = [(id, k * (width + 0.05), 0.0, 0.0) for k, id in enumerate(own[:half])]
        return [*front, *((id, k * (width + 0.05), depth + 0.02, 180.0) for k, id in enumerate(own[half:]))]

    # ---- pairs and things at both sides ----------------------------------------------------------------------------

    def _facing(self, group: Group) -> Iterator[list[Place]]:
        """Things that face each other, in two rows, with what is between them."""
        own = list(self.ids.get(group.key, ()))
        relation = next((r for r in group.relations if r.name == "facing" and self._objects(r) == own), None)
        if relation is None or len(own) < 2 or len(own) % 2 or self._at_walls(group):
            return
        half, (width, depth, _) = len(own) // 2, self.items[own[0]].size
        step = width + (0.08 if group.kind.seats == 1 else 0.2)
        if group.kind.role == "desk":  # people at desks face each other over their desks
            yield [*((id, k * step, 0.0, 0.0) for k, id in enumerate(own[:half])),
                   *((id, k * step, depth + 0.02, 180.0) for k, id in enumerate(own[half:]))]  # fmt: skip
            return
        middle = [i for g in self.groups for r in g.relations if r.name == "between" for i in self.ids.get(g.key, ())
                  if set(self._objects(r)) == set(own) and self._is_free(i)]  # fmt: skip
        deep = max((self.items[i].size[1] for i in middle), default=0.0)
        gap = relation.distance if relation.distance is not None else deep + 2 * _KNEES if middle else _TALK
        places = [(id, k * step, 0.0, 0.0) for k, id in enumerate(own[:half])]
        places += [(id, k * step, -(depth + gap), 180.0) for k, id in enumerate(own[half:])]
        along = (half - 1) * step / 2 - sum(self.items[i].size[0] + 0.1 for i in middle) / 2
        for i in middle:
            along += self.items[i].size[0] / 2
            places.append((i, along, -(depth + gap) / 2, 0.0))
            along += self.items[i].size[0] / 2 + 0.1
        yield places

    def _at_walls(self, group: Group) -> bool:
        return any(r.hard and r.name in ("against_wall", "in_corner", "at_window") for r in group.relations)

    def _flanked(self, group: Group) -> Iterator[list[Place]]:
        """A thing with others on both of its sides."""
        for relation in group.relations:
            if not relation.sides or not relation.objects:
                continue
            shared: dict[int, list[int]] = {}
            for one, other in pairs(list(self.ids.get(group.key, ())), self._objects(relation)):
                shared.setdefault(other, []).append(one)
            for other, own in shared.items():
                if len(own) > 1:
                    yield self._both_sides(other, own, relation.name == "around")

    def _both_sides(self, other: int, own: Sequence[int], seated: bool) -> list[Place]:
        (w, d, _), (width, depth, _) = self.items[other].size, self.items[own[0]].size
        left, right = own[: len(own) // 2], own[len(own) // 2 :]
        places: list[Place] = [(other, 0.0, 0.0, 0.0)]
        if seated and len(own) > 2:
            for side, those in ((-1, left), (1, right)):
                for k, id in enumerate(those):
                    x = ((k + 0.5) / len(those) - 0.5) * w
                    places.append((id, x, side * (d / 2 + _SEAT_GAP + depth / 2), 180.0 if side < 0 else 0.0))
            return places
        y = 0.0 if seated else d / 2 - depth / 2 if self.items[other].backed else 0.0
        for side, those in ((-1, left), (1, right)):
            for k, id in enumerate(those):
                across = depth if seated else width
                x = side * (w / 2 + 0.05 + across / 2 + k * (across + 0.05))
                places.append((id, x, y, -90.0 * side if seated else 0.0))
        return places

    def _circled(self, group: Group) -> Iterator[list[Place]]:
        """A round thing, or one with short sides, with more things around it than its sides hold."""
        for relation in group.relations:
            if relation.name != "around":
                continue
            shared: dict[int, list[int]] = {}
            for one, other in pairs(list(self.ids.get(group.key, ())), self._objects(relation)):
                shared.setdefault(other, []).append(one)
            for other, own in shared.items():
                round_one = self._kind_is_round(relation)
                if len(own) > self._seats_at(other, own[0]) or (round_one and len(own) > _MOST_AT_ROUND):
                    yield self._ring(own, other)

    def _kind_is_round(self, relation: GroupRelation) -> bool:
        key = self.find(relation.objects[0])
        return any(g.kind.round for g in self.groups if g.key == key)

    def _seats_at(self, other: int, one: int) -> int:
        """How many things fit at the four sides of another."""
        (w, d, _), width = self.items[other].size, self.items[one].size[0]
        free = 2 if not self.items[other].backed else 1
        return sum(n * max(int((side + 0.08) / (width + 0.08)), 1) for side, n in ((w, free), (d, 2)))

    def _between(self, group: Group) -> Iterator[list[Place]]:
        """Something between two things that stand with their backs to a wall: a nightstand between two beds."""
        for relation in group.relations:
            own, others = list(self.ids.get(group.key, ())), self._objects(relation)
            if relation.name != "between" or len(relation.objects) > 1 or len(others) != 2 or not own:
                continue
            if not all(self.items[i].backed for i in (*own, *others)):
                continue
            line = [others[0], *own, others[1]]
            places, x = list[Place](), 0.0
            deepest = max(self.items[i].size[1] for i in line)
            for id in line:
                width, depth, _ = self.items[id].size
                x += width / 2
                places.append((id, x, (deepest - depth) / 2, 0.0))
                x += width / 2 + 0.06
            yield places

    def _beneath(self, group: Group) -> Iterator[list[Place]]:
        """Something under a tree, beside its trunk."""
        for relation in group.relations:
            own, others = list(self.ids.get(group.key, ())), self._objects(relation)
            if relation.name not in ("under", "below") or len(own) != 1 or len(others) != 1:
                continue
            if everyday.shape(self.items[others[0]].label) == "tree" and self._is_free(others[0]):
                (w, _, _), (_, depth, _) = self.items[others[0]].size, self.items[own[0]].size
                yield [(others[0], 0.0, 0.0, 0.0), (own[0], 0.0, -(_TRUNK * w + depth / 2 + 0.03), 0.0)]


def _from_first(places: Sequence[Place]) -> Iterator[Place]:
    """The places in the axes of the first thing."""
    _, x0, y0, yaw0 = places[0]
    turn = -yaw0 * pi / 180
    for id, x, y, yaw in places:
        dx, dy = x - x0, y - y0
        yield (
            id,
            round(dx * cos(turn) - dy * sin(turn), 4),
            round(dx * sin(turn) + dy * cos(turn), 4),
            round((yaw - yaw0 + 180.0) % 360.0 - 180.0, 4),
        )
