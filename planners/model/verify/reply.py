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
from .json_reply import MAX_CHARS as MAX_CHARS
from .json_reply import Location, bare, given_object, told
from .json_reply import ReplyError as ReplyError

_HESITANT = ("absent", "ambiguous")


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
    made: dict[str, Any] = bare(Reply.model_json_schema())
    for definition in made["$defs"].values():
        if "const" in definition["properties"].get("op", {}):  # `op` has a default in our types; models must write it
            definition["required"] = ["op", *definition.get("required", [])]
    return made


def schema() -> dict[str, Any]:
    """The JSON Schema of `Reply` for `ModelBackend.answer`, without descriptions, which the prompt contains."""
    return dict(_schema())


def read(text: str) -> Reply:
    """Parse the reply in an answer: one JSON object, possibly in a code fence or between text without braces.

    Fields that are null count as omitted. Everything else must be valid for the type.

    Raises:
        ReplyError: there is no object, more than one, or it is not valid.
    """
    try:
        return Reply.model_validate(given_object(text))
    except ValidationError as error:
        raise ReplyError(told(error, _siblings)) from error


def _siblings(loc: Location) -> list[str]:
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
