"""`auto`: whoever is cheapest and sure plans; only what it abstains on goes on to those who cost more.

    wishes, where the words are one and the scene is there  ──►  grammar  ──abstains──►  language model, if there is one

Knows which answers are final. Refuses to let a model overrule an answer: where the grammar is sure no model is asked,
so that `auto` is as fast there, and right where it is right. Wishes for the whole room come before it, as it would take
some of them for a single edit: "make a circle of chairs" adds no circle.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import cached_property
from typing import Protocol

from ..gaussians.errors import BackendError, UserError
from .budget import OverBudgetError
from .grammar.meaning.changes import TO_A_LENGTH
from .grammar.vocabulary.verbs import TO_ALIGN
from .plan import EditPlan, NoPlanError, Planner, Sight

NAME = "auto"
ABSTAINS = ("not_understood", "impossible")  # verdicts of the grammar that others may know better

# What the grammar calls impossible because it does not see the scene: who sees sizes and places can compute a factor
# or an angle. Everything else that it calls impossible it has understood, and a model has no more operations than it
# has: one that is asked to "turn on the television" can only invent an edit, and a wrong edit costs more than none.
MEASURABLE = (TO_ALIGN, TO_A_LENGTH)


class Wisher(Planner, Protocol):
    """A planner that can tell at once, and without the scene, whether a text is for it."""

    def reads(self, text: str) -> bool:
        """Whether a text is a wish for the whole room, as far as its words go."""
        ...


class Cascade:
    """Wishes and grammar first, both without a model, then a model.

    Args:
        grammar: the planner that is asked always; what it calls `ok`, `unsafe` or `not_an_edit` never reaches a model,
            so that questions, chat and orders that are not about the scene do not.
        wishes: makes the planner of wishes for the whole room, when one is first needed; None leaves it out.
        model: the language-model planner; None leaves it out.
    """

    name = NAME

    def __init__(
        self, grammar: Planner, wishes: Callable[[], Wisher] | None = None, model: Planner | None = None
    ) -> None:
        self.grammar = grammar
        self.model = model
        self._wishes = wishes

    @cached_property
    def _wisher(self) -> Wisher | None:
        return self._wishes() if self._wishes is not None else None

    def plan(self, text: str, *, previous: str | None = None, sight: Sight | None = None) -> EditPlan:
        """The plan for an instruction; see `Planner.plan`. It carries the name of who made it.

        A model that cannot be asked, or gives no plan, is no error here: the grammar's abstention stands and says so.

        Raises:
            UserError: the instruction is too long to be one.
        """
        started = time.perf_counter()
        plan = self.grammar.plan(text, previous=previous)
        if plan.verdict == "unsafe":
            return plan
        wish = self._wished(text, previous, sight)
        if wish is not None and wish.verdict != "not_understood":
            return _timed(wish, started)
        if plan.verdict not in ABSTAINS:
            return plan
        return _timed(self._asked(wish or plan, text, previous, sight), started)

    def _wished(self, text: str, previous: str | None, sight: Sight | None) -> EditPlan | None:
        """What a wish for the whole room comes to; None if it is no wish."""
        if self._wisher is None or not self._wisher.reads(text):
            return None
        return self._wisher.plan(text, previous=previous, sight=sight)

    def _asked(self, abstained: EditPlan, text: str, previous: str | None, sight: Sight | None) -> EditPlan:
        """What the model makes of it, or the abstention with the reason why the model does not help."""
        if self.model is None or not may_ask(abstained, sight):
            return abstained
        try:
            plan = self.model.plan(text, previous=previous, sight=sight)
        except (BackendError, UserError) as error:  # a user's error too: a model that is named wrongly
            usage = error.usage if isinstance(error, NoPlanError) else None
            how = "was not asked" if isinstance(error, OverBudgetError) else "gave no plan"
            told = f"{abstained.reason}; the model {how}: {error}"
            return abstained.model_copy(update={"reason": told[:2000], "usage": usage})
        if plan.verdict != "not_understood":
            return plan
        told = "; ".join(filter(None, [abstained.reason, f"{plan.planner} did not understand it either", plan.reason]))
        return plan.model_copy(update={"reason": told[:2000], "unknown": plan.unknown or abstained.unknown})


def _timed(plan: EditPlan, started: float) -> EditPlan:
    return plan.model_copy(update={"seconds": time.perf_counter() - started})


def may_ask(abstained: EditPlan, sight: Sight | None) -> bool:
    """Whether a model may know more than the grammar that abstained."""
    if abstained.verdict == "impossible":
        return sight is not None and any(reason in abstained.reason for reason in MEASURABLE)
    return abstained.verdict == "not_understood"


def in_passing(planner: Planner) -> Planner:
    """Who reads short phrases in passing, such as the answer to "which one?", for which nobody is paid."""
    return planner.grammar if isinstance(planner, Cascade) else planner
