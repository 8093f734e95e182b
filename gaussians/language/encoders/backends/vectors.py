"""Precomputed text vectors: `vectors:PATH`, names with one vector each and no model.

Layouts (see `vector_files`): `vectors:FOLDER` with `text.npy` and `names.json` or `names.txt`;
`vectors:TEXT.npy,NAMES.json`; `vectors:FILE.npz` or `vectors:FILE.safetensors` with both inside. Images cannot be
encoded, so the vectors of a scene must come from masks with vectors, or with labels, which are encoded as texts.

A phrase is known if its head noun is one of the names ("the small bikes": bicycle, if bicycle is a name) and the words
before it are colours, materials or other modifiers that do not change the kind. Names compete with each other; there
are no captions of non-objects.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ....errors import BackendError
from ....world import kinds as world
from ....world.spelling import did_you_mean
from ....world.words import normalise
from .. import checked_images, checked_texts
from ..calibration import Calibration, of_clip
from ..vector_files import Name, calibration_beside, read
from ..vocabulary import Vocabulary


def load(argument: str) -> Vectors:
    """Load the vectors of a folder, a file, or a pair of files.

    Raises:
        BackendError: no vectors are found, or names and vectors do not match.
    """
    if not argument:
        raise BackendError("name the vectors: vectors:FOLDER, vectors:FILE.npz or vectors:TEXT.npy,NAMES.json")
    names, text = read(argument)
    return wrap(names, text, calibration_beside(Path(argument).expanduser()))


def wrap(names: Sequence[Name], text: NDArray[np.floating], calibration: Calibration | None = None) -> Vectors:
    """An encoder around names and their text vectors `[T, D]` that are already in memory; rows need not be unit.

    Raises:
        BackendError: counts differ, a name occurs twice, or a row is zero or not finite.
    """
    rows = np.asarray(text)
    if rows.ndim != 2 or len(rows) != len(names) or not len(names):
        raise BackendError(f"{len(names)} names need as many text vectors, got an array of shape {list(rows.shape)}")
    rows = rows.astype(np.float64)
    norms = np.linalg.norm(rows, axis=1, keepdims=True)
    if not np.isfinite(rows).all() or not (norms > 0).all():
        raise BackendError("a text vector is zero or not finite; write the vectors again")
    return Vectors(vocabulary_of(names), (rows / norms).astype(np.float32), calibration or of_clip())


@dataclass(frozen=True, eq=False)
class Vectors:
    """Text vectors as an `Encoder`.

    Attributes:
        rows: `[T, D]` unit text vectors of the vocabulary's names, in their order.
    """

    vocabulary: Vocabulary
    rows: NDArray[np.float32]
    calibration: Calibration

    @cached_property
    def fingerprint(self) -> str:
        digest = hashlib.sha256(json.dumps(self.vocabulary.names).encode())
        digest.update(np.ascontiguousarray(self.rows).tobytes())
        return f"vectors-{digest.hexdigest()[:16]}"

    @property
    def dim(self) -> int:
        return int(self.rows.shape[1])

    @property
    def image_size(self) -> int:
        return 0  # there is no image tower

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        """As in `Encoder`; a phrase that covers several names gets the mean of their vectors.

        Raises:
            BackendError: the head noun of a phrase is not a name (`knows` is False then).
        """
        found = np.zeros((len(checked_texts(texts)), self.dim), dtype=np.float32)
        for row, phrase in zip(found, texts, strict=True):
            meant = sorted(self._row[name] for name in self.vocabulary.covered(phrase))
            if not meant:
                hint = did_you_mean(phrase, self.vocabulary.names)
                raise BackendError(
                    f"there is no vector for {phrase!r} among {len(self.rows)} names" + (hint and f"; {hint}")
                )
            mean = self.rows[meant].astype(np.float64).mean(axis=0)
            row[:] = mean / np.linalg.norm(mean)
        return found

    def encode_images(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        if not len(checked_images(images)):
            return np.zeros((0, self.dim), dtype=np.float32)
        raise BackendError(
            "precomputed vectors have no image tower; embed from masks that carry labels or vectors, "
            "or use the encoder that made them (open_clip:... or onnx:FOLDER)"
        )

    def unknown_words(self, text: str) -> tuple[str, ...]:
        spoken = normalise(text)
        head, meant = self.vocabulary.head(text)
        known = {*head, *self.vocabulary.modifiers} if meant else self.vocabulary.modifiers
        return tuple(dict.fromkeys(w for w in spoken if w not in known))

    def knows(self, text: str) -> bool:
        return bool(self.vocabulary.covered(text)) and not self.unknown_words(text)

    @cached_property
    def _row(self) -> dict[str, int]:
        return {name: i for i, name in enumerate(self.vocabulary.names)}


def vocabulary_of(names: Sequence[Name]) -> Vocabulary:
    """Names as kinds, with their synonyms and those that household words have for them ("bike" for bicycle)."""
    household = Vocabulary.household().within(world.table().kinds)
    kinds = {name: synonyms for name, *synonyms in names}
    if len(kinds) < len(names):
        twice = next(n for i, (n, *_) in enumerate(names) if n in [m for m, *_ in names[:i]])
        raise BackendError(f"the name {twice!r} occurs twice among the names of the vectors; list each name once")
    own = {normalise(phrase): name for name, *synonyms in reversed(names) for phrase in (*synonyms, name)}
    own |= {normalise(name): name for name, *_ in names}
    target = {}  # household kind to the name with the same meaning
    for kind, synonyms in household.kinds.items():
        meant = next((own[p] for p in map(normalise, (kind, *synonyms)) if p in own), None)
        if meant is not None:
            target[kind] = meant
            kinds[meant] = [*kinds[meant], *(p for p in (kind, *synonyms) if normalise(p) not in own)]
    broader = {
        term: tuple(dict.fromkeys(target[k] for k in below if k in target))
        for term, below in household.broader.items()
        if normalise(term) not in own
    }
    return Vocabulary(
        {name: tuple(dict.fromkeys(synonyms)) for name, synonyms in kinds.items()},
        {term: below for term, below in broader.items() if below},
        (),
        household.modifiers,
    )
