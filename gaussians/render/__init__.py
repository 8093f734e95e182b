"""Render Gaussians: `render`, `contributions` and `split`, each dispatched to one of several back ends.

A back end is a module with `render(cloud, camera, background)`, `contributions(cloud, camera)` and
`split(cloud, camera, labels)`. It is imported on first use. Arguments are validated here.
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
from ..scene import Scene
from .shares import Split

__all__ = ["Split", "backends", "contributions", "render", "split"]

_MODULES = {"cpu": ".cpu", "reference": ".reference", "cuda": ".cuda"}
_AUTO = "cpu"


class Backend(Protocol):
    """Interface of a back end module. Equal input gives equal bytes; on a GPU, sums over pixels vary by rounding."""

    def render(self, cloud: GaussianCloud, camera: Camera, background: Vec3) -> Render: ...

    def contributions(self, cloud: GaussianCloud, camera: Camera) -> Tensor: ...

    def split(self, cloud: GaussianCloud, camera: Camera, labels: NDArray[np.int32]) -> Split: ...


def backends() -> tuple[str, ...]:
    """Names that `backend=` accepts besides "auto"."""
    return tuple(_MODULES)


def render(
    cloud: GaussianCloud | Scene, camera: Camera, background: Vec3 = (0.0, 0.0, 0.0), backend: str = "auto"
) -> Render:
    """Render colour, alpha, depth and group of every pixel in one pass.

    Gaussians with a non-finite value and Gaussians behind the camera are skipped; no pixel is ever NaN.
    The same input gives the same bytes.

    Args:
        cloud: the Gaussians, or a scene. They are copied to the back end's device; the image is returned on the
            cloud's device.
        camera: pose, intrinsics and image size.
        background: display-space RGB behind everything.
        backend: "auto" (the fast CPU renderer), or a name from `backends()`.

    Raises:
        UserError: `background` is not three finite numbers.
        BackendError: unknown back end, or its package or device is missing.
    """
    if len(background) != 3 or not all(math.isfinite(channel) for channel in background):
        raise UserError(f"background must be three finite numbers, red green blue, got {background!r}")
    return _load(backend).render(cloud.cloud if isinstance(cloud, Scene) else cloud, camera, background)


def contributions(cloud: GaussianCloud, camera: Camera, backend: str = "auto") -> Tensor:
    """Blending weight of each Gaussian summed over all pixels, `[N]` float32.

    The sum over Gaussians equals the sum of alpha over pixels. Zero means not visible: outside the view or occluded.

    Raises:
        BackendError: unknown back end, or its package or device is missing.
    """
    return _load(backend).contributions(cloud, camera)


def split(cloud: GaussianCloud, camera: Camera, labels: NDArray[np.integer], backend: str = "auto") -> Split:
    """Split `contributions` by the labels of a label image: the summed weight of each (Gaussian, label) pair.

    One pass whatever the number of labels. For every Gaussian the weights of all labels add up to its contribution.

    Args:
        labels: `[H, W]` integers of the camera's size, any values within int32.

    Raises:
        UserError: `labels` does not have the camera's size or an integer type.
        BackendError: unknown back end, or its package or device is missing.
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
        raise BackendError(f"unknown renderer {name!r}; choose auto, {', '.join(_MODULES)}")
    try:
        return cast(Backend, importlib.import_module(_MODULES[chosen], __package__))
    except ImportError as error:
        raise BackendError(
            f"renderer {chosen!r} cannot start ({error}); reinstall with: pip install scenewright"
        ) from error
