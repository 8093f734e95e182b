"""The layout solver's door: a problem in, a scene graph out, with what was kept and why the rest was not.

Knows how a finished search becomes a graph. Refuses to know how it was found (search).
"""

from __future__ import annotations

import time

from ..graph import Node, RoomShape, SceneGraph
from .bodies import Prepared
from .judging import kept_wishes
from .problem import Layout, Problem
from .search import Search


def solve(problem: Problem, seed: int = 0, *, effort: float = 1.0) -> Layout:
    """Place things in a room.

    Args:
        problem: the room, the things and the wishes.
        seed: the same problem and seed give the same layout.
        effort: how long to search; 1 is usual, 0 takes the first layout.
    """
    started = time.perf_counter()
    prepared = Prepared.of(problem)
    state = Search(prepared, seed, effort).run()
    nodes = []
    for i, item in enumerate(prepared.items):
        stand = state.stand(i)
        if stand is not None:
            nodes.append(
                Node(
                    id=item.id,
                    label=item.label,
                    color=item.color,
                    size=item.size,
                    position=stand.position,
                    yaw=stand.yaw,
                    support=item.support,
                )
            )
    graph = SceneGraph(room=RoomShape(size=problem.size), nodes=tuple(nodes))
    kept, stated = kept_wishes(prepared, state, graph)
    graph = graph.model_copy(update={"relations": stated})
    there = {n.id for n in nodes}
    return Layout(
        graph=graph,
        kept=kept,
        broken=tuple(w for w in problem.wishes if w not in kept),
        left_out=tuple(i.id for i in problem.items if i.id not in there),
        seconds=time.perf_counter() - started,
    )
