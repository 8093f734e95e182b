"""Wishes for the floor: some of it free, furniture at the walls, seats that see, things spread out, a reading corner.

Knows each of these wishes as layout wishes of some things. Refuses to know the solver's ways (solving.py), and figures
(formations.py).
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

from ...gaussians.language.query.query import Query
from ...gaussians.world import kinds
from ...gaussians.world.person import HEADROOM, STEP
from ...tools.operation import Placement
from ...tools.ops.insert import Insert
from ..layout import Keepout
from ..layout import Wish as LayoutWish
from ..rooms.node import Node
from . import solving
from .goals import Clear, ReadingCorner, See, Spread, Walls, Where
from .room import SMALL, CannotError, Id, Room, copied, toward

_DANCE = 0.3  # of the shorter side of the room is the radius of a dance floor
# Metres of floor for what people do, and for what is no kind of thing.
_WIDTHS = {"exercise": 2.0, "exercises": 2.0, "yoga": 1.9, "dancing": 2.4, "dance": 2.4, "play": 1.6, "kids": 1.8,
           "tree": 1.4, "wheelchair": 1.6}  # fmt: skip
_AROUND = 0.1  # metres of floor more than a thing is long
_LEAST, _MOST = 0.35, 1.6  # metres, radius of floor that was asked for without a size
_STEPS = (1.0, 0.85, 0.7, 0.55)  # shares of that radius that are tried before giving up


def clear(room: Room, goal: Clear, free: Collection[Id] = (), wishes: Sequence[LayoutWish] = ()) -> None:
    """Keep a disc of floor free; what stands in it goes as near as it may, other things only if they must.

    Args:
        free: what may move for another wish anyway, with that wish.

    Raises:
        CannotError: the floor cannot be freed.
    """
    wanted = _radius(room, goal)
    # Without a size in words less is still what was asked for.
    for share in (1.0,) if goal.width is not None else _STEPS:
        radius = wanted * share
        disc = _disc(room, goal.where, radius)
        keep = Keepout(name=goal.called, radius=radius + solving.GAP, center=disc)
        stuck = [n for n in room.nodes.values() if solving.in_disc(n, (*disc, radius)) and _in_the_way(room, n)]
        if stuck:
            reason = f"the {stuck[0].label} stays where it is, and stands in the way"
            continue
        inside = {n.id for n in room.nodes.values() if room.moves(n) and solving.in_disc(n, (*disc, keep.radius))}
        party, bound = solving.seated(room, inside) if not wishes else (set[Id](), [])
        tries = [frozenset(inside | party | set(free)), _movable(room)]
        try:
            if tries[0]:
                solving.eased(room, tries, [*wishes, *bound], [keep], "things are in the way")
        except CannotError as error:
            reason = str(error)
            continue
        what_for = "" if goal.called.startswith("free ") else f" for {goal.called}"
        room.told.append(f"{2 * radius:.1f} m of floor {_place(goal.where)} are free{what_for}")
        return
    raise CannotError(f"no floor can be freed {_place(goal.where)}: {reason}")


def _place(where: Where) -> str:
    if where.anchor is None:
        return "in the middle"
    return f"{where.relation.replace('_', ' ')} {where.anchor.describe()}"


def _in_the_way(room: Room, node: Node) -> bool:
    """Whether a thing that stays takes floor."""
    return node.bottom < HEADROOM and node.size[2] > STEP and node.support == "floor" and not room.moves(node)


def _radius(room: Room, goal: Clear) -> float:
    if goal.width is not None:
        return goal.width / 2
    if "floor" not in goal.called:
        if (kind := kinds.of(goal.called)) is not None:
            return max(high for _, high in kind.size[:2]) / 2 + _AROUND / 2
        for name, width in _WIDTHS.items():
            if name in goal.called:
                return width / 2
    share = _DANCE * min(room.size[:2]) if goal.where.anchor is None else 0.2 * min(room.size[:2])
    return min(max(share, _LEAST), _MOST)


def _disc(room: Room, where: Where, radius: float) -> tuple[float, float]:
    """Where the middle of the free floor is.

    Raises:
        CannotError: what it is near to is not there.
    """
    anchor = room.one(where.anchor) if where.anchor is not None else None
    if anchor is None:
        return (0.0, 0.0)
    front = math.radians(anchor.yaw)
    away = (math.sin(front), -math.cos(front))
    if where.relation == "next_to" and anchor.support == "floor" and room.moves(anchor):
        away = _free_side(room, anchor, radius)
    reach = radius + abs(_extent(anchor, away)) / 2 + solving.GAP
    x, y = anchor.position[0] + reach * away[0], anchor.position[1] + reach * away[1]
    most = [room.size[i] / 2 - radius - 0.02 for i in range(2)]
    return (max(-most[0], min(x, most[0])), max(-most[1], min(y, most[1])))


def _extent(node: Node, way: tuple[float, float]) -> float:
    turn = math.radians(node.yaw)
    along = way[0] * math.cos(turn) + way[1] * math.sin(turn)
    across = -way[0] * math.sin(turn) + way[1] * math.cos(turn)
    return abs(along) * node.size[0] + abs(across) * node.size[1]


def _free_side(room: Room, node: Node, radius: float) -> tuple[float, float]:
    """The side of a thing on which the most floor is."""

    def crowd(way: tuple[float, float]) -> float:
        reach = radius + _extent(node, way) / 2
        x, y = node.position[0] + reach * way[0], node.position[1] + reach * way[1]
        out = max(abs(x) + radius - room.size[0] / 2, abs(y) + radius - room.size[1] / 2, 0.0)
        met = sum(
            solving.in_disc(n, (x, y, radius)) for n in room.nodes.values() if n.id != node.id and n.size[2] > 0.05
        )
        return 3.0 * out + met

    turn = math.radians(node.yaw)
    ways = [(math.cos(turn + k * math.pi / 2), math.sin(turn + k * math.pi / 2)) for k in range(4)]
    return min(ways, key=crowd)


def walled(room: Room, goal: Walls) -> tuple[set[Id], list[LayoutWish]]:
    """What is to be at a wall and is not, and the wishes for that.

    Raises:
        CannotError: what was named is not there, or stays where it is.
    """
    named = room.find(goal.things)
    loose = [n for n in named if room.moves(n) and not solving.at_wall(room, n)]
    if not [n for n in named if room.moves(n)]:
        raise CannotError("nothing there can be moved")
    return {n.id for n in loose}, [LayoutWish(subject=n.id, name="against_wall") for n in loose]


def push(room: Room, goals: Sequence[Walls], floor: Clear | None) -> None:
    """Things to the walls, with some floor kept free where that is wished as well.

    Raises:
        CannotError: there is no room at the walls.
    """
    found = [walled(room, g) for g in goals]
    free = set().union(*(ids for ids, _ in found))
    wishes = list(dict.fromkeys(w for _, ws in found for w in ws))
    if floor is not None:
        clear(room, floor, free, wishes)
    elif free:
        tries = [frozenset(free), _movable(room)]
        solving.eased(room, tries, wishes, [], "not everything finds a place at a wall")
    count = len(free)
    room.told.append(f"{count} thing{'s' if count != 1 else ''} pushed to the walls" if free else "all is at the walls")


def see(room: Room, goal: See) -> None:
    """Seats turned to what they should see, moved only where something is in between.

    Raises:
        CannotError: there is nothing to see, or no seat.
    """
    seats = room.find(goal.things or Query(text="seat", pick="all"))
    seats = [n for n in seats if room.moves(n)]
    view = room.one(goal.goal)
    if view is None or not seats:
        raise CannotError("there is nothing to turn, or nothing to see")
    wishes = [LayoutWish(subject=n.id, name="facing", objects=(view.id,)) for n in seats if n.id != view.id]
    blind = {n.id for n in seats if not _sees(n, view)}
    reason = ""
    for loose in dict.fromkeys((frozenset(blind), frozenset(n.id for n in seats))):
        trial = copied(room)
        try:
            _turned(trial, loose, view)
            left = {id for id in loose if not _sees(trial.nodes[id], view)}
            if left:
                solving.rearranged(trial, left, [w for w in wishes if w.subject in left], [])
        except CannotError as error:
            reason = str(error)
            continue
        room.nodes = trial.nodes
        room.told.append(f"{len(seats)} seat{'s' if len(seats) != 1 else ''} see the {view.label or 'thing'}")
        return
    raise CannotError(f"not every seat can be turned to the {view.label}: {reason}")


def _turned(room: Room, seats: Collection[Id], view: Node) -> None:
    """Turn on the spot what has the room for it."""
    for id in seats:
        node = room.nodes[id]
        for step in (5.0, 45.0, 90.0):
            yaw = step * round(toward(node, view.position[:2]) / step)
            turned = node.model_copy(update={"yaw": yaw})
            if _sees(turned, view) and room.fits(id, node.position[0], node.position[1], yaw):
                room.put(id, node.position[0], node.position[1], yaw)
                break


def _sees(node: Node, view: Node) -> bool:
    """Whether a thing's front is turned to another within 40 degrees."""
    off = toward(node, view.position[:2]) - node.yaw
    return abs(math.remainder(off, 360.0)) <= 40.0


def spread(room: Room, goal: Spread) -> None:
    """Things as far from each other as they can be, each near a wall or corner of its own.

    Raises:
        CannotError: they cannot be moved, or there is only one.
    """
    things = [n for n in room.find(goal.things) if room.moves(n)]
    if len(things) < 2:
        raise CannotError("two things at least can be spread out")
    spots = _targets(room, things)
    for node in sorted(things, key=lambda n: -math.prod(n.size[:2])):
        free = [s for s in spots if room.fits(node.id, *s, node.yaw, but=[n.id for n in things if n.id != node.id])]
        if not free:
            raise CannotError(f"there is no free spot for the {node.label}")
        done = [n for n in things if n.id != node.id and room.nodes[n.id] != n]
        best = max(free, key=lambda s: _apart(s, node, [room.nodes[n.id] for n in done]))
        room.put(node.id, *best, node.yaw)
    if any(room.taken(room.nodes[n.id]) for n in things):
        raise CannotError("there is no room to spread them out")
    room.told.append(f"{len(things)} things spread out")


def _targets(room: Room, things: Sequence[Node]) -> list[tuple[float, float]]:
    """Places along the walls and in the corners."""
    reach = max(max(n.size[:2]) for n in things) / 2 * 1.2 + solving.MARGIN
    x, y = room.size[0] / 2 - reach, room.size[1] / 2 - reach
    count = 12
    steps = [-1 + 2 * k / count for k in range(count + 1)]
    return list(
        dict.fromkeys(
            [*((s * x, t * y) for s in steps for t in (-1, 1)), *((t * x, s * y) for s in steps for t in (-1, 1))]
        )
    )


def _apart(spot: tuple[float, float], node: Node, done: Sequence[Node]) -> float:
    """The distance to the nearest of those that have their place; the first one stays where it is, nearly."""
    if not done:
        return -math.dist(spot, node.position[:2])
    return min(math.dist(spot, n.position[:2]) for n in done) - 0.1 * math.dist(spot, node.position[:2])


def reading_corner(room: Room, goal: ReadingCorner) -> None:
    """A seat in a corner or where it was said, a lamp and a table beside it; what is missing is added.

    Raises:
        CannotError: there is no room for it.
    """
    pieces = [_first(room, labels) or _new(room, labels[0]) for labels in _READING]
    seat, *others = pieces
    wishes = [LayoutWish(subject=n.id, name="next_to", objects=(seat.id,)) for n in others]
    anchor = room.one(goal.where.anchor) if goal.where is not None and goal.where.anchor is not None else None
    if anchor is None:
        wishes.append(LayoutWish(subject=seat.id, name="in_corner"))
    else:
        wishes.append(LayoutWish(subject=seat.id, name="next_to", objects=(anchor.id,)))
    trial = copied(room)
    trial.nodes |= {n.id: n for n in pieces}
    mine = frozenset(n.id for n in pieces)
    small = frozenset(n.id for n in room.nodes.values() if room.moves(n) and max(n.size[:2]) < 2 * SMALL)
    solving.eased(
        trial, [mine, mine | small, mine | _movable(room)], wishes, [], "there is no room for a reading corner"
    )
    for node in pieces:
        if node.id not in room.nodes:
            there = trial.nodes.pop(node.id)
            place = Placement(relation="against" if node is seat else "on", offset=there.position[:2])
            room.ops.append(Insert(asset=node.label, place=place))
    room.nodes = trial.nodes
    room.told.append("a seat, a lamp and a table make a reading corner")


_READING = (("armchair", "chair"), ("floor lamp",), ("side table", "stool"))


def _new(room: Room, label: str) -> Node:
    """A thing that is not there yet, as large as such things are at most, in the middle of the room."""
    width, depth, height = (0.9 * most for _, most in kinds.table().kinds[label].size)
    return Node(id=f"new {label}", label=label, size=(width, depth, height), position=(0.0, 0.0, height / 2))


def _movable(room: Room) -> frozenset[Id]:
    return frozenset(n.id for n in room.nodes.values() if room.moves(n))


def _first(room: Room, labels: Sequence[str]) -> Node | None:
    """The first thing of one of these names that may move."""
    nodes = (n for label in labels for n in room.nodes.values() if n.label == label and room.moves(n))
    return next(nodes, None)
