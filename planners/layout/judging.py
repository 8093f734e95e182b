"""Which wishes a finished layout keeps: the checker's word where a scene graph can state them, our measure otherwise.

Knows both. Refuses to change the layout.
"""

from __future__ import annotations

from ..checking import check
from ..graph import NodeId, SceneGraph
from .bodies import Prepared
from .problem import Wish
from .state import State

STATED = (
    "left_of",
    "right_of",
    "in_front_of",
    "behind",
    "next_to",
    "on",
    "under",
    "above",
    "below",
    "inside",
    "facing",
)
Relations = tuple[tuple[NodeId, str, NodeId], ...]


def kept_wishes(prepared: Prepared, state: State, graph: SceneGraph) -> tuple[tuple[Wish, ...], Relations]:
    """The wishes that hold, and those of them that the graph can state as its relations."""
    there = {n.id for n in graph.nodes}
    kept, stated = list[Wish](), list[tuple[NodeId, str, NodeId]]()
    candidates = [
        w for w in prepared.problem.wishes if w.name in STATED and w.subject in there and w.objects[0] in there
    ]
    by_name = {n: [w for w in candidates if w.name == n] for n in STATED}
    broken = set[tuple[str, NodeId, NodeId]]()
    for name, wishes in by_name.items():
        if wishes:
            asked = graph.model_copy(update={"relations": tuple((w.subject, name, w.objects[0]) for w in wishes)})
            broken |= {(name, v.ids[0], v.ids[1]) for v in check(asked).violations if v.kind == "relation"}
    for row, wish in enumerate(prepared.problem.wishes):
        if wish.name in STATED:
            if wish in candidates and (wish.name, wish.subject, wish.objects[0]) not in broken:
                kept.append(wish)
                stated.append((wish.subject, wish.name, wish.objects[0]))
        elif state.holds(row)[0]:
            kept.append(wish)
    return tuple(kept), tuple(dict.fromkeys(stated))
