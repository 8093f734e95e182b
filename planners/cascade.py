"""The `auto` planner: tries the wish planner and the grammar first, and asks a language model only if they abstain.

    wishes, if the text is a wish for the room  ──►  grammar  ──abstains──►  language model, if one is configured

A plan of the grammar is final where it is sure of it or the scene has what it names. Where the scene has no such thing,
or several, or the words are taken for no edit, and the grammar had to guess at their meaning, the model is asked as
well; its plan counts only if the scene has what it names. Wishes for the whole room take precedence, because the
grammar would read some of them as a single edit: "make a circle of chairs" is not the insertion of a circle.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any, Protocol

from ..gaussians.errors import BackendError, ScenewrightError, UserError
from ..gaussians.language.query.nested import with_queries
from ..gaussians.language.query.query import Query
from ..tools.operation import EditOp
from .budget import OverBudgetError
from .grammar.meaning.changes import TO_A_LENGTH
from .grammar.vocabulary.verbs import TO_ALIGN
from .plan import EditPlan, NoPlanError, Observation, Planner

NAME = "auto"
ABSTAINS = ("not_understood", "impossible")  # verdicts of the grammar that another planner may improve on

# Refusals of the grammar that hold only because it does not see the scene: from sizes and positions a model can compute
# a factor or an angle. For every other "impossible" no operation exists, and a model has the same operations: asked to
# "turn on the television" it can only invent an edit, and a wrong edit costs more than none.
MEASURABLE = (TO_ALIGN, TO_A_LENGTH)


class WishReader(Planner, Protocol):
    """A planner that can tell from the text alone whether it reads it."""

    def reads(self, text: str) -> bool:
        """Whether the words of a text are a wish for the whole room."""
        ...


class Cascade:
    """Asks the wish planner and the grammar, which need no model, and then a language model.

    Args:
        grammar: asked for every instruction. What it calls `unsafe` never reaches a model, nor what it is sure of:
            questions, chat, and plans that it read in their own words.
        wishes: makes the planner of wishes for the whole room when it is first needed; None for no such planner.
        model: the language-model planner; None for no model.
    """

    name = NAME

    def __init__(
        self, grammar: Planner, wishes: Callable[[], WishReader] | None = None, model: Planner | None = None
    ) -> None:
        self.grammar = grammar
        self.model = model
        self._wishes = wishes

    @cached_property
    def _wish_planner(self) -> WishReader | None:
        return self._wishes() if self._wishes is not None else None

    def plan(self, text: str, *, previous: str | None = None, observation: Observation | None = None) -> EditPlan:
        """The plan for an instruction; see `Planner.plan`. Its `planner` names the planner that made it.

        If a model cannot be asked or gives no plan, no error is raised: the result is the grammar's abstention, and
        its reason says so.

        Raises:
            UserError: the instruction is too long.
        """
        started = time.perf_counter()
        plan = self.grammar.plan(text, previous=previous, observation=observation)
        if plan.verdict == "unsafe":
            return plan
        wish = self._plan_wish(text, previous, observation)
        in_motion = wish is not None and wish.verdict == "absent" and any(map(_is_timed, plan.ops))
        if wish is not None and wish.verdict != "not_understood" and not in_motion:
            return _with_total_time(wish, started)
        if plan.verdict not in ABSTAINS:
            return self._second_opinion(plan, text, previous, observation, started)
        return _with_total_time(self._ask_model(wish or plan, text, previous, observation), started)

    def _second_opinion(
        self, plan: EditPlan, text: str, previous: str | None, observation: Observation | None, started: float
    ) -> EditPlan:
        """The model's plan where the grammar's is not sure and fits nothing in the scene; else the grammar's."""
        sure = getattr(self.grammar, "is_sure", None)
        if self.model is None or observation is None or sure is None or sure(text, previous=previous):
            return plan
        if plan.verdict == "ok" and self._fits(plan, previous, observation):
            return plan
        other = self._ask_model(plan, text, previous, observation)
        if other.verdict == "ok" and other.planner != plan.planner and self._fits(other, previous, observation):
            return _with_total_time(other, started)
        return _with_total_time(plan.model_copy(update={"usage": other.usage}), started)

    def _fits(self, plan: EditPlan, previous: str | None, observation: Observation) -> bool:
        """Whether the scene has what a plan names; also where the scene cannot be read."""
        from .rooms.graph_scene import Stage
        from .rooms.plan_on_graph import recalled, resolve_plan

        try:
            stage = Stage.of(observation.graph())
            last = recalled(stage, self.grammar.plan(previous)) if previous else None
            rows = {node.id: row for row, node in enumerate(stage.graph.nodes)}
            return resolve_plan(stage, with_rows(plan, rows), last).verdict == "ok"
        except ScenewrightError:
            return True

    def _plan_wish(self, text: str, previous: str | None, observation: Observation | None) -> EditPlan | None:
        """The plan of the wish planner; None if the text is not a wish for the whole room."""
        if self._wish_planner is None or not self._wish_planner.reads(text):
            return None
        return self._wish_planner.plan(text, previous=previous, observation=observation)

    def _ask_model(
        self, abstained: EditPlan, text: str, previous: str | None, observation: Observation | None
    ) -> EditPlan:
        """The plan of the model, or the abstention, with the reason why the model gave no plan."""
        asked = abstained.verdict not in ABSTAINS or may_ask(abstained, observation)
        if self.model is None or not asked:
            return abstained
        try:
            plan = self.model.plan(text, previous=previous, observation=observation)
        except (BackendError, UserError) as error:  # UserError: the model's name is wrong
            usage = error.usage if isinstance(error, NoPlanError) else None
            how = "was not asked" if isinstance(error, OverBudgetError) else "gave no plan"
            reason = f"{abstained.reason}; the model {how}: {error}"
            return abstained.model_copy(update={"reason": reason[:2000], "usage": usage})
        if plan.verdict != "not_understood":
            return plan
        reason = "; ".join(
            filter(None, [abstained.reason, f"{plan.planner} did not understand it either", plan.reason])
        )
        return plan.model_copy(update={"reason": reason[:2000], "unknown": plan.unknown or abstained.unknown})


def _is_timed(op: EditOp) -> bool:
    """Whether an operation is of a time, or of motion: "have the fan go round the other way" is no wish for a room."""
    return type(op).makes_motion or getattr(op, "when", None) is not None


def _with_total_time(plan: EditPlan, started: float) -> EditPlan:
    return plan.model_copy(update={"seconds": time.perf_counter() - started})


def with_rows(plan: EditPlan, rows: Mapping[Any, int]) -> EditPlan:
    """A plan whose ids of groups are the rows of a stage; ids that are not there are left."""

    def change(query: Query) -> Query:
        return (
            query.model_copy(update={"groups": tuple(rows.get(i, i) for i in query.groups)}) if query.groups else query
        )

    return plan.model_copy(update={"ops": tuple(with_queries(op, change) for op in plan.ops)})


def may_ask(abstained: EditPlan, observation: Observation | None) -> bool:
    """Whether a model may plan what another planner abstained on."""
    if abstained.verdict == "impossible":
        return observation is not None and any(reason in abstained.reason for reason in MEASURABLE)
    return abstained.verdict == "not_understood"


def without_model(planner: Planner) -> Planner:
    """The planner for short phrases such as the answer to "which one?", on which no model is to be spent."""
    return planner.grammar if isinstance(planner, Cascade) else planner
