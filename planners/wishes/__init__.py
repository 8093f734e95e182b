"""Plans wishes for a whole room: the layout solver finds the moves, which become single edit operations."""

from __future__ import annotations

from .planner import WishPlanner

__all__ = ["WishPlanner"]
