"""Text and image encoders behind one protocol, one file a back end, chosen by one string.

Knows the protocol and how to find a back end. Refuses to know any back end's library: they are imported when asked for.
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
from . import backends
from .vocabulary import Vocabulary

if TYPE_CHECKING:
    from .calibration import Calibration

# Modules of this package that are not back ends.


@runtime_checkable
class Encoder(Protocol):
    """Pictures and phrases to unit vectors that can be compared with each other.

    Attributes:
        fingerprint: names the weights and the preprocessing; vectors of two fingerprints must never be compared.
        dim: D, length of the vectors.
        image_size: side in pixels of the square pictures it likes best; others are resampled.
        vocabulary: names to propose as labels, and what competes with a query.
        calibration: how a similarity becomes a probability.

    One that cannot see, but holds text vectors only, has an `image_size` of 0. One that learnt from photographs may
    have `on_background = True`, to be shown things on their own background as well as alone.
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
        """`[T, D]` float32, unit rows. Words the encoder does not know are left out (see `unknown_words`)."""
        ...

    def encode_images(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        """`[B, H, W, 3]` uint8, display space, to `[B, D]` float32, unit rows; B may be 0."""
        ...

    def unknown_words(self, text: str) -> tuple[str, ...]:
        """The words of `text` that the encoder never learnt, as normalised; empty for open vocabularies."""
        ...

    def knows(self, text: str) -> bool:
        """Whether `text` has words and all of them are known."""
        ...


def looks_at_background(encoder: Encoder) -> bool:
    """Whether an encoder is to be shown things on their own background as well as alone."""
    return bool(getattr(encoder, "on_background", False))


def names() -> tuple[str, ...]:
    """Names of the back ends in this package, whether or not what they need is installed."""
    return tuple(sorted(m.name for m in pkgutil.iter_modules(backends.__path__)))


def load(spec: str = "auto") -> Encoder:
    """An encoder by its specification.

    Args:
        spec: "auto" or "embedded" for the one that ships with the package, which is loaded once a process and shared
            (it holds no state, its vectors are deterministic); "embedded:DIR" for another trained by
            `python -m scenewright.training`; "open_clip:MODEL/PRETRAINED" or "open_clip:DIR" for a
            real CLIP; "onnx:FOLDER" for one as ONNX; "vectors:PATH" for text vectors made elsewhere.

    Raises:
        BackendError: unknown back end, missing extra, missing or broken weights; the message says what to do.
    """
    name, _, argument = spec.partition(":")
    name = {"auto": "embedded", "": "embedded"}.get(name, name)
    if name == "embedded" and not argument:
        return _shipped()
    if name not in names():
        raise BackendError(
            f"unknown encoder {spec!r}; "
            "use auto, embedded:DIR, open_clip:MODEL/PRETRAINED, open_clip:DIR, onnx:FOLDER or vectors:PATH"
        )
    return _loaded(name, argument)


@functools.cache
def _shipped() -> Encoder:
    return _loaded("embedded", "")


def _loaded(name: str, argument: str) -> Encoder:
    encoder: Encoder = importlib.import_module(f"{backends.__name__}.{name}").load(argument)
    return encoder


def checked_images(images: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """`images` itself if it is `[B, H, W, 3]` uint8.

    Raises:
        BackendError: it is not; the message says what came instead.
    """
    if not isinstance(images, np.ndarray) or images.dtype != np.uint8 or images.ndim != 4 or images.shape[3] != 3:
        got = f"{images.dtype} {list(images.shape)}" if isinstance(images, np.ndarray) else type(images).__name__
        raise BackendError(f"encode_images needs uint8 pictures of shape [B, H, W, 3], got {got}")
    if 0 in images.shape[1:3]:
        raise BackendError(f"encode_images needs pictures of at least one pixel, got shape {list(images.shape)}")
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
    """Where the shipped encoder lies."""
    return Path(__file__).parent / "weights"
