"""The likeliest row of labels is found, and marks and labels tell the same."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray

from scenewright.planners.grammar.learned.marks import labels_of, likeliest, spans_of

LABELS = ("O", "B-x", "I-x", "B-t", "I-t")


def by_trying(scores: NDArray[np.float32], moves: NDArray[np.float32], count: int) -> list[list[str]]:
    """The likeliest rows by trying every one: the reference."""

    def value(row: tuple[int, ...]) -> float:
        labels = [LABELS[i] for i in row]
        begun = zip(["O", *labels], labels, strict=False)
        if any(b.startswith("I-") and a[2:] != b[2:] for a, b in begun):
            return -np.inf
        return sum(float(moves[a, b]) for a, b in itertools.pairwise(row)) + sum(
            float(own[i]) for own, i in zip(scores, row, strict=True)
        )

    best = sorted(itertools.product(range(len(LABELS)), repeat=len(scores)), key=value, reverse=True)
    return [[LABELS[i] for i in row] for row in best[:count]]


@pytest.mark.parametrize("count", [1, 4])
@pytest.mark.parametrize("seed", range(6))
def test_the_likeliest_rows_are_found(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    scores = random.normal(size=(5, len(LABELS))).astype(np.float32)
    moves = random.normal(size=(len(LABELS), len(LABELS))).astype(np.float32)
    assert [row for row, _ in likeliest(scores, moves, LABELS, count)] == by_trying(scores, moves, count)


def test_no_more_rows_are_told_than_there_are() -> None:
    rows = likeliest(np.zeros((1, 3), np.float32), np.zeros((3, 3), np.float32), ("O", "B-x", "I-x"), 5)
    assert sorted(row[0] for row, _ in rows) == ["B-x", "O"]


def test_marks_and_labels_are_the_same() -> None:
    spans = [("x", 0, 2), ("t", 2, 3), ("t", 3, 6)]
    assert list(spans_of(labels_of(7, spans))) == spans
