"""The verdict of a vision model on an edit, from pictures before and after it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from ... import prompts
from ...gaussians.errors import BackendError
from ...tools.alternatives import either, given
from ..model.backend import Message, ModelBackend
from ..model.prompt.examples import quoted
from ..model.verify.json_reply import printable
from ..plan import Usage
from .asking import Purse, Wanted, ask, fitting, require_sight, schema
from .looker import Shown

_REASON, _EFFECT, _INSTRUCTION = 400, 120, 1000  # characters

Effect = Annotated[str, Field(min_length=1, max_length=_EFFECT, strict=True)]
Flag = Annotated[bool, Field(strict=True)]


class VerdictReply(BaseModel):
    """What a vision model answers; the prompt `vision_judge` explains the fields."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        json_schema_extra=either(
            {"done": given(enum=[True])}, {"done": given(enum=[False]), "right_thing": given(enum=[False])}
        ),
    )

    reason: Annotated[str, Field(min_length=1, max_length=_REASON, strict=True)]
    done: Flag
    right_thing: Flag
    side_effects: Annotated[tuple[Effect, ...], Field(max_length=8)] = ()
    residue: Flag
    looks_right: Flag


@dataclass(frozen=True)
class Verdict:
    """Whether an edit did what was asked, as a vision model sees it.

    Attributes:
        done: what was asked for happened.
        right_thing: to the thing that the instruction names.
        side_effects: changes that nobody asked for, in words.
        residue: something was left where a thing had been.
        looks_right: the result is plausible.
        reason: one or two sentences.
        usage: use of the model.
    """

    done: bool
    right_thing: bool
    side_effects: tuple[str, ...]
    residue: bool
    looks_right: bool
    reason: str
    usage: Usage | None = None

    @property
    def passed(self) -> bool:
        """Whether nothing speaks against the edit."""
        return self.done and self.right_thing and self.looks_right and not self.residue and not self.side_effects


def verdict(
    instruction: str, before: Sequence[Shown], after: Sequence[Shown], backend: ModelBackend, purse: Purse | None = None
) -> Verdict:
    """The verdict on an edit.

    Args:
        instruction: what was to be done, in the user's words.
        before, after: pictures from the same places, in the same order, the most telling first; those that do not fit
            the model's window are left out.
        purse: the budget; one of its own if None.

    Raises:
        BackendError: the model reads no pictures, cannot be reached, gave no usable reply, or its budget is used up.
        ValueError: the pictures before and after are not as many, or there are none.
    """
    if not before or len(before) != len(after):
        raise ValueError(f"a verdict needs as many pictures before as after, got {len(before)} and {len(after)}")
    require_sight(backend)
    if len(instruction.strip()) == 0:
        raise BackendError("there is no instruction to judge by")
    pairs = max(1, fitting(backend, prompts.load("vision_judge").text, instruction) // 2)
    before, after = before[:pairs], after[:pairs]
    request = prompts.load("vision_judge_request").fill(
        pictures="\n".join(_lines(before, after)), instruction=quoted(printable(instruction, _INSTRUCTION))
    )
    pictures = tuple(one.png for pair in zip(before, after, strict=True) for one in pair)
    messages = [Message("system", prompts.load("vision_judge").text), Message("user", request, pictures)]
    purse = purse or Purse()
    wanted = Wanted(VerdictReply, _check, schema(VerdictReply))
    reply = ask(backend, messages, wanted, purse, f"{backend.name} judges the edit").reply
    return Verdict(
        reply.done,
        reply.right_thing and reply.done,
        tuple(filter(None, (printable(one, _EFFECT) for one in reply.side_effects))),
        reply.residue,
        reply.looks_right,
        printable(reply.reason, _REASON),
        purse.usage,
    )


def _lines(before: Sequence[Shown], after: Sequence[Shown]) -> list[str]:
    """The pictures in words: before and after alternate, each pair from one place."""
    lines = []
    for pair, (old, new) in enumerate(zip(before, after, strict=True)):
        lines.append(f"Picture {2 * pair + 1}, before: {printable(old.caption or old.name, 200)}")
        lines.append(f"Picture {2 * pair + 2}, after, from the same place: {printable(new.caption or new.name, 200)}")
    return lines


def _check(reply: VerdictReply) -> str:
    return "right_thing: it cannot be true where done is false" if reply.right_thing and not reply.done else ""
