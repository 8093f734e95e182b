"""The wish planner: parses a wish into goals, rearranges the room to reach them, and plans the operations for that.

If one of several wishes cannot be fulfilled, nothing is planned, and the reason says which one and why.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from ...gaussians.errors import ScenewrightError
from ...tools.operation import EditOp
from ..plan import MAX_OPS, EditPlan
from ..rooms.graph import SceneGraph
from .goals import PlainEdit
from .parsing import NotAWish, ParsedInstruction, WishParser
from .room import Room, WishError, copy_of

if TYPE_CHECKING:
    from ..plan import Observation
    from ..rooms.check import Violation

NAME = "wishes"


class WishPlanner:
    """Plans wishes for a whole room. Stateless and thread-safe."""

    name = NAME

    def __init__(self) -> None:
        self._parser = WishParser()

    def reads(self, text: str) -> bool:
        """Whether the words of a text are a wish for a room; needs no scene.

        Raises:
            UserError: the text is too long.
        """
        try:
            return self._parser.may_be_wish(text) and self._parser.parse(text).wished
        except NotAWish:
            return False

    def plan(self, text: str, *, previous: str | None = None, observation: Observation | None = None) -> EditPlan:
        """The plan for a wish; see `Planner.plan`. `previous` is ignored: a wish names what it is about.

        Raises:
            UserError: the text is too long.
        """
        started = time.perf_counter()
        told: dict[str, Any]
        try:
            told = self._planned(self._parser.parse(text), observation)
        except NotAWish as unread:
            unknown = tuple(w[:200] for w in unread.words)[:64]
            told = {"verdict": "not_understood", "reason": str(unread), "unknown": unknown}
        except WishError as error:
            told = {"verdict": error.verdict, "reason": str(error)[:2000]}
        return EditPlan(instruction=text, planner=NAME, seconds=time.perf_counter() - started, **told)

    def _planned(self, reading: ParsedInstruction, observation: Observation | None) -> dict[str, Any]:
        """The fields of the plan: operations and reason, or a verdict and reason. Raises WishError if a wish cannot be
        fulfilled."""
        # Imported here because the solver takes half a second to import and few instructions are wishes.
        from . import achieve
        from .move_order import ordered_moves

        if observation is None:
            return {"verdict": "not_understood", "reason": "a wish for a room needs the scene: open one first"}
        try:
            graph = observation.graph()
        except ScenewrightError as error:
            return {"verdict": "not_understood", "reason": f"a wish for a room needs the scene: {error}"}
        start = Room.of(graph)
        goal = copy_of(start)
        achieve.achieve(goal, reading.goals)
        _refuse_worse(graph, goal.after())
        plain = [op for g in reading.goals if isinstance(g, PlainEdit) for op in g.ops]
        ops: list[EditOp] = [*ordered_moves(start, goal), *goal.ops, *plain]
        if not ops:
            return {"verdict": "not_an_edit", "reason": "the room is like that already: nothing has to move"}
        if len(ops) > MAX_OPS:
            raise WishError(f"that takes {len(ops)} steps, at most {MAX_OPS} are planned at once; ask for less")
        return {"ops": tuple(ops), "reason": "; ".join(goal.done)[:2000]}


def _refuse_worse(before: SceneGraph, after: SceneGraph) -> None:
    """Raise WishError if the change causes violations that were not there: overlaps, things outside the room or in the
    air."""
    from ..rooms.check import check

    known = {_key(v) for v in check(before.model_copy(update={"relations": ()})).violations}
    fresh = [v for v in check(after).violations if v.kind != "reach" and _key(v) not in known]
    if fresh:
        raise WishError(f"that would cause a new problem: {fresh[0].sentence}")


def _key(violation: Violation) -> tuple[str, frozenset[int | str]]:
    return violation.kind, frozenset(violation.ids)
