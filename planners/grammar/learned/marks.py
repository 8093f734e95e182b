"""Tells which words of a sentence name what: a linear chain over words, their neighbours and the mark before.

A conditional random field (Lafferty, McCallum, Pereira 2001) with the marks' beginnings and insides as labels; the
likeliest row of labels is found by Viterbi's algorithm.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..tagging.words import bag
from .files import store, stored
from .seen import STEM, classed

FILE = "marks.npz"
OUTSIDE = "O"
Span = tuple[str, int, int]  # a tag, and the words from one to another
_ENDS = bag(", . ; and but so")
_LEADS = bag(
    "when once while until till after before as during from at for in over by to because so instead not than between "
    ", ."
)


@dataclass(frozen=True)
class Tagger:
    """Labels, features, weights `[features, labels]`, and `moves` `[labels, labels]` from one label to the next, all
    float32."""

    labels: Sequence[str]
    names: Sequence[str]
    weights: NDArray[np.float32]
    moves: NDArray[np.float32]

    @cached_property
    def places(self) -> dict[str, int]:
        """The row of each feature."""
        return {name: row for row, name in enumerate(self.names)}

    @cached_property
    def _allowed(self) -> NDArray[np.float32]:
        """The moves, with those to the inside of a mark that has not begun at minus infinity."""
        bad = [[b.startswith("I-") and a[2:] != b[2:] for b in self.labels] for a in self.labels]
        return np.where(np.array(bad), -np.inf, self.moves).astype(np.float32)

    @classmethod
    def of(cls, folder: Path) -> Tagger:
        """The one that is stored in a folder."""
        lists, weights = stored(folder / FILE)
        return cls(lists["labels"], lists["names"], weights["weights"], weights["moves"])

    def write(self, folder: Path) -> None:
        """Store it in a folder."""
        lists = {"labels": self.labels, "names": self.names}
        store(folder / FILE, lists, {"weights": self.weights, "moves": self.moves})

    def spans(self, words: Sequence[str]) -> tuple[Span, ...]:
        """The marks in words."""
        if not words:
            return ()
        scores = np.stack(
            [self.weights[sorted(self.places[f] for f in seen if f in self.places)].sum(axis=0)
             for seen in features(words)]
        )  # fmt: skip
        inside = np.array([label.startswith("I-") for label in self.labels])
        best, came = np.where(inside, -np.inf, scores[0]), list[NDArray[np.int64]]()
        for row in scores[1:]:
            ways = best[:, None] + self._allowed
            came.append(ways.argmax(axis=0))
            best = ways.max(axis=0) + row
        at = [int(best.argmax())]
        for before in reversed(came):
            at.append(int(before[at[-1]]))
        return tuple(spans_of([self.labels[i] for i in reversed(at)]))


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


def features(words: Sequence[str]) -> list[frozenset[str]]:
    """What the tagger sees at each word: it and its neighbours, alone and in a row, and what leads its clause."""
    rim = 3
    padded = ["^"] * rim + list(words) + ["$"] * rim
    kinds = [classed(w) if w not in "^$" else w for w in padded]
    seen = [kind or word for word, kind in zip(padded, kinds, strict=True)]
    stems = [kind or word[:STEM] for word, kind in zip(padded, kinds, strict=True)]
    end, lead, verb, found = "^", "^", "", list[frozenset[str]]()
    for i, word in enumerate(padded[rim:-rim], rim):
        a, b, c, d, e = seen[i - 2 : i + 3]
        own = {f"{far}={seen[i + far]}" for far in (-2, -1, 0, 1, 2)}
        own |= {f"w{far}={padded[i + far]}" for far in (-1, 0, 1)} | {f"c{far}={stems[i + far]}" for far in (-3, 3)}
        own |= {f"bc={b}|{c}", f"cd={c}|{d}", f"bd={b}|{d}", f"ab={a}|{b}", f"de={d}|{e}"}
        own |= {f"bcd={b}|{c}|{d}", f"cde={c}|{d}|{e}", f"abc={a}|{b}|{c}"}
        own |= {f"s={word[-3:]}", f"end={end}", f"lead={lead}{verb}", "any"}
        found.append(frozenset(own))
        end = word if word in _ENDS else end
        if word in _LEADS:
            lead, verb = word, ""
        elif kinds[i].startswith("#v"):
            verb = "|v"
    return found
