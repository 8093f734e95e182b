"""The encoder shipped with the package: a small CLIP trained on our own renders, run by onnxruntime on one CPU thread.

Its folder holds `image.onnx` (input uint8 images, with preprocessing), `text.onnx` (input word ids), `words.json` (the
finite word list and the vocabulary) and `calibration.json`. `python -m scenewright.training` writes such folders.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....errors import BackendError
from ....world.words import normalise, plural
from .. import checked_images, checked_texts, weights_folder
from ..calibration import Calibration
from ..sessions import open_session, read_object
from ..vocabulary import Vocabulary

_WEIGHTS = ("image.onnx", "text.onnx", "words.json")  # the files that vectors depend on; the calibration is not one
_ADVICE = "reinstall scenewright or train again"
_BATCH = 64  # images at a time, to bound memory


def load(argument: str = "") -> Embedded:
    """The shipped encoder, or the one in folder `argument`.

    Raises:
        BackendError: files are missing or damaged.
    """
    folder = Path(argument).expanduser() if argument else weights_folder()
    missing = [name for name in (*_WEIGHTS, "calibration.json") if not (folder / name).is_file()]
    if missing:
        raise BackendError(
            f"no embedded encoder in {folder}: {', '.join(missing)} missing; "
            "give a folder that `python -m scenewright.training --out` wrote, or reinstall scenewright"
        )
    return Embedded(folder)


@dataclass(frozen=True, eq=False)
class Embedded:
    """The shipped model as an `Encoder`; files are read on first use."""

    folder: Path

    @cached_property
    def fingerprint(self) -> str:
        digest = hashlib.sha256()
        for name in _WEIGHTS:
            content = (self.folder / name).read_bytes()
            digest.update(f"{name}:{len(content)};".encode())
            digest.update(content)
        return f"embedded-{digest.hexdigest()[:16]}"

    @cached_property
    def dim(self) -> int:
        return int(self._words["dim"])

    @cached_property
    def image_size(self) -> int:
        return int(self._words["image_size"])

    @cached_property
    def vocabulary(self) -> Vocabulary:
        return Vocabulary.trained(self._words["vocabulary"])

    @cached_property
    def calibration(self) -> Calibration:
        return Calibration.from_json(read_object(self.folder / "calibration.json", _ADVICE))

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        rows = checked_texts(texts)
        if not rows:
            return np.zeros((0, self.dim), dtype=np.float32)
        tokens = tokenise(rows, self._index, int(self._words["length"]))
        return _unit(self._text_session.run(None, {"tokens": tokens})[0])

    def encode_images(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        pictures = checked_images(images)
        if not len(pictures):
            return np.zeros((0, self.dim), dtype=np.float32)
        pictures = _resampled(pictures, self.image_size)
        parts = [
            self._image_session.run(None, {"images": pictures[i : i + _BATCH]})[0]
            for i in range(0, len(pictures), _BATCH)
        ]
        return _unit(np.concatenate(parts))

    def unknown_words(self, text: str) -> tuple[str, ...]:
        return tuple(dict.fromkeys(w for w in normalise(text) if w not in self._index))

    def knows(self, text: str) -> bool:
        return bool(normalise(text)) and not self.unknown_words(text)

    @cached_property
    def _words(self) -> dict[str, Any]:
        return read_object(self.folder / "words.json", _ADVICE)

    @cached_property
    def _index(self) -> dict[str, int]:
        """Row of each trained word; 0 is padding. Its plural finds it too: a model may have been trained on a form that
        is no singular ("clothe")."""
        trained = {word: i + 1 for i, word in enumerate(self._words["words"])}
        return {plural(word): i for word, i in trained.items()} | trained

    @cached_property
    def _image_session(self) -> Any:
        return open_session(self.folder / "image.onnx", _ADVICE, threads=1)

    @cached_property
    def _text_session(self) -> Any:
        return open_session(self.folder / "text.onnx", _ADVICE, threads=1)


def tokenise(texts: list[str], index: dict[str, int], length: int) -> NDArray[np.int64]:
    """Word ids `[T, length]`, padded with 0 on the left so that the head noun is always last.

    Unknown words are left out; of longer phrases the last `length` known words are kept.
    """
    rows = np.zeros((len(texts), length), dtype=np.int64)
    for row, text in zip(rows, texts, strict=True):
        known = [index[w] for w in normalise(text) if w in index][-length:]
        if known:
            row[length - len(known) :] = known
    return rows


def _resampled(images: NDArray[np.uint8], size: int) -> NDArray[np.uint8]:
    """Images `[B, size, size, 3]` uint8, resampled with antialiasing; unchanged if they have that size."""
    if images.shape[1:3] == (size, size):
        return np.ascontiguousarray(images)
    from PIL import Image

    bilinear = Image.Resampling.BILINEAR
    return np.stack([np.asarray(Image.fromarray(image).resize((size, size), bilinear)) for image in images])


def _unit(rows: NDArray[np.floating]) -> NDArray[np.float32]:
    return np.asarray(rows / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), 1e-12), dtype=np.float32)
