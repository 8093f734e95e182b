"""A session: instructions about one scene, answers to questions, undo and redo, replay, and the log.

    do(text) -> planner.plan -> EditPlan -> for each operation: resolve, apply, check -> Receipt -> log -> Result

An instruction is carried out completely or not at all, and its record is on the disk before the state changes.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec

from ...gaussians.camera import Camera
from ...gaussians.errors import AmbiguousError, InstructionError, ScenewrightError, UnconfirmedError, UserError
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ...gaussians.timing import timed
from ...planners.rooms.own_assets import own_assets
from . import log as session_log
from .asker import FIRST_VIEWS, Asker, see_answer
from .dialled import SessionDial
from .embedding import embedded_by, only_thing
from .history import History, State
from .judge import Judge, JudgedError, known_judge
from .log_sessions import Beginning, begin
from .observation import any_moves, at_rest, graph_of, movement_of, paced, picture_of
from .own_references import own_references
from .picture_models import infill_of, photographed, restyler_of
from .plan_runner import PlanFailed, has_queries, run_plan
from .planner_client import PlannerClient, undo_or_redo
from .pointing import pointed_at
from .refusal import refusal, with_message
from .replay import Replayed, logged_edits, replay_edits
from .result import Result
from .sight import needs_sight, point_out
from .vision_client import VisionClient

if TYPE_CHECKING:
    from torch import Tensor

    from ...gaussians.effort import Dial, Effort
    from ...gaussians.files.captures.capture import Capture
    from ...gaussians.language.encoders import Encoder
    from ...gaussians.language.query.explain import Explanation
    from ...planners.budget import Budget, Ledger
    from ...planners.model.backend import ModelBackend
    from ...planners.plan import EditPlan, Movement, Planner, Usage
    from ...planners.questions.answer import Answer
    from ...planners.questions.describing import Description
    from ...planners.questions.survey import Survey
    from ...planners.rooms.graph import SceneGraph
    from ...tools.finishing.photograph import Photograph
    from ...tools.lifting.inpainters import Inpainter
    from ...tools.lifting.restylers import Restyler
    from ...tools.operation import Context
    from ...tools.registry import AnyOp
    from .clarify import Question
    from .naming import Named

P = ParamSpec("P")
Progress = Callable[[str, float], None]  # stage in words, share done in [0, 1]


class Session:
    """A conversation about one scene.

    Args:
        scene: the initial scene; never changed in place.
        planner: turns instructions into plans: a name that `planners.load` takes, or a planner. "auto": the grammar,
            and where it abstains a language model, if `SCENEWRIGHT_MODEL` names one.
        encoder: text and image encoder: a name that `gaussians.language.encoders.load` takes, or an encoder.
        log: path of a session log to append to, or None.
        viewer: the camera that defines left and right, and that `Result.render` uses; by default the scene's first
            camera, or a view chosen from the scene.
        progress: called with the stage and the share done during long work.
        seed: varies the assets that are inserted.
        pixel_checks: also compare the viewer's picture before and after each operation.
        budget: what language models may cost: "20s" for each instruction, "0.05usd" for the whole session, or both,
            "20s,0.05usd". When it is used up, "auto" goes on without a model, and says so.
        pictures: send the viewer's picture to models that take pictures.
        judge: "built-in": after each operation measure from the scenes, and ask the embedded encoder, whether what was
            asked for happened and nothing else; repair it at most twice, else take it back. "vlm": also ask the vision
            model, with pictures before and after. None: do not judge.
        accept_unconfirmed: edit what was chosen although its name is not confirmed, without asking; for scripts.
        assets: a folder with assets of your own (.glb, .ply), which are inserted by their names.
        infill: fill the surfaces that deleted, moved and replaced things hid: True or "scene" from the scene itself,
            False or "none" not at all, else also by a model that inpaints pictures, a name that
            `tools.lifting.inpainters.load` takes or an `Inpainter`.
        restyle: a model that paints views of what is restyled, a name that `tools.lifting.restylers.load` takes or a
            `Restyler`; None: materials are drawn.
        capture: photographs that the scene was fitted from, a `Capture` or a path that `read_capture` takes: what is
            filled is optimised against those that see behind what is gone.
        references: photographs of materials, which instructions name by their files or as "the photo"; see
            `add_reference`.
        harmony: fit what is put into the scene to its light, and let it cast shadows.
        effort: "fast", "balanced", "accurate", or seconds for each instruction or question: settings of embedding,
            filling and looking are chosen from measured points (`dial` tells which). None: the usual settings.
        vlm: a vision model for what geometry does not answer and words do not find: a name that `planners.model.load`
            takes, a back end, "auto" for the one that `SCENEWRIGHT_VLM` names, or None.

    Attributes:
        question: the open question: an ambiguous query with its candidates, an absent one with the nearest things, or
            an unconfirmed one with what was chosen; None if there is none.
        accept_unconfirmed: edit what was chosen although its name is not confirmed, without asking.
        log_notes: remarks about an existing log: the session that this one continues, broken lines, missing records.
        pixel_checks: also compare the viewer's picture before and after each operation.

    Raises:
        UserError: no such planner or judge, or the budget cannot be parsed.
        BackendError: a package, key or file that the planner needs is missing.
        FileError: the log cannot be opened, or the capture cannot be read or has no photographs.
        UserError: there is no such folder of assets, or it holds none.
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
        judge: str | None = None,
        vlm: str | ModelBackend | None = "auto",
        accept_unconfirmed: bool = False,
        assets: str | Path | None = None,
        infill: bool | str | Inpainter = True,
        capture: str | Path | Capture | None = None,
        restyle: str | Restyler | None = None,
        references: str | Path | Sequence[str | Path] | Mapping[str, Photograph] = (),
        harmony: bool = True,
        effort: Effort | Dial | None = None,
    ) -> None:
        self._progress = progress or (lambda stage, fraction: None)
        # The planner comes first, so that an unknown name creates no log file.
        self._planner = PlannerClient(planner, self, budget, pictures, self._progress)
        self._vision = VisionClient(vlm, self._planner.ledger, self._progress)
        self._encoder = encoder
        self._assets = own_assets(assets)
        self._infill, self._inpainter = infill_of(infill)
        self._fills = self._infill  # in the present instruction
        self._restyler = restyler_of(restyle)
        scene, self._photographs = photographed(scene, capture)
        self._references = own_references(references)
        self._harmony = harmony
        self._dialled = SessionDial.of(effort)
        self._asker = Asker()
        self._viewer = viewer
        self.said_at: float | None = None  # a time that was set; see `time`
        self._seed = seed
        self.pixel_checks = pixel_checks
        self.accept_unconfirmed = accept_unconfirmed
        self._judged_by = known_judge(judge, bool(self._vision))
        self.question: Question | None = None
        self._history = History(State(scene))
        self._log = session_log.SessionLog(log) if log is not None else None
        self.log_notes: tuple[str, ...] = ()
        if self._log is not None:
            self._take_over(begin(self._log, self._history.present))

    # -- state ------------------------------------------------------------------------------------------------------

    @property
    def scene(self) -> Scene:
        """The present scene."""
        return self._history.present.scene

    @property
    def digest(self) -> str:
        """SHA-256 digest of the present cloud, as in the log."""
        return self._history.present.digest

    @property
    def log_path(self) -> Path | None:
        """The session log, if there is one."""
        return self._log.path if self._log is not None else None

    @property
    def dial(self) -> Dial | None:
        """The dial with what it chose for the last job; None without `effort`."""
        return self._dialled.dial

    @property
    def last(self) -> Selection | None:
        """The selection that "it" refers to."""
        return self._history.present.last

    @property
    def done(self) -> tuple[str, ...]:
        """The instructions that led to the present scene, oldest first."""
        return tuple(s.text for s in [*self._history.past, self._history.present] if s.text)

    @property
    def states(self) -> tuple[State, ...]:
        """The states that led to the present one, oldest first, and the present one."""
        return (*self._history.past, self._history.present)

    @property
    def redoable(self) -> bool:
        """Whether there is something to redo."""
        return bool(self._history.future)

    @property
    def viewer(self) -> Camera:
        """The camera that defines left and right."""
        if self._viewer is None:
            from ..pictures.named_cameras import default_view

            self._viewer = default_view(self.scene)
        return self._viewer

    @viewer.setter
    def viewer(self, camera: Camera) -> None:
        self._viewer = camera

    @property
    def time(self) -> float:
        """The time of a scene with motion at which words are said, seconds: edits without a time are placed as things
        are then. The start at first; 0 in a scene that stands still.

        Raises (when set):
            UserError: the scene does not last until then.
        """
        motion = self.scene.motion
        if motion is None:
            return 0.0
        return motion.start if self.said_at is None else min(max(self.said_at, motion.start), motion.stop)

    @time.setter
    def time(self, seconds: float) -> None:
        motion = self.scene.motion
        if motion is None:
            raise UserError("nothing moves in this scene, so that it has no time; say for example 'open the door'")
        if not motion.start <= seconds <= motion.stop:
            raise UserError(f"the scene lasts from {motion.start:g} to {motion.stop:g} s; {seconds:g} s is not in it")
        self.said_at = float(seconds)

    def _moment(self) -> float | None:
        """The time that was set, of a scene with motion."""
        return None if self.said_at is None or self.scene.motion is None else self.time

    @property
    def encoder(self) -> Encoder:
        """The encoder, loaded when first needed."""
        if isinstance(self._encoder, str):
            from ...gaussians.language import encoders

            self._encoder = encoders.load(self._encoder)
        return self._encoder

    def embed(self, then: str | None = None) -> Scene:
        """The scene with its language field, made now if it has none.

        Args:
            then: the method of the dial that needs seconds after it, or None.

        The groups of a field that another encoder made are named anew by that of the session; a note of the field says
        so.

        Raises:
            BackendError: the encoder cannot be loaded.
        """
        language = self.scene.language
        if language is None or language.encoder != self.encoder.fingerprint:
            present = self._history.present
            made = self._dialled.embedding(present.scene, then)
            state = replace(present, scene=embedded_by(self.encoder, present.scene, self._progress, made))
            self._record("embed", session_log.embed_fields, present, state)
            self._history.amend(state)
        return self.scene

    def graph(self) -> SceneGraph:
        """The scene graph with the viewer in it; ids are group ids. Embeds the scene if it is not embedded yet.

        Raises:
            ScenewrightError: the scene could not be embedded.
            UserError: it is larger than a graph may be.
        """
        return graph_of(self.embed(), self.viewer)

    def picture(self) -> bytes:
        """The viewer's view as PNG, as it is sent to planners."""
        return picture_of(self.scene, self.viewer)

    def moves(self, query: Query) -> bool | None:
        """Whether any of what a query names moves at some time; None in a scene without motion, or if it names nothing
        there. Embeds the scene if it is not embedded yet."""
        found = self._in_motion(query)
        return None if found is None else any_moves(self.scene, found)

    def movement(self, query: Query) -> Movement | None:
        """How what a query names moves; None if it stands still, or if it names nothing there. Embeds the scene if it
        is not embedded yet."""
        found = self._in_motion(query, moves=True)
        return None if found is None else movement_of(self.scene, found)

    def after(self, ops: Sequence[AnyOp], query: Query) -> Movement | None:
        """How what a query names would move after operations that change when and how fast things do, without spells if
        it would not; None if they cannot be carried out, or if it names nothing there. Embeds the scene if it is not
        embedded yet."""
        if (found := self._in_motion(query, moves=True)) is None:
            return None
        then = paced(self.scene, ops, self._context(self.last))
        return None if then is None else movement_of(then, found) or at_rest(self.scene)

    def has(self, query: Query) -> bool:
        """Whether a scene with motion surely has what a query names; no of others. Embeds the scene if it is not
        embedded yet."""
        found = self._in_motion(query)
        return found is not None and found.verdict == "found"

    def lacks(self, query: Query) -> bool:
        """Whether a scene with motion has nothing that a query names; no of others. Embeds the scene if it is not
        embedded yet."""
        found = self._in_motion(query)
        return found is not None and found.verdict == "absent"

    def _in_motion(self, query: Query, moves: bool = False) -> Selection | None:
        """What a query names in a scene with motion, if that is asked only what moves; None in others, which are not
        embedded for that."""
        if self.scene.motion is None:
            return None
        from ...tools.timing.spans import moving_one

        self.embed()
        return moving_one(self.scene, query, self._context(self.last), moves)

    @property
    def references(self) -> tuple[str, ...]:
        """The names of the photographs that instructions may name."""
        return tuple(self._references)

    def add_reference(self, path: str | Path, width: float | None = None) -> str:
        """Let instructions name a photograph of a material: "the sofa like in the photo"; returns its name.

        Args:
            width: metres that it shows from left to right, if that is known.

        Raises:
            FileError: the file is no photograph that can be read.
            UserError: the width is no length of things.
        """
        added = own_references(path, width)
        self._references = {**self._references, **added}
        return next(iter(added))

    @property
    def judge(self) -> str | None:
        """The name of who judges edits: "built-in", "vlm", or None."""
        return self._judged_by

    @judge.setter
    def judge(self, name: str | None) -> None:
        self._judged_by = known_judge(name, bool(self._vision))

    def _judge(self) -> Judge | None:
        return None if self.judge is None else Judge(self._vision if self.judge == "vlm" else None)

    def _context(self, last: Selection | None) -> Context:
        """The context of an operation, where "it" refers to `last`."""
        from ...tools.operation import Context

        encoder = self.encoder if self.scene.language is not None else None
        return Context(
            viewer=self.viewer, last=last, encoder=encoder, seed=self._seed, pixel_checks=self.pixel_checks,
            assets=self._assets, infill=self._fills, inpainter=self._inpainter, photographs=self._photographs,
            restyler=self._restyler,
            references=self._references,
            harmony=self._harmony,
            time=self._moment(),
        )  # fmt: skip

    # -- planner ----------------------------------------------------------------------------------------------------

    @property
    def planner(self) -> str:
        """Name of the planner, as in receipts; for "auto" with the model that it may ask."""
        return self._planner.name

    @planner.setter
    def planner(self, planner: str | Planner) -> None:
        self._planner.use(planner)

    @property
    def budget(self) -> Budget:
        """What language models may cost: seconds for an instruction, dollars for the session."""
        return self._planner.budget

    @property
    def ledger(self) -> Ledger:
        """Budget and spending of models in this session, for planners that are made outside it."""
        return self._planner.ledger

    @property
    def spent(self) -> Usage | None:
        """Usage of language models in this session, refused instructions included; None if no model was asked."""
        return self._planner.spent

    @property
    def planned(self) -> EditPlan | None:
        """The latest plan, even if it was refused."""
        return self._planner.last

    # -- one instruction --------------------------------------------------------------------------------------------

    def do(self, text: str) -> Result:
        """Carry out an instruction completely or not at all. "undo" and "redo" in words are understood too.

        "More", "a bit less", "too strong" and the like carry out the last edit again from its start, with another
        strength; after an undo, the edit that was undone.

        Raises:
            NotUnderstoodError: some words were not understood; the message names them. (A UserError.)
            ImpossibleError: understood, but there is no operation for it. (An InstructionError.)
            AbsentError: a thing that is named is not there. `question` holds the nearest things.
            AmbiguousError: several things match. `question` holds them; `answer` chooses among them.
            UnconfirmedError: something was chosen whose name is not confirmed. `question` holds it; `answer("yes")`
                goes on with it, and so does `accept_unconfirmed`.
            CheckFailedError: an operation failed its own check, or the judge, and everything was rolled back.
            InstructionError: it cannot be done as said.
            BackendError: a language model that was chosen as the only planner gave no plan.
        """
        self._dialled.begin()
        if (step := undo_or_redo(text)) is not None:
            return self.undo() if step == "undo" else self.redo()
        if (changed := self._stronger(text)) is not None:
            return changed
        started = time.perf_counter()
        try:
            plan = self.plan(text)
        except ScenewrightError as error:
            self._record("failed", session_log.failed_fields, text, None, error, self._history.present)
            raise
        try:
            return self.apply(plan, planned_in=time.perf_counter() - started)
        except JudgedError as error:
            again = self._planned_again(plan, error)
            if again is None:
                raise
            return self.apply(again, planned_in=again.seconds)
        except (AmbiguousError, UnconfirmedError):
            raise  # a question that the user answers
        except (InstructionError, UserError):
            if (done := self._done_otherwise(plan)) is None:
                raise
            return done

    def _done_otherwise(self, plan: EditPlan) -> Result | None:
        """The result of what the instruction of a plan that failed most likely asks for; None if that fails, too."""
        other, question = self._planner.otherwise(plan) if plan.ok else None, self.question
        if other is None:
            return None
        try:
            return self.apply(other, planned_in=other.seconds)
        except ScenewrightError:
            self.question = question  # that of the first plan
            return None

    def _planned_again(self, plan: EditPlan, error: JudgedError) -> EditPlan | None:
        """Another plan of a language model for an instruction whose first plan was judged a failure; None if the model
        gives the same one again, or none. The grammar is not asked again: what it would do otherwise is tried where a
        plan cannot be carried out (`_done_otherwise`), and not where an eye dislikes the result."""
        if plan.usage is None:
            return None
        try:
            again = self.plan(plan.instruction)
        except ScenewrightError:
            return None
        if not again.ok or again.ops == plan.ops:
            return None
        failed = ", ".join(c.name for c in error.judgement.checks if not c.passed)
        told = f"planned again, as the judge refused the first plan ({failed})"
        return again.model_copy(update={"reason": "; ".join(r for r in (again.reason, told) if r)[:2000]})

    def plan(self, text: str) -> EditPlan:
        """The plan of an instruction; nothing is edited. Planners that look at the scene embed it.

        An instruction that is not understood gives a plan without operations; its `reason` names the words.

        Raises:
            UserError: the text is too long or is not valid Unicode.
            BackendError: a language model that was chosen as the only planner gave no plan.
        """
        context = self._history.present.context
        only = None if context else only_thing(self.scene)
        return self._planner.plan(text, context or (f"select the {only.label or 'thing'}" if only else None))

    def preview(self, instruction: str | EditPlan) -> Result:
        """A dry run: the result as it would be. Nothing is edited or logged, but the scene may become embedded."""
        self._dialled.begin()
        plan = self.plan(instruction) if isinstance(instruction, str) else instruction
        return self._carry_out(plan, {}, dry_run=True)[0]

    def _stronger(self, text: str) -> Result | None:
        """The last edit with the strength that a text asks for; None if the text does not ask for it, or there is no
        such edit, or it has no strength."""
        from .strength import stronger_plan, times_asked

        times, history = times_asked(text), self._history
        if times is None or not (history.future or history.past):
            return None
        undone = history.future[-1] if history.future else None
        last = undone or history.present
        plan = None if last.plan is None else stronger_plan(last.plan, times)
        if plan is None:
            return None
        return self.apply(plan) if undone is not None else self.apply(plan, start=history.undo_target())

    def apply(self, plan: EditPlan, *, planned_in: float = 0.0, start: State | None = None) -> Result:
        """Carry out a plan completely or not at all; raises as `do`.

        Args:
            planned_in: seconds that planning took.
            start: the state before the last edit, to carry it out instead of that edit, which is undone; None: the
                present state.
        """
        seconds = {"plan": planned_in}
        try:
            result, state = self._carry_out(plan, seconds, dry_run=False, start=start)
        except ScenewrightError as error:
            self._record("failed", session_log.failed_fields, plan.instruction, plan, error, self._history.present)
            raise
        with timed(seconds, "log"):
            if start is not None:
                self._record("undo", session_log.step_fields, plan.reason, self._history.present, start)
                self._history.undo()
            self._record("do", session_log.do_fields, result, self._history.present, state)
        self._history.advance(state)
        return result

    def answer(self, text: str) -> Result:
        """Choose among the candidates of `question`: by a number, "all", "the left one", "the red one"; or confirm what
        was chosen, by "yes".

        Of the things that are offered in place of one that was not found by its name, numbers choose; the field keeps
        that name for them.

        Raises:
            UserError: there is no open question, or the answer does not choose. The question then stays open.
            AbsentError: the answer is "no", and `question` offers other things.
            UnconfirmedError: the answer is "no" to what was chosen; the question is closed.
        """
        return self.apply(self.answered(text))

    def offer_others(self) -> ScenewrightError | None:
        """Let the open question offer other things than those it lists, none of which is meant, and the error that says
        so. None if there are none left."""
        from .answering import offer_others

        return offer_others(self)

    def answered(self, text: str) -> EditPlan:
        """The plan of `question` with the answer in it; raises as `answer`."""
        from .answering import answered

        return answered(self, text)

    def noun_phrase(self, text: str) -> Query | None:
        """What an answer means as a noun phrase, None if it is none."""
        return self._planner.noun_phrase(text)

    def regroup(self, scene: Scene) -> None:
        """Take over a scene whose field or groups differ, not its Gaussians; the log tells if groups do."""
        present = self._history.present
        state = replace(present, scene=scene)
        if scene.cloud is not present.scene.cloud:
            self._record("embed", session_log.embed_fields, present, state)
        self._history.amend(state)

    def select(self, phrase: str | Query) -> Selection:
        """Resolve a phrase, whatever the verdict; the scene does not change, and "it" refers to what was found.

        Raises:
            UserError: the phrase was not understood.
        """
        self._dialled.begin()
        query = self._planner.query(phrase)
        self.embed()
        found = replace(self._context(self.last).resolve(self.scene, query), query=query)
        if self._vision and needs_sight(found):
            seen, told = self._by_sight(found)
            found = (self._context(None).resolve(self.scene, seen) if seen is not None else found).noting(told)
        if found.chosen:
            self._history.amend(replace(self._history.present, last=found))
        return found

    def adjust(self, *, grow: float | None = None, invert: bool = False) -> Result:
        """Grow the selection by metres (negative shrinks it), or invert it; a step that can be undone.

        Raises:
            AbsentError: nothing is selected, or nothing would be left.
            UserError: the distance is not a number, or is too large.
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
        """Explain how a phrase resolves, term by term; nothing changes, not even what "it" refers to.

        Raises:
            UserError: the phrase was not understood.
        """
        from ...gaussians.language.query.explain import explain
        from ...gaussians.language.query.resolve import Resolver

        query = self._planner.query(phrase)
        return explain(Resolver(self.embed(), self.viewer, self.encoder, self.last), query)

    def recall(self, text: str | None) -> None:
        """Let "it" refer to the target of an earlier instruction, without carrying that out; None clears it.

        After an instruction that cannot be read or whose target is not found, "it" refers to nothing.
        """
        last: Selection | None = None
        if text and (about := self._planner.subject(text)) is not None:
            scene = self.embed()
            found = self._context(None).resolve(scene, about)
            last = found if found.chosen else None
        self._history.amend(replace(self._history.present, last=last, context=text or ""))

    def remember(self, groups: tuple[int, ...]) -> None:
        """Let "it" refer to these groups; the scene must be embedded."""
        found = self._context(None).resolve(self.scene, Query(groups=groups[:256]))
        self._history.amend(replace(self._history.present, last=found))

    def point(self, ids: Tensor | None) -> Selection | None:
        """Let "it" refer to Gaussians that were pointed at, not named: ids `[M]`, ascending; None or no id: to nothing.

        No edit, but the log tells it, so that a replay has the same "it".
        """
        present = self._history.present
        found = pointed_at(self.scene, ids) if ids is not None and len(ids) else None
        state = replace(present, last=found)
        self._record("select", session_log.select_fields, state)
        self._history.amend(state)
        return found

    # -- questions --------------------------------------------------------------------------------------------------

    def ask(self, text: str) -> Answer:
        """The answer to a question about the scene; "it" then refers to what the answer is about.

        Geometry answers what boxes, colours and relations decide; a vision model, if there is one, what pictures show.
        A question that nobody can answer has the answer None, and the text says why. The scene does not change, but may
        become embedded.

        Raises:
            UserError: the question is too long, or the scene is larger than a graph may be.
        """
        from ...planners.questions.asking import route
        from ...planners.questions.topic import topic

        self._dialled.begin()
        survey = self.survey()
        reading = route(text, survey, self._asker.timeline(self.scene, self.viewer, self.encoder, self.last, self.time))
        given = reading.answer
        if self._vision and reading.sight:
            first = self._dialled.views(FIRST_VIEWS)
            given = see_answer(text, given, survey, self.scene, self.viewer, self._vision, first)
        if groups := tuple(id for id in topic(given, survey) if isinstance(id, int)):
            self.remember(groups)
        return given

    def describe(self) -> Description:
        """A paragraph about the scene and a line for each thing, from what is measured. Embeds the scene if need be.

        Raises:
            UserError: the scene is larger than a graph may be.
        """
        from ...planners.questions.describing import describe

        return describe(self.survey())

    def name_all(self, *, overwrite: bool = False) -> Named:
        """Let the vision model name all things, from a few pictures; the language field keeps the names. No edit.

        Args:
            overwrite: take its name for things with a sure name too.

        Raises:
            UserError: there is no vision model.
            BackendError: it cannot be asked, or gave no usable reply.
        """
        from .naming import name_all

        named = name_all(self.embed(), self.viewer, self._vision, overwrite=overwrite)
        self._history.amend(replace(self._history.present, scene=named.scene))
        return named

    def is_question(self, text: str) -> bool:
        """Whether a text is a question rather than an instruction; an order in polite words is an instruction."""
        reading = self._planner.reads_as_question(text)
        if reading is not None:
            return reading
        from ...planners.questions.reading.words import asks

        return asks(text)

    def continues(self, text: str) -> bool:
        """Whether a text goes on with the instruction before: "closer", after something was moved."""
        return self._planner.continues(text, self._history.present.context or None)

    def survey(self) -> Survey:
        """The scene as questions see it: boxes, colours and relations of its things; measured once for each scene."""
        self.embed()
        return self._asker.survey(self.scene, self.viewer, self.encoder, self.last)

    def surroundings(self, groups: Sequence[int]) -> Scene:
        """The embedded scene, with all that is around some groups; by it views of them are chosen."""
        return self.embed()

    def replay(self, log: str | Path, *, session: int | str = -1, skip_failed: bool = False) -> list[Replayed]:
        """Carry out the edits of a logged session on this scene.

        Words are resolved again; group ids are used only where the cloud is the same. Instructions that were undone are
        left out. Each edit is a step that can be undone.

        Args:
            log: a session log.
            session: which of the sessions in it, counted from the first (0) or the last (-1); or its id.
            skip_failed: report an instruction that cannot be carried out here and go on; without it the replayed edits
                are undone and the error is raised.

        Raises:
            FileError: the log cannot be read.
            UserError: it holds no such session.
        """
        return replay_edits(self, logged_edits(log, session), skip_failed)

    def note_restoring(self, earlier: str | None) -> None:
        """Tell the log that the edits of an earlier session are made again from here on; None: that they are made."""
        if earlier is None:
            self._record("restored", dict)
        else:
            self._record("restore", lambda: {"session": earlier})

    # -- undo and redo ----------------------------------------------------------------------------------------------

    def undo(self) -> Result:
        """Undo the last instruction: the scene is again the same object as before it.

        Raises:
            UserError: there is nothing to undo.
        """
        return self._step("undo", self._history.undo_target(), self._history.present.text, self._history.undo)

    def redo(self) -> Result:
        """Redo the instruction that was undone last.

        Raises:
            UserError: there is nothing to redo.
        """
        target = self._history.redo_target()
        return self._step("redo", target, target.text, self._history.redo)

    def _step(self, kind: str, to: State, text: str, move: Callable[[], State]) -> Result:
        before = self._history.present
        self._record(kind, session_log.step_fields, text, before, to)
        move()
        self.question = None
        return Result(f"{kind}: {text}", None, (), before.scene, to.scene, self.viewer, to.last)

    # -- files ------------------------------------------------------------------------------------------------------

    def save(self, path: str | Path, force: bool = False, names: bool = True) -> Path | None:
        """Write the scene to a file; an existing one only with `force`.

        Args:
            names: write its language field beside it, if it has one.

        Returns:
            The path of the language field that was written, or None.

        Raises:
            UserError: the file exists, or its suffix is of no format that can be written.
            FileError: it cannot be written.
        """
        field = self._written(self.scene, path, force, names)
        self._record("save", session_log.save_fields, path, self._history.present)
        return field

    @staticmethod
    def _written(scene: Scene, path: str | Path, force: bool, names: bool) -> Path | None:
        """Write a scene to a file, with its language field if it has one and `names`; the path of that, or None."""
        from ...gaussians import files
        from ...gaussians.language.field import saving

        if names:
            return saving.save(scene, path, force=force)
        files.save(scene, path, force=force)
        return None

    def close(self) -> None:
        """Close the log; closing twice is harmless."""
        if self._log is not None:
            self._log.close()

    # -- private ----------------------------------------------------------------------------------------------------

    def _record(self, kind: str, fields: Callable[P, dict[str, Any]], *args: P.args, **kwargs: P.kwargs) -> None:
        """Write a record into the log, if there is one; `fields` is called only then."""
        if self._log is not None:
            self._log.append(kind, fields(*args, **kwargs))

    def _take_over(self, earlier: Beginning) -> None:
        """Take over the notes, the last instruction and the selection of the session that this one continues."""
        self.log_notes = earlier.notes
        if not earlier.context:
            return
        self._history.amend(replace(self._history.present, context=earlier.context))
        if earlier.groups and self.scene.language is not None:
            found = self._context(None).resolve(self.scene, Query(groups=earlier.groups[:256]))
            if len(found) == earlier.gaussians:
                self._history.amend(replace(self._history.present, last=found))

    def _carry_out(
        self, plan: EditPlan, seconds: dict[str, float], *, dry_run: bool, start: State | None = None
    ) -> tuple[Result, State]:
        self.question = None
        if not plan.ops:
            raise refusal(plan)
        if has_queries(plan):
            with timed(seconds, "embed"):
                self.embed("edit")
        self._fills = self._dialled.fills(plan, self.scene, self._infill)
        before = start or self._history.present
        if before.last is None and (only := only_thing(self.scene)) is not None:  # "twice as big" can mean nothing else
            before = replace(before, last=self._context(None).resolve(self.scene, Query(groups=(only.id,))))
        with timed(seconds, "edit"):
            try:
                state, receipts = run_plan(plan, before, self._context, dry_run=dry_run, judge=self._judge())
            except PlanFailed as failure:
                self.question = failure.question
                return self._carry_out(self._settled(failure), seconds, dry_run=dry_run, start=start)
        result = Result(
            plan.instruction, plan, receipts, before.scene, state.scene, self.viewer, state.last, seconds, dry_run,
            self._moment(),
        )  # fmt: skip
        return result, state

    def _settled(self, failure: PlanFailed) -> EditPlan:
        """The failed plan with what a vision model points at in place of the query that failed, or with that query
        confirmed, if the session accepts what is not confirmed.

        Raises:
            ScenewrightError: the error of the plan, if neither settles it.
        """
        from .answering import offer
        from .clarify import asked_about, plan_with_answer, plan_with_query

        question = failure.question
        if question is None:
            raise failure.error from failure.__cause__
        seen, told = None, ""
        if self._vision and needs_sight(question.selection):
            seen, told = self._by_sight(question.selection)
        if seen is None and question.selection.verdict == "unconfirmed" and self.accept_unconfirmed:
            return plan_with_answer(question, "yes", self._planner.noun_phrase)
        if seen is None:
            error = failure.error
            if question.selection.verdict == "absent":
                error = offer(self, question, error) or error
            elif about := asked_about(question):
                error = with_message(error, f"{error}; this asks for {about}")
            raise (with_message(error, f"{error}; {told}") if told else error) from failure.__cause__
        plan = plan_with_query(question, seen)
        return plan.model_copy(update={"reason": "; ".join(filter(None, [plan.reason, told]))[:2000]})

    def _by_sight(self, selection: Selection) -> tuple[Query | None, str]:
        """The query for what a vision model points at, None if at nothing, and a sentence about it. The scene's field
        keeps the name, and the state the phrase, so that the model is asked once until an edit changes the scene."""
        phrase, known = selection.query.describe(), self._history.present.pointed
        if phrase in known:
            return known[phrase], "as pointed out before"
        seen = point_out(self.scene, selection, self.viewer, self._vision)
        if seen.query is not None:
            pointed = {**known, phrase: seen.query}
            self._history.amend(replace(self._history.present, scene=seen.scene, pointed=pointed))
        return seen.query, seen.told
