"""Drop SH bands and Gaussians that gain too little on the held-out photographs.

Bands are trained first and dropped afterwards: the gain in a short trial is below the noise of training steps, the loss
from dropping a trained band is not.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import torch

from ..cloud import GaussianCloud
from ..reduce import rank_by_contribution
from .parameters import Parameters
from .photographs.photos import Photos
from .quality import measure

MIN_GAIN = 0.05  # dB; a band or a tenth of the Gaussians that gains less is dropped
MAX_DEGREE = 3  # SH degree that is trained before bands are dropped
KEEP_SHARE = 0.9  # of the Gaussians kept when the least visible ones are dropped
MAX_VIEWS = 48  # cameras that visibility is measured with


@dataclass(frozen=True)
class Choice:
    """One tried reduction.

    Attributes:
        what: "degree" of the harmonics, or number of "gaussians".
        before, after: SH degrees, or numbers of Gaussians.
        psnr: dB on the held-out photographs, before and after.
        taken: whether training continued with the reduced scene.
    """

    what: Literal["degree", "gaussians"]
    before: int
    after: int
    psnr: tuple[float, float]
    taken: bool


def drop_sh_bands(parameters: Parameters, photos: Photos, gain: float) -> list[Choice]:
    """Drop the highest SH band repeatedly while that costs less than `gain` dB on the held-out photographs."""
    cloud = parameters.cloud()
    smaller = ((degree, cloud.with_degree(degree)) for degree in range(cloud.degree, -1, -1))
    choices = _reduce("degree", smaller, photos, gain)
    for choice in choices:
        if choice.taken:
            parameters.lower_degree(choice.after)
    return choices


def drop_gaussians(parameters: Parameters, photos: Photos, gain: float) -> list[Choice]:
    """Drop the least visible tenth of the Gaussians repeatedly while that costs less than `gain` dB on the held-out
    photographs.

    Visibility is measured by `reduce.rank_by_contribution` with cameras of training photographs.
    """
    cloud = parameters.cloud()
    views = [photos.shots[i].camera for i in _evenly_spaced(len(photos.shots), MAX_VIEWS)]
    order = rank_by_contribution(cloud, views)
    smaller = ((count, cloud[torch.from_numpy(np.sort(order[:count]))]) for count in _counts(len(order)))
    choices = _reduce("gaussians", smaller, photos, gain)
    kept = min((choice.after for choice in choices if choice.taken), default=len(order))
    parameters.take(np.sort(order[:kept]))
    return choices


def _reduce(
    what: Literal["degree", "gaussians"], clouds: Iterator[tuple[int, GaussianCloud]], photos: Photos, gain: float
) -> list[Choice]:
    """Compare each cloud with the next smaller one, until a step costs `gain` dB or more."""
    before, cloud = next(clouds)
    psnr, choices = measure(cloud, photos.held_out).psnr, list[Choice]()
    for after, cloud in clouds:
        reduced = measure(cloud, photos.held_out).psnr
        choices.append(Choice(what, before, after, (psnr, reduced), psnr - reduced < gain))
        if not choices[-1].taken:
            break
        before, psnr = after, reduced
    return choices


def _counts(count: int) -> Iterator[int]:
    """`count`, then repeatedly `KEEP_SHARE` of the previous number, down to 1."""
    while count > 0:
        yield count
        count = int(KEEP_SHARE * count)


def _evenly_spaced(count: int, limit: int) -> Sequence[int]:
    """At most `limit` evenly spaced indices below `count`."""
    return np.unique(np.linspace(0, count - 1, min(count, limit)).round().astype(int)).tolist()
