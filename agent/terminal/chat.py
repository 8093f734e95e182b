"""The chat: passes each line to the session or to a slash command, and shows the result.

A line is a command (`slash_commands.py`), an answer to an open question, a question about the scene, or an
instruction. Lines come from `input_lines.py`.
"""

from __future__ import annotations

import shlex
import shutil
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from ...gaussians.errors import AbsentError, InstructionError, ScenewrightError, UserError
from ..pictures.named_cameras import view_text
from ..session import portions
from ..session.answers import chosen_numbers, keeps_and_more, rejects, says_enough
from ..session.camera_moves import Looked, look
from ..session.camera_words import read_moves
from ..session.clarify import is_further
from ..session.plan_report import candidate_json, planner_json, refusal_json, usage_lines
from ..session.planner_client import is_dismissal, undo_or_redo
from ..session.refusal import verdict_of
from . import slash_commands
from .halfblocks import depth_of, draw
from .input_lines import InputLines
from .tables import coloured

if TYPE_CHECKING:
    from prompt_toolkit.input import Input
    from prompt_toolkit.output import Output

    from ...gaussians.camera import Camera
    from ...gaussians.language.query.selection import Selection
    from ...planners.plan import EditPlan
    from ..pictures.scene_pictures import Picture
    from ..session.result import Result
    from ..session.session import Session
    from .output import Terminal

COMMANDS = tuple(slash_commands.SLASH_COMMANDS)
END_COMMANDS = ("/quit", "/exit", "quit", "exit")  # with and without the slash


class Chat:
    """One chat on a session.

    Args:
        session: the session to edit.
        terminal: where answers are printed.
        input, output: prompt_toolkit's, for tests; by default the process's terminal, or its pipe.

    Attributes:
        planned: the last plan that was carried out.
        home: the first view, whose left and right "from the left" means; None until the camera is moved.
        ended: whether the user ended the chat.
    """

    def __init__(
        self, session: Session, terminal: Terminal, input: Input | None = None, output: Output | None = None
    ) -> None:
        self.session = session
        self.terminal = terminal
        self.planned: EditPlan | None = None
        self.home: Camera | None = None
        self.ended = False
        self._kept = session.scene
        self._looked: Looked | None = None  # the last move of the camera
        self._looking = False  # whether nothing was edited since
        self._lines = InputLines(COMMANDS, self._words, terminal.as_json, input, output)
        self._previous_plan: EditPlan | None = None

    # -- the loop ---------------------------------------------------------------------------------------------------

    def run(self) -> None:
        """Read lines until one of `END_COMMANDS` or the end of input. Ctrl-C ends the instruction, not the chat."""
        if self._lines.interactive:
            self._greet()
        for line in self._lines:
            if line.strip().lower() in END_COMMANDS:
                break
            if line.strip():
                self.say(line.strip())
            if self.ended:
                break
        while self.unsaved and not self._leave():
            pass

    @property
    def unsaved(self) -> bool:
        """Whether the scene looks other than when it was saved last; undoing all edits makes it as it was."""
        now, kept = self.session.scene.cloud, self._kept.cloud
        return any(
            column is not before
            for (name, column), (_, before) in zip(now.columns(), kept.columns(), strict=True)
            if name not in ("group", "ids")
        )

    def kept(self) -> None:
        """Note that the present scene was saved."""
        self._kept = self.session.scene

    def _leave(self) -> bool:
        """Whether the chat may end although the scene is not saved. A person is asked for a file; a pipe is told."""
        self.terminal.say("the edited scene was not saved")
        if not self._lines.interactive:
            return True
        answer = self._lines.ask("save it as (a file, or 'no'): ")
        if answer is None or answer.lower() in ("no", "n", "nein", "discard", "quit", "/quit", "exit", "/exit"):
            return True
        if answer:
            self.say(answer if answer.startswith("/save ") else f"/save {shlex.quote(answer)}")
        return False

    def say(self, line: str) -> None:
        """Handle one line: a command, an answer, a question or an instruction. Errors become one sentence."""
        self._previous_plan = self.session.planned
        try:
            with self.terminal.interruptible():
                slash_commands.run_command(self, line) if line.startswith("/") else self._instruction(line)
        except KeyboardInterrupt:
            self.tell("cancelled; nothing was changed", {"verdict": "cancelled"})
        except InstructionError as error:
            self._ask_back(error)
        except ScenewrightError as error:
            if self.terminal.debug:
                raise
            text = "\n".join([str(error), *usage_lines(self._new_plan)])
            data = {"verdict": verdict_of(error), "reason": str(error), **refusal_json(error, self._new_plan)}
            self.tell(text, data, "red")
        except Exception as error:  # after a bug of ours the user must still be able to save
            if self.terminal.debug:
                raise
            reason = f"internal error ({type(error).__name__}: {error}); the scene is as it was. Please report it"
            self.tell(reason, {"verdict": "internal", "reason": reason}, "red")

    def _instruction(self, text: str) -> None:
        if self._look(text):
            return
        if self._waits_for(text):
            if is_dismissal(text):
                if rejects(text) and (others := self.session.offer_others()) is not None:
                    raise others
                self.session.question = None
                self.tell("nothing was changed", {"verdict": "cancelled"})
                return
            try:
                result = self.session.answer(text)
            except UserError:
                if self.session.is_question(text):
                    self._question(text)  # the open question stays open
                    return
                plan = self.session.plan(text)
                if not plan.ops:
                    raise  # neither an answer nor an instruction: the question stays open
                result = self.session.apply(plan, planned_in=plan.seconds)  # closes the question
        elif undo_or_redo(text) is None and self.session.is_question(text):
            self._question(text)
            return
        else:
            result = self.session.do(text)
        self.show_result(result)

    def _look(self, text: str) -> bool:
        """Move the camera, if that is what the text asks for; False if it does not.

        "closer" alone goes on with an edit of the instruction before, unless the camera was moved since.
        """
        moves = read_moves(text)
        if moves is None or self._names_a_camera():
            return False
        bare = all(move.bare for move in moves)
        if bare and (self.session.question is not None or (not self._looking and self.session.continues(text))):
            return False
        self.home = self.home or self.session.viewer
        looked = look(self.session, moves, self.home, self._looked)
        self.session.viewer, self._looked, self._looking = looked.camera, looked, True
        data = {"verdict": "ok", "view": view_text(looked.camera), "notes": list(looked.notes)}
        self.tell("\n".join([looked.told, *(f"note: {note}" for note in looked.notes)]), data)
        if self._lines.interactive:
            self.show_picture()
        return True

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

    def _question(self, text: str) -> None:
        """Answer a question about the scene."""
        answer = self.session.ask(text)
        self.tell(answer.text, answer.to_json(), "default" if answer.answer is not None else "yellow")

    def show_result(self, result: Result) -> None:
        """Print the result and, on an interactive terminal, a picture."""
        self.planned, self._looking = result.plan or self.planned, False
        lines = list(result.sentences()) or [result.text]
        lines += usage_lines(result.plan)
        if sum(result.seconds.values()) > 0:
            lines.append(f"({sum(result.seconds.values()):.2f} s)")
        self.tell("\n".join(lines), result.to_json(), "green")
        if self._lines.interactive:
            self.show_picture()

    @property
    def _new_plan(self) -> EditPlan | None:
        """The plan that was made for the present line, even if it was refused; None if there is none."""
        return self.session.planned if self.session.planned is not self._previous_plan else None

    def _ask_back(self, error: InstructionError) -> None:
        question = self.session.question
        candidates = question.candidates if question else ()
        lines = [str(error)]
        offered = question is not None and question.offered
        if isinstance(error, AbsentError) and candidates and not offered:
            lines.append("The nearest things that are there:")
        where = [f", {c.seen_from(self.session.viewer)}" if offered else "" for c in candidates]
        lines += [f"  {i}. {c.describe()}{side}" for i, (c, side) in enumerate(zip(candidates, where, strict=True), 1)]
        verdict = question.selection.verdict if question is not None else ""
        if verdict == "ambiguous":
            lines.append("Which one? A number, several ('1 and 2'), 'all', or for example 'the left one'.")
        if verdict == "absent" and candidates:
            lines.append("A number chooses one of them; or say it in other words.")
        if verdict == "unconfirmed":
            lines.append("Is that meant? 'yes' or 'no'.")
        data = {
            "verdict": verdict_of(error),
            "reason": str(error),
            "candidates": [candidate_json(c) for c in candidates],
            **planner_json(question.plan if question else self._new_plan),
        }
        self.tell("\n".join([*lines, *usage_lines(self._new_plan)]), data, "yellow")
        if verdict == "unconfirmed" and self._lines.interactive and question is not None:
            self.show_picture(question.selection)

    # -- output -----------------------------------------------------------------------------------------------------

    def tell(self, text: str, data: dict[str, Any], style: str = "default") -> None:
        """Print an answer, its first line in the colour `style`."""
        self.terminal.result(coloured(text, style, self.terminal.out), data)

    def show_picture(self, doubted: Selection | None = None) -> None:
        """Print the current view, at most 100 columns by 40 rows and no larger than the terminal.

        Args:
            doubted: what is asked about: it is lit and the rest dimmed, from where it is seen if the view does not
                show it.
        """
        from ...gaussians.render import render
        from ...gaussians.viewpoints.coverage import fit_camera
        from ..pictures.scene_pictures import camera_showing, spotlight

        columns, rows = _extent()
        width, height = 4 * columns, 4 * round(columns * 2 / 3)
        if doubted is None:
            camera = fit_camera(self.session.viewer, width, height)
            image = render(self.session.scene.cloud, camera).to_uint8()
        else:
            camera = fit_camera(camera_showing(self.session.scene, doubted, self.session.viewer), width, height)
            image = spotlight(self.session.scene, camera, doubted)
        self.terminal.picture(draw(image, columns, rows, depth_of(self.terminal.out)))

    def show_image(self, image: Picture) -> None:
        """Print a picture, on an interactive terminal."""
        if self._lines.interactive:
            columns, rows = _extent()
            self.terminal.picture(draw(image, columns, rows, depth_of(self.terminal.out)))

    def _greet(self) -> None:
        path, count = self.session.scene.path, len(self.session.scene.cloud)
        self.terminal.say(
            f"{path.name if path else 'scene'}: {count:,} Gaussians. Say what to change, or ask; /help lists more."
        )
        self.show_picture()

    def _words(self) -> Iterable[str]:
        """Words for completion in an instruction: operations, and the labels of things in the scene."""
        from ...tools.registry import OPS

        language = self.session.scene.language
        labels = {g.label for g in language.groups if g.label and g.count} if language else set()
        return sorted({*OPS, *labels})


def _extent() -> tuple[int, int]:
    """Columns and rows of a picture: at most 100 by 40, and no larger than the terminal."""
    size = shutil.get_terminal_size((80, 24))
    return min(size.columns, 100), max(min(size.lines - 4, 40), 8)
