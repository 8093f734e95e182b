"""Publish in a model's JSON Schema which combinations of its fields are allowed.

"Exactly one of direction, toward and place" is a validator in Python; a program or a language model that reads only the
schema does not see it. This module only writes schemas: the validators check values and write the error messages.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

Keywords = dict[str, Any]  # of JSON Schema
NOT_GIVEN: Keywords = {"type": "null"}


@dataclass(frozen=True)
class Given:
    """A field that is present, not null and meets the JSON Schema `keywords`."""

    keywords: Keywords


def given(**keywords: Any) -> Given:
    """The field is present and not null; `keywords` of JSON Schema narrow its values."""
    return Given(keywords)


def nonzero(limit: float) -> Given:
    """The field is present and a number from -limit to limit, but not 0."""
    signs = ({"exclusiveMinimum": 0, "maximum": limit}, {"minimum": -limit, "exclusiveMaximum": 0})
    return given(anyOf=[{"type": "number", **sign} for sign in signs])


def either(*alternatives: dict[str, Given | Keywords]) -> Callable[[Keywords], None]:
    """The value of `json_schema_extra` in a model's configuration that says: at least one of the alternatives holds.

    Each alternative maps names of fields to `given(...)`, to `NOT_GIVEN`, or to keywords that the field meets if it is
    present; fields that it does not name are free. They are published under `anyOf`, beside the narrowed properties.
    """

    def publish(schema: Keywords) -> None:
        schema["anyOf"] = [_branch(schema["properties"], wanted) for wanted in alternatives]

    return publish


def _branch(fields: Keywords, wanted: dict[str, Given | Keywords]) -> Keywords:
    required = [name for name, what in wanted.items() if isinstance(what, Given)]
    properties = {n: _present(fields[n], w.keywords) if isinstance(w, Given) else dict(w) for n, w in wanted.items()}
    return {"properties": properties, **({"required": required} if required else {})}


def _present(field: Keywords, keywords: Keywords) -> Keywords:
    """The schema of a field that is not null: the keywords if there are any, else its own schema without null."""
    if keywords or "anyOf" not in field:
        return keywords
    kept = [option for option in field["anyOf"] if option != NOT_GIVEN]
    return kept[0] if len(kept) == 1 else {"anyOf": kept}
