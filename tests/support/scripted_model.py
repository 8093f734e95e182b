"""A scripted language model that returns given answers and records the conversations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from scenewright.planners.model.backend import Answer, Message, OnText
from scenewright.planners.plan import Usage

Turn = str | Answer | Exception
Script = Callable[[Sequence[Message]], Turn]


class ScriptedModel:
    """A `ModelBackend` with scripted answers.

    Args:
        script: answers in order, the last one repeated; or functions from a conversation to an answer. An exception is
            raised instead of answering.
        name, sees, window: see `ModelBackend`.

    Attributes:
        asked: all conversations so far.
    """

    def __init__(
        self, *script: Turn | Script, name: str = "scripted", sees: bool = False, window: int = 32_768
    ) -> None:
        assert script, "a scripted model needs at least one answer"
        self.name, self.sees, self.window = name, sees, window
        self.asked: list[tuple[Message, ...]] = []
        self._script = script

    def answer(
        self, messages: Sequence[Message], schema: dict[str, Any], *, seconds: float, on_text: OnText | None = None
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
        if on_text is not None:
            for start in range(0, min(len(turn), 4096), 64):
                on_text(turn[start : start + 64])
        read = sum(len(m.text.split()) for m in messages)
        usage = Usage(model=self.name, requests=1, input_tokens=read, output_tokens=len(turn.split()))
        return Answer(turn, usage)
