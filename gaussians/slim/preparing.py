"""What `slim` may do (`Settings`), and what is measured of a scene once for all formats and promises (`prepare`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..errors import UserError
from ..scene import Scene
from .importance import Importance, Progress, rank
from .loss import Truth
from .views import SIZE, Views, choose_views


@dataclass(frozen=True)
class Settings:
    """What `slim` may do.

    Attributes:
        psnr: dB that the held-out views must keep; infinite keeps every bit.
        size: pixels of the longer side of the views.
        steps, seconds: length of the optimisation; at most one is given, without both there is none. In steps, equal
            input gives equal bytes.
    """

    psnr: float = 40.0
    size: int = SIZE
    steps: int | None = None
    seconds: float | None = None

    def __post_init__(self) -> None:
        if not self.psnr > 0:
            raise UserError(f"a PSNR is a positive number of decibels, got {self.psnr:g}; 40 is hardly visible")
        if any(length is not None and not length > 0 for length in (self.steps, self.seconds)):
            raise UserError("an optimisation takes a positive number of seconds or steps; leave it out for none")


@dataclass(frozen=True, eq=False)
class Prepared:
    """What is measured of a scene once, for all formats and promises.

    Attributes:
        views: the views.
        truth, held_out: the pictures from the views that choose and from the held-out ones.
        order: rows of the cloud, the ones to keep first.
        importance: of all Gaussians.
    """

    views: Views
    truth: Truth
    held_out: Truth
    order: NDArray[np.int64]
    importance: Importance


def prepare(
    scene: Scene, cameras: Sequence[Camera] = (), size: int = SIZE, progress: Progress | None = None
) -> Prepared:
    """Choose the views of a scene and rank its Gaussians; see `slim`."""
    views = choose_views(scene, cameras, size)
    order, importance = rank(scene.cloud, views.ranking, progress)
    return Prepared(
        views, Truth(scene.cloud, views.choice), Truth(scene.cloud, views.held_out), order, importance
    )  # fmt: skip
