"""Tells the kind of a sentence: a linear classifier over words, and over words in a row."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..tagging.words import split
from ..vocabulary.nouns import is_known
from .files import store, stored
from .seen import STEM, amount_or_color, hues

FILE = "kinds.npz"
_MARKS = frozenset('.;!,:"')
_LONGEST = 3  # words in a row


@dataclass(frozen=True)
class Classifier:
    """Kinds, features, and weights `[features + 1, kinds]` float32, the last row the biases."""

    labels: Sequence[str]
    names: Sequence[str]
    weights: NDArray[np.float32]

    @cached_property
    def places(self) -> dict[str, int]:
        """The row of each feature."""
        return {name: row for row, name in enumerate(self.names)}

    @classmethod
    def of(cls, folder: Path) -> Classifier:
        """The one that is stored in a folder."""
        lists, weights = stored(folder / FILE)
        return cls(lists["labels"], lists["names"], weights["weights"])

    def write(self, folder: Path) -> None:
        """Store it in a folder."""
        store(folder / FILE, {"labels": self.labels, "names": self.names}, {"weights": self.weights})

    def kinds_of(self, said: str) -> list[tuple[str, float]]:
        """The kinds of a sentence with their probabilities, the likeliest first."""
        found = sorted(self.places[feature] for feature in features(said) if feature in self.places)
        scores = self.weights[-1] + self.weights[found].sum(axis=0) / np.sqrt(max(1, len(found)))
        chances = np.exp(scores - scores.max())
        chances /= chances.sum()
        return [(self.labels[i], float(chances[i])) for i in np.argsort(-chances, kind="stable")]


def features(said: str) -> frozenset[str]:
    """What the classifier sees of a sentence: words and their beginnings, alone and in a row. Numbers, seconds and
    colours are each one word; a colour that tells which thing is meant is none."""
    given = [word.text for word in split(said) if word.text not in _MARKS]
    named = {i for i, (word, then) in enumerate(pairwise(given)) if _is_part_of_name(word, then)}
    words = ["^", *(amount_or_color(word) for i, word in enumerate(given) if i not in named), "$"]
    rows = {" ".join(words[i : i + n]) for n in range(1, _LONGEST + 1) for i in range(len(words) - n + 1)}
    stems = [word[:STEM] for word in words]
    return frozenset(rows | {f"{a}~{b}" for a, b in pairwise(stems)} | {f"{stem}~" for stem in stems})


def _is_part_of_name(word: str, then: str) -> bool:
    """Whether a colour tells which thing is meant: "the red book"."""
    return word in hues() and (then in ("one", "ones") or is_known(then))
