"""Reads the lines of a chat from a terminal with history and completion, or from a pipe.

prompt_toolkit is imported only for an interactive terminal.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from prompt_toolkit import PromptSession
    from prompt_toolkit.input import Input
    from prompt_toolkit.output import Output

PROMPT = "› "


class InputLines:
    """The lines of the input in order; the iteration ends with the input.

    Args:
        commands: names that begin a line, for completion.
        words: gives the other completions; called at each key.
        plain: read without prompt and completion even from a terminal, as the answers are for a program.
        input, output: prompt_toolkit's, for tests; by default the process's terminal, or its pipe.
    """

    def __init__(
        self,
        commands: tuple[str, ...],
        words: Callable[[], Iterable[str]],
        plain: bool = False,
        input: Input | None = None,
        output: Output | None = None,
    ) -> None:
        self._commands, self._words = commands, words
        self._plain, self._input, self._output = plain, input, output

    @property
    def interactive(self) -> bool:
        """Whether a person types the lines and sees the answers."""
        return not self._plain and (self._input is not None or (sys.stdin.isatty() and sys.stdout.isatty()))

    def __iter__(self) -> Iterator[str]:
        """Ctrl-C drops the line that is being typed; Ctrl-D ends the input."""
        if not self.interactive:
            for line in sys.stdin:
                yield line.rstrip("\n")
            return
        prompt = self._prompt()
        while True:
            try:
                yield prompt.prompt(PROMPT)
            except KeyboardInterrupt:
                continue
            except EOFError:
                return

    def ask(self, question: str) -> str | None:
        """One more line from a person, after a question; None if the input has ended. It is kept in no history."""
        from prompt_toolkit import PromptSession

        prompt: PromptSession[str] = PromptSession(input=self._input, output=self._output)
        try:
            return prompt.prompt(question).strip()
        except (EOFError, KeyboardInterrupt):
            return None

    def _prompt(self) -> PromptSession[str]:
        from prompt_toolkit import PromptSession
        from prompt_toolkit.auto_suggest import AutoSuggestFromHistory
        from prompt_toolkit.history import FileHistory, History, InMemoryHistory

        from .completion import ChatCompleter

        history: History = InMemoryHistory()
        if self._input is None and (file := history_file()) is not None:
            history = FileHistory(str(file))
        return PromptSession(
            history=history,
            auto_suggest=AutoSuggestFromHistory(),
            completer=ChatCompleter(self._commands, self._words),
            complete_while_typing=False,
            input=self._input,
            output=self._output,
        )


def history_file() -> Path | None:
    """The file that keeps typed lines between chats; None if its folder cannot be made or written."""
    root = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state") / "scenewright"
    try:
        root.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    return root / "chat_history" if os.access(root, os.W_OK) else None
