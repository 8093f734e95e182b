"""Text and image encoders behind one protocol, chosen by one string.

The module of a back end, and the libraries it needs, are imported when that back end is loaded.
"""

from __future__ import annotations

import functools
import importlib
import pkgutil
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from ...errors import BackendError
from ..specs import remember
from . import backends
from .vocabulary import Vocabulary

if TYPE_CHECKING:
    from .calibration import Calibration


@runtime_checkable
class Encoder(Protocol):
    """Encodes images and phrases as unit vectors in one space.

    Attributes:
        fingerprint: identifies weights and preprocessing; vectors of different fingerprints must not be compared.
        dim: D, length of the vectors.
        image_size: side of the square input image in pixels; other images are resampled. 0 without an image tower.
        vocabulary: names that are proposed as labels and compete with a query.
        calibration: maps similarities to probabilities.

    An encoder trained on photographs may have `on_background = True`: groups are then shown before their own
    background as well as alone, and in photographs where a capture is given.
    """

    @property
    def fingerprint(self) -> str: ...
    @property
    def dim(self) -> int: ...
    @property
    def image_size(self) -> int: ...
    @property
    def vocabulary(self) -> Vocabulary: ...
    @property
    def calibration(self) -> Calibration: ...

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        """Text vectors `[T, D]` float32, unit rows. Unknown words are left out (see `unknown_words`)."""
        ...

    def encode_images(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        """Image vectors `[B, D]` float32, unit rows, of images `[B, H, W, 3]` uint8 in display space; B may be 0."""
        ...

    def unknown_words(self, text: str) -> tuple[str, ...]:
        """The normalised words of `text` that the encoder does not know; empty for open vocabularies."""
        ...

    def knows(self, text: str) -> bool:
        """Whether `text` has words and all of them are known."""
        ...


def uses_background(encoder: Encoder) -> bool:
    """Whether this encoder was trained on photographs: it is shown groups before their own background as well as alone,
    and in photographs where there are any."""
    return bool(getattr(encoder, "on_background", False))


def names() -> tuple[str, ...]:
    """Names of all back ends, whether or not the libraries they need are installed."""
    return tuple(sorted(m.name for m in pkgutil.iter_modules(backends.__path__)))


def load(spec: str = "auto") -> Encoder:
    """Load an encoder by its specification.

    Args:
        spec: "auto" or "embedded" for the encoder shipped with the package, which is loaded once per process and shared
            (it has no state, its vectors are deterministic); "embedded:DIR" for another trained by
            `python -m scenewright.training`; "open_clip:MODEL/PRETRAINED" or "open_clip:DIR" for a
            published CLIP; "onnx:FOLDER" for one in ONNX; "vectors:PATH" for precomputed text vectors.

    Raises:
        BackendError: unknown back end, missing extra, missing or broken weights; the message says what to do.
    """
    name, _, argument = spec.partition(":")
    name = {"auto": "embedded", "": "embedded"}.get(name, name)
    if name == "embedded" and not argument:
        encoder = _shared_embedded()
        remember(encoder, "embedded")
        return encoder
    if name not in names():
        raise BackendError(
            f"unknown encoder {spec!r}; "
            "use auto, embedded:DIR, open_clip:MODEL/PRETRAINED, open_clip:DIR, onnx:FOLDER or vectors:PATH"
        )
    encoder = _loaded(name, argument)
    remember(encoder, spec)
    return encoder


@functools.cache
def _shared_embedded() -> Encoder:
    return _loaded("embedded", "")


def _loaded(name: str, argument: str) -> Encoder:
    encoder: Encoder = importlib.import_module(f"{backends.__name__}.{name}").load(argument)
    return encoder


def checked_images(images: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """`images` itself if it is `[B, H, W, 3]` uint8.

    Raises:
        BackendError: it is not; the message says what it is.
    """
    if not isinstance(images, np.ndarray) or images.dtype != np.uint8 or images.ndim != 4 or images.shape[3] != 3:
        got = f"{images.dtype} {list(images.shape)}" if isinstance(images, np.ndarray) else type(images).__name__
        raise BackendError(f"encode_images needs uint8 images of shape [B, H, W, 3], got {got}")
    if 0 in images.shape[1:3]:
        raise BackendError(f"encode_images needs images of at least one pixel, got shape {list(images.shape)}")
    return images


def checked_texts(texts: list[str]) -> list[str]:
    """`texts` itself if it is a list of strings.

    Raises:
        BackendError: it is one string or holds something else.
    """
    if isinstance(texts, str) or not all(isinstance(t, str) for t in texts):
        raise BackendError("encode_text needs a list of strings")
    return list(texts)


def weights_folder() -> Path:
    """The folder of the shipped encoder."""
    return Path(__file__).parent / "weights"
