"""Detectors of contours behind one type: the network, or the classical method that is its measured baseline."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....camera import Camera
from ....errors import BackendError
from ..view import ViewMasks
from .hierarchy import merge
from .layers import layers
from .watershed import regions_of

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

NAMES = ("network", "classical")


@dataclass(frozen=True)
class Detector:
    """Finds contours in pictures.

    Attributes:
        contours: from a picture `[8, H, W]`, whose channels `channels.py` lists, to contour strengths `[H, W]` in
            [0, 1].
        slope, offset: the probability that a contour of strength s in (0, 1) of the hierarchy is real is the logistic
            function of `slope * log(s / (1 - s)) + offset`.
    """

    contours: Callable[[F32], F32]
    slope: float
    offset: float

    def probability(self, strength: F64) -> F64:
        """Probability that contours of these strengths are real; it never falls as the strength grows."""
        inside = np.clip(strength, 1e-6, 1 - 1e-6)
        odds = self.slope * np.log(inside / (1 - inside)) + self.offset
        result: F64 = 1 / (1 + np.exp(-odds))
        return result

    def masks(self, picture: F32, camera: Camera) -> ViewMasks:
        """The regions of a picture `[8, H, W]` as layers of masks, finest first."""
        regions = regions_of(self.contours(picture))
        hierarchy = merge(regions)
        return layers(regions, hierarchy, self.probability(hierarchy.height), camera)


def load(name: str) -> Detector:
    """A detector by its name.

    Raises:
        BackendError: there is none of this name, or its weights cannot be loaded.
    """
    # The logistic functions are fitted to pictures of `scenewright.training.contours` that no network was trained on.
    if name == "classical":
        from .classical import contours

        return Detector(contours, 1.06, -0.47)
    if name == "network":
        from . import network

        network.session()
        return Detector(network.contours, 0.86, 0.16)
    raise BackendError(f"unknown detector of contours {name!r}; use {' or '.join(NAMES)}")
