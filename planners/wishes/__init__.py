"""Wishes for a whole room: many moves at once, found by the layout solver and said as atomic operations."""

from __future__ import annotations

from .planner import WishPlanner

__all__ = ["WishPlanner"]
