"""A session on a scene in tiles: each instruction is carried out on a window of it, whose changes go back to the tiles.

    plan -> groups that its words mean, by the table -> window of them and what is around -> the operation, as ever
         -> differences by id -> new files of the touched tiles

Names are on groups, so that most tiles are never read.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...gaussians.errors import ScenewrightError, UserError
from ...gaussians.language.query.nested import queries
from ...gaussians.language.query.query import ALL, BACKGROUND, FLOATERS, Query
from ...gaussians.language.query.resolve import Resolver
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ...gaussians.tiles import changing, window
from ...gaussians.tiles.store import Tiles
from .history import History, State
from .planner_client import undo_or_redo
from .result import Result
from .session import Session

if TYPE_CHECKING:
    from ...gaussians.language.query.explain import Explanation
    from ...planners.plan import EditPlan
    from ...planners.questions.survey import Survey

OF_THE_TARGET = frozenset({"select", "recolor", "opacity"})  # operations that look at their target alone
NEARBY = frozenset({"delete"})  # operations that give the same bytes in a window with what is around the target
_SAMPLE = 1000  # rows that colours are looked up in before the window is taken


class TiledSession(Session):
    """A session on a scene in tiles. What it edits is in the folder at once; undo and redo reach edits of earlier
    sessions too.

    Args:
        tiles: the scene.
        memory: bytes that a window and the work on it may take.
        options: as `Session` takes them.

    Attributes:
        tiles: the scene as it is now.
    """

    def __init__(self, tiles: Tiles, memory: int, **options: Any) -> None:
        self.tiles = tiles
        self._memory = memory
        self._window: window.Window | None = None
        super().__init__(window.outline(tiles, _SAMPLE), **options)

    def embed(self, then: str | None = None) -> Scene:
        """The scene, which must have a table of the session's encoder already.

        Raises:
            UserError: it has none, or another encoder made it.
        """
        language = self.scene.language
        if language is None:
            raise UserError(
                "the things of these tiles have no names: run `scenewright embed` on the folder if it fits into "
                "memory, else on the files, and tile them again"
            )
        if language.encoder != self.encoder.fingerprint:
            made_by = language.encoder if language.making is None else language.making.encoder
            raise UserError(f"these tiles were embedded by {made_by}; choose it with --encoder")
        return self.scene

    def do(self, text: str) -> Result:
        """See `Session.do`."""
        if (step := undo_or_redo(text)) is not None:
            return self.undo() if step == "undo" else self.redo()
        return super().do(text)

    def select(self, phrase: str | Query) -> Selection:
        """See `Session.select`."""
        query = self._planner.query(phrase)
        self._look(self._taken((query,), ()))
        return super().select(query)

    def explain(self, phrase: str | Query) -> Explanation:
        """See `Session.explain`."""
        query = self._planner.query(phrase)
        self._look(self._taken((query,), ()))
        return super().explain(query)

    def survey(self) -> Survey:
        """See `Session.survey`; questions may be about anything, so they need the whole scene.

        Raises:
            UserError: it does not fit into the memory.
        """
        self._look(window.everything(self.tiles, self._memory))
        return super().survey()

    def save(self, path: str | Path, force: bool = False) -> None:
        """Write the whole scene to another file.

        Raises:
            UserError: it does not fit into the memory, or as `Session.save`.
            FileError: as `Session.save`.
        """
        from ...gaussians.files import save

        save(window.everything(self.tiles, self._memory).scene, path, force=force)

    def undo(self) -> Result:
        """Undo the last edit of the folder.

        Raises:
            UserError: there is nothing to undo.
            FileError: the folder cannot be changed.
        """
        return self._stepped("undo", *changing.undo(self.tiles.folder))

    def redo(self) -> Result:
        """Redo the edit that was undone last; raises as `undo`."""
        return self._stepped("redo", *changing.redo(self.tiles.folder))

    def apply(self, plan: EditPlan, *, planned_in: float = 0.0, start: State | None = None) -> Result:
        """See `Session.apply`."""
        result = super().apply(plan, planned_in=planned_in)
        present = self._history.present
        self._history = History(replace(present, scene=window.outline(self.tiles, _SAMPLE)))
        return result

    def _stepped(self, kind: str, tiles: Tiles, text: str) -> Result:
        before, self.tiles = self.scene, tiles
        after = window.outline(tiles, _SAMPLE)
        self._history = History(State(after))
        self.question = None
        return Result(f"{kind}: {text}", None, (), before, after, self.viewer)

    def _carry_out(
        self, plan: EditPlan, seconds: dict[str, float], *, dry_run: bool, start: State | None = None
    ) -> tuple[Result, State]:
        from ...gaussians.timing import timed

        with timed(seconds, "tiles"):
            taken = self._taken_for(plan)
            self._look(taken)
        result, state = super()._carry_out(plan, seconds, dry_run=dry_run)
        if not dry_run and result.scene is not taken.scene:
            with timed(seconds, "write"):
                self.tiles = changing.change(taken, result.scene, plan.instruction)
        total = len(self.tiles) + (len(result.scene.cloud) - len(taken.scene.cloud) if dry_run else 0)
        told = self._told(plan, taken)
        receipts = tuple(r.model_copy(update={"total": total, "notes": (*r.notes, *told)}) for r in result.receipts)
        return replace(result, receipts=receipts), replace(state, receipts=receipts)

    def _told(self, plan: EditPlan, taken: window.Window) -> tuple[str, ...]:
        """What a user should know of the window that a plan was carried out in."""
        if taken.scene.cloud.rest is None or {op.op for op in plan.ops} <= OF_THE_TARGET | NEARBY:
            return ()
        rows = len(taken.scene.cloud)
        return (f"light, shadows and what lies behind were measured in the {rows:,} Gaussians around it",)

    def _look(self, taken: window.Window) -> None:
        """Let the session see a window."""
        self._window = taken
        self._history.amend(replace(self._history.present, scene=taken.scene))

    def _taken_for(self, plan: EditPlan) -> window.Window:
        """The window that a plan is carried out in."""
        kinds = {op.op for op in plan.ops}
        alone = tuple(query for op in plan.ops if op.op in OF_THE_TARGET for _, query in queries(op))
        near = tuple(query for op in plan.ops if op.op not in OF_THE_TARGET for _, query in queries(op))
        if not kinds <= OF_THE_TARGET | NEARBY and window.fits(self.tiles, len(self.tiles), self._memory):
            return window.everything(self.tiles, self._memory)
        return self._taken(alone, near)

    def _taken(self, alone: Sequence[Query], near: Sequence[Query]) -> window.Window:
        """A window of what some queries may mean, and of what is around what others may mean.

        Raises:
            UserError: it does not fit into the memory.
        """
        self.embed()
        own, middle = ({g for query in asked for g in self._groups(query)} for asked in (alone, near))
        if not own | middle or any(_is_of_all(query) for query in (*alone, *near)):
            if not own | middle and not window.fits(self.tiles, len(self.tiles), self._memory):
                return window.of_groups(self.tiles, (), self._memory)  # the table alone says that nothing is there
            return window.everything(self.tiles, self._memory)
        if not near:
            return window.of_groups(self.tiles, own, self._memory)
        return window.around(self.tiles, middle, self._memory, own)

    def _groups(self, query: Query) -> set[int]:
        """The groups that a query may mean, by the table and a few Gaussians; perhaps more than it does."""
        if query.last:
            return set(self.last.groups) if self.last is not None else set()
        plain = query.model_copy(
            update={
                "colors": (), "not_colors": (), "size": None, "relations": (), "pick": "all", "count": None,
                "ordinal": None, "exclude": (), "also": (), "grow": None, "invert": False, "region": None,
            }
        )  # fmt: skip
        try:
            return self._named_by(query, self.scene.replace(cloud=_NoRows()))
        except _RowsNeeded:  # colours that the table does not confirm are looked up in all things of the name
            return self._named_by(query, self.scene) | self._named_by(plain, self.scene)

    def _named_by(self, query: Query, scene: Scene) -> set[int]:
        """The groups that a query means in a scene, and those that it is not sure about."""
        try:
            found = Resolver(scene, self.viewer, self.encoder, self.last, bare=True).select(query)
        except ScenewrightError:
            return set()
        return {*found.groups, *(c.group for c in found.candidates)} - {-1}


class _RowsNeeded(Exception):  # not an error: the table alone does not tell
    """A query asked for Gaussians and not for the table of groups alone."""


class _NoRows:
    """Stands for the Gaussians of a scene while a query is resolved by its table alone."""

    def __getattr__(self, name: str) -> Any:
        raise _RowsNeeded(name)

    def __len__(self) -> int:
        raise _RowsNeeded("rows")


def _is_of_all(query: Query) -> bool:
    """Whether a query may mean Gaussians anywhere in the scene."""
    whole = query.text in ALL or query.text in BACKGROUND or query.text in FLOATERS
    described = bool(query.colors or query.relations or query.groups or query.last)
    return (
        (whole and not described)
        or query.region is not None
        or query.invert
        or bool(query.grow)
        or query.pick == "rest"
    )
