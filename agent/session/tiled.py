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
from ...gaussians.world.facing import SAMPLE as FACING_ROWS
from .history import History, State
from .planner_client import undo_or_redo
from .result import Result
from .session import Session

if TYPE_CHECKING:
    from ...gaussians.language.query.explain import Explanation
    from ...planners.plan import EditPlan
    from ...planners.questions.answer import Answer
    from ...planners.questions.survey import Survey

OF_THE_TARGET = frozenset({"select", "recolor", "opacity"})  # operations that look at their target alone
NEARBY = frozenset({"delete"})  # operations that give the same bytes in a window with what is around the target
SAMPLE = 1000


class TiledSession(Session):
    """A session on a scene in tiles. What it edits is in the folder at once; undo and redo reach edits of earlier
    sessions too.

    Args:
        tiles: the scene.
        memory: bytes that a window and the work on it may take.
        rows: Gaussians that are seen of it between instructions, evenly spaced: by them views are chosen and moved, and
            colours are looked up before a window is taken.
        options: as `Session` takes them.

    Attributes:
        tiles: the scene as it is now.
        memory: as given.
    """

    def __init__(self, tiles: Tiles, memory: int, rows: int = SAMPLE, **options: Any) -> None:
        self.tiles = tiles
        self.memory = memory
        self._rows = rows
        self._things: Scene | None = None  # a sample of each thing, for questions
        self._no_rows: Any = _NoRows()
        self._outline = window.outline(tiles, rows)
        super().__init__(self._outline, **options)

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
        self._look(self._taken((query,), ()).scene)
        return super().select(query)

    def explain(self, phrase: str | Query) -> Explanation:
        """See `Session.explain`."""
        query = self._planner.query(phrase)
        self._look(self._taken((query,), ()).scene)
        return super().explain(query)

    def recall(self, text: str | None) -> None:
        """See `Session.recall`."""
        if text and (about := self._planner.subject(text)) is not None:
            self._look(self._taken((about,), ()).scene)
        super().recall(text)

    def remember(self, groups: tuple[int, ...]) -> None:
        """See `Session.remember`; groups that do not fit into the memory are not remembered."""
        try:
            self._look(self._taken((Query(groups=groups[:256]),), ()).scene)
        except UserError:
            return
        super().remember(groups)

    def regroup(self, scene: Scene) -> None:
        """See `Session.regroup`. Names that are given to groups last until the next instruction.

        Raises:
            UserError: groups of Gaussians differ; they would have to be written.
        """
        if scene.cloud is not self.scene.cloud:
            raise UserError(
                "pieces and portions of things cannot be chosen in a scene in tiles; choose a whole thing by its "
                "number, or describe what is meant by its colour or its place"
            )
        super().regroup(scene)

    def surroundings(self, groups: Sequence[int]) -> Scene:
        """See `Session.surroundings`: a window around the groups."""
        if not groups:
            return self._outline
        return window.around(self.tiles, groups, self.memory).scene

    def look_away(self) -> None:
        """See all of the scene in outline again, and not the last window."""
        self._look(self._outline)

    @property
    def done(self) -> tuple[str, ...]:
        """See `Session.done`; those of earlier sessions too."""
        head = self.tiles.head
        return tuple(step.text for step in (*head.past, head.present) if step.text)

    @property
    def redoable(self) -> bool:
        """See `Session.redoable`."""
        return bool(self.tiles.head.future)

    def ask(self, text: str) -> Answer:
        """See `Session.ask`. Where the scene does not fit into the memory, what things are, where and how large is told
        by the table of groups, and how they are turned by a sample of each; no vision model is asked.

        Raises:
            UserError: as `Session.ask`; or even the samples do not fit into the memory.
        """
        if window.fits(self.tiles, len(self.tiles), self.memory):
            return super().ask(text)
        from ...planners.questions.asking import route
        from ...planners.questions.topic import topic

        survey = self.survey()
        given = route(text, survey, None).answer
        if groups := tuple(id for id in topic(given, survey) if isinstance(id, int)):
            self.remember(groups)
        return given

    def survey(self) -> Survey:
        """See `Session.survey`: of the whole scene, or of a sample of each thing if it does not fit into the memory.

        Raises:
            UserError: not even the samples fit.
        """
        self.embed()
        if window.fits(self.tiles, len(self.tiles), self.memory):
            self._look(window.everything(self.tiles, self.memory).scene)
            return super().survey()
        if self._things is None:
            self._things = window.things(self.tiles, self.memory, FACING_ROWS)
        self._look(self._things)
        return super().survey()

    def save(self, path: str | Path, force: bool = False, names: bool = True) -> Path | None:
        """Write the whole scene to another file: a .ply tile by tile, others if it fits into the memory; see
        `Session.save`.

        Raises:
            UserError: it does not fit, or as `Session.save`.
            FileError: as `Session.save`.
        """
        from ...gaussians.tiles.exporting import is_streamed, write_field, write_ply

        if is_streamed(Path(path)):
            write_ply(self.tiles, Path(path), force)
            return write_field(self.tiles, Path(path)) if names else None
        return self._written(window.everything(self.tiles, self.memory).scene, path, force, names)

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
        self._changed()
        self._history = History(replace(self._history.present, scene=self._outline))
        return result

    def _stepped(self, kind: str, tiles: Tiles, text: str) -> Result:
        before, self.tiles = self.scene, tiles
        self._changed()
        self._history = History(State(self._outline))
        self.question = None
        cloud = self._outline.cloud
        seen = cloud.replace(rest=window.Beyond(tiles, cloud.ids, cloud.group.numpy()))
        return Result(f"{kind}: {text}", None, (), before, self._outline.replace(cloud=seen), self.viewer)

    def _changed(self) -> None:
        """See the scene as it is now."""
        self._outline, self._things = window.outline(self.tiles, self._rows), None

    def _carry_out(
        self, plan: EditPlan, seconds: dict[str, float], *, dry_run: bool, start: State | None = None
    ) -> tuple[Result, State]:
        from ...gaussians.timing import timed

        with timed(seconds, "tiles"):
            taken = self._taken_for(plan)
            self._look(taken.scene)
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

    def _look(self, scene: Scene) -> None:
        """Let the session see a part of the scene."""
        self._history.amend(replace(self._history.present, scene=scene))

    def _taken_for(self, plan: EditPlan) -> window.Window:
        """The window that a plan is carried out in."""
        kinds = {op.op for op in plan.ops}
        alone = tuple(query for op in plan.ops if op.op in OF_THE_TARGET for _, query in queries(op))
        near = tuple(query for op in plan.ops if op.op not in OF_THE_TARGET for _, query in queries(op))
        if not kinds <= OF_THE_TARGET | NEARBY and window.fits(self.tiles, len(self.tiles), self.memory):
            return window.everything(self.tiles, self.memory)
        return self._taken(alone, near)

    def _taken(self, alone: Sequence[Query], near: Sequence[Query]) -> window.Window:
        """A window of what some queries may mean, and of what is around what others may mean.

        Raises:
            UserError: it does not fit into the memory.
        """
        self.embed()
        own, middle = ({g for query in asked for g in self._groups(query)} for asked in (alone, near))
        if not own | middle or any(_is_of_all(query) for query in (*alone, *near)):
            if not own | middle and not window.fits(self.tiles, len(self.tiles), self.memory):
                return window.of_groups(self.tiles, (), self.memory)  # the table alone says that nothing is there
            return window.everything(self.tiles, self.memory)
        if not near:
            return window.of_groups(self.tiles, own, self.memory)
        return window.around(self.tiles, middle, self.memory, own)

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
            return self._named_by(query, self._outline.replace(cloud=self._no_rows))
        except _RowsNeeded:  # colours that the table does not confirm are looked up in all things of the name
            return self._named_by(query, self._outline) | self._named_by(plain, self._outline)

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
