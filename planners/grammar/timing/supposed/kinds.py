"""Tells the kind of wish of an instruction: a linear classifier over words, pairs and triples of words.

Its weights (`weights.npz`) were learned from written sentences (`sentences.tsv`) by `learning.py`.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .....gaussians import color
from ...tagging.words import split
from ...vocabulary.nouns import is_known
from ...vocabulary.quantities import NUMBERS

FOLDER = Path(__file__).parent
_SECONDS = frozenset(("s", "sec", "secs", "second", "seconds"))
_MARKS = frozenset('.;!,:"')
LEAST = 0.3  # probability of a kind that is tried
MOST = 2  # kinds that are tried
_STEM = 5  # letters of a word by which its forms are alike
_LONGEST = 3  # words in a row


def features(said: str) -> frozenset[str]:
    """What the classifier sees of an instruction: words and their beginnings, alone and in a row. Numbers, seconds and
    colours are each one word."""
    given = [word.text for word in split(said) if word.text not in _MARKS]
    behind = [*given[1:], ""]
    words = ["^", *(_as_seen(w) for w, then in zip(given, behind, strict=True) if not _is_part_of_name(w, then)), "$"]
    rows = {" ".join(words[i : i + n]) for n in range(1, _LONGEST + 1) for i in range(len(words) - n + 1)}
    stems = [word[:_STEM] for word in words]
    return frozenset(rows | {f"{a}~{b}" for a, b in zip(stems, stems[1:], strict=False)} | {f"{s}~" for s in stems})


def _as_seen(word: str) -> str:
    if word in _SECONDS:
        return "#s"
    if word in NUMBERS or word[0].isdigit():
        return "#"
    return "#color" if word in _colors() else word


def _is_part_of_name(word: str, then: str) -> bool:
    """Whether a colour tells which thing is meant: "the red book"."""
    return word in _colors() and is_known(then)


@cache
def _colors() -> frozenset[str]:
    return frozenset(name for name in color.names() if " " not in name)


def kinds_of(said: str) -> list[tuple[str, float]]:
    """The kinds of wish with their probabilities, the likeliest first."""
    labels, places, weights = _model()
    found = [places[feature] for feature in features(said) if feature in places]
    scores = weights[-1] + weights[found].sum(axis=0) / np.sqrt(max(1, len(found)))
    chances = np.exp(scores - scores.max())
    chances /= chances.sum()
    return [(labels[i], float(chances[i])) for i in np.argsort(-chances, kind="stable")]


def likely(said: str) -> list[tuple[str, float]]:
    """The kinds of wish that an instruction may be of, with their probabilities; none if it is likelier none of them."""
    found = list[tuple[str, float]]()
    for kind, chance in kinds_of(said)[:MOST]:
        if kind == "none":
            break
        if chance >= LEAST:
            found.append((kind, chance))
    return found


@cache
def _model() -> tuple[list[str], dict[str, int], NDArray[np.float32]]:
    """Labels, the row of each feature, and weights `[features + 1, labels]`, the last row the biases."""
    with np.load(FOLDER / "weights.npz", allow_pickle=False) as file:
        names: Any = bytes(file["names"]).decode().split("\n")
        labels, weights = bytes(file["labels"]).decode().split("\n"), file["weights"].astype(np.float32)
        return labels, {name: row for row, name in enumerate(names)}, weights * float(file["step"])
