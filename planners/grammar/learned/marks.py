"""Marks of words: labels of their beginnings and insides, and the likeliest row of labels."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

OUTSIDE = "O"
Span = tuple[str, int, int]  # a tag, and the words from one to another


def likeliest(
    scores: NDArray[np.float32], moves: NDArray[np.float32], labels: Sequence[str], count: int = 1
) -> list[tuple[list[str], float]]:
    """The likeliest rows of labels in a conditional random field with their scores, the likeliest first, by Viterbi's
    algorithm with the best few ways to each label (Seshadri, Sundberg 1994, "List Viterbi Decoding Algorithms").

    Args:
        scores: `[words, labels]` of each label at each word.
        moves: `[labels, labels]` from one label to the next.
        labels: their names. The inside of a mark comes only behind its beginning.
        count: how many rows at most.
    """
    bad = [[b.startswith("I-") and a[2:] != b[2:] for b in labels] for a in labels]
    allowed = np.where(np.array(bad), -np.inf, moves)
    inside = np.array([label.startswith("I-") for label in labels])
    best = np.full((count, len(labels)), -np.inf)
    best[0] = np.where(inside, -np.inf, scores[0])
    came = list[NDArray[np.int64]]()
    for row in scores[1:]:
        ways = (best[:, :, None] + allowed).reshape(-1, len(labels))
        came.append(np.argsort(-ways, axis=0, kind="stable")[:count])
        best = np.take_along_axis(ways, came[-1], axis=0) + row
    found = list[tuple[list[str], float]]()
    for last in np.argsort(-best.reshape(-1), kind="stable")[:count]:
        if not np.isfinite(score := float(best.reshape(-1)[last])):
            break
        at = [int(last)]
        for before in reversed(came):
            rank, label = divmod(at[-1], len(labels))
            at.append(int(before[rank, label]))
        found.append(([labels[i % len(labels)] for i in reversed(at)], score))
    return found


def spans_of(labels: Sequence[str]) -> Iterator[Span]:
    """The marks of a row of labels."""
    tag, start = "", 0
    for at, label in enumerate((*labels, OUTSIDE)):
        if tag and label != f"I-{tag}":
            yield tag, start, at
            tag = ""
        if label.startswith("B-"):
            tag, start = label[2:], at


def held_by(spans: Collection[Span], *tags: str) -> set[int]:
    """Where the words of marks stand: of all, or of those with some tags."""
    return {at for tag, start, stop in spans if not tags or tag in tags for at in range(start, stop)}


def labels_of(count: int, spans: Sequence[Span]) -> list[str]:
    """The row of labels of so many words with marks."""
    labels = [OUTSIDE] * count
    for tag, start, stop in spans:
        labels[start:stop] = [f"B-{tag}", *[f"I-{tag}"] * (stop - start - 1)]
    return labels
