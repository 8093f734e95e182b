"""Describe all operations and their types for the prompt, generated from the schemas that validate them.

No operation is listed here; a new one in the registry appears automatically.
"""

from __future__ import annotations

import inspect
import json
import re
from functools import cache
from typing import Any, Literal, get_args

from ....tools.registry import OPS

_LIMITS = (("minimum", ">= {}"), ("exclusiveMinimum", "> {}"), ("maximum", "<= {}"), ("exclusiveMaximum", "< {}"))

_WIDE = 1000  # limits as wide as this bar only nonsense, and are left to the validators

_FEW = 2  # longer lists are left to the validators, too


Detail = Literal["full", "plain", "brief", "terse"]
DETAILS: tuple[Detail, ...] = get_args(Detail)
_SHORT = ("brief", "terse")
_SOME = 12  # values of a list
_CLAUSE = re.compile(r"[.;,]? \(|[.;:] ")
_SENTENCE = re.compile(r"(?<=[.:;])\s")


@cache
def described(detail: Detail = "full") -> str:
    """All operations, and then all types of their fields, in Markdown.

    Args:
        detail: "full": docstring, fields and example of each operation; "plain": without the examples; "brief": the
            docstring's first paragraph, and the fields on one line without their docstrings; "terse": the first
            sentence alone, of fields the first clause, and of long lists of values the first few.
    """
    parts: list[str] = []
    types: dict[str, dict[str, Any]] = {}
    for name, cls in OPS.items():
        made = cls.model_json_schema()
        words, data = cls.example
        if detail == "terse":
            made["description"] = _SENTENCE.split(made["description"], maxsplit=1)[0]
        parts += [f"### {name}", _about(made, detail), *_fields(made, detail)]
        parts += (
            [f"Example: {json.dumps(words)} is {json.dumps(data)}", ""]
            if detail == "full"
            else [""] * (detail == "plain")
        )
        types |= made.get("$defs", {})
    for name, made in types.items():
        parts += [f"### Type {name}", _about(made, detail), *_fields(made, detail), *([""] * (detail not in _SHORT))]
    return "\n".join(parts).strip()


def _about(made: dict[str, Any], detail: Detail) -> str:
    """The docstring of an operation or a type, without the attributes that stand with the fields."""
    text = inspect.cleandoc(made.get("description", "")).partition("\n\nAttributes:")[0]
    return " ".join(text.partition("\n\n")[0].split()) if detail in _SHORT else text


def _attributes(made: dict[str, Any]) -> dict[str, str]:
    """What the docstring of a type says about each field."""
    listed = inspect.cleandoc(made.get("description", "")).partition("\n\nAttributes:\n")[2]
    found: dict[str, str] = {}
    for line in listed.splitlines():
        name, colon, about = line.strip().partition(": ")
        if colon and line.startswith("    ") and not line.startswith("     "):
            found[name] = about
        elif found:
            found[next(reversed(found))] += f" {line.strip()}"
    return found


def _fields(made: dict[str, Any], detail: Detail) -> list[str]:
    """One line a field: "- color: text. A CSS name."; if brief, one line for all."""
    told, listed = [], _attributes(made)
    for name, field in made.get("properties", {}).items():
        if "const" in field:
            continue
        if detail in _SHORT and (name in ("target", "when") or f"`{name}` is" in _about(made, detail)):  # said there
            told.append(name)
            continue
        needed = " (required)" if name in made.get("required", ()) else ""
        default = field.get("default")
        usual = f", default {json.dumps(default)}" if default not in (None, [], "", False) else ""
        usual = usual.replace(", default ", " = ") if detail in _SHORT else usual
        said = field.get("description") or listed.get(name, "")
        # What a type says of its fields is said nowhere else; fields of operations mostly speak for themselves.
        said = _CLAUSE.split(said, maxsplit=1)[0] if detail == "terse" else said
        about = f". {' '.join(said.split())}" if said and (detail not in _SHORT or name in listed) else ""
        told.append(f"{name}{needed}: {_type(field, detail)}{usual}{about}")
    if detail in _SHORT and not listed:
        return ["; ".join(told)] if told else []
    return [f"- {one}" for one in told]


def _type(field: dict[str, Any], detail: Detail = "full") -> str:
    """A schema in a few words; if brief, without the limits of numbers and lists."""
    if "$ref" in field:
        return str(field["$ref"]).rpartition("/")[2]
    if "anyOf" in field:
        said = [_type(f, detail) for f in field["anyOf"] if f.get("type") != "null"]
        return " or ".join(dict.fromkeys(said))
    if "enum" in field and detail in _SHORT:
        some = field["enum"][: _SOME if detail == "terse" else None]
        return "|".join(map(str, some)) + "|..." * (len(some) < len(field["enum"]))
    if "enum" in field:
        return "one of " + ", ".join(map(str, field["enum"]))
    kind = str(field.get("type", "value"))
    if "prefixItems" in field:
        return "list of " + ", ".join(_type(f, detail) for f in field["prefixItems"])
    if kind == "array":
        most = field.get("maxItems", _WIDE)
        few = most <= _FEW and detail not in _SHORT
        return f"list of {f'at most {most}: ' if few else ''}{_type(field['items'], detail)}"
    if detail in _SHORT and kind in ("integer", "number", "boolean"):
        return {"integer": "whole number", "boolean": "flag"}.get(kind, kind)
    limits = " and ".join(form.format(f"{field[key]:g}") for key, form in _LIMITS if abs(field.get(key, _WIDE)) < _WIDE)
    return (
        f"{kind} {limits}".strip()
        if kind in ("integer", "number")
        else {"boolean": "true or false", "string": "text"}.get(kind, kind)
    )
