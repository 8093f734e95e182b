"""Constrain generated text to a JSON Schema, token by token, with llguidance, and close an unfinished text validly.

The caller chooses the tokens: it asks for the mask of allowed ones and reports its choice.
"""

from __future__ import annotations

import codecs
import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....gaussians.errors import BackendError
from ..backend import UnreachableError
from .tightening import tighten

_SCHEMAS = 4  # kept compiled
_LONGEST_CLOSING = 4096  # tokens; every step takes the shortest way, some tens are usual
# Characters tried in order to close a text: quotes inside strings; outside brackets, and null before nested values.
_INSIDE = '"' + "".join(chr(c) for c in range(32, 127) if chr(c) not in '"\\')
_OUTSIDE = '}]n123456789.0tf-"[{,:' + "abcdeghijklmopqrsuvwxyz"


class Vocabulary:
    """A tokenizer as llguidance reads it.

    Args:
        serialized: a fast tokenizer of the tokenizers library as JSON.
        size: of the vocabulary, at least the tokenizer's own.
        ends: ids of the tokens that end an answer.

    Raises:
        BackendError: llguidance is not installed, or cannot read the tokenizer.
    """

    def __init__(self, serialized: str, size: int, ends: list[int]) -> None:
        try:
            from llguidance import LLTokenizer
        except ImportError as error:
            raise BackendError("llguidance is not installed; run: pip install 'scenewright[models]'") from error
        try:
            self.reader: Any = LLTokenizer(serialized, n_vocab=size, eos_token=ends)
        except (ValueError, RuntimeError, TypeError) as error:
            raise BackendError(f"llguidance cannot read the model's tokenizer: {error}") from error
        self.size = size
        single = {c: self.reader.greedy_tokenize(c) for c in {*_INSIDE, *_OUTSIDE}}
        self.characters = {c: ids[0] for c, ids in single.items() if len(ids) == 1}
        self._compiled_matchers: dict[str, Any] = {}

    def matcher(self, schema: dict[str, Any]) -> Any:
        """A fresh matcher of the tightened schema; the last few schemas are compiled once.

        Raises:
            UnreachableError: the schema cannot be followed.
        """
        key = json.dumps(schema)
        if key not in self._compiled_matchers:
            if len(self._compiled_matchers) >= _SCHEMAS:
                del self._compiled_matchers[next(iter(self._compiled_matchers))]
            self._compiled_matchers[key] = self._compiled(schema)
        return self._compiled_matchers[key].deep_copy()

    def _compiled(self, schema: dict[str, Any]) -> Any:
        from llguidance import LLMatcher

        compact: Any = {"whitespace_flexible": False}  # free whitespace could continue forever
        try:
            grammar = LLMatcher.grammar_from_json_schema(tighten(schema), overrides=compact)
        except ValueError as error:
            raise _schema_error(str(error)) from error
        return _checked(LLMatcher(self.reader, grammar, log_level=0))


class Constrained:
    """One answer under construction.

    Attributes:
        tokens: chosen so far.
        text: their text.

    Raises:
        UnreachableError: the schema cannot be followed; so do its methods.
    """

    def __init__(self, vocabulary: Vocabulary, schema: dict[str, Any]) -> None:
        self._vocabulary = vocabulary
        self._matcher = vocabulary.matcher(schema)
        self._bits = np.zeros((vocabulary.size + 31) // 32, np.int32)
        self._decoder = codecs.getincrementaldecoder("utf-8")(errors="replace")
        self._in_string = self._escaped = False
        self.tokens: list[int] = []
        self.text = ""

    @property
    def done(self) -> bool:
        """Whether the text is a whole answer."""
        return bool(self._matcher.is_accepting())

    def allowed(self) -> NDArray[np.bool_]:
        """`[V]` which tokens may come next; at least one as long as it is not done."""
        self._matcher.unsafe_compute_mask_ptr(self._bits.ctypes.data, self._bits.nbytes)
        _checked(self._matcher)
        return np.unpackbits(self._bits.view(np.uint8), bitorder="little")[: self._vocabulary.size].astype(np.bool_)

    def take(self, token: int) -> list[int]:
        """Add a token and all that must follow it; these tokens."""
        self._matcher.consume_token(token)
        _checked(self._matcher)
        return self._add([token]) + self.take_forced()

    def take_forced(self) -> list[int]:
        """Add what must come next, the same for every answer; these tokens."""
        forced = [] if self.done else list(self._matcher.compute_ff_tokens())
        if forced:
            self._matcher.consume_tokens(forced)
            _checked(self._matcher)
        return self._add(forced)

    def close(self) -> None:
        """Bring the text to a valid end by the shortest way, without asking any model."""
        for _ in range(_LONGEST_CLOSING):
            if self.done:
                return
            self.take(self._closing(self.allowed()))
        raise _schema_error(f"no end within {_LONGEST_CLOSING} tokens")

    def _closing(self, allowed: NDArray[np.bool_]) -> int:
        """The allowed token that closes the text soonest by the order of characters; else any allowed token."""
        for character in _INSIDE if self._in_string else _OUTSIDE:
            token = self._vocabulary.characters.get(character)
            if token is not None and allowed[token]:
                return token
        return int(np.flatnonzero(allowed)[0])

    def _add(self, tokens: list[int]) -> list[int]:
        """Append tokens and their text, and track whether the text is inside a string."""
        said = self._decoder.decode(self._vocabulary.reader.decode_bytes(tokens)) if tokens else ""
        for character in said:
            quote = character == '"' and not self._escaped
            self._escaped = self._in_string and character == "\\" and not self._escaped
            self._in_string ^= quote
        self.tokens += tokens
        self.text += said
        return tokens


def _checked(matcher: Any) -> Any:
    """The matcher, unless it met an error, which it never leaves."""
    if matcher.is_error():
        raise _schema_error(str(matcher.get_error()).splitlines()[0])
    return matcher


def _schema_error(why: str) -> UnreachableError:
    return UnreachableError(f"no answer can be held to this schema: {why}")
