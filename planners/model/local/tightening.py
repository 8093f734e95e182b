"""Tighten a JSON Schema (as pydantic writes it) for constrained decoding, so that answers are valid and end soon.

A model under constrained decoding may fill every list to its limit. Therefore bounds are reduced, numbers get a maximum
number of decimals (otherwise "0.000…" never ends), recursion is unrolled to a depth, the tag of a union becomes
required, and alternatives beside `properties` are multiplied out. The result allows a subset of the given schema.
Unknown keywords are errors, since ignoring one would allow too much.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

Schema = dict[str, Any]

_WORDS = {"title", "description", "default", "examples", "discriminator", "$schema", "$defs", "$comment", "deprecated"}
_BOUNDS = {"minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum", "multipleOf"}
_KNOWN = {
    "string": {"minLength", "maxLength", "pattern"},
    "number": _BOUNDS,
    "integer": _BOUNDS,
    "array": {"items", "prefixItems", "minItems", "maxItems"},
    "object": {"properties", "required", "additionalProperties", "anyOf"},
    "boolean": set[str](),
    "null": set[str](),
}
_PREFIX = "#/$defs/"
_MAX_NUMBER = 10**6  # bound of the absolute value of numbers without bounds


@dataclass(frozen=True)
class Limits:
    """Bounds of a tightened schema.

    Attributes:
        chars: maximum length of a string.
        items: maximum length of a list; lists of recursive types get a quarter per level of nesting, but at least two.
        nesting: maximum depth of recursive types; "the cup on the table beside the sofa" needs 5.
        decimals: maximum decimals of a number.
    """

    chars: int = 240
    items: int = 24
    nesting: int = 5
    decimals: int = 3


def tighten(schema: Schema, limits: Limits | None = None) -> Schema:
    """Tighten a schema; descriptions and defaults are removed.

    Raises:
        ValueError: a keyword is unknown, a part has no type, or nothing fits the limits.
    """
    work = _Tightening(schema, limits or Limits())
    root = work.of({k: v for k, v in schema.items() if k != "$defs"}, work.limits.nesting)
    if root is None:
        raise ValueError("nothing fits this schema within the limits")
    definitions = {name: made for name, made in work.made.items() if made is not None}
    return {**root, "$defs": definitions}


class _Tightening:
    """State of tightening one schema; `left` is the remaining depth of recursion."""

    def __init__(self, schema: Schema, limits: Limits) -> None:
        self.limits = limits
        self.given: dict[str, Schema] = dict(schema.get("$defs", {}))
        self.made: dict[str, Schema | None] = {}
        self._recursive = {name for name in self.given if name in _reached(self.given, name)}
        self._tag_unions(schema)

    def of(self, node: Schema, left: int) -> Schema | None:
        """The tightened node; None if nothing fits it."""
        if "$ref" in node:
            return self._reference(node["$ref"].removeprefix(_PREFIX), left)
        if "const" in node or "enum" in node:
            return {"enum": node.get("enum", [node.get("const")])}
        if "properties" not in node and ("anyOf" in node or "oneOf" in node):
            return self._union(node, left)
        kind = node.get("type")
        if kind not in _KNOWN:
            raise ValueError(f"cannot tighten a schema without a plain type: {sorted(node)}")
        if unknown := node.keys() - _WORDS - _KNOWN[kind] - {"type"}:
            raise ValueError(f"cannot tighten {sorted(unknown)} of a schema of type {kind}")
        if kind == "object":
            return self._object(node, left)
        if kind == "array":
            return self._array(node, left)
        if kind == "string":
            return _without_descriptions(node) | {
                "maxLength": min(node.get("maxLength", self.limits.chars), self._chars(node))
            }
        if kind in ("number", "integer"):
            return self._number(node)
        return {"type": kind}

    def _reference(self, name: str, left: int) -> Schema | None:
        left -= name in self._recursive
        if left < 0:
            return None
        key = f"{name}.{left}"
        if key not in self.made:
            self.made[key] = self.of(self.given[name], left)
        return None if self.made[key] is None else {"$ref": _PREFIX + key}

    def _union(self, node: Schema, left: int) -> Schema | None:
        if unknown := node.keys() - _WORDS - {"anyOf", "oneOf", "type"}:
            raise ValueError(f"cannot tighten {sorted(unknown)} beside a union")
        made = [self.of(option, left) for option in node.get("anyOf") or node["oneOf"]]
        return _any_of([option for option in made if option is not None])

    def _object(self, node: Schema, left: int) -> Schema | None:
        made = [self._closed(node, alternative, left) for alternative in node.get("anyOf", [{}])]
        return _any_of([option for option in made if option is not None])

    def _closed(self, node: Schema, narrowing: Schema, left: int) -> Schema | None:
        """An object of one alternative; optional properties that no value fits are omitted."""
        if unknown := narrowing.keys() - {"properties", "required"}:
            raise ValueError(f"cannot tighten {sorted(unknown)} of an alternative")
        required = [*node.get("required", []), *narrowing.get("required", [])]
        properties = {}
        for name, field in node.get("properties", {}).items():
            made = self.of(_narrowed(field, narrowing.get("properties", {}).get(name, {})), left)
            if made is None and name in required:
                return None
            if made is not None and (name in required or made.get("maxItems") != 0):
                properties[name] = made
        ordered = [name for name in properties if name in required]
        return {"type": "object", "properties": properties, "required": ordered, "additionalProperties": False}

    def _array(self, node: Schema, left: int) -> Schema | None:
        if "prefixItems" in node:
            return self._tuple(node, left)
        items, least = self.of(node["items"], left), node.get("minItems", 0)
        if items is None:
            return None if least else {"type": "array", "maxItems": 0}
        most = min(node.get("maxItems", self.limits.items), max(least, self._items(node["items"], left)))
        return {"type": "array", "items": items, "minItems": least, "maxItems": most}

    def _tuple(self, node: Schema, left: int) -> Schema | None:
        """An array of fixed length, as pydantic writes tuples."""
        items = [self.of(item, left) for item in node["prefixItems"]]
        if not node.get("minItems") == node.get("maxItems") == len(items):
            raise ValueError("cannot tighten prefixItems of no fixed length")
        if any(item is None for item in items):
            return None
        return {"type": "array", "prefixItems": items, "items": False, "minItems": len(items), "maxItems": len(items)}

    def _items(self, item: Schema, left: int) -> int:
        inward = self.limits.nesting - left
        holds_itself = any(name in self._recursive for name in _references(item))
        return max(2, self.limits.items >> (2 * inward)) if holds_itself else self.limits.items

    def _chars(self, node: Schema) -> int:
        return max(self.limits.chars, node.get("minLength", 0))

    def _number(self, node: Schema) -> Schema:
        bounds = {"minimum": -_MAX_NUMBER, "maximum": _MAX_NUMBER}
        for inner, outer in (("exclusiveMinimum", "minimum"), ("exclusiveMaximum", "maximum")):
            if inner in node:
                del bounds[outer]
        step = {"multipleOf": 10**-self.limits.decimals} if node["type"] == "number" else {}
        return step | bounds | _without_descriptions(node)

    def _tag_unions(self, schema: Schema) -> None:
        """Make the tag of each union, a property that is constant in every option, required in its options."""
        for node in list(_nodes(schema)):
            options = [option.get("$ref", "").removeprefix(_PREFIX) for option in node.get("oneOf", [])]
            constants = [self._constants(name) for name in options]
            tags = sorted(set.intersection(*constants)) if constants else []
            for name in options if tags else ():
                option = self.given[name]
                self.given[name] = {**option, "required": [*tags, *option.get("required", [])]}

    def _constants(self, name: str) -> set[str]:
        """Names of the properties of a definition that are constants."""
        fields: dict[str, Schema] = self.given.get(name, {}).get("properties", {})
        return {field for field, node in fields.items() if "const" in node}


def _narrowed(field: Schema, narrowing: Schema) -> Schema:
    """A property under an alternative: a narrowing with a type replaces it, one with bounds only is merged."""
    whole = narrowing.keys() & {"$ref", "type", "enum", "const", "anyOf"}
    return narrowing if whole else field | narrowing


def _any_of(options: list[Schema]) -> Schema | None:
    if len(options) < 2:
        return options[0] if options else None
    return {"anyOf": options}


def _without_descriptions(node: Schema) -> Schema:
    """A node without its descriptive keywords."""
    return {key: value for key, value in node.items() if key not in _WORDS}


def _nodes(value: Any) -> Iterator[Schema]:
    """Every object of a JSON value that may be a schema."""
    if isinstance(value, dict):
        yield value
    for inner in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        yield from _nodes(inner)


def _references(node: Schema) -> set[str]:
    """Names of the definitions that a node refers to by `$ref`."""
    return {n["$ref"].removeprefix(_PREFIX) for n in _nodes(node) if isinstance(n.get("$ref"), str)}


def _reached(definitions: dict[str, Schema], name: str) -> set[str]:
    """Names of the definitions that a definition refers to, directly or indirectly."""
    found: set[str] = set()
    fresh = _references(definitions[name])
    while fresh:
        found |= fresh
        fresh = set().union(*(_references(definitions[n]) for n in fresh)) - found
    return found
