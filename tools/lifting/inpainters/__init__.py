"""Models that inpaint pictures behind one protocol, chosen by one string.

The module of a back end, and the libraries it needs, are imported when that back end is loaded.
"""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from ....gaussians.errors import BackendError

__all__ = ["Inpainter", "Shot", "checked", "load", "names"]

F32 = NDArray[np.float32]
Mask = NDArray[np.bool_]

_MODULES = {"onnx": ".onnx", "diffusers": ".diffusers", "folder": ".folder"}
_SLACK = 0.05  # by which values may leave [0, 1], as networks' do, before they are clipped
_BYTES = 2.0  # largest value from which a picture counts as one with values up to 255
_APART = 0.2  # mean difference of a picture from what it was given, outside of the mask


@dataclass(frozen=True, eq=False)
class Shot:
    """A picture with a hole.

    Attributes:
        name: of the view, usable as a file name.
        rgb: `[H, W, 3]` float32 in [0, 1], display space; anything in the hole.
        mask: `[H, W]` bool, the hole.
    """

    name: str
    rgb: F32
    mask: Mask


@runtime_checkable
class Inpainter(Protocol):
    """Fills holes in pictures. It is deterministic: the same shot and seed give the same picture.

    Attributes:
        name: for messages and receipts.
        grow: pixels by which a mask is dilated before `fill` sees it: models copy the outlines of what was there.
    """

    @property
    def name(self) -> str: ...
    @property
    def grow(self) -> int: ...

    def prepare(self, shots: Sequence[Shot]) -> None:
        """Called once for each edit, with all its views and their whole holes, before the first is filled.

        Raises:
            BackendError: the pictures are not there yet; the message says what to do.
        """
        ...

    def fill(self, shot: Shot, seed: int = 0) -> F32:
        """The picture `[H, W, 3]` with the hole filled; `checked` makes sure that it is one.

        Raises:
            BackendError: the model failed, or what it returned is no such picture.
        """
        ...


def names() -> tuple[str, ...]:
    """Names of all back ends, whether or not the libraries they need are installed."""
    return tuple(_MODULES)


def load(spec: str) -> Inpainter:
    """Load a model by its specification.

    Args:
        spec: "onnx:PATH" (a network of the LaMa class), "diffusers:PATH" (a folder with an inpainting pipeline) or
            "folder:PATH" (pictures inpainted elsewhere).

    Raises:
        BackendError: unknown back end, or its files or packages are missing; the message says what to do.
    """
    name, _, argument = spec.partition(":")
    if name not in _MODULES or not argument:
        raise BackendError(f"unknown infill {spec!r}; use scene, none, onnx:FILE, diffusers:FOLDER or folder:FOLDER")
    model: Inpainter = importlib.import_module(_MODULES[name], __name__).load(argument)
    return model


def checked(picture: NDArray[np.generic], shot: Shot, name: str, *, same_outside: bool = True) -> F32:
    """What a model returned as a picture with values in [0, 1]; outside of the mask it is the one that was given.

    Values up to 255 are divided by 255, as exported networks often return them.

    Args:
        same_outside: refuse a picture that differs outside of the mask; image to image changes that too.

    Raises:
        BackendError: another size, values that are not numbers or out of range, or another picture outside the mask.
    """
    found = np.asarray(picture)
    if found.shape != shot.rgb.shape or found.dtype.kind not in "fiu":
        what = f"{list(found.shape)} of type {found.dtype}"
        raise BackendError(f"{name} returned {what} for a picture of {list(shot.rgb.shape)}; it is no inpainting model")
    found = found.astype(np.float32)
    if not np.isfinite(found).all():
        raise BackendError(f"{name} returned values that are not numbers; export the model again, in 32 bits")
    low, high = float(found.min()), float(found.max())
    top = 255.0 if high > _BYTES else 1.0
    if low < -_SLACK * top or high > (1 + _SLACK) * top:
        raise BackendError(
            f"{name} returned values from {low:.3g} to {high:.3g}; a model must return 0 to 1, or 0 to 255: export it "
            "with its last activation"
        )
    found = np.clip(found / np.float32(top), 0, 1)
    outside = ~shot.mask
    if same_outside and outside.any() and (off := float(np.abs(found - shot.rgb)[outside].mean())) > _APART:
        raise BackendError(
            f"{name} returned another picture than it was given: outside of the mask it is off by {off:.2f} of 1; it "
            "expects another order of channels, or values in another range"
        )
    return np.where(shot.mask[..., None], found, shot.rgb).astype(np.float32)
