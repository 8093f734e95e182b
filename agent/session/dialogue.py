"""What a typed line means to a session: a move of the camera, an answer, a question about the scene, an instruction.

The chat on a terminal and the page in a browser share it; both show what `Dialogue` returns and raises.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ...gaussians.errors import AbsentError, InstructionError, ScenewrightError, UserError
from ..pictures.named_cameras import view_text
from . import portions
from .answers import chosen_numbers, keeps_and_more, rejects, says_enough
from .camera_moves import Looked, look
from .camera_words import read_moves
from .clarify import is_further
from .plan_report import candidate_json, planner_json, refusal_json, usage_lines
from .planner_client import is_dismissal, undo_or_redo
from .refusal import verdict_of

if TYPE_CHECKING:
    from ...gaussians.camera import Camera
    from ...planners.plan import EditPlan
    from ...planners.questions.answer import Answer
    from .result import Result
    from .session import Session


@dataclass(frozen=True)
class Said:
    """What a line led to, if it was not refused.

    Attributes:
        text: for a person; of an edit, `edit_lines` of its result.
        data: the same as plain data.
        sure: False for a question that nobody could answer.
        result: of an edit, undo or redo; None of anything else.
        camera: the viewer, if the line moved it.
        answer: to a question about the scene; None of anything else.
    """

    text: str
    data: dict[str, Any] = field(default_factory=dict)
    sure: bool = True
    result: Result | None = None
    camera: Camera | None = None
    answer: Answer | None = None


@dataclass(frozen=True)
class Refused:
    """Why a line was refused: lines for a person, the first a sentence, and plain data.

    Attributes:
        after: the lines that follow those of the candidates: how to answer, and what a model cost.
    """

    lines: tuple[str, ...]
    data: dict[str, Any]
    after: tuple[str, ...] = ()


class Dialogue:
    """The lines that are typed to one session.

    Attributes:
        home: the first view, whose left and right "from the left" means; None until the camera is moved.
        planned: the last plan that was carried out.
    """

    def __init__(self, session: Session) -> None:
        self.session = session
        self.home: Camera | None = None
        self.planned: EditPlan | None = None
        self._looked: Looked | None = None  # the last move of the camera
        self._looking = False  # whether nothing was edited since
        self._previous_plan: EditPlan | None = None

    def say(self, text: str) -> Said:
        """Do what a line says; raises as `Session.do`, `Session.answer` and `Session.ask`."""
        self.begin()
        if (looked := self._look(text)) is not None:
            return looked
        if self._waits_for(text):
            return self._answer(text)
        if undo_or_redo(text) is None and self.session.is_question(text):
            return self._question(text)
        return self.edited(self.session.do(text))

    def begin(self) -> None:
        """Begin a line: only plans that are made after it are its own."""
        self._previous_plan = self.session.planned

    def edited(self, result: Result) -> Said:
        """A result as what a line led to; words about the camera then no longer go on with its last move."""
        self._looking = False
        self.planned = result.plan or self.planned
        return Said("\n".join(edit_lines(result)), result.to_json(), result=result)

    def refused(self, error: ScenewrightError) -> Refused:
        """The lines and data of a refusal; of one that asks back, with the candidates and how to answer."""
        if not isinstance(error, InstructionError):
            data = {"verdict": verdict_of(error), "reason": str(error), **refusal_json(error, self._new_plan)}
            return Refused((str(error), *usage_lines(self._new_plan)), data)
        question = self.session.question
        candidates = question.candidates if question else ()
        lines = [str(error)]
        offered = question is not None and question.offered
        if isinstance(error, AbsentError) and candidates and not offered:
            lines.append("The nearest things that are there:")
        where = [f", {c.seen_from(self.session.viewer)}" if offered else "" for c in candidates]
        lines += [f"  {i}. {c.describe()}{side}" for i, (c, side) in enumerate(zip(candidates, where, strict=True), 1)]
        verdict = question.selection.verdict if question is not None else ""
        after: list[str] = []
        if verdict == "ambiguous":
            after.append("Which one? A number, several ('1 and 2'), 'all', or for example 'the left one'.")
        if verdict == "absent" and candidates:
            after.append("A number chooses one of them; or say it in other words.")
        if verdict == "unconfirmed":
            after.append("Is that meant? 'yes' or 'no'.")
        data = {
            "verdict": verdict_of(error),
            "reason": str(error),
            "candidates": [candidate_json(c) for c in candidates],
            **planner_json(question.plan if question else self._new_plan),
        }
        after += usage_lines(self._new_plan)
        return Refused((*lines, *after), data, tuple(after))

    # -- private ----------------------------------------------------------------------------------------------------

    @property
    def _new_plan(self) -> EditPlan | None:
        """The plan that was made for the present line, even if it was refused; None if there is none."""
        return self.session.planned if self.session.planned is not self._previous_plan else None

    def _answer(self, text: str) -> Said:
        """What a line leads to while a question is open."""
        if is_dismissal(text):
            if rejects(text) and (others := self.session.offer_others()) is not None:
                raise others
            self.session.question = None
            return Said("nothing was changed", {"verdict": "cancelled"})
        try:
            return self.edited(self.session.answer(text))
        except UserError:
            if self.session.is_question(text):
                return self._question(text)  # the open question stays open
            plan = self.session.plan(text)
            if not plan.ops:
                raise  # neither an answer nor an instruction: the question stays open
            return self.edited(self.session.apply(plan, planned_in=plan.seconds))  # closes the question

    def _question(self, text: str) -> Said:
        """The answer to a question about the scene."""
        answer = self.session.ask(text)
        return Said(answer.text, answer.to_json(), sure=answer.answer is not None, answer=answer)

    def _look(self, text: str) -> Said | None:
        """Move the camera, if that is what the text asks for; None if it does not.

        "closer" alone goes on with an edit of the instruction before, unless the camera was moved since.
        """
        moves = read_moves(text)
        if moves is None or self._names_a_camera():
            return None
        bare = all(move.bare for move in moves)
        if bare and (self.session.question is not None or (not self._looking and self.session.continues(text))):
            return None
        self.home = self.home or self.session.viewer
        looked = look(self.session, moves, self.home, self._looked)
        self.session.viewer, self._looked, self._looking = looked.camera, looked, True
        data = {"verdict": "ok", "view": view_text(looked.camera), "notes": list(looked.notes)}
        text = "\n".join([looked.told, *(f"note: {note}" for note in looked.notes)])
        return Said(text, data, camera=looked.camera)

    def _names_a_camera(self) -> bool:
        """Whether a camera is one of the things in the scene, so that words about it may be an edit."""
        language = self.session.scene.language
        return language is not None and any(g.label == "camera" for g in language.groups)

    def _waits_for(self, text: str) -> bool:
        """Whether a question is open that `text` may answer. Of the nearest things that were listed in place of one
        that is absent, only a number chooses."""
        question = self.session.question
        if question is None or undo_or_redo(text) is not None:
            return False
        if question.selection.verdict != "absent" or chosen_numbers(text, len(question.candidates)) is not None:
            return True
        count = len(question.candidates)
        if (is_further(question) and says_enough(text)) or keeps_and_more(text, count) is not None:
            return True
        return bool(question.candidates) and portions.read(text, count) is not None


def edit_lines(result: Result) -> list[str]:
    """A result for a person: a sentence for each operation, what a model cost, and the seconds."""
    lines = [*(result.sentences() or [result.text]), *usage_lines(result.plan)]
    if sum(result.seconds.values()) > 0:
        lines.append(f"({sum(result.seconds.values()):.2f} s)")
    return lines
