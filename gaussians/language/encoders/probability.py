"""The probability that a group is what a phrase names, from similarities: one fixed rule for all scenes and queries.

A raw cosine is not a usable score: its level depends on the phrase and it is not low for absent objects. So the phrase
competes, for each group separately, with the names of all other kinds and with captions of non-objects in a softmax.
Nothing is normalised over the groups of a scene, so an absent object scores low everywhere, and nothing is fitted to
the scene.

Open-vocabulary models have vocabularies of any length. For them the total weight of the rivals is constant
(`Calibration.rivals`), so that one threshold serves 40 names and 1,203: the odds are the ratio of the phrase's fit to
the mean fit of the names, times a fixed prior. The mean over names replaces canonical phrases ("object", "stuff"), and
needs no text tower. A threshold well below one half allows for near-synonyms: "chair" is found although "armchair"
takes half of its share.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ...errors import BackendError
from ...world.spelling import did_you_mean
from . import Encoder
from .calibration import SIZE_CAP, Array


def why_unknown(encoder: Encoder, text: str) -> str | None:
    """Why `probability` is 0 for this phrase in every scene, as a clause; None if the encoder knows the phrase."""
    unknown = encoder.unknown_words(text)
    if unknown:
        said = ", ".join(repr(w) for w in unknown)
        hint = did_you_mean(text, encoder.vocabulary.names, most=2, likeness=0.75)
        return f"the encoder does not know the word{'s' if len(unknown) > 1 else ''} {said}" + (hint and f" ({hint})")
    return None if encoder.knows(text) else "the phrase holds no word that names a thing"


def probability(
    encoder: Encoder, text: str, vectors: NDArray[np.floating], sizes: NDArray[np.floating] | None = None
) -> Array:
    """The probability that each group is a `text`.

    The phrase competes with all kinds that it does not cover and with the captions of non-objects, in a softmax at the
    encoder's calibrated scale and with the calibrated total weight of the rivals. A phrase with a word that the encoder
    does not know gets 0 everywhere (`why_unknown` gives the reason).

    Args:
        vectors: `[G, D]` mean image vectors of groups, of any norm; zero rows (not rendered) get 0.
        sizes: `[G, 3]` extents in metres, two level sides and the height; NaN rows, or None, ignore the size.

    Returns:
        `[G]` float64 in [0, 1], to be compared with `encoder.calibration.threshold`.

    Raises:
        BackendError: the width of the vectors is not the encoder's.
    """
    units, seen = _units(encoder, vectors)
    if why_unknown(encoder, text) is not None:
        return np.zeros(len(units))
    names, _ = _anchors(encoder)  # type: ignore[arg-type]  # identity is what it is cached by
    covered = encoder.vocabulary.covered(text)
    rivals = np.array([name not in covered for name in names])
    evidence = _size_evidence(encoder, names, sizes, len(units))
    own_size = evidence[:, ~rivals].max(axis=1) if covered else evidence.max(axis=1)
    logits = phrase_logits(encoder, text, vectors, rivals)
    logits[:, 0] += own_size
    logits[:, 1:] += evidence[:, rivals]
    return np.where(seen, softmax(logits)[:, 0], 0.0)


def phrase_logits(encoder: Encoder, text: str, vectors: NDArray[np.floating], rivals: NDArray[np.bool_]) -> Array:
    """Logits `[G, 1 + R]` of a known phrase and of its rivals for each group, by the pictures alone.

    Args:
        rivals: `[K + negatives]`, which of the canonical names and non-objects compete with the phrase.
    """
    units, _ = _units(encoder, vectors)
    _, anchors = _anchors(encoder)  # type: ignore[arg-type]  # identity is what it is cached by
    asked = _phrase(encoder, text)  # type: ignore[arg-type]  # likewise
    scale = encoder.calibration.scale
    against = scale * (units @ anchors[rivals].T)
    if encoder.calibration.rivals is not None and rivals.any():
        against = against + np.log(encoder.calibration.rivals / rivals.sum())
    return np.concatenate([scale * (units @ asked)[:, None], against], axis=1)


def distribution(encoder: Encoder, vectors: NDArray[np.floating], sizes: NDArray[np.floating] | None = None) -> Array:
    """Probability `[G, K + negatives]` of each canonical name for each group; zero rows for groups not rendered.

    Kinds come first, then non-objects, in the order of the vocabulary. Arguments as for `probability`.
    """
    units, seen = _units(encoder, vectors)
    names, anchors = _anchors(encoder)  # type: ignore[arg-type]  # identity is what it is cached by
    evidence = _size_evidence(encoder, names, sizes, len(units))
    return np.where(seen[:, None], softmax(encoder.calibration.scale * (units @ anchors.T) + evidence), 0.0)


def names(
    encoder: Encoder, vectors: NDArray[np.floating], sizes: NDArray[np.floating] | None = None, most: int = 1
) -> list[tuple[tuple[str, float], ...]]:
    """The most probable kinds of each group with their probabilities among all kinds and non-objects, highest first.

    Groups that were not rendered get none.
    """
    kinds = encoder.vocabulary.names
    share = distribution(encoder, vectors, sizes)
    order = np.argsort(-share[:, : len(kinds)], axis=1, kind="stable")[:, :most]
    return [
        tuple((kinds[k], float(row[k])) for k in best) if row.any() else ()
        for best, row in zip(order.tolist(), share, strict=True)
    ]


def labels(
    encoder: Encoder, vectors: NDArray[np.floating], sizes: NDArray[np.floating] | None = None
) -> list[tuple[str, float]]:
    """The most probable kind of each group and its probability, G pairs; `("", 0.0)` for groups not rendered."""
    return [found[0] if found else ("", 0.0) for found in names(encoder, vectors, sizes)]


def wholeness(encoder: Encoder, vectors: NDArray[np.floating]) -> Array:
    """Probability `[G]` that each group is one whole object, not a part, several objects or a piece of the room."""
    kinds = len(encoder.vocabulary.names)
    whole: Array = distribution(encoder, vectors)[:, :kinds].sum(axis=1)
    return whole


@lru_cache(maxsize=8)
def _anchors(encoder: Encoder) -> tuple[tuple[str, ...], Array]:
    """Names of kinds and non-objects, and their text vectors `[K + negatives, D]`."""
    names = (*encoder.vocabulary.names, *encoder.vocabulary.negatives)
    return names, encoder.encode_text(list(names)).astype(np.float64)


@lru_cache(maxsize=1024)
def _phrase(encoder: Encoder, text: str) -> Array:
    """Text vector `[D]` of a phrase, cached because queries repeat."""
    return encoder.encode_text([text]).astype(np.float64)[0]


def size_evidence(encoder: Encoder, sizes: NDArray[np.floating]) -> Array:
    """Log-likelihood `[G, K + negatives]` of measured sizes `[G, 3]` in metres under each name; see `probability`."""
    names, _ = _anchors(encoder)  # type: ignore[arg-type]  # identity is what it is cached by
    return _size_evidence(encoder, names, sizes, len(sizes))


def _size_evidence(encoder: Encoder, names: tuple[str, ...], sizes: NDArray[np.floating] | None, count: int) -> Array:
    """Log-likelihood `[G, K + negatives]` of the measured size under each name, nats; zero where it is unknown."""
    rule = encoder.calibration
    evidence = np.zeros((count, len(names)))
    if sizes is None or rule.size_weight == 0 or not rule.sizes or not count:
        return evidence
    measured = np.asarray(sizes, dtype=np.float64)
    if measured.shape != (count, 3):
        raise BackendError(f"sizes must have shape [{count}, 3], got {list(measured.shape)}")
    return _evidence_of(encoder, names, measured.tobytes())  # type: ignore[arg-type]  # as for the anchors


@lru_cache(maxsize=8)
def _evidence_of(encoder: Encoder, names: tuple[str, ...], sizes: bytes) -> Array:
    """`_size_evidence` of sizes `[G, 3]` float64 as bytes, cached because all queries on a scene share the sizes."""
    rule = encoder.calibration
    measured = np.frombuffer(sizes).reshape(-1, 3)
    evidence = np.zeros((len(measured), len(names)))
    usable = np.isfinite(measured).all(axis=1) & (measured > 0).all(axis=1)
    for column, name in enumerate(names):
        if name in rule.sizes:
            evidence[usable, column] = rule.sizes[name].log_likelihood(measured[usable])
        else:  # non-objects have any size: as probable as a kind that fits moderately
            evidence[usable, column] = -SIZE_CAP / 3
    return rule.size_weight * evidence


def _units(encoder: Encoder, vectors: NDArray[np.floating]) -> tuple[Array, NDArray[np.bool_]]:
    """Unit rows `[G, D]` and whether a row is not zero `[G]`."""
    rows = np.asarray(vectors, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != encoder.dim:
        raise BackendError(
            f"expected vectors of shape [G, {encoder.dim}], got {list(rows.shape)}; embed the scene again"
        )
    norms = np.linalg.norm(rows, axis=1)
    seen = norms > 1e-8
    return rows / np.where(seen, norms, 1.0)[:, None], seen


def softmax(logits: Array) -> Array:
    """The softmax over the last axis."""
    shifted = np.exp(logits - logits.max(axis=-1, keepdims=True))
    result: Array = shifted / shifted.sum(axis=-1, keepdims=True)
    return result
