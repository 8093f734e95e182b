"""Words and JSON: plans, scene graphs and the planners that make them. Knows no session and no pixels."""

from __future__ import annotations

from ..gaussians.errors import UserError
from .plan import EditPlan, Planner

__all__ = ["EditPlan", "Planner", "load"]


def load(spec: str = "auto") -> Planner:
    """The planner that one string names: "auto" or "grammar".

    Raises:
        UserError: no planner has this name.
    """
    if spec in ("auto", "grammar"):
        from .grammar import GrammarPlanner

        return GrammarPlanner()
    raise UserError(f"unknown planner {spec!r}; planners are auto and grammar")
