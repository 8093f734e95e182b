"""The chat: passes each line to the session or to a slash command, and shows the result.

A line is a command (`slash_commands.py`), or what `session/dialogue.py` makes of it. Lines come from `input_lines.py`.
"""

from __future__ import annotations

import shlex
import shutil
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from ...gaussians.errors import InstructionError, ScenewrightError
from ..session.dialogue import Dialogue
from ..session.history import looks_alike
from . import slash_commands
from .halfblocks import depth_of, draw
from .input_lines import InputLines
from .tables import coloured, table

if TYPE_CHECKING:
    from prompt_toolkit.input import Input
    from prompt_toolkit.output import Output

    from ...gaussians.language.query.selection import Selection
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
        dialogue: what typed lines mean to the session.
        ended: whether the user ended the chat.
    """

    elsewhere: ClassVar[Mapping[str, str]] = {}

    def __init__(
        self, session: Session, terminal: Terminal, input: Input | None = None, output: Output | None = None
    ) -> None:
        self.session = session
        self.terminal = terminal
        self.dialogue = Dialogue(session)
        self.ended = False
        self._kept = session.scene
        self._lines = InputLines(COMMANDS, self._words, terminal.as_json, input, output)

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
        return not looks_alike(self.session.scene.cloud, self._kept.cloud)

    def save(self, name: str, force: bool) -> str:
        """Write the scene to a file; returns what is told of it."""
        field = self.session.save(name, force=force)
        self._kept = self.session.scene
        return f"wrote {name}" if field is None else f"wrote {name}, and the names of its things to {field.name}"

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
        self.dialogue.begin()
        try:
            with self.terminal.interruptible():
                slash_commands.run_command(self, line) if line.startswith("/") else self._typed(line)
        except KeyboardInterrupt:
            self.tell("cancelled; nothing was changed", {"verdict": "cancelled"})
        except ScenewrightError as error:
            if self.terminal.debug and not isinstance(error, InstructionError):
                raise
            self._refuse(error)
        except Exception as error:  # after a bug of ours the user must still be able to save
            if self.terminal.debug:
                raise
            reason = f"internal error ({type(error).__name__}: {error}); the scene is as it was. Please report it"
            self.tell(reason, {"verdict": "internal", "reason": reason}, "red")

    def _typed(self, text: str) -> None:
        """Do what a line says that is no command, and show what it led to."""
        said = self.dialogue.say(text)
        if said.result is not None:
            self.show_result(said.result)
            return
        self.tell(said.text, said.data, "default" if said.sure else "yellow")
        if said.camera is not None and self._lines.interactive:
            self.show_picture()

    def show_result(self, result: Result) -> None:
        """Print the result and, on an interactive terminal, a picture."""
        said = self.dialogue.edited(result)
        self.tell(said.text, said.data, "green")
        if self._lines.interactive:
            self.show_picture()

    def _refuse(self, error: ScenewrightError) -> None:
        """Print why a line was refused; where it asks whether something is meant, also a picture of that."""
        refused, question = self.dialogue.refused(error), self.session.question
        self.tell("\n".join(refused.lines), refused.data, "yellow" if isinstance(error, InstructionError) else "red")
        doubted = question.selection if isinstance(error, InstructionError) and question is not None else None
        if doubted is not None and doubted.verdict == "unconfirmed" and self._lines.interactive:
            self.show_picture(doubted)

    def file(self, name: str) -> Path:
        """The file that a command names."""
        return Path(name)

    def end(self) -> None:
        """End the chat after this line."""
        self.ended = True

    # -- output -----------------------------------------------------------------------------------------------------

    def tell(self, text: str, data: dict[str, Any], style: str = "default") -> None:
        """Print an answer, its first line in the colour `style`."""
        self.terminal.result(coloured(text, style, self.terminal.out), data)

    def note(self, text: str) -> None:
        """Print a remark."""
        self.terminal.say(f"note: {text}")

    def table(self, columns: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
        """Rows under the names of their columns, as text."""
        return table(columns, rows)

    def show_picture(self, doubted: Selection | None = None) -> None:
        """Print the current view, at most 100 columns by 40 rows and no larger than the terminal.

        Args:
            doubted: what is asked about: it is lit and the rest dimmed, from where it is seen if the view does not
                show it.
        """
        from ...gaussians.motion.at import at
        from ...gaussians.render import render
        from ...gaussians.viewpoints.coverage import fit_camera
        from ..pictures.scene_pictures import camera_showing, spotlight

        columns, rows, width, height = picture_size()
        if doubted is None:
            camera = fit_camera(self.session.viewer, width, height)
            image = render(at(self.session.scene, self.session.time).cloud, camera).to_uint8()
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


def picture_size() -> tuple[int, int, int, int]:
    """Columns and rows of a picture of the scene, and its width and height in pixels before it is drawn."""
    columns, rows = _extent()
    return columns, rows, 4 * columns, 4 * round(columns * 2 / 3)


def _extent() -> tuple[int, int]:
    """Columns and rows of a picture: at most 100 by 40, and no larger than the terminal."""
    size = shutil.get_terminal_size((80, 24))
    return min(size.columns, 100), max(min(size.lines - 4, 40), 8)
