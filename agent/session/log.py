"""The session log: one JSON object a line, appended and never rewritten.

Knows how to make a record durable (one write, then fsync) and how to read a log that a crash cut short. Refuses to know
what a plan or a receipt means: it stores what it is given as plain JSON. Secrets never reach the disk: see `scrub`.

Schema version 1. Every record has `v`, `seq` (1, 2, ... through the file), `time` (UTC, ISO 8601) and `kind`:

    open    scenewright, scene (path or null), gaussians, digest     a session begins; undo never crosses it
    embed   encoder, things, before, after                           language was laid over the scene; no edit
    do      text, plan, receipts, before, after, seconds             an instruction was carried out
    failed  text, plan (or null), error, message, before             an instruction was refused; nothing was changed
    undo    text, before, after                                      the last `do` was taken back
    redo    text, before, after                                      and done again
    save    path, digest                                             the scene was written to a file

`before` and `after` are SHA-256 digests of the cloud, so that a reader can check that the records form a chain.
"""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from ...gaussians.errors import FileError

SCHEMA_VERSION = 1
Record = dict[str, Any]

_SECRET_NAME = re.compile(r"(API_?KEY|TOKEN|SECRET|PASSWORD)$", re.IGNORECASE)
_SECRET_SHAPE = re.compile(r"\b(?:sk|pk|hf|ghp|gsk|AIza)[-_]?[A-Za-z0-9_-]{20,}")
_HIDDEN = "[secret removed]"


@dataclass(frozen=True)
class LogContent:
    """What a log file holds.

    Attributes:
        records: the intact records, in order.
        damage: one sentence for each line that could not be read ("line 7 is cut short after 113 bytes").
    """

    records: tuple[Record, ...]
    damage: tuple[str, ...]

    def sessions(self) -> list[list[Record]]:
        """The records split at each `open`."""
        parts: list[list[Record]] = []
        for record in self.records:
            if record["kind"] == "open" or not parts:
                parts.append([])
            parts[-1].append(record)
        return parts


class SessionLog:
    """An append-only log file. Each `append` is on the disk when it returns.

    An existing log is continued: its records stay, numbering goes on. A last line that a crash cut short is left as it
    is and closed with a line break, so that it can never swallow the record written after it.

    Raises:
        FileError: the file cannot be opened or written.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        try:
            content = read_log(self.path) if self.path.exists() else LogContent((), ())
            self._fd = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_APPEND | getattr(os, "O_CLOEXEC", 0), 0o644)
        except OSError as error:
            raise FileError(f"cannot open the session log {self.path}: {error.strerror}") from error
        self._torn = _ends_torn(self.path)
        self._seq = max((r["seq"] for r in content.records), default=0)

    def append(self, kind: str, fields: Mapping[str, Any]) -> Record:
        """Write one record and force it to the disk; returns it as written.

        Raises:
            FileError: nothing, or not all of it, could be written (disk full, log closed).
        """
        record: Record = {"v": SCHEMA_VERSION, "seq": self._seq + 1, "time": _now(), "kind": kind, **fields}
        record = _clean(record)
        line = json.dumps(record, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
        data = (b"\n" if self._torn else b"") + line.encode() + b"\n"
        self._torn = True  # until every byte is out
        try:
            while data:
                data = data[os.write(self._fd, data) :]
            os.fsync(self._fd)
        except OSError as error:
            raise FileError(f"cannot write the session log {self.path}: {error.strerror}") from error
        self._torn = False
        self._seq += 1
        return record

    def close(self) -> None:
        """Close the file; closing twice is harmless."""
        if self._fd >= 0:
            os.close(self._fd)
            self._fd = -1

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, tb: TracebackType | None) -> None:
        self.close()


def read_log(path: str | os.PathLike[str]) -> LogContent:
    """Read every intact record; report the rest instead of failing on it.

    Raises:
        FileError: the file is missing, unreadable, or written by a later version of the schema.
    """
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise FileError(f"cannot read the session log {path}: {error.strerror}") from error
    records: list[Record] = []
    damage: list[str] = []
    for number, line in enumerate(data.split(b"\n"), start=1):
        if not line.strip():
            continue
        record = _parse(line)
        if record is None:
            damage.append(f"line {number} is not a whole record ({len(line)} bytes): cut short by a crash, or edited")
        elif record["v"] > SCHEMA_VERSION:
            raise FileError(f"{path} was written by a later version (schema {record['v']}); update Scenewright")
        else:
            records.append(record)
    return LogContent(tuple(records), tuple(damage))


def scrub(text: str) -> str:
    """`text` without anything that looks like a key or equals a secret of the environment.

    >>> scrub("use sk-abcdefghijklmnopqrstuvwx please")
    'use [secret removed] please'
    """
    for name, value in os.environ.items():
        if len(value) >= 8 and _SECRET_NAME.search(name):
            text = text.replace(value, _HIDDEN)
    return _SECRET_SHAPE.sub(_HIDDEN, text)


def _clean(value: Any) -> Any:
    """Plain JSON of `value`: secrets removed, NaN and infinities as null (JSON has no word for them)."""
    if isinstance(value, str):
        return scrub(value)
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): _clean(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_clean(item) for item in value]
    return value


def _parse(line: bytes) -> Record | None:
    """The record on a line, or None if it is not a whole one."""
    try:
        record = json.loads(line)
    except ValueError:
        return None
    whole = isinstance(record, dict) and isinstance(record.get("v"), int) and isinstance(record.get("seq"), int)
    return record if whole and isinstance(record.get("kind"), str) else None


def _ends_torn(path: Path) -> bool:
    """Whether the file's last line lacks its line break."""
    with path.open("rb") as file:
        if file.seek(0, os.SEEK_END) == 0:
            return False
        file.seek(-1, os.SEEK_END)
        return file.read(1) != b"\n"


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")
