"""The layout solver's door: a problem in, a scene graph out, with what was kept and why the rest was not.

Knows the order of the steps: prepare, search, judge, explain. Refuses to know how any of them is done.
"""

from __future__ import annotations

import time

from .bodies import Prepared
from .conflicts import explain
from .judging import judged
from .problem import Layout, Problem
from .search import Search


def solve(problem: Problem, seed: int = 0, *, effort: float = 1.0) -> Layout:
    """Place things in a room so that they are free, supported, reached and as was wished.

    Args:
        problem: the room, the things and the wishes; things with a `stand` stay there whatever else is wrong.
        seed: the same problem, seed and effort give the same layout, but for the seconds it took.
        effort: how long to search; 1 is usual, 0 takes the first layout.
    """
    started = time.perf_counter()
    prepared = Prepared.of(problem)
    state = Search(prepared, seed, effort).run()
    graph, kept = judged(prepared, state)
    broken = tuple(w for w in problem.wishes if w not in kept)
    there = {n.id for n in graph.nodes}
    return Layout(
        graph=graph,
        kept=kept,
        broken=broken,
        left_out=tuple(i.id for i in problem.items if i.id not in there),
        conflicts=explain(prepared, state, broken, seed, effort),
        seconds=time.perf_counter() - started,
    )
