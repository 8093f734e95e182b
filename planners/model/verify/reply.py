"""The reply type of a language model: its JSON Schema, its parser, and error messages for the model.

A reply is a verdict with operations or the reason why there are none. Nothing invalid is repaired or guessed here.
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
_FAULTS = 4  # reported at once
_FAULT_CHARS = 240  # of each
_HESITANT = ("absent", "ambiguous")
_UNTOLD = ("title", "description", "examples", "default")  # keywords left out of the schema; the prompt covers them


class ReplyError(ValueError):
    """An answer is not a valid reply. The message is for the model: short, which field, and what it allows."""


class Reply(BaseModel):
    """What the model answers.

    Attributes:
        verdict: "ok" with operations; every other verdict without, except that "absent" and "ambiguous" may hold the
            operations that were meant, so that the user can be shown what there is.
        reason: one sentence for the user; required for every verdict but "ok".
        unknown: words of the instruction that were not understood.
        ops: operations in order.
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
        if "const" in definition["properties"].get("op", {}):  # `op` has a default in our types; models must write it
            definition["required"] = ["op", *definition.get("required", [])]
    return made


def schema() -> dict[str, Any]:
    """The JSON Schema of `Reply` for `ModelBackend.answer`, without descriptions, which the prompt contains."""
    return dict(_schema())


def _bare(node: Any) -> Any:
    """A schema without descriptive keywords; properties with such names are kept."""
    if isinstance(node, list):
        return [_bare(item) for item in node]
    if not isinstance(node, dict):
        return node
    named = {k: {n: _bare(v) for n, v in node[k].items()} for k in ("properties", "$defs") if k in node}
    return {k: _bare(v) for k, v in node.items() if k not in (*_UNTOLD, *named)} | named


def read(text: str) -> Reply:
    """Parse the reply in an answer: one JSON object, possibly in a code fence or between text without braces.

    Fields that are null count as omitted. Everything else must be valid for the type.

    Raises:
        ReplyError: there is no object, more than one, or it is not valid.
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
    """The only JSON object in a text.

    It must start at the first brace, and no brackets may follow it. Trying later braces could take a part of a broken
    answer for the whole.
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
    """The first few errors as text for the model, each with its field and what it allows."""
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
    """Names of the fields at the level of `loc`, from the schema; the tag of a union's option is a step of its own."""
    options = [_schema()]
    for part in loc[:-1]:
        options = [s for o in options for s in _step(o, part)]
    return list(dict.fromkeys(name for o in options for name in o.get("properties", {})))


def _step(node: dict[str, Any], part: int | str) -> list[dict[str, Any]]:
    """The object schemas that one step of a location may lead to."""
    if isinstance(part, int):
        return _parts(node.get("items", {}))
    if part in node.get("properties", {}):
        return _parts(node["properties"][part])
    tagged = node.get("properties", {}).get("op", {}).get("const")
    return [node] if tagged == part else []


def _parts(node: dict[str, Any]) -> list[dict[str, Any]]:
    """The alternatives of a schema, with references and unions resolved."""
    if "$ref" in node:
        return _parts(_schema()["$defs"][str(node["$ref"]).rpartition("/")[2]])
    inner = [o for key in ("anyOf", "oneOf") for o in node.get(key, ()) if "properties" not in node]
    return [p for o in inner for p in _parts(o)] if inner else [node]
