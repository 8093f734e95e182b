"""Data types of the tagger: tagged tokens, clauses and the tagger's state; also splits text into sentences.

context_rules.py and tagger.py decide which class a word has.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from .lookahead import Lookahead
from .words import Word

_BOUNDARIES = frozenset(".;!?\n")


@dataclass(frozen=True)
class Tag:
    """One token for the parser: its class (a terminal of grammar.lark), its value, and the words it was made from."""

    type: str
    value: Any
    words: tuple[Word, ...]

    @property
    def text(self) -> str:
        return " ".join(w.text for w in self.words)


@dataclass
class Clause:
    """Tagged tokens of one clause.

    Attributes:
        verb: class of the first token, "" if the clause does not begin with a verb.
        negated: whether it is a prohibition ("do not touch the sofa").
        unsupported: why its verb cannot be carried out, "" if it can.
    """

    tags: list[Tag] = field(default_factory=list)
    verb: str = ""
    negated: bool = False
    unsupported: str = ""


class TaggerState:
    """A sentence while it is being tagged.

    Attributes:
        words, texts: the words of the sentence, and their text.
        ahead: lookups at any position of the sentence.
        clause: the clause that is being tagged.
        done: the finished clauses.
        particles: positions of verb particles that were tagged with their verbs ("blow it up").
    """

    def __init__(self, words: Sequence[Word]) -> None:
        self.words = tuple(words)
        self.texts = tuple(w.text for w in words)
        self.ahead = Lookahead(self.texts)
        self.clause = Clause()
        self.done: list[Clause] = []
        self.particles: set[int] = set()

    def emit(self, kind: str, value: Any, i: int, taken: int) -> int:
        """Append a token made of `taken` words from `i`; returns the position behind them."""
        self.clause.tags.append(Tag(kind, value, self.words[i : i + taken]))
        return i + taken

    @property
    def last_type(self) -> str:
        """The class of the clause's last token, "" at its beginning."""
        return self.clause.tags[-1].type if self.clause.tags else ""


def sentences(words: Sequence[Word]) -> Iterator[tuple[tuple[Word, ...], str]]:
    """The sentences, each with the punctuation mark that ends it ("" at the end of the text)."""
    start = 0
    for i, word in enumerate(words):
        if word.text in _BOUNDARIES:
            if i > start:
                yield tuple(words[start:i]), word.text
            start = i + 1
    if start < len(words):
        yield tuple(words[start:]), ""
