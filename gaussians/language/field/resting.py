"""What groups rest on, measured from their boxes, and what that says about their kinds.

A rug lies on the floor, a mug stands on something, a painting hangs on a wall. Boxes of captures are rough, so the
evidence is weak on purpose: it decides between names that look alike and outweighs no clear picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...world import kinds
from .language_field import Group, LanguageField, Rest

F64 = NDArray[np.float64]
Span = tuple[float, float]

GROUNDED = (0.03, 0.12)  # of the room's height, and of its own: an underside lower than either stands on the floor
TOUCHING = 0.12  # of the smaller height: gap between an underside and the top that carries it
HANGING = 0.95  # of the room's height: what reaches higher and stands on nothing hangs from the ceiling
AT_WALL = 0.06  # of the room's height: gap between a thing and the wall it hangs on
# How often a thing of a kind that belongs there (row) is measured to rest there (column, in the order of PLACES).
# Things of the floor are seldom off it; small things are put anywhere.
PLACES: tuple[Rest, ...] = ("floor", "surface", "wall", "ceiling")
SHARES = {
    "floor": (0.80, 0.12, 0.05, 0.03),
    "surface": (0.25, 0.60, 0.10, 0.05),
    "wall": (0.25, 0.15, 0.50, 0.10),
    "ceiling": (0.06, 0.10, 0.14, 0.70),
}


def with_rests(field: LanguageField, up: F64, floor: float | None) -> tuple[Group, ...]:
    """The groups with what each object rests on; unchanged if the floor is unknown.

    Args:
        up: unit vector `[3]`.
        floor: height of the floor along `up`, scene units.
    """
    if floor is None or not field.groups:
        return field.groups
    span = [_heights(g, up) for g in field.groups]
    return tuple(_with_rest(g, field, up, floor, span) for g in field.groups)


def _with_rest(group: Group, field: LanguageField, up: F64, floor: float, span: Sequence[Span]) -> Group:
    rests = _rest(group, field, up, floor, span) if group.level == "object" and group.count else ""
    return replace(group, rests=rests)


def _rest(group: Group, field: LanguageField, up: F64, floor: float, span: Sequence[Span]) -> Rest:
    """What one object rests on, "" if nothing is near it.

    Args:
        span: lowest and highest coordinate along up of each group.
    """
    low, high = span[group.id]
    room = max((span[g.id][1] for g in field.groups if g.count), default=high) - floor
    if low - floor <= max(GROUNDED[0] * room, GROUNDED[1] * (high - low)):
        return "floor"
    middle = np.array(group.box.center)
    for other in field.objects():
        if other.id != group.id and other.count and _carries(other, span[other.id], low, high, middle):
            return "surface"
    if high - floor >= HANGING * room:
        return "ceiling"
    walls = (g for g in field.groups if g.label == "wall" and g.level == "structure")
    return "wall" if any(_gap(group, wall) <= AT_WALL * room for wall in walls) else ""


def _carries(lower: Group, span: Span, low: float, high: float, middle: F64) -> bool:
    """Whether the top of `lower` meets the underside of a thing whose middle is above its footprint."""
    bottom, top = span
    if abs(low - top) > TOUCHING * min(high - low, top - bottom) + 1e-9 or bottom >= low:
        return False
    axes = np.array(lower.box.axes)
    offset = axes @ (middle - np.array(lower.box.center))
    return bool((np.abs(offset[:2]) <= np.array(lower.box.size[:2]) / 2).all())


def _gap(group: Group, wall: Group) -> float:
    """Distance from a group's box to a wall's plane, negative where it reaches into it."""
    axes, size = np.array(wall.box.axes), np.array(wall.box.size)
    thin = int(np.argmin(size[:2]))
    normal = axes[thin]
    reach = float(np.abs(np.array(group.box.axes) @ normal) @ np.array(group.box.size)) / 2
    away = abs(float(normal @ (np.array(group.box.center) - np.array(wall.box.center))))
    return away - reach - float(size[thin]) / 2


def _heights(group: Group, up: F64) -> tuple[float, float]:
    """Lowest and highest coordinate of a group's box along up."""
    middle = float(np.array(group.box.center) @ up)
    reach = float(np.abs(np.array(group.box.axes) @ up) @ np.array(group.box.size)) / 2
    return middle - reach, middle + reach


def log_likelihoods(groups: Sequence[Group], names: Sequence[str]) -> F64:
    """Log-likelihood `[G, H]` of where each group rests under each name, nats; constant where it is unknown.

    Openings and what hangs to the floor, such as a curtain, say nothing; neither do names that are no kinds.
    """
    rows = [_shares(name) for name in names]
    known = np.array([row for row in rows if row is not None]).reshape(-1, len(PLACES))
    neutral = known.mean(axis=0) if len(known) else np.full(len(PLACES), 1 / len(PLACES))
    table = np.log(np.array([neutral if row is None else row for row in rows]))  # [H, 4]
    at = {place: i for i, place in enumerate(PLACES)}
    return np.stack([table[:, at[g.rests]] if g.rests in at else np.zeros(len(names)) for g in groups])


def _shares(name: str) -> tuple[float, ...] | None:
    kind = kinds.find(name)
    if kind is None or kind.opening or kind.name == "curtain":
        return None
    return SHARES[kind.support]
