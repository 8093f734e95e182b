"""How far to believe a source of masks: log-odds of "one object" for what it says, estimated without any truth.

Agreement across views comes first: the share of the variance of a source's statements that lies between pairs of
regions and not between views of one pair (intraclass correlation). It gives the rate at which one view errs. The
statements of n views are as reliable as the formula of Spearman and Brown says, which stays below one however many
views repeat each other.

A source that leaves pixels out chooses what an object is, and agreement is all there is to estimate. One that divides
whole pictures does not: its regions may be patches of objects, or several objects. What "together" and "apart" mean to
it is estimated by expectation maximisation with geometry's probabilities as prior (Dawid & Skene 1979).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .statements import Counts, Cover

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

KNOTS = 9  # values of the Jaccard index between which log-odds are interpolated
ROUNDS = 30  # of expectation maximisation
PRIOR_BOUND = 2.0  # of geometry's log-odds as prior: it may be wrong one time in eight however sure it is
PSEUDO = 4.0  # pairs that say nothing, added to each estimate
MOST = 7.0  # bound of a source's log-odds
REPEATS = 2.0  # views whose log-odds add up; more views of one pair err alike
MAX_AGREEMENT = 0.9
PARTITION = 0.95  # share of the regions in masks from which a source divides whole pictures


@dataclass(frozen=True, eq=False)
class Reliability:
    """What the statements of one source are worth.

    Attributes:
        covered: `[KNOTS]` log-odds of "one object" at Jaccard indices from 0 to 1, where masks cover both regions.
        alone: `[KNOTS]` the same where one region is in no mask.
        agreement: intraclass correlation of the statements of one view, in (0, 1).
    """

    covered: F64
    alone: F64
    agreement: float

    def log_odds(self, counts: Counts, size: F64 | float = 1.0) -> F64:
        """Log-odds of "one object" for pairs of regions; 0 where no view says anything.

        Args:
            size: number of leaf pairs that the counts are summed over.
        """
        return self.judge(counts, size)[0]

    def judge(self, counts: Counts, size: F64 | float = 1.0) -> tuple[F64, F64]:
        """The same, and the certainty with which the source speaks of each pair, in [0, 1]."""
        index, alone, certainty = describe(counts, size, self.agreement)
        at = np.linspace(0, 1, KNOTS)
        result: F64 = certainty * (
            (1 - alone) * np.interp(index, at, self.covered) + alone * np.interp(index, at, self.alone)
        )
        return result, certainty


def describe(counts: Counts, size: F64 | float, agreement: float) -> tuple[F64, F64, F64]:
    """Jaccard index, share of masks without a counterpart, and certainty, of some pairs."""
    either = np.maximum(counts.either, 1e-9)
    index = np.clip(counts.common / either, 0, 1).astype(np.float64)
    alone = np.clip(counts.alone / np.maximum(either - counts.common, 1e-9), 0, 1).astype(np.float64)
    views = np.maximum(counts.views / size, 0).astype(np.float64)
    return index, alone, views * agreement / np.maximum(1 + (views - 1) * agreement, 1e-9)


def agreement_of(cover: Cover, first: I64, second: I64) -> float:
    """Intraclass correlation of what single views say about pairs: 1 if views never contradict each other."""
    index, weight = cover.by_view(first, second)
    total = weight.sum(axis=1)
    several = (weight > 0.25).sum(axis=1) >= 2
    if several.sum() < 2:
        return 0.0
    index, weight, total = index[several], weight[several], total[several]
    mean = (weight * index).sum(axis=1) / total
    # unbiased for weights: a mean over n views leaves (n - 1) / n of the variance within
    free = np.maximum(total - (weight**2).sum(axis=1) / total, 1e-9)
    within = float((weight * (index - mean[:, None]) ** 2).sum() / free.sum())
    middle = float((weight * index).sum() / total.sum())
    whole = float((weight * (index - middle) ** 2).sum() / total.sum())
    return float(np.clip(1 - within / max(whole, 1e-9), 0, MAX_AGREEMENT))


def estimate(covers: Sequence[Cover], first: I64, second: I64, prior: F64) -> list[Reliability]:
    """The reliability of each source.

    Args:
        first, second: `[E]` pairs of regions about which geometry has an opinion.
        prior: `[E]` geometry's log-odds that they are one object.
    """
    said = []
    for one in covers:
        agreement = agreement_of(one, first, second)
        index, alone, certainty = describe(one.between(first, second), 1.0, agreement)
        said.append((agreement, certainty, _weights(index, alone), chooses_objects(one)))
    belief = np.clip(prior, -PRIOR_BOUND, PRIOR_BOUND)
    chosen = [t * _table_of_objects(a) for a, _, _, t in said]
    tables = chosen
    for _ in range(ROUNDS if any(t < 1 for *_, t in said) else 0):
        total = belief + sum((c * (w @ t) for (_, c, w, _), t in zip(said, tables, strict=True)), np.zeros(len(belief)))
        same = 1 / (1 + np.exp(-np.clip(total, -30, 30)))
        tables = [k + (1 - t) * _table(w, c, same) for k, (_, c, w, t) in zip(chosen, said, strict=True)]
    return [Reliability(t[:KNOTS], t[KNOTS:], a) for (a, _, _, _), t in zip(said, tables, strict=True)]


def chooses_objects(cover: Cover) -> float:
    """1 for a source that leaves pixels out and so chooses what an object is, 0 for one that divides whole pictures."""
    share = float(cover.covered.sum()) / max(float(cover.seen.sum()), 1e-9)
    return float(np.clip((PARTITION - share) / 0.2, 0, 1))


def _table_of_objects(agreement: float) -> F64:
    """Log-odds at each knot for masks of objects, of which each view errs as often as agreement says.

    Two statements that are each wrong with probability e correlate by (1 - 2e)².
    """
    wrong = (1 - np.sqrt(agreement)) / 2
    most = REPEATS * float(np.log((1 - wrong) / wrong))
    return np.tile(np.linspace(-most, most, KNOTS), 2)


def _weights(index: F64, alone: F64) -> F64:
    """Weights `[E, 2 * KNOTS]` by which each pair lies at each knot, of both kinds."""
    place = index * (KNOTS - 1)
    low = np.minimum(place.astype(np.int64), KNOTS - 2)
    rows = np.arange(len(index))
    hat = np.zeros((len(index), KNOTS))
    hat[rows, low] = 1 - (place - low)
    hat[rows, low + 1] = place - low
    return np.concatenate([hat * (1 - alone)[:, None], hat * alone[:, None]], axis=1)


def _table(weights: F64, certainty: F64, same: F64) -> F64:
    """Log-odds at each knot, rising with the Jaccard index."""
    one, two = weights.T @ (certainty * same), weights.T @ (certainty * (1 - same))
    mass = one + two
    spare = PSEUDO * mass / max(float(mass.sum()), 1e-9) + 1e-6
    one, two = one + spare, two + spare
    odds = np.log(one / one.sum()) - np.log(two / two.sum())
    halves = [_rising(o, m) for o, m in zip(np.split(odds, 2), np.split(mass + 1e-6, 2), strict=True)]
    return np.clip(np.concatenate(halves), -MOST, MOST)


def _rising(values: F64, weight: F64) -> F64:
    """The nearest sequence that never falls, by pooling adjacent violators."""
    blocks: list[tuple[float, float, int]] = []
    for v, w in zip(values.tolist(), weight.tolist(), strict=True):
        blocks.append((v, w, 1))
        while len(blocks) > 1 and blocks[-2][0] > blocks[-1][0]:
            (a, wa, na), (b, wb, nb) = blocks[-2:]
            blocks[-2:] = [((a * wa + b * wb) / (wa + wb), wa + wb, na + nb)]
    return np.repeat([b[0] for b in blocks], [b[2] for b in blocks])
