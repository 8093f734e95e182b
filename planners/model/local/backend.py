"""A local language or vision-language model of transformers with constrained decoding: `transformers:FOLDER`.

Decoding is greedy and deterministic. Tokens that the schema forces are appended without sampling, and the KV cache of
the prefix shared with the last prompt (mostly instructions and examples) is reused. It is reused in whole chunks, so
that it went through the same arithmetic and the answer does not depend on earlier prompts.
"""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from inspect import signature
from typing import Any

from ...plan import Usage
from ..backend import Answer, Message, OnText, UnreachableError
from . import checkpoint, sight
from .constrained import Constrained, Vocabulary
from .conversation import prompt_tokens
from .sight import Prompt

_CHUNK = 256  # prompt tokens per forward pass; the time limit is checked in between
_MIN_ANSWER = 64  # minimum tokens for an answer; a prompt that leaves fewer is an error
_MAX_ANSWER = 2048  # maximum tokens of an answer; typical plans of 64 operations take about 1900
# Exceptions that a third-party model may raise; out of memory in torch is a RuntimeError.
_FAILURES = (MemoryError, RuntimeError, ValueError, TypeError, IndexError, KeyError, AttributeError)


def load(path: str, window: int | None = None) -> LocalModel:
    """Load the model in a folder, or by its name on the hub (see `checkpoint.read`).

    Args:
        window: tokens of prompt and answer together, if fewer than the model has.

    Raises:
        BackendError: the model cannot be loaded; the message says why and what to do.
    """
    model = LocalModel(checkpoint.read(path), f"transformers:{path}")
    model.window = min(model.window, window or model.window)
    return model


class LocalModel:
    """A causal or image-text-to-text model; see `ModelBackend`. Not for several threads at once.

    Args:
        parts: the model, its tokenizer, and its processor if it reads pictures.
        name: name in receipts.
        max_tokens: maximum tokens of an answer; longer ones are closed early.
        temperature: 0 takes the most probable token; above 0 tokens are sampled, deterministically by `seed`.
        seed: seed of the sampling.

    Raises:
        BackendError: the tokenizer cannot be constrained.
    """

    def __init__(
        self,
        parts: checkpoint.Checkpoint,
        name: str,
        *,
        max_tokens: int = _MAX_ANSWER,
        temperature: float = 0.0,
        seed: int = 0,
    ) -> None:
        self.name, self.window = name, parts.window
        self.max_tokens, self.temperature, self.seed = max_tokens, temperature, seed
        self._model, self._tokenizer, self._processor = parts.model, parts.tokenizer, parts.processor
        self._vocabulary = Vocabulary(_serialized(parts.tokenizer), parts.rows, _end_tokens(parts))
        # Logits of the last token only; those of a whole prompt would need more memory than the model.
        last_alone = "logits_to_keep" in signature(parts.model.forward).parameters
        self._options = {"use_cache": True, **({"logits_to_keep": 1} if last_alone else {})}
        self._read: list[int] = []  # tokens in the KV cache
        self._seen = False  # whether the cache holds pictures
        # Qwen's models keep the positions after the last pictures, and would apply them to a prompt without any.
        self._offsets = [module for module in parts.model.modules() if hasattr(module, "rope_deltas")]
        self._cache: Any = None

    @property
    def sees(self) -> bool:
        """Whether it reads pictures."""
        return self._processor is not None

    def answer(
        self, messages: Sequence[Message], schema: dict[str, Any], *, seconds: float, on_text: OnText | None = None
    ) -> Answer:
        """See `ModelBackend.answer`. The text is always valid by the schema. If time or tokens run out, it is completed
        without the model, and `end` is "closed".

        Raises:
            UnreachableError: the prompt does not fit the model's window, the schema cannot be followed, no token was
                generated in time, the memory did not suffice, or pictures are shown to a model that reads none.
            UserError: a picture cannot be read.
        """
        started = time.perf_counter()
        try:
            prompt = self._prompt(messages)
        except _FAILURES as error:
            raise self._failed(error) from error
        size = len(prompt.tokens)
        room = min(self.max_tokens, self.window - size)
        if room < min(_MIN_ANSWER, self.max_tokens):
            fewer = "show fewer pictures" if prompt.tensors else "a scene with fewer objects"
            raise UnreachableError(
                f"the prompt has {size} tokens and the window of {self.name} is {self.window}; "
                f"use a model with a longer window, or {fewer}"
            )
        text = Constrained(self._vocabulary, schema)
        try:
            taken = self._write(prompt, text, room, started + seconds, on_text or (lambda piece: None))
        except _FAILURES as error:
            raise self._failed(error) from error
        spent = round(time.perf_counter() - started, 3)
        usage = Usage(model=self.name[:200], requests=1, input_tokens=size, output_tokens=taken, seconds=spent)
        return Answer(text.text, usage, "done" if taken == len(text.tokens) else "closed")

    def _prompt(self, messages: Sequence[Message]) -> Prompt:
        if self._processor is not None:
            return sight.prompt(self._processor, messages, self._model)
        if any(message.pictures for message in messages):
            raise UnreachableError(f"{self.name} reads no pictures; use a model that does (LLaVA and the like)")
        return Prompt(prompt_tokens(self._tokenizer, messages))

    def _write(self, prompt: Prompt, text: Constrained, room: int, until: float, on_text: OnText) -> int:
        """Generate the whole answer; return the number of its tokens before it was closed without the model."""
        import torch

        draw = torch.Generator().manual_seed(self.seed)
        fresh = text.take_forced()
        scores = self._scores(prompt, fresh, until)
        told = ""
        while not text.done and len(text.tokens) < room and time.perf_counter() < until:
            fresh = text.take(self._choice(scores, text, draw))
            on_text(text.text.removeprefix(told))
            told = text.text
            if not text.done and len(text.tokens) < room:
                scores = self._forward(fresh)
        if not told and not text.done and time.perf_counter() >= until:
            raise UnreachableError(self._too_slow(len(prompt.tokens)))
        taken = len(text.tokens)
        if not text.done:
            text.close()
            on_text(text.text.removeprefix(told))
        return taken

    def _scores(self, given: Prompt, forced: list[int], until: float) -> Any:
        """Logits `[V]` of the token after the prompt and the tokens that the schema forces first."""
        prompt, scores = given.tokens, None
        for module in self._offsets:
            module.rope_deltas = None
        if given.tensors:  # pictures are read with the whole prompt at once, and never from the cache
            self._cache, self._read = None, []
            scores = self._forward(prompt, **given.tensors)
        else:
            self._reuse_cache([] if self._seen else prompt)
        self._seen = bool(given.tensors)
        while len(self._read) < len(prompt):
            if time.perf_counter() > until:
                raise UnreachableError(self._too_slow(len(prompt)))
            scores = self._forward(prompt[len(self._read) : len(self._read) + _CHUNK])
        return self._forward(forced) if forced else scores

    def _reuse_cache(self, prompt: list[int]) -> None:
        """Crop the cache to the whole chunks that it shares with the prompt, without the last token of the prompt."""
        shared = 0
        for mine, read in zip(prompt[:-1], self._read, strict=False):
            if mine != read:
                break
            shared += 1
        shared -= shared % _CHUNK
        if shared and getattr(self._cache, "is_croppable", False):
            self._cache.crop(shared - len(self._read))
            del self._read[shared:]
        else:
            self._cache, self._read = None, []

    def _forward(self, tokens: list[int], **pictured: Any) -> Any:
        """Run the model on tokens, and on the tensors of pictures among them; return logits `[V]` of the next one."""
        import torch

        cache, self._cache = self._cache, None  # dropped if the forward pass fails
        with torch.inference_mode():
            ids = torch.tensor([tokens], device=self._model.device)
            said = self._model(input_ids=ids, past_key_values=cache, **pictured, **self._options)
        self._cache = said.past_key_values
        self._read += tokens
        return said.logits[0, -1].float().cpu()

    def _choice(self, scores: Any, text: Constrained, draw: Any) -> int:
        """Choose the next token among those that the schema allows."""
        import torch

        allowed = torch.from_numpy(text.allowed())[: len(scores)]
        held = scores[: len(allowed)].masked_fill(~allowed, -torch.inf)
        if self.temperature <= 0:
            return int(held.argmax())
        return int(torch.multinomial(torch.softmax(held / self.temperature, dim=0), 1, generator=draw))

    def _too_slow(self, tokens: int) -> str:
        return (
            f"{self.name} only read its prompt of {tokens} tokens in the time it had; allow more seconds, or use a "
            "smaller model"
        )

    def _failed(self, error: Exception) -> UnreachableError:
        """The error for the user, for an exception of the running model."""
        told = str(error)
        if isinstance(error, MemoryError) or "out of memory" in told.lower() or "allocate" in told:
            advice = "use a smaller model, or a scene with fewer objects"
            return UnreachableError(f"{self.name} ran out of memory; {advice}")
        return UnreachableError(f"{self.name} failed: {told.splitlines()[0] if told else type(error).__name__}")


def _serialized(tokenizer: Any) -> str:
    """The tokenizer as JSON, without truncation and padding."""
    return json.dumps(json.loads(tokenizer.backend_tokenizer.to_str()) | {"truncation": None, "padding": None})


def _end_tokens(parts: checkpoint.Checkpoint) -> list[int]:
    """Ids of the tokens that end an answer; llguidance requires one even where the schema determines the end."""
    told = getattr(parts.model.generation_config, "eos_token_id", None)
    told = parts.tokenizer.eos_token_id if told is None else told
    ids = told if isinstance(told, list) else [told]
    return [i for i in ids if isinstance(i, int)] or [parts.rows - 1]
