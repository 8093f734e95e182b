"""The search for a layout: greedy construction with squeaky-wheel restarts (Joslin and Clements 1999).

Each start places the bodies one after another at their cheapest positions, then moves every body in turn to the best
position given all others. Bodies that failed are placed sooner in the next start. Work is counted, not timed, so the
same problem gives the same layout on every machine, unless a moment is given at which the search ends.
"""

from __future__ import annotations

import time

import numpy as np

from ...gaussians.world.box import YawBox
from ...gaussians.world.person import HEADROOM, STEP
from ...gaussians.world.support import SHELL
from .bodies import Body, Member, Prepared
from .candidate_positions import candidate_positions
from .costs import Positions
from .lattice import F64, Flags
from .state import State

_MAX_TRIALS = 6  # positions of a body that are tested for access to all things; the best of them is taken
_MAX_TRIALS_BLOCKED = 30  # the same if each of the first ones makes something inaccessible
_MIN_SPACING = 0.35  # metres between these positions
_PATIENCE = 4  # starts without a better layout, after which the search ends
_PATIENCE_SOFT = 2  # the same if only soft wishes, backs and use zones are imperfect
_MAX_PLACED = 150  # placements, at usual effort, after which no new start is made
_BLOCKING_URGENCY = 3.0  # urgency, square metres, added to things that made others inaccessible: they go before them
_MIN_GAIN = 0.05  # decrease in cost by an improvement pass that makes another pass worthwhile


class Search:
    """The search for a layout of one problem.

    Args:
        prepared: the problem.
        seed: of the noise on costs.
        effort: 1 is usual; scales the number of starts and improvement passes.
        until: `time.perf_counter()` at which the search ends, if a start more would take it beyond; None: never.
    """

    def __init__(self, prepared: Prepared, seed: int, effort: float, until: float | None = None) -> None:
        self.prepared, self.effort, self.until = prepared, effort, until
        self.rng = np.random.default_rng(seed)
        self.split = set[int]()
        self.placed = 0  # number of placements: the work done so far
        self.blocking = set[int]()  # things that made others inaccessible at every position tried
        self.urgent = [0.0] * len(prepared.items)
        things = max(len(prepared.items), 1)
        self.starts = max(1, min(round(12 * effort), round(effort * 200 / things)))
        self.passes = max(0, min(round(3 * effort), round(effort * 100 / things)))

    def run(self) -> State:
        """The best layout of all starts."""
        state = State(self.prepared)
        empty, best, lowest = state.copy(), state.copy(), np.inf
        raw, idle, began = np.inf, 0, time.perf_counter()
        for start in range(self.starts):
            if self.until is not None and start:
                now = time.perf_counter()
                if now + (now - began) / start > self.until:
                    break
            state.restore(empty)
            bodies = self._construct(state, 0.15 if start == 0 else 0.8)
            rough = state.cost()
            if rough < raw:
                raw = rough
                self._improve(state, bodies)
            self._place_carried(state, 0.0 if start == 0 else 0.4)
            cost = state.cost()
            idle = 0 if cost < lowest else idle + 1
            if cost < lowest:
                best, lowest = state.copy(), cost
            patience = (
                _PATIENCE if self._raise_urgency(state) else _PATIENCE_SOFT if self._raise_soft_urgency(state) else 0
            )
            if idle >= patience * max(self.effort, 1.0) or self.placed >= _MAX_PLACED * self.effort:
                break
        state.restore(best)
        return state

    def _construct(self, state: State, noise: float) -> list[Body]:
        """Choose the free discs, then place the bodies one after another."""
        self._clear_discs(state)
        placed = list[Body]()
        for body in sorted(self._bodies(), key=self._rank):
            placed += self._place_or_split(state, body, noise)
        return placed

    def _bodies(self) -> list[Body]:
        """The bodies, without the members that were split off because their wishes failed."""
        found = list[Body]()
        for body in self.prepared.bodies:
            first, *others = body.members
            found.append(Body((first, *(m for m in others if m.item not in self.split))))
            found += [Body((Member(m.item),)) for m in others if m.item in self.split]
        return found

    def _place_carried(self, state: State, noise: float) -> None:
        """Place the things that stand on other things."""
        carried = [i for i, item in enumerate(self.prepared.items) if item.support not in SHELL and item.stand is None]
        for i in sorted(carried, key=lambda i: (len(self.prepared.carriers[i]), -self.urgent[i], -self._size(i), i)):
            if not self.prepared.is_circular(i):
                self._put(state, Body((Member(i),)), noise)

    def _size(self, i: int) -> float:
        return self.prepared.items[i].size[0] * self.prepared.items[i].size[1]

    def _rank(self, body: Body) -> tuple[float, ...]:
        """Sort key of the placing order: failed, large and wall things first, rugs and hanging things last."""
        item = self.prepared.items[body.first]
        late = {"floor": 0.0, "wall": 1.0, "ceiling": 2.0}[str(item.support)]
        if item.support == "wall" and (item.height or 0.0) + item.size[2] < 1.0:
            late = 0.0
        if item.support == "wall" and self._faced(body.first):
            late = -1.0
        if item.support == "floor" and item.size[2] <= STEP:
            late = 1.5
        area = sum(self.prepared.area(m.item) for m in body.members)
        bound = self._hard_wishes(body.first)
        urgent = max(self.urgent[m.item] for m in body.members)
        walled = 0.5 if self.prepared.wants_wall(body.first) else 0.0
        return late, float(item.optional), -(urgent + area + 0.2 * min(bound, 5) + walled), float(body.first)

    def _faced(self, i: int) -> bool:
        """Whether other things are to face an item: a whiteboard is placed before the desks."""
        rows = ((r, self.prepared.participants[r]) for r in self.prepared.wishes_of[i])
        return any(self.prepared.problem.wishes[r].name == "facing" and i in parts[1:] for r, parts in rows)

    def _place_or_split(self, state: State, body: Body, noise: float) -> list[Body]:
        """Place a body; if there is no room for all of it, place its things one by one."""
        if self._put(state, body, noise) or len(body.members) == 1:
            return [body]
        singles = [Body((Member(m.item),)) for m in body.members]
        for single in singles:
            self._put(state, single, noise)
        return singles

    def _put(self, state: State, body: Body, noise: float) -> bool:
        """Put a body at the cheapest position that keeps all things accessible; return whether it was placed."""
        found = candidate_positions(state, body, self.rng, noise)
        if not found:
            return False
        self.placed += 1
        before = state.unreached_count()
        state.place(*self._cheapest_accessible(state, found, before))
        if state.unreached_count() <= before:
            return True
        self.blocking |= {m.item for m in body.members}
        if all(self.prepared.items[m.item].optional for m in body.members):
            state.remove(body)
            return False
        return True

    def _cheapest_accessible(
        self, state: State, found: list[Positions], before: int
    ) -> tuple[Body, float, float, float, float]:
        """The cheapest position including the cost of inaccessible things; `before`: how many there were already."""
        cost = np.concatenate([p.cost for p in found])
        x, y = np.concatenate([p.x for p in found]), np.concatenate([p.y for p in found])
        which = np.repeat(np.arange(len(found)), [len(p.cost) for p in found])
        best: tuple[Body, float, float, float, float] | None = None
        lowest, accessible = np.inf, False
        for tried in range(_MAX_TRIALS_BLOCKED):
            if tried >= _MAX_TRIALS and accessible:
                break
            self.placed += tried > 0 and tried % _MAX_TRIALS == 0
            k = int(cost.argmin())
            if not cost[k] < lowest:
                break
            place = found[which[k]]
            here = (place.body, float(x[k]), float(y[k]), place.yaw, place.low)
            state.place(*here)
            total = float(cost[k]) + state.access_cost()
            accessible = accessible or state.unreached_count() <= before
            state.remove(place.body)
            if total < lowest:
                best, lowest = here, total
            cost[(np.hypot(x - x[k], y - y[k]) < _MIN_SPACING) & (which == which[k])] = np.inf
        assert best is not None
        return best

    def _improve(self, state: State, bodies: list[Body]) -> None:
        """Move every body to its best position given all others, in passes, until a pass gains too little."""
        cost = state.cost()
        for _ in range(self.passes):
            before = cost
            for body in bodies:
                kept = state.copy()
                state.remove(body)
                now = state.cost() if self._put(state, body, 0.0) else np.inf
                if now > cost:
                    state.restore(kept)
                else:
                    cost = now
            late = self.until is not None and time.perf_counter() > self.until
            if late or cost > before - _MIN_GAIN:
                return

    def _clear_discs(self, state: State) -> None:
        """Place every disc without a given centre as near to the middle of the room as it fits."""
        width, deep, _ = state.size
        for k, keepout in enumerate(self.prepared.problem.free):
            if keepout.center is not None or state.discs[k] is not None:
                continue
            r = keepout.radius
            if 2 * r > min(width, deep):
                continue
            xs, ys = np.linspace(r - width / 2, width / 2 - r, 41), np.linspace(r - deep / 2, deep / 2 - r, 41)
            away = np.hypot(xs[:, None], ys[None, :]) + self.rng.normal(0.0, 1e-6, (41, 41))
            for _, spot in state.solids(set()):
                if spot.low < HEADROOM:
                    away[_meets_disc(xs, ys, spot, r)] = np.inf
            best = int(away.argmin())
            if np.isfinite(away.flat[best]):
                state.discs[k] = (float(xs[best // 41]), float(ys[best % 41]), r)

    def _raise_urgency(self, state: State) -> bool:
        """Raise the urgency of things without a place or with a broken hard wish; return whether there were any."""
        failing = {i for i, spot in enumerate(state.spots) if spot is None}
        for row, wish in enumerate(self.prepared.problem.wishes):
            if wish.hard and not state.holds(row)[0]:
                failing |= set(self.prepared.participants[row])
                self._split_bodies(set(self.prepared.participants[row]))
        for i in self.blocking:
            self.urgent[i] += _BLOCKING_URGENCY
        self.blocking = set()
        unreached = state.grids[-1].unreached()
        failing |= {i for i in unreached if isinstance(i, int)}
        for i in failing:
            for k in (i, *self.prepared.carriers[i]):
                self.urgent[k] += 1.0
        return bool(failing)

    def _raise_soft_urgency(self, state: State) -> bool:
        """Raise the urgency of things away from their wall, with a blocked use zone or a broken soft wish. Returns
        whether there were any."""
        imperfect = {*state.away_from_wall(), *state.blocked_use()}
        for row, wish in enumerate(self.prepared.problem.wishes):
            if not wish.hard and not state.holds(row)[0]:
                imperfect |= set(self.prepared.participants[row])
        for i in imperfect:
            for k in (i, *self.prepared.carriers[i]):
                self.urgent[k] += 0.5
        return bool(imperfect)

    def _split_bodies(self, parts: set[int]) -> None:
        """Split things with a broken wish off their bodies, and other members of these bodies that have hard wishes."""
        self.split |= parts
        for body in self.prepared.bodies:
            if body.first in parts:
                self.split |= {m.item for m in body.members if self._hard_wishes(m.item)}

    def _hard_wishes(self, i: int) -> int:
        """Number of hard wishes that name an item."""
        return sum(self.prepared.problem.wishes[r].hard for r in self.prepared.wishes_of[i])


def _meets_disc(xs: F64, ys: F64, spot: YawBox, radius: float) -> Flags:
    """`[X, Y]` middles at which a disc would overlap a box."""
    meets: Flags = spot.distance_to(xs[:, None], ys[None, :]) < radius
    return meets
