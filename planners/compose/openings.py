"""Place doors, windows, curtains and beams, before the layout solver places the furniture."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..layout.problem import Item, Stand, Wall
from ..rooms.node import Size
from . import knowledge
from .brief import Brief

_SILL = 0.9  # metres from the floor to a window
_BEFORE = 0.3  # metres before a window that are kept free of things taller than its sill
_NARROWEST = 0.5  # metres, a window above a thing
_EDGE = 0.12  # least metres from an opening to the corner
_YAWS: dict[Wall, float] = {"north": 0.0, "east": -90.0, "south": 180.0, "west": 90.0}
_WINDOW_WALLS: tuple[Wall, ...] = ("north", "west", "east", "south")


@dataclass
class _Walls:
    """The intervals of each wall that openings take, metres from its middle."""

    size: Size
    taken: dict[Wall, list[tuple[float, float]]]

    def length(self, wall: Wall) -> float:
        return self.size[0] if wall in ("north", "south") else self.size[1]

    def free(self, wall: Wall, along: float, width: float) -> bool:
        low, high = along - width / 2, along + width / 2
        fits = abs(along) + width / 2 <= self.length(wall) / 2 - 0.02
        return fits and all(high <= a or low >= b for a, b in self.taken[wall])

    def stand(self, wall: Wall, along: float, size: Size, bottom: float) -> Stand:
        """The position of an opening that begins at height `bottom`; its back is in the wall's plane."""
        half, middle = size[1] / 2, bottom + size[2] / 2
        x, y = self.size[0] / 2 - half, self.size[1] / 2 - half
        spot = {"north": (along, y), "south": (along, -y), "east": (x, along), "west": (-x, along)}[wall]
        return Stand(position=(round(spot[0], 4), round(spot[1], 4), round(middle, 4)), yaw=_YAWS[wall])


def openings(
    brief: Brief, size: Size, rng: np.random.Generator, ids: Iterator[int], beneath: Sequence[Size] = ()
) -> tuple[list[Item], list[Item]]:
    """Doors and windows of a room, each with its place on a wall.

    Args:
        brief: may state how many.
        size: of the room.
        rng: chooses walls and places.
        ids: numbers for them.
        beneath: sizes of things that are said to be under a window, which is no wider and above them.
    """
    walls = _Walls(size, {w: [] for w in _WINDOW_WALLS})
    asked = {t.name: t for t in brief.things if t.name in ("door", "window")}
    kind = knowledge.room(brief.kind)
    doors = asked["door"].count if "door" in asked else 0 if kind.outdoor else 1
    low, high = kind.windows
    drawn = int(rng.integers(low, high + 1))
    needs = any(r.name == "at_window" for r in brief.relations)
    windows = asked["window"].count if "window" in asked else 0 if "window" in brief.without else max(drawn, int(needs))
    if "door" in brief.without:
        doors = 0
    order: list[Wall] = ["east", "west"] if rng.random() < 0.5 else ["west", "east"]
    named = {r.wall for r in brief.relations if r.wall}  # openings avoid walls that the brief names for things
    own = {r.wall for r in brief.relations if r.subject == "door"}
    entered: list[Wall] = sorted([*order, "north", "south"], key=lambda w: (w not in own, w == "south", w in named))
    made = [_doors(walls, ids, entered[i % 4], rng) for i in range(doors)]
    scale = 1.35 if "window" in asked and asked["window"].scale in ("large", "huge") else 1.0
    shown = {r.wall for r in brief.relations if r.subject == "window"}
    avoided = {entered[0], *named, "south"}
    lit = [w for w in _WINDOW_WALLS if w in shown] or [w for w in _WINDOW_WALLS if w not in avoided]
    lit = lit or list(_WINDOW_WALLS)
    limits = (scale, min((0.9 * s[0] for s in beneath), default=30.0), max((s[2] for s in beneath), default=0.0) + 0.03)
    glazed = [_window(walls, ids, lit[i % len(lit)], limits, rng) for i in range(windows)]
    return [d for d in made if d], [w for w in glazed if w]


def _doors(walls: _Walls, ids: Iterator[int], wall: Wall, rng: np.random.Generator) -> Item | None:
    kind = knowledge.things()["door"]
    length, height = walls.length(wall), walls.size[2]
    width = round(min(float(rng.uniform(*kind.size[0])), length - 0.1), 3)
    size = (width, 0.06, round(min(2.0, height - 0.05), 3))
    if width < 0.4 or size[2] < 0.5:
        return None
    side = 1 if rng.random() < 0.5 else -1
    for at in (side, -side, 0):
        along = at * max(length / 2 - width / 2 - _EDGE, 0.0)
        if walls.free(wall, along, width):
            walls.taken[wall].append((along - width / 2, along + width / 2))
            stand = walls.stand(wall, along, size, 0.0)
            color = "brown" if rng.random() < 0.5 else "white"
            way = min(0.9, walls.size[1 if wall in ("north", "south") else 0] / 2)
            return Item(
                id=next(ids), label="door", color=color, size=size, support="wall", stand=stand, clear=(way, 0, 0, 0)
            )
    return None


def _window(
    walls: _Walls, ids: Iterator[int], wall: Wall, limits: tuple[float, float, float], rng: np.random.Generator
) -> Item | None:
    """A window on a wall; `limits`: factor on its usual size, its greatest width and its lowest underside."""
    kind, (scale, widest, lowest) = knowledge.things()["window"], limits
    widest = max(widest, _NARROWEST)
    length, height = walls.length(wall), walls.size[2]
    width = round(min(float(rng.uniform(*kind.size[0])) * scale, length - 2 * _EDGE, widest), 3)
    bottom = min(_SILL, height * 0.35) if scale == 1.0 else min(0.5, height * 0.2)
    bottom = max(bottom, min(lowest, height - 0.6))
    tall = round(min(float(rng.uniform(*kind.size[2])) * scale, height - bottom - 0.15), 3)
    if width < 0.3 or tall < 0.3:
        return None
    reach = length / 2 - width / 2 - _EDGE
    for along in (0.0, -reach, reach, -reach / 2, reach / 2):
        if walls.free(wall, along, width):
            walls.taken[wall].append((along - width / 2, along + width / 2))
            size = (width, 0.08, tall)
            stand = walls.stand(wall, along, size, bottom)
            box = Item(id=next(ids), label="window", color="white", size=size, support="wall", stand=stand)
            return box.model_copy(update={"height": round(bottom, 3), "clear": (_BEFORE, 0.0, 0.0, 0.0)})
    return None


def hang_curtains(
    items: Sequence[Item], most: int, size: Size, height: float, color: str, ids: Iterator[int]
) -> tuple[list[Item], list[Item]]:
    """Add a curtain before each window without one; returns all items, and the curtains.

    A curtain hangs from above its window to below the sill. The clear space before the window moves to the curtain.

    Args:
        items: doors and windows among them.
        most: how many curtains at most.
        size: usual size of a curtain, of which only the depth is used.
        height: of the room.
        color: of all.
        ids: numbers for them.
    """
    windows = [i for i in items if i.label == "window" and any(i.clear)]
    openings = [i for i in items if i.label in ("window", "door")]
    made = [_curtain(w, openings, size[1], height, color, next(ids)) for w in windows[:most]]
    bare = {w.id: w.model_copy(update={"clear": (0.0,) * 4}) for w in windows[:most]}
    return [*(bare.get(i.id, i) for i in items), *made], made


def _curtain(window: Item, openings: Sequence[Item], deep: float, height: float, color: str, number: int) -> Item:
    """A curtain 1.3 times as wide as its window, or less where the next opening on the wall is near."""
    stand = window.stand
    assert stand is not None  # `openings` places each opening that it makes
    along = 0 if stand.yaw in (0.0, 180.0) else 1
    width = 1.3 * window.size[0]
    for other in openings:
        if other is not window and other.stand is not None and other.stand.yaw == stand.yaw:
            apart = abs(other.stand.position[along] - stand.position[along])
            width = min(width, max(apart + (window.size[0] - other.size[0]) / 2, window.size[0]))
    low = max((window.height or 0.0) - 0.1, 0.05)
    high = min(stand.position[2] + window.size[2] / 2 + 0.18, height - 0.02)
    away = window.size[1] / 2 + deep / 2 + 0.01
    inward = {0.0: (0.0, -1.0), 180.0: (0.0, 1.0), 90.0: (1.0, 0.0), -90.0: (-1.0, 0.0)}[stand.yaw]
    x, y = (round(c + away * i, 4) for c, i in zip(stand.position[:2], inward, strict=True))
    return Item(
        id=number,
        label="curtain",
        color=color,
        size=(round(width, 3), deep, round(high - low, 3)),
        support="wall",
        stand=Stand(position=(x, y, round((low + high) / 2, 4)), yaw=stand.yaw),
        height=round(low, 3),
        clear=(_BEFORE, 0.0, 0.0, 0.0),
    )


def beams(size: Size, count: int, section: Size, color: str, ids: Iterator[int]) -> list[Item]:
    """Beams from the west to the east wall, evenly spaced over the depth.

    Args:
        size: of the room.
        count: how many at most; they are at least half a metre apart.
        section: its depth and height are those of a beam.
        color: of all.
        ids: numbers for them.
    """
    number = max(1, min(count, int(size[1] / 0.5)))
    deep, tall = section[1], min(section[2], size[2] / 8)
    box = (round(size[0] - 0.02, 3), deep, round(tall, 3))
    made = []
    for i in range(number):
        y = size[1] * ((i + 0.5) / number - 0.5)
        stand = Stand(position=(0.0, round(y, 4), round(size[2] - tall / 2, 4)))
        made.append(Item(id=next(ids), label="beam", color=color, size=box, support="ceiling", stand=stand))
    return made
