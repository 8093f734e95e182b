"""JSON Schemas of arguments as tool servers and function-calling interfaces take them: small, an object at the root.

Some interfaces refuse `anyOf` at the root of a function's schema, and all schemas are sent to a model with every
request. What is left out here is still checked when the function is called.
"""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

Keywords = dict[str, Any]  # of JSON Schema
_NULL = {"type": "null"}


def argument_schema(model: type[BaseModel], without: tuple[str, ...] = ()) -> Keywords:
    """The schema of a model's fields, without titles, null alternatives, and combinations of fields.

    Args:
        without: fields to leave out.
    """
    made = model.model_json_schema()
    for name in without:
        made["properties"].pop(name, None)
    made["required"] = [name for name in made.get("required", []) if name not in without]
    made.pop("description", None)
    return _compact(made)


def _compact(schema: Keywords) -> Keywords:
    """A schema of an object or value, and all schemas in it, made smaller; what it allows is the same or more."""
    kept = {k: v for k, v in schema.items() if k != "title" and not (k == "default" and v in (None, [], ()))}
    if "properties" in kept:
        kept.pop("anyOf", None)  # combinations of fields; the model's validators check them
        kept["properties"] = {name: _compact(field) for name, field in kept["properties"].items()}
    if "$defs" in kept:
        kept["$defs"] = {name: _compact(definition) for name, definition in kept["$defs"].items()}
    if isinstance(kept.get("items"), dict):
        kept["items"] = _compact(kept["items"])
    if "prefixItems" in kept:
        kept["prefixItems"] = [_compact(item) for item in kept["prefixItems"]]
    if "anyOf" in kept:
        options = [_compact(option) for option in kept.pop("anyOf") if option != _NULL]
        kept = (
            {**kept, **options[0]} if len(options) == 1 and not kept.keys() & options[0] else {**kept, "anyOf": options}
        )
    if not kept.get("required", True):
        del kept["required"]
    return kept


def described_once(schema: Keywords, told: set[str]) -> Keywords:
    """A schema whose shared types are told in full only if they are not among `told`, to which they are added.

    Of those that were told, types that only other types refer to are objects of any kind here.
    """
    if "$defs" not in schema:
        return schema
    outer = _referred({k: v for k, v in schema.items() if k != "$defs"})
    types = {
        name: made if name not in told else _silent(made) if name in outer else {"type": "object"}
        for name, made in schema["$defs"].items()
    }
    told.update(types)
    return {**schema, "$defs": types}


def _referred(schema: Any) -> set[str]:
    """The names of the types that a schema refers to by itself."""
    if isinstance(schema, dict):
        own = {schema["$ref"].rpartition("/")[2]} if isinstance(schema.get("$ref"), str) else set()
        return own.union(*(_referred(v) for v in schema.values()))
    return set[str]().union(*(_referred(v) for v in schema)) if isinstance(schema, list) else set()


def _silent(made: Keywords) -> Keywords:
    """The schema of a type without its description, those of its fields, their limits and their long enumerations:
    they are told where the type is described, and checked when a function is called."""
    fields = {name: _bare(field) for name, field in made.get("properties", {}).items()}
    kept = {k: v for k, v in made.items() if k != "description"}
    return {**kept, "properties": fields} if fields else kept


_LIMITS = frozenset({
    "description", "default", "minLength", "maxLength", "minItems", "maxItems", "minimum", "maximum",
    "exclusiveMinimum", "exclusiveMaximum",
})  # fmt: skip
_LONG = 6  # values of an enumeration


def _bare(schema: Keywords) -> Keywords:
    """A schema of a value with its types alone."""
    kept = {k: v for k, v in schema.items() if k not in _LIMITS and not (k == "enum" and len(v) > _LONG)}
    if isinstance(kept.get("items"), dict):
        kept["items"] = _bare(kept["items"])
    for name in ("anyOf", "prefixItems"):
        if name in kept:
            kept[name] = [_bare(option) for option in kept[name]]
    return kept
