"""Learn from written sentences to tell their kinds, and which of their words name what.

A file of sentences holds on each line a writer, a kind and a sentence with marks: "[x the ball] is to be [as red]".
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import torch

from ..gaussians import late_re as re
from ..planners.grammar.learned import kinds, marks
from ..planners.grammar.learned.kinds import Classifier
from ..planners.grammar.learned.marks import Span, Tagger, labels_of
from ..planners.grammar.tagging.words import split

RARE = 2  # sentences, or words, in which a feature must stand
RIDGE = 1e-5  # of the squares of the classifier's weights
PULL = 0.1  # the same of the tagger's, which sees sums and not means
STEPS = 120
_MARK = re.compile(r"\[(?P<tag>[a-z]+) (?P<said>[^\[\]]*)\]")


@dataclass(frozen=True)
class Sentence:
    """What one writer wrote of one kind, with marks."""

    writer: str
    kind: str
    marked: str

    @cached_property
    def said(self) -> str:
        """The sentence without marks."""
        return _MARK.sub(lambda found: found["said"], self.marked)

    @cached_property
    def words(self) -> tuple[str, ...]:
        """Its words and marks of punctuation."""
        return tuple(word.text for word in split(self.said))

    @cached_property
    def spans(self) -> tuple[Span, ...]:
        """Its marks in its words."""
        found, shorter = list[Span](), 0
        places = [word.start for word in split(self.said)]
        for mark in _MARK.finditer(self.marked):
            start = mark.start() - shorter
            shorter += len(mark[0]) - len(mark["said"])
            at = [i for i, place in enumerate(places) if start <= place < start + len(mark["said"])]
            found += [(mark["tag"], at[0], at[-1] + 1)] if at else []
        return tuple(found)


def sentences(path: Path) -> list[Sentence]:
    """The sentences of a file."""
    return [Sentence(*line.split("\t")) for line in path.read_text(encoding="utf-8").splitlines()]


def classifier(known: Sequence[Sentence], ridge: float = RIDGE) -> Classifier:
    """What tells the kinds of sentences best: logistic regression with a Gaussian prior.

    Args:
        ridge: weight of the squares of its weights; less for many kinds, of which each has few sentences.
    """
    seen = [kinds.features(sentence.said) for sentence in known]
    names, rows = _numbered(seen)
    labels = sorted({sentence.kind for sentence in known})
    each = [len(row) ** -0.5 for row in rows for _ in row]
    given = _sparse(rows, each, len(names))
    wanted = torch.tensor([labels.index(sentence.kind) for sentence in known])
    weights = torch.zeros(len(names) + 1, len(labels), dtype=torch.float64, requires_grad=True)

    def loss() -> torch.Tensor:
        scores = torch.sparse.mm(given, weights[:-1]) + weights[-1]
        return torch.nn.functional.cross_entropy(scores, wanted) + ridge * weights[:-1].square().sum()

    _minimized(loss, [weights])
    return Classifier(labels, names, weights.detach().numpy().astype(np.float32))


def tagger(known: Sequence[Sentence]) -> Tagger:
    """What tells the marks of sentences best: a conditional random field with a Gaussian prior."""
    marked = [sentence for sentence in known if sentence.words]
    seen = [marks.features(sentence.words) for sentence in marked]
    names, rows = _numbered([own for sentence in seen for own in sentence])
    given = _sparse(rows, [1.0 for row in rows for _ in row], len(names))
    tags = sorted({tag for sentence in marked for tag, _, _ in sentence.spans})
    labels = [marks.OUTSIDE, *(f"{part}-{tag}" for tag in tags for part in "BI")]
    counts = torch.tensor([len(sentence.words) for sentence in marked])
    here = torch.arange(int(counts.max())) < counts[:, None]  # [sentences, words]
    at = torch.zeros(here.shape, dtype=torch.long).masked_scatter(here, torch.arange(len(rows)))
    told = [labels.index(label) for s in marked for label in labels_of(len(s.words), s.spans)]
    wanted = torch.zeros(here.shape, dtype=torch.long).masked_scatter(here, torch.tensor(told))
    weights = torch.zeros(len(names), len(labels), dtype=torch.float64, requires_grad=True)
    moves = torch.zeros(len(labels), len(labels), dtype=torch.float64, requires_grad=True)

    def loss() -> torch.Tensor:
        scores = torch.sparse.mm(given, weights)[at]  # [sentences, words, labels]
        gold = (scores.gather(2, wanted[..., None])[..., 0] * here).sum()
        gold = gold + (moves[wanted[:, :-1], wanted[:, 1:]] * here[:, 1:]).sum()
        sums = scores[:, 0]
        for word in range(1, here.shape[1]):
            further = torch.logsumexp(sums[:, :, None] + moves, 1) + scores[:, word]
            sums = torch.where(here[:, word, None], further, sums)
        return torch.logsumexp(sums, 1).sum() - gold + PULL * (weights.square().sum() + moves.square().sum())

    _minimized(loss, [weights, moves])
    return Tagger(labels, names, *(w.detach().numpy().astype(np.float32) for w in (weights, moves)))


def _numbered(seen: Sequence[frozenset[str]]) -> tuple[list[str], list[list[int]]]:
    """The features that are not rare, and those of each row by their numbers."""
    often = Counter(feature for found in seen for feature in found)
    names = sorted(feature for feature, n in often.items() if n >= RARE)
    places = {name: i for i, name in enumerate(names)}
    return names, [sorted(places[f] for f in found if f in places) for found in seen]


def _sparse(rows: Sequence[Sequence[int]], values: Sequence[float], width: int) -> torch.Tensor:
    at = torch.tensor([[i, place] for i, row in enumerate(rows) for place in row]).T
    filled = torch.tensor(values, dtype=torch.float64)
    return torch.sparse_coo_tensor(at, filled, (len(rows), width), check_invariants=True).coalesce()


def _minimized(loss: Callable[[], torch.Tensor], weights: list[torch.Tensor]) -> None:
    """Change weights, all zero at first, by L-BFGS: the same sentences give the same weights on one machine."""
    optimizer = torch.optim.LBFGS(weights, max_iter=STEPS, line_search_fn="strong_wolfe")

    def step() -> torch.Tensor:
        optimizer.zero_grad()
        value = loss()
        value.backward()  # type: ignore[no-untyped-call]
        return value

    optimizer.step(step)  # type: ignore[no-untyped-call]


@dataclass(frozen=True)
class Told:
    """How well the sentences of writers are told by models that know those of the others.

    Attributes:
        kinds: the share of sentences whose kind is told.
        precision, recall: of marks, with their tag and both ends.
    """

    kinds: float
    precision: float
    recall: float


def told_of_unseen(known: Sequence[Sentence], ridge: float = RIDGE) -> Told:
    """How well the sentences of each writer are told by models that know those of the others."""
    right, hits, given, wanted = 0, 0, 0, 0
    for writer in sorted({sentence.writer for sentence in known}):
        others = [sentence for sentence in known if sentence.writer != writer]
        kind_of, spans_of = classifier(others, ridge), tagger(others)
        for sentence in known:
            if sentence.writer == writer:
                right += kind_of.kinds_of(sentence.said)[0][0] == sentence.kind
                found, true = set(spans_of.spans(sentence.words)), set(sentence.spans)
                hits, given, wanted = hits + len(found & true), given + len(found), wanted + len(true)
    return Told(right / len(known), hits / given, hits / wanted)


def learn(path: Path, folder: Path, ridge: float = RIDGE) -> None:
    """Learn from the sentences of a file, say how well that goes, and write the models into a folder."""
    known = sentences(path)
    told = told_of_unseen(known, ridge)
    print(
        f"{len(known)} sentences; of a writer who was left out {told.kinds:.3f} of the kinds are told right, "
        f"and marks with a precision of {told.precision:.3f} and a recall of {told.recall:.3f}"
    )
    classifier(known, ridge).write(folder)
    tagger(known).write(folder)
