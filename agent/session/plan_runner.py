"""Runs a plan on a state, operation by operation, and returns the new state; a failed plan changes nothing."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from ...gaussians.errors import ScenewrightError
from ...gaussians.language.query.nested import queries
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from .history import State
from .refusal import open_verdict, with_message

if TYPE_CHECKING:
    from ...gaussians.language.query.query import Query
    from ...planners.plan import EditPlan
    from ...tools.operation import Context
    from ...tools.receipt import Receipt
    from .clarify import Question
    from .judge import Judge


class PlanFailed(Exception):
    """An operation failed, and with it the plan.

    Attributes:
        error: the operation's error.
        question: the query that an answer of the user would settle; None if there is none.
    """

    def __init__(self, error: ScenewrightError, question: Question | None) -> None:
        super().__init__(str(error))
        self.error = error
        self.question = question


def has_queries(plan: EditPlan) -> bool:
    """Whether any operation has a query that must be resolved in the scene."""
    return any(True for op in plan.ops for _ in queries(op))


def run_plan(
    plan: EditPlan,
    start: State,
    context_of: Callable[[Selection | None], Context],
    *,
    dry_run: bool,
    judge: Judge | None,
) -> tuple[State, tuple[Receipt, ...]]:
    """The state after a plan, and a receipt for each operation.

    Args:
        context_of: makes the context of an operation from the selection that "it" refers to.
        dry_run: mark the receipts as a dry run.
        judge: judges each operation after it was carried out; None: nobody does.

    Raises:
        PlanFailed: an operation cannot be done, failed its own check, or was judged a failure.
    """
    from ...tools import execute
    from ...tools.binding import bound_targets, exchanged_likes
    from ...tools.ops.reframe import of_everything
    from ...tools.timing.through_time import carry_through_time

    words = plan.instruction if len(plan.ops) == 1 else ""
    carry_out = execute.carry_out if judge is None else partial(judge.carry_out, instruction=words)

    def before(query: Query, it: Selection | None) -> Selection:
        return context_of(it).resolve(start.scene, query)

    scene, last = start.scene, start.last
    bound = bound_targets(plan.ops, before, start.last)
    early = exchanged_likes(plan.ops, before, start.last)
    receipts: list[Receipt] = []
    for step, op in enumerate(plan.ops):
        context = context_of(last)
        try:
            op = of_everything(op)
            if step in early:
                op = op.settled(start.scene, context_of(start.last))
            scene, receipt, last, _ = carry_through_time(scene, op, context, bound[step], carry_out)
        except ScenewrightError as error:
            raise PlanFailed(_in_plan(error, plan, step), _question(plan, step, error, scene, context)) from error
        receipts.append(
            receipt.model_copy(update={"backends": {**receipt.backends, "planner": plan.planner}, "dry_run": dry_run})
        )
    if judge is not None and len(plan.ops) > 1:
        try:
            receipts = judge.look_at_all(start.scene, scene, plan.instruction, receipts)
        except ScenewrightError as error:
            raise PlanFailed(error, None) from error
    pointed = start.pointed if scene.cloud is start.scene.cloud else {}  # group ids and places may differ after an edit
    told = tuple(receipts)
    return State(scene, last, plan.instruction, plan.instruction, pointed, plan, told), told


def _question(plan: EditPlan, step: int, error: ScenewrightError, scene: Scene, context: Context) -> Question | None:
    verdict = open_verdict(error)
    if verdict is None:
        return None
    from .clarify import find_question

    return find_question(plan, step, verdict, lambda query: context.resolve(scene, query))


def _in_plan(error: ScenewrightError, plan: EditPlan, step: int) -> ScenewrightError:
    """The error; of a compound plan, with the failed step and the statement that nothing was changed."""
    if len(plan.ops) == 1:
        return error
    where = f"step {step + 1} of {len(plan.ops)} ({plan.ops[step].op}) failed, nothing was changed"
    return with_message(error, f"{where}: {error}")
