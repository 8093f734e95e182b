"""What a session log asks to be done again: the instructions that stood in the end, as plans that fit another scene.

Knows records and plans. Refuses to know how a plan is carried out. All of a session is read before any of it is done.
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
    """One instruction of a replay: what it did here, or why it could not be done."""

    text: str
    result: Result | None
    error: ScenewrightError | None


@dataclass(frozen=True)
class Deed:
    """What was done in a session: its words, its plan, and the digest of the cloud that it was done to."""

    text: str
    plan: EditPlan
    before: str | None

    def on(self, digest: str) -> EditPlan:
        """The plan for the cloud of this digest; in another than its own, ids of groups mean nothing."""
        return self.plan if self.before == digest else portable(self.plan)


def deeds(log: str | Path, session: int) -> list[Deed]:
    """What stood in the end of a session, oldest first.

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
        raise UserError(f"{log} holds {len(sessions)} sessions; there is none number {session}")
    return [Deed(str(r["text"]), read_plan(r, log), r.get("before")) for r in standing(sessions[session])]


def standing(records: list[Record]) -> list[Record]:
    """The `do` records of a session that were not undone in the end."""
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
        FileError: there is none that this version can read.
    """
    from pydantic import ValidationError

    from ...planners.plan import EditPlan

    try:
        return EditPlan.model_validate(record["plan"])
    except (KeyError, ValidationError) as error:
        raise FileError(f"{source}: record {record['seq']} holds no plan this version can read ({error})") from error


def portable(plan: EditPlan) -> EditPlan:
    """The plan without ids of groups, which mean nothing in another scene; its words stay."""
    ops = []
    for op in plan.ops:
        for path, query in list(queries(op)):
            if query.groups:
                op = exchange(op, path, query.model_copy(update={"groups": ()}))
        ops.append(op)
    return plan.model_copy(update={"ops": tuple(ops)})
