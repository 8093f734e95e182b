"""Compose a room from a sentence: get a brief from the reader or a model, pose the layout problem, solve it."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from ...gaussians.errors import BackendError
from ..budget import Budget, Ledger
from ..layout.problem import Conflict, Layout, Problem
from ..layout.solver import Attempt, attempt
from ..plan import Usage
from ..rooms.check import check
from .brief import Brief, RefusedError
from .problems import Posed, problem_of
from .sentence.read import read
from .surfaces import with_surfaces
from .unmet import unmet_wishes

if TYPE_CHECKING:
    from ...gaussians.effort import Dial
    from ..model.backend import ModelBackend
    from .proposing import Proposal

_GROWTH = (1.0, 1.12, 1.25, 1.45, 1.7)  # factors on the sides of a room without a stated size, tried in turn
_SHRINKING = (1.0, 0.999, 0.9, 0.8, 0.7)  # factors on things in a room with a stated size; below 1 all are small ones
_STRIDE = 7919  # between the seeds of attempts, so that users' neighbouring seeds share no attempt
_WORSE = 1000  # what is missing counts as much as so many things that nobody can walk up to
_SECONDS = 120.0  # time limit of a model, all attempts together, where no budget is given
EMBEDDED = "embedded"
Mode = Literal["auto", "model"]


@dataclass(frozen=True)
class Composition:
    """A room that was composed.

    Attributes:
        brief: what was asked for, as it was understood.
        problem: the layout problem that the brief poses.
        layout: positions of the things; its `conflicts` are the requests that cannot be fulfilled together.
        remarks: notes for the user about the reading and the furnishing, a sentence each.
        names: for each node of the graph that the brief asked for, its id to the id of the brief's thing.
        proposer: where the brief comes from: "embedded", the model's name, or "given".
        prompt_hash: hash of the prompt, "" where no model was asked.
        usage: what the model used, None where none was asked.
        unmet: what was asked for and is not in the room as asked for, a sentence each.
    """

    brief: Brief
    problem: Problem
    layout: Layout
    remarks: tuple[str, ...] = ()
    names: dict[int, str] | None = None
    proposer: str = EMBEDDED
    prompt_hash: str = ""
    usage: Usage | None = None
    unmet: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether everything that was asked for is in the room as asked for."""
        return self.layout.ok


def compose(
    text: str | Brief,
    *,
    seed: int = 0,
    planner: ModelBackend | None = None,
    mode: Mode = "auto",
    effort: float = 1.0,
    ledger: Ledger | None = None,
    dial: Dial | None = None,
) -> Composition:
    """A room from a description.

    Args:
        text: a description in words, or a brief.
        seed: the same words and seed give the same room.
        planner: a language model that proposes the brief; without one the embedded reader does. Where the wishes of a
            brief conflict, it is asked once for a second brief.
        mode: "auto" asks the model only where the embedded reader did not understand everything; "model" always.
        effort: of the layout solver, 1 is usual.
        dial: chooses the effort of the layout solver in place of `effort`.
        ledger: limits of the model, and what it has spent; None: two minutes, all attempts together.

    Raises:
        UserError: the text is too long to be a description.
        RefusedError: the text describes no room.
        BackendError: the model gave no brief.
        OverBudgetError: the budget is used up.
    """
    ledger = ledger if ledger is not None else Ledger(Budget(seconds=_SECONDS))
    started = time.monotonic()
    brief, proposal = _brief(text, planner, mode, ledger)
    posed, layout = arranged(brief, seed, effort, dial)
    if layout.conflicts and planner is not None and isinstance(text, str):
        left = ledger.budget.seconds - (time.monotonic() - started)
        second = _second(text, brief, layout, planner, ledger, left)
        if second is not None:
            again = arranged(second.brief, seed, effort, dial)
            if len(again[1].conflicts) < len(layout.conflicts) and _names_as_much(second.brief, brief):
                brief, (posed, layout), proposal = second.brief, again, _joined(proposal, second)
    layout = layout.model_copy(update={"graph": with_surfaces(layout.graph, brief, posed.names)})
    unknown = [f"not understood: {', '.join(brief.unknown)}"] if brief.unknown else []
    remarks = (*unknown, *brief.remarks, *posed.remarks)
    unmet = unmet_wishes(brief, posed, layout)
    if proposal is None:
        proposer = "given" if isinstance(text, Brief) else EMBEDDED
        return Composition(brief, posed.problem, layout, remarks, posed.names, proposer, unmet=unmet)
    name = planner.name if planner is not None else ""
    return Composition(
        brief, posed.problem, layout, remarks, posed.names, name, proposal.prompt_hash, proposal.usage, unmet
    )


def _joined(first: Proposal | None, second: Proposal) -> Proposal:
    """The second proposal with the usage of both."""
    return second if first is None else replace(second, usage=first.usage.plus(second.usage))


def _second(
    text: str, brief: Brief, layout: Layout, planner: ModelBackend, ledger: Ledger, left: float
) -> Proposal | None:
    """A second brief of a model that is told what is not possible together; None where it gives none in time."""
    from .proposing import propose

    if left <= 0:
        return None
    told = ["; ".join(c.statements) for c in layout.conflicts[:4]]
    try:
        ledger.require()
        proposal = propose(text, planner, seconds=left, heard=brief, conflicts=told)
    except BackendError:
        return None  # the first brief stands, with its conflict
    except RefusedError:
        return None
    ledger.add(proposal.usage)
    return proposal


def _names_as_much(second: Brief, first: Brief) -> bool:
    """Whether a second brief gives up none of the things of the first."""
    return sum(t.count for t in second.things) >= sum(t.count for t in first.things)


def arranged(brief: Brief, seed: int, effort: float, dial: Dial | None = None) -> tuple[Posed, Layout]:
    """The layout of a brief. A room without a stated size grows until everything that was asked for fits; in one with
    a stated size the things shrink, as far as their own sizes are not stated. What fails in the end is explained.
    `dial` chooses the effort in place of `effort`, and seconds that it promises end the search."""
    best: tuple[int, Posed, Attempt] | None = None
    until: float | None = None
    for number, (grow, shrink) in enumerate(_attempts(brief)):
        posed = problem_of(brief, seed, grow=grow, shrink=shrink)
        if dial is not None and number == 0:
            things = len(posed.problem.items)
            effort = float(dial.choose("compose", things).settings["effort"])
            until = dial.until
        began = time.perf_counter()
        tried = attempt(posed.problem, seed + _STRIDE * number, effort, until)
        failures = _failures(posed, tried.layout)
        if best is None or failures < best[0]:
            best = (failures, posed, tried)
        late = until is not None and 2 * time.perf_counter() - began > until  # the next one takes as long
        if failures == 0 or (number and failures < _WORSE) or late:
            break
    assert best is not None
    failures, posed, tried = best
    return posed, _with_missing_items(posed, tried.explained() if failures else tried.layout)


def _failures(posed: Posed, layout: Layout) -> int:
    """How many things and relations that were asked for are not there, times `_WORSE`, and how many faults the checker
    finds in the rest, where people cannot get to everything."""
    asked = {i.id for i in posed.problem.items if not i.optional}
    broken = sum(w.hard for w in layout.broken)
    return _WORSE * (broken + len(asked & set(layout.left_out))) + len(check(layout.graph).violations)


def _attempts(brief: Brief) -> list[tuple[float, float]]:
    """Factors on the room's sides and on the sizes of things, to be tried in turn."""
    return [(g, 1.0) for g in _GROWTH] if _may_grow(brief) else [(1.0, s) for s in _SHRINKING]


def _may_grow(brief: Brief) -> bool:
    said = brief.size
    return said is None or (said.area is None and (said.width is None or said.depth is None))


def _with_missing_items(posed: Posed, layout: Layout) -> Layout:
    """The layout, with a conflict for each missing item that was asked for and for which no cause was found."""
    asked = {i.id: i for i in posed.problem.items if not i.optional}
    explained = {s for c in layout.conflicts for s in c.subjects}
    missing = [asked[i] for i in layout.left_out if i in asked and i not in explained]
    if not missing:
        return layout
    width, depth, _ = posed.problem.size
    more = tuple(
        Conflict(
            statements=(
                f"the {i.label} ({i.id}) is {i.size[0]:.2f} m wide and {i.size[1]:.2f} m deep",
                f"the room is {width:.2f} m wide and {depth:.2f} m deep",
            ),
            subjects=(i.id,),
        )
        for i in missing
    )
    return layout.model_copy(update={"conflicts": (*layout.conflicts, *more)})


def _brief(
    text: str | Brief, planner: ModelBackend | None, mode: Mode, ledger: Ledger
) -> tuple[Brief, Proposal | None]:
    """The brief, and the proposal of the model if it was asked."""
    if isinstance(text, Brief):
        return text, None
    if planner is None:
        return read(text), None
    embedded: Brief | None = None
    if mode == "auto":
        try:
            embedded = read(text)
        except RefusedError as refusal:
            if refusal.verdict != "not_understood":
                raise
        if embedded is not None and not embedded.unknown:
            return embedded, None
    from .proposing import propose

    ledger.require()
    proposal = propose(text, planner, seconds=ledger.budget.seconds, heard=embedded)
    ledger.add(proposal.usage)
    return proposal.brief, proposal
