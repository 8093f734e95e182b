"""Planners: turn instructions into edit plans, and read, check, compose and lay out scene graphs."""

from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING, Any

from ..gaussians.errors import UserError
from .budget import Ledger, Metered, Progress
from .plan import EditPlan, Planner

if TYPE_CHECKING:
    from .cascade import WishReader

__all__ = ["EditPlan", "Planner", "load"]

MODEL_VARIABLE = "SCENEWRIGHT_MODEL"
_LOGIN = re.compile(r"//[^/@\s]*@")  # user name and password in a URL


def load(
    spec: str = "auto", *, ledger: Ledger | None = None, pictures: bool = False, progress: Progress | None = None
) -> Planner:
    """Load the planner that a specification names.

    "grammar" parses plain English without a model. "auto" adds wishes for the whole room; where both abstain it asks
    the language model that the environment variable `SCENEWRIGHT_MODEL` names, if it is set. "auto:MODEL" names the
    model directly. A model alone ("openai:…", see `planners.model.FORMS`) plans everything. "auto" loads its model
    when it first asks it.

    Args:
        ledger: budget and spending of the session; by default a new one with the default budget.
        pictures: send the viewer's picture to the model.
        progress: called while a model plans.

    Raises:
        UserError: no planner has this name.
        BackendError: a model named alone cannot be loaded.
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
        planner.require()  # raises now what is missing, not at the first instruction
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


def _wishes() -> WishReader:
    from .wishes import WishPlanner

    return WishPlanner()


def _metered(spec: str, *, ledger: Ledger, pictures: bool, progress: Progress | None) -> Metered:
    """A model planner within the ledger's budget, loaded when it is first asked."""

    def make(report: Progress) -> Planner:
        from .model import load_planner

        return load_planner(spec, seconds=ledger.budget.seconds, pictures=pictures, progress=report)

    return Metered(_public(spec), make, ledger, progress)


def _public(spec: str) -> str:
    """A specification without user name and password, at most 200 characters, for messages."""
    return _LOGIN.sub("//", spec)[:200]
