"""The probability that a group is what a phrase names, from all sources: pictures, detectors, size and support.

Each source gives every name a likelihood; their product, normalised over the names, is the posterior. Pictures and
detectors may be wrong as a whole, so their likelihoods are mixed with a constant by the trust in them: however sure one
of them is, it cannot outweigh another beyond its trust.

The trust in pictures is that of the scene, not of the group. An encoder names things surely where they are like those
it was trained with, and gives its names little probability elsewhere: over our own rooms, the mean probability of the
best name is 0.8 to 0.9, over captures 0.1 to 0.4. Where detectors named groups as well, agreement with them counts.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...world import kinds
from ...world.words import normalise
from ..encoders import Encoder
from ..encoders.calibration import SIZE_CAP
from ..encoders.probability import distribution, phrase_logits, size_evidence, softmax, why_unknown
from . import detectors, resting
from .language_field import MAX_NAMES, LanguageField, Names

F64 = NDArray[np.float64]

MOST_TRUST = 0.97  # in pictures: the embedded encoder names that share of whole things right that it was not trained on
AGREEMENT_PRIOR = 4.0  # groups named by detectors that the trust by confidence is worth
USUAL = 0.85  # confidence of an encoder of 81 names in our own rooms; that of others is told by their calibration
SURE_DETECTOR = 0.5  # probability by detectors alone from which a group tells whether pictures agree
ESTIMATED = 0.5  # weight of sizes by an estimated scale
SURE = 0.5  # posterior from which a name is confirmed in a scene whose pictures are not trusted
MOST_BELIEFS = 4  # kept with a field; more only where the scale of a scene is changed again and again
TRUSTED = (0.5, 0.9)  # trust in pictures at which the encoder's own threshold begins to confirm, and fully does


@dataclass(frozen=True, eq=False)
class Shares:
    """What each source says of one phrase.

    Attributes:
        total: `[G]` posterior.
        logs: `[T, 1 + R]` log-likelihoods by each source of the phrase and of its rivals; sources that say nothing are
            left out.
        rows: `[T]` the groups that any source has seen; 0 for the others.
    """

    total: F64
    logs: Mapping[str, F64]
    rows: NDArray[np.intp]

    @cached_property
    def sources(self) -> dict[str, F64]:
        """The probability `[G]` by each source alone, in [0, 1]."""
        found = {}
        for name, values in self.logs.items():
            found[name] = np.zeros(len(self.total))
            found[name][self.rows] = softmax(values)[:, 0]
        return found


@dataclass(frozen=True, eq=False)
class Belief:
    """The evidence about the names of all groups of a field. See `belief_of`.

    Attributes:
        field, encoder: the field, and the encoder of its vectors.
        metres: metres per unit as the scene says, None if unknown.
    """

    field: LanguageField
    encoder: Encoder
    metres: float | None

    @cached_property
    def detector(self) -> detectors.Detector | None:
        return detectors.detector_of(self.field.groups)

    @cached_property
    def pictured(self) -> tuple[str, ...]:
        """The names that pictures are compared with: kinds of the encoder, then its non-objects."""
        return (*self.encoder.vocabulary.names, *self.encoder.vocabulary.negatives)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Every name in question: those of `pictured`, then kinds that only detectors know, and any other kind."""
        heard = () if self.detector is None else self.detector.heard
        beyond = (detectors.canonical(label) for label in heard if not self.encoder.vocabulary.covered(label))
        other = () if self.detector is None else (detectors.OTHER,)
        return (*self.pictured, *dict.fromkeys(name for name in beyond if name not in self.pictured), *other)

    @cached_property
    def is_kind(self) -> NDArray[np.bool_]:
        """Whether each name `[H]` is a kind and not a non-object."""
        none = {*self.encoder.vocabulary.negatives, detectors.OTHER}
        return np.array([name not in none for name in self.names])

    @cached_property
    def seen(self) -> NDArray[np.bool_]:
        """Whether each group `[G]` has a vector."""
        return np.asarray(self.field.embeddings.any(axis=1))

    @cached_property
    def told(self) -> NDArray[np.bool_]:
        """Whether any source tells something of each group `[G]`: a picture, or a detector."""
        return self.seen | np.array([bool(g.votes) for g in self.field.groups], dtype=bool)

    @cached_property
    def rows(self) -> NDArray[np.intp]:
        """The groups `[T]` of which any source tells something."""
        return np.flatnonzero(self.told)

    @cached_property
    def heard(self) -> F64:
        """Log-likelihood `[G, H]` of the votes of detectors, not yet tempered."""
        if self.detector is None:
            return np.zeros((len(self.field.groups), len(self.names)))
        return detectors.log_shares(self.field.groups, self.names, self.encoder.vocabulary, self.detector)

    @cached_property
    def sized(self) -> F64:
        """Log-likelihood `[G, H]` of the sizes."""
        if self.scale is None:
            return np.zeros((len(self.field.groups), len(self.names)))
        known = size_evidence(self.encoder, self.field.boxes.sizes * self.scale)
        beyond = len(self.names) - len(self.pictured)
        neutral = np.full((len(known), beyond), -self.encoder.calibration.size_weight * SIZE_CAP / 3)
        return (1.0 if self.metres is not None else ESTIMATED) * np.concatenate([known, neutral], axis=1)

    @property
    def scale(self) -> float | None:
        """Metres per unit that sizes are read with: as given, else as estimated."""
        making = self.field.making
        return self.metres if self.metres is not None or making is None else making.scale

    @cached_property
    def rested(self) -> F64:
        """Log-likelihood `[G, H]` of what the groups rest on."""
        return resting.log_likelihoods(self.field.groups, self.names)

    @cached_property
    def trust(self) -> float:
        """Trust in pictures, from the confidence of the encoder and its agreement with detectors."""
        making = self.field.making
        if making is not None and making.trust is not None:
            return making.trust
        there = self._pictured_objects
        if not there.any() or not self.encoder.vocabulary.names:  # a graph whose things all have no name
            return MOST_TRUST
        share = distribution(self.encoder, self.field.embeddings[there])
        by_confidence = MOST_TRUST
        if self.encoder.calibration.rivals is None:  # an open vocabulary is trained on photographs of everything
            by_confidence = sharpened(self.confidence, self.encoder.calibration.confidence)
        agreed = self._agreement(there, share)
        mean = (AGREEMENT_PRIOR * by_confidence + float(agreed.sum())) / (AGREEMENT_PRIOR + len(agreed))
        return min(mean, MOST_TRUST)

    @property
    def confidence(self) -> float:
        """Mean probability of the best name by all but detectors, over the objects; larger ones weigh more.

        Sizes tell look-alikes apart where the scale is known: a plain cube is a box, a dishwasher or a loaf. With them
        the means of rooms of plain things and of captures lie further apart (0.7 to 0.95 and 0.1 to 0.4) than by
        pictures alone (0.45 to 0.9).
        """
        there = self._pictured_objects
        weight = np.sqrt([g.count for g, ok in zip(self.field.groups, there, strict=True) if ok])
        known = len(self.pictured)
        best = softmax(self._seen_logs(MOST_TRUST)[there, :known])[:, self.is_kind[:known]].max(axis=1)
        return float(np.average(best, weights=weight))

    @property
    def _pictured_objects(self) -> NDArray[np.bool_]:
        """Which groups `[G]` are objects with a picture."""
        own = [g.level == "object" and g.count > 0 for g in self.field.groups]
        return np.array(own, dtype=bool) & self.seen

    def _agreement(self, there: NDArray[np.bool_], share: F64) -> F64:
        """The probability that pictures give the name by detectors, for groups that detectors name surely."""
        if self.detector is None or not self.encoder.image_size:
            return np.zeros(0)
        by_detector = softmax(self.heard[there][:, : len(self.pictured)])
        best = by_detector.argmax(axis=1)
        sure = by_detector.max(axis=1) >= SURE_DETECTOR
        result: F64 = share[np.flatnonzero(sure), best[sure]]
        return result

    # -- phrases ----------------------------------------------------------------------------------------------------

    def shares(self, text: str, trusting: bool = False) -> Shares:
        """The posterior of a phrase against every name that it does not cover, and each source's own judgement.

        All are 0 for a phrase that neither the encoder nor a detector knows.

        Args:
            trusting: whether pictures are trusted as in a scene that the encoder knows.
        """
        meant = self.meant(text)
        known = why_unknown(self.encoder, text) is None
        if not known and not meant.any():
            return Shares(np.zeros(len(self.field.groups)), {}, self.rows)
        trust = max(self.trust, MOST_TRUST) if trusting else self.trust
        logs = {"picture": self._pictures(text, known, meant, trust)}
        if self.detector is not None:
            logs["detector"] = _tempered(softmax(_own_first(self.heard[self.rows], meant)), self.detector.trust)
        if self.scale is not None:
            logs["size"] = _own_first(self.sized[self.rows], meant)
        if any(g.rests for g in self.field.groups):
            logs["support"] = _own_first(self.rested[self.rows], meant)
        total = np.zeros(len(self.field.groups))
        total[self.rows] = softmax(np.sum(list(logs.values()), axis=0))[:, 0]
        return Shares(total, logs, self.rows)

    def meant(self, text: str) -> NDArray[np.bool_]:
        """Which names `[H]` a phrase covers."""
        covered = self.encoder.vocabulary.covered(text)
        own, kind = detectors.canonical(text), kinds.of(text)
        family = kinds.table().families.get(" ".join(normalise(text)), ())
        inner = {own, *family, *([kind.name] if kind is not None else [])}
        beyond = self.names[len(self.pictured) :]
        return np.array([*(n in covered for n in self.pictured), *(n in inner for n in beyond)], dtype=bool)

    def _pictures(self, text: str, known: bool, meant: NDArray[np.bool_], trust: float) -> F64:
        """Tempered log-likelihood `[T, 1 + R]` by pictures of the phrase and of the names that it does not cover."""
        count, vectors = len(self.pictured), self.field.embeddings[self.rows]
        rivals = ~meant[:count]
        beyond = int((~meant[count:]).sum())
        if known:
            share = softmax(phrase_logits(self.encoder, text, vectors, rivals))
        else:  # a kind that only detectors know: neither for nor against it
            among = softmax(phrase_logits(self.encoder, self.pictured[0], vectors, rivals)[:, 1:])
            share = np.concatenate([np.full((len(among), 1), 1 / count), among], axis=1)
        share = np.concatenate([share, np.full((len(share), beyond), 1 / count)], axis=1)
        constant = np.full(share.shape, 1 / count)
        constant[:, 0] = max(int(meant.sum()), 1) / count
        mixed = trust * share + (1 - trust) * constant
        return np.log(np.where(self.seen[self.rows][:, None], mixed, constant))

    # -- names ------------------------------------------------------------------------------------------------------

    @cached_property
    def joint(self) -> F64:
        """Posterior `[G, H]` of every name for each group; rows sum to one."""
        return self._joint(self.trust)

    @cached_property
    def joint_trusting(self) -> F64:
        """`joint` as if pictures were trusted as in a scene that the encoder knows."""
        return self._joint(MOST_TRUST)

    def _joint(self, trust: float) -> F64:
        logs = self._seen_logs(trust)
        if self.detector is not None:
            logs = logs + _tempered(softmax(self.heard), self.detector.trust)
        return softmax(logs)

    def _seen_logs(self, trust: float) -> F64:
        """Log-likelihood `[G, H]` of every name by pictures, sizes and support."""
        return _tempered(self._pictured_shares, trust, len(self.pictured)) + self.sized + self.rested

    @cached_property
    def _pictured_shares(self) -> F64:
        """Probability `[G, H]` of every name by pictures alone; even where none was taken, or for names beyond them."""
        share = distribution(self.encoder, self.field.embeddings)
        share = np.where(self.seen[:, None], share, 1 / share.shape[1])
        beyond = len(self.names) - len(self.pictured)
        return np.concatenate([share, np.full((len(share), beyond), 1 / len(self.pictured))], axis=1)

    def of_kinds(self, kinds: frozenset[str], trusting: bool = False) -> F64:
        """Posterior `[G]` that each group is of any of some kinds; 0 for groups that no source has seen."""
        wanted = np.array([name in kinds for name in self.names], dtype=bool) & self.is_kind
        total = (self.joint_trusting if trusting else self.joint)[:, wanted].sum(axis=1)
        return np.where(self.told, total, 0.0)

    def named(self) -> list[Names]:
        """The most probable kinds of each group with their posteriors, highest first; none for structure and parts."""
        total = np.where(self.is_kind, self.joint, 0.0)
        order = np.argsort(-total, axis=1, kind="stable")[:, :MAX_NAMES]
        return [
            tuple((self.names[k], float(row[k])) for k in best if row[k] > 0) if g.level == "object" and told else ()
            for g, told, best, row in zip(self.field.groups, self.told, order.tolist(), total, strict=True)
        ]

    @property
    def confirms(self) -> float:
        """The posterior from which a name is confirmed, and not only likely.

        Where pictures are trusted it is the encoder's threshold, which allows for near-synonyms.
        """
        low, high = TRUSTED
        sure = min(max((self.trust - low) / (high - low), 0.0), 1.0)
        threshold = self.encoder.calibration.threshold
        return threshold + (max(SURE, threshold) - threshold) * (1 - sure)


def belief_of(field: LanguageField, encoder: Encoder, metres: float | None) -> Belief:
    """The evidence about the names of a field, computed once for each field, encoder and scale.

    The field itself holds it, so both are freed together.
    """
    key = (encoder.fingerprint, metres)
    if key not in field.beliefs:
        if len(field.beliefs) >= MOST_BELIEFS:
            field.beliefs.clear()
        field.beliefs[key] = Belief(field, encoder, metres)
    belief: Belief = field.beliefs[key]
    return belief


def sharpened(confidence: float, usual: float) -> float:
    """Twice the log-odds of a confidence: an encoder is overconfident the more, the less it is right.

    Args:
        usual: the confidence of the encoder where it knows things; there the result is that of `USUAL`.
    """
    odds = confidence / max(1 - confidence, 1e-12) * (1 - usual) / usual * USUAL / (1 - USUAL)
    return odds**2 / (1 + odds**2)


def _own_first(logs: F64, meant: NDArray[np.bool_]) -> F64:
    """Logs `[G, 1 + R]` of the best of the meant names, or of a neutral one if none is, followed by the others."""
    own = logs[:, meant].max(axis=1) if meant.any() else np.log(np.exp(logs).mean(axis=1))
    return np.concatenate([own[:, None], logs[:, ~meant]], axis=1)


def _tempered(share: F64, trust: float, count: int | None = None) -> F64:
    """Log of probabilities `[G, K]` mixed with a constant by the distrust in them."""
    result: F64 = np.log(trust * share + (1 - trust) / (count or share.shape[1]))
    return result
