"""Find from upright boxes what a thing rests on: another thing, the floor, a wall or the ceiling.

A room has its origin at the centre of the floor; lengths are metres. In a scene of any scale, `standing_on` finds what
moves along with a thing, from the score of the relation "on" (see `relations`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..camera import Vec3
from ..language.field.language_field import Group, LanguageField
from ..scene import Frame
from .box import YawBox
from .person import STEP
from .relation_geometry import HOLDS, Stand
from .relations import score

SHELL = ("floor", "wall", "ceiling")
ALOFT = "air"  # of what falls or floats at a moment of a film, and rests on nothing
NO_THINGS = (*SHELL, ALOFT)  # supports that are no things
CONTACT = 0.12  # of the smaller height: error of measured boxes where a thing's underside meets another's top
_THIN = 0.05  # metres: least height for `CONTACT`, so that things can stand on a thin rug
FIXED = 0.1  # largest metres between a wall or the ceiling and a thing fixed to it: brackets and frames
AIR = 0.02  # largest metres of air under a thing that counts as standing
_GROUNDED = (0.05, 0.1)  # of the room's height, and of its own: an underside lower than either is on the floor
_TOPMOST = 0.97  # of the room's height: a thing that reaches higher, and stands on nothing, hangs from the ceiling
SHEET = 20.0  # a thing longer than this times its height is a sheet, as a rug, which moves without the things on it


def is_stepped_on(support: int | str, height: float) -> bool:
    """Whether a thing lies on the floor so low that people and furniture stand on it, as on a rug."""
    return support == "floor" and height <= STEP


def is_sheet(size: Vec3) -> bool:
    """Whether a thing is so thin for its length that things on it do not move along; at any scale."""
    return max(size[:2]) > SHEET * size[2]


def wall_gap(box: YawBox, room: Vec3) -> float:
    """Metres from a box to the nearest wall of a room of that size; negative where it reaches into the wall."""
    (hx, hy), (width, depth, _) = box.half, room
    return min(width / 2 - abs(box.x) - hx, depth / 2 - abs(box.y) - hy)


def aside(upper: YawBox, lower: YawBox) -> float:
    """Metres by which the middle of `upper` is off the footprint of `lower`; zero or less where it is over it."""
    x, y = lower.local(upper.x, upper.y)
    return float(max(abs(x) - lower.w / 2, abs(y) - lower.d / 2))


def air(upper: YawBox, lower: YawBox) -> float:
    """Metres of height between the underside of `upper` and `lower`; negative where it is inside, as on a seat."""
    return max(upper.low - lower.high, lower.low - upper.low)


def touches_top(upper: YawBox, lower: YawBox) -> bool:
    """Whether the underside of `upper` meets the top of `lower`, within the error of measured boxes.

    The middle of `upper` must be over the footprint of `lower`, and higher than its middle.
    """
    if lower.low + lower.h / 2 >= upper.low + upper.h / 2 or aside(upper, lower) > 0:
        return False
    return abs(upper.low - lower.high) <= CONTACT * max(min(lower.h, upper.h), _THIN)


def support_of(
    index: int, boxes: Sequence[YawBox], room: Vec3, fixture: bool
) -> int | Literal["floor", "wall", "ceiling"]:
    """What a thing rests on: the index of another one in `boxes`, or "floor", "wall" or "ceiling".

    In this order: the highest box whose top touches its underside; the wall, for a fixture at one; the floor; the
    ceiling; the smallest box that its underside is inside (a seat, a shelf); the wall for fixtures and things at one;
    the floor.

    Args:
        index: row of the thing.
        fixture: whether things of this kind hang on walls.
    """
    box = boxes[index]
    others = [i for i in range(len(boxes)) if i != index]
    below = [i for i in others if touches_top(box, boxes[i])]
    if below:
        return max(below, key=lambda i: (boxes[i].high, i))
    at_wall = wall_gap(box, room) < FIXED
    if fixture and at_wall:
        return "wall"
    if box.low <= max(_GROUNDED[0] * room[2], _GROUNDED[1] * box.h):
        return "floor"
    if box.high >= _TOPMOST * room[2] and not fixture:
        return "ceiling"
    around = [i for i in others if boxes[i].low < box.low < boxes[i].high and aside(box, boxes[i]) <= 0]
    if around and not fixture:
        return min(around, key=lambda i: (math.prod(boxes[i][3:6]), i))
    return "wall" if fixture or at_wall else "floor"


def standing_on(field: LanguageField, frame: Frame, support: Group) -> tuple[Group, ...]:
    """Objects of a scene that stand directly on an object, or in it as on a shelf; none for a sheet (a rug)."""
    if support.level != "object" or is_sheet(support.box.size):
        return ()
    east, north, up = frame.basis()
    stand = Stand(east, north, up, np.zeros(3), field.typical_size)
    over = _may_overlap(field, support, up)
    others = (g for g in field.objects() if g.count and g.id != support.id and over[g.id])
    return tuple(g for g in others if score("on", g, [support], stand) >= HOLDS)


def _may_overlap(field: LanguageField, support: Group, up: NDArray[np.float64]) -> NDArray[np.bool_]:
    """`[G]`: groups whose footprint may lie over that of a group: seen from above, their centres are no farther apart
    than their boxes reach. Scenes of many rooms have thousands of things elsewhere."""
    boxes = field.boxes
    apart = boxes.centers - np.array(support.box.center)
    level = np.linalg.norm(apart - (apart @ up)[:, None] * up, axis=1)
    reach = (np.linalg.norm(boxes.sizes, axis=1) + np.linalg.norm(support.box.size)) / 2
    return np.asarray(level <= reach * (1 + 1e-6) + 1e-9)
