"""What a language model is to answer, strictly: a verdict, and operations or the reason why there are none.

Knows the type, its JSON Schema for back ends, and how one JSON object is found in what was said. Refuses to know how
the model was asked and what stands in the scene.
"""

from __future__ import annotations

import json
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ...tools.registry import AnyOp
from ..plan import MAX_OPS, Verdict

MAX_CHARS = 65_536  # of an answer; the longest plans are a tenth of it


class ReplyError(ValueError):
    """An answer is no valid reply; the message is written for the model."""


class Reply(BaseModel):
    """What the model answers.

    Attributes:
        verdict: "ok" with operations; every other verdict without, but "absent" and "ambiguous" may show the operations
            that were meant.
        reason: one sentence for the user; needed for every verdict but "ok".
        unknown: the words of the instruction that were not understood.
        ops: what to do, in order.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    verdict: Verdict
    reason: Annotated[str, Field(max_length=400)] = ""
    unknown: Annotated[tuple[Annotated[str, Field(max_length=80)], ...], Field(max_length=8)] = ()
    ops: Annotated[tuple[AnyOp, ...], Field(max_length=MAX_OPS)] = ()


def schema() -> dict[str, Any]:
    """The JSON Schema of a reply, for `ModelBackend.answer`."""
    return Reply.model_json_schema()


def read(text: str) -> Reply:
    """The reply in an answer.

    Raises:
        ReplyError: there is none, or it is not valid.
    """
    try:
        return Reply.model_validate(json.loads(text))
    except ValidationError as error:
        told = "; ".join(f"{'.'.join(str(p) for p in e['loc'])}: {e['msg']}" for e in error.errors()[:4])
        raise ReplyError(told) from error
    except (ValueError, RecursionError) as error:
        raise ReplyError(f"not JSON: {error}") from error
