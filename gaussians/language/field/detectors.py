"""What detectors' labels say about the kind of a group: log-likelihoods from the votes of its masks.

A view that sees a thing either gives it a label or is silent. A kind that the detector knows is named in most views,
mostly right; another kind is named in few, after one of the kinds that it looks like. Views are not independent, so
their number counts with a limit; and because a detector may be wrong in all views alike, its judgement is tempered.
How much a label is worth is estimated from the agreement of the labels of one group, without any truth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...world import kinds
from ...world.words import normalise
from ..encoders.probability import softmax
from ..encoders.vocabulary import Vocabulary
from .language_field import Group, Names

F64 = NDArray[np.float64]

NAMED = 0.6  # share of the views of a thing in which a detector that knows its kind names it
NAMED_STRANGE = 0.25  # the same of a thing whose kind it does not know
LOOK_ALIKES = 8.0  # labels that a thing of an unknown kind may be given
LABELS = 40.0  # labels that an error may give
COVERED = 0.6  # how well a label fits a kind that it covers without being its name: "chair" of an armchair
SILENCE = 0.3  # weight of a view without a label: things that are small or far are missed in many views alike
MOST_VIEWS = 8.0  # independent views that any number of views is worth
UNSEEN_VIEWS = 2.0  # views that a group without any mask is taken to have been seen in
RIGHT = 0.8  # share of right labels of a detector about which nothing is known
RIGHT_VIEWS = 5.0  # labels that this assumption is worth
TRUST = (0.3, 0.95)  # least and largest trust in a detector
OTHER = "another kind of thing"  # name of every kind that is not in question


@dataclass(frozen=True)
class Detector:
    """What is known of the detectors of a scene.

    Attributes:
        heard: every label that they gave to some group, sorted.
        right: estimated share of right labels, in (0, 1).
    """

    heard: tuple[str, ...]
    right: float

    @property
    def trust(self) -> float:
        """The probability that what the detector says of a group in all views together is right."""
        low, high = TRUST
        return min(max(self.right, low), high)


def detector_of(groups: Sequence[Group]) -> Detector | None:
    """The detectors that named the groups; None if none did.

    Two labels of one group agree with probability `right` squared, if errors seldom agree.
    """
    heard = sorted({name for g in groups for name, weight in g.votes if name and weight > 0})
    if not heard:
        return None
    agreeing, pairs = RIGHT**2 * RIGHT_VIEWS, RIGHT_VIEWS
    for group in groups:
        weights = np.array([w for name, w in group.votes if name])
        total = float(weights.sum())
        if total > 1:
            collision = (float((weights**2).sum()) - total) / (total**2 - total)
            agreeing += max(collision, 0.0) * min(total, MOST_VIEWS)
            pairs += min(total, MOST_VIEWS)
    return Detector(tuple(heard), float(np.sqrt(np.clip(agreeing / pairs, 0.01, 0.99))))


def canonical(label: str) -> str:
    """The name of the kind that a label means as a whole, or its own words: "couch" to "sofa", "cat" to "cat"."""
    kind = kinds.find(label)
    return kind.name if kind is not None else " ".join(normalise(label))


def fits(label: str, names: Sequence[str], vocabulary: Vocabulary) -> F64:
    """How well a label fits each name `[H]`: 1 for its own kind, less for kinds that it covers, else 0."""
    own = canonical(label)
    exact = vocabulary.covered(label)
    wide = vocabulary.covered(label, loose=True)
    sole = len(exact) == 1
    return np.array([
        1.0 if name == own or (sole and name in exact) else COVERED if name in wide else 0.0 for name in names
    ])  # fmt: skip


def log_likelihoods(groups: Sequence[Group], names: Sequence[str], vocabulary: Vocabulary, detector: Detector) -> F64:
    """Log-likelihood `[G, H]` of the votes of each group under each name, nats, up to a constant of each group."""
    fit = np.stack([fits(label, names, vocabulary) for label in detector.heard])  # [L, H]
    known = fit.max(axis=0) > 0
    right = detector.right
    said = np.where(known, NAMED * (right * fit + (1 - right) / LABELS), NAMED_STRANGE / LOOK_ALIKES)  # [L, H]
    silent = np.log(np.where(known, 1 - NAMED, 1 - NAMED_STRANGE))  # [H]
    row = {label: i for i, label in enumerate(detector.heard)}
    return np.stack([_of_votes(g.votes, np.log(said), silent, row) for g in groups])


def log_shares(groups: Sequence[Group], names: Sequence[str], vocabulary: Vocabulary, detector: Detector) -> F64:
    """Log-probability `[G, H]` of each name by the votes alone; the last name is `OTHER`.

    Votes that contradict each other speak for a kind that the detector does not know. They do not speak for any single
    name that was never heard: above the mean of all names, its share goes to `OTHER`.
    """
    share = softmax(log_likelihoods(groups, names[:-1], vocabulary, detector))
    heard = np.stack([fits(label, names[:-1], vocabulary) for label in detector.heard]).max(axis=0) > 0
    kept = np.where(heard, share, np.minimum(share, 1 / len(names)))
    rest = np.maximum(1 - kept.sum(axis=1, keepdims=True), 1e-12)
    return np.log(np.concatenate([kept, rest], axis=1))


def _of_votes(votes: Names, said: F64, silent: F64, row: dict[str, int]) -> F64:
    """Log-likelihood `[H]` of the votes of one group."""
    named = sum(weight for name, weight in votes if name)
    quiet = SILENCE * sum(weight for name, weight in votes if not name)
    total = named + quiet
    if total <= 0:
        result: F64 = UNSEEN_VIEWS * silent
        return result
    mean = quiet * silent + sum((weight * said[row[name]] for name, weight in votes if name), np.zeros(len(silent)))
    return np.asarray(mean / total * (MOST_VIEWS * total / (MOST_VIEWS + total)))
