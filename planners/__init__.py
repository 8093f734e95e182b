"""Words to plans. Knows planners by name; each is imported when asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..gaussians.errors import BackendError

if TYPE_CHECKING:
    from .plan import Planner

__all__ = ["load"]


def load(spec: str = "auto") -> Planner:
    """The planner called `spec`: "grammar", or "auto" for the cheapest that is here (the grammar).

    Raises:
        BackendError: there is no such planner.
    """
    if spec in ("auto", "grammar"):
        from .grammar import GrammarPlanner

        return GrammarPlanner()
    raise BackendError(f"there is no planner {spec!r}; choose 'auto' or 'grammar'")
