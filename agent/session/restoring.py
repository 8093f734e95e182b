"""Makes the edits again that a session left in its log without saving them: after a crash, or after it was closed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from ...gaussians.errors import ScenewrightError
from .log import Record, read_log
from .log_sessions import LoggedSession, sessions_of
from .replay import edit_of, point_again, replay_edits

if TYPE_CHECKING:
    from .session import Session

_WORK = frozenset({"do", "undo", "redo", "save", "select"})  # what a person does in a session


def unfinished(log: str | Path) -> LoggedSession | None:
    """The session before the last one of a log, if that began with the same scene and its work is nowhere else.

    A session that was cut off while it made the edits of another again counts as none.

    Raises:
        FileError: the log cannot be read.
    """
    *earlier, own = sessions_of(read_log(log))
    for session in reversed(earlier):
        kinds = {record["kind"] for record in session.records}
        if not kinds & _WORK or ("restore" in kinds and "restored" not in kinds):
            continue
        begins = own.records[0]
        if not session.begins_with({"digest": begins.get("digest")}) or _saved(session):
            return None
        return session if session.edits or session.undone or selection_of(session) is not None else None
    return None


def restore(session: Session, earlier: LoggedSession, note: Callable[[str], None]) -> None:
    """Make the edits of an earlier session of the log again, with what can be redone and what "it" referred to; tells
    how that went.

    Edits that cannot be made again are left out, and told; they stay in the log.
    """
    assert session.log_path is not None
    session.note_restoring(earlier.id)
    made = session.replay(session.log_path, session=earlier.number - 1, skip_failed=True)
    failed = [r for r in made if r.error is not None]
    for lost in failed:
        note(f"could not be made again: {lost.text!r} ({lost.error})")
    for done in made:
        if done.note:
            note(done.note)
    if not failed:
        _redoable(session, earlier, note)
    if (last := selection_of(earlier)) is not None and not failed:
        _select(session, last)
    session.note_restoring(None)
    count = len(made) - len(failed)
    if count:
        note(f"made {count} unsaved edit{'s' if count > 1 else ''} of {earlier.describe()} again; undo takes them back")


def _redoable(session: Session, earlier: LoggedSession, note: Callable[[str], None]) -> None:
    """Make what was undone at the end of an earlier session again, and undo it, so that it can be redone."""
    assert session.log_path is not None
    log = session.log_path
    try:
        again = replay_edits(session, [edit_of(record, log) for record in earlier.undone], skip_failed=False)
    except ScenewrightError as error:  # those before it were made and undone
        note(f"what was undone cannot all be redone ({error})")
        return
    for _ in again:
        session.undo()


def selection_of(session: LoggedSession) -> Record | None:
    """The record of what was pointed at in the last state of a session; None if nothing was since its last edit."""
    stack: list[Record | None] = [None]
    undone: list[Record | None] = []
    for record in session.records:
        if record["kind"] == "do":
            stack.append(None)
            undone.clear()
        elif record["kind"] == "undo" and len(stack) > 1:
            undone.append(stack.pop())
        elif record["kind"] == "redo" and undone:
            stack.append(undone.pop())
        elif record["kind"] == "select":
            stack[-1] = record
    return stack[-1]


def _saved(session: LoggedSession) -> bool:
    """Whether the last change of a session was saved."""
    changing = [record["kind"] for record in session.records if record["kind"] in ("do", "undo", "redo", "save")]
    return changing[-1:] == ["save"]


def _select(session: Session, record: Record) -> None:
    """Let "it" refer to what a `select` record says, where the scene is the same."""
    groups = tuple(record.get("groups") or ())
    try:
        if groups or record.get("ids"):
            session.embed("edit")
        if session.digest != record.get("before"):
            return
        if record.get("ids"):
            point_again(session, record["ids"])
        elif groups:
            session.remember(groups)
        else:
            session.point(None)
    except ScenewrightError:
        return  # a selection is not worth more than a note, and what it was is in the log
