"""Marks of words: labels of their beginnings and insides, and the likeliest row of labels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

OUTSIDE = "O"
Span = tuple[str, int, int]  # a tag, and the words from one to another


def likeliest(scores: NDArray[np.float32], moves: NDArray[np.float32], labels: Sequence[str]) -> list[str]:
    """The likeliest row of labels in a conditional random field, by Viterbi's algorithm.

    Args:
        scores: `[words, labels]` of each label at each word.
        moves: `[labels, labels]` from one label to the next.
        labels: their names. The inside of a mark comes only behind its beginning.
    """
    bad = [[b.startswith("I-") and a[2:] != b[2:] for b in labels] for a in labels]
    allowed = np.where(np.array(bad), -np.inf, moves)
    inside = np.array([label.startswith("I-") for label in labels])
    best, came = np.where(inside, -np.inf, scores[0]), list[NDArray[np.int64]]()
    for row in scores[1:]:
        ways = best[:, None] + allowed
        came.append(ways.argmax(axis=0))
        best = ways.max(axis=0) + row
    at = [int(best.argmax())]
    for before in reversed(came):
        at.append(int(before[at[-1]]))
    return [labels[i] for i in reversed(at)]


def spans_of(labels: Sequence[str]) -> Iterator[Span]:
    """The marks of a row of labels."""
    tag, start = "", 0
    for at, label in enumerate((*labels, OUTSIDE)):
        if tag and label != f"I-{tag}":
            yield tag, start, at
            tag = ""
        if label.startswith("B-"):
            tag, start = label[2:], at


def labels_of(count: int, spans: Sequence[Span]) -> list[str]:
    """The row of labels of so many words with marks."""
    labels = [OUTSIDE] * count
    for tag, start, stop in spans:
        labels[start:stop] = [f"B-{tag}", *[f"I-{tag}"] * (stop - start - 1)]
    return labels
