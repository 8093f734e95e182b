"""A film as planners see it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from scenewright.gaussians.language.query.query import Query
from scenewright.planners.grammar import GrammarPlanner
from scenewright.planners.plan import Movement
from scenewright.tools.registry import AnyOp

PLANNER = GrammarPlanner()


class ToldFilm:
    """A scene with motion that tells what moves in it, and nothing else."""

    def graph(self) -> Any:
        raise AssertionError("no graph is needed")

    def picture(self) -> bytes | None:
        return None

    def moves(self, query: Query) -> bool | None:
        raise NotImplementedError

    def movement(self, query: Query) -> Movement | None:
        raise NotImplementedError

    def after(self, ops: Sequence[AnyOp], query: Query) -> Movement | None:
        return None

    def has(self, query: Query) -> bool:
        return False

    def lacks(self, query: Query) -> bool:
        return False

    def planned(self, text: str) -> list[dict[str, Any]]:
        """The operations that an instruction asks for in this film, without what they have by default."""
        plan = PLANNER.plan(text, observation=self)
        return [op.model_dump(exclude_defaults=True, mode="json") | {"op": op.op} for op in plan.ops]
