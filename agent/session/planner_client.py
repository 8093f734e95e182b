"""The session's planner: turns words into plans and queries, can be exchanged, and accounts for what models cost.

Undo, redo and dismissals ("never mind") are recognised here without a planner.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Literal

from ...gaussians.errors import UserError
from ...gaussians.language.query.nested import without_confirmation
from ...gaussians.language.query.query import Query
from .answers import only_an_answer

if TYPE_CHECKING:
    from ...planners.budget import Budget, Ledger, Progress
    from ...planners.plan import EditPlan, Observation, Planner, Usage

_STEPS: tuple[tuple[Literal["undo", "redo"], re.Pattern[str]], ...] = (
    (
        "undo",
        re.compile(
            r"(please )?(undo|take (that|it|this) back|revert)( (that|it|this|the last (one|step|edit|change)))?", re.I
        ),
    ),
    ("redo", re.compile(r"(please )?(redo|do (that|it) again)( (that|it|this))?", re.I)),
)


def undo_or_redo(text: str) -> Literal["undo", "redo"] | None:
    """Which of the two an instruction asks for; None if it asks for something else."""
    said = text.strip().rstrip(".!")
    return next((step for step, words in _STEPS if words.fullmatch(said)), None)


_DISMISSED = re.compile(
    r"(never ?mind|forget (it|that)|cancel( (it|that))?|none|none of (them|these|those)|neither|no|stop)", re.I
)


def is_dismissal(text: str) -> bool:
    """Whether the text drops an open question ("never mind") instead of answering it."""
    return _DISMISSED.fullmatch(text.strip().rstrip(".!")) is not None


class PlannerClient:
    """Plans the instructions of one session. `last` is the latest plan, even if it was refused.

    Args:
        planner: a name for `planners.load`, or a planner.
        observation: the session's scene, for planners that look at it.
        budget: what language models may cost, as `Budget.parse` takes it; seconds for one instruction, dollars for the
            session. A change of planner does not reset it.
        pictures: send the viewer's picture to models.
        progress: called while a model plans.

    Raises:
        UserError: no such planner, or the budget cannot be parsed.
        BackendError: a package, key or file that the planner needs is missing.
    """

    def __init__(
        self,
        planner: str | Planner,
        observation: Observation,
        budget: str | Budget | None,
        pictures: bool,
        progress: Progress,
    ) -> None:
        from ...planners.budget import Budget, Ledger

        self._observation, self._pictures, self._progress = observation, pictures, progress
        self.last: EditPlan | None = None
        self._ledger = Ledger(Budget.parse(budget) if isinstance(budget, str) else budget)
        self.use(planner)

    @property
    def name(self) -> str:
        """The planner's name; of a cascade, with the model that it may ask: "auto:MODEL"."""
        from ...planners.cascade import Cascade

        model = self._planner.model if isinstance(self._planner, Cascade) else None
        return f"{self._planner.name}:{model.name}" if model is not None else self._planner.name

    @property
    def spent(self) -> Usage | None:
        """Usage of language models in this session; None if no model was asked."""
        return self._ledger.spent

    @property
    def ledger(self) -> Ledger:
        """The budget of the session and what it has spent on models."""
        return self._ledger

    @property
    def budget(self) -> Budget:
        """What language models may cost."""
        return self._ledger.budget

    def use(self, planner: str | Planner) -> None:
        """Change to another planner; raises as the constructor, and then keeps the old one."""
        from ...planners import load

        if isinstance(planner, str):
            planner = load(planner, ledger=self._ledger, pictures=self._pictures, progress=self._progress)
        self._planner = planner

    def plan(self, text: str, previous: str | None = None) -> EditPlan:
        """The plan for an instruction; see `Planner.plan`. A text that is only an answer ("all", "2") plans no edit.

        Raises:
            UserError: the text is too long or is not valid Unicode.
            BackendError: a model that was chosen as the only planner gave no plan.
        """
        if not text.isprintable() and any("\ud800" <= c <= "\udfff" for c in text):
            raise UserError("the text is not UTF-8; type it again, or set the terminal to UTF-8")
        self.last = None
        if only_an_answer(text):  # with the instruction before, a planner could read it as an edit of everything
            self.last = _answer_to_nothing(text)
            return self.last
        plan = self._planner.plan(text, previous=previous, observation=self._observation)
        self.last = plan.model_copy(update={"ops": without_confirmation(plan.ops)})
        return self.last

    def otherwise(self, plan: EditPlan) -> EditPlan | None:
        """Another plan for the instruction of one that cannot be carried out in the scene, None if there is none; only
        of the grammar."""
        from ...planners.grammar import GrammarPlanner

        if plan.planner != GrammarPlanner.name:
            return None
        return GrammarPlanner().otherwise(plan, observation=self._observation)

    def reads_as_question(self, text: str) -> bool | None:
        """Whether the grammar takes a text for a question: no if it plans an edit, None if it cannot tell."""
        from ...planners.grammar import GrammarPlanner
        from ...planners.grammar.tagging.non_edits import QUESTION

        plan = GrammarPlanner().plan(text)
        if plan.ok or plan.verdict == "unsafe":
            return False
        return True if plan.verdict == "not_an_edit" and QUESTION in plan.reason else None

    def continues(self, text: str, previous: str | None) -> bool:
        """Whether the grammar reads a text as going on with the instruction before ("a bit more")."""
        from ...planners.grammar import GrammarPlanner

        return previous is not None and GrammarPlanner().plan(text, previous=previous).ok

    def noun_phrase(self, text: str) -> Query | None:
        """A short noun phrase as a query, without asking the model of a cascade; None if it cannot be read."""
        from ...planners.cascade import without_model

        return _query(without_model(self._planner).plan(f"select {text}", observation=self._observation))

    def query(self, phrase: str | Query) -> Query:
        """The query for a noun phrase, or for the target of an instruction; a query is returned as it is.

        Raises:
            UserError: the words cannot be read as either.
            BackendError: as `plan`.
        """
        query = phrase if isinstance(phrase, Query) else self._described(phrase)
        if query is None:
            raise UserError(f"{phrase!r} does not describe things; say for example 'the red chair'")
        return query

    def subject(self, text: str) -> Query | None:
        """The target of the last operation of an instruction; None if it is not understood. Raises as `plan`."""
        about = [query for op in self.plan(text).ops if (query := op.query()) is not None]
        return about[-1] if about else None

    def _described(self, text: str) -> Query | None:
        from ...planners.cascade import without_model

        quick = without_model(self._planner)
        for words in (f"select {text}", text):
            if (query := _query(quick.plan(words, observation=self._observation))) is not None:
                return query
        return _query(self.plan(f"select {text}")) if quick is not self._planner else None


def _query(plan: EditPlan) -> Query | None:
    """The target of a plan of one operation."""
    return plan.ops[0].query() if len(plan.ops) == 1 else None


def _answer_to_nothing(text: str) -> EditPlan:
    """The plan, without operations, of an answer that no question waits for."""
    from ...planners.plan import EditPlan

    reason = (
        f"{text.strip()!r} is an answer, but no question is open; say what to do, and with what: 'delete all chairs'"
    )
    return EditPlan(instruction=text, planner="session", verdict="not_an_edit", reason=reason)
