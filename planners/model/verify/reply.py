"""What a language model is to answer, strictly: a verdict, and operations or the reason why there are none.

Knows the type, its JSON Schema for back ends, how one JSON object is found in what was said, and how to say what is
wrong with it. Refuses to know how the model was asked and what stands in the scene, and to guess what was meant.
"""

from __future__ import annotations

from functools import cache
from typing import Annotated, Any, Self, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from ....tools.alternatives import either, given
from ....tools.registry import AnyOp
from ...plan import MAX_OPS, Verdict
from .strict_json import DECODER, TooDeepError, given_only

MAX_CHARS = 65_536  # of an answer; the longest plans are a tenth of it
_FAULTS = 4  # named at once
_FAULT_CHARS = 240  # of each
_HESITANT = ("absent", "ambiguous")
_UNTOLD = ("title", "description", "examples", "default")  # the prompt says these things


class ReplyError(ValueError):
    """An answer is no valid reply. The message is for the model: short, which field, and what it allows."""


class Reply(BaseModel):
    """What the model answers.

    Attributes:
        verdict: "ok" with operations; every other verdict without, except that "absent" and "ambiguous" may hold the
            operations that were meant, so that the user can be shown what there is.
        reason: one sentence for the user; needed for every verdict but "ok".
        unknown: the words of the instruction that were not understood.
        ops: what to do, in order.
    """

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        json_schema_extra=either(
            {"verdict": given(enum=["ok"]), "ops": given(minItems=1)},
            {"verdict": given(enum=list(_HESITANT)), "reason": given(minLength=1)},
            {
                "verdict": given(enum=[v for v in get_args(Verdict) if v not in ("ok", *_HESITANT)]),
                "reason": given(minLength=1),
                "ops": {"maxItems": 0},
            },
        ),
    )

    verdict: Verdict
    reason: Annotated[str, Field(max_length=400)] = ""
    unknown: Annotated[tuple[Annotated[str, Field(max_length=80)], ...], Field(max_length=8)] = ()
    ops: Annotated[tuple[AnyOp, ...], Field(max_length=MAX_OPS)] = ()

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if self.verdict == "ok" and not self.ops:
            raise ValueError('verdict "ok" needs at least one operation in ops')
        if self.ops and self.verdict not in ("ok", *_HESITANT):
            raise ValueError(f'verdict "{self.verdict}" takes no ops, got {len(self.ops)}')
        if self.verdict != "ok" and not self.reason:
            raise ValueError(f'verdict "{self.verdict}" needs a reason')
        return self


@cache
def _schema() -> dict[str, Any]:
    made: dict[str, Any] = _bare(Reply.model_json_schema())
    for definition in made["$defs"].values():
        if "const" in definition["properties"].get("op", {}):  # the type has a default, but nobody else knows it
            definition["required"] = ["op", *definition.get("required", [])]
    return made


def schema() -> dict[str, Any]:
    """The JSON Schema of a reply, for `ModelBackend.answer`: that of the very type that validates, without the words
    that the prompt says better."""
    return dict(_schema())


def _bare(node: Any) -> Any:
    """A schema without what is only said to readers; a property may be called whatever it is."""
    if isinstance(node, list):
        return [_bare(item) for item in node]
    if not isinstance(node, dict):
        return node
    named = {k: {n: _bare(v) for n, v in node[k].items()} for k in ("properties", "$defs") if k in node}
    return {k: _bare(v) for k, v in node.items() if k not in (*_UNTOLD, *named)} | named


def read(text: str) -> Reply:
    """The reply in an answer: one JSON object, which may stand in a fence or between words without braces.

    Fields that are null count as not given. Everything else must be exactly as the type says.

    Raises:
        ReplyError: there is none, more than one, or it is not valid.
    """
    if len(text) > MAX_CHARS:
        raise ReplyError(f"the answer has {len(text)} characters, at most {MAX_CHARS} are read; answer shorter")
    try:
        return Reply.model_validate(given_only(_object(text)))
    except ValidationError as error:
        raise ReplyError(_told(error)) from error
    except (TooDeepError, RecursionError) as error:
        raise ReplyError("the JSON is nested too deeply") from error


def _object(text: str) -> dict[str, Any]:
    """The one JSON object in a text.

    The first brace must begin it and nothing behind it may look like another: to try one brace after the other would
    take a part of a broken answer for the whole of it.
    """
    start = text.find("{")
    if start < 0:
        raise ReplyError("the answer holds no JSON object; answer with one JSON object and nothing else")
    try:
        found, end = DECODER.raw_decode(text, start)
    except ValueError as error:
        raise ReplyError(f"the answer is no valid JSON: {str(error)[:_FAULT_CHARS]}") from error
    if any(c in text[:start] + text[end:] for c in "{}[]"):
        raise ReplyError("the answer holds more than one JSON object; answer with one and nothing else")
    assert isinstance(found, dict)
    return found


def _told(error: ValidationError) -> str:
    """What is wrong, for the model: the first few faults, each with its field and what that allows."""
    faults = error.errors(include_url=False, include_input=False)
    told = [f"{_place(f['loc'])}: {_fault(f)}"[:_FAULT_CHARS] for f in faults[:_FAULTS]]
    return "\n".join([*told, *([f"and {len(faults) - _FAULTS} more"] if len(faults) > _FAULTS else [])])


def _fault(fault: Any) -> str:
    said = str(fault["msg"]).removeprefix("Value error, ")
    if fault["type"] == "extra_forbidden":
        return f"there is no such field here; fields are {', '.join(_siblings(fault['loc']))}"
    return said


def _place(loc: tuple[int | str, ...]) -> str:
    return ".".join(str(part) for part in loc) or "the answer"


def _siblings(loc: tuple[int | str, ...]) -> list[str]:
    """Names of the fields beside a place, found by walking the schema; the name of a union's option is a step too."""
    options = [_schema()]
    for part in loc[:-1]:
        options = [s for o in options for s in _step(o, part)]
    return list(dict.fromkeys(name for o in options for name in o.get("properties", {})))


def _step(node: dict[str, Any], part: int | str) -> list[dict[str, Any]]:
    """The objects that one step of a place may lead to."""
    if isinstance(part, int):
        return _parts(node.get("items", {}))
    if part in node.get("properties", {}):
        return _parts(node["properties"][part])
    tagged = node.get("properties", {}).get("op", {}).get("const")
    return [node] if tagged == part else []


def _parts(node: dict[str, Any]) -> list[dict[str, Any]]:
    """A schema without references and unions."""
    if "$ref" in node:
        return _parts(_schema()["$defs"][str(node["$ref"]).rpartition("/")[2]])
    inner = [o for key in ("anyOf", "oneOf") for o in node.get(key, ()) if "properties" not in node]
    return [p for o in inner for p in _parts(o)] if inner else [node]
