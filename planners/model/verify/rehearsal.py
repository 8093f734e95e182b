"""Dry run of a model's plan on the scene graph: what each operation would touch, and what its ids refer to.

Queries name nodes by the graph's ids, the graph scene by rows. The graph has sanitised names, so that all texts made
here may be sent to the model. `guard.py` turns the results into faults.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property

from ....gaussians.errors import UserError
from ....gaussians.language.query.nested import queries, with_queries
from ....gaussians.language.query.query import Query
from ....gaussians.language.query.selection import Selection
from ....tools.operation import EditOp
from ...plan import EditPlan, Planner
from ...rooms.graph import SceneGraph
from ...rooms.graph_scene import Id, Stage
from ...rooms.label_encoder import THRESHOLD, agreement
from ...rooms.node import Node
from ...rooms.plan_on_graph import Resolved, recalled, resolve_plan
from ..prompt.pruning import line

_NEAR = 5  # nodes suggested instead of a missing one
_SHOWN = 12  # candidates shown


class Rehearsal:
    """Dry runs on one graph.

    Args:
        graph: with sanitised names.
        previous: the previous instruction, if any.
        recall: plans the previous instruction, to resolve "it".
    """

    def __init__(self, graph: SceneGraph, previous: str | None, recall: Planner) -> None:
        self.graph = graph
        self._previous = previous
        self._recall = recall

    @cached_property
    def stage(self) -> Stage:
        return Stage.of(self.graph)

    @cached_property
    def rows(self) -> dict[int, int]:
        """The stage's row of each id that a query may name."""
        return {node.id: row for row, node in enumerate(self.graph.nodes) if isinstance(node.id, int)}

    @cached_property
    def last(self) -> Selection | None:
        """What "it" refers to, None if that is unknown."""
        if not self._previous:
            return None
        try:
            return recalled(self.stage, self._recall.plan(self._previous))
        except UserError:
            return None

    @property
    def last_ids(self) -> tuple[Id, ...]:
        """Ids of what "it" refers to."""
        return self.stage.names(self.last.groups) if self.last is not None else ()

    def dry_run(self, ops: Sequence[EditOp]) -> Resolved | None:
        """What the operations would touch; None if they refer to an "it" that is unknown. All ids must exist."""
        if self.last is None and any(q.last for _, q in queries(tuple(ops[:1]))):
            return None
        staged = tuple(with_queries(op, self._with_rows) for op in ops)
        return resolve_plan(self.stage, EditPlan(instruction="", ops=staged, planner=""), self.last)

    def missing_ids(self, query: Query) -> list[int]:
        """Ids that the query names and the graph does not have."""
        return [i for i in query.groups if i not in self.rows]

    def alternatives(self, query: Query, missing: int) -> list[Node]:
        """Nodes that may be meant instead of a missing id: those that the query's text fits, else those with the
        nearest ids."""
        nodes = [n for n in self.graph.nodes if isinstance(n.id, int)]
        fits = _fitting_labels(query, nodes)
        named = [n for n in nodes if n.label in fits]
        return (named or sorted(nodes, key=lambda n: (abs(int(n.id) - missing), n.id)))[:_NEAR]

    def misnamed(self, query: Query) -> Node | None:
        """A node that the query names by id while its text fits only other things of the scene."""
        fits = _fitting_labels(query, self.graph.nodes)
        named = (self.graph.nodes[self.rows[i]] for i in query.groups if i in self.rows)
        return next((n for n in named if fits and n.label and n.label not in fits), None)

    def label(self, id: int) -> str:
        """Label of the node with this id, "" if it has none."""
        return self.graph.nodes[self.rows[id]].label

    def by_words(self, query: Query) -> tuple[Id, ...]:
        """Ids of all nodes that the words of a query fit, ignoring its ids and its choice among several."""
        words = query.model_copy(update={"groups": (), "also": (), "pick": "all", "count": None, "ordinal": None})
        try:
            found = self.stage.find(with_queries(words, self._with_rows), self.last)
        except UserError:
            return ()
        return self.stage.names(found.groups) if found.verdict == "found" else ()

    def by_query(self, query: Query) -> tuple[Id, ...]:
        """Ids of the nodes that a query means; nothing if that is not clear."""
        try:
            found = self.stage.find(query, self.last)
        except UserError:
            return ()
        return self.stage.names(found.groups) if found.verdict == "found" else ()

    def shown(self, ids: Iterable[Id]) -> str:
        """Some nodes as lines of text for the model."""
        nodes = {n.id: n for n in self.graph.nodes}
        lines = [line(nodes[i]) for i in ids if i in nodes]
        more = [f"and {len(lines) - _SHOWN} more"] if len(lines) > _SHOWN else []
        return "\n".join([*lines[:_SHOWN], *more])

    def _with_rows(self, query: Query) -> Query:
        if not query.groups:
            return query
        return query.model_copy(update={"groups": tuple(self.rows[i] for i in query.groups)})


def _fitting_labels(query: Query, nodes: Sequence[Node]) -> set[str]:
    """Labels that the text of a query fits."""
    labels = sorted({n.label for n in nodes if n.label})
    return {label for label, p in zip(labels, agreement(query.text, labels), strict=True) if p >= THRESHOLD}
