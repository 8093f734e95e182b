"""The protocol of language models, `ModelBackend`: messages in, one JSON text out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol

from ..plan import NoPlanError, Usage

OnText = Callable[[str], None]  # called with each piece of the answer as it is streamed


@dataclass(frozen=True)
class Message:
    """One turn of a conversation.

    Attributes:
        role: who speaks.
        text: what is said.
        pictures: PNG, JPEG or WebP, of any size; a back end scales them down to what its model reads. Only users show
            pictures. In front of several, a back end writes "Picture 1:" and so on, so that the text can name them.
    """

    role: Literal["system", "user", "assistant"]
    text: str
    pictures: tuple[bytes, ...] = ()


@dataclass(frozen=True)
class Answer:
    """A model's response.

    Attributes:
        text: meant to be JSON of the schema, but not guaranteed to be.
        usage: of this one request.
        end: "done"; "cut": truncated at the token limit; "closed": truncated, and the back end completed the text to
            valid JSON without the model, so it must not be executed; "declined": the model or its provider refused to
            answer, and `text` is the refusal.
    """

    text: str
    usage: Usage
    end: Literal["done", "cut", "closed", "declined"] = "done"


class UnreachableError(NoPlanError):
    """The model gave no answer: server down, key missing or wrong, unknown model, timeout, rate limit, or a malformed
    response. The message says which and what to do, and never contains a key. `usage` is that of earlier answers."""


class ModelBackend(Protocol):
    """A language model."""

    @property
    def name(self) -> str:
        """The spec as the user gave it, "openai:gpt-…", for receipts; never contains a key."""
        ...

    @property
    def sees(self) -> bool:
        """Whether the model accepts images."""
        ...

    @property
    def window(self) -> int:
        """Context window: tokens of prompt and answer together, as far as known."""
        ...

    def answer(
        self, messages: Sequence[Message], schema: dict[str, Any], *, seconds: float, on_text: OnText | None = None
    ) -> Answer:
        """Answer a conversation.

        Args:
            messages: a system message, then alternately user and assistant, ending with a user message.
            schema: JSON Schema of the answer; a back end enforces it as far as it can.
            seconds: time limit, including retries after rate limits.
            on_text: receives the answer in pieces if the back end streams.

        Raises:
            UnreachableError: no answer in time.
        """
        ...
