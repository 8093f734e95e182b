"""A stand-in for a language model: it gives the answers it was made with, and remembers what it was asked.

For tests and for charts that say so. Knows the protocol of models. Refuses to think.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ..plan import Usage
from .backend import Answer, Heard, Message

Turn = str | Answer | Exception
Script = Callable[[Sequence[Message]], Turn]


class ScriptedModel:
    """A model that answers by rote.

    Args:
        script: its answers in order, the last one again and again; or what makes one of a conversation. An exception
            is raised instead of answering.
        name, sees, window: as `ModelBackend` has them.

    Attributes:
        asked: every conversation so far.
    """

    def __init__(
        self, *script: Turn | Script, name: str = "scripted", sees: bool = False, window: int = 32_768
    ) -> None:
        assert script, "a scripted model needs something to say"
        self.name, self.sees, self.window = name, sees, window
        self.asked: list[tuple[Message, ...]] = []
        self._script = script

    def answer(
        self, messages: Sequence[Message], schema: dict[str, Any], *, seconds: float, heard: Heard | None = None
    ) -> Answer:
        """See `ModelBackend.answer`; tokens are counted as words."""
        self.asked.append(tuple(messages))
        turn = self._script[min(len(self.asked), len(self._script)) - 1]
        if callable(turn):
            turn = turn(messages)
        if isinstance(turn, Exception):
            raise turn
        if isinstance(turn, Answer):
            return turn
        if heard is not None:
            for start in range(0, min(len(turn), 4096), 64):
                heard(turn[start : start + 64])
        read = sum(len(m.text.split()) for m in messages)
        usage = Usage(model=self.name, requests=1, input_tokens=read, output_tokens=len(turn.split()))
        return Answer(turn, usage)
