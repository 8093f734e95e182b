"""Who reads instructions for a session: a planner that can be exchanged, what it may look at, and what it has cost.

Knows planners, budgets and which words are no text. Refuses to know what becomes of a plan.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Literal

from ...gaussians.errors import UserError
from ...gaussians.language.query.query import Query

if TYPE_CHECKING:
    from ...planners.budget import Budget, Progress
    from ...planners.plan import EditPlan, Planner, Sight, Usage

_STEPS: tuple[tuple[Literal["undo", "redo"], re.Pattern[str]], ...] = (
    (
        "undo",
        re.compile(
            r"(please )?(undo|take (that|it|this) back|revert)( (that|it|this|the last (one|step|edit|change)))?", re.I
        ),
    ),
    ("redo", re.compile(r"(please )?(redo|do (that|it) again)( (that|it|this))?", re.I)),
)


def step_meant(text: str) -> Literal["undo", "redo"] | None:
    """Whether words ask to go a step back or forward; None if they ask for something else."""
    said = text.strip().rstrip(".!")
    return next((step for step, words in _STEPS if words.fullmatch(said)), None)


_DISMISSED = re.compile(
    r"(never ?mind|forget (it|that)|cancel( (it|that))?|none|none of (them|these|those)|neither|no|stop)", re.I
)


def dismisses(text: str) -> bool:
    """Whether words say that a question need not be answered."""
    return _DISMISSED.fullmatch(text.strip().rstrip(".!")) is not None


class Reader:
    """Reads for one session. `last` is the plan that was made last, whatever came of it.

    Args:
        planner: as `planners.load` takes it, or a planner.
        sight: the session's scene, for planners that look at it.
        budget: what language models may cost, as `Budget.parse` takes it; seconds for one instruction, dollars for the
            session, whatever planner it changes to.
        pictures: let models see the viewer's picture.
        progress: told while a model plans.

    Raises:
        UserError: no such planner, or the budget is none.
        BackendError: what the planner needs is not there.
    """

    def __init__(
        self, planner: str | Planner, sight: Sight, budget: str | Budget | None, pictures: bool, progress: Progress
    ) -> None:
        from ...planners.budget import Budget, Ledger

        self._sight, self._pictures, self._progress = sight, pictures, progress
        self.last: EditPlan | None = None
        self._ledger = Ledger(Budget.parse(budget) if isinstance(budget, str) else budget)
        self.use(planner)

    @property
    def name(self) -> str:
        """The planner's own name, and behind it the model that it may ask."""
        from ...planners.cascade import Cascade

        model = self._planner.model if isinstance(self._planner, Cascade) else None
        return f"{self._planner.name}:{model.name}" if model is not None else self._planner.name

    @property
    def spent(self) -> Usage | None:
        """What language models were asked for in this session; None if none was."""
        return self._ledger.spent

    @property
    def budget(self) -> Budget:
        """What they may cost."""
        return self._ledger.budget

    def use(self, planner: str | Planner) -> None:
        """Let another planner read from now on; raises as the constructor, and then the old one stays."""
        from ...planners import load

        if isinstance(planner, str):
            planner = load(planner, ledger=self._ledger, pictures=self._pictures, progress=self._progress)
        self._planner = planner

    def plan(self, text: str, previous: str | None = None) -> EditPlan:
        """The plan for an instruction; see `Planner.plan`.

        Raises:
            UserError: too long to be an instruction, or no text.
            BackendError: a model that was named alone gave no plan.
        """
        if not text.isprintable() and any("\ud800" <= c <= "\udfff" for c in text):
            raise UserError("the text is not UTF-8; type it again, or set the terminal to UTF-8")
        self.last = None
        self.last = self._planner.plan(text, previous=previous, sight=self._sight)
        return self.last

    def noun_phrase(self, text: str) -> Query | None:
        """The query of a noun phrase, read without a language model; None if it is not a noun phrase."""
        from ...planners.cascade import without_model

        return _query(without_model(self._planner).plan(f"select {text}", sight=self._sight))

    def query(self, phrase: str | Query) -> Query:
        """What is described: by a phrase, as what an instruction is about, or by a query itself.

        Raises:
            UserError: the words do neither.
            BackendError: as `plan`.
        """
        query = phrase if isinstance(phrase, Query) else self._described(phrase)
        if query is None:
            raise UserError(f"{phrase!r} is no description of things; say for example 'the red chair'")
        return query

    def subject(self, text: str) -> Query | None:
        """What an instruction is about in the end, None if it is not understood; raises as `plan`."""
        about = [query for op in self.plan(text).ops if (query := op.query()) is not None]
        return about[-1] if about else None

    def _described(self, text: str) -> Query | None:
        from ...planners.cascade import without_model

        quick = without_model(self._planner)
        for words in (f"select {text}", text):
            if (query := _query(quick.plan(words, sight=self._sight))) is not None:
                return query
        return _query(self.plan(f"select {text}")) if quick is not self._planner else None


def _query(plan: EditPlan) -> Query | None:
    """What a plan of one operation is about."""
    return plan.ops[0].query() if len(plan.ops) == 1 else None
