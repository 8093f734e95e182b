"""JSON Schema of what planners exchange, as a language model or another program reads it.

Knows the pydantic models and what each operation says of itself. Refuses to state anything twice: the schema is that of
the very models that validate.
"""

from __future__ import annotations

import json
from collections.abc import Callable
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
    """The JSON Schema of an edit plan ("plan"), a scene graph, one operation ("ops"), a query or a
    brief of a room to compose.

    An operation's description is its docstring and an example in words; `examples` holds the same as JSON.

    Raises:
        UserError: there is no such schema.
    """
    if name not in _MAKERS:
        raise UserError(f"there is no schema {name!r}; schemas are {', '.join(NAMES)}")
    made = _MAKERS[name]()
    known = {cls.__name__: cls for cls in registry.OPS.values()}
    for title, definition in made.get("$defs", {}).items():
        if title in known:
            words, data = known[title].example
            example = f"{json.dumps(words)} is {json.dumps(data)}"
            definition["description"] = f"{definition.get('description', '').strip()}\n\nExample: {example}"
            definition["examples"] = [data]
    return {"$schema": _DIALECT, **made}
