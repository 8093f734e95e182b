"""Places of the room: its four walls and corners as the viewer sees them, and which of them a thing is at."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...gaussians.world.support import FIXED
from .reading.room_phrases import named_in
from .things import Thing

F64 = NDArray[np.float64]

AT_WALL = 0.3  # metres of gap up to which a thing stands at a wall
IN_CORNER = 0.8  # metres of gap to both walls up to which a thing is in their corner
NAMES = ("back", "front", "left", "right")
_THIRD = 1.0 / 3.0
_CENTRAL = 0.4  # of the way from the middle of the room to a wall


@dataclass(frozen=True, eq=False)
class Room:
    """The room as the viewer sees it.

    Attributes:
        width, depth: metres along x and y; its middle is the origin.
        forward: `[2]` unit vector of the viewer's line of sight in plan.
    """

    width: float
    depth: float
    forward: F64


def middle(thing: Thing) -> F64:
    """`[2]` centre of a thing in plan."""
    return np.array(thing.group.box.center[:2])


@dataclass(frozen=True, eq=False)
class Wall:
    """A wall of the room.

    Attributes:
        name: as the viewer sees it: "back", "front", "left" or "right".
        out: `[2]` unit vector from the middle of the room to it.
        reach: metres from the middle of the room to it.
    """

    name: str
    out: F64
    reach: float


def walls(room: Room) -> tuple[Wall, ...]:
    """The four walls, named as the viewer sees them."""
    forward = room.forward
    right = np.array([forward[1], -forward[0]])
    outs = [(np.array([1.0, 0.0]), room.width / 2), (np.array([-1.0, 0.0]), room.width / 2),
            (np.array([0.0, 1.0]), room.depth / 2), (np.array([0.0, -1.0]), room.depth / 2)]  # fmt: skip
    ways = {"back": forward, "front": -forward, "left": -right, "right": right}
    found: list[Wall] = []
    for name in NAMES:
        out, reach = max(outs, key=lambda o: float(o[0] @ ways[name]))
        outs = [o for o in outs if o[0] is not out]
        found.append(Wall(name, out, reach))
    return tuple(found)


def gap_to(wall: Wall, thing: Thing) -> float:
    """Metres between a thing and a wall; negative where it reaches into the wall."""
    box = thing.group.box
    return wall.reach - float(middle(thing) @ wall.out) - box.extent(np.array([*wall.out, 0.0])) / 2


def wall_of(thing: Thing, room: Room) -> tuple[Wall, float]:
    """The wall that a thing is at: of one that hangs on a wall the one along its width, of others the nearest."""
    every = walls(room)
    gaps = [(gap_to(w, thing), i) for i, w in enumerate(every)]
    best = min(gaps)[0]
    close = [i for gap, i in gaps if gap <= best + FIXED]
    if len(close) > 1 and thing.node is not None:
        back = -np.array(thing.node.yaw_box.front)
        close.sort(key=lambda i: -abs(float(every[i].out @ back)))
    return every[close[0]], gaps[close[0]][0]


def corner_of(thing: Thing, room: Room) -> tuple[Wall, Wall, float]:
    """The corner that a thing is nearest to, as its two walls, back or front first, and the larger gap to them."""
    back, front, left, right = walls(room)
    one = min((back, front), key=lambda w: gap_to(w, thing))
    other = min((left, right), key=lambda w: gap_to(w, thing))
    return one, other, max(gap_to(one, thing), gap_to(other, thing))


def in_corner(thing: Thing, room: Room) -> bool:
    """Whether a thing is in a corner of the room."""
    return corner_of(thing, room)[2] <= IN_CORNER


def zone(thing: Thing, room: Room) -> tuple[str, str]:
    """The part of the room: "back", "front" or "", and "left", "right" or "", "" being the middle third."""
    back, _, _, right = walls(room)
    place = middle(thing)
    deep, wide = float(place @ back.out) / back.reach, float(place @ right.out) / right.reach
    return (
        "back" if deep > _THIRD else "front" if deep < -_THIRD else "",
        "right" if wide > _THIRD else "left" if wide < -_THIRD else "",
    )


def is_in(thing: Thing, said: str, room: Room) -> tuple[bool, float]:
    """Whether a thing is in a place of the room, as said, and how sure that is."""
    names = named_in(said)
    if "corner" in said:
        one, other, gap = corner_of(thing, room)
        return gap <= IN_CORNER and set(names) <= {one.name, other.name}, 0.93 if abs(gap - IN_CORNER) > 0.3 else 0.75
    if "wall" in said:
        wall, _ = wall_of(thing, room)
        others = [w for w in walls(room) if w.name in names] or [wall]
        least = min(gap_to(w, thing) for w in others)
        return least <= AT_WALL, 0.93 if abs(least - AT_WALL) > 0.15 else 0.75
    back, _, _, right = walls(room)
    wide, far = float(middle(thing) @ right.out) / right.reach, float(middle(thing) @ back.out) / back.reach
    if re.search(r"\b(?:middle|cent(?:er|re))\b", said):
        off = max(abs(wide), abs(far))
        return off <= _CENTRAL, 0.9 if abs(off - _CENTRAL) > 0.15 else 0.7
    along = {"right": wide, "left": -wide, "back": far, "front": -far}
    least = min((along[n] for n in names), default=-1.0)
    return least > 0, round(0.6 + 0.33 * min(abs(least) / 0.2, 1.0), 3)
