"""Let a language model propose a brief: the prompt describes the kind of room, and an invalid answer is repaired.

An answer that is still invalid after the allowed number of repairs is discarded.
"""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from ... import prompts
from ...gaussians.errors import BackendError
from ...gaussians.world import relations
from ..grammar.tagging.words import clean
from ..grammar.vocabulary.unsafe import unsafe_words
from ..model.backend import Message, ModelBackend
from ..model.verify.strict_json import DECODER, TooDeepError, given_only
from ..plan import Usage
from . import knowledge
from .brief import Brief, RefusedError, Relation, Thing

REPAIRS = 3
_LONGEST = 200_000  # most characters of an answer
_FAULT = 900  # most characters of an error message that goes back to the model
_EXAMPLE = Brief(
    kind="coffee shop",
    scale="small",
    things=(
        Thing(id="round table", name="round table", count=3),
        Thing(id="counter", name="counter"),
        Thing(id="cake", name="cake"),
    ),
    relations=(Relation(subject="cake", name="on", objects=("counter",)),),
    without=("potted plant",),
)


class Proposed(BaseModel):
    """The answer of the model: a brief, or another verdict with its reason."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    verdict: Literal["ok", "not_an_edit", "not_understood", "impossible", "unsafe"]
    reason: Annotated[str, Field(max_length=400)] = ""
    brief: Brief | None = None

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if (self.verdict == "ok") != (self.brief is not None):
            raise ValueError('verdict "ok" needs a brief, and every other verdict must have none')
        if self.verdict != "ok" and not self.reason:
            raise ValueError(f'verdict "{self.verdict}" needs a reason')
        if self.brief is not None and not (self.brief.things or self.brief.habits):
            raise ValueError("the brief is empty: name things, or leave habits on")
        return self


@dataclass(frozen=True)
class Proposal:
    """A model's brief, the hash of the prompt files, and the usage."""

    brief: Brief
    prompt_hash: str
    usage: Usage


def propose(
    text: str,
    model: ModelBackend,
    *,
    seconds: float = 120.0,
    heard: Brief | None = None,
    conflicts: Sequence[str] = (),
) -> Proposal:
    """The brief that a model proposes for a description.

    Args:
        text: the description.
        model: the model that is asked.
        seconds: time limit of all attempts together.
        heard: the brief of the embedded reader; the prompt describes its kind of room.
        conflicts: what of that brief is not possible together; it is asked for one that is.

    Raises:
        UserError: the text is too long to be a description.
        RefusedError: the text is unsafe, or the model says that it describes no room.
        BackendError: the model cannot be reached, or gave no valid brief after all attempts.
    """
    cleaned = clean(text)
    if phrase := unsafe_words(cleaned):
        raise RefusedError("this is no description of a room", "unsafe", (phrase[:60],))
    ends = time.monotonic() + seconds
    asked = f"Description: {json.dumps(cleaned)}\nAnswer:"
    messages = [Message("system", _system(heard)), Message("user", asked)]
    if heard is not None and conflicts:
        first = json.dumps({"verdict": "ok", "brief": heard.model_dump(mode="json", exclude_defaults=True)})
        told = prompts.load("compose_conflict").fill(conflicts="\n".join(f"- {c}" for c in conflicts))
        messages += [Message("assistant", first[:_LONGEST]), Message("user", told)]
    opening = len(messages)
    usage = Usage(model=model.name)
    fault = ""
    for _ in range(1 + REPAIRS):
        left = ends - time.monotonic()
        if left <= 0:
            raise BackendError(
                f"{model.name} gave no brief within {seconds:g} s; allow more time or shorten the description"
            )
        answer = model.answer(messages, schema(), seconds=left)
        usage = usage.plus(answer.usage)
        if answer.end == "declined":
            raise BackendError(f"{model.name} declined to answer; describe the room in other words")
        try:
            if answer.end != "done":  # constrained decoding closes the JSON: it is valid but incomplete
                raise ValueError("the answer was cut off at the length limit; give a shorter answer")
            found = _read(answer.text)
        except ValueError as error:
            fault = str(error)[:_FAULT]
            repair = prompts.load("compose_repair").fill(fault=fault)
            messages = [*messages[:opening], Message("assistant", answer.text[:_LONGEST]), Message("user", repair)]
            continue
        return Proposal(_accepted(found), prompt_hash(), usage)
    raise BackendError(f"{model.name} gave no valid brief in {1 + REPAIRS} attempts; the last fault: {fault}")


def _accepted(found: Proposed) -> Brief:
    if found.brief is None:
        assert found.verdict != "ok"
        raise RefusedError(found.reason, found.verdict)
    return found.brief


@cache
def _schema_text() -> str:
    return json.dumps(Proposed.model_json_schema())


def schema() -> dict[str, Any]:
    """The JSON Schema of an answer, from the type that validates it."""
    made: dict[str, Any] = json.loads(_schema_text())
    return made


def prompt_hash() -> str:
    """The hash of the prompt files."""
    return prompts.short_hash(*(prompts.load(name).hash for name in ("compose", "compose_repair", "compose_conflict")))


def _system(heard: Brief | None) -> str:
    """The system prompt, with the knowledge about the kind of room that was read, or about rooms in general."""
    kind = knowledge.room(heard.kind if heard else "room")
    example = {"verdict": "ok", "brief": _EXAMPLE.model_dump(mode="json", exclude_defaults=True)}
    return prompts.load("compose").fill(
        relations=", ".join(relations.names("wish")),
        alone=", ".join(name for name in relations.names("wish") if not relations.named(name).anchors),
        rooms=", ".join(sorted(knowledge.rooms())),
        knowledge=f"Usual in a {knowledge.summary(kind)}",
        things=", ".join(sorted(knowledge.things())),
        example=json.dumps(example),
    )


def _read(text: str) -> Proposed:
    """The JSON object of an answer, which may be in a code fence.

    Raises:
        ValueError: there is none, or it is invalid; the message is for the model.
    """
    bare = text.strip().removeprefix("```json").removeprefix("```").removesuffix("```").strip()
    if len(bare) > _LONGEST:
        raise ValueError(f"the answer has {len(bare)} characters, at most {_LONGEST} are read; give a shorter answer")
    try:
        return Proposed.model_validate(given_only(DECODER.decode(bare)))
    except ValidationError as error:
        faults = error.errors(include_url=False, include_input=False)[:4]
        raise ValueError("\n".join(f"{'.'.join(map(str, f['loc']))}: {f['msg']}" for f in faults)) from error
    except (TooDeepError, RecursionError) as error:
        raise ValueError("the JSON is nested too deeply") from error
    except ValueError as error:
        raise ValueError(f"the answer is not valid JSON: {error}") from error
