"""The kind of a question about time, and which of its words name what.

`training/timed_words.py` learns both from written questions.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from .....grammar.learned.marks import Span
from .....grammar.learned.network import networks, told
from .....grammar.tagging.words import clean, split
from .....grammar.timing.spoken import in_figures

TASK = "questions"


def words_of(text: str) -> tuple[str, ...]:
    """The words of a question, with decimals in figures."""
    return tuple(word.text for word in split(in_figures(clean(text))))


def kinds_of(words: Sequence[str]) -> Sequence[tuple[str, float]]:
    """The kinds of question with their probabilities, the likeliest first."""
    return told(TASK, tuple(words)).kinds


def marked_ways(words: Sequence[str]) -> tuple[tuple[Span, ...], ...]:
    """Which words of a question name what it is about (`x`), another thing (`y`), at what time it is asked (`t`), in
    what unit (`u`), and which ask for nothing (`off`); in likely ways, the likeliest first."""
    return told(TASK, tuple(words)).ways


def vocabulary() -> Collection[str]:
    """The words that have been seen often."""
    return networks().places.keys()
