"""Captions of a scene and its things by a vision model, from a few pictures with numbered marks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from ... import prompts
from ..budget import OverBudgetError
from ..model.backend import Message, ModelBackend
from ..model.prompt.labels import plain
from ..model.verify.json_reply import printable
from ..plan import Usage
from .asking import NoReplyError, Purse, Wanted, ask, described, require_sight, schema
from .facts import Facts
from .looker import Looker, Shown

BATCH = 12  # things that one request describes; more make models skip some
PICTURES = 2  # of one request
_NAME, _CAPTION, _SCENE = 48, 240, 400  # characters
_FACTS_TOKENS = 800

Number = Annotated[int, Field(ge=0, le=10**6, strict=True)]


class CaptionEntry(BaseModel):
    """One thing: the number of its mark, its name, and a sentence about it."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    number: Number
    name: Annotated[str, Field(max_length=_NAME, strict=True)] = ""
    caption: Annotated[str, Field(max_length=_CAPTION, strict=True)] = ""


class CaptionsReply(BaseModel):
    """What a vision model answers; the prompt `vision_caption` explains the fields."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    scene: Annotated[str, Field(max_length=_SCENE, strict=True)] = ""
    captions: Annotated[tuple[CaptionEntry, ...], Field(max_length=2 * BATCH)] = ()


@dataclass(frozen=True)
class Caption:
    """What a vision model says about one group.

    Attributes:
        name: a plain noun, "" if the model gave none, or none that is a plausible name of a thing.
        text: one sentence.
        view: name of a picture that showed it.
    """

    name: str
    text: str
    view: str


@dataclass(frozen=True)
class Captions:
    """Captions of a scene.

    Attributes:
        scene: one sentence about the whole, "" if there is none.
        groups: by id of the group; groups that no picture shows or the model does not recognise are left out.
        stopped: why groups were left out beyond that, "" if for no other reason.
        pictures: pictures that were sent, and requests made.
        usage: use of the model.
    """

    scene: str
    groups: dict[int, Caption]
    stopped: str = ""
    pictures: int = 0
    usage: Usage | None = None


def captions(
    groups: Sequence[int], facts: Facts, looker: Looker, backend: ModelBackend, purse: Purse | None = None
) -> Captions:
    """Captions of a scene and of its groups.

    Each request shows a batch of groups in a few pictures that are chosen for them; what they hide is shown once more.

    Args:
        groups: ids of the groups to describe; empty: the scene, and what the looker marks.
        purse: the budget; one of its own if None, with 12 views.

    Raises:
        BackendError: the model reads no pictures, cannot be reached, or gave no usable reply to the first request.
    """
    require_sight(backend)
    purse = purse or Purse(views=12)
    made = Captions("", {})
    for batch in _batches(list(dict.fromkeys(groups)), made.groups):
        count = purse.take(PICTURES)
        shown = looker.overview(batch, count)[:count] if count else ()
        todo = _numbers(shown, batch)
        if not count:
            return replace(made, stopped="the budget of views is used up", usage=purse.usage)
        if not shown or (batch and not todo):
            continue
        try:
            reply = _asked(backend, shown, todo, facts, purse)
        except (NoReplyError, OverBudgetError) as error:
            if not made.pictures:
                raise
            return replace(made, stopped=str(error), usage=purse.usage)
        made.groups.update(_read(reply, todo, shown))
        made = replace(made, scene=made.scene or printable(reply.scene, _SCENE), pictures=made.pictures + len(shown))
    return replace(made, usage=purse.usage)


def _batches(groups: Sequence[int], done: Mapping[int, Caption]) -> Iterator[Sequence[int]]:
    """The groups in batches; then those that are not done, once more: fewer groups get pictures nearer to them."""
    if not groups:
        yield ()
    for start in range(0, len(groups), BATCH):
        yield groups[start : start + BATCH]
    left = [group for group in groups if group not in done]
    for start in range(0, len(left) if done else 0, BATCH):
        yield left[start : start + BATCH]


def _numbers(shown: Sequence[Shown], wanted: Sequence[int]) -> dict[int, int]:
    """The marks to ask about, number to group: of the wanted groups, or of all if none are named; those that take most
    of a picture first, at most one batch."""
    marks = {mark: group for one in shown for mark, group in one.numbers.items()}
    area = {group: max((one.visible.get(group, 0.0) for one in shown), default=0.0) for group in marks.values()}
    chosen = [mark for mark in sorted(marks) if not wanted or marks[mark] in wanted]
    chosen.sort(key=lambda mark: (-area[marks[mark]], mark))
    return {mark: marks[mark] for mark in sorted(chosen[:BATCH])}


def _asked(
    backend: ModelBackend, shown: Sequence[Shown], todo: dict[int, int], facts: Facts, purse: Purse
) -> CaptionsReply:
    request = prompts.load("vision_caption_request").fill(
        pictures=described(shown),
        facts=facts.table("", todo, _FACTS_TOKENS, only_marked=True),
        numbers=", ".join(f"#{mark}" for mark in todo) or "(none: describe the scene only)",
    )
    messages = [
        Message("system", prompts.load("vision_caption").text),
        Message("user", request, tuple(one.png for one in shown)),
    ]

    def check(reply: CaptionsReply) -> str:
        numbers = [entry.number for entry in reply.captions]
        if unknown := sorted(set(numbers) - set(todo)):
            return f"captions: {unknown[0]} was not asked for; numbers are {', '.join(map(str, todo)) or 'none'}"
        if len(set(numbers)) != len(numbers):
            return "captions: a number is described twice"
        bad = [entry.number for entry in reply.captions if entry.name and plain(entry.name) is None]
        return f"captions: the name of {bad[0]} is no plain noun" if bad else ""

    stage = f"{backend.name} describes {len(todo)} things"
    wanted = Wanted(CaptionsReply, check, schema(CaptionsReply))
    return ask(backend, messages, wanted, purse, stage).reply


def _read(reply: CaptionsReply, todo: dict[int, int], shown: Sequence[Shown]) -> dict[int, Caption]:
    """Captions by group; entries that still cannot be used after the repair are left out."""
    made: dict[int, Caption] = {}
    for entry in reply.captions:
        group = todo.get(entry.number)
        name, text = plain(entry.name) or "", printable(entry.caption, _CAPTION)
        if group is None or group in made or not (name or text):
            continue
        view = next(one.name for one in shown if entry.number in one.numbers)
        made[group] = Caption(name.lower(), text, view)
    return made
