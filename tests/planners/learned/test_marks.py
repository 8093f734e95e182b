"""The tagger finds the likeliest row of labels, and its weights are read as they were written."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

from scenewright.planners.grammar.learned.files import store, stored
from scenewright.planners.grammar.learned.marks import Tagger, features, labels_of, spans_of
from scenewright.planners.grammar.learned.seen import classed

LABELS = ("O", "B-x", "I-x", "B-t", "I-t")


def tagger(seed: int, words: list[str]) -> Tagger:
    names = sorted(frozenset().union(*features(words)))
    random = np.random.default_rng(seed)
    weights = random.normal(size=(len(names), len(LABELS))).astype(np.float32)
    return Tagger(LABELS, names, weights, random.normal(size=(len(LABELS), len(LABELS))).astype(np.float32))


def likeliest(model: Tagger, words: list[str]) -> list[str]:
    """By trying every row: the reference."""
    scores = [model.weights[[model.places[f] for f in seen]].sum(axis=0) for seen in features(words)]

    def value(row: tuple[int, ...]) -> float:
        labels = [LABELS[i] for i in row]
        begun = zip(["O", *labels], labels, strict=False)
        if any(b.startswith("I-") and a[2:] != b[2:] for a, b in begun):
            return -np.inf
        moves = sum(float(model.moves[a, b]) for a, b in itertools.pairwise(row))
        return moves + sum(float(s[i]) for s, i in zip(scores, row, strict=True))

    best = max(itertools.product(range(len(LABELS)), repeat=len(words)), key=value)
    return [LABELS[i] for i in best]


@pytest.mark.parametrize("seed", range(6))
def test_the_likeliest_row_is_found(seed: int) -> None:
    words = ["stop", "the", "old", "fan", "now"]
    model = tagger(seed, words)
    assert model.spans(words) == tuple(spans_of(likeliest(model, words)))


def test_no_words_have_no_marks() -> None:
    assert tagger(0, ["fan"]).spans([]) == ()


def test_marks_and_labels_are_the_same() -> None:
    spans = [("x", 0, 2), ("t", 2, 3), ("t", 3, 6)]
    assert list(spans_of(labels_of(7, spans))) == spans


def test_words_of_one_class_look_alike() -> None:
    assert [classed(w) for w in ("3", "three", "secs", "red", "sofa")] == ["#", "#", "#s", "#color", "#thing"]


def test_weights_are_stored_to_half_a_step(tmp_path: Path) -> None:
    weights = np.random.default_rng(1).normal(size=(5, 3)).astype(np.float32)
    store(tmp_path / "a.npz", {"names": ["a b", "ü"], "labels": ["c"]}, {"weights": weights})
    lists, read = stored(tmp_path / "a.npz")
    assert lists == {"names": ["a b", "ü"], "labels": ["c"]}
    assert np.abs(read["weights"] - weights).max() <= np.abs(weights).max() / 127 / 2 + 1e-6
