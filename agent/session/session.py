"""A session: instructions about one scene in a straight line, answers to questions, and replay.

    do(text) -> planner.plan -> EditPlan -> for each operation: resolve, apply, check -> Receipt -> log -> Result

Knows the order of things. Refuses to know grammar, pixels and tensors, and leaves the scene and its past to the
workspace that it is. An instruction is carried out whole or not at all, and its record is on the disk before the
session moves on.
"""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from ...gaussians.camera import Camera
from ...gaussians.errors import ScenewrightError, UserError
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from .clarify import answered
from .history import State
from .plan_runner import Stopped, carry_out, names_things
from .planner_client import Reader, step_meant
from .refusal import refusal, retold
from .replay import Replayed, deeds
from .result import Result
from .sight import SessionSight
from .stopwatch import timed
from .workspace import Progress, Workspace

if TYPE_CHECKING:
    from ...gaussians.language.encoders import Encoder
    from ...gaussians.language.query.explain import Explanation
    from ...planners.budget import Budget
    from ...planners.plan import EditPlan, Planner, Usage


class Session(Workspace):
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
        progress = progress or (lambda stage, fraction: None)
        # The planner first: a name that is none leaves no log behind.
        self._reader = Reader(planner, SessionSight(self), budget, pictures, progress)
        super().__init__(scene, encoder, log, viewer, progress=progress, seed=seed, pixel_checks=pixel_checks)

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
            self._journal.refused(text, None, error, self._history.present)
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
            self._journal.refused(plan.instruction, plan, error, self._history.present)
            raise
        with timed(seconds, "log"):
            self._journal.done(result, self._history.present, state)
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

    # -- inside -----------------------------------------------------------------------------------------------------

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
