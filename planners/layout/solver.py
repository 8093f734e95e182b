"""The entry point of the layout solver: prepare the problem, search a layout, verify it and explain what failed."""

from __future__ import annotations

import time

from .bodies import Prepared
from .conflicts import explain
from .problem import Layout, Problem
from .search import Search
from .verify import verified


def solve(problem: Problem, seed: int = 0, *, effort: float = 1.0, explained: bool = True) -> Layout:
    """Place things in a room so that they are free of collisions, supported, accessible and fulfil the wishes.

    Args:
        problem: the room, the things and the wishes; things with a `stand` stay there in any case.
        seed: the same problem, seed and effort give the same layout, apart from its `seconds`.
        effort: how long to search; 1 is usual, 0 takes the first layout.
        explained: whether to search for the reasons of what failed; without them `Layout.conflicts` is empty.
    """
    started = time.perf_counter()
    prepared = Prepared.of(problem)
    state = Search(prepared, seed, effort).run()
    graph, kept = verified(prepared, state)
    broken = tuple(w for w in problem.wishes if w not in kept)
    there = {n.id for n in graph.nodes}
    return Layout(
        graph=graph,
        kept=kept,
        broken=broken,
        left_out=tuple(i.id for i in problem.items if i.id not in there),
        conflicts=explain(prepared, state, broken, seed, effort) if explained else (),
        seconds=time.perf_counter() - started,
    )
