"""The plain commands that a sentence may stand for, the likeliest first; the planner takes the first it understands."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .elision import gapped, remarks, splits, terse, topics
from .smoothing import unopened, without_reason
from .wishes import wishes

_QUESTIONING = frozenset("what where who which why how when is are does do did has have was were".split())


def restatements(texts: Sequence[str], mark: str) -> Iterator[list[str]]:
    """Other ways to say a sentence, as words; a full stop among them parts sentences.

    Args:
        texts: the words of the sentence.
        mark: the mark that ends it.
    """
    said = " ".join(texts)
    seen = {said}
    for reading in _readings(said, mark):
        if reading not in seen:
            seen.add(reading)
            yield reading.split()


def _readings(said: str, mark: str) -> Iterator[str]:
    shorter = without_reason(said)
    plain = unopened(said)
    shortest = unopened(without_reason(plain)) if plain != said else unopened(shorter)
    for words in dict.fromkeys((said, plain)):
        yield from (" ".join(r) for r in topics(words.split()))
    yield from (plain, shorter, shortest)
    for base in dict.fromkeys((said, shorter, plain, shortest)):
        yield from wishes(base)
    if mark == "?" and plain.split()[0] in _QUESTIONING:
        return
    words = shortest.split()
    for reading in (gapped(words), map(str.split, terse(words)), remarks(words), splits(words)):
        yield from (" ".join(r) for r in reading)
