"""Reads the edits of a logged session that were not undone, as plans that can be run on another scene.

The whole session is read before the first plan is run.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ...gaussians.errors import FileError, ScenewrightError, UserError
from ...gaussians.language.query.nested import exchange, queries
from .log import Record, read_log
from .result import Result

if TYPE_CHECKING:
    from ...planners.plan import EditPlan


@dataclass(frozen=True)
class Replayed:
    """One instruction of a replay: its result on this scene, or the error."""

    text: str
    result: Result | None
    error: ScenewrightError | None


@dataclass(frozen=True)
class LoggedEdit:
    """An edit of a logged session: its words, its plan, the digest of the cloud before it, and the groups that "it"
    referred to, which a question or a selection between edits may have set."""

    text: str
    plan: EditPlan
    before: str | None
    it: tuple[int, ...] = ()

    def plan_for(self, digest: str) -> EditPlan:
        """The plan for the cloud with this digest; on another cloud than the logged one, without group ids."""
        return self.plan if self.before == digest else portable(self.plan)


def logged_edits(log: str | Path, session: int) -> list[LoggedEdit]:
    """The edits of a session that were not undone, oldest first.

    Args:
        session: which of the sessions in the log, counted from the first (0) or the last (-1).

    Raises:
        FileError: the log cannot be read.
        UserError: it holds no such session.
    """
    sessions = read_log(log).sessions()
    if not sessions:
        raise UserError(f"{log} holds no session; give a log written with --log")
    if not -len(sessions) <= session < len(sessions):
        raise UserError(f"{log} holds {len(sessions)} sessions; there is no session {session}")
    return [
        LoggedEdit(str(r["text"]), read_plan(r, log), r.get("before"), tuple(r.get("it") or ()))
        for r in not_undone(sessions[session])
    ]


def not_undone(records: list[Record]) -> list[Record]:
    """The `do` records of a session that were not undone, or were redone."""
    done: list[Record] = []
    undone: list[Record] = []
    for record in records:
        if record["kind"] == "do":
            done.append(record)
            undone.clear()
        elif record["kind"] == "undo" and done:
            undone.append(done.pop())
        elif record["kind"] == "redo" and undone:
            done.append(undone.pop())
    return done


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
