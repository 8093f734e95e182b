"""All free positions of a body on its candidate surfaces with their costs, one array for each lattice.

Lattices are in the frame of the floor, or of the thing that carries the body. costs.py defines the costs.
"""

from __future__ import annotations

import numpy as np

from ...gaussians.world import relations
from ...gaussians.world.box import YawBox, to_world
from ...gaussians.world.person import HEADROOM, STEP
from .bodies import Body, Member
from .candidate_surfaces import FLOOR, Surface, candidate_surfaces
from .costs import Positions, add_crowding_cost, at_positions, habit_cost, in_frame, use_cost, wish_cost
from .lattice import EPSILON, Flags, Lattice, blocked, in_disc
from .measures import measure, walls_gaps
from .state import BROKEN_SOFT, State

_VIEWED = tuple(k.name for k in relations.KINDS if k.aim)


def candidate_positions(state: State, body: Body, rng: np.random.Generator, noise: float) -> list[Positions]:
    """Every position where a body fits, with its cost; positions along walls are tried first."""
    found: list[Positions] = []
    for walls_only in (True, False):
        for surface in candidate_surfaces(state, body, walls_only):
            for lattice in surface.lattices:
                place = _priced(state, reseated(state, body, lattice.yaw), surface, lattice)
                if place is not None:
                    found.append(place)
        if any(len(p.cost) and p.cost.min() < BROKEN_SOFT for p in found):
            break
    if noise:
        found = [p._replace(cost=p.cost + rng.normal(0.0, noise, len(p.cost))) for p in found]
    return found


def _priced(state: State, body: Body, surface: Surface, lattice: Lattice) -> Positions | None:
    """The free positions of a lattice with their costs; None if there are none."""
    prepared, frame = state.prepared, surface.frame
    own = {m.item for m in body.members}
    shape = (len(lattice.xs), len(lattice.ys))
    taken, cost = np.zeros(shape, bool), np.zeros(shape)
    exempt = own | {c for i in own for c in prepared.carriers[i]}
    solids = [(i, in_frame(s, frame)) for i, s in state.solids(exempt)]
    add_crowding_cost(state, body, lattice, solids, cost)
    for member in body.members:
        moving = state.spot(member, 0.0, 0.0, lattice.yaw, surface.low)
        if not state.is_flat(member.item):
            blocked(lattice, moving, [s for j, s in solids if (member.item, j) not in prepared.sheltered], taken)
            _out_of_discs(state, lattice, moving, frame, taken)
        if taken.all():
            return None
        cost += use_cost(state, lattice, member, moving, solids, frame)
    free = np.argwhere(~taken)
    x, y = to_world(frame.x, frame.y, frame.yaw, lattice.xs[free[:, 0]], lattice.ys[free[:, 1]])
    place = Positions(body, x, y, lattice.yaw + frame.yaw, surface.low, cost[free[:, 0], free[:, 1]])
    place = _within_room(state, body, place) if frame is not FLOOR else place
    if not len(place.cost):
        return None
    return place._replace(cost=place.cost + wish_cost(state, body, place) + habit_cost(state, body, place))


def reseated(state: State, body: Body, yaw: float) -> Body:
    """The body with its members' seats exchanged so that as many wishes among them as possible hold at this yaw."""
    rows = [
        r
        for r in dict.fromkeys(r for m in body.members for r in state.prepared.wishes_of[m.item])
        if state.prepared.problem.wishes[r].name in _VIEWED
        and set(state.prepared.participants[r]) <= {m.item for m in body.members}
    ]
    if not rows:
        return body
    members, kept = body.members, _held(state, body.members, rows, yaw)
    for i in range(1, len(members)):
        for j in range(i + 1, len(members)):
            trial = state.prepared.swapped(members, i, j)
            if trial is not None and (now := _held(state, trial, rows, yaw)) > kept:
                members, kept = trial, now
    return Body(members)


def _held(state: State, members: tuple[Member, ...], rows: list[int], yaw: float) -> int:
    spots = {m.item: state.spot(m, 0.0, 0.0, yaw, 0.0) for m in members}
    wishes = state.prepared.problem.wishes
    return sum(
        bool(measure(wishes[r].name, state.size, *_split([spots[p] for p in state.prepared.participants[r]]), [])[0])
        for r in rows
    )


def _split(spots: list[YawBox]) -> tuple[YawBox, list[YawBox]]:
    return spots[0], spots[1:]


def _within_room(state: State, body: Body, place: Positions) -> Positions:
    """Only the positions where all of the body is in the room."""
    kept = np.ones(len(place.cost), bool)
    for member in body.members:
        spot = at_positions(state, member, place)
        kept &= np.min(walls_gaps(spot, state.size), axis=0) >= -EPSILON
    return place._replace(x=place.x[kept], y=place.y[kept], cost=place.cost[kept])


def _out_of_discs(state: State, lattice: Lattice, moving: YawBox, frame: YawBox, taken: Flags) -> None:
    if moving.low >= HEADROOM or moving.high <= STEP:
        return
    for disc in state.discs:
        if disc is not None:
            x, y = frame.local(disc[0], disc[1])
            taken |= in_disc(lattice, moving, float(x), float(y), disc[2])
