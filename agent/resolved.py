"""Plans and selections as the JSON that scripts read: verdict, steps with their targets, candidates, reason.

Knows the shape of an answer. Refuses to know how it is printed.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from ..gaussians.errors import AbsentError, AmbiguousError, InstructionError, ScenewrightError, UserError
from ..gaussians.language.selection import Candidate, Selection

if TYPE_CHECKING:
    from ..planners.plan import EditPlan
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
    plan: EditPlan | None = None
    steps: list[dict[str, Any]] = []
    verdict, reason = "ok", ""
    try:
        session.recall(context)
        plan = session.plan(text)
        receipts = session.preview(plan).receipts
        steps = [_step(op, r.selection.groups) for op, r in zip(plan.ops, receipts, strict=True)]
    except ScenewrightError as error:
        verdict, reason = verdict_of(error), str(error)
        steps = [_step(op, ()) for op in plan.ops] if plan is not None else []
    question = session.question
    return {
        "verdict": verdict,
        "steps": steps,
        "candidates": [candidate_json(c) for c in question.candidates] if question else [],
        "reason": reason,
        "planner": plan.planner if plan is not None else "grammar",
        "seconds": round(time.perf_counter() - started, 4),
    }


def verdict_of(error: ScenewrightError) -> str:
    """The one word for why an instruction was not carried out."""
    own = getattr(error, "verdict", None)  # a planner's error says it itself: "not_an_edit", "unsafe", ...
    if isinstance(own, str):
        return own
    for kind, verdict in ((AbsentError, "absent"), (AmbiguousError, "ambiguous"), (InstructionError, "impossible")):
        if isinstance(error, kind):
            return verdict
    if isinstance(error, UserError):
        return "not_understood"
    raise error


def _step(op: Any, targets: tuple[int, ...]) -> dict[str, Any]:
    fields = op.model_dump(mode="json", exclude_none=True)
    return {"op": fields.pop("op"), "targets": list(targets) if op.query() is not None else [], **fields}
