"""What all replies of language models share: the JSON object in an answer, its bare schema, faults, printable text."""

from __future__ import annotations

import unicodedata
from collections.abc import Callable, Sequence
from typing import Any

from pydantic import ValidationError

from .strict_json import DECODER, TooDeepError, given_only

MAX_CHARS = 65_536  # of an answer; the longest plans are a tenth of it
_FAULTS = 4  # reported at once
_FAULT_CHARS = 500  # of each; that is enough for the names of all operations
_UNTOLD = ("title", "description", "examples", "default")  # keywords left out of schemas; the prompts cover them

Location = tuple[int | str, ...]


class ReplyError(ValueError):
    """An answer is not a valid reply. The message is for the model: short, which field, and what it allows."""


def given_object(text: str) -> dict[str, Any]:
    """The only JSON object in an answer, possibly in a code fence or between text without braces, without nulls.

    It must start at the first brace, and no brackets may follow it. Trying later braces could take a part of a broken
    answer for the whole.

    Raises:
        ReplyError: there is none, more than one, or it is no strict JSON.
    """
    if len(text) > MAX_CHARS:
        raise ReplyError(f"the answer has {len(text)} characters, at most {MAX_CHARS} are read; answer shorter")
    start = text.find("{")
    if start < 0:
        raise ReplyError("the answer holds no JSON object; answer with one JSON object and nothing else")
    try:
        found, end = DECODER.raw_decode(text, start)
        if any(c in text[:start] + text[end:] for c in "{}[]"):
            raise ReplyError("the answer holds more than one JSON object; answer with one and nothing else")
        given: dict[str, Any] = given_only(found)
    except (TooDeepError, RecursionError) as error:
        raise ReplyError("the JSON is nested too deeply") from error
    except ReplyError:
        raise
    except ValueError as error:
        raise ReplyError(f"the answer is no valid JSON: {str(error)[:_FAULT_CHARS]}") from error
    return given


def bare(node: Any) -> Any:
    """A schema without descriptive keywords; properties with such names are kept."""
    if isinstance(node, list):
        return [bare(item) for item in node]
    if not isinstance(node, dict):
        return node
    named = {k: {n: bare(v) for n, v in node[k].items()} for k in ("properties", "$defs") if k in node}
    return {k: bare(v) for k, v in node.items() if k not in (*_UNTOLD, *named)} | named


def told(error: ValidationError, siblings: Callable[[Location], Sequence[str]]) -> str:
    """The first few errors as text for the model, each with its field and what it allows.

    Args:
        siblings: names of the fields at the level of a location.
    """
    faults = error.errors(include_url=False, include_input=False)
    lines = [f"{_place(f['loc'])}: {_fault(f, siblings)}"[:_FAULT_CHARS] for f in faults[:_FAULTS]]
    return "\n".join([*lines, *([f"and {len(faults) - _FAULTS} more"] if len(faults) > _FAULTS else [])])


def _fault(fault: Any, siblings: Callable[[Location], Sequence[str]]) -> str:
    if fault["type"] == "extra_forbidden":
        return f"there is no such field here; fields are {', '.join(siblings(fault['loc']))}"
    return str(fault["msg"]).removeprefix("Value error, ")


def _place(loc: Location) -> str:
    return ".".join(str(part) for part in loc) or "the answer"


def printable(text: str, most: int) -> str:
    """A model's text made printable: one line, without control and formatting characters, truncated to `most`."""
    line = " ".join("".join(" " if unicodedata.category(c)[0] == "C" else c for c in text).split())
    return line if len(line) <= most else line[: most - 1] + "…"
