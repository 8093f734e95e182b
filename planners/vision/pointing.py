"""Which of the numbered things in pictures a phrase means, confirmed on another picture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from ... import prompts
from ...tools.alternatives import either, given
from ..budget import OverBudgetError
from ..model.backend import Message, ModelBackend, UnreachableError
from ..model.prompt.examples import quoted
from ..model.verify.json_reply import ReplyError, printable
from ..plan import Usage
from .asking import NoReplyError, Purse, Wanted, ask, described, require_sight, schema, shown_marks
from .looker import Looker, Shown

PICTURES, REQUESTS = 3, 2  # of a query, the confirming one among them
_PHRASE, _REASON = 200, 300  # characters

Number = Annotated[int, Field(ge=0, le=10**6, strict=True)]


class PointReply(BaseModel):
    """What a vision model answers; the prompt `vision_point` explains the fields."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        json_schema_extra=either(
            {"none": {"enum": [False]}, "meant": given(minItems=1)},
            {"none": given(enum=[True]), "meant": {"maxItems": 0}},
        ),
    )

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
        confidence: the model's estimate; the lower one of both looks, halved where the second one contradicts.
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


Inner = Callable[[Sequence[int]], Sequence[int]]  # groups to the pieces that they consist of


def point(
    phrase: str,
    groups: Sequence[int],
    looker: Looker,
    backend: ModelBackend,
    purse: Purse | None = None,
    inner: Inner | None = None,
) -> Pointed:
    """The groups that a phrase means: two pictures of the candidates, then a third that confirms, or finds them.

    If only a part of something is meant, the third picture numbers its pieces, and those that are meant are the result.
    Without a second look (budget, no other picture, a model that fails then, a first reply that had to be repaired) the
    first stands, unconfirmed. There are never more than `PICTURES` pictures and `REQUESTS` requests.

    Args:
        groups: ids of the candidates; empty: what the looker marks in the whole scene.
        purse: the budget; one of its own if None, with 3 views.
        inner: the pieces of groups; None: groups have none.

    Raises:
        BackendError: the model reads no pictures, cannot be reached, gave no usable reply, or its budget is used up.
    """
    require_sight(backend)
    purse = purse or Purse(views=PICTURES)
    purse.require()
    count = purse.take(min(PICTURES - 1, max(purse.views - 1, 1)))
    shown = looker.overview(groups, count)[:count] if count else ()
    marks = shown_marks(shown)
    if not marks:
        return Pointed((), False, 0.0, False, "no picture shows a numbered thing", tuple(one.name for one in shown))
    before = purse.usage.requests if purse.usage else 0
    reply = pointed(phrase, shown, backend, purse)
    found = tuple(marks[mark] for mark in dict.fromkeys(reply.meant))
    repaired = purse.usage is not None and purse.usage.requests - before >= REQUESTS
    pieces = inner(found) if inner is not None and reply.parts else ()
    second = None if repaired else _second(reply, shown, pieces, looker, purse)
    confirmed, confidence = False, reply.confidence
    if second is not None and found and not pieces:
        confirmed, confidence = _confirmed(phrase, reply, set(found), second, backend, purse)
    elif second is not None and (other := _another_look(phrase, second, backend, purse)) is not None:
        confirmed = other.none and not found
        confidence = min(reply.confidence, other.confidence) if other.none else other.confidence
        reply, found = other, tuple(second.numbers[mark] for mark in dict.fromkeys(other.meant))
    because = printable(reply.because, _REASON)
    views = tuple(one.name for one in (*shown, *((second,) if second else ())))
    return Pointed(found, reply.parts, round(confidence, 4), confirmed, because, views, purse.usage)


def _confirmed(
    phrase: str, reply: PointReply, found: set[int], second: Shown, backend: ModelBackend, purse: Purse
) -> tuple[bool, float]:
    """Whether another picture gives the same groups, and the confidence after it."""
    try:
        again = pointed(phrase, (second,), backend, purse, attempts=1)
    except NoReplyError:
        return False, reply.confidence / 2
    except (UnreachableError, OverBudgetError):
        return False, reply.confidence
    lower = min(reply.confidence, again.confidence)
    same = {second.numbers[mark] for mark in again.meant} == found
    return same, lower if same else lower / 2


def _another_look(phrase: str, second: Shown, backend: ModelBackend, purse: Purse) -> PointReply | None:
    """What another picture shows where the first ones did not show it; None if the model fails then."""
    try:
        return pointed(phrase, (second,), backend, purse, attempts=1)
    except (NoReplyError, UnreachableError, OverBudgetError):
        return None


def pointed(
    phrase: str, shown: Sequence[Shown], backend: ModelBackend, purse: Purse, attempts: int = REQUESTS
) -> PointReply:
    """What a model says about the numbers in pictures; `meant` holds only numbers that they show.

    Args:
        attempts: requests, all but the first to repair a reply.

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

    stage = f"{backend.name} looks for {printable(phrase, 40)}"
    wanted = Wanted(PointReply, check, schema(PointReply, meant=marks))
    return ask(backend, messages, wanted, purse, stage, attempts).reply


def _second(
    reply: PointReply, shown: Sequence[Shown], pieces: Sequence[int], looker: Looker, purse: Purse
) -> Shown | None:
    """Another picture: of the pieces, else near a single thing, else of the whole; None if there is none."""
    if not purse.take(1):
        return None
    if pieces:
        return next((one for one in looker.overview(pieces, 1) if one.numbers), None)
    wanted = [f"close:#{reply.meant[0]}"] if len(set(reply.meant)) == 1 else []
    seen = {one.name for one in shown}
    for request in (*wanted, "overview"):
        made = looker.look(request)
        if made is not None and made.name not in seen and set(reply.meant) <= set(made.numbers):
            return made
    return None
