"""The atomic operations of the registry as tools: one tool an operation, with the operation's own schema."""

from __future__ import annotations

import inspect
import json
from collections.abc import Callable
from typing import Any

from ...gaussians.errors import UserError
from ...gaussians.language.query.nested import without_confirmation
from ...planners.plan import EditPlan
from ...tools import registry
from ...tools.operation import EditOp, Length
from . import views
from .limits import ArgumentError
from .reply import Reply, edited
from .schemas import argument_schema
from .tool import Desk, Hints, Tool

PICTURE = {"type": "boolean", "default": False, "description": "Also return a picture of the scene afterwards."}
_BY_WORDS = "select"  # the tool of this name takes words too (see `instructions.py`)
_REMOVES = frozenset({"delete", "isolate", "replace"})
_ABSOLUTE = frozenset({"isolate"})  # done twice, they are as done once


def operation_tools() -> list[Tool]:
    """A tool for each operation of the registry, in alphabetical order."""
    return [_tool(name, op) for name, op in registry.OPS.items() if name != _BY_WORDS]


def _tool(name: str, op: type[EditOp]) -> Tool:
    words, data = op.example
    example = json.dumps({k: v for k, v in data.items() if k != "op"}, ensure_ascii=False)
    schema = argument_schema(op, without=("op",))
    schema["properties"] = {**schema["properties"], "picture": PICTURE}
    described = f'{inspect.cleandoc(op.__doc__ or "")}\n\nExample: "{words}" is {example}'
    return Tool(name, described, schema, _runs(name), Hints(False, name in _REMOVES, name in _ABSOLUTE))


def _runs(name: str) -> Callable[[Desk, dict[str, Any]], Reply]:
    def run(desk: Desk, given: dict[str, Any]) -> Reply:
        op, picture = _parsed(name, given)
        plan = EditPlan(instruction=operation_words(op), ops=(op,), planner="agent")
        result = desk.session.apply(plan)
        return edited(result, (views.after_edit(result),) if picture else ())

    return run


def _parsed(name: str, given: dict[str, Any]) -> tuple[EditOp, bool]:
    """The operation, and whether a picture is wanted. Raises UserError naming the wrong fields."""
    fields = {k: v for k, v in given.items() if k != "picture"}
    picture = given.get("picture", False)
    if not isinstance(picture, bool):
        raise ArgumentError(f"not valid arguments of {name} (picture: must be true or false)")
    if fields.pop("op", name) != name:
        raise ArgumentError(f"not valid arguments of {name} (op: this tool does nothing but {name})")
    try:
        return without_confirmation(registry.parse({"op": name, **fields})), picture
    except UserError as error:
        raise ArgumentError(str(error)) from error


def operation_words(op: EditOp) -> str:
    """The operation in words, for the history and the log: "move it: direction up, distance 0.45 m"."""
    fields = op.model_dump(exclude_defaults=True, exclude={"op", "target"}, mode="json")
    more = ", ".join(f"{name} {_in_words(getattr(op, name), value)}" for name, value in fields.items())
    return (f"{op.op} {op.subject()}: {more}" if more else f"{op.op} {op.subject()}")[:400]


def _in_words(field: object, dumped: Any) -> str:
    """A field as a person writes it: a text without quotation marks, a length with its unit; others as JSON."""
    if isinstance(field, Length):
        return f"{field.value:g} {field.unit}"
    return dumped if isinstance(dumped, str) else json.dumps(dumped, ensure_ascii=False)
