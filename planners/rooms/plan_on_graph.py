"""Resolve a plan on a scene graph: the nodes that each step would change, or the verdict that stops it.

No scene is built or edited. impossible.py refuses steps that sizes make impossible.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from ...gaussians.errors import UserError
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...tools.binding import bound_targets, exchanged_likes
from ...tools.operation import EditOp
from ...tools.registry import AnyOp
from ..impossible import Step, StepRefused, metres, refuse_above, refuse_impossible, refuse_part
from ..plan import EditPlan, Movement, Observation, Planner, Verdict
from .graph import SceneGraph
from .graph_scene import Id, Stage

_NEW = "new"  # ids of what a plan adds begin so


@dataclass(frozen=True)
class Resolved:
    """A plan resolved on a graph.

    Attributes:
        verdict: "ok", or why nothing would be done.
        steps: in order; those after the one that failed have no targets.
        candidates: ids of the nodes that an ambiguous phrase may mean, or of the nearest matches of an absent one.
        reason: a sentence for a person; if ok, the words that were read with another spelling.
        plan: the resolved plan.
    """

    verdict: Verdict
    steps: tuple[Step, ...]
    candidates: tuple[Id, ...]
    reason: str
    plan: EditPlan


def resolve_text(
    stage: Stage, planner: Planner, text: str, context: str | None = None, observation: Observation | None = None
) -> Resolved:
    """What an instruction would touch; "it" is what the instruction before (`context`) was about on the same graph.

    What the instruction before took away is not there any more, neither for the words nor for the planner.

    Args:
        observation: the graph as planners may look at it; its ids are the stage's rows.

    Raises:
        UserError: a text is too long to be an instruction.
        BackendError: a language model cannot be reached.
    """
    if not context:
        return resolve_plan(stage, planner.plan(text, observation=observation))
    play = _Play(stage)
    last = play.recall(planner.plan(context, observation=observation))
    if observation is not None and play.gone:
        observation = _Later(observation, play.gone)
    return resolve_plan(play.stage, planner.plan(text, previous=context, observation=observation), last)


@dataclass(frozen=True)
class _Later:
    """An observation after things were taken away; `gone` holds their ids."""

    before: Observation
    gone: frozenset[int]

    def graph(self) -> SceneGraph:
        graph = self.before.graph()
        kept = tuple(
            n.model_copy(update={"support": "floor"}) if n.support in self.gone else n
            for n in graph.nodes
            if n.id not in self.gone
        )
        relations = tuple(r for r in graph.relations if not {r[0], r[2]} & self.gone)
        return graph.model_copy(update={"nodes": kept, "relations": relations})

    def picture(self) -> bytes | None:
        return None  # it would show what is gone

    def moves(self, query: Query) -> bool | None:
        return self.before.moves(query)

    def movement(self, query: Query) -> Movement | None:
        return self.before.movement(query)

    def after(self, ops: Sequence[AnyOp], query: Query) -> Movement | None:
        """As the scene's own."""
        return self.before.after(ops, query)

    def has(self, query: Query) -> bool:
        """As the scene's own."""
        return self.before.has(query)

    def lacks(self, query: Query) -> bool:
        return self.before.lacks(query)


def resolve_plan(stage: Stage, plan: EditPlan, last: Selection | None = None) -> Resolved:
    """What a plan would touch on a graph."""
    if not plan.ops:
        return Resolved(plan.verdict, (), (), plan.reason, plan)
    play = _Play(stage, last)
    steps: list[Step] = []
    bound = bound_targets(plan.ops, stage.find, last)
    early = exchanged_likes(plan.ops, stage.find, last)
    for number, op in enumerate(plan.ops, start=1):
        try:
            settled = _Play(stage, last).settled(op) if number - 1 in early else op
            steps.append(play.step(settled, bound[number - 1]))
        except (StepRefused, UserError) as error:
            where = f"step {number} of {len(plan.ops)} ({op.op}): " if len(plan.ops) > 1 else ""
            verdict: Verdict = error.verdict if isinstance(error, StepRefused) else "not_understood"
            candidates = error.candidates if isinstance(error, StepRefused) else ()
            rest = tuple(Step(o) for o in plan.ops[len(steps) :])
            return Resolved(verdict, (*steps, *rest), candidates, where + str(error), plan)
    return Resolved("ok", tuple(steps), (), "; ".join([*filter(None, [plan.reason]), *_slips(stage, plan)]), plan)


def recalled(stage: Stage, plan: EditPlan) -> Selection | None:
    """What "it" means after a plan, None if that cannot be told."""
    return _Play(stage).recall(plan)


def _slips(stage: Stage, plan: EditPlan) -> list[str]:
    """Notes on misspelt nouns that were read as the label with the nearest spelling."""
    said = dict.fromkeys(text for op in plan.ops for text in _texts(op.model_dump()))
    read = ((text, stage.encoder.meant(text)) for text in said)
    return [f"read “{text}” as {meant}" for text, meant in read if meant]


def _texts(node: Any) -> Iterator[str]:
    """Every noun phrase of the queries in an operation's fields."""
    if isinstance(node, dict):
        if node.get("text"):
            yield str(node["text"])
        node = tuple(node.values())
    if isinstance(node, tuple | list):
        for item in node:
            yield from _texts(item)


@dataclass
class _Play:
    """Applies the steps of one plan to the graph as far as later words depend on it: removed nodes and new colours.

    Attributes:
        stage: as it is after the steps so far.
        last: what "it" means, None for nothing.
        fresh: ids of what was added and "it" now means; empty while it means things of the graph.
    """

    stage: Stage
    last: Selection | None = None
    fresh: tuple[Id, ...] = ()
    added: int = field(default=0)
    gone: frozenset[int] = frozenset()

    def recall(self, plan: EditPlan) -> Selection | None:
        """What "it" means after a plan, and the graph without what the plan took away; something that was to be added
        may be there by now."""
        for op in plan.ops:
            query = op.query() or Query(text=getattr(op, "asset", ""), pick="one")
            try:
                found = self.stage.find(query, self.last)
            except UserError:
                return None
            self.last = found if found.verdict == "found" else None
            if self.last is not None and op.op in ("delete", "isolate"):
                self._take_away(op, self.last.groups)
        return self.last

    def _take_away(self, op: EditOp, groups: Iterable[int]) -> None:
        """Remove what an operation on these groups removes."""
        field_ = self.stage.scene.language
        assert field_ is not None
        kept = set(groups)
        away = kept if op.op != "isolate" else {g.id for g in field_.groups if g.id not in kept}
        self.gone |= away
        self.stage = self.stage.without(away)

    def step(self, op: EditOp, bound: Selection | None = None) -> Step:
        """The operation with what it would touch.

        Args:
            bound: what it is about, if that was found before the first step.

        Raises:
            StepRefused: something is absent, ambiguous or cannot be.
            UserError: a word is unknown.
        """
        op = self.settled(op)
        query = op.query()
        about_fresh = query is not None and query.last and bool(self.fresh)
        there = None if bound is None else tuple(g for g in bound.groups if g not in self.gone)
        if bound is not None and there:
            chosen: Selection | None = replace(bound, groups=there)
        else:
            chosen = None if query is None or about_fresh else self._target(op, query)
        anchors = self._anchors(op)
        targets = self.fresh if about_fresh else self.stage.names(chosen.groups) if chosen is not None else ()
        step = Step(op, targets, self.stage.names(g for a in anchors for g in a.groups), metres(op))
        refuse_above(self.stage, step, chosen)
        if chosen is not None:
            refuse_impossible(self.stage, step, chosen, anchors)
        self._after(op, chosen)
        return step

    def settled(self, op: EditOp) -> EditOp:
        """The operation with the colour of the thing that it is to be like; a surface is not known here."""
        like: Query | None = getattr(op, "like", None)
        if like is None:
            return op
        if op.op == "restyle":
            self._found(like)
            return op
        colors = list(dict.fromkeys(self.stage.color(g) for g in self._found(like).groups))
        if len(colors) > 1 or not colors[0]:
            raise StepRefused("ambiguous", f"{like.describe()} has no single colour that is known; name the colour")
        return op.model_copy(update={"color": colors[0], "like": None})

    def _found(self, query: Query) -> Selection:
        found = self.stage.find(query, self.last)
        if found.verdict == "found":
            return found
        named = self.stage.names(c.group for c in found.candidates if c.group >= 0)
        near = named if found.verdict == "ambiguous" else named[:3]
        raise StepRefused(
            "ambiguous" if found.verdict == "ambiguous" else "absent", self.stage.told(found.reason), near
        )

    def _target(self, op: EditOp, query: Query) -> Selection:
        """What an operation changes."""
        try:
            return self._found(query)
        except StepRefused as error:
            if error.verdict == "absent":
                refuse_part(self.stage, Step(op), self.last)
            raise

    def _anchors(self, op: EditOp) -> list[Selection]:
        """What its place or direction refers to; things added by this plan have no place of their own yet."""
        place, toward = getattr(op, "place", None), getattr(op, "toward", None)
        queries = [*(place.anchors if place is not None else ()), *([toward] if toward is not None else [])]
        return [self._found(q) for q in queries if not (q.last and self.fresh)]

    def _after(self, op: EditOp, chosen: Selection | None) -> None:
        """What "it" means next, and what the words of the next step meet."""
        groups = chosen.groups if chosen is not None else ()
        if op.op in ("insert", "replace", "duplicate"):
            self.added += 1
            self.last, self.fresh = None, (f"{_NEW} {self.added}",)
        elif chosen is not None:
            self.last, self.fresh = chosen, ()
        if op.op in ("delete", "replace") or (op.op == "isolate" and chosen is not None):
            self._take_away(op, groups)
        elif op.op == "recolor" and getattr(op, "adjust", None) is None:
            self.stage = self.stage.painted(groups, str(getattr(op, "color", "")))
