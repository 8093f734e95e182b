"""Reads the edits of a logged session that were not undone, as plans that can be run on another scene.

The whole session is read before the first plan is run.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import torch
from torch import Tensor

from ...gaussians.errors import FileError, ScenewrightError
from ...gaussians.language.query.nested import exchange, queries
from .log import Record, said_at_of, viewer_of
from .log_sessions import LoggedSession, logged_session
from .packed_ids import unpack
from .plan_runner import has_queries
from .refusal import with_message
from .result import Result

if TYPE_CHECKING:
    from ...gaussians.camera import Camera
    from ...gaussians.language.query.selection import Selection
    from ...gaussians.scene import Scene
    from ...planners.plan import EditPlan


@dataclass(frozen=True)
class Replay:
    """A session of a log that is to be replayed."""

    log: Path
    session: LoggedSession


@dataclass(frozen=True)
class Replayed:
    """One instruction of a replay: its result on this scene, or the error; a note if it led to another scene than the
    log says."""

    text: str
    result: Result | None
    error: ScenewrightError | None
    note: str = ""


@dataclass(frozen=True)
class LoggedEdit:
    """An edit of a logged session: its words, its plan, the digests of the cloud before and after it, the groups that
    "it" referred to, which a question or a selection between edits may have set, the viewer it was meant for, the
    packed Gaussians of "it" where they are not those of the groups, and the time at which it was said."""

    text: str
    plan: EditPlan
    before: str | None
    it: tuple[int, ...] = ()
    after: str | None = None
    viewer: Camera | None = None
    it_ids: str | None = None
    said_at: float | None = None

    def plan_for(self, digest: str) -> EditPlan:
        """The plan for the cloud with this digest; on another cloud than the logged one, without group ids."""
        return self.plan if self.before == digest else portable(self.plan)

    def difference(self, before: str, after: str) -> str:
        """A sentence if the same cloud as the logged one was edited to another one; else ""."""
        if before != self.before or self.after in (None, after):
            return ""
        return f"{self.text!r} led to another scene than in the log: the digests do not match"


def logged_edits(log: str | Path, session: int | str) -> list[LoggedEdit]:
    """The edits of a session that were not undone, oldest first.

    Args:
        session: which of the sessions in the log, as `logged_session` takes it.

    Raises:
        FileError: the log cannot be read.
        UserError: it holds no such session.
    """
    return [edit_of(record, log) for record in logged_session(log, session).edits]


def edit_of(record: Record, log: str | Path) -> LoggedEdit:
    """The edit of a `do` record of a log; raises FileError if this version cannot read its plan."""
    return LoggedEdit(
        str(record["text"]),
        read_plan(record, log),
        record.get("before"),
        tuple(record.get("it") or ()),
        record.get("after"),
        viewer_of(record),
        record.get("it_ids"),
        said_at_of(record),
    )


class Edited(Protocol):
    """The part of `session.Session` that a replay uses."""

    said_at: float | None

    @property
    def digest(self) -> str: ...
    @property
    def last(self) -> Selection | None: ...
    @property
    def viewer(self) -> Camera: ...
    @viewer.setter
    def viewer(self, camera: Camera) -> None: ...
    def embed(self, then: str | None = None) -> Scene: ...
    def remember(self, groups: tuple[int, ...]) -> None: ...
    def point(self, ids: Tensor | None) -> Selection | None: ...
    def apply(self, plan: EditPlan) -> Result: ...
    def undo(self) -> Result: ...


def replay_edits(session: Edited, edits: Sequence[LoggedEdit], skip_failed: bool) -> list[Replayed]:
    """Carry out logged edits on a session; see `Session.replay`.

    On the cloud that they were made on, each is carried out for the viewer and at the time that it was meant for, so
    that "left" and "there" mean the same; on another cloud for the session's own, which it has afterwards too.
    """
    own = session.viewer, session.said_at
    try:
        return _replayed(session, edits, skip_failed, own)
    finally:
        session.viewer, session.said_at = own


def _replayed(
    session: Edited, edits: Sequence[LoggedEdit], skip_failed: bool, own: tuple[Camera, float | None]
) -> list[Replayed]:
    """See `replay_edits`."""
    outcome: list[Replayed] = []
    for edit in edits:
        try:
            if has_queries(edit.plan):
                session.embed("edit")  # as the edit did, so that the groups are those of the log
            before = session.digest
            if edit.it_ids and before == edit.before:
                point_again(session, edit.it_ids)
            elif edit.it and before == edit.before and (session.last is None or session.last.groups != edit.it):
                session.embed()
                session.remember(edit.it)
                before = session.digest
            if edit.viewer is not None and before == edit.before:
                session.viewer, session.said_at = edit.viewer, edit.said_at
            else:
                session.viewer, session.said_at = own
            result = session.apply(edit.plan_for(before))
            outcome.append(Replayed(edit.text, result, None, edit.difference(before, session.digest)))
        except ScenewrightError as error:
            if not skip_failed:
                for _ in outcome:
                    session.undo()
                message = f"replay stopped at {edit.text!r}, all of it was undone: {error}"
                raise with_message(error, message) from error
            outcome.append(Replayed(edit.text, None, error))
    return outcome


def point_again(session: Edited, packed: str) -> None:
    """Let "it" refer to the Gaussians that a log has packed, if it does not yet; a text that is none is passed over."""
    try:
        ids = unpack(packed)
    except ValueError:
        return
    if session.last is None or not torch.equal(session.last.ids, ids):
        session.point(ids)


def read_plan(record: Record, source: str | Path) -> EditPlan:
    """The plan of a `do` record.

    Raises:
        FileError: the record has no plan that this version can read.
    """
    from pydantic import ValidationError

    from ...planners.plan import EditPlan

    try:
        return EditPlan.model_validate(record["plan"])
    except (KeyError, ValidationError) as error:
        raise FileError(f"{source}: record {record['seq']} holds no plan this version can read ({error})") from error


def portable(plan: EditPlan) -> EditPlan:
    """The plan without group ids and confirmations, which are valid in one scene only; its words are resolved again."""
    ops = []
    for op in plan.ops:
        for path, query in list(queries(op)):
            if query.groups or query.confirmed:
                op = exchange(op, path, query.model_copy(update={"groups": (), "confirmed": False}))
        ops.append(op)
    return plan.model_copy(update={"ops": tuple(ops)})
