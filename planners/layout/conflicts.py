"""Explain why a problem cannot be solved: find a smallest set of statements that contradict each other.

The method is QuickXplain (Junker 2004) on subproblems made of some of the statements. A subproblem counts as impossible
if the search does not solve it, so the size of a set depends on the quality of the search.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Literal, NamedTuple

from ...gaussians.world import kinds
from ...gaussians.world.person import STEP
from ..rooms.node import NodeId
from .bodies import Prepared
from .problem import Conflict, Item, Problem, Rigid, Wish
from .search import Search
from .sentences import describe_item, describe_keepout, describe_room, describe_wish
from .state import State

_TINY = (0.01, 0.01, 0.01)  # size of a thing in a subproblem that does not state its size
_EFFORT = 0.5  # of the search on subproblems
_MAX_PLACED = 800  # placements, at usual effort, to explain one layout
_MAX_CONFLICTS = 8  # conflicts reported
_MAX_SIZES = 12  # statements about sizes that are reduced to a smallest set; longer lists are reported as they are
_MAX_THINGS = 80  # things in a subproblem; larger ones are not searched


class Statement(NamedTuple):
    """One statement of a problem: `key` is a row of the problem's wishes or keepouts, or an item's id."""

    kind: Literal["wish", "size", "stand", "keepout", "room"]
    key: NodeId = 0


Statements = tuple[Statement, ...]


def explain(prepared: Prepared, state: State, broken: Sequence[Wish], seed: int, effort: float) -> tuple[Conflict, ...]:
    """Smallest contradicting sets of statements for missing required things and for the `broken` hard wishes."""
    return tuple(_Explainer(prepared, seed, effort).explain(state, broken))


def failed(prepared: Prepared, state: State) -> bool:
    """Whether a required thing is missing, a hard wish is broken, or a disc has no place."""
    missing = any(s is None and not i.optional for s, i in zip(state.spots, prepared.items, strict=True))
    return missing or None in state.discs or any(True for _ in broken_rows(prepared, state))


def broken_rows(prepared: Prepared, state: State) -> Iterator[int]:
    """Rows of hard wishes about placed things that do not hold."""
    for row, wish in enumerate(prepared.problem.wishes):
        there = all(state.spots[p] is not None for p in prepared.participants[row])
        if wish.hard and there and not state.holds(row)[0]:
            yield row


class _Explainer:
    def __init__(self, prepared: Prepared, seed: int, effort: float) -> None:
        self.prepared, self.problem, self.seed = prepared, prepared.problem, seed
        self.left = _MAX_PLACED * max(effort, 0.2)
        self.known: dict[frozenset[Statement], bool] = {}

    def explain(self, state: State, broken: Sequence[Wish]) -> Iterator[Conflict]:
        """Conflicts, at most one for each failure and none twice."""
        told = list[Statements]()
        yield from self._without_search(state, told)
        for failure, about in self._failures(state, broken):
            if len(told) >= _MAX_CONFLICTS or any(failure in t for t in told):
                continue
            found = self._smallest(failure, about)
            if found not in told:
                told.append(found)
                yield self._conflict(found)

    def _failures(self, state: State, broken: Sequence[Wish]) -> Iterator[tuple[Statement, set[NodeId]]]:
        """Failed statements with the ids of the things concerned: missing things first, then discs, then wishes."""
        for item, spot in zip(self.prepared.items, state.spots, strict=True):
            chain = self.prepared.carriers[self.prepared.index[item.id]]
            if spot is None and not item.optional and all(state.spots[c] is not None for c in chain):
                yield Statement("size", item.id), {item.id, *(self.prepared.items[c].id for c in chain)}
        for k, disc in enumerate(state.discs):
            if disc is None:
                yield Statement("keepout", k), set()
        missing = {i.id for i, s in zip(self.prepared.items, state.spots, strict=True) if s is None}
        for row, wish in enumerate(self.problem.wishes):
            names = {wish.subject, *wish.objects}
            if wish.hard and wish in broken and not names & missing:
                yield Statement("wish", row), names

    def _without_search(self, state: State, told: list[Statements]) -> Iterator[Conflict]:
        """Conflicts that need no search: cycles of support, boxes too large for the room, too little floor."""
        for i, item in enumerate(self.prepared.items):
            if self.prepared.is_circular(i):
                told.append((Statement("size", item.id),))
                ring = self.prepared.carriers[i]
                if i == min(ring):
                    yield self._support_cycle(ring)
            elif state.spots[i] is None and not item.optional and len(told) < _MAX_CONFLICTS:
                least, most = sorted(item.size[:2]), sorted(self.problem.size[:2])
                if item.size[2] > self.problem.size[2] or any(a > b for a, b in zip(least, most, strict=True)):
                    told.append((Statement("size", item.id), Statement("room")))
                    yield self._conflict(told[-1])
        if excess := self._too_much_floor({key for t in told for kind, key in t if kind == "size"}):
            missing = (i.id for i, s in zip(self.prepared.items, state.spots, strict=True) if s is None)
            told.append((*excess, *(Statement("size", name) for name in missing)))
            yield self._conflict(excess)

    def _support_cycle(self, ring: Sequence[int]) -> Conflict:
        """The conflict of things that stand on each other."""
        items = [self.prepared.items[c] for c in ring]
        said = tuple(f"{describe_item(i)} stands on {describe_item(self._item(i.support))}" for i in items)
        return Conflict(statements=said, subjects=tuple(i.id for i in items))

    def _too_much_floor(self, gone: set[NodeId]) -> Statements:
        """A few things whose footprints together exceed the floor; empty if the floor is large enough."""
        solid = [
            i for i in self.prepared.items
            if i.support == "floor" and i.size[2] > STEP and not i.optional and i.stand is None and i.id not in gone
        ]  # fmt: skip
        area, those = 0.0, [Statement("room")]
        for item in sorted(solid, key=lambda i: -i.size[0] * i.size[1]):
            area += item.size[0] * item.size[1]
            those.append(Statement("size", item.id))
            if area > self.problem.size[0] * self.problem.size[1]:
                return self._quickxplain(tuple(those), those[-1]) if len(those) <= _MAX_SIZES else tuple(those)
        return ()

    def _smallest(self, failure: Statement, about: set[NodeId]) -> Statements:
        """The smallest set found: among the things concerned, else among their partners too, else among all."""
        for names in self._widening(about):
            stated = self._statements(names, failure)
            if len(names) <= _MAX_THINGS and not self._possible(stated):
                return self._quickxplain(stated, failure)
        sizes = tuple(Statement("size", name) for name in sorted(about, key=str))
        return tuple(dict.fromkeys((failure, *sizes, Statement("room"))))

    def _widening(self, about: set[NodeId]) -> Iterator[set[NodeId]]:
        """Growing sets of things: those concerned, then with their partners, then all."""
        yield about
        wider = about | {
            n
            for w in self.problem.wishes
            if w.hard and {w.subject, *w.objects} & about
            for n in (w.subject, *w.objects)
        }
        if wider != about:
            yield wider
        yield {item.id for item in self.problem.items}

    def _statements(self, names: set[NodeId], failure: Statement) -> Statements:
        """The statements about some things and about the room."""
        found = [failure]
        for row, wish in enumerate(self.problem.wishes):
            if wish.hard and {wish.subject, *wish.objects} <= names:
                found.append(Statement("wish", row))
        found += [Statement("keepout", k) for k in range(len(self.problem.free))]
        for item in self.problem.items:
            if item.id in names and not item.optional:
                opening = kinds.is_opening(item.label)
                found += [Statement("stand", item.id)] if item.stand and not opening else []
                found += [Statement("size", item.id)] if not opening else []
        return tuple(dict.fromkeys((*found, Statement("room"))))

    def _quickxplain(self, stated: Statements, failure: Statement) -> Statements:
        """QuickXplain: a subset of the statements that is impossible while each of its own subsets is possible."""
        if not self._possible((failure,)):
            return (failure,)
        others = tuple(s for s in stated if s != failure)

        def search(base: Statements, added: bool, rest: Statements) -> Statements:
            if added and not self._possible(base):
                return ()
            if len(rest) == 1:
                return rest
            half = len(rest) // 2
            upper = search((*base, *rest[:half]), True, rest[half:])
            lower = search((*base, *upper), bool(upper), rest[:half])
            return (*lower, *upper)

        without = not self._possible(others) if others else False
        found = search((), False, others) if without else (failure, *search((failure,), False, others))
        return tuple(s for s in stated if s in found)

    def _possible(self, stated: Statements) -> bool:
        """Whether the search finds a layout that fulfils some statements; False once the work limit is reached."""
        key = frozenset(stated)
        if key not in self.known:
            part = self._subproblem(key)
            if self.left <= 0:
                return False
            prepared = Prepared.of(part)
            search = Search(prepared, self.seed, _EFFORT)
            state = search.run()
            self.left -= search.placed
            self.known[key] = not failed(prepared, state)
        return self.known[key]

    def _subproblem(self, stated: frozenset[Statement]) -> Problem:
        """The problem made of some statements only: without a statement a size is tiny and the room very large."""
        wishes = tuple(w for k, w in enumerate(self.problem.wishes) if Statement("wish", k) in stated)
        names = {n for w in wishes for n in (w.subject, *w.objects)} | {s.key for s in stated if s.kind in _OF_ITEM}
        names |= {i.id for i in self.prepared.items if "window" in i.label.lower() and i.stand}
        rows = {c for n in names if n in self.prepared.index for c in self._with_carriers(n)}
        width, deep, high = self.problem.size
        if Statement("room") not in stated:
            width, deep, high = 3 * width + 20.0, 3 * deep + 20.0, 3 * high + 5.0
        return Problem(
            size=(width, deep, high),
            items=tuple(self._stated_item(self.prepared.items[i], stated) for i in sorted(rows)),
            wishes=wishes,
            free=tuple(f for k, f in enumerate(self.problem.free) if Statement("keepout", k) in stated),
            walkway=self.problem.walkway,
            rigid=self._rigid({self.prepared.items[i].id for i in rows}, stated),
        )

    def _rigid(self, there: set[NodeId], stated: frozenset[Statement]) -> tuple[Rigid, ...]:
        """The rigid groups of which all things are there in their stated sizes."""
        return tuple(
            g
            for g in self.problem.rigid
            if all(name in there and Statement("size", name) in stated for name, *_ in g.members)
        )

    def _with_carriers(self, name: NodeId) -> tuple[int, ...]:
        i = self.prepared.index[name]
        return (i, *self.prepared.carriers[i])

    def _stated_item(self, item: Item, stated: frozenset[Statement]) -> Item:
        opening = item.stand is not None and (kinds.is_opening(item.label))
        if opening:
            return item.model_copy(update={"clear": (0.0,) * 4})
        changes: dict[str, object] = {"optional": False, "clear": (0.0,) * 4, "backed": False}
        if Statement("size", item.id) not in stated:
            changes["size"] = self._any_size(item)
        if Statement("stand", item.id) not in stated:
            changes["stand"] = None
        return item.model_copy(update=changes)

    def _any_size(self, item: Item) -> tuple[float, float, float]:
        """The size of a thing without a statement of its size: tiny, but wide enough for the things on it."""
        row = self.prepared.index[item.id]
        rows = zip(self.prepared.items, self.prepared.carriers, strict=True)
        side = sum(max(i.size[:2]) for i, chain in rows if chain[:1] == (row,))
        width, deep = (min(side, 0.8 * s) for s in self.problem.size[:2])
        return (width, deep, item.size[2]) if side else _TINY

    def _item(self, name: NodeId) -> Item:
        return self.prepared.items[self.prepared.index[name]]

    def _conflict(self, stated: Statements) -> Conflict:
        said, subjects = list[str](), list[NodeId]()
        tell: dict[str, Callable[[NodeId], str]] = {
            "size": lambda key: "{} is {:g} m wide, {:g} m deep and {:g} m high".format(
                describe_item(self._item(key)), *self._item(key).size
            ),
            "stand": lambda key: f"{describe_item(self._item(key))} stays where it is",
            "keepout": lambda key: describe_keepout(self.problem.free[int(key)]),
            "room": lambda key: describe_room(self.problem.size),
            "wish": lambda key: describe_wish(self.problem.wishes[int(key)], self._item),
        }
        for kind, key in stated:
            said.append(tell[kind](key))
            wish = self.problem.wishes[int(key)] if kind == "wish" else None
            if wish and wish.name == "at_window" and not any("window" in i.label.lower() for i in self.prepared.items):
                said.append("the room has no window")
            subjects += [key] if kind in _OF_ITEM else [wish.subject, *wish.objects] if wish else []
        return Conflict(statements=tuple(said), subjects=tuple(dict.fromkeys(subjects)))


_OF_ITEM = ("size", "stand")
