"""The queries inside an operation or another query: walked, exchanged, changed.

A node is a pydantic model, a tuple of nodes, or any other value, which holds no query.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from pydantic import BaseModel

from .query import Query

Path = tuple[str | int, ...]  # field names and positions that lead from a node to one of its queries


def queries(node: Any, path: Path = ()) -> Iterator[tuple[Path, Query]]:
    """Every query in a node and where it stands, those inside another query before it."""
    if isinstance(node, BaseModel):
        for name in type(node).model_fields:
            yield from queries(getattr(node, name), (*path, name))
        if isinstance(node, Query):
            yield path, node
    elif isinstance(node, tuple):
        for i, item in enumerate(node):
            yield from queries(item, (*path, i))


def exchange(node: Any, path: Path, query: Query | tuple[Query, ...]) -> Any:
    """`node` with the query, or the tuple of queries, at `path` exchanged; everything else is shared."""
    if not path:
        return query
    key, rest = path[0], path[1:]
    if isinstance(key, int):
        return tuple(exchange(item, rest, query) if i == key else item for i, item in enumerate(node))
    return node.model_copy(update={key: exchange(getattr(node, key), rest, query)})


def with_queries(node: Any, change: Callable[[Query], Query]) -> Any:
    """`node` with every query changed, inner ones first; what does not change is shared."""
    if isinstance(node, tuple):
        return tuple(with_queries(item, change) for item in node)
    if not isinstance(node, BaseModel):
        return node
    old = {name: getattr(node, name) for name in type(node).model_fields}
    new = {name: made for name, value in old.items() if (made := with_queries(value, change)) != value}
    node = node.model_copy(update=new) if new else node
    return change(node) if isinstance(node, Query) else node


def without_confirmation(node: Any) -> Any:
    """`node` with no query confirmed: only a user confirms, see `Query.confirmed`."""
    return with_queries(node, lambda q: q.model_copy(update={"confirmed": False}) if q.confirmed else q)
