"""An instruction as sentences, and a clause without what only makes it polite.

Knows marks and filler. Refuses to know what is wished, and where a sentence falls into clauses (reading.py).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..grammar.tagging.words import clean, split
from ..grammar.vocabulary import lexicon

_ENDS = frozenset(".;!:\n")
_OPENERS = tuple(sorted((*lexicon.POLITE, *lexicon.FILLER), key=len, reverse=True))
_SOUND = frozenset({"i want", "i need"})  # openers that some wishes begin with


def sentences(text: str) -> Iterator[tuple[str, ...]]:
    """The words of each sentence; a colon parts a headline from what it means."""
    words: list[str] = []
    for word in (*(w.text for w in split(clean(text))), "."):
        if word in _ENDS or word == "?":
            if words:
                yield tuple(words)
            words = []
        else:
            words.append(word)


def plain(words: Sequence[str]) -> list[str]:
    """The words of a clause without politeness before and filler in and behind it."""
    kept = [w for w in words if w not in (",", '"')]
    while found := next((p for p in _OPENERS if tuple(kept[: len(p)]) == p and " ".join(p) not in _SOUND), None):
        kept = kept[len(found) :]
    while found := next((p for p in lexicon.FILLER if p and tuple(kept[-len(p) :]) == p and p[-1] != "room"), None):
        kept = kept[: -len(found)]
    return [w for w in kept if w not in ("please", "just", "simply")]
