"""A planner's verdict as an error: the words were not understood, or no operation does what they ask.

Knows verdicts. Refuses to know grammar.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...gaussians.errors import AbsentError, AmbiguousError, InstructionError, ScenewrightError, UserError

if TYPE_CHECKING:
    from ...planners.plan import EditPlan


class NotUnderstoodError(UserError):
    """The words are no instruction that the planner can read; `verdict` is its own word for why."""

    def __init__(self, message: str, verdict: str) -> None:
        super().__init__(message)
        self.verdict = verdict


class ImpossibleError(InstructionError):
    """Understood, but no operation does it; `verdict` is the planner's word for why."""

    def __init__(self, message: str, verdict: str) -> None:
        super().__init__(message)
        self.verdict = verdict


def retold(error: ScenewrightError, message: str) -> ScenewrightError:
    """The same error, of the same kind and with what else it carries, in other words."""
    other = type(error).__new__(type(error), message)  # kinds differ in what they are made of
    other.__dict__.update(error.__dict__)
    return other


def refusal(plan: EditPlan) -> ScenewrightError:
    """The error that a plan without operations stands for."""
    reason = plan.reason or "this was not understood; say it in other words"
    if plan.verdict == "absent":
        return AbsentError(reason)
    if plan.verdict == "ambiguous":
        return AmbiguousError(reason)
    if plan.verdict == "impossible":
        return ImpossibleError(reason, plan.verdict)
    return NotUnderstoodError(reason, plan.verdict)


def verdict_of(error: ScenewrightError) -> str:
    """The one word for why an instruction was not carried out; "failed" for files and back ends."""
    if isinstance(error, NotUnderstoodError | ImpossibleError):
        return error.verdict
    for kind, verdict in ((AbsentError, "absent"), (AmbiguousError, "ambiguous"), (InstructionError, "impossible")):
        if isinstance(error, kind):
            return verdict
    return "not_understood" if isinstance(error, UserError) else "failed"
