"""The session log: one JSON object a line, appended and never rewritten.

`SessionLog` writes each record durably (one write, then fsync); `read_log` also reads a log that a crash cut short.
Secrets are removed before anything is written: see `scrub`.

Schema version 1. Every record has `v`, `seq` (1, 2, ... through the file), `time` (UTC, ISO 8601) and `kind`:

    open    session, continues, scenewright, scene (path or null), gaussians, digest, file
                                                                     a session begins; undo never goes back before it
    embed   encoder, things, before, after                           a language field was added to the scene; no edit
    do      text, it, it_ids, plan, viewer, said_at, receipts, selection, before, after, seconds
                                                                     an instruction was carried out
    failed  text, plan (or null), error, message, before             an instruction was refused; nothing was changed
    select  groups, gaussians, ids, before                           "it" was pointed at; no edit
    restore session                                                  the edits of an earlier session are made again
    restored                                                         they are all made
    undo    text, before, after                                      the last `do` was undone
    redo    text, before, after                                      the last `undo` was redone
    save    path, digest, file                                       the scene was written to a file

`session` is the id of the session, `continues` that of the earlier one that ended with this scene, or null; `file` is
the SHA-256 digest of the scene file's bytes; `it` and `selection` are what "it" referred to before and after, and
`it_ids` and `ids` its Gaussians (`packed_ids`), null where they are those of its groups; `viewer`
is the camera in whose frame left, right, in front and behind were meant (see `viewer_fields`); `said_at` is the time
of a scene with motion at which it was said, in seconds, null where none was set. Logs of earlier versions
lack some of these. `before` and `after` are SHA-256 digests of the cloud, so that a reader can check that the records
form a chain. The functions `*_fields` give the fields of a record. A session without a log does not call them, as
digests of large clouds take time.
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
from typing import TYPE_CHECKING, Any, Self

from ...gaussians.errors import FileError, ScenewrightError, UserError
from .log_lock import LogLock

if TYPE_CHECKING:
    from ...gaussians.camera import Camera
    from ...planners.plan import EditPlan
    from .history import State
    from .result import Result

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
    """An append-only log file. Each record is on the disk when `append` returns.

    An existing log is continued: its records stay and the numbering goes on. If a crash cut the last line short, the
    next record begins on a new line, so that the damaged line does not spoil it. Until it is closed, no other session
    can open the log.

    Attributes:
        found: what the log held when it was opened.

    Raises:
        FileError: the file cannot be opened or written, or another session has it open.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        self._fd = -1
        self._lock = LogLock(self.path)
        try:
            self._open()
        except BaseException:
            self.close()
            raise

    def _open(self) -> None:
        try:
            self.found = read_log(self.path) if self.path.exists() else LogContent((), ())
            self._fd = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_APPEND | getattr(os, "O_CLOEXEC", 0), 0o644)
        except OSError as error:
            raise FileError(f"cannot open the session log {self.path}: {error.strerror}") from error
        self._torn = _ends_torn(self.path)
        self._seq = max((r["seq"] for r in self.found.records), default=0)

    def append(self, kind: str, fields: Mapping[str, Any]) -> Record:
        """Write one record and force it to the disk; returns it as written.

        Raises:
            FileError: nothing, or not all of it, could be written (disk full, log closed).
        """
        record: Record = {"v": SCHEMA_VERSION, "seq": self._seq + 1, "time": _now(), "kind": kind, **fields}
        record = _clean(record)
        line = json.dumps(record, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
        data = (b"\n" if self._torn else b"") + line.encode() + b"\n"
        self._torn = True  # until every byte is written
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
        self._lock.release()

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
    """`text` without anything that looks like an API key or equals a secret in an environment variable.

    >>> scrub("use sk-abcdefghijklmnopqrstuvwx please")
    'use [secret removed] please'
    """
    for name, value in os.environ.items():
        if len(value) >= 8 and _SECRET_NAME.search(name):
            text = text.replace(value, _HIDDEN)
    return _SECRET_SHAPE.sub(_HIDDEN, text)


def open_fields(state: State) -> dict[str, Any]:
    """Fields of `open`."""
    from ... import __version__

    scene = state.scene
    return {
        "scenewright": __version__,
        "scene": str(scene.path) if scene.path else None,
        "gaussians": len(scene.cloud),
        "digest": state.digest,
        "file": _file_digest(scene.path),
    }


def embed_fields(before: State, after: State) -> dict[str, Any]:
    """Fields of `embed`; the scene of `after` has a language field."""
    language = after.scene.language
    assert language is not None
    things = len(language.objects())
    return {"encoder": language.encoder, "things": things, "before": before.digest, "after": after.digest}


def do_fields(result: Result, before: State, after: State) -> dict[str, Any]:
    """Fields of `do`. The plan holds its planner, prompt hash and model usage."""
    left = result.selection
    return {
        "text": result.text,
        "it": list(before.last.groups) if before.last is not None else [],
        "it_ids": _packed(before),
        "plan": result.plan.model_dump(mode="json") if result.plan is not None else None,
        "viewer": viewer_fields(result.viewer),
        "said_at": result.said_at,
        "receipts": [r.model_dump(mode="json") for r in result.receipts],
        "selection": {"groups": list(left.groups), "gaussians": len(left)} if left is not None else None,
        "before": before.digest,
        "after": after.digest,
        "seconds": dict(result.seconds),
    }


def select_fields(state: State) -> dict[str, Any]:
    """Fields of `select`."""
    last = state.last
    groups, count = ([], 0) if last is None else (list(last.groups), len(last))
    return {"groups": groups, "gaussians": count, "ids": _packed(state), "before": state.digest}


def _packed(state: State) -> str | None:
    """The Gaussians of what "it" refers to, packed; None if they are those of its groups, or there are none."""
    last, field = state.last, state.scene.language
    if last is None or not len(last):
        return None
    if field is not None and len(last) == sum(field.groups[g].count for g in last.groups):
        return None
    from .packed_ids import pack

    return pack(last.ids)


def viewer_fields(camera: Camera) -> dict[str, Any]:
    """A camera as JSON, exact to the last bit: `world_to_camera` as four rows, the other fields as of `Camera`."""
    pose = [[float(x) for x in row] for row in camera.world_to_camera]
    lens = {name: float(getattr(camera, name)) for name in ("fx", "fy", "cx", "cy")}
    size = {"width": int(camera.width), "height": int(camera.height), "name": camera.name}
    return {"world_to_camera": pose, **lens, **size}


def viewer_of(record: Record) -> Camera | None:
    """The viewer of a `do` record; None if it has none, or none that is a camera."""
    import numpy as np

    from ...gaussians.camera import Camera

    fields = record.get("viewer")
    if not isinstance(fields, dict):
        return None
    try:
        return Camera(**{**fields, "world_to_camera": np.array(fields["world_to_camera"], dtype=np.float64)})
    except (KeyError, TypeError, ValueError, UserError):
        return None


def said_at_of(record: Record) -> float | None:
    """The time at which a `do` record was said; None if it has none that is a number."""
    time = record.get("said_at")
    return float(time) if isinstance(time, int | float) and math.isfinite(time) else None


def failed_fields(text: str, plan: EditPlan | None, error: ScenewrightError, state: State) -> dict[str, Any]:
    """Fields of `failed`."""
    return {
        "text": text,
        "plan": plan.model_dump(mode="json") if plan else None,
        "error": type(error).__name__,
        "message": str(error),
        "before": state.digest,
    }


def step_fields(text: str, before: State, after: State) -> dict[str, Any]:
    """Fields of `undo` and `redo`."""
    return {"text": text, "before": before.digest, "after": after.digest}


def save_fields(path: str | Path, state: State) -> dict[str, Any]:
    """Fields of `save`."""
    return {"path": str(path), "digest": state.digest, "file": _file_digest(Path(path))}


def _file_digest(path: Path | None) -> str | None:
    """The digest of a scene file's bytes; None if it is no longer there."""
    from ...gaussians.files.fingerprint import fingerprint

    if path is None or not path.exists():
        return None
    return fingerprint(path)


def _clean(value: Any) -> Any:
    """Plain JSON of `value`: secrets removed, NaN and infinities as null (JSON cannot represent them)."""
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
