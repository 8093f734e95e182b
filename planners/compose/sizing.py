"""Compute sizes of things and of the room from stated lengths, size words, usual ranges and needed floor area."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, pi, sqrt

import numpy as np

from ..rooms.node import Size
from . import knowledge
from .brief import Brief, Scale
from .furnishing import Furnishing, Group

_SCALES: dict[Scale, tuple[float, float]] = {  # (position in the usual range, factor)
    "tiny": (0.0, 0.7), "small": (0.0, 0.85), "normal": (0.5, 1.0), "large": (1.0, 1.15), "huge": (1.0, 1.4),
}  # fmt: skip
_EDGE_PER_CHAIR = 0.58  # metres of a table's edge that one chair takes
_PASSAGE = 0.35  # metres of passage around each thing on the floor, half of the way between two things
_FLOOR_SHARE = 0.72  # share of the floor that things may take, clear space and passages included
_WALL_SHARE = 0.62  # share of the wall length that things with their back to a wall may take
_LONGEST = 2.0  # times the longest usual side: limit of a side where only the other one is stated
_SMALLEST = 1.0  # metres, least side of a room


def size_of(group: Group, rng: np.random.Generator) -> Size:
    """Width, depth and height of each thing of a group, metres: stated, or drawn from the usual range."""
    thing, kind = group.thing, group.kind
    where, factor = _SCALES[thing.scale]
    shares = rng.random(3) if thing.scale == "normal" else np.full(3, where)
    drawn = [(low + (high - low) * t) * factor for (low, high), t in zip(kind.size, shares, strict=True)]
    width, depth, height = (
        s if s is not None else float(d) for s, d in zip((thing.width, thing.depth, thing.height), drawn, strict=True)
    )
    if kind.round and kind.support == "wall":
        width = height = thing.width or thing.height or (width + height) / 2
    elif kind.round and (thing.width is None or thing.depth is None):
        width = depth = thing.width or thing.depth or (width + depth) / 2
    return round(width, 3), round(depth, 3), round(height, 3)


def table_for(size: Size, chairs: int, is_round: bool) -> Size:
    """The size of a table, made large enough for this many chairs around it."""
    width, depth, height = size
    if is_round:
        need = round(max(width, chairs * _EDGE_PER_CHAIR / pi - 0.15), 3)
        return need, need, height
    ends = 2 * int(depth / _EDGE_PER_CHAIR)
    need = ceil(max(chairs - ends, 0) / 2) * _EDGE_PER_CHAIR
    return round(max(width, need), 3), depth, height


def sized(made: Furnishing, rng: np.random.Generator) -> list[tuple[Group, Size]]:
    """Every group with the size of its things; tables are made large enough for their chairs."""
    found = []
    for group in made.groups:
        size = size_of(group, rng)
        around = ((g, r) for g in made.groups for r in g.relations if r.name == "around")
        chairs = [g for g, relation in around if made.find(relation.objects[0]) is group]
        sat = -(-sum(g.count for g in chairs) // group.count)
        if sat > 1 and group.thing.width is None and group.kind.top:
            size = table_for(size, sat, group.kind.round)
        found.append((group, size))
    return found


def color_of(group: Group, styles: Sequence[str], rng: np.random.Generator, material_color: str) -> str:
    """The colour of a group: stated, else that of its material, else a usual one, preferably of the styles."""
    chosen = int(rng.integers(1 << 16))
    if group.thing.color or material_color:
        return group.thing.color or material_color
    liked = {c for s in styles if s in knowledge.styles() for c in knowledge.styles()[s].colors}
    usual = [c for c in group.kind.colors if c in liked] or list(group.kind.colors)
    return usual[chosen % len(usual)] if usual else ""


def stated_area(brief: Brief) -> float | None:
    """Floor area in square metres, from the stated area or sides; None where the brief states neither."""
    said = brief.size
    if said is None:
        return None
    if said.width is not None and said.depth is not None:
        return said.width * said.depth
    return said.area or (said.width or said.depth or 0.0) ** 2 or None


def room_size(
    brief: Brief, groups: Sequence[tuple[Group, Size]], rng: np.random.Generator, grow: float
) -> tuple[float, float, float]:
    """Width, depth and height of the room, metres: stated, else drawn from the usual range and large enough.

    Args:
        brief: may state sides or the area.
        groups: what has to fit, each with its size.
        rng: draws from the usual range.
        grow: factor on each side that was not stated.
    """
    kind, said = knowledge.room(brief.kind), brief.size
    where = {"tiny": 0.0, "small": 0.15, "normal": None, "large": 0.85, "huge": 1.0}[brief.scale]
    shares = rng.random(3) if where is None else np.full(3, where)
    width, depth, height = (
        float(low + (high - low) * t)
        for (low, high), t in zip((kind.width, kind.depth, kind.height), shares, strict=True)
    )
    by_floor, by_walls = _floor_needed(groups) / (width * depth), _wall_needed(groups) / (2 * (width + depth))
    stretch = max(1.0, sqrt(by_floor), by_walls) * grow
    width, depth = width * stretch, depth * stretch
    if said is not None:
        if said.area is not None and said.width is None and said.depth is None:
            ratio = sqrt(said.area / (width * depth))
            width, depth = width * ratio, depth * ratio
        area = said.area or width * depth
        width, depth = (
            said.width or (min(area / said.depth, _LONGEST * kind.width[1]) if said.depth else width),
            said.depth or (min(area / said.width, _LONGEST * kind.depth[1]) if said.width else depth),
        )
    return (
        round(max(width, 0.01 if said else _SMALLEST), 2),
        round(max(depth, 0.01 if said else _SMALLEST), 2),
        round(_height(brief, groups, height), 2),
    )


def _floor_needed(groups: Sequence[tuple[Group, Size]]) -> float:
    """Square metres of floor that things need, with the space that is kept free around them."""
    total = 1.2  # square metres before the door
    for group, (width, depth, height) in groups:
        if group.kind.support != "floor" or height < 0.05:
            continue
        before, behind, left, right = group.kind.clear
        passage = _PASSAGE / 2 if group.kind.seats == 1 else _PASSAGE
        total += group.count * (width + left + right + passage) * (depth + before + behind + passage)
    return total / _FLOOR_SHARE


def _wall_needed(groups: Sequence[tuple[Group, Size]]) -> float:
    """Metres of wall that things with their back to a wall need."""
    widths = sum(g.count * (size[0] + 0.1) for g, size in groups if g.kind.backed and g.kind.support == "floor")
    return (widths + 1.2) / _WALL_SHARE


def _height(brief: Brief, groups: Sequence[tuple[Group, Size]], usual: float) -> float:
    if brief.size is not None and brief.size.height is not None:
        return brief.size.height
    if "high ceiling" in brief.features:
        usual = max(usual, 3.4)
    if "low ceiling" in brief.features:
        usual = min(usual, 2.25)
    tallest = max((size[2] for _, size in groups), default=0.0)
    return max(usual, tallest + 0.1)
