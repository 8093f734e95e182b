"""Orders the moves from one state of a room to another so that nothing overlaps after any of them.

Where two things block each other, one is set aside first.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from ...gaussians.language.query.query import Query
from ...tools.ops.arrange import Arrange
from ..rooms.node import Node
from .room import Id, Room, WishError, wrapped

_STILL = 0.02  # metres; a smaller move is none
_STRAIGHT = 1.0  # degrees; a smaller turn is none
_LATTICE = 0.25  # metres between places to set a thing aside


def ordered_moves(start: Room, goal: Room) -> list[Arrange]:
    """The moves from one state of a room to another, in an order without overlaps.

    Raises:
        WishError: there is no place to set a blocking thing aside.
    """
    now = Room(start.stage, dict(start.nodes))
    waiting = {i: n for i, n in goal.nodes.items() if i in now.nodes and n.support == now.nodes[i].support}
    waiting = {i: n for i, n in waiting.items() if _moves_itself(now, goal, i) and _is_elsewhere(now.nodes[i], n)}
    known = frozenset(frozenset((n.id, other.id)) for n in now.nodes.values() for other in now.overlapping(n))
    found: list[Arrange] = []
    parked = set[Id]()
    while waiting:
        free = [i for i, n in waiting.items() if _is_free(now, i, n, known)]
        if free:
            found.append(_move(now, waiting[free[0]]))
            del waiting[free[0]]
        else:
            found.append(_set_aside(now, waiting, known, parked))
    return found


def _moves_itself(now: Room, goal: Room, id: Id) -> bool:
    """Whether a thing needs a move of its own, because its support does not carry it to its goal."""
    at = now.nodes[id].support
    if at not in now.nodes:
        return True
    along = {n.id: n for n in _after_move(now, at, goal.nodes[at])}
    return _is_elsewhere(along[id], goal.nodes[id]) if id in along else True


def _after_move(now: Room, id: Id, there: Node) -> list[Node]:
    trial = Room(now.stage, dict(now.nodes))
    trial.move_to(id, there.position[0], there.position[1], there.yaw)
    return [trial.nodes[i] for i in (id, *trial.carried_by(id))]


def _is_elsewhere(a: Node, b: Node) -> bool:
    turned = abs(wrapped(a.yaw - b.yaw)) > _STRAIGHT
    return turned or math.dist(a.position[:2], b.position[:2]) > _STILL


def _is_free(now: Room, id: Id, there: Node, known: frozenset[frozenset[Id]]) -> bool:
    return all(frozenset((id, n.id)) in known for n in now.overlapping(there, now.carried_by(id)))


def _move(now: Room, there: Node) -> Arrange:
    """One move; updates the room."""
    was = now.nodes[there.id]
    now.move_to(there.id, there.position[0], there.position[1], there.yaw)
    return Arrange(
        target=target(was),
        x=round(there.position[0] - was.position[0], 4),
        y=round(there.position[1] - was.position[1], 4),
        turn=round(wrapped(there.yaw - was.yaw), 3),
    )


def _set_aside(now: Room, waiting: Mapping[Id, Node], known: frozenset[frozenset[Id]], parked: set[Id]) -> Arrange:
    """Move the smallest waiting thing to a place where it blocks nothing; each thing is set aside only once. Raises
    WishError if there is no such place."""
    goals = list(waiting.values())
    for id in sorted(set(waiting) - parked, key=lambda i: math.prod(now.nodes[i].size[:2])):
        node = now.nodes[id]
        for x, y in _free_places(now, node):
            there = node.model_copy(update={"position": (x, y, node.position[2])})
            is_clear = now.inside(there) and _is_free(now, id, there, known)
            others = Room(now.stage, {g.id: g for g in goals if g.id != id})
            if is_clear and not others.overlapping(there):
                parked.add(id)
                return _move(now, there)
    names = ", ".join(f"the {now.nodes[i].label}" for i in list(waiting)[:4])
    raise WishError(f"{names}: each stands where another should go, and nothing can be set aside meanwhile")


def _free_places(room: Room, node: Node) -> list[tuple[float, float]]:
    """Places on a grid over the floor, nearest to a thing first."""
    width, depth, _ = room.size
    xs = [-width / 2 + _LATTICE * k for k in range(1, int(width / _LATTICE))]
    ys = [-depth / 2 + _LATTICE * k for k in range(1, int(depth / _LATTICE))]
    places = [(x, y) for x in xs for y in ys]
    away = [p for p in places if math.dist(p, node.position[:2]) > _LATTICE]
    return sorted(away, key=lambda p: math.dist(p, node.position[:2]))


def target(node: Node) -> Query:
    """The query for a thing in a plan: its id, and its label for readers."""
    groups = (node.id,) if isinstance(node.id, int) else ()
    return Query(text=node.label, groups=groups)
