"""Tells the kind of wish of an instruction: a linear classifier over words, and over words in a row.

`training/timed_wishes.py` learns its weights from written sentences.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...tagging.words import split
from ...vocabulary.nouns import is_known
from ...vocabulary.quantities import NUMBERS
from .names import hues

FOLDER = Path(__file__).parent
NO_WISH = "none"  # the kind of questions, remarks, and wishes that are about neither time nor motion
LEAST = 0.3  # probability of a kind that is tried
MOST = 2  # kinds that are tried
_SECONDS = frozenset(("s", "sec", "secs", "second", "seconds"))
_MARKS = frozenset('.;!,:"')
_STEM = 5  # letters of a word by which its forms are alike
_LONGEST = 3  # words in a row


@dataclass(frozen=True)
class Model:
    """Kinds, features, and weights `[features + 1, kinds]` float32, the last row the biases."""

    labels: Sequence[str]
    names: Sequence[str]
    weights: NDArray[np.float32]

    @cached_property
    def places(self) -> dict[str, int]:
        """The row of each feature."""
        return {name: row for row, name in enumerate(self.names)}

    def kinds_of(self, said: str) -> list[tuple[str, float]]:
        """The kinds of wish with their probabilities, the likeliest first."""
        found = sorted(self.places[feature] for feature in features(said) if feature in self.places)
        scores = self.weights[-1] + self.weights[found].sum(axis=0) / np.sqrt(max(1, len(found)))
        chances = np.exp(scores - scores.max())
        chances /= chances.sum()
        return [(self.labels[i], float(chances[i])) for i in np.argsort(-chances, kind="stable")]


def likely(said: str) -> list[tuple[str, float]]:
    """The kinds of wish that an instruction may be of, with probabilities; none if it is likelier no such wish."""
    found = list[tuple[str, float]]()
    for kind, chance in stored().kinds_of(said)[:MOST]:
        if kind == NO_WISH:
            break
        if chance >= LEAST:
            found.append((kind, chance))
    return found


def features(said: str) -> frozenset[str]:
    """What the classifier sees of an instruction: words and their beginnings, alone and in a row. Numbers, seconds and
    colours are each one word; a colour that tells which thing is meant is none."""
    given = [word.text for word in split(said) if word.text not in _MARKS]
    behind = [*given[1:], ""]
    words = ["^", *(_as_seen(w) for w, then in zip(given, behind, strict=True) if not _is_part_of_name(w, then)), "$"]
    rows = {" ".join(words[i : i + n]) for n in range(1, _LONGEST + 1) for i in range(len(words) - n + 1)}
    stems = [word[:_STEM] for word in words]
    return frozenset(rows | {f"{a}~{b}" for a, b in pairwise(stems)} | {f"{stem}~" for stem in stems})


def _as_seen(word: str) -> str:
    if word in _SECONDS:
        return "#s"
    if word in NUMBERS or word[0].isdigit():
        return "#"
    return "#color" if word in hues() else word


def _is_part_of_name(word: str, then: str) -> bool:
    """Whether a colour tells which thing is meant: "the red book"."""
    return word in hues() and is_known(then)


@cache
def stored() -> Model:
    """The model in use."""
    with np.load(FOLDER / "weights.npz", allow_pickle=False) as file:
        names, labels = (bytes(file[key]).decode().split("\n") for key in ("names", "labels"))
        return Model(labels, names, file["weights"].astype(np.float32) * file["step"])
