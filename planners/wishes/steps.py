"""From where things were to where they are to be, one thing after another, so that none stands in another on the way.

Knows boxes and the order of moves. Refuses to know why anything goes anywhere. Where two things wait for each other,
one is set aside first.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from ...gaussians.language.query.query import Query
from ...tools.ops.arrange import Arrange
from ..rooms.node import Node
from .room import CannotError, Id, Room, wrapped

_STILL = 0.02  # metres, and
_STRAIGHT = 1.0  # degrees: less is no move
_LATTICE = 0.25  # metres between places to set a thing aside


def moves(start: Room, goal: Room) -> list[Arrange]:
    """The moves that lead from one state of a room to another, in an order that works.

    Raises:
        CannotError: there is no room to set anything aside.
    """
    now = Room(start.stage, dict(start.nodes))
    waiting = {i: n for i, n in goal.nodes.items() if i in now.nodes and n.support == now.nodes[i].support}
    waiting = {i: n for i, n in waiting.items() if _leads(now, goal, i) and _is_elsewhere(now.nodes[i], n)}
    known = _known(now)
    found: list[Arrange] = []
    parked = set[Id]()
    while waiting:
        free = [i for i, n in waiting.items() if _may(now, i, n, known)]
        if free:
            found.append(_step(now, waiting[free[0]]))
            del waiting[free[0]]
        else:
            found.append(_aside(now, waiting, known, parked))
    return found


def _leads(now: Room, goal: Room, id: Id) -> bool:
    """Whether a thing moves by itself: what stands on a thing that moves goes along."""
    at = now.nodes[id].support
    if at not in now.nodes:
        return True
    along = {n.id: n for n in _with(now, at, goal.nodes[at])}
    return _is_elsewhere(along[id], goal.nodes[id]) if id in along else True


def _with(now: Room, id: Id, there: Node) -> list[Node]:
    trial = Room(now.stage, dict(now.nodes))
    trial.put(id, there.position[0], there.position[1], there.yaw)
    return [trial.nodes[i] for i in (id, *trial.riders(id))]


def _is_elsewhere(a: Node, b: Node) -> bool:
    turned = abs(wrapped(a.yaw - b.yaw)) > _STRAIGHT
    return turned or math.dist(a.position[:2], b.position[:2]) > _STILL


def _known(room: Room) -> frozenset[frozenset[Id]]:
    """Pairs that are in each other from the start, as measured boxes may be."""
    return frozenset(frozenset((n.id, other.id)) for n in room.nodes.values() for other in room.taken(n))


def _may(now: Room, id: Id, there: Node, known: frozenset[frozenset[Id]]) -> bool:
    met = now.taken(there, now.riders(id))
    return all(frozenset((id, n.id)) in known for n in met)


def _step(now: Room, there: Node) -> Arrange:
    """One move; the room is then as after it."""
    was = now.nodes[there.id]
    now.put(there.id, there.position[0], there.position[1], there.yaw)
    return Arrange(
        target=target(was),
        x=round(there.position[0] - was.position[0], 4),
        y=round(there.position[1] - was.position[1], 4),
        turn=round(wrapped(there.yaw - was.yaw), 3),
    )


def _aside(now: Room, waiting: Mapping[Id, Node], known: frozenset[frozenset[Id]], parked: set[Id]) -> Arrange:
    """Set the smallest thing that waits where it is in nobody's way, each thing once.

    Raises:
        CannotError: there is no such place.
    """
    goals = list(waiting.values())
    for id in sorted(set(waiting) - parked, key=lambda i: math.prod(now.nodes[i].size[:2])):
        node = now.nodes[id]
        for x, y in _around(now, node):
            there = node.model_copy(update={"position": (x, y, node.position[2])})
            clear = now.inside(there) and _may(now, id, there, known)
            others = Room(now.stage, {g.id: g for g in goals if g.id != id})
            if clear and not others.taken(there):
                parked.add(id)
                return _step(now, there)
    names = ", ".join(f"the {now.nodes[i].label}" for i in list(waiting)[:4])
    raise CannotError(f"{names}: each stands where another should go, and nothing can be set aside meanwhile")


def _around(room: Room, node: Node) -> list[tuple[float, float]]:
    """Places of the floor, the nearest to a thing first."""
    width, depth, _ = room.size
    xs = [-width / 2 + _LATTICE * k for k in range(1, int(width / _LATTICE))]
    ys = [-depth / 2 + _LATTICE * k for k in range(1, int(depth / _LATTICE))]
    places = [(x, y) for x in xs for y in ys]
    away = [p for p in places if math.dist(p, node.position[:2]) > _LATTICE]
    return sorted(away, key=lambda p: math.dist(p, node.position[:2]))


def target(node: Node) -> Query:
    """A thing as a plan names it: by its id, and by its name for readers."""
    groups = (node.id,) if isinstance(node.id, int) else ()
    return Query(text=node.label, groups=groups)
