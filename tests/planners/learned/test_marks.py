"""The likeliest row of labels is found, and marks and labels tell the same."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray

from scenewright.planners.grammar.learned.marks import labels_of, likeliest, spans_of

LABELS = ("O", "B-x", "I-x", "B-t", "I-t")


def by_trying(scores: NDArray[np.float32], moves: NDArray[np.float32]) -> list[str]:
    """The likeliest row by trying every one: the reference."""

    def value(row: tuple[int, ...]) -> float:
        labels = [LABELS[i] for i in row]
        begun = zip(["O", *labels], labels, strict=False)
        if any(b.startswith("I-") and a[2:] != b[2:] for a, b in begun):
            return -np.inf
        return sum(float(moves[a, b]) for a, b in itertools.pairwise(row)) + sum(
            float(own[i]) for own, i in zip(scores, row, strict=True)
        )

    best = max(itertools.product(range(len(LABELS)), repeat=len(scores)), key=value)
    return [LABELS[i] for i in best]


@pytest.mark.parametrize("seed", range(6))
def test_the_likeliest_row_is_found(seed: int) -> None:
    random = np.random.default_rng(seed)
    scores = random.normal(size=(5, len(LABELS))).astype(np.float32)
    moves = random.normal(size=(len(LABELS), len(LABELS))).astype(np.float32)
    assert likeliest(scores, moves, LABELS) == by_trying(scores, moves)


def test_marks_and_labels_are_the_same() -> None:
    spans = [("x", 0, 2), ("t", 2, 3), ("t", 3, 6)]
    assert list(spans_of(labels_of(7, spans))) == spans
