"""Errors for plans without operations, and the verdict of an error."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from ...gaussians.errors import (
    AbsentError,
    AmbiguousError,
    InstructionError,
    ScenewrightError,
    UnconfirmedError,
    UserError,
)

if TYPE_CHECKING:
    from ...planners.plan import EditPlan


class NotUnderstoodError(UserError):
    """The planner cannot read the instruction; `verdict` is the plan's verdict."""

    def __init__(self, message: str, verdict: str) -> None:
        super().__init__(message)
        self.verdict = verdict


class ImpossibleError(InstructionError):
    """The instruction was understood, but no operation does it; `verdict` is the plan's verdict."""

    def __init__(self, message: str, verdict: str) -> None:
        super().__init__(message)
        self.verdict = verdict


def with_message(error: ScenewrightError, message: str) -> ScenewrightError:
    """A copy of the error, of the same class and with the same attributes, with another message."""
    other = type(error).__new__(type(error), message)  # __new__, as the constructors take different arguments
    other.__dict__.update(error.__dict__)
    return other


def refusal(plan: EditPlan) -> ScenewrightError:
    """The error for a plan without operations, by its verdict."""
    reason = plan.reason or "this was not understood; say it in other words"
    if plan.verdict == "absent":
        return AbsentError(reason)
    if plan.verdict == "ambiguous":
        return AmbiguousError(reason)
    if plan.verdict == "impossible":
        return ImpossibleError(reason, plan.verdict)
    return NotUnderstoodError(reason, plan.verdict)


def open_verdict(error: ScenewrightError) -> Literal["absent", "ambiguous", "unconfirmed"] | None:
    """The verdict of the selection that an instruction failed on, which the user may settle; None for other errors."""
    if isinstance(error, AbsentError):
        return "absent"
    if isinstance(error, AmbiguousError):
        return "ambiguous"
    return "unconfirmed" if isinstance(error, UnconfirmedError) else None


def verdict_of(error: ScenewrightError) -> str:
    """The verdict that says why an instruction was not carried out; "failed" for files and back ends."""
    if isinstance(error, NotUnderstoodError | ImpossibleError):
        return error.verdict
    if (asked := open_verdict(error)) is not None:
        return asked
    if isinstance(error, InstructionError):
        return "impossible"
    return "not_understood" if isinstance(error, UserError) else "failed"
