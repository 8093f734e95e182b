"""The sessions in a log: their ids and edits, which of them a new session continues, and what is wrong with the log."""

from __future__ import annotations

import secrets
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...gaussians.errors import UserError
from .log import LogContent, Record, SessionLog, open_fields, read_log

if TYPE_CHECKING:
    from .history import State


@dataclass(frozen=True)
class LoggedSession:
    """One session of a log.

    Attributes:
        number: its place in the log, from 1.
        id: its id; "" in logs of versions without ids.
        records: its records, in order.
    """

    number: int
    id: str
    records: tuple[Record, ...]

    @property
    def edits(self) -> list[Record]:
        """The `do` records that were not undone, or were redone; oldest first."""
        return self._steps()[0]

    @property
    def undone(self) -> list[Record]:
        """The `do` records that were undone and can be redone; the one that is redone first comes first."""
        return self._steps()[1][::-1]

    def _steps(self) -> tuple[list[Record], list[Record]]:
        """The `do` records that hold, and those that were undone, each in the order in which that happened."""
        done: list[Record] = []
        undone: list[Record] = []
        for record in self.records:
            if record["kind"] == "do":
                done.append(record)
                undone.clear()
            elif record["kind"] == "undo" and done:
                undone.append(done.pop())
            elif record["kind"] == "redo" and undone:
                done.append(undone.pop())
        return done, undone

    def describe(self) -> str:
        """The session in words: "session 2 (1f00c0de, 3 edits)"."""
        many = len(self.edits)
        edits = f"{many} edit{'s' if many != 1 else ''}"
        return f"session {self.number} ({self.id}, {edits})" if self.id else f"session {self.number} ({edits})"

    def to_json(self) -> dict[str, Any]:
        return {"number": self.number, "id": self.id, "edits": len(self.edits)}

    def begins_with(self, fields: dict[str, Any]) -> bool:
        """Whether it began with the scene of an `open` record's fields."""
        first = self.records[0]
        return first["kind"] == "open" and first.get("digest") == fields["digest"]

    def ends_with(self, fields: dict[str, Any]) -> bool:
        """Whether it ended with the scene of an `open` record's fields, in memory or in the file that it saved last."""
        if not self.edits:
            return False
        digests = [r.get("after") or r.get("digest") for r in self.records if r.get("after") or r.get("digest")]
        last = self.records[-1]
        saved = last["kind"] == "save" and last.get("file") is not None and last["file"] == fields["file"]
        return saved or digests[-1:] == [fields["digest"]]


def sessions_of(content: LogContent) -> tuple[LoggedSession, ...]:
    """The sessions of a log, in order."""
    return tuple(
        LoggedSession(number, str(records[0].get("session") or ""), tuple(records))
        for number, records in enumerate(content.sessions(), start=1)
    )


def logged_session(log: str | Path, which: int | str = -1) -> LoggedSession:
    """One session of a log.

    Args:
        which: counted from the first (0) or the last (-1); or, as text, its id or its number from "1".

    Raises:
        FileError: the log cannot be read.
        UserError: it holds no such session; the message lists those that it holds.
    """
    sessions = sessions_of(read_log(log))
    if not sessions:
        raise UserError(f"{log} holds no session; give a log written with --log")
    if isinstance(which, int):
        if -len(sessions) <= which < len(sessions):
            return sessions[which]
    elif named := [s for s in sessions if s.id == which] or [s for s in sessions if str(s.number) == which]:
        return named[-1]
    held = ", ".join(s.describe().removeprefix("session ") for s in sessions[-8:])
    raise UserError(f"{log} holds {len(sessions)} sessions; there is no session {which}, but {held}")


def problems(content: LogContent) -> tuple[str, ...]:
    """What is wrong with a log, a sentence for each: lines that are broken, records that are missing or repeated, and
    records that begin with another scene than the record before them left."""
    found = list(content.damage)
    before: Record | None = None
    at: str | None = None
    for record in content.records:
        seq = record["seq"]
        if before is not None and seq != before["seq"] + 1:
            found.append(f"record {seq} follows record {before['seq']}: records are missing, or are not in order")
        begins = record.get("digest") if record["kind"] == "save" else record.get("before")
        if record["kind"] != "open" and None not in (at, begins) and begins != at:
            told = f" ({record['text']!r})" if record.get("text") else ""
            found.append(f"record {seq}{told} begins with another scene than the record before it left")
        at = record.get("after") or record.get("digest") or at
        before = record
    return tuple(found)


@dataclass(frozen=True)
class Beginning:
    """What a new session takes over from the log that it writes to.

    Attributes:
        notes: sentences for the user.
        context: the last instruction of the session that it continues, "" if it continues none.
        groups: the groups that "it" referred to at the end of that one.
        gaussians: how many Gaussians these had; groups with another number of them are not the same.
    """

    notes: tuple[str, ...] = ()
    context: str = ""
    groups: tuple[int, ...] = ()
    gaussians: int = 0


def begin(log: SessionLog, state: State) -> Beginning:
    """Write the `open` record of a session that begins with `state`. It continues the last session of the log if that
    ended with the same scene, in memory or in the file that it saved last."""
    fields = open_fields(state)
    sessions = sessions_of(log.found)
    own: dict[str, Any] = {"session": secrets.token_hex(4), "continues": None, **fields}
    told = [f"in the log {log.path}: {problem}" for problem in problems(log.found)]
    last = sessions[-1] if sessions else None
    if last is None or not last.ends_with(fields):
        if last is not None:
            told.append(_anew(len(sessions), last, own["session"], fields))
        log.append("open", own)
        return Beginning(tuple(told))
    log.append("open", {**own, "continues": last.id or None})
    done = last.edits[-1]
    text, left = str(done["text"]), done.get("selection") or {}
    told.append(f"session {own['session']} goes on where {last.describe()} of the log ended, after {text!r}")
    return Beginning(tuple(told), text, tuple(left.get("groups", ())), left.get("gaussians", 0))


def _anew(count: int, last: LoggedSession, own: str, fields: dict[str, Any]) -> str:
    """A sentence about a session that begins anew in a log with others."""
    told = f"session {own} begins in a log that holds {count} before it"
    if last.edits and last.begins_with(fields):
        told += f"; {last.describe()} began with this scene, and replaying it makes its edits again"
    return told
