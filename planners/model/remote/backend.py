"""Remote language models: OpenAI's wire format (Ollama, vLLM, llama.cpp too), Anthropic's and Google's.

A refused request is repeated with fewer parameters, a failed one after a pause, until the time limit.
"""

from __future__ import annotations

import asyncio
import os
import time
from collections.abc import Callable, Sequence
from typing import Any

from ....gaussians.errors import BackendError
from ...plan import Usage
from .. import pictures
from ..backend import Answer, Message, ModelBackend, OnText, UnreachableError
from . import context_window, errors, http, wire
from .address import Address, read
from .errors import Extras
from .wait import Emit, Failed, wait
from .wire import Reply

HOSTED_WINDOW = 128_000  # tokens; the minimum of the models that the three providers now offer
NEAR_WINDOW = 8_192  # of servers that do not tell; twice the smallest default, 4096, which is too few for any plan
_PICTURES = {"openai": pictures.OPENAI, "anthropic": pictures.ANTHROPIC, "google": pictures.GOOGLE}
# Prefixes of hosted models without image input; all others accept images.
_WITHOUT_IMAGES = ("gpt-3.5", "o1-mini", "o1-preview", "o3-mini", "claude-2", "claude-instant", "gemini-1.0", "text-")


def load(spec: str, window: int | None = None) -> ModelBackend:
    """The model that "openai:MODEL[@BASE_URL]", "anthropic:MODEL[@BASE_URL]" or "google:MODEL[@BASE_URL]" names.

    Keys come from OPENAI_API_KEY, ANTHROPIC_API_KEY, GOOGLE_API_KEY or GEMINI_API_KEY; SCENEWRIGHT_API_KEY comes first.
    A self-hosted server in OpenAI's format needs none. Nothing is imported and no request is sent yet.

    Args:
        window: tokens of prompt and answer together; None asks the server.

    Raises:
        UserError: the specification is malformed.
        BackendError: a key or a package is missing; the message says which, and how to get it.
    """
    return Remote(read(spec, os.environ), window)


class Remote:
    """A language model behind an address, a `ModelBackend`.

    It remembers the parameters that its server refused (a schema, a temperature), so that a refusal costs one request,
    and the form of answers that it keeps to.
    """

    def __init__(self, address: Address, window: int | None = None) -> None:
        self._address = address
        self._window = window
        self._extras = Extras()

    @property
    def name(self) -> str:
        """The spec as the user wrote it; contains no key."""
        return self._address.name

    @property
    def sees(self) -> bool:
        """Whether pictures may be sent: to hosted models with image input, and to any model of a self-hosted server."""
        model = self._address.model
        return self._address.own or not (model.startswith(_WITHOUT_IMAGES) or model == "gpt-4")

    @property
    def window(self) -> int:
        """Tokens for prompt and answer: as set, or as the server tells, which is asked until it does; else the minimum
        of hosted models, or the usual setting of local servers."""
        if self._window is None and self._address.own:
            self._window = context_window.told_by(self._address)
        return self._window or (NEAR_WINDOW if self._address.near else HOSTED_WINDOW)

    def answer(
        self, messages: Sequence[Message], schema: dict[str, Any], *, seconds: float, on_text: OnText | None = None
    ) -> Answer:
        """One answer, as `ModelBackend.answer`; may be called from a thread with or without an event loop.

        The server enforces the schema; if it refuses that, JSON mode, or nothing. The first import of the libraries is
        not counted in `seconds`.

        Raises:
            UnreachableError: there was no answer; the message says why and what to do, and contains no key.
            BackendError: the libraries are broken.
            UserError: a picture of a message cannot be read.
        """
        messages = pictures.fitted(messages, _PICTURES[self._address.kind])
        try:
            wire.import_libraries(self._address.kind)
        except ImportError as error:
            raise BackendError(f"pydantic-ai cannot be used ({error}): pip install -U 'scenewright[llm]'") from None
        begun = time.monotonic()
        refusals: list[Exception] = []

        async def work(emit: Emit) -> Reply:
            listener = emit if on_text is not None else None
            return await self._ask_with_retries(messages, schema, begun + seconds, listener, refusals)

        reply = wait(work, seconds, on_text)
        waited = time.monotonic() - begun
        if isinstance(reply, Failed):
            # The refusal that used up the time is more informative than the timeout.
            late = isinstance(reply.error, TimeoutError) and refusals
            raise UnreachableError(errors.describe(late[-1] if late else reply.error, self._address, seconds))
        usage = Usage(
            model=self.name,
            requests=1,
            input_tokens=reply.input_tokens,
            output_tokens=reply.output_tokens,
            dollars=reply.dollars,
            seconds=min(waited, 86_400.0),
        )
        return Answer(text=reply.text, usage=usage, end=reply.end)

    async def _ask_with_retries(
        self,
        messages: Sequence[Message],
        schema: dict[str, Any],
        deadline: float,
        emit: Callable[[str], None] | None,
        refusals: list[Exception],
    ) -> Reply:
        """Request an answer, with fewer parameters after a refusal, and with retries where they may help.

        Args:
            refusals: errors of a busy or failing server, after which the request is repeated, are appended here.
        """
        left = deadline - time.monotonic()
        extras, tries, spoken, kind = self._extras, 0, False, self._address.kind

        def pass_on(piece: str) -> None:
            nonlocal spoken
            spoken = True
            if emit is not None:
                emit(piece)

        async with http.open_client(self._address, left) as client:
            model = wire.build(self._address, client)
            while True:
                question = wire.Question(messages, schema, extras, left, pass_on if emit is not None else None)
                try:
                    reply = await wire.ask(model, self._address, question)
                except Exception as error:
                    less = None if spoken else errors.fewer_extras(extras, error, kind)
                    if less is None and emit is not None:
                        less = errors.without_stream(extras, error)
                    pause = 0.0 if less else None if spoken else errors.retry_delay(error, tries)
                    if pause is None or pause >= deadline - time.monotonic():
                        raise
                    if less is None:
                        refusals.append(error)
                        tries += 1
                    extras = less or extras
                    await asyncio.sleep(pause)
                else:
                    self._extras = errors.learned(extras, reply.text, kind) if reply.end == "done" else extras
                    return reply
