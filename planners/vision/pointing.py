"""Which of the numbered things in pictures a phrase means, confirmed on another picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from ... import prompts
from ..budget import OverBudgetError
from ..model.backend import Message, ModelBackend, UnreachableError
from ..model.prompt.examples import quoted
from ..model.verify.json_reply import ReplyError, printable
from ..plan import Usage
from .asking import NoReplyError, Purse, ask, described, require_sight, shown_marks
from .looker import Looker, Shown

PICTURES = 3  # of a query, the confirming one among them
_PHRASE, _REASON = 200, 300  # characters

Number = Annotated[int, Field(ge=0, le=10**6, strict=True)]


class PointReply(BaseModel):
    """What a vision model answers; the prompt `vision_point` explains the fields."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    because: Annotated[str, Field(max_length=_REASON, strict=True)] = ""
    meant: Annotated[tuple[Number, ...], Field(max_length=24)] = ()
    parts: Annotated[bool, Field(strict=True)] = False
    none: Annotated[bool, Field(strict=True)] = False
    confidence: Annotated[float, Field(ge=0, le=1, allow_inf_nan=False, strict=True)]

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if self.none == bool(self.meant):
            raise ValueError("give numbers in meant, or none true and no numbers")
        return self


@dataclass(frozen=True)
class Pointed:
    """What a phrase means, as a vision model sees it.

    Attributes:
        groups: ids of the groups that are meant, in the order of the reply; empty if none is.
        part: whether only a part of the group is meant.
        confidence: the model's estimate; the lower one of both looks, halved where the second look did not confirm.
        confirmed: whether a second picture gave the same groups.
        because: by what the model recognised it, for the user.
        views: names of the pictures that were sent.
        usage: use of the model.
    """

    groups: tuple[int, ...]
    part: bool
    confidence: float
    confirmed: bool
    because: str
    views: tuple[str, ...]
    usage: Usage | None = None


def point(
    phrase: str, groups: Sequence[int], looker: Looker, backend: ModelBackend, purse: Purse | None = None
) -> Pointed:
    """The groups that a phrase means: two pictures of the candidates, then a third that confirms.

    Without a second look (budget, no other picture, a model that fails then) the first stands, unconfirmed.

    Args:
        groups: ids of the candidates; empty: what the looker marks in the whole scene.
        purse: the budget; one of its own if None, with 3 views.

    Raises:
        BackendError: the model reads no pictures, cannot be reached, gave no usable reply, or its budget is used up.
    """
    require_sight(backend)
    purse = purse or Purse(views=PICTURES)
    purse.require()
    count = purse.take(min(PICTURES - 1, max(purse.views - 1, 1)))
    shown = looker.overview(groups, count)[:count] if count else ()
    if not shown_marks(shown):
        return Pointed((), False, 0.0, False, "no picture shows a numbered thing", tuple(one.name for one in shown))
    reply = pointed(phrase, shown, backend, purse)
    marks = shown_marks(shown)
    first = tuple(marks[mark] for mark in dict.fromkeys(reply.meant) if mark in marks)
    views = [one.name for one in shown]
    second = _second(phrase, reply, marks, shown, looker, purse)
    again: PointReply | None = None
    if second is not None:
        views.append(second.name)
        try:
            again = pointed(phrase, (second,), backend, purse)
        except (NoReplyError, UnreachableError, OverBudgetError):
            again = None
    confirmed = again is not None and {second.numbers.get(m) for m in again.meant} == set(first) if second else False
    confidence = reply.confidence if again is None else min(reply.confidence, again.confidence)
    if again is not None and not confirmed:
        confidence /= 2
    return Pointed(
        first,
        reply.parts,
        round(confidence, 4),
        confirmed,
        printable(reply.because, _REASON),
        tuple(views),
        purse.usage,
    )


def pointed(phrase: str, shown: Sequence[Shown], backend: ModelBackend, purse: Purse) -> PointReply:
    """What one request says about the numbers in pictures; `meant` holds only numbers that they show.

    Raises:
        BackendError: as `point`.
    """
    marks = shown_marks(shown)
    request = prompts.load("vision_point_request").fill(
        pictures=described(shown), phrase=quoted(printable(phrase, _PHRASE))
    )
    messages = [
        Message("system", prompts.load("vision_point").text),
        Message("user", request, tuple(one.png for one in shown)),
    ]

    def check(reply: PointReply) -> str:
        if unknown := sorted(set(reply.meant) - set(marks)):
            there = ", ".join(map(str, sorted(marks)))
            raise ReplyError(f"meant: no picture shows the number {unknown[0]}; numbers are {there}")
        return ""

    return ask(backend, messages, PointReply, check, purse, f"{backend.name} looks for {printable(phrase, 40)}").reply


def _second(
    phrase: str, reply: PointReply, marks: dict[int, int], shown: Sequence[Shown], looker: Looker, purse: Purse
) -> Shown | None:
    """Another picture that shows what is meant: near a single thing, else of the whole; None if there is none."""
    if not purse.take(1):
        return None
    wanted = [f"close:#{reply.meant[0]}"] if len(set(reply.meant)) == 1 else []
    seen = {one.name for one in shown}
    for request in (*wanted, "overview"):
        made = looker.look(request)
        if made is not None and made.name not in seen and set(reply.meant) <= set(made.numbers):
            return made
    return None
