"""The surfaces that a body may be put on (floor, walls, ceiling, tops of things) and the lattices of positions there.

Which of these positions are free and what they cost is computed in candidate_positions.py.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...gaussians.world.box import YawBox
from ...gaussians.world.person import HUNG_AT
from ...gaussians.world.support import SHELL
from .bodies import TABLE_GAP, Body
from .lattice import EPSILON, F64, TURNS, Lattice
from .state import State

FLOOR = YawBox(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)  # the frame of the floor
_CELLS = 80  # positions along the longer side of a room; the step is 5 cm or more
_FINE, _ON_TOP = 0.05, 0.025  # metres between positions on the floor, and at most on a thing
_MAX_REACHED_TOP = 1.5  # metres; a thing goes on top of a higher carrier only if it does not fit inside it
_MAX_OVERHANG = 1.5  # largest width of a thing relative to its carrier
_SMALL = 0.35  # metres; smaller things are tried at one yaw only


@dataclass(frozen=True, eq=False)
class Surface:
    """A surface for a body: the frame of its lattices, the height of the body's underside, and the lattices."""

    frame: YawBox
    low: float
    lattices: tuple[Lattice, ...]


def candidate_surfaces(state: State, body: Body, walls_only: bool) -> Iterator[Surface]:
    """The surfaces that a body may be put on, with lattices of positions.

    Args:
        walls_only: give positions along walls, and on things; otherwise all other positions.
    """
    prepared, item = state.prepared, state.prepared.items[body.first]
    height = item.size[2]
    width, deep, high = state.size
    if height > high + EPSILON:
        return
    if item.support not in SHELL:
        if walls_only:
            yield from _on_thing(state, body)
    elif item.support == "wall":
        for low in _hanging_heights(state, body.first) if walls_only else ():
            yield Surface(FLOOR, low, tuple(_along_walls(state, body)))
    elif item.support == "ceiling":
        if not walls_only:
            yield Surface(FLOOR, high - height, tuple(_in_rectangle(state, body, width, deep)))
    elif walls_only and prepared.wants_wall(body.first):
        yield Surface(FLOOR, 0.0, tuple(_along_walls(state, body)))
    elif not walls_only:
        yield Surface(FLOOR, 0.0, tuple(_in_rectangle(state, body, width, deep)))


def _hanging_heights(state: State, i: int) -> list[float]:
    """Heights of the underside to try for a thing that hangs on a wall, the usual one first."""
    item = state.prepared.items[i]
    most = state.size[2] - item.size[2]
    if item.height is not None:
        return [item.height] if item.height <= most + EPSILON else []
    usual = HUNG_AT - item.size[2] / 2
    above = [
        spot.high + 0.15
        for row in state.prepared.wishes_of[i]
        if state.prepared.problem.wishes[row].name == "above" and state.prepared.participants[row][0] == i
        if (spot := state.known_spot(state.prepared.participants[row][1])) is not None
    ]
    heights = [*(max(a, usual) for a in above), usual, usual + 0.3, usual + 0.6, usual - 0.4]
    return list(dict.fromkeys(round(min(max(h, 0.0), most), 4) for h in heights))


def _on_thing(state: State, body: Body) -> Iterator[Surface]:
    """Surfaces on top of the carrier, or inside it where a wish says so or the top is out of reach."""
    prepared, i = state.prepared, body.first
    item, carrier = prepared.items[i], state.spots[prepared.carriers[i][0]]
    if carrier is None:
        return
    inside = any(
        prepared.problem.wishes[r].name == "inside" and prepared.participants[r] == (i, prepared.carriers[i][0])
        for r in prepared.wishes_of[i]
    )
    tall = carrier.h
    within = [carrier.low + f * tall for f in (0.5, 0.25, 0.75)]
    lows = [carrier.high]
    if inside:
        lows = [carrier.low + min(0.02, 0.1 * tall)]
    elif carrier.high > _MAX_REACHED_TOP and tall > 1.0:
        lows = [*(low for low in within if low + item.size[2] <= carrier.high), carrier.high]
    for low in lows:
        if low + item.size[2] <= state.size[2] + EPSILON:
            yield Surface(carrier, low, tuple(_in_rectangle(state, body, carrier.w, carrier.d, carrier)))


def _in_rectangle(state: State, body: Body, width: float, deep: float, frame: YawBox = FLOOR) -> Iterator[Lattice]:
    """All positions within a rectangle, one lattice for each yaw of the body."""
    carried = frame is not FLOOR
    step = _ON_TOP if carried else max(_FINE, max(width, deep) / _CELLS)
    size = state.prepared.items[body.first].size
    was = state.prepared.items[body.first].was
    turns = TURNS if carried or max(size[:2]) > _SMALL or len(body.members) > 1 else TURNS[:1]
    for yaw in turns if was is None or carried else tuple(dict.fromkeys((*turns, was.yaw))):
        x0, x1, y0, y1 = extents_of(state, body, yaw)
        spans = []
        for low, high, side in ((x0, x1, width), (y0, y1, deep)):
            if high - low > side + EPSILON:
                if not carried or high - low > _MAX_OVERHANG * side:
                    break
                spans.append(np.array([-(low + high) / 2]))
            else:
                spans.append(_steps(-side / 2 - low, side / 2 - high, step))
        else:
            more = (
                _touching_on_top(state, body, frame, (x0, x1, y0, y1))
                if carried
                else _partner_lines(state, body, (x0, x1, y0, y1))
            )
            xs, ys = (_with_extra(span, extra) for span, extra in zip(spans, more, strict=True))
            yield Lattice(xs, ys, yaw)


def _along_walls(state: State, body: Body) -> Iterator[Lattice]:
    """Positions where the back of the body's first thing is at a wall."""
    width, deep, _ = state.size
    item = state.prepared.items[body.first]
    back = item.size[1] / 2 + (item.aisle if item.backed else 0.0)
    for yaw in TURNS:
        x0, x1, y0, y1 = extents_of(state, body, yaw)
        low, high = np.array([-width / 2 - x0, -deep / 2 - y0]), np.array([width / 2 - x1, deep / 2 - y1])
        if (high < low - EPSILON).any():
            continue
        across, along = _partner_lines(state, body, (x0, x1, y0, y1))
        step = max(_FINE, max(width, deep) / _CELLS)
        if yaw in (0.0, 180.0):
            y = deep / 2 - back if yaw == 0.0 else back - deep / 2
            if low[1] - EPSILON <= y <= high[1] + EPSILON:
                yield Lattice(_with_extra(_steps(low[0], high[0], step), across), np.array([y]), yaw)
        else:
            x = width / 2 - back if yaw == -90.0 else back - width / 2
            if low[0] - EPSILON <= x <= high[0] + EPSILON:
                yield Lattice(np.array([x]), _with_extra(_steps(low[1], high[1], step), along), yaw)


def extents_of(state: State, body: Body, yaw: float) -> tuple[float, float, float, float]:
    """Extents of a body from its first thing's middle, metres: (x minimum, x maximum, y minimum, y maximum)."""
    boxes = [state.spot(m, 0.0, 0.0, yaw, 0.0) for m in body.members]
    halves = [b.half for b in boxes]
    return (
        min(b.x - h[0] for b, h in zip(boxes, halves, strict=True)),
        max(b.x + h[0] for b, h in zip(boxes, halves, strict=True)),
        min(b.y - h[1] for b, h in zip(boxes, halves, strict=True)),
        max(b.y + h[1] for b, h in zip(boxes, halves, strict=True)),
    )


def _steps(low: float, high: float, step: float) -> F64:
    """Coordinates from low to high about `step` apart, with both ends and the middle."""
    if high - low <= EPSILON:
        return np.array([(low + high) / 2])
    return np.linspace(low, high, 2 * max(int(np.ceil((high - low) / step / 2)), 1) + 1)


def _with_extra(steps: F64, extra: Any) -> F64:
    """The steps, with those of the `extra` positions that lie within their range."""
    more = [e for e in extra if steps[0] <= e <= steps[-1]]
    return np.unique(np.concatenate([steps, more])) if more and len(steps) > 1 else steps


def _touching_on_top(
    state: State, body: Body, carrier: YawBox, extents: tuple[float, float, float, float]
) -> tuple[list[float], list[float]]:
    """Coordinates on a carrier at which a body touches the things that stand there already."""
    xs, ys = list[float](), list[float]()
    above = state.prepared.carriers[body.first][0]
    for spot, chain in zip(state.spots, state.prepared.carriers, strict=True):
        if spot is not None and chain[:1] == (above,):
            u, v = carrier.local(spot.x, spot.y)
            hx, hy = spot._replace(yaw=spot.yaw - carrier.yaw).half
            xs += [u - hx - extents[1], u + hx - extents[0]]
            ys += [v - hy - extents[3], v + hy - extents[2]]
    return xs, ys


def _partner_lines(
    state: State, body: Body, extents: tuple[float, float, float, float]
) -> tuple[list[float], list[float]]:
    """Coordinates at which a body is in line with or touches its wishes' partners, and its present ones."""
    xs, ys = list[float](), list[float]()
    if (now := state.spots[body.first]) is not None:
        xs, ys = [float(now.x)], [float(now.y)]
    if (was := state.prepared.items[body.first].was) is not None:
        xs, ys = [*xs, was.position[0]], [*ys, was.position[1]]
    partners = {
        p for m in body.members for r in state.prepared.wishes_of[m.item] for p in state.prepared.participants[r]
    }
    for p in sorted(partners - {m.item for m in body.members}):
        if (spot := state.known_spot(p)) is not None:
            hx, hy = spot.half
            xs += [spot.x, spot.x - hx - extents[1] - TABLE_GAP, spot.x + hx - extents[0] + TABLE_GAP]
            ys += [spot.y, spot.y - hy - extents[3] - TABLE_GAP, spot.y + hy - extents[2] + TABLE_GAP]
    return xs, ys
