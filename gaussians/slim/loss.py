"""Measures what a changed cloud loses against the original, as PSNR over a set of views."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..cloud import GaussianCloud
from ..render import render
from .views import View

F32 = NDArray[np.float32]

EXACT = 120.0  # dB, reported for equal pictures


@dataclass(frozen=True)
class Loss:
    """The loss over a set of views.

    Attributes:
        psnr: dB of the squared error averaged over all pixels of all views. It is at most the mean of the views' PSNRs.
        mean: mean of the views' PSNRs, dB.
        worst: lowest PSNR of a view, dB.
        views: number of views.
    """

    psnr: float
    mean: float
    worst: float
    views: int

    @property
    def error(self) -> float:
        """Mean squared error; zero for equal pictures."""
        return 0.0 if self.psnr >= EXACT else float(10 ** (-self.psnr / 10))


class Truth:
    """The pictures of the original scene from some views, clipped to [0, 1]."""

    def __init__(self, cloud: GaussianCloud, views: Sequence[View]) -> None:
        self.views = tuple(views)
        self.pictures = tuple(picture(cloud, view) for view in self.views)

    def loss(self, cloud: GaussianCloud) -> Loss:
        """What `cloud` loses."""
        pairs = zip(self.views, self.pictures, strict=True)
        return loss_of([squared_error(picture(cloud, view), known) for view, known in pairs])


def squared_error(found: F32, known: F32) -> float:
    """Mean squared error of a picture."""
    return float(np.mean((found - known).astype(np.float64) ** 2))


def loss_of(errors: Sequence[float]) -> Loss:
    """The loss over some views, from the mean squared error of each."""
    each = decibels(np.array(errors))
    return Loss(float(decibels(float(np.mean(errors)))), float(each.mean()), float(each.min()), len(errors))


def picture(cloud: GaussianCloud, view: View) -> F32:
    """`[H, W, 3]` render of a view, clipped to [0, 1]."""
    drawn: F32 = render(cloud, view.camera, view.background).rgb.clamp(0, 1).cpu().numpy()
    return drawn


def decibels(error: NDArray[np.floating] | float) -> NDArray[np.float64]:
    """PSNR in dB of mean squared errors of pictures in [0, 1]; at most `EXACT`."""
    return -10 * np.log10(np.maximum(error, 10 ** (-EXACT / 10)))
