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
    """One line a field: "- color (optional): text up to 40 characters. A CSS name."."""
    told = []
    for name, field in made.get("properties", {}).items():
        if "const" in field:
            continue
        needed = "" if name in made.get("required", ()) else " (optional)"
        default = field.get("default")
        usual = f", default {json.dumps(default)}" if default not in (None, [], "") else ""
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
        return "one of " + ", ".join(json.dumps(v) for v in field["enum"])
    kind = str(field.get("type", "value"))
    if "prefixItems" in field:
        return "list of " + ", ".join(map(_type, field["prefixItems"]))
    if kind == "array":
        return f"list of at most {field.get('maxItems', 'any number of')}: {_type(field['items'])}"
    limits = " and ".join(form.format(f"{field[key]:g}") for key, form in _LIMITS if key in field)
    return (
        f"{kind} {limits}".strip()
        if kind in ("integer", "number")
        else {"boolean": "true or false", "string": "text"}.get(kind, kind)
    )
