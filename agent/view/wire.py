"""Binary messages to the page: columns of slots under a JSON header (docs/view-protocol.md, "Binary messages")."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from .changes import Changes, Shown
from .columns import columns_of, encode, width
from .slots import I64, ranges_of, slots_of

MAGIC = b"SWV1"
CHUNK = 65_536  # slots of one message of a load
_RANGE_BYTES = 12  # of a range in the header, about: gaps whose rows take fewer bytes are sent along


@dataclass(frozen=True)
class Part:
    """Rows of one column: its name, ranges `[R, 2]` of slots, and their bytes one after another."""

    column: str
    ranges: I64
    data: bytes


def load(shown: Shown) -> Iterator[bytes]:
    """The messages that tell a page everything, made one by one."""
    count = shown.slots.count
    chunks = max(1, -(-count // CHUNK))
    for number in range(chunks):
        first, end = number * CHUNK, min((number + 1) * CHUNK, count)
        ranges = np.array([[first, end - first]], np.int64)
        rows = shown.slots.rows[first:end]
        parts = [
            Part(column, ranges, encode(shown.scene.cloud, shown.owner, column, rows))
            for column in columns_of(shown.degree)
        ]
        yield message(shown, None, parts, (number, chunks))


def change(shown: Shown, base: int, changed: Changes, kind: Literal["columns", "before"] = "columns") -> bytes:
    """The message that turns what a page shows at revision `base` into `shown`."""
    parts = []
    for column, slots in changed.items():
        ranges = ranges_of(slots, _RANGE_BYTES // width(column, shown.degree))
        rows = shown.slots.rows[slots_of(ranges)]
        parts.append(Part(column, ranges, encode(shown.scene.cloud, shown.owner, column, rows)))
    return message(shown, base, parts, (0, 1), kind)


def message(
    shown: Shown,
    base: int | None,
    parts: list[Part],
    chunk: tuple[int, int],
    kind: Literal["columns", "before"] = "columns",
) -> bytes:
    """One binary message."""
    told: list[dict[str, Any]] = []
    body: list[bytes] = []
    offset = 0
    for part in parts:
        told.append({"column": part.column, "ranges": part.ranges.tolist(), "offset": offset, "bytes": len(part.data)})
        padding = -len(part.data) % 8
        body += [part.data, bytes(padding)]
        offset += len(part.data) + padding
    header = {
        "type": kind, "revision": shown.revision, "base": base, "slots": shown.slots.count, "degree": shown.degree,
        "chunk": list(chunk), "parts": told,
    }  # fmt: skip
    text = json.dumps(header, separators=(",", ":")).encode()
    text += b" " * (-(8 + len(text)) % 8)
    return b"".join([MAGIC, len(text).to_bytes(4, "little"), text, *body])


def read(data: bytes) -> tuple[Mapping[str, Any], dict[str, Part]]:
    """The header and the parts of a message by column, for tests and for clients in Python.

    Raises:
        ValueError: it is no such message.
    """
    if data[:4] != MAGIC:
        raise ValueError("not a message of columns")
    begin = 8 + int.from_bytes(data[4:8], "little")
    header = json.loads(data[8:begin])
    parts = {}
    for part in header["parts"]:
        start = begin + part["offset"]
        ranges = np.array(part["ranges"], np.int64).reshape(-1, 2)
        parts[part["column"]] = Part(part["column"], ranges, data[start : start + part["bytes"]])
    return header, parts
