"""The grammar planner: parses plain imperative English with an LALR grammar (lark), without a language model."""

from .planner import GrammarPlanner

__all__ = ["GrammarPlanner"]
