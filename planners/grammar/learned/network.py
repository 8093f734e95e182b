"""Tells the kind of a sentence and which of its words name what: a small recurrent network.

Words, and the runs of letters in them, are embedded; two layers of long short-term memory (Hochreiter, Schmidhuber
1997) read them forwards and backwards. The kind is told from the greatest and the mean of what they hold, the marks
from what they hold at each word, as a chain of labels (Lample et al. 2016, "Neural Architectures for Named Entity
Recognition"). Several tasks share all but their last layers. Networks that learned the same sentences from other
beginnings err in other places, so that the mean of what a few of them tell is right more often (Hansen, Salamon 1990,
"Neural Network Ensembles").
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .files import store, stored
from .marks import Span, likeliest, spans_of
from .seen import amount_or_color, classed

F32 = NDArray[np.float32]

FILE = Path(__file__).with_name("networks.npz")
ROWS = 8192  # of the table of pieces
LAYERS = 2
WAYS = ("forwards", "backwards")
MOST_WAYS, BEHIND = 6, 3.0  # ways to mark a sentence that are told, and how much lower they score than the likeliest
UNKNOWN = 0  # row of a word that was seen too rarely
_RUNS = (3, 4, 5)  # letters of a piece


@dataclass(frozen=True)
class Told:
    """What is told of a sentence.

    Attributes:
        kinds: with their probabilities, the likeliest first.
        ways: the marks in its words, in likely ways, the likeliest first.
    """

    kinds: tuple[tuple[str, float], ...]
    ways: tuple[tuple[Span, ...], ...]

    @property
    def spans(self) -> tuple[Span, ...]:
        """The likeliest marks."""
        return self.ways[0]


@dataclass(frozen=True, eq=False)
class Network:
    """The network with its weights.

    Attributes:
        lists: `words`, the first of which is empty and stands for all others; of each task `kinds.TASK` and
            `labels.TASK`.
        weights: float32 arrays: `rows.words` `[words, width]`, `rows.pieces` `[ROWS, width]`; of each layer and way
            `rnn.LAYER.WAY.inputs` `[4 hidden, inputs]`, `.hidden` `[4 hidden, hidden]` and `.biases`, whose rows are
            the gates of input, forgetting, candidates and output; of each task `kinds.TASK.inputs` and
            `labels.TASK.inputs` `[outputs, inputs]`, their `.biases`, and `moves.TASK` `[labels, labels]` from one
            label to the next.
    """

    lists: Mapping[str, Sequence[str]]
    weights: Mapping[str, F32]

    @cached_property
    def places(self) -> dict[str, int]:
        """The row of each word."""
        return {word: row for row, word in enumerate(self.lists["words"])}

    def scores(self, task: str, words: Sequence[str]) -> tuple[F32, F32]:
        """The probabilities of the kinds of a task, and the score of each label at each word, `[words, labels]`.

        Args:
            task: one of those that it has learned.
            words: lower-case words and marks of punctuation; at least one.
        """
        held = self._held(words)
        pooled = np.concatenate([held.max(axis=0), held.mean(axis=0)])
        scores = self._linear(f"kinds.{task}", pooled)
        chances = np.exp(scores - scores.max())
        return chances / chances.sum(), self._linear(f"labels.{task}", held)

    def _held(self, words: Sequence[str]) -> F32:
        """What the last layer holds at each word, `[words, 2 hidden]`."""
        known = self.weights["rows.words"][[self.places.get(word, UNKNOWN) for word in words]]
        built = np.stack([self.weights["rows.pieces"][list(pieces(word))].mean(axis=0) for word in words])
        held = np.concatenate([known, built], axis=1)
        for layer in range(LAYERS):
            forwards, backwards = (f"rnn.{layer}.{way}" for way in WAYS)
            held = np.concatenate([self._read(forwards, held), self._read(backwards, held[::-1])[::-1]], axis=1)
        return held

    def _read(self, name: str, inputs: F32) -> F32:
        """What one layer holds after each word, one way."""
        given = self._linear(name, inputs)
        again = self.weights[f"{name}.hidden"]
        size = again.shape[1]
        hidden, cell = (np.zeros(size, np.float32) for _ in range(2))
        halved = np.full(4 * size, 0.5, np.float32)  # the sigmoid of x is (1 + tanh(x / 2)) / 2
        halved[2 * size : 3 * size] = 1.0
        found = np.empty((len(inputs), size), np.float32)
        for at, row in enumerate(given):
            gates = np.tanh((row + _times(hidden, again)) * halved)
            enter, keep, leave = (0.5 + 0.5 * gates[part * size : (part + 1) * size] for part in (0, 1, 3))
            cell = keep * cell + enter * gates[2 * size : 3 * size]
            hidden = leave * np.tanh(cell)
            found[at] = hidden
        return found

    def _linear(self, name: str, values: F32) -> F32:
        return _times(values, self.weights[f"{name}.inputs"]) + self.weights[f"{name}.biases"]


@dataclass(frozen=True, eq=False)
class Networks:
    """Networks with the same lists, which tell what they hold on average.

    Attributes:
        members: one at least.
    """

    members: tuple[Network, ...]

    @classmethod
    def of(cls, path: Path = FILE) -> Networks:
        """Those that a file holds."""
        lists, weights = stored(path)
        count = 1 + max(int(name.split(".")[0]) for name in weights)
        own = [{name: values for name, values in weights.items() if name.startswith(f"{i}.")} for i in range(count)]
        return cls(
            tuple(Network(lists, {name.split(".", 1)[1]: values for name, values in held.items()}) for held in own)
        )

    def write(self, path: Path = FILE) -> None:
        """Store them in a file."""
        weights = {f"{i}.{name}": held for i, own in enumerate(self.members) for name, held in own.weights.items()}
        store(path, self.members[0].lists, weights)

    @property
    def places(self) -> Mapping[str, int]:
        """The row of each word."""
        return self.members[0].places

    @cached_property
    def _moves(self) -> dict[str, F32]:
        """For each task the mean of the scores from one label to the next."""
        names = [name for name in self.members[0].weights if name.startswith("moves.")]
        return {
            name.removeprefix("moves."): np.mean([own.weights[name] for own in self.members], axis=0) for name in names
        }

    def told(self, task: str, words: Sequence[str]) -> Told:
        """The kind of a sentence and its marks.

        Args:
            task: one of those that they have learned.
            words: lower-case words and marks of punctuation.
        """
        if not words:
            return Told((), ((),))
        chances, labels = (
            np.mean(own, axis=0) for own in zip(*(m.scores(task, words) for m in self.members), strict=True)
        )
        lists, moves = self.members[0].lists, self._moves[task]
        names = lists[f"kinds.{task}"]
        kinds = tuple((names[i], float(chances[i])) for i in np.argsort(-chances, kind="stable"))
        rows = likeliest(labels, moves, lists[f"labels.{task}"], MOST_WAYS)
        ways = tuple(tuple(spans_of(row)) for row, score in rows if score > rows[0][1] - BEHIND)
        return Told(kinds, tuple(dict.fromkeys(ways)))


def _times(values: F32, weights: F32) -> F32:
    """Each row of weights with the values; without threads, which wait for each other on a busy machine."""
    found: F32 = np.einsum("...i,oi->...o", values, weights)
    return found


@cache
def pieces(word: str) -> tuple[int, ...]:
    """The rows of a word's pieces: its two classes first, then the runs of letters of what is no number."""
    runs = [f"={classed(word)}", f"~{amount_or_color(word)}"]
    if not word[:1].isdigit():
        marked = f"<{word}>"
        runs += [marked[at : at + count] for count in _RUNS for at in range(len(marked) - count + 1)]
    return tuple(zlib.crc32(run.encode()) % ROWS for run in runs)


@lru_cache(maxsize=512)  # several checks ask for the same words
def told(task: str, words: tuple[str, ...]) -> Told:
    """What the networks that come with the package tell of a sentence."""
    return networks().told(task, words)


@cache
def networks() -> Networks:
    """The networks that come with the package."""
    return Networks.of()
