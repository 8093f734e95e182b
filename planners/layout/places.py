"""Where a body may stand, and what each place costs: all positions of a fine lattice at once.

Knows lattices, obstacles and prices. Refuses to know in which order things are placed.
The frame is the floor's, or that of the thing that carries the body.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..graph import SHELL
from .bodies import FLAT, HEAD, TUCKED, Body, Member
from .measures import VIEWED, behind_gap, measure, walls_gaps
from .shapes import EPSILON, F64, TURNS, Flags, Lattice, Spot, blocked, in_disc, meetings, shifted
from .state import HARD, SOFT, USED, WALLED, State, placed

_FLOOR = Spot(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
_CELLS = 80  # positions along the longer side of a room; the step is 5 cm or more
_FINE, _ON_TOP = 0.05, 0.025  # metres between positions on the floor, and at most on a thing
_EYE = 1.5  # metres from the floor to the middle of what hangs on a wall
_HIGH = 1.5  # metres; nothing is put on top of what is higher, if it can stand within it
_WIDER = 1.5  # times as wide as its carrier a thing may be
_SMALL = 0.35  # metres; it does not matter how smaller things are turned
_MOVED, _TURNED = 1.5, 0.5  # price of a metre away from where a thing was, and metres that a quarter turn is worth
_FREE = 0.55  # metres; what is larger and wants no wall stands free, with room around it


class Place(NamedTuple):
    """Positions of a body's first thing, one price each: world x and y `[M]`, yaw, underside."""

    body: Body
    x: F64
    y: F64
    yaw: float
    low: float
    price: F64


@dataclass(frozen=True, eq=False)
class Ground:
    """What a body is put on: the frame of its lattice, its extents there, the height, and whether at walls only."""

    frame: Spot
    low: float
    lattices: tuple[Lattice, ...]


def places(state: State, body: Body, rng: np.random.Generator, noise: float) -> list[Place]:
    """Every place where a body fits, with its price; what wants a wall is tried there first."""
    found: list[Place] = []
    for walls_only in (True, False):
        for ground in _grounds(state, body, walls_only):
            for lattice in ground.lattices:
                place = _priced(state, seated(state, body, lattice.yaw), ground, lattice)
                if place is not None:
                    found.append(place)
        if any(len(p.price) and p.price.min() < SOFT for p in found):
            break
    if noise:
        found = [p._replace(price=p.price + rng.normal(0.0, noise, len(p.price))) for p in found]
    return found


def _grounds(state: State, body: Body, walls_only: bool) -> Iterator[Ground]:
    """What a body may be put on, with the lattices of positions there."""
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
            yield Ground(_FLOOR, low, tuple(_along_walls(state, body)))
    elif item.support == "ceiling":
        if not walls_only:
            yield Ground(_FLOOR, high - height, tuple(_anywhere(state, body, width, deep)))
    elif walls_only and prepared.wants_wall(body.first):
        yield Ground(_FLOOR, 0.0, tuple(_along_walls(state, body)))
    elif not walls_only:
        yield Ground(_FLOOR, 0.0, tuple(_anywhere(state, body, width, deep)))


def _hanging_heights(state: State, i: int) -> list[float]:
    """Undersides to try for what hangs on a wall, the usual one first."""
    item = state.prepared.items[i]
    most = state.size[2] - item.size[2]
    if item.height is not None:
        return [item.height] if item.height <= most + EPSILON else []
    usual = _EYE - item.size[2] / 2
    above = [
        spot.high + 0.15
        for row in state.prepared.wishes_of[i]
        if state.prepared.problem.wishes[row].name == "above" and state.prepared.parties[row][0] == i
        if (spot := state.seen(state.prepared.parties[row][1])) is not None
    ]
    heights = [*(max(a, usual) for a in above), usual, usual + 0.3, usual + 0.6, usual - 0.4]
    return list(dict.fromkeys(round(min(max(h, 0.0), most), 4) for h in heights))


def _on_thing(state: State, body: Body) -> Iterator[Ground]:
    """On top of the thing that carries it, or within it where that is asked for or the top is out of reach."""
    prepared, i = state.prepared, body.first
    item, carrier = prepared.items[i], state.spots[prepared.carriers[i][0]]
    if carrier is None:
        return
    inside = any(
        prepared.problem.wishes[r].name == "inside" and prepared.parties[r] == (i, prepared.carriers[i][0])
        for r in prepared.wishes_of[i]
    )
    tall = carrier.high - carrier.low
    within = [carrier.low + f * tall for f in (0.5, 0.25, 0.75)]
    lows = [carrier.high]
    if inside:
        lows = [carrier.low + min(0.02, 0.1 * tall)]
    elif carrier.high > _HIGH and tall > 1.0:
        lows = [*(low for low in within if low + item.size[2] <= carrier.high), carrier.high]
    for low in lows:
        if low + item.size[2] <= state.size[2] + EPSILON:
            yield Ground(carrier, low, tuple(_anywhere(state, body, carrier.w, carrier.d, carrier)))


def _anywhere(state: State, body: Body, width: float, deep: float, frame: Spot = _FLOOR) -> Iterator[Lattice]:
    """All positions within a rectangle, for every way to turn the body."""
    carried = frame is not _FLOOR
    step = _ON_TOP if carried else max(_FINE, max(width, deep) / _CELLS)
    size = state.prepared.items[body.first].size
    for yaw in TURNS if carried or max(size[:2]) > _SMALL or len(body.members) > 1 else TURNS[:1]:
        x0, x1, y0, y1 = _extents(state, body, yaw)
        spans = []
        for low, high, side in ((x0, x1, width), (y0, y1, deep)):
            if high - low > side + EPSILON:
                if not carried or high - low > _WIDER * side:
                    break
                spans.append(np.array([-(low + high) / 2]))
            else:
                spans.append(_steps(-side / 2 - low, side / 2 - high, step))
        else:
            more = ((), ()) if carried else _beside(state, body, (x0, x1, y0, y1))
            xs, ys = (_joined(span, extra) for span, extra in zip(spans, more, strict=True))
            yield Lattice(xs, ys, yaw)


def _along_walls(state: State, body: Body) -> Iterator[Lattice]:
    """Positions with the back of the first thing at a wall."""
    width, deep, _ = state.size
    back = state.prepared.items[body.first].size[1] / 2
    for yaw in TURNS:
        x0, x1, y0, y1 = _extents(state, body, yaw)
        low, high = np.array([-width / 2 - x0, -deep / 2 - y0]), np.array([width / 2 - x1, deep / 2 - y1])
        if (high < low - EPSILON).any():
            continue
        across, along = _beside(state, body, (x0, x1, y0, y1))
        step = max(_FINE, max(width, deep) / _CELLS)
        if yaw in (0.0, 180.0):
            y = deep / 2 - back if yaw == 0.0 else back - deep / 2
            if low[1] - EPSILON <= y <= high[1] + EPSILON:
                yield Lattice(_joined(_steps(low[0], high[0], step), across), np.array([y]), yaw)
        else:
            x = width / 2 - back if yaw == -90.0 else back - width / 2
            if low[0] - EPSILON <= x <= high[0] + EPSILON:
                yield Lattice(np.array([x]), _joined(_steps(low[1], high[1], step), along), yaw)


def _extents(state: State, body: Body, yaw: float) -> tuple[float, float, float, float]:
    """How far a body reaches from its first thing's middle: left, right, front and back."""
    boxes = [state.spot(m, 0.0, 0.0, yaw, 0.0) for m in body.members]
    halves = [b.half for b in boxes]
    return (
        min(b.x - h[0] for b, h in zip(boxes, halves, strict=True)),
        max(b.x + h[0] for b, h in zip(boxes, halves, strict=True)),
        min(b.y - h[1] for b, h in zip(boxes, halves, strict=True)),
        max(b.y + h[1] for b, h in zip(boxes, halves, strict=True)),
    )


def _steps(low: float, high: float, step: float) -> F64:
    """From low to high about `step` apart, both ends included, and the middle between them."""
    if high - low <= EPSILON:
        return np.array([(low + high) / 2])
    return np.linspace(low, high, 2 * max(int(np.ceil((high - low) / step / 2)), 1) + 1)


def _joined(steps: F64, extra: Any) -> F64:
    """The steps, and the further positions that lie between them."""
    more = [e for e in extra if steps[0] <= e <= steps[-1]]
    return np.unique(np.concatenate([steps, more])) if more and len(steps) > 1 else steps


def _beside(state: State, body: Body, extents: tuple[float, float, float, float]) -> tuple[list[float], list[float]]:
    """Coordinates at which a body is in line with, or touches, what it has to do with; and where it stands now."""
    xs, ys = list[float](), list[float]()
    if (now := state.spots[body.first]) is not None:
        xs, ys = [float(now.x)], [float(now.y)]
    if (was := state.prepared.items[body.first].was) is not None:
        xs, ys = [*xs, was.position[0]], [*ys, was.position[1]]
    partners = {p for m in body.members for r in state.prepared.wishes_of[m.item] for p in state.prepared.parties[r]}
    for p in sorted(partners - {m.item for m in body.members}):
        if (spot := state.seen(p)) is not None:
            hx, hy = spot.half
            xs += [spot.x, spot.x - hx - extents[1] - TUCKED, spot.x + hx - extents[0] + TUCKED]
            ys += [spot.y, spot.y - hy - extents[3] - TUCKED, spot.y + hy - extents[2] + TUCKED]
    return xs, ys


def _priced(state: State, body: Body, ground: Ground, lattice: Lattice) -> Place | None:
    """The free positions of a lattice with their prices; None where there are none."""
    prepared, frame = state.prepared, ground.frame
    own = {m.item for m in body.members}
    shape = (len(lattice.xs), len(lattice.ys))
    taken, price = np.zeros(shape, bool), np.zeros(shape)
    exempt = own | {c for i in own for c in prepared.carriers[i]}
    solids = [(i, _in_frame(s, frame)) for i, s in state.solids(exempt)]
    _breathe(state, body, lattice, solids, price)
    for member in body.members:
        moving = state.spot(member, 0.0, 0.0, lattice.yaw, ground.low)
        if not state.is_flat(member.item):
            blocked(lattice, moving, [s for _, s in solids], taken)
            _out_of_discs(state, lattice, moving, frame, taken)
        if taken.all():
            return None
        _use(state, lattice, member, moving, solids, frame, price)
    free = np.argwhere(~taken)
    x, y = shifted(frame.x, frame.y, frame.yaw, lattice.xs[free[:, 0]], lattice.ys[free[:, 1]])
    place = Place(body, x, y, lattice.yaw + frame.yaw, ground.low, price[free[:, 0], free[:, 1]])
    place = _within_room(state, body, place) if frame is not _FLOOR else place
    if not len(place.price):
        return None
    return place._replace(price=place.price + _wished(state, body, place) + _habits(state, body, place))


def _breathe(state: State, body: Body, lattice: Lattice, solids: list[tuple[int, Spot]], price: F64) -> None:
    """Add the price of crowding what one has nothing to do with; rugs keep off rugs, and from under other things."""
    item, tied = state.prepared.items[body.first], state.prepared.tied
    if item.support not in ("floor", "wall"):
        return
    x0, x1, y0, y1 = _extents(state, body, lattice.yaw)
    others = [s for j, s in solids if not any((m.item, j) in tied for m in body.members)]
    box = Spot((x0 + x1) / 2, (y0 + y1) / 2, 0.0, x1 - x0, y1 - y0, 0.06, item.size[2])
    if item.support == "wall":
        low = item.height if item.height is not None else _EYE - item.size[2] / 2
        levels = [(0.3, 1.0, others, box._replace(low=low, high=low + item.size[2]))]
    elif item.size[2] <= FLAT:
        rugs = [s._replace(high=0.1) for j, s in enumerate(state.spots) if s and state.is_flat(j) and j != body.first]
        levels = [(0.0, 5.0, [*others, *rugs], box._replace(low=0.0, high=0.2))]
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


def seated(state: State, body: Body, yaw: float) -> Body:
    """The body with its like members in those seats in which most of what is wished among them holds at this yaw."""
    rows = [
        r
        for r in dict.fromkeys(r for m in body.members for r in state.prepared.wishes_of[m.item])
        if state.prepared.problem.wishes[r].name in VIEWED
        and set(state.prepared.parties[r]) <= {m.item for m in body.members}
    ]
    if not rows:
        return body
    members, kept = body.members, _held(state, body.members, rows, yaw)
    for i in range(1, len(members)):
        for j in range(i + 1, len(members)):
            trial = state.prepared.exchanged(members, i, j)
            if trial is not None and (now := _held(state, trial, rows, yaw)) > kept:
                members, kept = trial, now
    return Body(members)


def _held(state: State, members: tuple[Member, ...], rows: list[int], yaw: float) -> int:
    spots = {m.item: state.spot(m, 0.0, 0.0, yaw, 0.0) for m in members}
    wishes = state.prepared.problem.wishes
    return sum(
        bool(measure(wishes[r].name, state.size, *_split([spots[p] for p in state.prepared.parties[r]]), [])[0])
        for r in rows
    )


def _split(spots: list[Spot]) -> tuple[Spot, list[Spot]]:
    return spots[0], spots[1:]


def _in_frame(spot: Spot, frame: Spot) -> Spot:
    if frame is _FLOOR:
        return spot
    u, v = frame.local(spot.x, spot.y)
    return spot._replace(x=u, y=v, yaw=spot.yaw - frame.yaw)


def _within_room(state: State, body: Body, place: Place) -> Place:
    """Only places at which all of the body is in the room."""
    kept = np.ones(len(place.price), bool)
    for member in body.members:
        spot = _moved(state, member, place)
        kept &= np.min(walls_gaps(spot, state.size), axis=0) >= -EPSILON
    return place._replace(x=place.x[kept], y=place.y[kept], price=place.price[kept])


def _moved(state: State, member: Member, place: Place) -> Spot:
    x, y = shifted(place.x, place.y, place.yaw, member.x, member.y)
    w, d, h = state.prepared.items[member.item].size
    return Spot(x, y, place.yaw + member.yaw, w, d, place.low, place.low + h)


def _out_of_discs(state: State, lattice: Lattice, moving: Spot, frame: Spot, taken: Flags) -> None:
    if moving.low >= HEAD or moving.high <= FLAT:
        return
    for disc in state.discs:
        if disc is not None:
            x, y = frame.local(disc[0], disc[1])
            taken |= in_disc(lattice, moving, float(x), float(y), disc[2])


def _use(
    state: State,
    lattice: Lattice,
    member: Member,
    moving: Spot,
    solids: list[tuple[int, Spot]],
    frame: Spot,
    price: F64,
) -> None:
    """Add the price of standing in the room that another needs for its use, or of having too little oneself."""
    prepared, i = state.prepared, member.item
    for zone in prepared.zones(i):
        room = placed(zone, moving)
        others = [s for j, s in solids if (i, j) not in prepared.tied and i not in prepared.carriers[j]]
        for window, meets in meetings(lattice, room, others):
            price[window] = np.maximum(price[window], USED * np.asarray(meets))
        if frame is _FLOOR:
            here = room._replace(x=lattice.xs[:, None] + room.x, y=lattice.ys[None, :] + room.y)
            left, right, front, back = walls_gaps(here, state.size)
            short = np.minimum(np.minimum(left, right), np.minimum(front, back))
            price += USED * (short < -0.05)
    if not state.is_flat(i):
        zones = [
            _in_frame(z, frame)
            for j, zs in enumerate(state.zones)
            if zs and (i, j) not in prepared.tied and j not in prepared.carriers[i]
            for z in zs
        ]
        for window, meets in meetings(lattice, moving, zones):
            price[window] += USED * np.asarray(meets)


def _wished(state: State, body: Body, place: Place) -> F64:
    """The price of the wishes that the body's things, and what they will carry, take part in."""
    prepared = state.prepared
    moving = {m.item: _moved(state, m, place) for m in body.members}
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
        kept, cost = measure(wish.name, state.size, one, others, state.windows)
        missed = (HARD if wish.hard else SOFT) * (0.3 if proxied else 1.0)
        total += np.where(kept, 0.0, missed) + (2.0 if wish.hard else 1.5) * np.minimum(cost, 10.0)
    return total


def _habits(state: State, body: Body, place: Place) -> F64:
    """The price of looking at a wall, of a back that is not at one, and of standing about in the middle."""
    prepared, item = state.prepared, state.prepared.items[body.first]
    here = _moved(state, body.members[0], place)
    total = np.zeros(len(place.price))
    if item.was is not None:
        turned = abs((place.yaw - item.was.yaw + 180.0) % 360.0 - 180.0) / 90.0
        away = np.hypot(place.x - item.was.position[0], place.y - item.was.position[1])
        total += _MOVED * (away + _TURNED * turned)
    if item.support == "wall":
        usual = item.height if item.height is not None else max(_EYE - item.size[2] / 2, 0.0)
        aside = np.minimum(np.abs(here.x), np.abs(here.y))
        return total + 3.0 * abs(place.low - usual) + 0.3 * aside
    if item.support != "floor":
        carrier = state.seen(prepared.carriers[body.first][0]) if prepared.carriers[body.first] else None
        return total if carrier is None else total + _upon(here, carrier)
    fx, fy = here.front
    ahead = np.minimum(
        np.inf if abs(fx) < 1e-6 else (state.size[0] / 2 - np.sign(fx) * here.x) / abs(fx),
        np.inf if abs(fy) < 1e-6 else (state.size[1] / 2 - np.sign(fy) * here.y) / abs(fy),
    )
    total += 2.0 * np.maximum(1.2 - (ahead - here.d / 2), 0.0)
    if prepared.wants_wall(body.first):
        gap = np.minimum(behind_gap(here, state.size), 3.0)
        total += np.where(gap > 0.02, WALLED + 4.0 * gap, 0.0)
    elif len(body.members) == 1 and not prepared.wishes_of[body.first] and item.was is None:
        total += 1.2 * np.min(walls_gaps(here, state.size), axis=0)
    return total


def _upon(here: Spot, carrier: Spot) -> F64:
    """On a thing: turned as it is turned, near its middle, rather to the back."""
    u, v = carrier.local(here.x, here.y)
    same = abs((here.yaw - carrier.yaw + 180.0) % 360.0 - 180.0) < 1.0
    off: F64 = np.hypot(u, v - 0.15 * carrier.d) + (0.0 if same else 0.7)
    return off
