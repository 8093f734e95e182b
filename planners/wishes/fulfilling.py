"""Goals to the room as it should be: which is worked out by what, and which belong together.

Knows the kinds of goals. Refuses to know how any of them is reached.
"""

from __future__ import annotations

from collections.abc import Sequence

from ...tools.ops.insert import Insert
from . import floor, formations, surfaces
from .goals import (
    Become,
    Clear,
    Declutter,
    Formation,
    Goal,
    Party,
    Plain,
    ReadingCorner,
    See,
    SetTable,
    Spread,
    Symmetric,
    Tidy,
    Walls,
    Where,
)
from .room import CannotError, Room

_BALLOONS = 2  # bunches at a party that nobody described


def fulfil(room: Room, goals: Sequence[Goal]) -> None:
    """Bring a room to where every goal holds.

    Raises:
        CannotError: one cannot.
    """
    todo: list[Goal] = [g for g in goals if not isinstance(g, Plain)]
    if any(isinstance(g, Party) for g in todo):
        rest = [g for g in goals if not isinstance(g, Party)]
        todo = [g for g in todo if not isinstance(g, Party)] if rest else _party(room)
    walls = [g for g in todo if isinstance(g, Walls)]
    floors = [g for g in todo if isinstance(g, Clear)]
    if walls:
        floor.push(room, walls, floors[0] if floors else None)
        floors = floors[1:]
    for wish in floors:
        floor.clear(room, wish)
    for goal in todo:
        _fulfil_one(room, goal)


def _party(room: Room) -> list[Goal]:
    """What a party takes that nobody described."""
    lamps = any(n.support == "ceiling" for n in room.nodes.values())
    if not lamps:  # they would hang in each other
        room.ops.append(Insert(asset="streamers"))
    room.ops.append(Insert(asset="balloons", count=_BALLOONS))
    room.told.append(f"{'' if lamps else 'streamers and '}{_BALLOONS} bunches of balloons put up")
    return [Walls(), Clear(Where(), called="dance floor")]


def _fulfil_one(room: Room, goal: Goal) -> None:
    match goal:
        case Formation():
            formations.form(room, goal)
        case Tidy():
            surfaces.tidy(room)
        case Declutter():
            surfaces.declutter(room, goal)
        case SetTable():
            surfaces.set_table(room, goal)
        case See():
            floor.see(room, goal)
        case Spread():
            floor.spread(room, goal)
        case ReadingCorner():
            floor.reading_corner(room, goal)
        case Symmetric():
            formations.mirror(room)
        case Become():
            raise CannotError(f"making a room a {goal.kind} takes other furniture: compose one, or say what to add")
        case _:
            return
