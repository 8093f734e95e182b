"""A plan on a scene graph: for every step the nodes it would touch, or the verdict that stops it. Nothing is built.

Knows plans, the stage that a graph becomes, and what cannot be because of sizes: a sofa in a vase, a table on the mug
that stands on it, a step out of the room. Refuses to know how words are read and how queries are resolved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from ..gaussians.errors import InstructionError, UserError
from ..gaussians.language.query import Query
from ..gaussians.language.selection import Selection
from ..tools.base import METRES, EditOp, Length
from ..tools.ops.scale import Scale
from .plan import EditPlan, Planner, Sight, Verdict
from .stage import Id, Stage

MAKES_PLACE = ("delete", "move", "rotate", "scale", "duplicate", "replace")  # what floor, walls and ceiling forbid
_NEW = "new"  # ids of what a plan adds begin so


class _Stopped(InstructionError):
    """A step cannot be done; `verdict` says why."""

    def __init__(self, verdict: Verdict, reason: str, candidates: Sequence[Id] = ()) -> None:
        super().__init__(reason)
        self.verdict: Verdict = verdict
        self.candidates = tuple(candidates)


@dataclass(frozen=True)
class Step:
    """One operation and what it would touch.

    Attributes:
        op: as planned.
        targets: ids of the nodes it changes; of what an earlier step adds, "new 1", "new 2", …
        anchors: ids of what its place or direction refers to.
        metres: how far it moves, where it says so.
    """

    op: EditOp
    targets: tuple[Id, ...] = ()
    anchors: tuple[Id, ...] = ()
    metres: float | None = None


@dataclass(frozen=True)
class Resolved:
    """A plan met with a graph.

    Attributes:
        verdict: "ok", or why nothing would be done.
        steps: in order; those behind the one that stopped it have no targets.
        candidates: ids: what an ambiguous phrase hesitates between, or what is nearest to an absent one.
        reason: a sentence for a person; if ok, what was read otherwise than it was written.
        plan: what was resolved.
    """

    verdict: Verdict
    steps: tuple[Step, ...]
    candidates: tuple[Id, ...]
    reason: str
    plan: EditPlan


def resolve_text(
    stage: Stage, planner: Planner, text: str, context: str | None = None, sight: Sight | None = None
) -> Resolved:
    """What an instruction would touch; "it" is what the instruction before (`context`) was about on the same graph.

    Args:
        sight: the graph as planners may look at it; its ids are the stage's rows.

    Raises:
        UserError: a text is too long to be an instruction.
        BackendError: a language model cannot be reached.
    """
    last = recalled(stage, planner.plan(context, sight=sight)) if context else None
    return resolve_plan(stage, planner.plan(text, previous=context, sight=sight), last)


def resolve_plan(stage: Stage, plan: EditPlan, last: Selection | None = None) -> Resolved:
    """What a plan would touch on a graph."""
    if not plan.ops:
        return Resolved(plan.verdict, (), (), plan.reason, plan)
    play = _Play(stage, last)
    steps: list[Step] = []
    for number, op in enumerate(plan.ops, start=1):
        try:
            steps.append(play.step(op))
        except (_Stopped, UserError) as error:
            where = f"step {number} of {len(plan.ops)} ({op.op}): " if len(plan.ops) > 1 else ""
            verdict: Verdict = error.verdict if isinstance(error, _Stopped) else "not_understood"
            candidates = error.candidates if isinstance(error, _Stopped) else ()
            rest = tuple(Step(o) for o in plan.ops[len(steps) :])
            return Resolved(verdict, (*steps, *rest), candidates, where + str(error), plan)
    return Resolved("ok", tuple(steps), (), "; ".join([*filter(None, [plan.reason]), *_slips(stage, plan)]), plan)


def recalled(stage: Stage, plan: EditPlan) -> Selection | None:
    """What "it" means after a plan, None if that cannot be told."""
    return _Play(stage).recall(plan)


def _slips(stage: Stage, plan: EditPlan) -> list[str]:
    """Remarks on nouns that were read as the one thing here that is spelt almost so."""
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
    """The steps of one plan, played on the stage as far as words can tell: what is gone, what has a new colour.

    Attributes:
        stage: as it is after the steps so far.
        last: what "it" means, None for nothing.
        fresh: ids of what was added and "it" now means; empty while it means things of the graph.
    """

    stage: Stage
    last: Selection | None = None
    fresh: tuple[Id, ...] = ()
    added: int = field(default=0)

    def recall(self, plan: EditPlan) -> Selection | None:
        """What "it" means after a plan, with the graph as it is; something that was to be added may be there by now."""
        for op in plan.ops:
            query = op.query() or Query(text=getattr(op, "asset", ""), pick="one")
            try:
                found = self.stage.find(query, self.last)
            except UserError:
                return None
            self.last = found if found.verdict == "found" else None
        return self.last

    def step(self, op: EditOp) -> Step:
        """The operation with what it would touch.

        Raises:
            _Stopped: something is absent, ambiguous or cannot be.
            UserError: a word is unknown.
        """
        query = op.query()
        about_fresh = query is not None and query.last and bool(self.fresh)
        chosen = None if query is None or about_fresh else self._found(query)
        anchors = self._anchors(op)
        targets = self.fresh if about_fresh else self.stage.names(chosen.groups) if chosen is not None else ()
        step = Step(op, targets, self.stage.names(g for a in anchors for g in a.groups), metres(op))
        if chosen is not None:
            _refuse_impossible(self.stage, step, chosen, anchors)
        self._after(op, chosen)
        return step

    def _found(self, query: Query) -> Selection:
        found = self.stage.find(query, self.last)
        if found.verdict == "found":
            return found
        named = self.stage.names(c.group for c in found.candidates if c.group >= 0)
        near = named if found.verdict == "ambiguous" else named[:3]
        raise _Stopped("ambiguous" if found.verdict == "ambiguous" else "absent", self.stage.told(found.reason), near)

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
        if op.op in ("delete", "replace"):
            self.stage = self.stage.without(groups)
        elif op.op == "isolate" and chosen is not None:
            field_ = self.stage.scene.language
            assert field_ is not None
            self.stage = self.stage.without(g.id for g in field_.groups if g.id not in groups)
        elif op.op == "recolor" and getattr(op, "adjust", None) is None:
            self.stage = self.stage.painted(groups, str(getattr(op, "color", "")))


def metres(op: EditOp) -> float | None:
    """The distance an operation says, in metres; a graph's units are metres."""
    length: Length | None = getattr(op, "distance", None) or getattr(op, "height", None)
    return None if length is None else round(length.value * METRES.get(length.unit, 1.0), 9)


def _refuse_impossible(stage: Stage, step: Step, chosen: Selection, anchors: Sequence[Selection]) -> None:
    """Raise if sizes and supports forbid the step.

    Raises:
        _Stopped: they do.
    """
    shell = [g for g in chosen.groups if stage.group(g).level == "structure"]
    if shell and step.op.op in MAKES_PLACE:
        raise _Stopped("impossible", f"the {stage.group(shell[0]).label} stays: {step.op.op} is for things in the room")
    room = stage.graph.room.size
    if step.metres is not None and step.op.op == "move" and step.metres > sum(s * s for s in room) ** 0.5:
        raise _Stopped("impossible", f"{step.metres:g} m leads out of a room of {room[0]:g} x {room[1]:g} m")
    if step.op.op == "scale":
        _refuse_size(stage, step, chosen)
    relation = getattr(getattr(step.op, "place", None), "relation", "")
    check = {"inside": _too_large_inside, "on": _too_large_on}.get(relation)
    for anchor in (g for a in anchors for g in a.groups):
        for target in chosen.groups:
            _refuse_place(stage, target, anchor, check)


def _refuse_size(stage: Stage, step: Step, chosen: Selection) -> None:
    """Raise if something would outgrow the room."""
    assert isinstance(step.op, Scale)
    axis, length = step.op.axis, step.op.length
    for group in (stage.group(g) for g in chosen.groups):
        sides = {"height": group.box.size[2:], "width": group.box.size[:2], "depth": group.box.size[:2]}
        factor = step.op.factor or 1.0
        if length is not None:
            factor = length[1].value * METRES.get(length[1].unit, 1.0) / max(sides[length[0]])
        most = max(sides.get(axis, group.box.size)) * factor
        if factor > 1 and most > 2 * max(stage.graph.room.size):
            raise _Stopped("impossible", f"{group.label} would be {most:.3g} m large, which no room of this size holds")


def _refuse_place(stage: Stage, target: int, anchor: int, check: Callable[[Stage, int, int], bool] | None) -> None:
    name, other = stage.group(target).label, stage.group(anchor).label
    if target == anchor:
        raise _Stopped("impossible", f"{name} cannot be put relative to itself")
    if check is None or stage.group(anchor).level == "structure":
        return
    if _stands_on(stage, anchor, target):
        raise _Stopped("impossible", f"{other} stands on {name}, so {name} cannot go on it")
    if check(stage, target, anchor):
        raise _Stopped("impossible", f"{name} is too large to go on or into {other}")


def _too_large_inside(stage: Stage, target: int, anchor: int) -> bool:
    """Whether the two smaller extents of a thing exceed those of what is to hold it; its length may stick out."""
    thing, holder = (sorted(stage.group(g).box.size) for g in (target, anchor))
    return thing[0] > holder[1] or thing[1] > holder[2]


def _too_large_on(stage: Stage, target: int, anchor: int) -> bool:
    """Whether even the shorter side of a thing's footprint is twice the longer one of what is to carry it."""
    return min(stage.group(target).box.size[:2]) > 2 * max(stage.group(anchor).box.size[:2])


def _stands_on(stage: Stage, upper: int, lower: int) -> bool:
    """Whether `upper` stands on `lower`, directly or on something that does."""
    supports: dict[Any, Id] = {n.id: n.support for n in stage.graph.nodes}
    at, seen = stage.ids[upper], set[Id]()
    while at in supports and at not in seen:
        seen.add(at)
        at = supports[at]
        if at == stage.ids[lower]:
            return True
    return False
