"""Keeps the tables of a LALR parser in the user's cache folder: building them takes half a second, reading them 20 ms.

The file is JSON and is named after the grammar and lark's version, so that it never answers for another grammar.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any

import lark
from lark import Lark
from lark.grammar import Rule
from lark.lexer import Lexer, TerminalDef

from ...gaussians.user_cache import user_cache


def load_parser(grammar: str, lexer: type[Lexer]) -> Lark:
    """The parser of a grammar, from its stored tables where there are any; else it is built and its tables stored."""
    path = tables_path(grammar)
    with suppress(Exception):  # whatever is wrong with the file, the tables can be built again
        return _restored(json.loads(path.read_bytes()), lexer)
    parser = Lark(grammar, parser="lalr", lexer=lexer)
    with suppress(OSError):  # without a cache folder the tables are built in every process
        _write(path, _stored(parser))
    return parser


def tables_path(grammar: str) -> Path:
    """Path of the stored tables of a grammar."""
    mark = hashlib.sha256(f"{lark.__version__};{grammar}".encode()).hexdigest()[:24]
    return user_cache("grammar", f"{mark}.json")


def _stored(parser: Lark) -> dict[str, Any]:
    """A parser as JSON. Keys that are numbers, which JSON has not, become pairs."""
    data, memo = parser.memo_serialize([TerminalDef, Rule])
    del data["options"]["lexer"], data["parser"]["lexer_conf"]["lexer_type"]
    table = data["parser"]["parser"]
    table["states"] = [(state, list(actions.items())) for state, actions in table["states"].items()]
    table["tokens"] = list(table["tokens"].items())
    return {"data": data, "memo": list(memo.items())}


def _restored(stored: dict[str, Any], lexer: type[Lexer]) -> Lark:
    """The parser that `_stored` was given."""
    data = stored["data"]
    data["options"]["lexer"] = data["parser"]["lexer_conf"]["lexer_type"] = lexer
    table = data["parser"]["parser"]
    table["states"] = {state: dict(actions) for state, actions in table["states"]}
    table["tokens"] = dict(table["tokens"])
    parser: Lark = Lark._load_from_dict(data, dict(stored["memo"]))  # type: ignore[no-untyped-call]
    return parser


def _write(path: Path, content: dict[str, Any]) -> None:
    """Write the file whole or not at all: other processes may write it at the same time."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent)
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            json.dump(content, file, separators=(",", ":"))
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
