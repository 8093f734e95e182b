"""The conversation: a line in, an edit and a picture out.

Knows what is an instruction, an answer or a command, how to ask back, and what to show. Refuses to know how an
instruction is carried out (the session does), what the commands do (`slashes.py`) and where lines come from
(`lines.py`).
"""

from __future__ import annotations

import shutil
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from ...gaussians.errors import AbsentError, InstructionError, ScenewrightError, UserError
from ..session.model_usage import asked
from ..session.planner_client import dismisses, step_meant
from ..session.refusal import verdict_of
from ..session.resolved_plan import candidate_json, planner_json, refusal_json
from . import slash_commands
from .halfblocks import depth_of, draw
from .input_lines import Lines
from .tables import coloured

if TYPE_CHECKING:
    from prompt_toolkit.input import Input
    from prompt_toolkit.output import Output

    from ...planners.plan import EditPlan
    from ..session.result import Result
    from ..session.session import Session
    from .output import Terminal

COMMANDS = tuple(slash_commands.SLASHES)
ENDS = ("/quit", "/exit", "quit", "exit")  # with and without the stroke: nothing else can be meant


class Chat:
    """One conversation.

    Args:
        session: what is talked about.
        terminal: where answers go.
        input, output: prompt_toolkit's, for tests; by default the process's terminal, or its pipe.

    Attributes:
        planned: the last plan that was carried out.
        saved: whether the scene is as it was written last.
        over: whether somebody ended it.
    """

    def __init__(
        self, session: Session, terminal: Terminal, input: Input | None = None, output: Output | None = None
    ) -> None:
        self.session = session
        self.terminal = terminal
        self.planned: EditPlan | None = None
        self.saved = True
        self.over = False
        self._lines = Lines(COMMANDS, self._words, terminal.as_json, input, output)
        self._before: EditPlan | None = None

    # -- the loop ---------------------------------------------------------------------------------------------------

    def run(self) -> None:
        """Read lines until one of `ENDS` or the end of input. Ctrl-C ends the instruction, not the conversation."""
        if self._lines.typed:
            self._greet()
        for line in self._lines:
            if line.strip().lower() in ENDS:
                break
            if line.strip():
                self.say(line.strip())
            if self.over:
                break
        if not self.saved:
            self.terminal.say("the edited scene was not saved")

    def say(self, line: str) -> None:
        """One line: a command, an answer to an open question, or an instruction. Errors become one sentence."""
        self._before = self.session.planned
        try:
            with self.terminal.interruptible():
                slash_commands.carry_out(self, line) if line.startswith("/") else self._instruction(line)
        except KeyboardInterrupt:
            self.tell("cancelled; nothing was changed", {"verdict": "cancelled"})
        except InstructionError as error:
            self._ask_back(error)
        except ScenewrightError as error:
            if self.terminal.debug:
                raise
            said = "\n".join([str(error), *asked(self._fresh)])
            data = {"verdict": verdict_of(error), "reason": str(error), **refusal_json(error, self._fresh)}
            self.tell(said, data, "red")
        except Exception as error:  # a mistake of ours must not cost the user what was not saved yet
            if self.terminal.debug:
                raise
            reason = f"internal error ({type(error).__name__}: {error}); the scene is as it was. Please report it"
            self.tell(reason, {"verdict": "internal", "reason": reason}, "red")

    def _instruction(self, text: str) -> None:
        question = self.session.question
        if question is not None and question.selection.verdict == "ambiguous" and step_meant(text) is None:
            if dismisses(text):
                self.session.question = None
                self.tell("nothing was changed", {"verdict": "cancelled"})
                return
            try:
                result = self.session.answer(text)
            except UserError:
                plan = self.session.plan(text)
                if not plan.ops:
                    raise  # neither an answer nor an instruction: the question stands
                result = self.session.apply(plan, planned_in=plan.seconds)  # which drops the question
        else:
            result = self.session.do(text)
        self.show_result(result)

    def show_result(self, result: Result) -> None:
        """What was done, in words and, for who sees it, as a picture."""
        self.planned, self.saved = result.plan or self.planned, False
        lines = list(result.sentences()) or [result.text]
        lines += asked(result.plan)
        if sum(result.seconds.values()) > 0:
            lines.append(f"({sum(result.seconds.values()):.2f} s)")
        self.tell("\n".join(lines), result.to_json(), "green")
        if self._lines.typed:
            self.show_picture()

    @property
    def _fresh(self) -> EditPlan | None:
        """The plan that was made of this line, though nothing may have come of it; None if none was."""
        return self.session.planned if self.session.planned is not self._before else None

    def _ask_back(self, error: InstructionError) -> None:
        question = self.session.question
        candidates = question.candidates if question else ()
        lines = [str(error)]
        if isinstance(error, AbsentError) and candidates:
            lines.append("The nearest things that are there:")
        lines += [f"  {i}. {c.describe()}" for i, c in enumerate(candidates, start=1)]
        if question is not None and question.selection.verdict == "ambiguous":
            lines.append("Which one? A number, 'all', or for example 'the left one'.")
        data = {
            "verdict": verdict_of(error),
            "reason": str(error),
            "candidates": [candidate_json(c) for c in candidates],
            **planner_json(question.plan if question else self._fresh),
        }
        self.tell("\n".join([*lines, *asked(self._fresh)]), data, "yellow")

    # -- what the user sees -----------------------------------------------------------------------------------------

    def tell(self, text: str, data: dict[str, Any], style: str = "default") -> None:
        """An answer, its first line in a colour that says how it went."""
        self.terminal.result(coloured(text, style, self.terminal.out), data)

    def show_picture(self) -> None:
        """The current view, as large as the terminal allows and the eye needs."""
        from ...gaussians.render import render
        from ...gaussians.viewpoints.coverage import fit_camera

        size = shutil.get_terminal_size((80, 24))
        columns, rows = min(size.columns, 100), min(size.lines - 4, 40)
        camera = fit_camera(self.session.viewer, 4 * columns, 4 * round(columns * 2 / 3))
        image = render(self.session.scene.cloud, camera).to_uint8()
        self.terminal.picture(draw(image, columns, max(rows, 8), depth_of(self.terminal.out)))

    def _greet(self) -> None:
        path, count = self.session.scene.path, len(self.session.scene.cloud)
        self.terminal.say(
            f"{path.name if path else 'scene'}: {count:,} Gaussians. Say what to change; /help lists more."
        )
        self.show_picture()

    def _words(self) -> Iterable[str]:
        """What may be completed in an instruction: operations, and the names of things in the scene."""
        from ...tools.registry import OPS

        language = self.session.scene.language
        labels = {g.label for g in language.groups if g.label and g.count} if language else set()
        return sorted({*OPS, *labels})
