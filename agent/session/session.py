"""A session: instructions about one scene, answers to questions, undo and redo, replay, and the log.

    do(text) -> planner.plan -> EditPlan -> for each operation: resolve, apply, check -> Receipt -> log -> Result

An instruction is carried out whole or not at all, and its record is on the disk before the session moves on.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec

from ...gaussians.camera import Camera
from ...gaussians.errors import ScenewrightError, UserError
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ...gaussians.timing import timed
from . import log_records
from .clarify import Question, answered
from .history import History, State
from .log import SessionLog
from .plan_runner import Stopped, carry_out, names_things
from .planner_client import Reader, step_meant
from .refusal import refusal, retold
from .replay import Replayed, deeds
from .result import Result
from .sight import graph_of, picture_of

if TYPE_CHECKING:
    from ...gaussians.language.encoders import Encoder
    from ...gaussians.language.query.explain import Explanation
    from ...planners.budget import Budget
    from ...planners.plan import EditPlan, Planner, Usage
    from ...planners.rooms.graph import SceneGraph
    from ...tools.operation import Context

P = ParamSpec("P")
Progress = Callable[[str, float], None]  # stage in words, share done in [0, 1]


class Session:
    """A conversation about one scene.

    Args:
        scene: where it starts; never changed in place.
        planner: who reads instructions: a name that `planners.load` takes, or a planner. "auto": the grammar, and where
            it abstains a language model, if `SCENEWRIGHT_MODEL` names one.
        encoder: which encoder words are compared with: a name that `gaussians.language.encoders.load` takes, or one.
        log: path of a session log to append to, or None.
        viewer: whose left and right are meant, and what `Result.render` shows; by default the scene's first camera,
            or a view chosen from the scene.
        progress: told how far long work is.
        seed: what varies between two inserted things of a kind.
        pixel_checks: also compare the viewer's picture before and after each operation.
        budget: what language models may cost: "20s" for each instruction, "0.05usd" for the whole session, or both,
            "20s,0.05usd". Used up, "auto" leaves them out, and says so.
        pictures: let models see the viewer's picture, where they can.

    Attributes:
        question: which of several things is meant, or what is nearest to one that is not there; None if nothing is
            open.
        pixel_checks: also compare the viewer's picture before and after each operation.

    Raises:
        UserError: no such planner, or the budget is none.
        BackendError: the planner that was named lacks something.
        FileError: the log cannot be opened.
    """

    def __init__(
        self,
        scene: Scene,
        planner: str | Planner = "auto",
        encoder: str | Encoder = "auto",
        log: str | Path | None = None,
        viewer: Camera | None = None,
        *,
        progress: Progress | None = None,
        seed: int = 0,
        pixel_checks: bool = False,
        budget: str | Budget | None = None,
        pictures: bool = False,
    ) -> None:
        self._progress = progress or (lambda stage, fraction: None)
        # The planner first: a name that is none leaves no log behind.
        self._reader = Reader(planner, self, budget, pictures, self._progress)
        self._encoder = encoder
        self._viewer = viewer
        self._seed = seed
        self.pixel_checks = pixel_checks
        self.question: Question | None = None
        self._history = History(State(scene))
        self._log = SessionLog(log) if log is not None else None
        self._record("open", log_records.opened, self._history.present)

    # -- what it is now ---------------------------------------------------------------------------------------------

    @property
    def scene(self) -> Scene:
        """The scene as it stands."""
        return self._history.present.scene

    @property
    def last(self) -> Selection | None:
        """What "it" means."""
        return self._history.present.last

    @property
    def done(self) -> tuple[str, ...]:
        """The instructions that led to the present scene, oldest first."""
        states = [*self._history.past, self._history.present]
        return tuple(s.text for s in states if s.text)

    @property
    def viewer(self) -> Camera:
        """Whose left and right are meant."""
        if self._viewer is None:
            from ..pictures.named_cameras import default_view

            self._viewer = default_view(self.scene)
        return self._viewer

    @viewer.setter
    def viewer(self, camera: Camera) -> None:
        self._viewer = camera

    @property
    def encoder(self) -> Encoder:
        """The encoder, loaded when first needed."""
        if isinstance(self._encoder, str):
            from ...gaussians.language import encoders

            self._encoder = encoders.load(self._encoder)
        return self._encoder

    def embed(self) -> Scene:
        """The scene with its language field, made now if it has none."""
        if self.scene.language is None:
            from ...gaussians.language.field.embed import embed

            present = self._history.present
            state = replace(present, scene=embed(present.scene, self.encoder, progress=self._progress))
            self._record("embed", log_records.embedded, present, state)
            self._history.amend(state)
        return self.scene

    def graph(self) -> SceneGraph:
        """What stands where, and where the viewer stands; ids are groups. Embeds the scene, as a query would.

        Raises:
            ScenewrightError: the scene could not be embedded.
            UserError: it is larger than a graph may be.
        """
        return graph_of(self.embed(), self.viewer)

    def picture(self) -> bytes:
        """The viewer's view as PNG, as planners see it."""
        return picture_of(self.scene, self.viewer)

    def _context(self, last: Selection | None) -> Context:
        """What an operation is given besides the scene, where "it" means `last`."""
        from ...tools.operation import Context

        encoder = self.encoder if self.scene.language is not None else None
        return Context(viewer=self.viewer, last=last, encoder=encoder, seed=self._seed, pixel_checks=self.pixel_checks)

    # -- who reads --------------------------------------------------------------------------------------------------

    @property
    def planner(self) -> str:
        """Who reads instructions, as receipts call it; for "auto" with the model that it may ask."""
        return self._reader.name

    @planner.setter
    def planner(self, planner: str | Planner) -> None:
        self._reader.use(planner)

    @property
    def budget(self) -> Budget:
        """What language models may cost: seconds for an instruction, dollars for the session."""
        return self._reader.budget

    @property
    def spent(self) -> Usage | None:
        """What language models were asked for in this session, whatever came of it; None if none was."""
        return self._reader.spent

    @property
    def planned(self) -> EditPlan | None:
        """The plan that was made last, whatever came of it."""
        return self._reader.last

    # -- one instruction --------------------------------------------------------------------------------------------

    def do(self, text: str) -> Result:
        """Carry out an instruction, whole or not at all. "undo" and "redo" in words are understood too.

        Raises:
            NotUnderstoodError: the words were not understood; the message says which. (A UserError.)
            ImpossibleError: understood, but there is no operation for it. (An InstructionError.)
            AbsentError: what is named is not there. `question` holds the nearest things.
            AmbiguousError: several things match. `question` holds them; `answer` says which.
            CheckFailedError: an operation failed its own check and everything was rolled back.
            InstructionError: it cannot be done as said.
            BackendError: a language model that was named as the only planner gave no plan.
        """
        if (step := step_meant(text)) is not None:
            return self.undo() if step == "undo" else self.redo()
        started = time.perf_counter()
        try:
            plan = self.plan(text)
        except ScenewrightError as error:
            self._record("failed", log_records.refused, text, None, error, self._history.present)
            raise
        return self.apply(plan, planned_in=time.perf_counter() - started)

    def plan(self, text: str) -> EditPlan:
        """What an instruction is taken to mean; nothing changes. Planners that look at the scene embed it.

        Words that were not understood give a plan without operations; its `reason` says which.

        Raises:
            UserError: the text is too long to be an instruction, or no text.
            BackendError: a language model that was named as the only planner gave no plan.
        """
        return self._reader.plan(text, self._history.present.spoken or None)

    def preview(self, instruction: str | EditPlan) -> Result:
        """A dry run: the result as it would be. Nothing is edited and no edit logged; the scene may become embedded."""
        plan = self.plan(instruction) if isinstance(instruction, str) else instruction
        return self._carry_out(plan, {}, dry_run=True)[0]

    def apply(self, plan: EditPlan, *, planned_in: float = 0.0) -> Result:
        """Carry out a plan that was made before, whole or not at all; raises as `do`."""
        seconds = {"plan": planned_in}
        try:
            result, state = self._carry_out(plan, seconds, dry_run=False)
        except ScenewrightError as error:
            self._record("failed", log_records.refused, plan.instruction, plan, error, self._history.present)
            raise
        with timed(seconds, "log"):
            self._record("do", log_records.done, result, self._history.present, state)
        self._history.advance(state)
        return result

    def answer(self, text: str) -> Result:
        """Say which of the things in `question` was meant: a number, "all", "the left one", "the red one".

        Raises:
            UserError: nothing was asked, or the answer is no choice. The question then stands.
        """
        return self.apply(self.answered(text))

    def answered(self, text: str) -> EditPlan:
        """The plan that an answer to `question` makes of the one it was asked about; raises as `answer`."""
        if self.question is None or not self.question.candidates:
            raise UserError("there is no open question; give an instruction")
        return answered(self.question, text, self._reader.noun_phrase)

    def select(self, phrase: str | Query) -> Selection:
        """What a phrase means here, whatever the verdict; the scene does not change, and "it" means what was found.

        Raises:
            UserError: the phrase was not understood.
        """
        query = self._reader.query(phrase)
        self.embed()
        found = self._context(self.last).resolve(self.scene, query)
        if found.verdict == "found":
            self._history.amend(replace(self._history.present, last=found))
        return found

    def adjust(self, *, grow: float | None = None, invert: bool = False) -> Result:
        """Grow what is selected by metres (negative shrinks it), or turn it inside out; a step that can be undone.

        Raises:
            AbsentError: nothing is selected, or nothing would be left.
            UserError: the distance is no number or too large.
        """
        from pydantic import ValidationError

        from ...planners.plan import EditPlan
        from ...tools.ops.select import Select

        try:
            query = Query(last=True, grow=grow, invert=invert)
        except ValidationError as error:
            raise UserError(f"a selection cannot grow by {grow} m; give metres between -100 and 100") from error
        return self.apply(EditPlan(instruction=query.describe(), ops=(Select(target=query),), planner="said"))

    def explain(self, phrase: str | Query) -> Explanation:
        """Why a phrase means what it means here, term by term; nothing changes, not even what "it" means.

        Raises:
            UserError: the phrase was not understood.
        """
        from ...gaussians.language.query.explain import explain
        from ...gaussians.language.query.resolve import Resolver

        query = self._reader.query(phrase)
        return explain(Resolver(self.embed(), self.viewer, self.encoder, self.last), query)

    def recall(self, text: str | None) -> None:
        """Let "it" mean what an earlier instruction was about, without carrying that out; None forgets.

        An instruction that cannot be read or found leaves "it" without a meaning.
        """
        last: Selection | None = None
        if text and (about := self._reader.subject(text)) is not None:
            scene = self.embed()
            found = self._context(None).resolve(scene, about)
            last = found if found.verdict == "found" else None
        self._history.amend(replace(self._history.present, last=last, spoken=text or ""))

    def replay(self, log: str | Path, *, session: int = -1, skip_failed: bool = False) -> list[Replayed]:
        """Carry out what another session did, here: words are resolved again, ids only where the scene is the same.

        Instructions that were undone there are left out. Each becomes a step of its own that can be undone.

        Args:
            log: a session log.
            session: which of the sessions in it, counted from the first (0) or the last (-1).
            skip_failed: go on after an instruction that cannot be carried out here and report it; without it the
                session is put back to where it was and the error is raised.

        Raises:
            FileError: the log cannot be read.
            UserError: it holds no such session.
        """
        outcome: list[Replayed] = []
        for deed in deeds(log, session):
            try:
                result = self.apply(deed.on(self._history.present.digest))
                outcome.append(Replayed(deed.text, result, None))
            except ScenewrightError as error:
                if not skip_failed:
                    for _ in outcome:
                        self.undo()
                    told = f"replay stopped at {deed.text!r}, all of it was taken back: {error}"
                    raise retold(error, told) from error
                outcome.append(Replayed(deed.text, None, error))
        return outcome

    # -- back and forth ---------------------------------------------------------------------------------------------

    def undo(self) -> Result:
        """Take the last instruction back: the scene is again the very value it was.

        Raises:
            UserError: there is nothing to undo.
        """
        return self._step("undo", self._history.behind(), self._history.present.text, self._history.back)

    def redo(self) -> Result:
        """Do again what was taken back.

        Raises:
            UserError: there is nothing to redo.
        """
        ahead = self._history.ahead()
        return self._step("redo", ahead, ahead.text, self._history.forth)

    def _step(self, kind: str, to: State, text: str, move: Callable[[], State]) -> Result:
        before = self._history.present
        self._record(kind, log_records.moved, text, before, to)
        move()
        self.question = None
        return Result(f"{kind}: {text}", None, (), before.scene, to.scene, self.viewer, to.last)

    # -- files ------------------------------------------------------------------------------------------------------

    def save(self, path: str | Path, force: bool = False) -> None:
        """Write the scene to a file; an existing one only with `force`.

        Raises:
            UserError: the file exists, or no format is written under its name.
            FileError: it cannot be written.
        """
        from ...gaussians.files import save

        save(self.scene, path, force=force)
        self._record("save", log_records.saved, path, self._history.present)

    def close(self) -> None:
        """Close the log; closing twice is harmless."""
        if self._log is not None:
            self._log.close()

    # -- inside -----------------------------------------------------------------------------------------------------

    def _record(self, kind: str, fields: Callable[P, dict[str, Any]], *said: P.args, **named: P.kwargs) -> None:
        """Write a record into the log if there is one; `fields` of it are worked out only then."""
        if self._log is not None:
            self._log.append(kind, fields(*said, **named))

    def _carry_out(self, plan: EditPlan, seconds: dict[str, float], *, dry_run: bool) -> tuple[Result, State]:
        self.question = None
        if not plan.ops:
            raise refusal(plan)
        if names_things(plan):
            with timed(seconds, "embed"):
                self.embed()
        before = self._history.present
        with timed(seconds, "edit"):
            try:
                state, receipts = carry_out(plan, before, self._context, dry_run=dry_run)
            except Stopped as stopped:
                self.question = stopped.question
                raise stopped.error from stopped.__cause__
        viewer, last = self.viewer, state.last
        result = Result(plan.instruction, plan, receipts, before.scene, state.scene, viewer, last, seconds, dry_run)
        return result, state
