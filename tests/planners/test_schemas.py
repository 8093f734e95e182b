"""Schemas are strict and bounded everywhere, and hold what each operation says of itself."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from scenewright.gaussians.errors import UserError
from scenewright.planners.schemas import NAMES, schema
from scenewright.tools import registry


def unbounded(node: Any, path: str = "") -> Iterator[str]:
    """Every place of a schema where a string, an array or a number has no limit, or an object takes any field."""
    if isinstance(node, list):
        for i, item in enumerate(node):
            yield from unbounded(item, f"{path}[{i}]")
    if not isinstance(node, dict):
        return
    kind = node.get("type")
    closed = "const" in node or "enum" in node
    if kind == "string" and not closed and "maxLength" not in node:
        yield f"{path}: string without maxLength"
    if kind == "array" and "maxItems" not in node:
        yield f"{path}: array without maxItems"
    if kind in ("integer", "number") and not closed:
        low, high = {"minimum", "exclusiveMinimum"} & node.keys(), {"maximum", "exclusiveMaximum"} & node.keys()
        if not low or not high:
            yield f"{path}: number without both limits"
    if kind == "object" and node.get("additionalProperties") is not False:
        yield f"{path}: object that takes any field"
    for key, value in node.items():
        if key not in ("examples", "default", "example", "mapping"):
            yield from unbounded(value, f"{path}.{key}")


@pytest.mark.parametrize("name", NAMES)
def test_everything_is_bounded_and_closed(name: str) -> None:
    assert list(unbounded(schema(name))) == []


@pytest.mark.parametrize(
    "loose",
    [
        {"type": "string"},
        {"type": "array", "items": {"type": "boolean"}},
        {"type": "number", "minimum": 0},
        {"type": "object", "properties": {}},
        {"anyOf": [{"type": "null"}, {"type": "integer", "maximum": 3}]},
    ],
)
def test_the_walk_sees_what_is_loose(loose: dict[str, Any]) -> None:
    assert len(list(unbounded({"$defs": {"Loose": loose}}))) == 1


@pytest.mark.parametrize("name", ["plan", "ops"])
def test_each_operation_tells_what_it_does_and_gives_a_valid_example(name: str) -> None:
    definitions = schema(name)["$defs"]
    for op, cls in registry.OPS.items():
        told = definitions[cls.__name__]
        assert (cls.__doc__ or "").strip().split("\n")[0] in told["description"]
        assert cls.example[0] in told["description"]
        (example,) = told["examples"]
        assert registry.parse(example).op == op


def test_unknown_schema_is_refused() -> None:
    with pytest.raises(UserError, match="plan, graph, ops, query"):
        schema("sceen")
