"""Words and JSON: plans, scene graphs and the planners that make them. Knows no session and no pixels."""

from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING, Any

from ..gaussians.errors import UserError
from .budget import Ledger, Metered, Progress
from .plan import EditPlan, Planner

if TYPE_CHECKING:
    from .cascade import Wisher

__all__ = ["EditPlan", "Planner", "load"]

MODEL_VARIABLE = "SCENEWRIGHT_MODEL"
_LOGIN = re.compile(r"//[^/@\s]*@")  # name and password in an address


def load(
    spec: str = "auto", *, ledger: Ledger | None = None, pictures: bool = False, progress: Progress | None = None
) -> Planner:
    """The planner that one string names.

    "grammar" reads plain English without a model. "auto" adds wishes for the whole room, and where both abstain the
    language model that the environment names (`SCENEWRIGHT_MODEL`), if it names one; "auto:MODEL" names it here. A
    model alone ("openai:…", see `planners.model.FORMS`) plans everything. A model of "auto" is loaded when it is first
    asked.

    Args:
        ledger: what models may cost, and have cost; without one an account of its own, with the usual patience.
        pictures: let models see the viewer's picture.
        progress: told while a model plans.

    Raises:
        UserError: no planner has this name.
        BackendError: a model that was named alone lacks something.
    """
    if spec == "grammar":
        from .grammar import GrammarPlanner

        return GrammarPlanner()
    kind, colon, rest = spec.partition(":")
    named = rest if colon else os.environ.get(MODEL_VARIABLE, "").strip()
    if kind == "auto" and not colon and not named:
        return _cascade()
    from . import model

    settings: dict[str, Any] = {"ledger": ledger or Ledger(), "pictures": pictures, "progress": progress}
    if model.is_model(spec):
        planner = _metered(spec, **settings)
        planner.require()  # what is missing is said now, not at the first instruction
        return planner
    if kind == "auto" and model.is_model(named):
        return _cascade(_metered(named, **settings))
    known = f"planners are auto, grammar, {', '.join(model.FORMS)}, and auto: before one of these"
    if spec == "auto":
        raise UserError(f"{MODEL_VARIABLE} names no language model ({_public(named)!r}); {known}")
    raise UserError(f"unknown planner {_public(spec)!r}; {known}")


def _cascade(model: Planner | None = None) -> Planner:
    from .cascade import Cascade
    from .grammar import GrammarPlanner

    return Cascade(GrammarPlanner(), _wishes, model)


def _wishes() -> Wisher:
    from .wishes import WishPlanner

    return WishPlanner()


def _metered(spec: str, *, ledger: Ledger, pictures: bool, progress: Progress | None) -> Metered:
    """A model that keeps to the ledger's budget, loaded when it is first asked."""

    def make(goes_on: Progress) -> Planner:
        from .model import load_planner

        return load_planner(spec, seconds=ledger.budget.seconds, pictures=pictures, progress=goes_on)

    return Metered(_public(spec), make, ledger, progress)


def _public(spec: str) -> str:
    """A specification as it may be shown."""
    return _LOGIN.sub("//", spec)[:200]
