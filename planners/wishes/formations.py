"""Goals that arrange things in figures: a circle, an arc, rows, around a table, or mirrored pairs.

The slots of a figure are exact, so the layout solver does not place them: the figure is tried as a whole at many places
until nothing is in its way. Only chairs around a table are placed by the solver.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
import scipy

from ..layout import Wish as LayoutWish
from ..rooms.node import Node
from . import rearrange
from .floor import clear_floor
from .goals import Clear, Formation, Where
from .room import Room, WishError, copy_of, toward, wrapped

Slot = tuple[float, float, float]  # x, y, yaw
Slots = list[Slot]

_NEIGHBOUR_GAP = 0.15  # metres between neighbours in a figure
_MIN_RADIUS = 0.6  # metres, smallest radius of a circle
_LATTICE = 0.2  # metres between the places at which a figure is tried
_TURNS = 12  # number of rotations of a circle that are tried
_SIZE_TOLERANCE = 0.3  # relative difference in size within which two things of one label are a pair


def form(room: Room, goal: Formation) -> None:
    """Arrange things in a figure.

    Raises:
        WishError: there are too few of them, or there is no room.
    """
    things = [n for n in room.find(goal.things) if room.is_movable(n)]
    about = room.one(goal.about) if goal.about is not None else None
    things = [n for n in things if about is None or n.id != about.id]
    if len(things) < (1 if goal.shape == "around" else 2):
        raise WishError(f"{goal.things.describe()}: there are not enough that can be moved")
    if goal.shape == "around" and about is not None and about.label.split()[-1:] in (["table"], ["desk"]):
        _at_table(room, things, about)
    else:
        slots = _find_place(room, goal, things, about)
        _assign(room, things, slots)
    where = f" around the {about.label}" if about is not None and goal.shape == "around" else ""
    shape = {"circle": " in a circle", "arc": " on an arc", "row": f" in {goal.rows} row{'s' * (goal.rows > 1)}"}
    room.done.append(f"{len(things)} things{shape.get(goal.shape, '')}{where}")


def _at_table(room: Room, things: Sequence[Node], table: Node) -> None:
    """Place chairs at the free sides of a table, facing it; raises WishError if there is no room for them."""
    wishes = [LayoutWish(subject=n.id, name="around", objects=(table.id,)) for n in things]
    own = frozenset(n.id for n in things)
    movable = frozenset(n.id for n in room.nodes.values() if room.is_movable(n))
    complaint = f"not all of them find room around the {table.label}"
    rearrange.rearrange_stepwise(room, [own, own | {table.id}, movable | own], wishes, [], complaint)


def _find_place(room: Room, goal: Formation, things: Sequence[Node], about: Node | None) -> Slots:
    """The slots of the figure at the best place where it fits; if it fits nowhere, floor is cleared for it first.
    Raises WishError if there is no room for it even then."""
    if found := _shortest_free(room, goal, things, about):
        return found
    reach = max(math.hypot(x, y) for x, y, _ in _slots(goal, things, None, (0.0, 0.0), 0.0))
    width = 2 * reach + 1.5 * max(max(n.size[:2]) for n in things)
    trial = copy_of(room)
    for node in things:  # the things themselves do not block the figure
        del trial.nodes[node.id]
    try:
        clear_floor(trial, Clear(goal.where or Where(), width, f"the {goal.shape}"))
    except WishError as error:
        raise WishError(f"there is no room for that figure: {error}") from error
    kept = {n.id: room.nodes[n.id] for n in things}
    room.nodes = {**trial.nodes, **kept}
    if found := _shortest_free(room, goal, things, about):
        return found
    raise WishError("there is no room for that figure")


def _shortest_free(room: Room, goal: Formation, things: Sequence[Node], about: Node | None) -> Slots:
    """The free figure with the shortest total distance to move; empty if there is none."""
    ids = [n.id for n in things]
    tried = [
        (slots, _assignment(things, slots)) for slots in _candidates(room, goal, things, about) if _within(room, slots)
    ]
    tried.sort(key=lambda t: sum(math.dist(things[i].position[:2], t[0][j][:2]) for i, j in t[1]))
    for slots, order in tried:
        if all(room.fits(things[i].id, *slots[j], but=ids) for i, j in order):
            return slots
    return []


def _within(room: Room, slots: Slots) -> bool:
    return all(abs(x) < room.size[0] / 2 and abs(y) < room.size[1] / 2 for x, y, _ in slots)


def _candidates(room: Room, goal: Formation, things: Sequence[Node], about: Node | None) -> Iterator[Slots]:
    """The figure at every place of the floor, or around its subject, in every rotation."""
    turns = (
        [360.0 / _TURNS * k for k in range(_TURNS)] if goal.shape in ("circle", "around") else [0.0, 90.0, 180.0, 270.0]
    )
    if goal.shape in ("circle", "around", "arc") and about is not None:
        places = [about.position[:2]]
        turns = [15.0 * k for k in range(24)] if goal.shape == "arc" else turns
    elif goal.where is not None:
        anchor = room.one(goal.where.anchor) if goal.where.anchor is not None else None
        near = (0.0, 0.0) if anchor is None else anchor.position[:2]
        places = sorted(_floor(room), key=lambda p: math.dist(p, near))[:40]
    else:
        places = _floor(room)
    if goal.shape == "circle" and about is None:
        for table in (n for n in room.nodes.values() if n.label.split()[-1:] == ["table"] and n not in things):
            yield from (_slots(goal, things, table, table.position[:2], turn) for turn in turns)
    for place in places:
        for turn in turns:
            yield _slots(goal, things, about, place, turn)


def _floor(room: Room) -> list[tuple[float, float]]:
    width, depth, _ = room.size
    xs = np.arange(-width / 2 + 0.5, width / 2 - 0.4, _LATTICE)
    ys = np.arange(-depth / 2 + 0.5, depth / 2 - 0.4, _LATTICE)
    return [(float(x), float(y)) for x in xs for y in ys]


def _slots(
    goal: Formation, things: Sequence[Node], about: Node | None, place: tuple[float, float], turn: float
) -> Slots:
    """The slots of a figure centred at a place and turned by `turn` degrees."""
    if goal.shape == "row":
        return _rows(goal, things, about, place, turn)
    span = 180.0 if goal.shape == "arc" else 360.0
    count = len(things)
    need = sum(n.size[0] + _NEIGHBOUR_GAP for n in things) / math.radians(span)
    inner = 0.0 if about is None else math.hypot(*about.size[:2]) / 2 + 0.1
    if goal.shape == "arc" and about is not None:
        inner = max(inner, 1.4)
    radius = max(need, _MIN_RADIUS, inner) + max(n.size[1] for n in things) / 2
    step = span / max(count - 1, 1) if goal.shape == "arc" else span / count
    slots = Slots()
    for k in range(count):
        angle = math.radians(turn + k * step)
        x, y = place[0] + radius * math.cos(angle), place[1] + radius * math.sin(angle)
        slots.append((x, y, toward((x, y), place)))
    return slots


def _rows(
    goal: Formation, things: Sequence[Node], about: Node | None, place: tuple[float, float], turn: float
) -> Slots:
    """The slots of rows, one behind the other, all with the same yaw."""
    yaw = turn
    if about is not None:
        yaw = 90.0 * round(toward(place, about.position[:2]) / 90.0)
    each = math.ceil(len(things) / goal.rows)
    pitch = max(n.size[0] for n in things) + _NEIGHBOUR_GAP
    behind = max(n.size[1] for n in things) + 0.4
    c, s = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
    slots = Slots()
    for k in range(len(things)):
        row, seat = divmod(k, each)
        u = (seat - (min(each, len(things) - row * each) - 1) / 2) * pitch
        v = (row - (goal.rows - 1) / 2) * behind
        slots.append((place[0] + c * u - s * v, place[1] + s * u + c * v, wrapped(yaw)))
    return slots


def _assignment(things: Sequence[Node], slots: Slots) -> list[tuple[int, int]]:
    """Pairs (thing, slot) with the smallest total distance: a linear assignment (Kuhn 1955)."""
    away = [[math.dist(n.position[:2], s[:2]) for s in slots] for n in things]
    rows, columns = scipy.optimize.linear_sum_assignment(np.array(away))
    return [(int(i), int(j)) for i, j in zip(rows, columns, strict=True)]


def _assign(room: Room, things: Sequence[Node], slots: Slots) -> None:
    for i, j in _assignment(things, slots):
        room.move_to(things[i].id, *slots[j])


def mirror(room: Room) -> None:
    """Mirror every two alike things about the axis of the largest movable thing.

    Raises:
        WishError: no two things are alike, or there is no room.
    """
    movable = [n for n in room.nodes.values() if room.is_movable(n)]
    if len(movable) < 3:
        raise WishError("there is nothing to mirror")
    axis = max(movable, key=lambda n: n.size[0] * n.size[1])
    c, s = math.cos(math.radians(axis.yaw)), math.sin(math.radians(axis.yaw))
    done = 0
    for one, other in _pairs([n for n in movable if n.id != axis.id]):
        u, v = (_local(n, axis, c, s) for n in (one, other))
        aside, along = (abs(u[0]) + abs(v[0])) / 2, (u[1] + v[1]) / 2
        left, right = (one, other) if u[0] <= v[0] else (other, one)
        for node, x in ((left, -aside), (right, aside)):
            yaw = 90.0 * round((node.yaw - axis.yaw) / 90.0)
            yaw = yaw if node is left else -(room.nodes[left.id].yaw - axis.yaw)
            px, py = axis.position[0] + c * x - s * along, axis.position[1] + s * x + c * along
            if not room.fits(node.id, px, py, wrapped(axis.yaw + yaw), but=(one.id, other.id)):
                raise WishError(f"the {node.label} has no room where its mirror image would be")
            room.move_to(node.id, px, py, wrapped(axis.yaw + yaw))
        done += 1
    if not done:
        raise WishError("no two things here are alike, so nothing can be mirrored")
    room.done.append(f"{done} pair{'s' if done > 1 else ''} mirrored about the {axis.label}")


def _local(node: Node, axis: Node, c: float, s: float) -> tuple[float, float]:
    dx, dy = node.position[0] - axis.position[0], node.position[1] - axis.position[1]
    return c * dx + s * dy, c * dy - s * dx


def _pairs(nodes: Sequence[Node]) -> Iterator[tuple[Node, Node]]:
    """Pairs of things of one label and similar size."""
    left = list(nodes)
    while left:
        one = left.pop(0)
        alike = [n for n in left if n.label == one.label and _is_like(one, n)]
        if alike:
            left.remove(alike[0])
            yield one, alike[0]


def _is_like(a: Node, b: Node) -> bool:
    return all(abs(x - y) <= _SIZE_TOLERANCE * max(x, y) for x, y in zip(sorted(a.size), sorted(b.size), strict=True))
