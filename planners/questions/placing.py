"""Where a thing is in the room, in a few words: "on the desk", "at the back wall", "in the front left corner"."""

from __future__ import annotations

from ...gaussians.world.support import ALOFT
from . import measuring
from .relating import related, supporter
from .room_places import AT_WALL, corner_of, in_corner, wall_of, zone
from .survey import Survey, Thing

_NEAR = 1.2  # metres: farther things are not told as neighbours
_SMALL = 0.5  # metres: of what is smaller it is told that it is on the floor, where it might be on something


def place_of(thing: Thing, survey: Survey) -> tuple[str, str]:
    """Where a thing is in a few words, and more of it; measured once for each thing of a survey."""
    if thing.row not in survey.places:
        survey.places[thing.row] = _place_of(thing, survey)
    return survey.places[thing.row]


def _place_of(thing: Thing, survey: Survey) -> tuple[str, str]:
    if thing.node is None:
        return "part of the room", ""
    on = supporter(thing, survey)
    if not isinstance(on, str):
        inside = thing.group.box.center[2] < on.group.box.center[2] + on.group.box.size[2] / 2
        return f"{'in' if inside else 'on'} {survey.named(on)}", _side(thing, survey)
    if on == ALOFT:
        return "in the air", _on_ground(thing, survey)[0]
    if on == "wall":
        below = [t for t in related("under", (thing,), survey) if t.node is not None and t.node.support == "floor"]
        more = f"above {survey.named(below[0])}" if below else _beside(thing, survey)
        return f"on the {wall_of(thing, survey.room)[0].name} wall", more
    if on == "ceiling":
        under = [t for t in related("under", (thing,), survey) if t.node is not None and t.node.support == "floor"]
        under.sort(key=lambda t: t.group.box.size[2], reverse=True)  # the table, not the rug under it
        return "on the ceiling", f"over {survey.named(under[0])}" if under else _side(thing, survey)
    return _on_floor(thing, survey)


def _on_floor(thing: Thing, survey: Survey) -> tuple[str, str]:
    where, beside = _on_ground(thing, survey)
    small = survey.scaled and max(measuring.sides(survey, thing)) < _SMALL
    return (f"on the floor {where}" if small else where), beside


def _on_ground(thing: Thing, survey: Survey) -> tuple[str, str]:
    beside = _beside(thing, survey)
    if in_corner(thing, survey.room):
        one, other, _ = corner_of(thing, survey.room)
        return f"in the {one.name} {other.name} corner", beside
    wall, gap = wall_of(thing, survey.room)
    if gap <= AT_WALL:
        return f"at the {wall.name} wall", beside
    return _side(thing, survey), beside


def _beside(thing: Thing, survey: Survey) -> str:
    near = [t for t in related("next_to", (thing,), survey) if survey.gap(t, thing) <= _NEAR]
    return f"next to {survey.named(near[0])}" if near else ""


def _side(thing: Thing, survey: Survey) -> str:
    deep, wide = zone(thing, survey.room)
    if deep and wide:
        return f"at the {deep} on the {wide} of the room"
    if deep:
        return f"at the {deep} of the room"
    return f"on the {wide} side of the room" if wide else "in the middle of the room"


def sides(survey: Survey) -> tuple[float, float, float]:
    """Width (from the viewer's left to right), depth and height of the room, metres."""
    width, depth, height = survey.graph.room.size
    return (depth, width, height) if is_turned(survey) else (width, depth, height)


def is_turned(survey: Survey) -> bool:
    """Whether the viewer's left and right run along y."""
    right = survey.stand.right
    return abs(float(right[1])) > abs(float(right[0])) + 1e-9
