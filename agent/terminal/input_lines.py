"""Where the lines of a conversation come from: a terminal with history and completion, or a pipe.

Knows prompt_toolkit, and imports it only for a person. Refuses to know what is said.
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


class Lines:
    """The lines that are said, in order; iterating ends with the input.

    Args:
        commands: names that begin a line, for completion.
        words: asked at each key for what else can be completed.
        bare: read line by line even from a terminal, as answers are for a program.
        input, output: prompt_toolkit's, for tests; by default the process's terminal, or its pipe.
    """

    def __init__(
        self,
        commands: tuple[str, ...],
        words: Callable[[], Iterable[str]],
        bare: bool = False,
        input: Input | None = None,
        output: Output | None = None,
    ) -> None:
        self._commands, self._words = commands, words
        self._bare, self._input, self._output = bare, input, output

    @property
    def typed(self) -> bool:
        """Whether a person types them, who also sees the answers."""
        return not self._bare and (self._input is not None or (sys.stdin.isatty() and sys.stdout.isatty()))

    def __iter__(self) -> Iterator[str]:
        """Ctrl-C drops the line that is being typed, Ctrl-D ends them."""
        if not self.typed:
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
    """Where typed lines are kept between conversations; None if that folder cannot be made."""
    root = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state") / "scenewright"
    try:
        root.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    return root / "chat_history" if os.access(root, os.W_OK) else None
