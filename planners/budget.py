"""What asking language models may cost: a budget in words, the account of a session, and a planner that keeps to it.

Knows seconds, dollars and when they are used up. Refuses to know what a model is asked.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

from ..gaussians.errors import BackendError, ScenewrightError, UserError
from .plan import EditPlan, NoPlanError, Planner, Sight, Usage

Progress = Callable[[str, float], None]  # stage in words, share done in [0, 1]

SECONDS = 60.0  # the longest that a model is waited for where no budget says otherwise
_MOST = {"seconds": 86_400.0, "dollars": 1e6}
_PART = re.compile(
    r"(?P<dollar>\$)?\s*(?P<number>\d+(?:\.\d*)?|\.\d+)\s*(?P<unit>s|sec|secs|seconds?|usd|dollars?)?", re.IGNORECASE
)


class OverBudgetError(BackendError):
    """The budget is used up; the model was not asked."""


@dataclass(frozen=True)
class Budget:
    """What language models may cost.

    Attributes:
        seconds: the longest that one instruction may wait for them, all attempts together; not counting the embedding
            of a scene that they look at for the first time.
        dollars: what one session may spend; None sets no limit. No instruction is begun when it is used up, so that
            the last one may go beyond it. Where no price is known (own servers, local models) nothing is counted.
    """

    seconds: float = SECONDS
    dollars: float | None = None

    @classmethod
    def parse(cls, text: str) -> Budget:
        """ "20s", "0.05usd" or both, "20s,0.05usd"; also "$0.05".

        Raises:
            UserError: it is no budget.
        """
        said: dict[str, float] = {}
        for part in text.split(","):
            found = _PART.fullmatch(part.strip())
            unit = (found["unit"] or "").lower() if found else ""
            name = "dollars" if found and (found["dollar"] or unit.startswith(("u", "d"))) else "seconds"
            clear = found is not None and bool(found["dollar"]) != bool(unit) and name not in said
            if not clear or found is None or not 0 < float(found["number"]) <= _MOST[name]:
                raise UserError(
                    f"{text!r} is no budget; write seconds for an instruction, dollars for the session or both, above "
                    "zero: 20s or 0.05usd or 20s,0.05usd (to ask no model at all: --planner grammar)"
                )
            said[name] = float(found["number"])
        return cls(**said)


class Ledger:
    """What a session has spent on language models, against its budget."""

    def __init__(self, budget: Budget | None = None) -> None:
        self.budget = budget or Budget()
        self.spent: Usage | None = None

    def add(self, usage: Usage | None) -> None:
        """Write down what was asked."""
        if usage is not None:
            self.spent = usage if self.spent is None else self.spent.plus(usage)

    def require(self) -> None:
        """Let a model be asked once more.

        Raises:
            OverBudgetError: the session's dollars are spent.
        """
        spent, limit = (self.spent.dollars or 0.0) if self.spent else 0.0, self.budget.dollars
        if limit is not None and spent >= limit:
            raise OverBudgetError(
                f"the session's budget of ${limit:.4g} is used up (${spent:.4g} spent); --budget sets another"
            )


class Metered:
    """A planner that costs something: loaded when it is first needed, asked only while the budget lasts.

    Args:
        name: what it is called until it is loaded; holds no key.
        make: loads it; it is to report pieces of an answer to the progress that it is given.
        ledger: the account of the session.
        progress: told when it is asked, whenever a piece of the answer arrives, and when it is done; the share is that
            of the seconds it may take.
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
        """Load it now.

        Raises:
            BackendError: what it needs is not there.
        """
        _ = self._planner

    @cached_property
    def _planner(self) -> Planner:
        return self._make(self._goes_on)

    def plan(self, text: str, *, previous: str | None = None, sight: Sight | None = None) -> EditPlan:
        """The plan for an instruction; see `Planner.plan`.

        Raises:
            OverBudgetError: the budget is used up.
            BackendError: it cannot be loaded, cannot be reached, or gave no plan.
        """
        self._ledger.require()
        if sight is not None:  # embedding may take longer than any model, and is no time of the model's
            with suppress(ScenewrightError):
                sight.graph()
        stage, self._since = f"asking {self.name}", time.monotonic()
        self._progress(stage, 0.0)
        try:
            plan = self._planner.plan(text, previous=previous, sight=sight)
        except NoPlanError as error:
            self._ledger.add(error.usage)
            raise
        finally:
            self._progress(stage, 1.0)
        self._ledger.add(plan.usage)
        return plan

    def _goes_on(self, stage: str, share: float) -> None:
        waited = time.monotonic() - self._since
        self._progress(f"{stage} ({waited:.0f} s)", min(waited / self._ledger.budget.seconds, 0.99))
