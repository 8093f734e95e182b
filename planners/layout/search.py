"""The search: things one after another at the cheapest place, those that fared badly sooner the next time.

Knows an order, restarts and second looks. Refuses to know what a place costs (places) and why nothing fits (conflicts).
Greedy construction with squeaky-wheel restarts (Joslin and Clements 1999), then every body in turn is taken up and
put where it is best given all others. Work is counted, not timed, so that the same problem ends the same everywhere.
"""

from __future__ import annotations

import numpy as np

from ...gaussians.world.box import YawBox
from ...gaussians.world.person import HEADROOM, STEP
from ...gaussians.world.support import SHELL
from .bodies import Body, Member, Prepared
from .costs import Place
from .lattice import F64, Flags
from .places import places
from .state import State

_TRIES = 6  # places that are looked at for a way to everything, before the best of them is taken
_SEEK = 30  # such places where all of the first shut something off
_APART = 0.35  # metres between such places
_IDLE = 4  # starts without a better layout, after which no more are made
_IDLE_TIDY = 2  # the same where only habits are at stake
_WORK = 150  # times that something is placed, at usual effort, after which no new start is made
_FIRST = 3.0  # urgency, in square metres, of what shut others off: it is placed before them the next time
_WORTH = 0.05  # price by which a second look must better the layout to be worth another


class Search:
    """One problem being solved.

    Args:
        prepared: the problem.
        seed: of the noise on prices from the second start on.
        effort: 1 is usual; scales starts and second looks.
    """

    def __init__(self, prepared: Prepared, seed: int, effort: float) -> None:
        self.prepared, self.effort = prepared, effort
        self.rng = np.random.default_rng(seed)
        self.loose = set[int]()
        self.placed = 0  # how often something was placed: the work done so far
        self.blocking = set[int]()  # what shut others off, wherever it was put
        self.urgent = [0.0] * len(prepared.items)
        things = max(len(prepared.items), 1)
        self.starts = max(1, min(round(12 * effort), round(effort * 200 / things)))
        self.looks = max(0, min(round(3 * effort), round(effort * 100 / things)))

    def run(self) -> State:
        """The best layout of all starts."""
        state = State(self.prepared)
        empty, best, least = state.copy(), state.copy(), np.inf
        raw, idle = np.inf, 0
        for start in range(self.starts):
            state.restore(empty)
            bodies = self._fill(state, 0.15 if start == 0 else 0.8)
            rough = state.price()
            if rough < raw:
                raw = rough
                self._better(state, bodies)
            self._load(state, 0.0 if start == 0 else 0.4)
            price = state.price()
            idle = 0 if price < least else idle + 1
            if price < least:
                best, least = state.copy(), price
            patience = _IDLE if self._blame(state) else _IDLE_TIDY if self._tidy(state) else 0
            if idle >= patience * max(self.effort, 1.0) or self.placed >= _WORK * self.effort:
                break
        state.restore(best)
        return state

    def _fill(self, state: State, noise: float) -> list[Body]:
        """Keep discs free, then place the bodies one after another."""
        self._clear_discs(state)
        placed = list[Body]()
        for body in sorted(self._bodies(), key=self._rank):
            placed += self._settle(state, body, noise)
        return placed

    def _bodies(self) -> list[Body]:
        """What moves as one, without those that could not keep their wishes that way."""
        found = list[Body]()
        for body in self.prepared.bodies:
            first, *others = body.members
            found.append(Body((first, *(m for m in others if m.item not in self.loose))))
            found += [Body((Member(m.item),)) for m in others if m.item in self.loose]
        return found

    def _load(self, state: State, noise: float) -> None:
        """Place what stands on other things."""
        carried = [i for i, item in enumerate(self.prepared.items) if item.support not in SHELL and item.stand is None]
        for i in sorted(carried, key=lambda i: (len(self.prepared.carriers[i]), -self.urgent[i], -self._size(i), i)):
            if not self.prepared.is_circular(i):
                self._put(state, Body((Member(i),)), noise)

    def _size(self, i: int) -> float:
        return self.prepared.items[i].size[0] * self.prepared.items[i].size[1]

    def _rank(self, body: Body) -> tuple[float, ...]:
        """What is placed first: what failed before, what is large or wants a wall, rugs and hung things last."""
        item = self.prepared.items[body.first]
        late = {"floor": 0.0, "wall": 1.0, "ceiling": 2.0}[str(item.support)]
        if item.support == "wall" and (item.height or 0.0) + item.size[2] < 1.0:
            late = 0.0
        if item.support == "wall" and self._faced(body.first):
            late = -1.0
        if item.support == "floor" and item.size[2] <= STEP:
            late = 1.5
        area = sum(self.prepared.area(m.item) for m in body.members)
        bound = self._bound(body.first)
        urgent = max(self.urgent[m.item] for m in body.members)
        walled = 0.5 if self.prepared.wants_wall(body.first) else 0.0
        return late, float(item.optional), -(urgent + area + 0.2 * min(bound, 5) + walled), float(body.first)

    def _faced(self, i: int) -> bool:
        """Whether others are to look at an item: a whiteboard is hung before the desks are set out."""
        rows = ((r, self.prepared.parties[r]) for r in self.prepared.wishes_of[i])
        return any(self.prepared.problem.wishes[r].name == "facing" and i in parts[1:] for r, parts in rows)

    def _settle(self, state: State, body: Body, noise: float) -> list[Body]:
        """Place a body; if there is no room for all of it at once, its things one by one."""
        if self._put(state, body, noise) or len(body.members) == 1:
            return [body]
        singles = [Body((Member(m.item),)) for m in body.members]
        for single in singles:
            self._put(state, single, noise)
        return singles

    def _put(self, state: State, body: Body, noise: float) -> bool:
        """Put a body at the cheapest place from which everything can still be walked up to."""
        found = places(state, body, self.rng, noise)
        if not found:
            return False
        self.placed += 1
        before = state.lost()
        state.place(*self._reachable(state, found, before))
        if state.lost() <= before:
            return True
        self.blocking |= {m.item for m in body.members}
        if all(self.prepared.items[m.item].optional for m in body.members):
            state.remove(body)
            return False
        return True

    def _reachable(self, state: State, found: list[Place], before: int) -> tuple[Body, float, float, float, float]:
        """The cheapest place, with what it shuts off counted in; `before` so many things were shut off already."""
        price = np.concatenate([p.price for p in found])
        x, y = np.concatenate([p.x for p in found]), np.concatenate([p.y for p in found])
        which = np.repeat(np.arange(len(found)), [len(p.price) for p in found])
        best: tuple[Body, float, float, float, float] | None = None
        least, open_way = np.inf, False
        for tried in range(_SEEK):
            if tried >= _TRIES and open_way:
                break
            self.placed += tried > 0 and tried % _TRIES == 0
            k = int(price.argmin())
            if not price[k] < least:
                break
            place = found[which[k]]
            here = (place.body, float(x[k]), float(y[k]), place.yaw, place.low)
            state.place(*here)
            total = float(price[k]) + state.crowded()
            open_way = open_way or state.lost() <= before
            state.remove(place.body)
            if total < least:
                best, least = here, total
            price[(np.hypot(x - x[k], y - y[k]) < _APART) & (which == which[k])] = np.inf
        assert best is not None
        return best

    def _better(self, state: State, bodies: list[Body]) -> None:
        """Take up every body and put it where it is best now, as long as that is worth it."""
        price = state.price()
        for _ in range(self.looks):
            before = price
            for body in bodies:
                kept = state.copy()
                state.remove(body)
                now = state.price() if self._put(state, body, 0.0) else np.inf
                if now > price:
                    state.restore(kept)
                else:
                    price = now
            if price > before - _WORTH:
                return

    def _clear_discs(self, state: State) -> None:
        """A place for every disc that the solver may choose: as near to the middle of the room as it fits."""
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

    def _blame(self, state: State) -> bool:
        """Make what has no place, or breaks a hard wish, more urgent; whether there was any such thing."""
        guilty = {i for i, spot in enumerate(state.spots) if spot is None}
        for row, wish in enumerate(self.prepared.problem.wishes):
            if wish.hard and not state.holds(row)[0]:
                guilty |= set(self.prepared.parties[row])
                self._loosen(set(self.prepared.parties[row]))
        for i in self.blocking:
            self.urgent[i] += _FIRST
        self.blocking = set()
        lost = state.ways[-1].unreached()
        guilty |= {i for i in lost if isinstance(i, int)}
        for i in guilty:
            for k in (i, *self.prepared.carriers[i]):
                self.urgent[k] += 1.0
        return bool(guilty)

    def _tidy(self, state: State) -> bool:
        """Make what has no wall behind it, no room, or breaks a habit, more urgent; whether there was any such."""
        untidy = {*state.unbacked(), *state.used()}
        for row, wish in enumerate(self.prepared.problem.wishes):
            if not wish.hard and not state.holds(row)[0]:
                untidy |= set(self.prepared.parties[row])
        for i in untidy:
            for k in (i, *self.prepared.carriers[i]):
                self.urgent[k] += 0.5
        return bool(untidy)

    def _loosen(self, parts: set[int]) -> None:
        """Part bodies over a wish that is not kept: its own things, and those of one body with it that are bound."""
        self.loose |= parts
        for body in self.prepared.bodies:
            if body.first in parts:
                self.loose |= {m.item for m in body.members if self._bound(m.item)}

    def _bound(self, i: int) -> int:
        """How many hard wishes an item takes part in."""
        return sum(self.prepared.problem.wishes[r].hard for r in self.prepared.wishes_of[i])


def _meets_disc(xs: F64, ys: F64, spot: YawBox, radius: float) -> Flags:
    """`[X, Y]` middles at which a disc would reach into a box."""
    meets: Flags = spot.distance_to(xs[:, None], ys[None, :]) < radius
    return meets
