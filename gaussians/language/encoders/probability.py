"""From similarity to "how sure are we that this thing is a t": one frozen rule for every scene and every query.

A raw cosine says little: it depends on the phrase and is never low for something absent. So a phrase competes, for each
thing on its own, with the names of all other kinds and with captions of what is not one whole object; the share it wins
is a probability. Nothing is normalised over the things of a scene, so an absent object scores low everywhere.

Models that read any name have vocabularies of any length. There the rivals together weigh the same however many they
are (`Calibration.rivals`), so that one threshold serves 40 names and 1,203: the odds are how much better the phrase
fits than the average name does, times a fixed prior. The average over names does what canonical phrases ("object",
"stuff") do elsewhere, and needs no text tower. A threshold well under one half leaves room for near-synonyms: "chair"
is found though "armchair" took half of its share.

Knows vectors, names and sizes. Refuses to know scenes, and never tunes itself on the scene it is asked about.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ...errors import BackendError
from ...world.spelling import did_you_mean
from . import Encoder
from .calibration import SIZE_CAP, Array


def doubt(encoder: Encoder, text: str) -> str | None:
    """Why `probability` is 0 for this phrase whatever the scene holds, in a sentence; None if it is understood."""
    unknown = encoder.unknown_words(text)
    if unknown:
        said = ", ".join(repr(w) for w in unknown)
        hint = did_you_mean(text, encoder.vocabulary.names, most=2, likeness=0.75)
        return f"the encoder does not know the word{'s' if len(unknown) > 1 else ''} {said}" + (hint and f" ({hint})")
    return None if encoder.knows(text) else "the phrase holds no word that names a thing"


def probability(
    encoder: Encoder, text: str, vectors: NDArray[np.floating], sizes: NDArray[np.floating] | None = None
) -> Array:
    """How sure the encoder is that each thing is a `text`.

    The phrase competes with all kinds it does not itself cover and with the captions of non-objects, in a softmax at
    the encoder's calibrated scale, where all rivals together weigh what its calibration says. A phrase with a word the
    encoder does not know gets 0 everywhere (`doubt` says why).

    Args:
        vectors: `[G, D]` mean image vectors of things; zero rows (never seen) get 0. They need not be unit.
        sizes: `[G, 3]` extents in metres, two level sides and the height; rows with NaN, or None, leave size out.

    Returns:
        `[G]` float64 in [0, 1]; compare with `encoder.calibration.threshold`.

    Raises:
        BackendError: the vectors have another width than the encoder's.
    """
    units, seen = _units(encoder, vectors)
    if doubt(encoder, text) is not None:
        return np.zeros(len(units))
    names, anchors = _anchors(encoder)  # type: ignore[arg-type]  # identity is what it is cached by
    covered = encoder.vocabulary.covered(text)
    asked = _phrase(encoder, text)  # type: ignore[arg-type]  # likewise
    rivals = np.array([name not in covered for name in names])
    scale = encoder.calibration.scale
    evidence = _size_evidence(encoder, names, sizes, len(units))
    own_size = evidence[:, ~rivals].max(axis=1) if covered else evidence.max(axis=1)
    own = scale * (units @ asked) + own_size
    against = (scale * (units @ anchors.T) + evidence)[:, rivals]
    if encoder.calibration.rivals is not None and rivals.any():
        against = against + np.log(encoder.calibration.rivals / rivals.sum())
    logits = np.concatenate([own[:, None], against], axis=1)
    return np.where(seen, _softmax(logits)[:, 0], 0.0)


def distribution(encoder: Encoder, vectors: NDArray[np.floating], sizes: NDArray[np.floating] | None = None) -> Array:
    """`[G, K + negatives]`: for each thing the share of each canonical name, kinds first, then non-objects, in the
    vocabulary's order; rows that were never seen are 0. Arguments as for `probability`."""
    units, seen = _units(encoder, vectors)
    names, anchors = _anchors(encoder)  # type: ignore[arg-type]  # identity is what it is cached by
    evidence = _size_evidence(encoder, names, sizes, len(units))
    return np.where(seen[:, None], _softmax(encoder.calibration.scale * (units @ anchors.T) + evidence), 0.0)


def labels(
    encoder: Encoder, vectors: NDArray[np.floating], sizes: NDArray[np.floating] | None = None
) -> list[tuple[str, float]]:
    """For each thing the kind it most likely is and how likely that is, among all kinds and non-objects; `[G]`.

    Rows that were never seen get `("", 0.0)`.
    """
    kinds = encoder.vocabulary.names
    share = distribution(encoder, vectors, sizes)
    best = share[:, : len(kinds)].argmax(axis=1)
    return [(kinds[k], float(row[k])) if row.any() else ("", 0.0) for k, row in zip(best, share, strict=True)]


def wholeness(encoder: Encoder, vectors: NDArray[np.floating]) -> Array:
    """`[G]`: how sure the encoder is that each thing is one whole object, not a part, a merge or a piece of room."""
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
    """Text vector `[D]` of a phrase that was asked; people ask for the same things again and again."""
    return encoder.encode_text([text]).astype(np.float64)[0]


def _size_evidence(encoder: Encoder, names: tuple[str, ...], sizes: NDArray[np.floating] | None, count: int) -> Array:
    """`[G, K + negatives]` nats that the measured size adds to each name; zero where the size is not known."""
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
    """Of `[G, 3]` float64 sizes as bytes: every phrase that is asked of a scene meets the same sizes."""
    rule = encoder.calibration
    measured = np.frombuffer(sizes).reshape(-1, 3)
    evidence = np.zeros((len(measured), len(names)))
    usable = np.isfinite(measured).all(axis=1) & (measured > 0).all(axis=1)
    for column, name in enumerate(names):
        if name in rule.sizes:
            evidence[usable, column] = rule.sizes[name].log_likelihood(measured[usable])
        else:  # non-objects come in every size: as likely as a kind of middling fit
            evidence[usable, column] = -SIZE_CAP / 3
    return rule.size_weight * evidence


def _units(encoder: Encoder, vectors: NDArray[np.floating]) -> tuple[Array, NDArray[np.bool_]]:
    """Unit rows `[G, D]` and which rows were not zero `[G]`."""
    rows = np.asarray(vectors, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != encoder.dim:
        raise BackendError(
            f"expected vectors of shape [G, {encoder.dim}], got {list(rows.shape)}; embed the scene again"
        )
    norms = np.linalg.norm(rows, axis=1)
    seen = norms > 1e-8
    return rows / np.where(seen, norms, 1.0)[:, None], seen


def _softmax(logits: Array) -> Array:
    """Over the last axis, without overflow."""
    shifted = np.exp(logits - logits.max(axis=-1, keepdims=True))
    result: Array = shifted / shifted.sum(axis=-1, keepdims=True)
    return result
