"""Variants of an encoder with the same vectors: with a cache of phrases, or with another calibration rule."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ...gaussians.language.encoders import Encoder
from .cases import Case


class _Variant:
    """Hands everything on to the encoder it was made from, but for what is exchanged; phrases are encoded once."""

    def __init__(self, encoder: Encoder, **exchanged: Any) -> None:
        self._encoder = encoder
        self._known: dict[str, NDArray[np.float32]] = {}
        vars(self).update(exchanged)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._encoder, name)

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        new = [t for t in dict.fromkeys(texts) if t not in self._known]
        if new:
            self._known.update(zip(new, self._encoder.encode_text(new), strict=True))
        return np.stack([self._known[t] for t in texts])


def remembering(encoder: Encoder) -> Encoder:
    """The encoder, encoding each phrase once: what a query costs "after the text is encoded"."""
    return cast(Encoder, _Variant(encoder))


def with_threshold(encoder: Encoder, threshold: float) -> Encoder:
    """The encoder under another threshold."""
    return cast(Encoder, _Variant(encoder, calibration=replace(encoder.calibration, threshold=threshold)))


def forgetful(case: Case) -> Case:
    """The case with none of the answers that its field keeps: these are kept by the encoder's fingerprint, which
    variants of one encoder share."""
    assert case.scene.language is not None
    return replace(case, scene=case.scene.replace(language=replace(case.scene.language)))


def without_size(encoder: Encoder) -> Encoder:
    """The encoder without the term of the measured size."""
    return cast(Encoder, _Variant(encoder, calibration=replace(encoder.calibration, size_weight=0.0)))


def without_negatives(encoder: Encoder) -> Encoder:
    """The encoder without the captions of what is no whole object."""
    return cast(Encoder, _Variant(encoder, vocabulary=replace(encoder.vocabulary, negatives=())))
