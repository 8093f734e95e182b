"""A plan carried out on a state, operation by operation: the state it leads to, or where and why it stopped.

Knows the order of a plan and what only a session can tell a receipt. Refuses to keep anything: a plan that stops
halfway leaves the state that it began from.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from ...gaussians.errors import AbsentError, AmbiguousError, ScenewrightError
from ...gaussians.language.query.nested import queries
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from .clarify import Question, find_question
from .history import State
from .refusal import retold

if TYPE_CHECKING:
    from ...planners.plan import EditPlan
    from ...tools.operation import Context
    from ...tools.receipt import Receipt


class Stopped(Exception):  # no error of its own: it carries one, and what can be asked about it
    """An operation failed, and with it the plan; `question` is what an answer would settle, None if none would."""

    def __init__(self, error: ScenewrightError, question: Question | None) -> None:
        super().__init__(str(error))
        self.error = error
        self.question = question


def names_things(plan: EditPlan) -> bool:
    """Whether any operation is about something that has to be found in the scene."""
    return any(True for op in plan.ops for _ in queries(op))


def carry_out(
    plan: EditPlan, start: State, context_of: Callable[[Selection | None], Context], *, dry_run: bool
) -> tuple[State, tuple[Receipt, ...]]:
    """The state that a plan leads to, and a receipt for each operation.

    Args:
        context_of: what an operation is given where "it" means the selection.
        dry_run: receipts say that nothing was kept.

    Raises:
        Stopped: an operation cannot be done, or failed its own check.
    """
    from ...tools import execute

    scene, last = start.scene, start.last
    receipts: list[Receipt] = []
    for step, op in enumerate(plan.ops):
        context = context_of(last)
        try:
            scene, receipt, last = execute.carry_out(scene, op, context)
        except ScenewrightError as error:
            raise Stopped(_in_plan(error, plan, step), _question(plan, step, error, scene, context)) from error
        receipts.append(_signed(receipt, plan, dry_run))
    return State(scene, last, plan.instruction, plan.instruction), tuple(receipts)


def _question(plan: EditPlan, step: int, error: ScenewrightError, scene: Scene, context: Context) -> Question | None:
    if not isinstance(error, AmbiguousError | AbsentError):
        return None
    verdict = "ambiguous" if isinstance(error, AmbiguousError) else "absent"
    return find_question(plan, step, verdict, lambda query: context.resolve(scene, query))


def _signed(receipt: Receipt, plan: EditPlan, dry_run: bool) -> Receipt:
    """The receipt with what only the session knows: who planned it, and whether anything was kept."""
    return receipt.model_copy(update={"backends": {**receipt.backends, "planner": plan.planner}, "dry_run": dry_run})


def _in_plan(error: ScenewrightError, plan: EditPlan, step: int) -> ScenewrightError:
    """The error, saying where in a compound instruction it arose and that the whole of it was rolled back."""
    if len(plan.ops) == 1:
        return error
    where = f"step {step + 1} of {len(plan.ops)} ({plan.ops[step].op}) failed, nothing was changed"
    return retold(error, f"{where}: {error}")
