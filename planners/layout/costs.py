"""What a position costs: wishes not kept, room for use taken, a wall stared at, things crowded.

Knows prices, in about metres off. Refuses to know which positions are free and which is taken.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...gaussians.world.box import YawBox, to_world
from ...gaussians.world.person import HUNG_AT, STEP
from ...gaussians.world.support import SHELL
from .bodies import Body, Member
from .candidate_surfaces import FLOOR, extents_of
from .lattice import F64, Lattice, meetings
from .measures import WALLS, behind_gap, measure, walls_gaps
from .state import BACKED, HARD, SOFT, USED, WALLED, State, placed

_MOVED, _TURNED = 3.0, 1.0  # price of a metre away from where a thing was, and metres that a quarter turn is worth
_CROWDED = 0.3  # share of a top from which things are put close together
_FREE = 0.55  # metres; what is larger and wants no wall stands free, with room around it


class Place(NamedTuple):
    """Positions of a body's first thing, one price each: world x and y `[M]`, yaw, underside."""

    body: Body
    x: F64
    y: F64
    yaw: float
    low: float
    price: F64


def moved(state: State, member: Member, place: Place) -> YawBox:
    x, y = to_world(place.x, place.y, place.yaw, member.x, member.y)
    w, d, h = state.prepared.items[member.item].size
    return YawBox(x, y, place.low, w, d, h, place.yaw + member.yaw)


def in_frame(spot: YawBox, frame: YawBox) -> YawBox:
    if frame is FLOOR:
        return spot
    u, v = frame.local(spot.x, spot.y)
    return spot._replace(x=u, y=v, yaw=spot.yaw - frame.yaw)


def crowding(state: State, body: Body, lattice: Lattice, solids: list[tuple[int, YawBox]], price: F64) -> None:
    """Add the price of crowding what one has nothing to do with; rugs keep off rugs, and from under other things."""
    item, tied = state.prepared.items[body.first], state.prepared.tied
    if item.support not in SHELL:
        return
    x0, x1, y0, y1 = extents_of(state, body, lattice.yaw)
    others = [s for j, s in solids if not any((m.item, j) in tied for m in body.members)]
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
        price += 2.0 * (walls < 0.5)
    for margin, each, those, own in levels:
        wide = own._replace(w=own.w + 2 * margin, d=own.d + 2 * margin)
        for window, meets in meetings(lattice, wide, those):
            price[window] += each * np.asarray(meets)


def use(
    state: State,
    lattice: Lattice,
    member: Member,
    moving: YawBox,
    solids: list[tuple[int, YawBox]],
    frame: YawBox,
) -> F64:
    """The price of standing in the room that another needs for its use, or of having too little oneself."""
    price = np.zeros((len(lattice.xs), len(lattice.ys)))
    prepared, i = state.prepared, member.item
    for zone in prepared.zones_of[i]:
        room = placed(zone, moving)
        others = [s for j, s in solids if not prepared.may_enter(i, zone, j) and i not in prepared.carriers[j]]
        for window, meets in meetings(lattice, room, others):
            price[window] = np.maximum(price[window], USED * np.asarray(meets))
        if frame is FLOOR:
            here = room._replace(x=lattice.xs[:, None] + room.x, y=lattice.ys[None, :] + room.y)
            left, right, front, back = walls_gaps(here, state.size)
            short = np.minimum(np.minimum(left, right), np.minimum(front, back))
            price += USED * (short < -0.05)
    if not state.is_flat(i):
        zones = [
            in_frame(z, frame)
            for j, zs in enumerate(state.zones)
            if zs and j not in prepared.carriers[i]
            for local, z in zip(prepared.zones_of[j], zs, strict=False)
            if not prepared.may_enter(j, local, i)
        ]
        for window, meets in meetings(lattice, moving, zones):
            price[window] += USED * np.asarray(meets)
    return price


def wished(state: State, body: Body, place: Place) -> F64:
    """The price of the wishes that the body's things, and what they will carry, take part in."""
    prepared = state.prepared
    moving = {m.item: moved(state, m, place) for m in body.members}
    total = np.zeros(len(place.price))
    for row in sorted({r for i in moving for r in prepared.wishes_of[i]}):
        wish, parts = prepared.problem.wishes[row], prepared.parties[row]
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
        kept, cost = measure(wish.name, state.size, one, others, state.windows, wish.wall)
        missed = (HARD if wish.hard else SOFT) * (0.3 if proxied else 1.0)
        total += np.where(kept, 0.0, missed) + (2.0 if wish.hard else 1.5) * np.minimum(cost, 10.0)
    return total


def habits(state: State, body: Body, place: Place) -> F64:
    """The price of looking at a wall, of a back that is not at one, and of standing about in the middle."""
    prepared, item = state.prepared, state.prepared.items[body.first]
    here = moved(state, body.members[0], place)
    total = np.zeros(len(place.price))
    if prepared.problem.open:
        total += sum(
            state.exposure(m.item) * np.asarray(state.hides(m.item, moved(state, m, place))) for m in body.members
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
        return total + _upon(state, body.first, here)
    fx, fy = here.front
    ahead = np.minimum(
        np.inf if abs(fx) < 1e-6 else (state.size[0] / 2 - np.sign(fx) * here.x) / abs(fx),
        np.inf if abs(fy) < 1e-6 else (state.size[1] / 2 - np.sign(fy) * here.y) / abs(fy),
    )
    total += 2.0 * np.maximum(1.2 - (ahead - here.d / 2), 0.0)
    if prepared.wants_wall(body.first):
        gap = np.abs(np.minimum(behind_gap(here, state.size), 3.0) - item.aisle)
        total += np.where(gap > BACKED, WALLED + 4.0 * gap, 0.0)
    elif item.size[2] <= STEP:
        total += 0.3 * np.hypot(here.x, here.y)
    elif len(body.members) == 1 and not prepared.wishes_of[body.first] and item.was is None:
        gaps = zip(WALLS, walls_gaps(here, state.size), strict=True)
        total += 1.2 * np.min([g for wall, g in gaps if wall not in prepared.problem.open], axis=0, initial=1e3)
    return total


def _upon(state: State, i: int, here: YawBox) -> F64:
    """On a thing: turned as it is turned, near its middle and rather to the back; where it is crowded, in a corner."""
    above = state.prepared.carriers[i][0]
    carrier = state.spots[above]
    assert carrier is not None  # places were found on it
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
