"""Goals for the floor: free floor, furniture at the walls, seats that face something, spreading out, a reading corner.

Most of them become layout wishes, which rearrange.py solves.
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
from . import rearrange
from .goals import Clear, ReadingCorner, See, Spread, Walls, Where
from .room import SMALL, Id, Room, WishError, copy_of, toward

_DANCE_FLOOR = 0.3  # radius of a dance floor as a share of the shorter side of the room
# Metres of floor for activities, and for things that are not in the table of kinds.
_WIDTHS = {"exercise": 2.0, "exercises": 2.0, "yoga": 1.9, "dancing": 2.4, "dance": 2.4, "play": 1.6, "kids": 1.8,
           "tree": 1.4, "wheelchair": 1.6}  # fmt: skip
_AROUND = 0.1  # metres of floor added to the length of a thing
_MIN_RADIUS, _MAX_RADIUS = 0.35, 1.6  # metres, limits on the radius of free floor without a given size
_RADIUS_STEPS = (1.0, 0.85, 0.7, 0.55)  # shares of that radius that are tried in order


def clear_floor(room: Room, goal: Clear, free: Collection[Id] = (), wishes: Sequence[LayoutWish] = ()) -> None:
    """Keep a disc of floor free; things in it move nearby, other things move only if that fails.

    Args:
        free: things that may move because of `wishes`.
        wishes: layout wishes that must hold as well.

    Raises:
        WishError: the floor cannot be freed.
    """
    wanted = _radius(room, goal)
    # If no size was given, a smaller disc still fulfils the wish.
    for share in (1.0,) if goal.width is not None else _RADIUS_STEPS:
        radius = wanted * share
        disc = _disc_center(room, goal.where, radius)
        keep = Keepout(name=goal.called, radius=radius + rearrange.GAP, center=disc)
        stuck = [n for n in room.nodes.values() if rearrange.in_disc(n, (*disc, radius)) and _in_the_way(room, n)]
        if stuck:
            reason = f"the {stuck[0].label} stays where it is, and stands in the way"
            continue
        inside = {
            n.id for n in room.nodes.values() if room.is_movable(n) and rearrange.in_disc(n, (*disc, keep.radius))
        }
        party, bound = rearrange.chairs_at_tables(room, inside) if not wishes else (set[Id](), [])
        tries = [frozenset(inside | party | set(free)), _movable(room)]
        try:
            if tries[0]:
                rearrange.rearrange_stepwise(room, tries, [*wishes, *bound], [keep], "things are in the way")
        except WishError as error:
            reason = str(error)
            continue
        what_for = "" if goal.called.startswith("free ") else f" for {goal.called}"
        room.done.append(f"{2 * radius:.1f} m of floor {_where_in_words(goal.where)} are free{what_for}")
        return
    raise WishError(f"no floor can be freed {_where_in_words(goal.where)}: {reason}")


def _where_in_words(where: Where) -> str:
    if where.anchor is None:
        return "in the middle"
    return f"{where.relation.replace('_', ' ')} {where.anchor.describe()}"


def _in_the_way(room: Room, node: Node) -> bool:
    """Whether an immovable thing occupies floor."""
    return node.bottom < HEADROOM and node.size[2] > STEP and node.support == "floor" and not room.is_movable(node)


def _radius(room: Room, goal: Clear) -> float:
    if goal.width is not None:
        return goal.width / 2
    if "floor" not in goal.called:
        if (kind := kinds.of(goal.called)) is not None:
            return max(high for _, high in kind.size[:2]) / 2 + _AROUND / 2
        for name, width in _WIDTHS.items():
            if name in goal.called:
                return width / 2
    share = _DANCE_FLOOR * min(room.size[:2]) if goal.where.anchor is None else 0.2 * min(room.size[:2])
    return min(max(share, _MIN_RADIUS), _MAX_RADIUS)


def _disc_center(room: Room, where: Where, radius: float) -> tuple[float, float]:
    """The centre of the free floor; raises WishError if its anchor is not in the room."""
    anchor = room.one(where.anchor) if where.anchor is not None else None
    if anchor is None:
        return (0.0, 0.0)
    front = math.radians(anchor.yaw)
    away = (math.sin(front), -math.cos(front))
    if where.relation == "next_to" and anchor.support == "floor" and room.is_movable(anchor):
        away = _free_side(room, anchor, radius)
    reach = radius + abs(_extent(anchor, away)) / 2 + rearrange.GAP
    x, y = anchor.position[0] + reach * away[0], anchor.position[1] + reach * away[1]
    most = [room.size[i] / 2 - radius - 0.02 for i in range(2)]
    return (max(-most[0], min(x, most[0])), max(-most[1], min(y, most[1])))


def _extent(node: Node, way: tuple[float, float]) -> float:
    turn = math.radians(node.yaw)
    along = way[0] * math.cos(turn) + way[1] * math.sin(turn)
    across = -way[0] * math.sin(turn) + way[1] * math.cos(turn)
    return abs(along) * node.size[0] + abs(across) * node.size[1]


def _free_side(room: Room, node: Node, radius: float) -> tuple[float, float]:
    """The direction (unit vector) of the side of a thing with the most free floor."""

    def crowd(way: tuple[float, float]) -> float:
        reach = radius + _extent(node, way) / 2
        x, y = node.position[0] + reach * way[0], node.position[1] + reach * way[1]
        out = max(abs(x) + radius - room.size[0] / 2, abs(y) + radius - room.size[1] / 2, 0.0)
        met = sum(
            rearrange.in_disc(n, (x, y, radius)) for n in room.nodes.values() if n.id != node.id and n.size[2] > 0.05
        )
        return 3.0 * out + met

    turn = math.radians(node.yaw)
    ways = [(math.cos(turn + k * math.pi / 2), math.sin(turn + k * math.pi / 2)) for k in range(4)]
    return min(ways, key=crowd)


def wall_wishes(room: Room, goal: Walls) -> tuple[set[Id], list[LayoutWish]]:
    """The things that should stand at a wall and do not, and the layout wishes for that.

    Raises:
        WishError: the named things are not in the room, or none can be moved.
    """
    named = room.find(goal.things)
    loose = [n for n in named if room.is_movable(n) and not rearrange.at_wall(room, n)]
    if not [n for n in named if room.is_movable(n)]:
        raise WishError("nothing there can be moved")
    return {n.id for n in loose}, [LayoutWish(subject=n.id, name="against_wall") for n in loose]


def push_to_walls(room: Room, goals: Sequence[Walls], floor: Clear | None) -> None:
    """Push things to the walls, and keep floor free if that is wished as well.

    Raises:
        WishError: there is no room at the walls, or the floor cannot be freed.
    """
    found = [wall_wishes(room, g) for g in goals]
    free = set().union(*(ids for ids, _ in found))
    wishes = list(dict.fromkeys(w for _, ws in found for w in ws))
    if floor is not None:
        clear_floor(room, floor, free, wishes)
    elif free:
        tries = [frozenset(free), _movable(room)]
        rearrange.rearrange_stepwise(room, tries, wishes, [], "not everything finds a place at a wall")
    count = len(free)
    room.done.append(f"{count} thing{'s' if count != 1 else ''} pushed to the walls" if free else "all is at the walls")


def turn_seats(room: Room, goal: See) -> None:
    """Turn seats to something; seats that cannot turn where they stand are moved.

    Raises:
        WishError: there is nothing to face or no seat, or not every seat can be turned.
    """
    seats = room.find(goal.things or Query(text="seat", pick="all"))
    seats = [n for n in seats if room.is_movable(n)]
    view = room.one(goal.goal)
    if view is None or not seats:
        raise WishError("there is nothing to turn, or nothing to see")
    wishes = [LayoutWish(subject=n.id, name="facing", objects=(view.id,)) for n in seats if n.id != view.id]
    blind = {n.id for n in seats if not _sees(n, view)}
    reason = ""
    for loose in dict.fromkeys((frozenset(blind), frozenset(n.id for n in seats))):
        trial = copy_of(room)
        try:
            _turn_in_place(trial, loose, view)
            left = {id for id in loose if not _sees(trial.nodes[id], view)}
            if left:
                rearrange.rearrange(trial, left, [w for w in wishes if w.subject in left], [])
        except WishError as error:
            reason = str(error)
            continue
        room.nodes = trial.nodes
        room.done.append(f"{len(seats)} seat{'s' if len(seats) != 1 else ''} see the {view.label or 'thing'}")
        return
    raise WishError(f"not every seat can be turned to the {view.label}: {reason}")


def _turn_in_place(room: Room, seats: Collection[Id], view: Node) -> None:
    """Turn seats where they stand if they have the room for it."""
    for id in seats:
        node = room.nodes[id]
        for step in (5.0, 45.0, 90.0):
            yaw = step * round(toward(node, view.position[:2]) / step)
            turned = node.model_copy(update={"yaw": yaw})
            if _sees(turned, view) and room.fits(id, node.position[0], node.position[1], yaw):
                room.move_to(id, node.position[0], node.position[1], yaw)
                break


def _sees(node: Node, view: Node) -> bool:
    """Whether a thing's front points at another within 40 degrees."""
    return abs(math.remainder(toward(node, view.position[:2]) - node.yaw, 360.0)) <= 40.0


def spread(room: Room, goal: Spread) -> None:
    """Spread things out along the walls and corners, far from each other.

    Raises:
        WishError: fewer than two of them can be moved, or there is no room.
    """
    things = [n for n in room.find(goal.things) if room.is_movable(n)]
    if len(things) < 2:
        raise WishError("spreading out needs at least two movable things")
    spots = _candidate_spots(room, things)
    for node in sorted(things, key=lambda n: -math.prod(n.size[:2])):
        free = [s for s in spots if room.fits(node.id, *s, node.yaw, but=[n.id for n in things if n.id != node.id])]
        if not free:
            raise WishError(f"there is no free spot for the {node.label}")
        done = [n for n in things if n.id != node.id and room.nodes[n.id] != n]
        best = max(free, key=lambda s: _spread_score(s, node, [room.nodes[n.id] for n in done]))
        room.move_to(node.id, *best, node.yaw)
    if any(room.overlapping(room.nodes[n.id]) for n in things):
        raise WishError("there is no room to spread them out")
    room.done.append(f"{len(things)} things spread out")


def _candidate_spots(room: Room, things: Sequence[Node]) -> list[tuple[float, float]]:
    """Candidate places along the walls and in the corners."""
    reach = max(max(n.size[:2]) for n in things) / 2 * 1.2 + rearrange.MARGIN
    x, y = room.size[0] / 2 - reach, room.size[1] / 2 - reach
    count = 12
    steps = [-1 + 2 * k / count for k in range(count + 1)]
    return list(
        dict.fromkeys(
            [*((s * x, t * y) for s in steps for t in (-1, 1)), *((t * x, s * y) for s in steps for t in (-1, 1))]
        )
    )


def _spread_score(spot: tuple[float, float], node: Node, done: Sequence[Node]) -> float:
    """Score of a spot: distance to the nearest placed thing, less a little for the way; the first thing stays near."""
    if not done:
        return -math.dist(spot, node.position[:2])
    return min(math.dist(spot, n.position[:2]) for n in done) - 0.1 * math.dist(spot, node.position[:2])


def reading_corner(room: Room, goal: ReadingCorner) -> None:
    """Place a seat in a corner or at the given place, with a lamp and a table next to it; missing things are added.

    Raises:
        WishError: there is no room for it.
    """
    pieces = [_first(room, labels) or _new(room, labels[0]) for labels in _READING_CORNER]
    seat, *others = pieces
    wishes = [LayoutWish(subject=n.id, name="next_to", objects=(seat.id,)) for n in others]
    anchor = room.one(goal.where.anchor) if goal.where is not None and goal.where.anchor is not None else None
    if anchor is None:
        wishes.append(LayoutWish(subject=seat.id, name="in_corner"))
    else:
        wishes.append(LayoutWish(subject=seat.id, name="next_to", objects=(anchor.id,)))
    trial = copy_of(room)
    trial.nodes |= {n.id: n for n in pieces}
    mine = frozenset(n.id for n in pieces)
    small = frozenset(n.id for n in room.nodes.values() if room.is_movable(n) and max(n.size[:2]) < 2 * SMALL)
    rearrange.rearrange_stepwise(
        trial, [mine, mine | small, mine | _movable(room)], wishes, [], "there is no room for a reading corner"
    )
    for node in pieces:
        if node.id not in room.nodes:
            there = trial.nodes.pop(node.id)
            place = Placement(relation="against" if node is seat else "on", offset=there.position[:2])
            room.ops.append(Insert(asset=node.label, place=place))
    room.nodes = trial.nodes
    room.done.append("a seat, a lamp and a table make a reading corner")


_READING_CORNER = (("armchair", "chair"), ("floor lamp",), ("side table", "stool"))


def _new(room: Room, label: str) -> Node:
    """A node for a new thing in the middle of the room, at 0.9 times the largest size of its kind."""
    width, depth, height = (0.9 * most for _, most in kinds.table().kinds[label].size)
    return Node(id=f"new {label}", label=label, size=(width, depth, height), position=(0.0, 0.0, height / 2))


def _movable(room: Room) -> frozenset[Id]:
    return frozenset(n.id for n in room.nodes.values() if room.is_movable(n))


def _first(room: Room, labels: Sequence[str]) -> Node | None:
    """The first movable thing with one of these labels, None if there is none."""
    nodes = (n for label in labels for n in room.nodes.values() if n.label == label and room.is_movable(n))
    return next(nodes, None)
