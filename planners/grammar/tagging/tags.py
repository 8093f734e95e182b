"""Tokens for the grammar, the clauses they make, and where a sentence ends.

Knows what a token carries. Refuses to know which class a word has: special.py and tagger.py say that.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from .words import Word

_BOUNDARIES = frozenset(".;!?\n")


@dataclass(frozen=True)
class Tag:
    """One token for the grammar: its class, what it means, and the words it was made from."""

    type: str
    value: Any
    words: tuple[Word, ...]

    @property
    def text(self) -> str:
        return " ".join(w.text for w in self.words)


@dataclass
class Clause:
    """Tagged tokens of one clause; `verb` is the class of its first token, "" if it does not begin with a verb."""

    tags: list[Tag] = field(default_factory=list)
    verb: str = ""
    negated: bool = False
    unsupported: str = ""


def sentences(words: Sequence[Word]) -> Iterator[tuple[tuple[Word, ...], str]]:
    """The sentences and the mark each ends with ("" at the end of the text)."""
    start = 0
    for i, word in enumerate(words):
        if word.text in _BOUNDARIES:
            if i > start:
                yield tuple(words[start:i]), word.text
            start = i + 1
    if start < len(words):
        yield tuple(words[start:]), ""
