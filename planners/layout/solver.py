"""The entry point of the layout solver: prepare the problem, search a layout, verify it and explain what failed."""

from __future__ import annotations

import time
from dataclasses import dataclass

from .bodies import Prepared
from .conflicts import explain
from .problem import Layout, Problem
from .search import Search
from .state import State
from .verify import verified


@dataclass(frozen=True, eq=False)
class Attempt:
    """A layout that was searched, and what its failures are explained from.

    Attributes:
        layout: without conflicts.
        prepared, state, seed, effort: of the search.
    """

    layout: Layout
    prepared: Prepared
    state: State
    seed: int
    effort: float

    def explained(self) -> Layout:
        """The layout with the reasons of what failed."""
        started = time.perf_counter()
        conflicts = explain(self.prepared, self.state, self.layout.broken, self.seed, self.effort)
        seconds = self.layout.seconds + time.perf_counter() - started
        return self.layout.model_copy(update={"conflicts": conflicts, "seconds": seconds})


def attempt(problem: Problem, seed: int = 0, effort: float = 1.0, until: float | None = None) -> Attempt:
    """Search a layout as `solve` does, without explaining what failed.

    Args:
        until: value of `time.perf_counter()` after which no further start of the search is made, so that the layout
            depends on the machine's speed; None: work alone limits the search.
    """
    started = time.perf_counter()
    prepared = Prepared.of(problem)
    state = Search(prepared, seed, effort, until).run()
    graph, kept = verified(prepared, state)
    there = {n.id for n in graph.nodes}
    layout = Layout(
        graph=graph,
        kept=kept,
        broken=tuple(w for w in problem.wishes if w not in kept),
        left_out=tuple(i.id for i in problem.items if i.id not in there),
        conflicts=(),
        seconds=time.perf_counter() - started,
    )
    return Attempt(layout, prepared, state, seed, effort)


def solve(problem: Problem, seed: int = 0, *, effort: float = 1.0, explained: bool = True) -> Layout:
    """Place things in a room so that they are free of collisions, supported, accessible and fulfil the wishes.

    Args:
        problem: the room, the things and the wishes; things with a `stand` stay there in any case.
        seed: the same problem, seed and effort give the same layout, apart from its `seconds`.
        effort: how long to search; 1 is usual, 0 takes the first layout.
        explained: whether to search for the reasons of what failed; without them `Layout.conflicts` is empty.
    """
    made = attempt(problem, seed, effort)
    return made.explained() if explained else made.layout
