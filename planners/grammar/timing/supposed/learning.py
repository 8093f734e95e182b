"""Learns the weights of `kinds.py` from `sentences.tsv`: `python -m scenewright.planners.grammar.timing.supposed.learning`.

Logistic regression with a Gaussian prior (ridge), by L-BFGS from zero: the same sentences give the same weights on one
machine. Weights are stored in steps of 1/127 of the largest.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
import torch

from .kinds import FOLDER, features

RARE = 2  # sentences in which a feature must stand
RIDGE = 1e-5
STEPS = 120

Sentence = tuple[str, str]  # the kind of wish, and how it is said


def sentences() -> list[Sentence]:
    """The sentences to learn from."""
    lines = (FOLDER / "sentences.tsv").read_text(encoding="utf-8").splitlines()
    return [(kind, said) for kind, _, said in (line.partition("\t") for line in lines)]


def learned(known: Sequence[Sentence]) -> tuple[list[str], list[str], torch.Tensor]:
    """Labels, features, and weights `[features + 1, labels]` (the last row are the biases)."""
    seen = [features(said) for _, said in known]
    often = Counter(feature for found in seen for feature in found)
    names = sorted(feature for feature, n in often.items() if n >= RARE)
    labels, places = sorted({kind for kind, _ in known}), {name: i for i, name in enumerate(names)}
    rows = [sorted(places[f] for f in found if f in places) for found in seen]
    at = torch.tensor([[i, place] for i, row in enumerate(rows) for place in row]).T
    each = torch.tensor([len(row) ** -0.5 for row in rows for _ in row], dtype=torch.float64)
    given = torch.sparse_coo_tensor(at, each, (len(rows), len(names))).coalesce()
    wanted = torch.tensor([labels.index(kind) for kind, _ in known])
    weights = torch.zeros(len(names) + 1, len(labels), dtype=torch.float64, requires_grad=True)
    optimizer = torch.optim.LBFGS([weights], max_iter=STEPS, line_search_fn="strong_wolfe")

    def loss() -> torch.Tensor:
        optimizer.zero_grad()
        scores = torch.sparse.mm(given, weights[:-1]) + weights[-1]
        value = torch.nn.functional.cross_entropy(scores, wanted) + RIDGE * weights[:-1].square().sum()
        value.backward()
        return value

    optimizer.step(loss)
    return labels, names, weights.detach()


def main() -> None:
    """Learn from all sentences, and store the weights."""
    labels, names, weights = learned(sentences())
    step = float(weights.abs().max()) / 127
    whole = (weights / step).round().to(torch.int8).numpy()
    texts = {key: np.frombuffer("\n".join(said).encode(), np.uint8) for key, said in (("names", names), ("labels", labels))}
    np.savez_compressed(FOLDER / "weights.npz", weights=whole, step=np.float32(step), **texts)


if __name__ == "__main__":
    main()
