"""A planner without a model: plain imperative English, read with a grammar (lark)."""

from .planner import GrammarPlanner

__all__ = ["GrammarPlanner"]
