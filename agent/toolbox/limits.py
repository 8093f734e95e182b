"""Limits on the arguments of a call, checked before anything else looks at them: size, depth, numbers, characters."""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BaseModel, Field, ValidationError

from ...gaussians.errors import UserError

MAX_TEXT = 4000  # characters of one string, as in an edit plan
MAX_TOTAL = 65_536  # characters of all strings of a call
MAX_VALUES = 4096  # values in a call
MAX_DEPTH = 40  # a query with relations nested eight deep has 33 levels
MAX_NUMBER = 2**53  # a larger integer is not exact in JSON

Text = Annotated[str, Field(min_length=1, max_length=MAX_TEXT)]


class ArgumentError(UserError):
    """The arguments of a call are not valid; the message names the first ones and what they allow."""


def check_arguments(arguments: object) -> dict[str, Any]:
    """The arguments, if they are a plain JSON object within the limits.

    Raises:
        ArgumentError: they are not; the message says which limit is exceeded.
    """
    if not isinstance(arguments, Mapping):
        raise ArgumentError(f"the arguments must be a JSON object, not {type(arguments).__name__}")
    characters = values = 0
    waiting: list[tuple[object, int]] = [(arguments, 1)]
    while waiting:
        value, depth = waiting.pop()
        values += 1
        if isinstance(value, Mapping):
            inside: list[object] = [*value.keys(), *value.values()]
        elif isinstance(value, list | tuple):
            inside = list(value)
        else:
            characters += _check_scalar(value)
            inside = []
        if depth > MAX_DEPTH or values + len(waiting) + len(inside) > MAX_VALUES or characters > MAX_TOTAL:
            raise ArgumentError(
                f"the arguments are too large: at most {MAX_DEPTH} levels, {MAX_VALUES:,} values and "
                f"{MAX_TOTAL:,} characters"
            )
        waiting.extend((item, depth + 1) for item in inside)
    return {str(name): value for name, value in arguments.items()}


def _check_scalar(value: object) -> int:
    """The characters of a value that is no container. Raises ArgumentError if it is not one that JSON has."""
    if isinstance(value, str):
        if len(value) > MAX_TEXT:
            raise ArgumentError(f"a text has {len(value):,} characters; at most {MAX_TEXT:,} are allowed")
        if any(c not in "\n\t" and unicodedata.category(c) in ("Cc", "Cs") for c in value):
            raise ArgumentError("a text holds control characters or broken Unicode; send plain text")
        return len(value)
    if isinstance(value, bool) or value is None:
        return 0
    if isinstance(value, int | float):
        if not abs(value) <= MAX_NUMBER:  # also false of NaN
            raise ArgumentError("a number is not finite or is larger than 2^53")
        return 0
    raise ArgumentError(f"a value is of type {type(value).__name__}, which JSON does not have")


def complaint(error: ValidationError, tool: str) -> ArgumentError:
    """A validation error in one sentence that names the first wrong fields."""
    told = [f"{'.'.join(str(p) for p in e['loc']) or 'arguments'}: {e['msg']}"[:300] for e in error.errors()[:4]]
    return ArgumentError(f"not valid arguments of {tool} ({'; '.join(told)})")


class Arguments(BaseModel):
    """Base of the arguments of a tool: immutable, and no unknown names."""

    model_config = {"frozen": True, "extra": "forbid", "use_attribute_docstrings": True}
