"""Costs of positions: broken wishes, blocked use zones, fronts close to walls, crowding. The unit is about a metre.

Which positions are free is computed in candidate_positions.py.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...gaussians.world.box import YawBox, to_world
from ...gaussians.world.person import HUNG_AT, STEP
from ...gaussians.world.support import SHELL
from .bodies import Body, Member
from .candidate_surfaces import FLOOR, extents_of
from .lattice import F64, Lattice, overlap_windows
from .measures import WALLS, behind_gap, measure, walls_gaps
from .state import BLOCKED_USE, BROKEN_HARD, BROKEN_SOFT, MAX_BACK_GAP, NOT_AT_WALL, State, placed

_MOVED, _TURNED = 3.0, 1.0  # cost of a metre away from the old position, and metres that count like a quarter turn
_CROWDED = 0.3  # covered share of a top above which things are put close together
_FREE = 0.55  # metres; a larger thing that does not belong at a wall gets space around it


class Positions(NamedTuple):
    """Positions of a body's first thing: world x and y `[M]`, one yaw, one underside height, and costs `[M]`."""

    body: Body
    x: F64
    y: F64
    yaw: float
    low: float
    cost: F64


def at_positions(state: State, member: Member, place: Positions) -> YawBox:
    x, y = to_world(place.x, place.y, place.yaw, member.x, member.y)
    w, d, h = state.prepared.items[member.item].size
    return YawBox(x, y, place.low, w, d, h, place.yaw + member.yaw)


def in_frame(spot: YawBox, frame: YawBox) -> YawBox:
    if frame is FLOOR:
        return spot
    u, v = frame.local(spot.x, spot.y)
    return spot._replace(x=u, y=v, yaw=spot.yaw - frame.yaw)


def add_crowding_cost(state: State, body: Body, lattice: Lattice, solids: list[tuple[int, YawBox]], cost: F64) -> None:
    """Add the cost of standing close to unrelated things; rugs also avoid other rugs and the floor under things."""
    item, related = state.prepared.items[body.first], state.prepared.related
    if item.support not in SHELL:
        return
    x0, x1, y0, y1 = extents_of(state, body, lattice.yaw)
    others = [s for j, s in solids if not any((m.item, j) in related for m in body.members)]
    box = YawBox((x0 + x1) / 2, (y0 + y1) / 2, 0.06, x1 - x0, y1 - y0, item.size[2] - 0.06)
    if item.support == "wall":
        low = item.height if item.height is not None else HUNG_AT - item.size[2] / 2
        levels = [(0.3, 1.0, others, box._replace(low=low, h=item.size[2]))]
    elif item.support == "ceiling":
        levels = [(0.6, 1.0, others, box._replace(low=state.size[2] - item.size[2], h=item.size[2]))]
    elif item.size[2] <= STEP:
        rugs = [
            s._replace(h=0.1 - s.low) for j, s in enumerate(state.spots) if s and state.is_flat(j) and j != body.first
        ]
        levels = [(0.0, 5.0, [*others, *rugs], box._replace(low=0.0, h=0.2))]
    elif state.prepared.wants_wall(body.first) or max(item.size[:2]) < _FREE:
        levels = [(0.3, 0.5, others, box)]
    else:
        levels = [(0.5, 2.0, others, box), (1.0, 1.0, others, box)]
        walls = np.minimum(
            np.minimum(lattice.xs + x0, -lattice.xs - x1)[:, None] + state.size[0] / 2,
            np.minimum(lattice.ys + y0, -lattice.ys - y1)[None, :] + state.size[1] / 2,
        )
        cost += 2.0 * (walls < 0.5)
    for margin, each, those, own in levels:
        wide = own._replace(w=own.w + 2 * margin, d=own.d + 2 * margin)
        for window, meets in overlap_windows(lattice, wide, those):
            cost[window] += each * np.asarray(meets)


def use_cost(
    state: State, lattice: Lattice, member: Member, moving: YawBox, solids: list[tuple[int, YawBox]], frame: YawBox
) -> F64:
    """The cost of standing in another thing's use zone, or of having a blocked use zone."""
    cost = np.zeros((len(lattice.xs), len(lattice.ys)))
    prepared, i = state.prepared, member.item
    for zone in prepared.zones_of[i]:
        room = placed(zone, moving)
        others = [s for j, s in solids if not prepared.may_enter(i, zone, j) and i not in prepared.carriers[j]]
        for window, meets in overlap_windows(lattice, room, others):
            cost[window] = np.maximum(cost[window], BLOCKED_USE * np.asarray(meets))
        if frame is FLOOR:
            here = room._replace(x=lattice.xs[:, None] + room.x, y=lattice.ys[None, :] + room.y)
            left, right, front, back = walls_gaps(here, state.size)
            short = np.minimum(np.minimum(left, right), np.minimum(front, back))
            cost += BLOCKED_USE * (short < -0.05)
    if not state.is_flat(i):
        zones = [
            in_frame(z, frame)
            for j, zs in enumerate(state.zones)
            if zs and j not in prepared.carriers[i]
            for local, z in zip(prepared.zones_of[j], zs, strict=False)
            if not prepared.may_enter(j, local, i)
        ]
        for window, meets in overlap_windows(lattice, moving, zones):
            cost[window] += BLOCKED_USE * np.asarray(meets)
    return cost


def wish_cost(state: State, body: Body, place: Positions) -> F64:
    """The cost of the wishes about the body's things and about the things they will carry."""
    prepared = state.prepared
    moving = {m.item: at_positions(state, m, place) for m in body.members}
    total = np.zeros(len(place.cost))
    for row in sorted({r for i in moving for r in prepared.wishes_of[i]}):
        wish, parts = prepared.problem.wishes[row], prepared.participants[row]
        spots, proxied = [], False
        for p in parts:
            at = next((k for k in (p, *prepared.carriers[p]) if k in moving or state.spots[k] is not None), None)
            spots.append(None if at is None else moving.get(at) or state.spots[at])
            proxied |= at != p
        if len({id(s) for s in spots}) < len(spots) or any(s is None for s in spots):
            continue
        if proxied and wish.name in ("on", "inside", "above", "below", "under"):
            continue
        if wish.name in ("on", "inside") and parts[1] in prepared.carriers[parts[0]]:
            continue
        one, *others = (s for s in spots if s is not None)
        kept, cost = measure(wish.name, state.size, one, others, state.windows, wish.wall, wish.distance)
        missed = (BROKEN_HARD if wish.hard else BROKEN_SOFT) * (0.3 if proxied else 1.0)
        total += np.where(kept, 0.0, missed) + (2.0 if wish.hard else 1.5) * np.minimum(cost, 10.0)
    return total


def habit_cost(state: State, body: Body, place: Positions) -> F64:
    """The cost of unusual positions: a front close to a wall, a back away from it, a free thing far from all walls."""
    prepared, item = state.prepared, state.prepared.items[body.first]
    here = at_positions(state, body.members[0], place)
    total = np.zeros(len(place.cost))
    if prepared.problem.open:
        total += sum(
            state.view_cost(m.item) * np.asarray(state.blocks_view(m.item, at_positions(state, m, place)))
            for m in body.members
        )
    if item.was is not None:
        turned = abs((place.yaw - item.was.yaw + 180.0) % 360.0 - 180.0) / 90.0
        away = np.hypot(place.x - item.was.position[0], place.y - item.was.position[1])
        total += _MOVED * (away + _TURNED * turned)
    if item.support == "wall":
        usual = item.height if item.height is not None else max(HUNG_AT - item.size[2] / 2, 0.0)
        aside = np.minimum(np.abs(here.x), np.abs(here.y))
        return total + 3.0 * abs(place.low - usual) + 0.3 * aside
    if item.support != "floor":
        if item.support == "ceiling":
            return total + 0.3 * np.hypot(here.x, here.y)
        return total + _on_top_cost(state, body.first, here)
    fx, fy = here.front
    ahead = np.minimum(
        np.inf if abs(fx) < 1e-6 else (state.size[0] / 2 - np.sign(fx) * here.x) / abs(fx),
        np.inf if abs(fy) < 1e-6 else (state.size[1] / 2 - np.sign(fy) * here.y) / abs(fy),
    )
    total += 2.0 * np.maximum(1.2 - (ahead - here.d / 2), 0.0)
    if prepared.wants_wall(body.first):
        gap = np.abs(np.minimum(behind_gap(here, state.size), 3.0) - item.aisle)
        total += np.where(gap > MAX_BACK_GAP, NOT_AT_WALL + 4.0 * gap, 0.0)
    elif item.size[2] <= STEP:
        total += 0.3 * np.hypot(here.x, here.y)
    elif len(body.members) == 1 and not prepared.wishes_of[body.first] and item.was is None:
        gaps = zip(WALLS, walls_gaps(here, state.size), strict=True)
        total += 1.2 * np.min([g for wall, g in gaps if wall not in prepared.problem.open], axis=0, initial=1e3)
    return total


def _on_top_cost(state: State, i: int, here: YawBox) -> F64:
    """The cost of positions on a carrier: best at its yaw, near its middle and to the back; if crowded, in a corner."""
    above = state.prepared.carriers[i][0]
    carrier = state.spots[above]
    assert carrier is not None  # the positions are on it
    u, v = carrier.local(here.x, here.y)
    same = abs((here.yaw - carrier.yaw + 180.0) % 360.0 - 180.0) < 1.0
    taken = sum(
        j.size[0] * j.size[1]
        for j, c in zip(state.prepared.items, state.prepared.carriers, strict=True)
        if c[:1] == (above,)
    )
    off: F64 = np.hypot(u, v - 0.15 * carrier.d)
    if taken > _CROWDED * carrier.w * carrier.d:
        hx, hy = here._replace(yaw=here.yaw - carrier.yaw).half
        off = (u - hx + carrier.w / 2) + (carrier.d / 2 - v - hy)
    return off + (0.0 if same else 0.7)
