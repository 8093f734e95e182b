"""Which fields of a model go together, published in its JSON Schema as the alternatives that they are.

"Exactly one of direction, toward and place" is a validator in Python; a program or a language model that reads only the
schema would never learn of it. Knows schemas. Refuses to validate: the validators do, and say what is wrong in words.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

Keywords = dict[str, Any]  # of JSON Schema
NOT_GIVEN: Keywords = {"type": "null"}


@dataclass(frozen=True)
class Given:
    """A field that is there and not null, and meets `keywords` besides."""

    keywords: Keywords


def given(**keywords: Any) -> Given:
    """The field is there and not null; `keywords` of JSON Schema narrow what it may be."""
    return Given(keywords)


def nonzero(limit: float) -> Given:
    """The field is there, a number from -limit to limit but not 0."""
    signs = ({"exclusiveMinimum": 0, "maximum": limit}, {"minimum": -limit, "exclusiveMaximum": 0})
    return given(anyOf=[{"type": "number", **sign} for sign in signs])


def either(*alternatives: dict[str, Given | Keywords]) -> Callable[[Keywords], None]:
    """One of the alternatives holds: for `json_schema_extra` of a model's configuration.

    Each maps names of fields to `given(...)`, to `NOT_GIVEN`, or to keywords that the field meets if it is there;
    fields that it does not name are free. They are published under `anyOf`, beside the properties they narrow.
    """

    def publish(schema: Keywords) -> None:
        schema["anyOf"] = [_branch(schema["properties"], wanted) for wanted in alternatives]

    return publish


def _branch(fields: Keywords, wanted: dict[str, Given | Keywords]) -> Keywords:
    required = [name for name, what in wanted.items() if isinstance(what, Given)]
    properties = {n: _present(fields[n], w.keywords) if isinstance(w, Given) else dict(w) for n, w in wanted.items()}
    return {"properties": properties, **({"required": required} if required else {})}


def _present(field: Keywords, keywords: Keywords) -> Keywords:
    """What a field may be besides null: the keywords if they say so, else what its own schema says."""
    if keywords or "anyOf" not in field:
        return keywords
    kept = [option for option in field["anyOf"] if option != NOT_GIVEN]
    return kept[0] if len(kept) == 1 else {"anyOf": kept}
