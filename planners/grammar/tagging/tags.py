"""Tokens for the grammar, the clauses they make, and where a sentence ends.

Which class a word has is said by context_rules.py and tagger.py.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from .lookahead import Reading
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


class Tagging:
    """A sentence on the way to tagged clauses.

    Attributes:
        words, texts: of the sentence.
        read: looks ahead in it.
        clause: the one that is being tagged.
        done: the clauses before it.
        particles: positions of particles of verbs that were tagged before ("blow it up").
    """

    def __init__(self, words: Sequence[Word]) -> None:
        self.words = tuple(words)
        self.texts = tuple(w.text for w in words)
        self.read = Reading(self.texts)
        self.clause = Clause()
        self.done: list[Clause] = []
        self.particles: set[int] = set()

    def put(self, kind: str, value: Any, i: int, taken: int) -> int:
        """Tag `taken` words from `i`; the position behind them."""
        self.clause.tags.append(Tag(kind, value, self.words[i : i + taken]))
        return i + taken

    @property
    def before(self) -> str:
        """The class of the last token of the clause, "" at its beginning."""
        return self.clause.tags[-1].type if self.clause.tags else ""


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
