"""What a word outside an encoder's vocabulary means in words that it knows: `known_words.json`, our own table.

The table covers the 1,203 names of LVIS and further everyday words. It says of which known kind a word names a sort
("folding chair": chair), which known kinds come nearest to it without being it ("wheelbarrow": bar cart), and to which
family it belongs ("alligator": animal), whether or not the vocabulary holds members of that family. Some kinds of the
embedded encoder are coarse ("vegetable"): most of their synonyms name sorts of them, and the table says which do not.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Literal, NamedTuple

from ...world import kinds as world
from ...world.words import AFTER_HEAD, normalise
from .vocabulary import Vocabulary

Relation = Literal["same", "sort", "alike", "family", "none"]
Words = tuple[str, ...]


class Known(NamedTuple):
    """What a phrase means to an encoder.

    Attributes:
        kinds: names of the vocabulary, the likeliest first; may be empty.
        relation: "same": the phrase names these kinds. "sort": it names a sort of each, so that one of these kinds may
            or may not be it. "alike": these kinds come nearest to it, but are not it. "family": it belongs to the
            family of these kinds, whose members need not resemble it. "none": the table does not know the phrase.
    """

    kinds: tuple[str, ...]
    relation: Relation


def known_as(text: str, vocabulary: Vocabulary | None = None) -> Known:
    """The kinds of a vocabulary that a noun phrase comes to, by the longest ending that the table knows.

    Args:
        vocabulary: of the encoder that is asked; that of the embedded encoder if None.
    """
    vocabulary = _household() if vocabulary is None else vocabulary
    for phrase in _endings(text):
        own, covered = vocabulary.head(" ".join(phrase))
        if phrase == own and not _is_sort(phrase, covered, vocabulary):
            return Known(tuple(n for n in vocabulary.names if n in covered), "same")
        if kinds := tuple(k for k in _table().sorts.get(phrase, ()) if k in vocabulary.kinds):
            return Known(kinds, "sort")
        if kinds := tuple(k for k in _table().alike.get(phrase, ()) if k in vocabulary.kinds):
            return Known(kinds, "alike")
        if (family := _table().families.get(phrase)) is not None:
            members = {*vocabulary.broader.get(family, ()), *world.table().families.get(family, ())}
            return Known(tuple(n for n in vocabulary.names if n in members), "family")
        if phrase == own:
            return Known(tuple(n for n in vocabulary.names if n in covered), "sort")
    return Known((), "none")


def is_loose(text: str, vocabulary: Vocabulary) -> bool:
    """Whether the vocabulary covers a phrase by a coarse kind only ("cucumber" by vegetable), so that a thing of that
    kind may or may not be what is named."""
    phrase, covered = vocabulary.head(text)
    return _is_sort(phrase, covered, vocabulary)


def _is_sort(phrase: Words, covered: frozenset[str], vocabulary: Vocabulary) -> bool:
    """Whether a phrase of the vocabulary names but a sort of the coarse kinds that it covers."""
    coarse = _table().coarse
    broader = any(normalise(term) == phrase for term in vocabulary.broader)
    return bool(covered) and not broader and all(k in coarse and phrase not in coarse[k] for k in covered)


def family_of(text: str) -> str | None:
    """The family that a phrase belongs to ("alligator": "animal"), by the longest ending that the table knows."""
    return next((_table().families[p] for p in _endings(text) if p in _table().families), None)


@dataclass(frozen=True)
class _Table:
    """Normalised phrases and what they come to: kinds they are sorts of, kinds they are near to, a family; and the
    phrases that name each coarse kind itself."""

    sorts: Mapping[Words, tuple[str, ...]]
    alike: Mapping[Words, tuple[str, ...]]
    families: Mapping[Words, str]
    coarse: Mapping[str, frozenset[Words]]


@cache
def _table() -> _Table:
    data = json.loads(Path(__file__).with_name("known_words.json").read_text(encoding="utf-8"))
    sorts, alike = (_by_phrase(data[part]) for part in ("sorts", "alike"))
    families: dict[Words, str] = {}
    for family, words in data["families"].items():
        for word in (family, *words):
            families.setdefault(normalise(word), family)
    coarse = {kind: frozenset(normalise(n) for n in (kind, *names)) for kind, names in data["coarse"].items()}
    return _Table(sorts, alike, families, coarse)


def _by_phrase(rows: Mapping[str, list[str]]) -> dict[Words, tuple[str, ...]]:
    """Phrases to the kinds in whose row they stand, in the order of the rows."""
    found: dict[Words, tuple[str, ...]] = {}
    for kind, words in rows.items():
        for word in words:
            found[normalise(word)] = (*found.get(normalise(word), ()), kind)
    return found


def _endings(text: str) -> list[Words]:
    """The phrase, then the endings of what stands before "of", "with" and the like, then its own, the longest first."""
    words = normalise(text)
    cut = next((i for i, w in enumerate(words) if i and w in AFTER_HEAD), len(words))
    parts = (words[:cut], words)
    endings = (part[start:] for part in parts for start in range(len(part)))
    return list(dict.fromkeys([words, *endings])) if words else []


@cache
def _household() -> Vocabulary:
    return Vocabulary.household()
