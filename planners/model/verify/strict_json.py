"""Strict JSON decoding: duplicate fields, NaN and infinity, and deep nesting are errors."""

from __future__ import annotations

import json
from typing import Any, NoReturn

MAX_DEPTH = 40  # a query within a query is four levels deeper, so real answers stay far below


class TooDeepError(ValueError):
    """The JSON is nested deeper than `MAX_DEPTH`."""


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    made = dict(pairs)
    if len(made) != len(pairs):
        raise ValueError("a field is given twice")
    return made


def _no_number(name: str) -> NoReturn:
    raise ValueError(f"{name} is no number in JSON")


DECODER = json.JSONDecoder(object_pairs_hook=_unique, parse_constant=_no_number)


def given_only(node: Any, depth: int = 0) -> Any:
    """Remove fields that are null, with which models that must write every field mark omitted ones.

    Raises:
        TooDeepError: nested deeper than `MAX_DEPTH`.
    """
    if depth > MAX_DEPTH:
        raise TooDeepError("the JSON is nested too deeply")
    if isinstance(node, dict):
        return {k: given_only(v, depth + 1) for k, v in node.items() if v is not None}
    return [given_only(item, depth + 1) for item in node] if isinstance(node, list) else node
