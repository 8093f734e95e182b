"""Plans, selections, refusals and model usage as the JSON that scripts read and as lines for a person.

`resolved_plan` and `graph_plan` also resolve the targets of a plan, in a scene or on a scene graph.
"""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ...gaussians.errors import InstructionError, ScenewrightError, UserError
from ...gaussians.language.query.selection import Candidate, Selection
from .refusal import NotUnderstoodError, verdict_of

if TYPE_CHECKING:
    from ...planners.impossible import Step
    from ...planners.plan import EditPlan, Planner, Usage
    from ...planners.rooms.graph_scene import Stage
    from .session import Session


def candidate_json(candidate: Candidate) -> dict[str, Any]:
    """A candidate with each term's score."""
    return {
        "group": candidate.group,
        "label": candidate.label,
        "color": candidate.color,
        "center": [round(c, 4) for c in candidate.center],
        "size": [round(s, 4) for s in candidate.size],
        "score": round(candidate.score, 4),
        "terms": {name: round(value, 4) for name, value in candidate.terms.items()},
    }


def selection_json(selection: Selection) -> dict[str, Any]:
    """A selection without the rows of its Gaussians."""
    return {
        "verdict": selection.verdict,
        "asked": selection.query.describe(),
        "gaussians": len(selection),
        "groups": list(selection.groups),
        "candidates": [candidate_json(c) for c in selection.candidates],
        "reason": selection.reason,
    }


def resolved_plan(session: Session, text: str, context: str | None = None) -> dict[str, Any]:
    """The plan of an instruction with its targets resolved in the session's scene; nothing is edited.

    Args:
        context: the previous instruction, whose target "it" refers to, and after which the scene is looked at.
    """
    started = time.perf_counter()
    changed = _carried_out(session, context)
    try:
        plan, told = _resolved(session, text)
    finally:
        if changed:
            session.undo()
    return {**told, **planner_json(plan), "seconds": round(time.perf_counter() - started, 4)}


def _carried_out(session: Session, context: str | None) -> bool:
    """Carry out the instruction before, as the grammar reads it, so that what it deleted is not there.

    Where that cannot be done, "it" is what it was about, if that can be told. Returns whether the scene changed.
    """
    from ...planners.grammar import GrammarPlanner

    session.recall(context)
    plan = GrammarPlanner().plan(context) if context else None
    if plan is None or all(op.op == "select" for op in plan.ops):
        return False
    try:
        session.apply(plan)
    except ScenewrightError:
        session.recall(context)
        return False
    return True


def _resolved(session: Session, text: str) -> tuple[EditPlan, dict[str, Any]]:
    """The plan of an instruction, and its verdict, steps and candidates in the session's scene as it is."""
    plan = session.plan(text)
    steps: list[dict[str, Any]] = []
    verdict, reason = "ok", plan.reason
    try:
        receipts = session.preview(plan).receipts
        steps = [_step(op, r.selection.groups) for op, r in zip(plan.ops, receipts, strict=True)]
    except (InstructionError, UserError) as error:
        verdict, reason = verdict_of(error), str(error)
        steps = [_step(op, ()) for op in plan.ops]
    candidates = session.question.candidates if session.question else ()
    return plan, {
        "verdict": verdict,
        "steps": steps,
        "candidates": [candidate_json(c) for c in candidates],
        "reason": reason,
        "unknown": list(plan.unknown),
    }


def planner_json(plan: EditPlan | None) -> dict[str, Any]:
    """The planner, its prompt hash and the usage of language models; `usage` is null if no model was asked."""
    if plan is None:
        return {"planner": "", "prompt_hash": "", "usage": None}
    usage = plan.usage.model_dump(mode="json") if plan.usage is not None else None
    return {"planner": plan.planner, "prompt_hash": plan.prompt_hash, "usage": usage}


def refusal_json(error: ScenewrightError, plan: EditPlan | None) -> dict[str, Any]:
    """The planner and usage of a refused instruction, and the verdict if the instruction could be read.

    Args:
        plan: the plan; None if there is none. The usage of a model that gave no plan is then taken from the error.
    """
    from ...planners.plan import NoPlanError

    read = isinstance(error, InstructionError | NotUnderstoodError)
    data = {**planner_json(plan), **({"verdict": verdict_of(error)} if read else {})}
    if isinstance(error, NoPlanError) and error.usage is not None:
        data["usage"] = error.usage.model_dump(mode="json")
    return data


def graph_plan(stage: Stage, planner: Planner, text: str, context: str | None = None) -> dict[str, Any]:
    """The plan of an instruction with its targets resolved on a scene graph, in the format of `resolved_plan`.

    A step also has `anchors`, the ids that its place or direction refers to, and `metres` where a distance is given.
    Where a planner that looked at the graph names `groups` in a query, those are rows of the stage (see
    `GraphObservation`); `targets` and `anchors` are the graph's own ids.
    """
    from ...planners.rooms.plan_on_graph import resolve_text
    from .observation import GraphObservation

    started = time.perf_counter()
    found = resolve_text(stage, planner, text, context, GraphObservation(stage))
    nodes = {n.id: n for n in stage.graph.nodes}
    known = [nodes[i] for i in found.candidates if i in nodes]
    return {
        "verdict": found.verdict,
        "steps": [_graph_step(step) for step in found.steps],
        "candidates": [{"id": n.id, "label": n.label, "color": n.color} for n in known],
        "reason": found.reason,
        "unknown": list(found.plan.unknown),
        **planner_json(found.plan),
        "seconds": round(time.perf_counter() - started, 4),
    }


def _graph_step(step: Step) -> dict[str, Any]:
    more: dict[str, Any] = {"anchors": list(step.anchors)} if step.anchors else {}
    if step.metres is not None:
        more["metres"] = step.metres
    return {**_step(step.op, step.targets), **more}


def plan_json(plan: EditPlan) -> dict[str, Any]:
    """A plan made without a scene: its targets are queries that are not resolved."""
    return {
        "verdict": plan.verdict,
        "steps": [op.model_dump(mode="json", exclude_none=True) for op in plan.ops],
        "candidates": [],
        "reason": plan.reason,
        "unknown": list(plan.unknown),
        **planner_json(plan),
        "seconds": round(plan.seconds, 4),
    }


def rejected_json(reason: str) -> dict[str, Any]:
    """The answer to a text that was rejected before planning: too long, or not valid Unicode."""
    return {
        "verdict": "not_understood", "steps": [], "candidates": [], "reason": reason, "unknown": [],
        **planner_json(None), "seconds": 0.0,
    }  # fmt: skip


def plan_lines(plan: EditPlan) -> list[str]:
    """A plan for a person: one operation a line, without fields at their default."""
    rows = [{"op": op.op, **op.model_dump(mode="json", exclude_defaults=True)} for op in plan.ops]
    return [json.dumps(row, ensure_ascii=False) for row in rows]


def usage_lines(plan: EditPlan | None) -> tuple[str, ...]:
    """One line such as "planned by openai:gpt-5 in 1.2 s, 1,830 tokens, $0.0040"; none if no model was asked."""
    if plan is None or plan.usage is None:
        return ()
    verb = "planned by" if plan.planner == plan.usage.model else "asked"
    return (f"{verb} {plan.usage.model} {format_usage(plan.usage)}",)


def format_usage(usage: Usage) -> str:
    """ "in 1.2 s, 1,830 tokens, $0.0040"; dollars where a price is known."""
    parts = [f"in {usage.seconds:.1f} s"]
    if usage.requests > 1:
        parts.append(f"{usage.requests} requests")
    if tokens := usage.input_tokens + usage.output_tokens:
        parts.append(f"{tokens:,} tokens")
    if usage.dollars is not None:
        parts.append(f"${usage.dollars:.4f}")
    if usage.prompt is not None and not usage.prompt.whole:
        parts.append(usage.prompt.describe())
    return ", ".join(parts)


def _step(op: Any, targets: Sequence[int | str]) -> dict[str, Any]:
    fields = op.model_dump(mode="json", exclude_none=True)
    return {"op": fields.pop("op"), "targets": list(targets) if op.query() is not None else [], **fields}
