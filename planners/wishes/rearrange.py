"""Rearranges a room with the layout solver: some things may move, all others keep their places.

Callers first let few things move, and all movable things only if that fails, so that a room changes as little as
possible.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

import numpy as np

from ...gaussians.world import kinds
from ...gaussians.world.box import overlap
from ..layout import Item, Keepout, Layout, Problem, Stand, solve
from ..layout import Wish as LayoutWish
from ..rooms.node import Node
from .room import Id, Room, WishError, copy_of, is_seat, wrapped

MARGIN = 0.05  # metres kept from the walls, because a room's size is that of its shell
GAP = 0.03  # metres added to sizes, so that things stand apart
AT_WALL = 0.3  # metres from a wall within which a thing counts as standing at it
_LEAF = 0.7  # metres in front of a door that stay free
_PULLED_UP = 0.3  # metres from a table within which a seat is pulled up to it
_CHAIR = 0.75  # metres; larger seats are not pulled up to a table


def rearrange(
    room: Room, free: Collection[Id], wishes: Sequence[LayoutWish], discs: Sequence[Keepout], seed: int = 0
) -> None:
    """Move the free things so that the wishes hold and the discs are empty; updates the room.

    Raises:
        WishError: there is no such layout; the message names the conflict.
    """
    layout = solve(_problem(room, free, wishes, discs), seed)
    if not layout.ok or layout.left_out:
        raise WishError(conflict(layout))
    for node in layout.graph.nodes:
        if node.id in free:
            room.move_to(node.id, node.position[0], node.position[1], _yaw_of_thing(room, node))


def rearrange_stepwise(
    room: Room, tries: Sequence[frozenset[Id]], wishes: Sequence[LayoutWish], discs: Sequence[Keepout], complaint: str
) -> None:
    """Rearrange with the first set of movable things in `tries` that has a solution and blocks no door.

    If every solution blocks a door, the first solution is used.

    Raises:
        WishError: no set has a solution; the message is the complaint and why the last try failed.
    """
    reason, least = "", None
    for loose in dict.fromkeys(tries):
        trial = copy_of(room)
        try:
            rearrange(trial, loose, wishes, discs)
        except WishError as error:
            reason = str(error)
            continue
        if not _blocks_a_door(trial, loose):
            room.nodes = trial.nodes
            return
        least = least or trial
    if least is None:
        raise WishError(f"{complaint}: {reason}")
    room.nodes = least.nodes


def _blocks_a_door(room: Room, moved: Collection[Id]) -> bool:
    """Whether a moved thing stands in front of a door."""
    doors = [n for n in room.nodes.values() if n.label.split()[-1:] == ["door"]]
    leaves = [d.model_copy(update={"size": (d.size[0], d.size[1] + 2 * _LEAF, d.size[2])}) for d in doors]
    return any(overlap(leaf.box, room.nodes[i].box) > GAP for leaf in leaves for i in moved if i in room.nodes)


def chairs_at_tables(room: Room, free: Collection[Id]) -> tuple[set[Id], list[LayoutWish]]:
    """Seats at tables of which a part may move, and soft wishes that the chairs stay at their table."""
    along, wishes = set[Id](), list[LayoutWish]()
    for table in (n for n in room.nodes.values() if n.label.split()[-1:] == ["table"]):
        chairs = [n for n in room.nodes.values() if is_seat(n) and _sits(n, table)]
        if table.id in free or any(n.id in free for n in chairs):
            along |= {n.id for n in chairs if room.is_movable(n)}
            wishes += [
                LayoutWish(subject=n.id, name="around", objects=(table.id,), hard=False)
                for n in chairs
                if room.is_movable(n) and max(n.size[:2]) < _CHAIR
            ]
    return along, wishes


def _sits(node: Node, table: Node) -> bool:
    """Whether a seat is pulled up to a table."""
    aside = np.abs(table.box.local(np.array([node.position]))[0, :2]) - np.array(table.size[:2]) / 2
    return float(np.linalg.norm(np.maximum(aside, 0.0))) < max(node.size[:2]) / 2 + _PULLED_UP


def _yaw_of_thing(room: Room, node: Node) -> float:
    """The yaw of a thing in degrees, from that of its item in the problem, which may be turned by 90 degrees. A thing
    without a front is turned as little as its footprint allows."""
    was = room.nodes[node.id]
    yaw = wrapped(node.yaw - 90.0) if is_crosswise(was) else node.yaw
    if _has_front(was):
        return yaw
    square = abs(was.size[0] - was.size[1]) <= GAP
    return wrapped(was.yaw + math.remainder(yaw - was.yaw, 90.0 if square else 180.0))


def is_crosswise(node: Node) -> bool:
    """Whether a thing is deeper than wide although things of its kind have their long side at the wall."""
    return node.size[1] > 1.2 * node.size[0] and not _is_long(node)


def _has_front(node: Node) -> bool:
    """Whether it matters which way a thing is turned."""
    kind = kinds.of(node.label)
    return kind is not None and (kind.front or kind.backed or kind.support == "wall")


def _is_long(node: Node) -> bool:
    """Whether things of this kind are deeper than wide, as beds are: their short side is at the wall."""
    kind = kinds.of(node.label)
    return kind is not None and kind.size[1][0] > kind.size[0][1]


def conflict(layout: Layout) -> str:
    """Why a layout has conflicts, in one sentence."""
    told = [" and ".join(c.statements) for c in layout.conflicts[:2]]
    return "these cannot all be: " + "; ".join(told) if told else "there is no room for that"


def _problem(room: Room, free: Collection[Id], wishes: Sequence[LayoutWish], discs: Sequence[Keepout]) -> Problem:
    width, depth, height = room.size
    walled = {w.subject for w in wishes if w.name in ("against_wall", "in_corner")}
    walled |= {id for id in free if at_wall(room, room.nodes[id])}
    carried_by = {r for id in free for r in room.carried_by(id)}
    items = [_item(room, n, n.id in free, n.id in walled) for n in room.nodes.values() if n.id not in carried_by]
    return Problem(
        size=(width - 2 * MARGIN, depth - 2 * MARGIN, height),
        items=tuple(items),
        wishes=tuple(wishes),
        free=tuple(discs),
        walkway=0.0,
    )


def _item(room: Room, node: Node, free: bool, walled: bool) -> Item:
    """The item of the layout problem for a thing."""
    stand = Stand(position=node.position, yaw=node.yaw)
    known = {"id": node.id, "label": node.label, "color": node.color, "support": node.support}
    if not free:
        return Item(**known, size=node.size, stand=stand)  # type: ignore[arg-type]
    width, depth, height = node.size
    yaw = node.yaw
    if is_crosswise(node):
        width, depth, yaw = depth, width, wrapped(yaw + 90.0)
    was = Stand(position=node.position, yaw=wrapped(90.0 * round(yaw / 90.0)))
    size = (width + GAP, depth + GAP, height)
    return Item(**known, size=size, was=was, backed=walled)  # type: ignore[arg-type]


def in_disc(node: Node, disc: tuple[float, float, float]) -> bool:
    """Whether a thing reaches into a disc of floor (x, y, radius)."""
    x, y, _ = node.box.local(np.array([[disc[0], disc[1], node.position[2]]]))[0]
    aside = max(abs(float(x)) - node.size[0] / 2, 0.0), max(abs(float(y)) - node.size[1] / 2, 0.0)
    return math.hypot(*aside) < disc[2]


def at_wall(room: Room, node: Node) -> bool:
    """Whether a thing stands within `AT_WALL` of a wall."""
    corners = abs(node.box.corners()[:, :2]).max(axis=0)
    return bool(min(room.size[0] / 2 - corners[0], room.size[1] / 2 - corners[1]) < AT_WALL)
