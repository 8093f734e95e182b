"""Sizes of things and of the room: from stated lengths, words of size, usual ranges and the floor that things need."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, pi, sqrt

import numpy as np

from ..rooms.node import Size
from . import knowledge
from .brief import Brief, Scale
from .furnishing import Furnishing, Group

_SCALES: dict[Scale, tuple[float, float]] = {  # (where in the range, factor)
    "tiny": (0.0, 0.7), "small": (0.0, 0.85), "normal": (0.5, 1.0), "large": (1.0, 1.15), "huge": (1.0, 1.4),
}  # fmt: skip
_SIT = 0.58  # metres of a table's edge that one chair takes
_PASSAGE = 0.35  # metres around each thing on the floor, half of a way between two
_FULL = 0.72  # share of a floor that things with their clear space and passages may take
_BACKS = 0.62  # share of the walls that backed things may take
_LONGEST = 2.0  # times as long as usual a room becomes of which one side is stated
_SMALLEST = 1.0  # metres, of a room's side


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


def table_for(size: Size, chairs: int, round_one: bool) -> Size:
    """A table made so much larger that this many chairs find room around it."""
    width, depth, height = size
    if round_one:
        need = round(max(width, chairs * _SIT / pi - 0.15), 3)
        return need, need, height
    ends = 2 * int(depth / _SIT)
    need = ceil(max(chairs - ends, 0) / 2) * _SIT
    return round(max(width, need), 3), depth, height


def sized(made: Furnishing, rng: np.random.Generator) -> list[tuple[Group, Size]]:
    """Every group with the size of its things; tables are as large as their chairs need."""
    found = []
    for group in made.groups:
        size = size_of(group, rng)
        chairs = [g for g in made.groups for b in g.bonds if b.name == "around" and made.find(b.objects[0]) is group]
        sat = -(-sum(g.count for g in chairs) // group.count)
        if sat > 1 and group.thing.width is None and group.kind.top:
            size = table_for(size, sat, group.kind.round)
        found.append((group, size))
    return found


def color_of(group: Group, styles: Sequence[str], rng: np.random.Generator, material_color: str) -> str:
    """The colour of a group: said, of its material, or one it usually has that the styles like."""
    chosen = int(rng.integers(1 << 16))
    if group.thing.color or material_color:
        return group.thing.color or material_color
    liked = {c for s in styles if s in knowledge.styles() for c in knowledge.styles()[s].colors}
    usual = [c for c in group.kind.colors if c in liked] or list(group.kind.colors)
    return usual[chosen % len(usual)] if usual else ""


def stated_area(brief: Brief) -> float | None:
    """Floor area in square metres as far as the brief says it."""
    said = brief.size
    if said is None:
        return None
    if said.width is not None and said.depth is not None:
        return said.width * said.depth
    return said.area or (said.width or said.depth or 0.0) ** 2 or None


def room_size(
    brief: Brief, groups: Sequence[tuple[Group, Size]], rng: np.random.Generator, grow: float
) -> tuple[float, float, float]:
    """Width, depth and height of the room: what was stated, and otherwise usual and large enough.

    Args:
        brief: says it, or says nothing.
        groups: what has to fit, each with its size.
        rng: draws from the usual range.
        grow: how much longer each side is made that was not stated.
    """
    kind, said = knowledge.room(brief.kind), brief.size
    where = {"tiny": 0.0, "small": 0.15, "normal": None, "large": 0.85, "huge": 1.0}[brief.scale]
    shares = rng.random(3) if where is None else np.full(3, where)
    width, depth, height = (
        float(low + (high - low) * t)
        for (low, high), t in zip((kind.width, kind.depth, kind.height), shares, strict=True)
    )
    stretch = max(1.0, sqrt(_needed(groups) / (width * depth)), _backs(groups) / (2 * (width + depth))) * grow
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


def _needed(groups: Sequence[tuple[Group, Size]]) -> float:
    """Square metres of floor that things take with what is kept free about them."""
    total = 1.2  # before the door
    for group, (width, depth, height) in groups:
        if group.kind.support != "floor" or height < 0.05:
            continue
        before, behind, left, right = group.kind.clear
        passage = _PASSAGE / 2 if group.kind.seats == 1 else _PASSAGE
        total += group.count * (width + left + right + passage) * (depth + before + behind + passage)
    return total / _FULL


def _backs(groups: Sequence[tuple[Group, Size]]) -> float:
    """Metres of wall that things with their back to it need."""
    widths = sum(g.count * (size[0] + 0.1) for g, size in groups if g.kind.backed and g.kind.support == "floor")
    return (widths + 1.2) / _BACKS


def _height(brief: Brief, groups: Sequence[tuple[Group, Size]], usual: float) -> float:
    if brief.size is not None and brief.size.height is not None:
        return brief.size.height
    if "high ceiling" in brief.features:
        usual = max(usual, 3.4)
    if "low ceiling" in brief.features:
        usual = min(usual, 2.25)
    tallest = max((size[2] for _, size in groups), default=0.0)
    return max(usual, tallest + 0.1)
