"""Limits the time and money spent on language models: a parsed budget, the spending of a session, a metered planner."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from ..gaussians.errors import BackendError, ScenewrightError, UserError
from .plan import EditPlan, NoPlanError, Observation, Planner, Usage

Progress = Callable[[str, float], None]  # called with the stage in words and the share done in [0, 1]

SECONDS = 60.0  # default limit on waiting for a model
_MAXIMUM = {"seconds": 86_400.0, "dollars": 1e6, "views": 1000.0, "tokens": 1e9}
_WHOLE = ("views", "tokens")  # counts
_PART = re.compile(
    r"(?P<dollar>\$)?\s*(?P<number>\d+(?:\.\d*)?|\.\d+)\s*"
    r"(?P<unit>s|sec|secs|seconds?|usd|dollars?|views?|tokens?)?",
    re.IGNORECASE,
)


class OverBudgetError(BackendError):
    """The budget is used up, so the model was not asked."""


@dataclass(frozen=True)
class Budget:
    """What language models may cost.

    Attributes:
        seconds: limit on waiting for them in one instruction, all attempts together; the embedding of a scene that
            they see for the first time does not count.
        dollars: what one session may spend; None sets no limit. It is checked before each instruction, so the last
            instruction may exceed it. Models without a known price (own servers, local models) cost nothing here.
        views: pictures that a vision model is shown for one question; None leaves it to the question.
        tokens: what one question may cost, prompts and answers together; checked before each request. None sets no
            limit.
    """

    seconds: float = SECONDS
    dollars: float | None = None
    views: int | None = None
    tokens: int | None = None

    @classmethod
    def parse(cls, text: str) -> Budget:
        """Parse any of "20s", "0.05usd" or "$0.05", "8views" and "20000tokens", with commas in between.

        Raises:
            UserError: the text is not a budget.
        """
        said: dict[str, Any] = {}
        for part in text.split(","):
            found = _PART.fullmatch(part.strip())
            unit = (found["unit"] or "").lower() if found else ""
            name = _measured(unit) if unit else "dollars"
            clear = found is not None and bool(found["dollar"]) != bool(unit) and name not in said
            number = float(found["number"]) if found else 0.0
            if not clear or not 0 < number <= _MAXIMUM[name] or (name in _WHOLE and number != int(number)):
                raise UserError(
                    f"{text!r} is not a budget; write seconds for an instruction, dollars for the session, views or "
                    "tokens for a question, or several, above zero: 20s or 0.05usd or 20s,0.05usd,8views,20000tokens "
                    "(to ask no model at all: --planner grammar)"
                )
            said[name] = int(number) if name in _WHOLE else number
        return cls(**said)


def _measured(unit: str) -> str:
    """The field of a budget that a unit measures."""
    return {"u": "dollars", "d": "dollars", "v": "views", "t": "tokens"}.get(unit[0], "seconds")


class Ledger:
    """The budget of a session and what it has spent on language models."""

    def __init__(self, budget: Budget | None = None) -> None:
        self.budget = budget or Budget()
        self.spent: Usage | None = None

    def add(self, usage: Usage | None) -> None:
        """Add the usage of one instruction."""
        if usage is not None:
            self.spent = usage if self.spent is None else self.spent.plus(usage)

    def require(self) -> None:
        """Check that a model may be asked once more.

        Raises:
            OverBudgetError: the session's dollars are spent.
        """
        spent, limit = (self.spent.dollars or 0.0) if self.spent else 0.0, self.budget.dollars
        if limit is not None and spent >= limit:
            raise OverBudgetError(
                f"the session's budget of ${limit:.4g} is used up (${spent:.4g} spent); --budget sets another"
            )


class Metered:
    """A planner with a cost: loaded when it is first needed, asked only while the budget lasts.

    Args:
        name: its name in messages; contains no key.
        make: loads it; the loaded planner reports each piece of an answer to the callback that `make` is given.
        ledger: budget and spending of the session.
        progress: called when the planner is asked, when a piece of the answer arrives, and when it is done; the share
            is that of the time limit.
    """

    def __init__(
        self, name: str, make: Callable[[Progress], Planner], ledger: Ledger, progress: Progress | None = None
    ) -> None:
        self.name = name
        self._make = make
        self._ledger = ledger
        self._progress = progress or (lambda stage, share: None)
        self._since = 0.0

    def require(self) -> None:
        """Load the planner now.

        Raises:
            BackendError: something that it needs is missing.
        """
        _ = self._planner

    @cached_property
    def _planner(self) -> Planner:
        return self._make(self._report)

    def plan(self, text: str, *, previous: str | None = None, observation: Observation | None = None) -> EditPlan:
        """The plan for an instruction; see `Planner.plan`.

        Raises:
            OverBudgetError: the budget is used up.
            BackendError: the planner cannot be loaded or reached, or gave no plan.
        """
        self._ledger.require()
        if observation is not None:  # embed the scene before the clock starts: it may take longer than a model
            with suppress(ScenewrightError):
                observation.graph()
        stage, self._since = f"asking {self.name}", time.monotonic()
        self._progress(stage, 0.0)
        try:
            plan = self._planner.plan(text, previous=previous, observation=observation)
        except NoPlanError as error:
            self._ledger.add(error.usage)
            raise
        finally:
            self._progress(stage, 1.0)
        self._ledger.add(plan.usage)
        return plan

    def _report(self, stage: str, share: float) -> None:
        waited = time.monotonic() - self._since
        self._progress(f"{stage} ({waited:.0f} s)", min(waited / self._ledger.budget.seconds, 0.99))
