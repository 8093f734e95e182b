"""Completion of a chat line: commands after a slash, else the operations and the things in the scene.

Knows prompt_toolkit. Refuses to know sessions: it is given words.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from prompt_toolkit.completion import CompleteEvent, Completer, Completion, PathCompleter
from prompt_toolkit.document import Document


class ChatCompleter(Completer):
    """Completes the word before the cursor.

    Args:
        commands: names that begin a line, with their slash.
        words: asked at each key for what else can be said; phrases of several words are completed as one.
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
        """Words and phrases that continue the longest tail of the line that begins one of them."""
        words = tuple(self._words())
        starts = [0, *(i + 1 for i, c in enumerate(text) if c == " ")]
        for start in starts:
            tail = text[start:].lower()
            found = [w for w in words if tail and w.lower().startswith(tail)]
            if found:
                yield from (Completion(w, -len(tail)) for w in found)
                return
