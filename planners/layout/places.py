"""Where a body may stand, and what each place costs: all positions of a fine lattice at once.

Knows obstacles. Refuses to know in which order things are placed, and what makes a place dear (prices).
The frame is the floor's, or that of the thing that carries the body.
"""

from __future__ import annotations

import numpy as np

from ...gaussians.world import relations
from ...gaussians.world.box import YawBox, to_world
from ...gaussians.world.person import HEADROOM, STEP
from .bodies import Body, Member
from .candidate_surfaces import FLOOR, Ground, grounds
from .costs import Place, crowding, habits, in_frame, moved, use, wished
from .lattice import EPSILON, Flags, Lattice, blocked, in_disc
from .measures import measure, walls_gaps
from .state import SOFT, State

_VIEWED = tuple(k.name for k in relations.KINDS if k.aim)


def places(state: State, body: Body, rng: np.random.Generator, noise: float) -> list[Place]:
    """Every place where a body fits, with its price; what wants a wall is tried there first."""
    found: list[Place] = []
    for walls_only in (True, False):
        for ground in grounds(state, body, walls_only):
            for lattice in ground.lattices:
                place = _priced(state, seated(state, body, lattice.yaw), ground, lattice)
                if place is not None:
                    found.append(place)
        if any(len(p.price) and p.price.min() < SOFT for p in found):
            break
    if noise:
        found = [p._replace(price=p.price + rng.normal(0.0, noise, len(p.price))) for p in found]
    return found


def _priced(state: State, body: Body, ground: Ground, lattice: Lattice) -> Place | None:
    """The free positions of a lattice with their prices; None where there are none."""
    prepared, frame = state.prepared, ground.frame
    own = {m.item for m in body.members}
    shape = (len(lattice.xs), len(lattice.ys))
    taken, price = np.zeros(shape, bool), np.zeros(shape)
    exempt = own | {c for i in own for c in prepared.carriers[i]}
    solids = [(i, in_frame(s, frame)) for i, s in state.solids(exempt)]
    crowding(state, body, lattice, solids, price)
    for member in body.members:
        moving = state.spot(member, 0.0, 0.0, lattice.yaw, ground.low)
        if not state.is_flat(member.item):
            blocked(lattice, moving, [s for _, s in solids], taken)
            _out_of_discs(state, lattice, moving, frame, taken)
        if taken.all():
            return None
        price += use(state, lattice, member, moving, solids, frame)
    free = np.argwhere(~taken)
    x, y = to_world(frame.x, frame.y, frame.yaw, lattice.xs[free[:, 0]], lattice.ys[free[:, 1]])
    place = Place(body, x, y, lattice.yaw + frame.yaw, ground.low, price[free[:, 0], free[:, 1]])
    place = _within_room(state, body, place) if frame is not FLOOR else place
    if not len(place.price):
        return None
    return place._replace(price=place.price + wished(state, body, place) + habits(state, body, place))


def seated(state: State, body: Body, yaw: float) -> Body:
    """The body with its like members in those seats in which most of what is wished among them holds at this yaw."""
    rows = [
        r
        for r in dict.fromkeys(r for m in body.members for r in state.prepared.wishes_of[m.item])
        if state.prepared.problem.wishes[r].name in _VIEWED
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


def _split(spots: list[YawBox]) -> tuple[YawBox, list[YawBox]]:
    return spots[0], spots[1:]


def _within_room(state: State, body: Body, place: Place) -> Place:
    """Only places at which all of the body is in the room."""
    kept = np.ones(len(place.price), bool)
    for member in body.members:
        spot = moved(state, member, place)
        kept &= np.min(walls_gaps(spot, state.size), axis=0) >= -EPSILON
    return place._replace(x=place.x[kept], y=place.y[kept], price=place.price[kept])


def _out_of_discs(state: State, lattice: Lattice, moving: YawBox, frame: YawBox, taken: Flags) -> None:
    if moving.low >= HEADROOM or moving.high <= STEP:
        return
    for disc in state.discs:
        if disc is not None:
            x, y = frame.local(disc[0], disc[1])
            taken |= in_disc(lattice, moving, float(x), float(y), disc[2])
