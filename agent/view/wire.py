"""Binary messages to the page: columns of slots under a JSON header (docs/view-protocol.md, "Binary messages")."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ...gaussians.cloud import GaussianCloud
from .changes import Changes, Shown
from .columns import columns_of, encode, width
from .preview import Preview
from .slots import EMPTY, I64, ranges_of, slots_of

MAGIC = b"SWV1"
TELLS_EMPTY = ("color", "group")  # the columns that tell an empty slot; its others keep what they held
CHUNK = 65_536  # slots of one message of a load
_RANGE_BYTES = 12  # of a range in the header, about: gaps whose rows take fewer bytes are sent along


@dataclass(frozen=True)
class Part:
    """Rows of one column: its name, ranges `[R, 2]` of slots, and their bytes one after another."""

    column: str
    ranges: I64
    data: bytes


def load(shown: Shown, preview: Preview | None = None) -> Iterator[bytes]:
    """The messages that tell a page everything, made one by one; a preview comes first and goes bit by bit."""
    count = shown.slots.count
    chunks, extra = max(1, -(-count // CHUNK)), preview is not None
    if preview is not None:
        rows = np.arange(len(preview.cloud))
        parts = [_part(preview.cloud, shown, column, count + rows, rows) for column in columns_of(shown.degree)]
        yield message(shown, None, parts, (0, chunks + 1))
    for number in range(chunks):
        first, end = number * CHUNK, min((number + 1) * CHUNK, count)
        slots = np.arange(first, end)
        gone = np.zeros(0, np.int64) if preview is None else count + preview.emptied(first, end)
        parts = []
        for column in columns_of(shown.degree):
            marked = gone if column in TELLS_EMPTY else gone[:0]
            rows = np.concatenate([shown.slots.rows[first:end], np.full(len(marked), EMPTY)])
            parts.append(_part(shown.scene.cloud, shown, column, np.concatenate([slots, marked]), rows))
        yield message(shown, None, parts, (number + extra, chunks + extra))


def _part(cloud: GaussianCloud, shown: Shown, column: str, slots: I64, rows: I64) -> Part:
    """A column of rows `[M]` of a cloud in ascending slots `[M]`."""
    return Part(column, ranges_of(slots), encode(cloud, shown.owner, column, rows))


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
    kind: Literal["columns", "before", "frame"] = "columns",
    more: Mapping[str, Any] | None = None,
) -> bytes:
    """One binary message, with more fields in its header."""
    told: list[dict[str, Any]] = []
    body: list[bytes] = []
    offset = 0
    for part in parts:
        told.append({"column": part.column, "ranges": part.ranges.tolist(), "offset": offset, "bytes": len(part.data)})
        padding = -len(part.data) % 8
        body += [part.data, bytes(padding)]
        offset += len(part.data) + padding
    reach = max((int(part.ranges[-1].sum()) for part in parts if len(part.ranges)), default=0)
    header = {
        "type": kind, "revision": shown.revision, "base": base, "slots": max(shown.slots.count, reach),
        "degree": shown.degree,
        "chunk": list(chunk), "parts": told, **(more or {}),
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
