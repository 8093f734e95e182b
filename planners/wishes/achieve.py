"""Brings a room to a state in which all goals hold: dispatches each goal to its function, some of them together."""

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
    PlainEdit,
    ReadingCorner,
    See,
    SetTable,
    Spread,
    Symmetric,
    Tidy,
    Walls,
    Where,
)
from .room import Room, WishError

_BALLOONS = 2  # bunches of balloons for a party without details


def achieve(room: Room, goals: Sequence[Goal]) -> None:
    """Change a room so that every goal holds.

    Raises:
        WishError: a goal cannot be reached.
    """
    todo: list[Goal] = [g for g in goals if not isinstance(g, PlainEdit)]
    if any(isinstance(g, Party) for g in todo):
        rest = [g for g in goals if not isinstance(g, Party)]
        todo = [g for g in todo if not isinstance(g, Party)] if rest else _party(room)
    walls = [g for g in todo if isinstance(g, Walls)]
    floors = [g for g in todo if isinstance(g, Clear)]
    if walls:
        floor.push_to_walls(room, walls, floors[0] if floors else None)
        floors = floors[1:]
    for wish in floors:
        floor.clear_floor(room, wish)
    for goal in todo:
        _achieve_one(room, goal)


def _party(room: Room) -> list[Goal]:
    """Add decorations; the goals of a party without details: furniture at the walls and a dance floor."""
    lamps = any(n.support == "ceiling" for n in room.nodes.values())
    if not lamps:  # streamers would overlap ceiling lamps
        room.ops.append(Insert(asset="streamers"))
    room.ops.append(Insert(asset="balloons", count=_BALLOONS))
    room.done.append(f"{'' if lamps else 'streamers and '}{_BALLOONS} bunches of balloons put up")
    return [Walls(), Clear(Where(), called="dance floor")]


def _achieve_one(room: Room, goal: Goal) -> None:
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
            floor.turn_seats(room, goal)
        case Spread():
            floor.spread(room, goal)
        case ReadingCorner():
            floor.reading_corner(room, goal)
        case Symmetric():
            formations.mirror(room)
        case Become():
            raise WishError(f"a {goal.kind} needs other furniture: compose such a room, or say what to add")
        case _:
            return
