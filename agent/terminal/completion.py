"""Completion of a chat line: commands after a slash, file paths after /save, else given words and phrases."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from prompt_toolkit.completion import CompleteEvent, Completer, Completion, PathCompleter
from prompt_toolkit.document import Document


class ChatCompleter(Completer):
    """Completes the word before the cursor.

    Args:
        commands: names that begin a line, with their slash.
        words: gives the other completions; called at each key. A phrase of several words is completed as a whole.
    """

    def __init__(self, commands: tuple[str, ...], words: Callable[[], Iterable[str]]) -> None:
        self._commands = commands
        self._words = words
        self._paths = PathCompleter(expanduser=True)

    def get_completions(self, document: Document, complete_event: CompleteEvent) -> Iterable[Completion]:
        text = document.text_before_cursor
        if text.startswith("/") and " " not in text:
            yield from (Completion(c, -len(text)) for c in self._commands if c.startswith(text))
        elif text.startswith("/save "):
            rest = text.removeprefix("/save ").lstrip()
            yield from self._paths.get_completions(Document(rest), complete_event)
        else:
            yield from self._phrases(text)

    def _phrases(self, text: str) -> Iterable[Completion]:
        """Words and phrases that begin with the longest possible end of the line."""
        words = tuple(self._words())
        starts = [0, *(i + 1 for i, c in enumerate(text) if c == " ")]
        for start in starts:
            tail = text[start:].lower()
            found = [w for w in words if tail and w.lower().startswith(tail)]
            if found:
                yield from (Completion(w, -len(tail)) for w in found)
                return
