"""The kind of a question about time, and which of its words name what.

`training/timed_questions.py` learns both from written questions.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path

from .....grammar.learned.kinds import Classifier
from .....grammar.learned.marks import Span, Tagger

FOLDER = Path(__file__).parent


def kinds_of(said: str) -> list[tuple[str, float]]:
    """The kinds of question with their probabilities, the likeliest first."""
    return classifier().kinds_of(said)


def marked(words: Sequence[str]) -> tuple[Span, ...]:
    """Which words of a question name what it is about (`x`), another thing (`y`), at what time it is asked (`t`), in
    what unit (`u`), and which ask for nothing (`off`)."""
    return tagger().spans(words)


@cache
def classifier() -> Classifier:
    """What tells kinds."""
    return Classifier.of(FOLDER)


@cache
def vocabulary() -> frozenset[str]:
    """The words that the classifier knows."""
    return frozenset(name for name in classifier().names if name.isalpha())


@cache
def tagger() -> Tagger:
    """What tells marks."""
    return Tagger.of(FOLDER)
