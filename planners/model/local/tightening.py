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
_FARTHEST = 10**6  # numbers without bounds of their own


@dataclass(frozen=True)
class Limits:
    """How far a schema is drawn in.

    Attributes:
        chars: of a string.
        items: of a list; lists of what can hold itself get a quarter at each step inward, but two at least.
        nesting: how many steps what can hold itself may go inward; "the cup on the table beside the sofa" takes 5.
        decimals: of a number.
    """

    chars: int = 240
    items: int = 24
    nesting: int = 5
    decimals: int = 3


def tighten(schema: Schema, limits: Limits | None = None) -> Schema:
    """The smaller schema; descriptions and defaults are gone.

    Raises:
        ValueError: a keyword is unknown here, a part says nothing, or nothing fits the limits.
    """
    work = _Tightening(schema, limits or Limits())
    root = work.of({k: v for k, v in schema.items() if k != "$defs"}, work.limits.nesting)
    if root is None:
        raise ValueError("nothing fits this schema within the limits")
    definitions = {name: made for name, made in work.made.items() if made is not None}
    return {**root, "$defs": definitions}


class _Tightening:
    """One schema at work; `left` is how many steps inward are left."""

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
            return _kept(node) | {"maxLength": min(node.get("maxLength", self.limits.chars), self._chars(node))}
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
        """An object of one alternative; optional properties that nothing fits are left out."""
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
        bounds = {"minimum": -_FARTHEST, "maximum": _FARTHEST}
        for inner, outer in (("exclusiveMinimum", "minimum"), ("exclusiveMaximum", "maximum")):
            if inner in node:
                del bounds[outer]
        step = {"multipleOf": 10**-self.limits.decimals} if node["type"] == "number" else {}
        return step | bounds | _kept(node)

    def _tag_unions(self, schema: Schema) -> None:
        """Require of each union's options the property that tells them apart, a constant in each."""
        for node in list(_nodes(schema)):
            options = [option.get("$ref", "").removeprefix(_PREFIX) for option in node.get("oneOf", [])]
            constants = [self._constants(name) for name in options]
            tags = sorted(set.intersection(*constants)) if constants else []
            for name in options if tags else ():
                option = self.given[name]
                self.given[name] = {**option, "required": [*tags, *option.get("required", [])]}

    def _constants(self, name: str) -> set[str]:
        """Names of the properties of a definition that can have one value only."""
        fields: dict[str, Schema] = self.given.get(name, {}).get("properties", {})
        return {field for field, node in fields.items() if "const" in node}


def _narrowed(field: Schema, narrowing: Schema) -> Schema:
    """A property under an alternative: one that says what the property is replaces it, one of bounds only joins in."""
    whole = narrowing.keys() & {"$ref", "type", "enum", "const", "anyOf"}
    return narrowing if whole else field | narrowing


def _any_of(options: list[Schema]) -> Schema | None:
    if len(options) < 2:
        return options[0] if options else None
    return {"anyOf": options}


def _kept(node: Schema) -> Schema:
    """A node without its words for readers."""
    return {key: value for key, value in node.items() if key not in _WORDS}


def _nodes(value: Any) -> Iterator[Schema]:
    """Every object of a JSON value that may be a schema."""
    if isinstance(value, dict):
        yield value
    for inner in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        yield from _nodes(inner)


def _references(node: Schema) -> set[str]:
    """Names of the definitions a node refers to; tags of a union repeat those of its options."""
    return {n["$ref"].removeprefix(_PREFIX) for n in _nodes(node) if isinstance(n.get("$ref"), str)}


def _reached(definitions: dict[str, Schema], name: str) -> set[str]:
    """Names of the definitions that a definition refers to, however far."""
    found: set[str] = set()
    fresh = _references(definitions[name])
    while fresh:
        found |= fresh
        fresh = set().union(*(_references(definitions[n]) for n in fresh)) - found
    return found
