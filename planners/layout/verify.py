"""Verify a finished layout with the checker of scene graphs: remove what it rejects, find out which wishes are kept.

Wishes that a scene graph cannot state are judged by the solver's own measures.
"""

from __future__ import annotations

from ...gaussians.world import relations
from ..rooms.check import check
from ..rooms.graph import SceneGraph
from ..rooms.node import Node, NodeId, RoomShape
from .bodies import Prepared
from .problem import Wish
from .state import State

STATED = relations.names("stated")
_UNSOUND = ("collision", "bounds", "support")
Relations = tuple[tuple[NodeId, str, NodeId], ...]


def verified(prepared: Prepared, state: State) -> tuple[SceneGraph, tuple[Wish, ...]]:
    """The graph of a layout without rejected things, with the relations that hold; and all kept wishes."""
    while True:
        graph = _graph(prepared, state)
        asked = tuple(dict.fromkeys((w.subject, w.name, w.objects[0]) for w in _statable(prepared, state)))
        report = check(graph.model_copy(update={"relations": asked}))
        culprits = [v.ids for v in report.violations if v.kind in _UNSOUND]
        if not any(_take_out(prepared, state, ids) for ids in culprits):
            break
    doubtful = {v.ids for v in report.violations if v.kind == "relation"}
    stated = tuple(r for r in asked if (r[0], r[2]) not in doubtful or _holds(graph, r))
    kept = [
        wish
        for row, wish in enumerate(prepared.problem.wishes)
        if (wish.name not in STATED or (wish.subject, wish.name, wish.objects[0]) in stated)
        and ((wish.name in STATED and wish.distance is None) or state.holds(row)[0])
    ]
    return graph.model_copy(update={"relations": stated}), tuple(kept)


def _statable(prepared: Prepared, state: State) -> list[Wish]:
    there = {i.id for i, spot in zip(prepared.items, state.spots, strict=True) if spot is not None}
    return [w for w in prepared.problem.wishes if w.name in STATED and {w.subject, *w.objects} <= there]


def _holds(graph: SceneGraph, relation: tuple[NodeId, str, NodeId]) -> bool:
    """Whether the checker accepts one relation; needed where a pair has several relations and not all of them hold."""
    return not any(v.kind == "relation" for v in check(graph.model_copy(update={"relations": (relation,)})).violations)


def _take_out(prepared: Prepared, state: State, ids: tuple[NodeId, ...]) -> bool:
    """Remove one of these things, if the solver placed any of them, with what it carries; return whether it did."""
    free = [i for i in (prepared.index[n] for n in ids) if prepared.items[i].stand is None and state.spots[i]]
    if not free:
        return False
    least = min(free, key=lambda i: (not prepared.items[i].optional, prepared.area(i), i))
    for i, chain in enumerate(prepared.carriers):
        if i == least or (least in chain and prepared.items[i].stand is None):
            state.take(i)
    return True


def _graph(prepared: Prepared, state: State) -> SceneGraph:
    nodes = []
    for i, item in enumerate(prepared.items):
        if (stand := state.stand(i)) is not None:
            known = item.model_dump(include={"id", "label", "color", "size", "support"})
            nodes.append(Node(**known, position=stand.position, yaw=stand.yaw))
    there = {n.id for n in nodes}
    # A fixed thing whose carrier was not placed hangs in the air: a graph cannot name a carrier that it does not have.
    grounded = [
        n if n.support in ("floor", "wall", "ceiling", *there) else n.model_copy(update={"support": "floor"})
        for n in nodes
    ]
    return SceneGraph(
        room=RoomShape(size=prepared.problem.size, outdoor=prepared.problem.outdoor), nodes=tuple(grounded)
    )
