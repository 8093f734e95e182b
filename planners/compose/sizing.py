"""Compute sizes of things and of the room from stated lengths, size words, usual ranges and needed floor area."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, pi, sqrt

import numpy as np

from ..rooms.node import Size
from . import knowledge
from .brief import Brief, Scale
from .furnishing import ROOF, Furnishing, Group

_SCALES: dict[Scale, tuple[float, float]] = {  # (position in the usual range, factor)
    "tiny": (0.0, 0.7), "small": (0.0, 0.85), "normal": (0.5, 1.0), "large": (1.0, 1.15), "huge": (1.0, 1.4),
}  # fmt: skip
_EDGE_PER_CHAIR = 0.58  # metres of a table's edge that one chair takes
_PASSAGE = 0.35  # metres of passage around each thing on the floor, half of the way between two things
_FLOOR_SHARE = 0.72  # share of the floor that things may take, clear space and passages included
_WALL_SHARE = 0.62  # share of the wall length that things with their back to a wall may take
_LONGEST = 2.0  # times the longest usual side: limit of a side where only the other one is stated
_BESIDE = 0.03  # metres between things on a top
_LOOSE = 1.15  # factor on the width of a top that holds several rows of things, as they differ in size
_RAIL = 0.2  # metres, depth of railings and fences
_STANDS = 0.7  # least share of a thing's depth that is on what carries it
_MOST_GROWN = 2.5  # factor by which what carries things may grow
_MOST_AT_ROUND = 4  # seats of a round table that are not in a ring
_RING_SHARE = 0.92  # of the square around a ring of seats, which others may not enter
_LEAST = 0.6  # furniture shrinks no further to stand on something
_SMALLEST = 1.0  # metres, least side of a room


def size_of(group: Group, rng: np.random.Generator, shrink: float = 1.0) -> Size:
    """Width, depth and height of each thing of a group, metres: stated, or drawn from the usual range.

    `shrink` is a factor on what is not stated: 1 draws freely, less takes the lower end of the range and that factor.
    """
    thing, kind = group.thing, group.kind
    where, factor = _SCALES[thing.scale]
    shares = rng.random(3) if thing.scale == "normal" else np.full(3, where)
    factors = (factor, factor, 1.0 if kind.top or kind.seats else factor)  # a long table is no higher than others
    if shrink < 1.0:
        shares = np.array([0.0, 0.0, shares[2]])
        factors = (factor * shrink, factor * shrink, factors[2])
    drawn = [(low + (high - low) * t) * f for (low, high), t, f in zip(kind.size, shares, factors, strict=True)]
    width, depth, height = (
        s if s is not None else float(d) for s, d in zip((thing.width, thing.depth, thing.height), drawn, strict=True)
    )
    if kind.round and kind.support == "wall":
        width = height = thing.width or thing.height or (width + height) / 2
    elif kind.round and (thing.width is None or thing.depth is None):
        width = depth = thing.width or thing.depth or (width + depth) / 2
    return round(width, 3), round(depth, 3), round(height, 3)


def table_for(size: Size, chairs: int, is_round: bool, sides: int = 4, edge: float = _EDGE_PER_CHAIR) -> Size:
    """The size of a table, made large enough for this many chairs around it, at one, two or four of its sides, each of
    which takes `edge` metres."""
    width, depth, height = size
    if sides < 4 and not is_round:
        return round(max(width, ceil(chairs / sides) * edge), 3), depth, height
    if is_round:
        need = round(max(width, chairs * edge / pi - 0.15), 3)
        return need, need, height
    ends = 2 * int(depth / edge)
    need = ceil(max(chairs - ends, 0) / 2) * edge
    return round(max(width, need), 3), depth, height


def sized(made: Furnishing, rng: np.random.Generator, shrink: float = 1.0) -> list[tuple[Group, Size]]:
    """Every group with the size of its things: one size for all of a kind. Tables are made large enough for their
    chairs, and what carries things for what it carries."""
    found = dict[str, Size]()
    drawn = dict[tuple[object, ...], Size]()
    for group in made.groups:
        thing = group.thing
        alike = (group.kind.name, thing.scale, thing.width, thing.depth, thing.height, thing.optional)
        size = size_of(group, rng, shrink)
        size = drawn.setdefault(alike, size)
        around = [(g, r) for g in made.groups for r in g.relations if r.name == "around"]
        chairs = [(g, r) for g, r in around if made.find(r.objects[0]) is group]
        sat = -(-sum(g.count for g, _ in chairs) // group.count)
        if sat > 1 and thing.width is None and group.kind.top:
            edge = max(max(g.kind.size[0][1] for g, _ in chairs) + 0.08, _EDGE_PER_CHAIR)
            sides = 2 if any(r.sides for _, r in chairs) else 1 if group.kind.backed else 4
            size = table_for(size, sat, group.kind.round, sides, edge)
        found[group.key] = size
    for group in made.groups:
        _fit_canopy(made, group, found)
    for group in made.groups:
        _fit_loads(made, group, found)
        _fit_beneath(made, group, found)
        _fit_inside(made, group, found)
    return [(g, found[g.key]) for g in made.groups]


def _fit_loads(made: Furnishing, carrier: Group, sizes: dict[str, Size]) -> None:
    """Widen what carries things that were asked for until they fit on it in rows; where its own size is stated, or it
    would grow too much, the things shrink instead."""
    on = [(g, r) for g in made.groups if g.asked for r in g.relations if r.name == "on" and r.objects]
    loads = [g for g, r in on if made.find(r.objects[0]) is carrier and g is not carrier and not carrier.kind.is_rug]
    if not loads:
        return
    width, depth, height = sizes[carrier.key]
    counts = [ceil(g.count / carrier.count) for g in loads]
    deepest = max(sizes[g.key][1] for g in loads)
    thing = carrier.thing
    deep = depth if thing.depth is not None else min(max(depth, deepest + 0.02), _MOST_GROWN * depth)
    rows = max(int((deep + 0.01) / (deepest + _BESIDE)), 1)
    need = sum(n * (sizes[g.key][0] + _BESIDE) for g, n in zip(loads, counts, strict=True)) / rows
    need = max(need, max(sizes[g.key][0] for g in loads) + 0.02)
    if sum(counts) > 1 and rows > 1:
        need *= _LOOSE
    wide = width if thing.width is not None else min(max(width, need), _MOST_GROWN * width)
    if carrier.kind.round:
        wide = deep = max(wide, deep)
    sizes[carrier.key] = round(wide, 3), round(deep, 3), height
    rail = carrier.kind.backed and depth < _RAIL  # at the edge of the place: nothing may stand over on its far side
    factor = min(1.0, wide / need, (deep if rail else deep / _STANDS) / deepest)
    if any(g.kind.seats for g in loads):
        factor = max(factor, _LEAST)
    if factor < 1.0:
        for g in loads:
            if g.thing.width is None and g.thing.depth is None:
                w, d, h = sizes[g.key]
                sizes[g.key] = round(w * factor, 3), round(d * factor, 3), round(h * max(factor, 0.7), 3)


def _fit_canopy(made: Furnishing, group: Group, sizes: dict[str, Size]) -> None:
    """Widen a roof without a stated size over what is said to be under it, with the chairs around that."""
    for relation in group.relations:
        roof = made.find(relation.objects[0]) if relation.name in ("under", "below") and relation.objects else None
        if roof is None or roof.kind.under < ROOF or roof.thing.width is not None or group.kind.is_rug:
            continue
        (width, depth, height), (w, d, _) = sizes[roof.key], sizes[group.key]
        seated = any(r.name == "around" and made.find(r.objects[0]) is group for g in made.groups for r in g.relations)
        room = 1.5 if seated else 0.3
        number = ceil(group.count / roof.count)
        w, d = (w * number + room, d + room) if number > 1 else (w + room, d + room)
        sizes[roof.key] = round(max(width, w), 3), round(max(depth, d), 3), height


def _fit_inside(made: Furnishing, group: Group, sizes: dict[str, Size]) -> None:
    """Widen a container without a stated size for what is inside it, up to a limit; beyond it the contents shrink."""
    for relation in group.relations:
        other = made.find(relation.objects[0]) if relation.name == "inside" and relation.objects else None
        if other is None or other is group or other.kind.support == "wall":
            continue
        (width, depth, height), (w, d, h) = sizes[other.key], sizes[group.key]
        number = ceil(group.count / other.count)
        wide, deep = (number * (w + 0.03) + 0.04, d + 0.05)
        if other.thing.width is None and other.thing.depth is None:
            width, depth = min(max(width, wide), _MOST_GROWN * width), min(max(depth, deep), _MOST_GROWN * depth)
            sizes[other.key] = round(width, 3), round(depth, 3), height
        factor = min(1.0, (width - 0.02 - 0.01 * number) / (number * w), (depth - 0.02) / d)
        tall = min(1.0, 0.9 * height / h)
        if (factor < 1.0 or tall < 1.0) and group.thing.width is None and group.thing.height is None:
            sizes[group.key] = round(w * factor, 3), round(d * factor, 3), round(h * min(tall, factor), 3)


def _fit_beneath(made: Furnishing, group: Group, sizes: dict[str, Size]) -> None:
    """Make what is said to be under a thing small enough for the space beneath it."""
    for relation in group.relations:
        other = made.find(relation.objects[0]) if relation.name in ("under", "below") and relation.objects else None
        if other is None or not other.kind.under or group.kind.is_rug or group.thing.height is not None:
            continue
        (width, depth, height), (w, d, h) = sizes[group.key], sizes[other.key]
        factor = min(1.0, 0.98 * other.kind.under * h / height)
        if width > w and depth > d and group.thing.width is None and group.thing.depth is None:
            width, depth = 0.9 * w, 0.9 * d
        sizes[group.key] = round(width, 3), round(depth, 3), round(height * factor, 3)


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
    long, short = _formed_sides(groups)
    if max(width, depth) < long:
        width, depth = (long, depth) if width > depth else (width, long)
    if min(width, depth) < short:
        width, depth = max(width, short), max(depth, short)
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


def _formed_sides(groups: Sequence[tuple[Group, Size]]) -> tuple[float, float]:
    """The longer and the shorter side of the floor, metres, that rows, grids and circles need at least."""
    long = short = 0.0
    for group, (width, depth, _) in groups:
        form = group.thing.arrangement
        if form is None or group.kind.support != "floor":
            continue
        gap = form.gap if form.gap is not None else 0.1 if group.kind.seats == 1 else 0.62
        rows = 1 if form.form == "row" else form.rows or max(2, round(sqrt(group.count / 1.5)))
        columns = form.columns or ceil(group.count / rows)
        rows = ceil(group.count / columns)
        if form.form == "circle":
            away = max((r.distance or 0.0 for r in group.relations if r.objects), default=0.0)
            sides = [max(group.count * (width + 0.1) / pi + 2 * depth + 1.0, 2 * (away + depth) + 1.4)] * 2
        else:
            sides = [columns * (width + gap) + 0.4, rows * (depth + 0.7) + (1.0 if rows > 1 else 0.5)]
        long, short = max(long, *sides), max(short, min(sides))
    return long, short


def _floor_needed(groups: Sequence[tuple[Group, Size]]) -> float:
    """Square metres of floor that things need, with the space that is kept free around them."""
    total = 1.2  # square metres before the door
    rings = _rings(groups)
    for group, (width, depth, height) in groups:
        if group.kind.support != "floor" or height < 0.05:
            continue
        if group.key in rings:
            total += rings[group.key]
            continue
        before, behind, left, right = group.kind.clear
        passage = _PASSAGE / 2 if group.kind.seats == 1 else _PASSAGE
        total += group.count * (width + left + right + passage) * (depth + before + behind + passage)
    return total / _FLOOR_SHARE


def _rings(groups: Sequence[tuple[Group, Size]]) -> dict[str, float]:
    """Square metres, with passages, of round tables with seats all around them, by key; 0 for the seats' own keys."""
    sizes = {g.key: (g, s) for g, s in groups}
    found: dict[str, float] = {}
    for group, (_, depth, _) in groups:
        for relation in group.relations:
            if relation.name != "around" or not relation.objects or relation.objects[0] not in sizes:
                continue
            table, size = sizes[relation.objects[0]]
            if table.kind.round and group.count > _MOST_AT_ROUND * table.count:
                across = 1.2 * size[0] + 0.24 + 2 * depth + _PASSAGE
                found |= {group.key: 0.0, table.key: _RING_SHARE * table.count * across**2}
    return found


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
