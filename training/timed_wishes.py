"""Learn to tell the kinds of wishes about time and motion from written sentences.

    python -m scenewright.training.timed_wishes

Reads `timed_wishes.tsv` (on each line a writer, a kind and a sentence; the ten writers knew the kinds and no code),
tells how often the kind of a writer's sentences is told right by what the others wrote, and writes `weights.npz` beside
`supposed/kinds.py`. Logistic regression with a Gaussian prior, by L-BFGS from zero: the same sentences give the same
weights on one machine.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch

from ..planners.grammar.timing.supposed.kinds import FOLDER, Model, features

SENTENCES = Path(__file__).with_name("timed_wishes.tsv")
RARE = 2  # sentences in which a feature must stand
RIDGE = 1e-5  # of the squares of weights
STEPS = 120
LEVELS = 127  # weights are stored as whole numbers of steps


class Sentence(NamedTuple):
    """What one writer wrote for one kind of wish."""

    writer: str
    kind: str
    said: str


def sentences() -> list[Sentence]:
    """The sentences to learn from."""
    lines = SENTENCES.read_text(encoding="utf-8").splitlines()
    return [Sentence(*line.split("\t")) for line in lines]


def learned(known: Sequence[Sentence]) -> Model:
    """The model that tells the kinds of sentences best."""
    seen = [features(sentence.said) for sentence in known]
    often = Counter(feature for found in seen for feature in found)
    names = sorted(feature for feature, n in often.items() if n >= RARE)
    labels, places = sorted({sentence.kind for sentence in known}), {name: i for i, name in enumerate(names)}
    rows = [sorted(places[f] for f in found if f in places) for found in seen]
    at = torch.tensor([[i, place] for i, row in enumerate(rows) for place in row]).T
    each = torch.tensor([len(row) ** -0.5 for row in rows for _ in row], dtype=torch.float64)
    given = torch.sparse_coo_tensor(at, each, (len(rows), len(names)), check_invariants=True).coalesce()
    wanted = torch.tensor([labels.index(sentence.kind) for sentence in known])
    weights = torch.zeros(len(names) + 1, len(labels), dtype=torch.float64, requires_grad=True)
    optimizer = torch.optim.LBFGS([weights], max_iter=STEPS, line_search_fn="strong_wolfe")

    def loss() -> torch.Tensor:
        optimizer.zero_grad()
        scores = torch.sparse.mm(given, weights[:-1]) + weights[-1]
        value = torch.nn.functional.cross_entropy(scores, wanted) + RIDGE * weights[:-1].square().sum()
        value.backward()  # type: ignore[no-untyped-call]
        return value

    optimizer.step(loss)  # type: ignore[no-untyped-call]
    return Model(labels, names, weights.detach().numpy().astype(np.float32))


def right_of_unseen(known: Sequence[Sentence]) -> float:
    """The share of sentences whose kind is told by a model that knows those of the other writers."""
    right = 0
    for writer in sorted({sentence.writer for sentence in known}):
        model = learned([sentence for sentence in known if sentence.writer != writer])
        own = [sentence for sentence in known if sentence.writer == writer]
        right += sum(model.kinds_of(sentence.said)[0][0] == sentence.kind for sentence in own)
    return right / len(known)


def main() -> None:
    """Learn from all sentences, and store the weights."""
    known = sentences()
    print(f"{len(known)} sentences; of a writer who was left out {right_of_unseen(known):.3f} are told right")
    model = learned(known)
    step = float(np.abs(model.weights).max()) / LEVELS
    names, labels = (np.frombuffer("\n".join(said).encode(), np.uint8) for said in (model.names, model.labels))
    whole = np.round(model.weights / step).astype(np.int8)
    np.savez_compressed(FOLDER / "weights.npz", weights=whole, step=np.float32(step), names=names, labels=labels)


if __name__ == "__main__":
    main()
