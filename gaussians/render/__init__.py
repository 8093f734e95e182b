"""Pixels from Gaussians: one call, several back ends behind it.

Knows which back ends exist and checks what they are given. Refuses to know how any of them works: each is one module
with `render(cloud, camera, background)`, `contributions(cloud, camera)` and `split(cloud, camera, labels)`, imported
when first asked for.
"""

from __future__ import annotations

import importlib
import math
from typing import Protocol, cast

import numpy as np
from numpy.typing import NDArray
from torch import Tensor

from ..camera import Camera, Render, Vec3
from ..cloud import GaussianCloud
from ..errors import BackendError, UserError
from .shares import Split

__all__ = ["Split", "backends", "contributions", "render", "split"]

_MODULES = {"cpu": ".cpu", "reference": ".reference", "cuda": ".cuda"}
_AUTO = "cpu"


class Backend(Protocol):
    """What a back end module offers. Equal input gives equal bytes; on a GPU, sums over pixels to their rounding."""

    def render(self, cloud: GaussianCloud, camera: Camera, background: Vec3) -> Render: ...

    def contributions(self, cloud: GaussianCloud, camera: Camera) -> Tensor: ...

    def split(self, cloud: GaussianCloud, camera: Camera, labels: NDArray[np.int32]) -> Split: ...


def backends() -> tuple[str, ...]:
    """Names that `backend=` accepts besides "auto"."""
    return tuple(_MODULES)


def render(cloud: GaussianCloud, camera: Camera, background: Vec3 = (0.0, 0.0, 0.0), backend: str = "auto") -> Render:
    """Draw a cloud as a camera sees it: colour, alpha, depth and group of every pixel in one pass.

    Gaussians with a number that is not finite are left out, as are those behind the eye; no pixel is ever NaN.
    Drawing the same input twice gives the same bytes.

    Args:
        cloud: the Gaussians; moved to the device that the back end draws on, and the picture back to theirs.
        camera: pose, intrinsics and image size.
        background: display-space colour behind everything.
        backend: "auto" (the fast CPU renderer), or a name from `backends()`.

    Raises:
        UserError: `background` is not three finite numbers.
        BackendError: no such back end, or its package or device is not there.
    """
    if len(background) != 3 or not all(math.isfinite(channel) for channel in background):
        raise UserError(f"background must be three finite numbers, red green blue, got {background!r}")
    return _load(backend).render(cloud, camera, background)


def contributions(cloud: GaussianCloud, camera: Camera, backend: str = "auto") -> Tensor:
    """How much of the picture each Gaussian is: `[N]` float32, its blending weight summed over all pixels.

    The sum over Gaussians is the sum of alpha over pixels. Zero means not seen: outside the view or hidden.

    Raises:
        BackendError: no such back end, or its package or device is not there.
    """
    return _load(backend).contributions(cloud, camera)


def split(cloud: GaussianCloud, camera: Camera, labels: NDArray[np.integer], backend: str = "auto") -> Split:
    """How much of each label's pixels each Gaussian is: `contributions`, shared out among the labels of a picture.

    One pass whatever the number of labels. For every Gaussian the weights of all labels add up to its contribution.

    Args:
        labels: `[H, W]` integers of the camera's size, any values within int32.

    Raises:
        UserError: `labels` has another size than the camera, or holds no integers.
        BackendError: no such back end, or its package or device is not there.
    """
    if labels.shape != (camera.height, camera.width) or not np.issubdtype(labels.dtype, np.integer):
        raise UserError(
            f"labels must be integers of the camera's size [{camera.height}, {camera.width}], "
            f"got {labels.dtype} {list(labels.shape)}"
        )
    return _load(backend).split(cloud, camera, labels.astype(np.int32, copy=False))


def _load(name: str) -> Backend:
    """The module of a back end."""
    chosen = _AUTO if name == "auto" else name
    if chosen not in _MODULES:
        raise BackendError(f"no renderer is called {name!r}; choose auto, {', '.join(_MODULES)}")
    try:
        return cast(Backend, importlib.import_module(_MODULES[chosen], __package__))
    except ImportError as error:
        raise BackendError(
            f"renderer {chosen!r} cannot start ({error}); reinstall with: pip install scenewright"
        ) from error
