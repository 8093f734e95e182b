"""JSON Schemas of plans, scene graphs, operations, queries and briefs, for language models and other programs.

Each schema is generated from the pydantic model that validates the data.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from typing import Any

from ..gaussians.errors import UserError
from ..gaussians.language.query.query import Query
from ..tools import registry
from .compose.brief import Brief
from .plan import EditPlan
from .rooms.graph import SceneGraph

_DIALECT = "https://json-schema.org/draft/2020-12/schema"
_MAKERS: dict[str, Callable[[], dict[str, Any]]] = {
    "plan": EditPlan.model_json_schema,
    "graph": SceneGraph.model_json_schema,
    "ops": registry.schema,
    "query": Query.model_json_schema,
    "brief": Brief.model_json_schema,
}
NAMES = tuple(_MAKERS)


def schema(name: str) -> dict[str, Any]:
    """The JSON Schema named "plan" (edit plan), "graph" (scene graph), "ops" (one operation), "query" or "brief".

    The description of an operation is its docstring and an example in words; `examples` holds the example as JSON.

    Raises:
        UserError: there is no schema of this name.
    """
    if name not in _MAKERS:
        raise UserError(f"there is no schema {name!r}; schemas are {', '.join(NAMES)}")
    made: dict[str, Any] = json.loads(_text(name))
    return made


@cache
def _text(name: str) -> str:
    """A schema as JSON. Each caller of `schema` gets its own copy: generating one takes a tenth of a second."""
    made = _MAKERS[name]()
    known = {cls.__name__: cls for cls in registry.OPS.values()}
    for title, definition in made.get("$defs", {}).items():
        if title in known:
            words, data = known[title].example
            example = f"{json.dumps(words)} is {json.dumps(data)}"
            definition["description"] = f"{definition.get('description', '').strip()}\n\nExample: {example}"
            definition["examples"] = [data]
    return json.dumps({"$schema": _DIALECT, **made})
