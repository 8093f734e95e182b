"""Inpainting networks of the LaMa class as one ONNX file: `onnx:FILE`.

Inputs are found by their names and shapes: a picture `[1, 3, H, W]` in [0, 1] and a mask `[1, 1, H, W]`, 1 in the hole;
or both stacked in one input of four channels. H and W may be fixed or free. The output is a picture `[1, 3, H, W]` or
`[1, H, W, 3]`, in [0, 1] or up to 255.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....gaussians.errors import BackendError
from ....gaussians.language.encoders.sessions import open_session
from . import F32, Shot, checked
from .sizes import Fitted

_ADVICE = "export the model again, or download the file again"
_KINDS = {"tensor(float)": np.float32, "tensor(float16)": np.float16, "tensor(uint8)": np.uint8}
_GROW = 5  # px, for LaMa's wide masks
_MULTIPLE = 8  # of the sides of a network that takes any size


@dataclass(frozen=True)
class _Input:
    name: str
    channels: int
    size: tuple[int | None, int | None]
    kind: Any


@dataclass(frozen=True, eq=False)
class Onnx:
    """A network; `name` is its specification."""

    name: str
    session: Any
    picture: _Input
    mask: _Input | None
    grow: int = _GROW

    def prepare(self, shots: Sequence[Shot]) -> None:
        """Nothing to prepare."""

    def fill(self, shot: Shot, seed: int = 0) -> F32:
        """See `Inpainter`; a network needs no seed."""
        fitted = Fitted.to(shot.mask.shape, self.picture.size, _MULTIPLE)
        mask = fitted.mask(shot.mask)[None, None].astype(np.float32)
        rgb = fitted.picture(shot.rgb).transpose(2, 0, 1)[None] * (1 - mask)
        if self.mask is None:
            feeds = {self.picture.name: _as(np.concatenate([rgb, mask], axis=1), self.picture.kind)}
        else:
            feeds = {self.picture.name: _as(rgb, self.picture.kind), self.mask.name: _as(mask, self.mask.kind, 1)}
        try:
            out = np.asarray(self.session.run(None, feeds)[0])
        except Exception as error:  # onnxruntime raises its own classes, which share no public base
            raise BackendError(f"{self.name} failed: {error}; {_ADVICE}") from error
        return checked(self._picture(out, fitted), shot, self.name)

    def _picture(self, out: NDArray[Any], fitted: Fitted) -> NDArray[Any]:
        """The output as `[H, W, 3]` of the size of the shot; as it is if it is no picture of the size taken."""
        if out.ndim == 4 and out.shape[0] == 1:
            out = out[0]
        if out.ndim == 3 and out.shape[0] == 3 and out.shape[1:] == fitted.taken:
            out = out.transpose(1, 2, 0)
        if out.shape != (*fitted.taken, 3) or out.dtype.kind not in "fiu" or not np.isfinite(out).all():
            return out
        return fitted.back(np.ascontiguousarray(out, dtype=np.float32))


def load(argument: str) -> Onnx:
    """The network in the file `argument`.

    Raises:
        BackendError: the file is missing or broken, or has other inputs.
    """
    path = Path(argument).expanduser()
    if not path.is_file():
        raise BackendError(f"there is no file {path}; --infill onnx:FILE names an inpainting network such as lama.onnx")
    session = open_session(path, _ADVICE)
    inputs = [_read(i) for i in session.get_inputs()]
    masks = [i for i in inputs if i.channels == 1 and i.kind is not None]
    pictures = [i for i in inputs if i.channels in (3, 4) and i.kind is not None]
    named = [i for i in masks if "mask" in i.name.lower()] or masks
    whole = len(pictures) == 1 and len(inputs) == (2 if pictures[0].channels == 3 else 1)
    if not whole or (pictures[0].channels == 3 and not named):
        told = "; ".join(f"{i.name} {list(i.shape)} {i.type}" for i in session.get_inputs())
        raise BackendError(
            f"{path} is no inpainting network: it takes {told}, not a picture [1, 3, H, W] and a mask [1, 1, H, W]"
        )
    return Onnx(f"onnx:{argument}", session, pictures[0], named[0] if pictures[0].channels == 3 else None)


def _read(found: Any) -> _Input:
    shape = list(found.shape)
    if len(shape) != 4:
        return _Input(found.name, 0, (None, None), None)
    channels = shape[1] if isinstance(shape[1], int) else (1 if "mask" in found.name.lower() else 3)
    height, width = (s if isinstance(s, int) and s > 0 else None for s in shape[2:])
    return _Input(found.name, channels, (height, width), _KINDS.get(found.type))


def _as(values: F32, kind: Any, top: int = 255) -> NDArray[Any]:
    """Values in [0, 1] as a network takes them; `top`: what 1 is in integers."""
    if kind is np.uint8:
        return np.ascontiguousarray((values * top + 0.5).astype(np.uint8))
    return np.ascontiguousarray(values.astype(kind))
