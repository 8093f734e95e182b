"""Goals for small things on surfaces: tidying up, clearing a surface, setting a table.

Nothing is deleted: things that are cleared off a surface go onto another one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...gaussians.world import kinds
from ...tools.operation import Placement
from ...tools.ops.insert import Insert
from ...tools.ops.move import Move
from ..rooms.node import Node
from . import rearrange
from .goals import Declutter, SetTable
from .move_order import target
from .room import SMALL, Id, Room, WishError, is_likely, is_seat, wrapped

Place = tuple[float, float, float, float]  # x, y of a plate, and the unit vector from the guest inward

_REACH = 0.75  # metres from a table within which a seat belongs to it
_FULL = 0.6  # share of a top that may be occupied
_RIM = 0.2  # metres from the edge of a table to the middle of a plate
_PLATE = 0.34  # metres of table edge per person


def tidy(room: Room) -> None:
    """Straighten furniture, align it with its wall, and put small things from the floor onto furniture.

    Raises:
        WishError: there is no surface with room for a small thing.
    """
    straight = sum(
        _straighten(room, n) for n in list(room.nodes.values()) if room.is_movable(n) and max(n.size) >= SMALL
    )
    loose = [n for n in room.nodes.values() if _is_loose(room, n)]
    taken = dict[Id, float]()
    for node in loose:
        _put_away(room, node, _surfaces(room), taken)
    if straight:
        room.done.append(f"{straight} thing{'s' if straight > 1 else ''} straightened")
    if loose:
        room.done.append(f"{len(loose)} small thing{'s' if len(loose) > 1 else ''} picked up from the floor")


def _straighten(room: Room, node: Node) -> bool:
    """Turn a thing to the nearest multiple of 90 degrees and align it with its wall, if it fits; whether it moved."""
    x, y, _ = node.position
    yaw = wrapped(90.0 * round(node.yaw / 90.0))
    width, depth = (node.size[0], node.size[1]) if round(yaw / 90.0) % 2 == 0 else (node.size[1], node.size[0])
    reach = (room.size[0] / 2 - rearrange.MARGIN - width / 2, room.size[1] / 2 - rearrange.MARGIN - depth / 2)
    for to_x, to_y in ((_flush(x, reach[0]), _flush(y, reach[1])), (x, y)):
        moved = abs(wrapped(yaw - node.yaw)) > 1.0 or math.dist((to_x, to_y), (x, y)) > rearrange.MARGIN
        if moved and room.fits(node.id, to_x, to_y, yaw):
            room.move_to(node.id, to_x, to_y, yaw)
            return True
    return False


def _flush(at: float, most: float) -> float:
    """A coordinate, moved to the wall if it is near one."""
    return math.copysign(most, at) if rearrange.MARGIN < most - abs(at) < rearrange.AT_WALL else at


def _is_loose(room: Room, node: Node) -> bool:
    """Whether a small thing lies on the floor although it belongs on furniture."""
    kind = kinds.of(node.label)
    on_floor = kind is not None and kind.support == "floor"
    small = node.support == "floor" and max(node.size) < SMALL and not node.is_stepped_on
    return small and bool(node.label) and not on_floor and is_likely(node)


def _surfaces(room: Room) -> list[Node]:
    """Furniture that things can be put on, storage before tables, then by size."""
    known = [(n, kind) for n in room.nodes.values() if n.support == "floor" and (kind := kinds.of(n.label)) is not None]
    found = [(n, kind.stores) for n, kind in known if kind.top or kind.stores]
    return [n for n, _ in sorted(found, key=lambda f: (not f[1], -f[0].size[0] * f[0].size[1]))]


def _is_used(node: Node) -> bool:
    """Whether a thing is used where it stands, and so is not cleared away: a lamp, a monitor."""
    families = kinds.table().families
    kind, used = kinds.of(node.label), (*families["lamp"], *families["electronics"], *families["appliance"])
    return node.label in families if kind is None else kind.name in used


def _put_away(room: Room, node: Node, surfaces: Sequence[Node], taken: dict[Id, float]) -> None:
    """Plan a move of a thing onto the nearest surface with room for it.

    Args:
        taken: area that earlier calls occupied, in square metres by surface; updated.

    Raises:
        WishError: no surface has room.
    """
    area = node.size[0] * node.size[1]
    free = []
    for carrier in surfaces:
        load = taken.get(carrier.id, 0.0) + sum(
            n.size[0] * n.size[1] for n in room.nodes.values() if n.support == carrier.id
        )
        fits = max(node.size[:2]) <= 1.2 * min(carrier.size[:2])
        if fits and load + area <= _FULL * carrier.size[0] * carrier.size[1]:
            free.append(carrier)
    if not free:
        raise WishError(f"there is nothing with room for the {node.label}: add a shelf, or say what to take away")
    near = min(free, key=lambda n: math.dist(n.position[:2], node.position[:2]))
    taken[near.id] = taken.get(near.id, 0.0) + area
    place = Placement(relation="on", anchors=(target(near),))
    room.ops.append(Move(target=target(node), place=place))


def declutter(room: Room, goal: Declutter) -> None:
    """Move things that are not used on a surface onto other surfaces.

    Raises:
        WishError: no other surface has room.
    """
    surface = room.one(goal.surface)
    if surface is None:
        raise WishError("say what to clear off")
    on = [n for n in room.nodes.values() if n.support == surface.id]
    extra = [n for n in on if not _is_used(n)]
    others = [n for n in _surfaces(room) if n.id != surface.id]
    taken = dict[Id, float]()
    for node in extra:
        _put_away(room, node, others, taken)
    room.done.append(f"{len(extra)} of {len(on)} things cleared off the {surface.label}")


def set_table(room: Room, goal: SetTable) -> None:
    """Add a plate and a glass in front of each seat, and evenly around the table for people without a seat.

    Raises:
        WishError: there is no table, or it is too small.
    """
    tables = [n for n in room.find(goal.table.model_copy(update={"pick": "all"})) if n.support == "floor"]
    tables = [n for n in tables if n.label.split()[-1:] in (["table"], ["island"])]  # desks are not set
    if not tables:
        raise WishError("there is no table to be set", "absent")
    table = max(tables, key=lambda n: n.size[0] * n.size[1])  # people eat at the largest
    seats = [n for n in room.nodes.values() if is_seat(n) and _gap(n, table) < _REACH]
    people = goal.people or len(seats) or 2
    places = _places(table, seats, people)
    if places is None:
        raise WishError(f"the {table.label} is too small for {people}")
    c, s = math.cos(math.radians(table.yaw)), math.sin(math.radians(table.yaw))
    for asset, back, aside in (("plate", 0.0, 0.0), ("wine glass", 0.14, 0.14)):
        for u, v, du, dv in places:
            x, y = u + back * du - aside * dv, v + back * dv + aside * du
            offset = (round(c * x - s * y, 3), round(s * x + c * y, 3))
            place = Placement(relation="on", anchors=(target(table),), offset=offset)
            room.ops.append(Insert(asset=asset, place=place))
    short = f", of whom {len(seats)} have a seat" if len(seats) < people else ""
    room.done.append(f"the {table.label} is set for {people}{short}")


def _gap(node: Node, table: Node) -> float:
    """Distance in metres from the centre of a seat to the edge of a table."""
    at = table.box.local(_middle(node))[0]
    x, y = abs(float(at[0])) - table.size[0] / 2, abs(float(at[1])) - table.size[1] / 2
    return math.hypot(max(x, 0.0), max(y, 0.0))


def _places(table: Node, seats: Sequence[Node], people: int) -> list[Place] | None:
    """Places of the plates in the table's frame: in front of the seats, then where there is most room. None if they do
    not fit."""
    chosen: list[Place] = []
    before = [_before(table, *table.box.local(_middle(n))[0, :2]) for n in seats]
    for options in (before, _rim(table)):
        while len(chosen) < people and (free := [p for p in options if all(_far(p, q) for q in chosen)]):
            chosen.append(max(free, key=lambda p: min((math.dist(p[:2], q[:2]) for q in chosen), default=0.0)))
    return chosen if len(chosen) == people else None


def _rim(table: Node) -> list[Place]:
    """Places side by side along the whole edge of a table."""
    width, depth, _ = table.size
    found: list[Place] = []
    for length, side in ((width, 0), (depth, 1)):
        count = int(length / _PLATE)
        for k in range(count):
            along = (k + 0.5) * length / count - length / 2
            for far in (-9.0, 9.0):
                found.append(_before(table, *((along, far) if side == 0 else (far, along))))
    return found


def _before(table: Node, u: float, v: float) -> Place:
    """The place at a table's edge nearest to a point (u, v) beside it, in the table's frame."""
    half = [max(s / 2 - _RIM, 0.0) for s in table.size[:2]]
    beyond = abs(u) - table.size[0] / 2, abs(v) - table.size[1] / 2
    x, y = max(-half[0], min(u, half[0])), max(-half[1], min(v, half[1]))
    if beyond[0] >= beyond[1]:
        return (math.copysign(half[0], u), y, -math.copysign(1.0, u), 0.0)
    return (x, math.copysign(half[1], v), 0.0, -math.copysign(1.0, v))


def _far(p: Sequence[float], q: Sequence[float]) -> bool:
    return math.dist(p[:2], q[:2]) >= _PLATE * 0.95


def _middle(node: Node) -> NDArray[np.float64]:
    return np.array([node.position])
