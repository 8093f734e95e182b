"""Describe all operations and their types for the prompt, generated from the schemas that validate them.

No operation is listed here; a new one in the registry appears automatically.
"""

from __future__ import annotations

import inspect
import json
from functools import cache
from typing import Any

from ....tools.registry import OPS

_LIMITS = (("minimum", ">= {}"), ("exclusiveMinimum", "> {}"), ("maximum", "<= {}"), ("exclusiveMaximum", "< {}"))

_WIDE = 1000  # limits as wide as this bar only nonsense, and are left to the validators

_FEW = 2  # longer lists are left to the validators, too


@cache
def described() -> str:
    """All operations with docstring, fields and example, then all types of their fields, in Markdown."""
    parts: list[str] = []
    types: dict[str, dict[str, Any]] = {}
    for name, cls in OPS.items():
        made = cls.model_json_schema()
        words, data = cls.example
        parts += [f"### {name}", made.get("description", "").strip(), *_fields(made)]
        parts += [f"Example: {json.dumps(words)} is {json.dumps(data)}", ""]
        types |= made.get("$defs", {})
    for name, made in types.items():
        parts += [f"### Type {name}", inspect.cleandoc(made.get("description", "")), *_fields(made), ""]
    return "\n".join(parts).strip()


def _fields(made: dict[str, Any]) -> list[str]:
    """One line a field: "- color: text. A CSS name."."""
    told = []
    for name, field in made.get("properties", {}).items():
        if "const" in field:
            continue
        needed = " (required)" if name in made.get("required", ()) else ""
        default = field.get("default")
        usual = f", default {json.dumps(default)}" if default not in (None, [], "", False) else ""
        about = f". {field['description'].strip()}" if field.get("description") else ""
        told.append(f"- {name}{needed}: {_type(field)}{usual}{about}")
    return told


def _type(field: dict[str, Any]) -> str:
    """A schema in a few words."""
    if "$ref" in field:
        return str(field["$ref"]).rpartition("/")[2]
    if "anyOf" in field:
        return " or ".join(_type(f) for f in field["anyOf"] if f.get("type") != "null")
    if "enum" in field:
        return "one of " + ", ".join(map(str, field["enum"]))
    kind = str(field.get("type", "value"))
    if "prefixItems" in field:
        return "list of " + ", ".join(map(_type, field["prefixItems"]))
    if kind == "array":
        most = field.get("maxItems", _WIDE)
        return f"list of {'' if most > _FEW else f'at most {most}: '}{_type(field['items'])}"
    limits = " and ".join(form.format(f"{field[key]:g}") for key, form in _LIMITS if abs(field.get(key, _WIDE)) < _WIDE)
    return (
        f"{kind} {limits}".strip()
        if kind in ("integer", "number")
        else {"boolean": "true or false", "string": "text"}.get(kind, kind)
    )
