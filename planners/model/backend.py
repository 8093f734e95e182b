"""What a language model is to the planner: messages in, one JSON text out. Every model is behind this protocol.

Knows messages, answers and what can go wrong with them. Refuses to know prompts, plans and scenes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol

from ..plan import NoPlanError, Usage

Heard = Callable[[str], None]  # called with each piece of the answer as it arrives


@dataclass(frozen=True)
class Message:
    """One turn: who speaks, what, and at most one picture (PNG) shown with it."""

    role: Literal["system", "user", "assistant"]
    text: str
    picture: bytes | None = None


@dataclass(frozen=True)
class Answer:
    """What a model said.

    Attributes:
        text: its words, meant to be JSON of the schema; nothing is promised.
        usage: of this one request.
        end: "done"; "cut", it stopped at its longest answer; "closed", so too, and the back end completed the text by
            the schema without asking: valid, but not what was meant, so not to be carried out; "declined", it or its
            provider refused to answer, and `text` is what it said instead.
    """

    text: str
    usage: Usage
    end: Literal["done", "cut", "closed", "declined"] = "done"


class UnreachableError(NoPlanError):
    """The model gave no answer: server down, key missing or wrong, no such model, timeout, rate limit, nonsense on
    the wire. The message says which, what to do, and never holds a key. `usage` is what answers before it cost."""


class ModelBackend(Protocol):
    """A language model."""

    @property
    def name(self) -> str:
        """As the user named it, "openai:gpt-…", for receipts; never holds a key."""
        ...

    @property
    def sees(self) -> bool:
        """Whether pictures may be sent to it."""
        ...

    @property
    def window(self) -> int:
        """How many tokens prompt and answer may have together, as far as known."""
        ...

    def answer(
        self, messages: Sequence[Message], schema: dict[str, Any], *, seconds: float, heard: Heard | None = None
    ) -> Answer:
        """One answer to a conversation.

        Args:
            messages: a system message first, then user and assistant in turn, a user last.
            schema: JSON Schema that the answer is to follow; a back end enforces it as far as it can.
            seconds: the longest that may pass, own retries after rate limits included.
            heard: streamed to, where the back end can.

        Raises:
            UnreachableError: there was no answer in time.
        """
        ...
