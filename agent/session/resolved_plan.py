"""Plans and selections as the JSON that scripts read: verdict, steps with their targets, candidates, reason.

Knows the shape of an answer. Refuses to know how it is printed.
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
    from ...planners.plan import EditPlan, Planner
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
    """A selection without its rows."""
    return {
        "verdict": selection.verdict,
        "asked": selection.query.describe(),
        "gaussians": len(selection),
        "groups": list(selection.groups),
        "candidates": [candidate_json(c) for c in selection.candidates],
        "reason": selection.reason,
    }


def resolved_plan(session: Session, text: str, context: str | None = None) -> dict[str, Any]:
    """What an instruction would do in the session's scene; nothing is changed.

    Args:
        context: the instruction before, which says what "it" means.
    """
    started = time.perf_counter()
    session.recall(context)
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
    return {
        "verdict": verdict,
        "steps": steps,
        "candidates": [candidate_json(c) for c in candidates],
        "reason": reason,
        "unknown": list(plan.unknown),
        **planner_json(plan),
        "seconds": round(time.perf_counter() - started, 4),
    }


def planner_json(plan: EditPlan | None) -> dict[str, Any]:
    """Who planned, by which prompt, and what language models were asked for: `usage` is null if none was."""
    if plan is None:
        return {"planner": "", "prompt_hash": "", "usage": None}
    usage = plan.usage.model_dump(mode="json") if plan.usage is not None else None
    return {"planner": plan.planner, "prompt_hash": plan.prompt_hash, "usage": usage}


def refusal_json(error: ScenewrightError, plan: EditPlan | None) -> dict[str, Any]:
    """Who planned what was refused, what that took, and the verdict of an instruction that was read.

    Args:
        plan: what was planned; None if nothing was, though asking in vain may have cost something.
    """
    from ...planners.plan import NoPlanError

    read = isinstance(error, InstructionError | NotUnderstoodError)
    told = {**planner_json(plan), **({"verdict": verdict_of(error)} if read else {})}
    if isinstance(error, NoPlanError) and error.usage is not None:
        told["usage"] = error.usage.model_dump(mode="json")
    return told


def graph_plan(stage: Stage, planner: Planner, text: str, context: str | None = None) -> dict[str, Any]:
    """What an instruction would touch on a scene graph, in the shape of `resolved_plan`; ids are the graph's own.

    A step also has `anchors`, the ids that its place or direction refers to, and `metres` where a distance is said.
    Where a planner that looked at the graph names `groups` in a query, those are rows of the stage (see `StageSight`);
    `targets` and `anchors` are the graph's own ids.
    """
    from ...planners.rooms.plan_on_graph import resolve_text
    from .sight import StageSight

    started = time.perf_counter()
    found = resolve_text(stage, planner, text, context, StageSight(stage))
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
    """A plan of words alone, before any scene was looked at: targets are phrases."""
    return {
        "verdict": plan.verdict,
        "steps": [op.model_dump(mode="json", exclude_none=True) for op in plan.ops],
        "candidates": [],
        "reason": plan.reason,
        "unknown": list(plan.unknown),
        **planner_json(plan),
        "seconds": round(plan.seconds, 4),
    }


def unread(reason: str) -> dict[str, Any]:
    """The answer to words that no planner looked at: too long to be an instruction, or no text."""
    return {
        "verdict": "not_understood", "steps": [], "candidates": [], "reason": reason, "unknown": [],
        **planner_json(None), "seconds": 0.0,
    }  # fmt: skip


def plan_lines(plan: EditPlan) -> list[str]:
    """A plan for a person: one operation a line, without what is left at its default."""
    rows = [{"op": op.op, **op.model_dump(mode="json", exclude_defaults=True)} for op in plan.ops]
    return [json.dumps(row, ensure_ascii=False) for row in rows]


def _step(op: Any, targets: Sequence[int | str]) -> dict[str, Any]:
    fields = op.model_dump(mode="json", exclude_none=True)
    return {"op": fields.pop("op"), "targets": list(targets) if op.query() is not None else [], **fields}
