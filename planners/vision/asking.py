"""One request to a vision model with a strict reply type: read, repaired once, and charged to a budget.

Replies are pydantic types that forbid unknown fields. What a type cannot say (which numbers are in the pictures) a
`check` says.
"""

from __future__ import annotations

import copy
import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Generic, TypeVar

from pydantic import BaseModel, ValidationError

from ... import prompts
from ...gaussians.errors import BackendError
from ..budget import Ledger, OverBudgetError, Progress
from ..model.backend import Answer, Message, ModelBackend, OnText, UnreachableError
from ..model.prompt.pruning import tokens
from ..model.verify.json_reply import Location, ReplyError, bare, given_object, printable, told
from ..plan import NoPlanError, Usage
from .looker import Shown

T = TypeVar("T", bound=BaseModel)

PICTURE_TOKENS = 1100  # estimate of what a model counts for a picture 768 pixels wide
REPLY_TOKENS = 700  # kept for a reply and what repairs it
_ATTEMPTS = 2  # the reply, and one repair
_ECHO_CHARS, _FAULT_CHARS, _TOLD_CHARS = 2000, 1000, 300
_CUT = "the answer was cut off because it is too long; answer shorter"


class NoReplyError(NoPlanError):
    """A vision model was asked and gave no usable reply; `usage` is what that cost."""


@dataclass(frozen=True)
class Wanted(Generic[T]):
    """What a reply must be.

    Attributes:
        kind: its type.
        check: what is wrong with a reply that is valid by its type, "" for nothing; such a fault is told to the model
            once, and a reply that still has it is returned with it. Raises ReplyError where the reply is of no use.
        schema: JSON Schema of what `kind` and `check` allow together, for back ends that hold a model to it.
    """

    kind: type[T]
    check: Callable[[T], str]
    schema: dict[str, Any]


@dataclass(frozen=True)
class Said(Generic[T]):
    """A reply.

    Attributes:
        reply: valid by its type.
        doubt: what is still wrong with it after the repair, "" for nothing.
    """

    reply: T
    doubt: str = ""


class Purse:
    """What one question may still cost, and what it has cost.

    Args:
        ledger: the session's budget and spending; all usage is added to it.
        progress: called with the stage in words and the share of the time limit that has passed; without it replies
            are not streamed.
        views: limit on pictures where the budget sets none.

    Attributes:
        usage: of this question, None before the first request.
        views: pictures that may still be rendered.
    """

    def __init__(self, ledger: Ledger | None = None, progress: Progress | None = None, views: int = 8) -> None:
        self._ledger = ledger or Ledger()
        self._progress = progress
        self._begun = time.monotonic()
        self.usage: Usage | None = None
        self.views = self._ledger.budget.views or views

    @property
    def seconds(self) -> float:
        """Seconds that are left."""
        return self._ledger.budget.seconds - (time.monotonic() - self._begun)

    def require(self) -> None:
        """Check that a model may be asked once more.

        Raises:
            OverBudgetError: the seconds or tokens of the question or the dollars of the session are used up.
        """
        budget = self._ledger.budget
        if self.seconds <= 0:
            raise OverBudgetError(f"the {budget.seconds:g} s of the question are over; --budget gives it more")
        spent = self.usage.input_tokens + self.usage.output_tokens if self.usage else 0
        if budget.tokens is not None and spent >= budget.tokens:
            raise OverBudgetError(f"the question's budget of {budget.tokens} tokens is used up; --budget gives it more")
        self._ledger.require()

    def take(self, views: int) -> int:
        """How many of these pictures may be rendered; they count as rendered."""
        granted = max(min(views, self.views), 0)
        self.views -= granted
        return granted

    def add(self, usage: Usage | None) -> None:
        """Charge the usage of a request to the question and to the session."""
        if usage is not None:
            self.usage = usage if self.usage is None else self.usage.plus(usage)
            self._ledger.add(usage)

    def report(self, stage: str) -> None:
        """Tell that something happens."""
        if self._progress is not None:
            passed = time.monotonic() - self._begun
            self._progress(f"{stage} ({passed:.0f} s)", min(max(passed / self._ledger.budget.seconds, 0.0), 0.99))

    def listener(self, stage: str) -> OnText | None:
        """Takes the pieces of a streamed reply; None if nobody is told of them."""
        return None if self._progress is None else lambda piece: self.report(stage)


def require_sight(backend: ModelBackend) -> None:
    """Check that a model reads pictures.

    Raises:
        BackendError: it does not.
    """
    if not backend.sees:
        raise BackendError(f"{backend.name} reads no pictures; name a model that does")


def fitting(backend: ModelBackend, *texts: str) -> int:
    """How many pictures fit a model's window beside texts and the reply; at least one."""
    used = sum(map(tokens, texts)) + REPLY_TOKENS
    return max(1, (backend.window - used) // PICTURE_TOKENS)


def described(shown: Sequence[Shown]) -> str:
    """The pictures of a request in words, one line each, with the numbers of their marks."""
    lines = []
    for number, one in enumerate(shown, 1):
        marks = ", ".join(f"#{mark}" for mark in sorted(one.numbers))
        seen = f" Numbered things in it: {marks}." if marks else " It has no numbers."
        lines.append(f"Picture {number}: {printable(one.caption or one.name, 300)}{seen}")
    return "\n".join(lines)


def shown_marks(shown: Sequence[Shown]) -> dict[int, int]:
    """The marks in any of the pictures: number to group id."""
    return {mark: group for one in shown for mark, group in one.numbers.items()}


@cache
def _schema(kind: type[BaseModel]) -> dict[str, Any]:
    made: dict[str, Any] = bare(kind.model_json_schema())
    return made


def schema(kind: type[BaseModel], **numbers: Collection[int]) -> dict[str, Any]:
    """The JSON Schema of a reply type, without descriptions, which the prompt contains.

    Args:
        numbers: for lists of numbers, by field: which there are; the schema bounds them, or allows none.
    """
    made: dict[str, Any] = copy.deepcopy(_schema(kind))
    for name, allowed in numbers.items():
        field = made["properties"][name]
        if allowed:
            field["items"] = {"type": "integer", "minimum": min(allowed), "maximum": max(allowed)}
        else:
            field["maxItems"] = 0
    return made


def read(text: str, kind: type[T]) -> T:
    """The reply in an answer.

    Raises:
        ReplyError: it holds no valid reply; the message is for the model.
    """
    try:
        return kind.model_validate(given_object(text))
    except ValidationError as error:
        raise ReplyError(told(error, lambda loc: _fields(kind, loc))) from error


def ask(
    backend: ModelBackend,
    messages: Sequence[Message],
    wanted: Wanted[T],
    purse: Purse,
    stage: str,
    attempts: int = _ATTEMPTS,
) -> Said[T]:
    """The reply to messages; one that is invalid or fails the check is repaired once.

    Args:
        stage: what is done, for the progress.
        attempts: requests, all but the first to repair.

    Raises:
        NoReplyError: no valid reply after the repair, or the model declined.
        UnreachableError: the model gave no answer. (So is NoReplyError a NoPlanError.)
        OverBudgetError: the budget is used up before a request.
    """
    talk, fault = list(messages), ""
    for attempt in range(attempts):
        answer = _answer(backend, talk, wanted.schema, purse, stage)
        if answer.end == "declined":
            raise NoReplyError(f"{backend.name} declined: {printable(answer.text, _TOLD_CHARS)}", purse.usage)
        doubted = None
        try:
            if answer.end == "closed":  # valid, but incomplete
                raise ReplyError(_CUT)
            doubted = read(answer.text, wanted.kind)
            fault = wanted.check(doubted)
        except ReplyError as error:
            doubted, fault = None, _CUT if answer.end == "cut" else str(error)
        if doubted is not None and (not fault or attempt + 1 == attempts):
            return Said(doubted, fault)
        talk = [*messages, *_repair(answer.text, fault)]
    raise NoReplyError(f"{backend.name} gave no usable reply; at last: {printable(fault, _TOLD_CHARS)}", purse.usage)


def _answer(backend: ModelBackend, talk: Sequence[Message], given: dict[str, Any], purse: Purse, stage: str) -> Answer:
    purse.require()
    purse.report(stage)
    try:
        answer = backend.answer(talk, given, seconds=purse.seconds, on_text=purse.listener(stage))
    except UnreachableError as error:
        purse.add(error.usage)
        raise UnreachableError(str(error), purse.usage) from error
    purse.add(answer.usage)
    return answer


def _repair(answer: str, fault: str) -> tuple[Message, Message]:
    """The bad answer, cut short, and what was wrong with it."""
    echo = answer if len(answer) <= _ECHO_CHARS else answer[:_ECHO_CHARS] + " …"
    said = prompts.load("vision_repair").fill(fault=fault[:_FAULT_CHARS])
    return Message("assistant", echo.strip() or "(nothing)"), Message("user", said)


def _fields(kind: type[BaseModel], loc: Location) -> list[str]:
    """Names of the fields at the level of a location, for lists of objects within a reply too."""
    node = _schema(kind)
    for part in loc[:-1]:
        node = node.get("items", {}) if isinstance(part, int) else node.get("properties", {}).get(part, {})
        if "$ref" in node:
            node = _schema(kind)["$defs"][str(node["$ref"]).rpartition("/")[2]]
    return list(node.get("properties", {}))
