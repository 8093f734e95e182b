"""The planner of wishes: from a wish in words, over goals and a layout, to atomic operations that lead there.

Knows the order of the work. Refuses to do half of it: if one of several wishes cannot come true nothing is planned, and
the reason says which and why.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from ...gaussians.errors import ScenewrightError
from ...tools.operation import EditOp
from ..plan import MAX_OPS, EditPlan
from ..rooms.graph import SceneGraph
from .goals import Plain
from .reading import Reader, Reading, Unread
from .room import CannotError, Room, copied

if TYPE_CHECKING:
    from ..plan import Observation
    from ..rooms.check import Violation

NAME = "wishes"


class WishPlanner:
    """Plans wishes for a whole room. Stateless; one instance serves all threads."""

    name = NAME

    def __init__(self) -> None:
        self._reader = Reader()

    def reads(self, text: str) -> bool:
        """Whether a text is a wish for a room, as far as its words go; no scene is looked at.

        Raises:
            UserError: the text is too long to be an instruction.
        """
        try:
            return self._reader.may_wish(text) and self._reader.read(text).wished
        except Unread:
            return False

    def plan(self, text: str, *, previous: str | None = None, observation: Observation | None = None) -> EditPlan:
        """The plan for a wish; see `Planner.plan`. `previous` is not looked at: a wish says what it is about.

        Raises:
            UserError: the text is too long to be an instruction.
        """
        started = time.perf_counter()
        told: dict[str, Any]
        try:
            told = self._planned(self._reader.read(text), observation)
        except Unread as unread:
            unknown = tuple(w[:200] for w in unread.words)[:64]
            told = {"verdict": "not_understood", "reason": str(unread), "unknown": unknown}
        except CannotError as error:
            told = {"verdict": error.verdict, "reason": str(error)[:2000]}
        return EditPlan(instruction=text, planner=NAME, seconds=time.perf_counter() - started, **told)

    def _planned(self, reading: Reading, observation: Observation | None) -> dict[str, Any]:
        """Operations and reason, or another verdict.

        Raises:
            CannotError: a wish cannot come true.
        """
        # The solver takes half a second to import; every instruction is read, and few are wishes.
        from . import fulfilling
        from .steps import moves

        if observation is None:
            return {"verdict": "not_understood", "reason": "a wish for a room needs the scene: open one first"}
        try:
            graph = observation.graph()
        except ScenewrightError as error:
            return {"verdict": "not_understood", "reason": f"a wish for a room needs the scene: {error}"}
        start = Room.of(graph)
        goal = copied(start)
        fulfilling.fulfil(goal, reading.goals)
        _refuse_worse(graph, goal.after())
        plain = [op for g in reading.goals if isinstance(g, Plain) for op in g.ops]
        ops: list[EditOp] = [*moves(start, goal), *goal.ops, *plain]
        if not ops:
            return {"verdict": "not_an_edit", "reason": "it is so already: nothing has to move"}
        if len(ops) > MAX_OPS:
            raise CannotError(f"that takes {len(ops)} steps, at most {MAX_OPS} are planned at once; wish for less")
        return {"ops": tuple(ops), "reason": "; ".join(goal.told)[:2000]}


def _refuse_worse(before: SceneGraph, after: SceneGraph) -> None:
    """Raise if things would stand in each other, out of the room or in the air that did not before.

    Raises:
        CannotError: they would.
    """
    from ..rooms.check import check

    known = {_key(v) for v in check(before.model_copy(update={"relations": ()})).violations}
    fresh = [v for v in check(after).violations if v.kind != "reach" and _key(v) not in known]
    if fresh:
        raise CannotError(f"that would not do: {fresh[0].sentence}")


def _key(violation: Violation) -> tuple[str, frozenset[int | str]]:
    return violation.kind, frozenset(violation.ids)
