"""No more than a scene needs: bands of harmonics and Gaussians stay where held-out photographs gain by them.

Knows how to find what is not missed. Refuses to know when it is asked. Bands are trained first and left out then: what
they gain in a short trial is lost in the noise of steps, what they are worth when trained is not.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import torch

from ..cloud import GaussianCloud
from ..reduce import ranked
from .photographs.photos import Photos
from .quality import measure
from .train import Trainer

GAIN = 0.05  # dB, below which a band, or a tenth of the Gaussians, is not worth its numbers
HIGHEST = 3  # degree of harmonics that is tried
TENTH = 0.9  # of the Gaussians stay when the least of them are left out
VIEWS = 48  # photographs by which a Gaussian is judged


@dataclass(frozen=True)
class Choice:
    """Something that was tried without.

    Attributes:
        what: "degree" of the harmonics, or number of "gaussians".
        before, after: degrees, or numbers.
        psnr: dB on the held-out photographs, of before and of after.
        taken: whether training went on with what came after.
    """

    what: Literal["degree", "gaussians"]
    before: int
    after: int
    psnr: tuple[float, float]
    taken: bool


def fewer_bands(trainer: Trainer, photos: Photos, gain: float) -> list[Choice]:
    """Leave out the highest band, and again, while that costs the held-out photographs less than `gain` dB. What is
    left can be trained on."""
    cloud = trainer.parameters.cloud()
    ways = ((degree, cloud.with_degree(degree)) for degree in range(cloud.degree, -1, -1))
    choices = _while_not_missed("degree", ways, photos, gain)
    for choice in choices:
        if choice.taken:
            trainer.parameters.narrow(choice.after)
    return choices


def fewer_gaussians(trainer: Trainer, photos: Photos, gain: float) -> list[Choice]:
    """Leave out the least visible tenth of the Gaussians, and again, while that costs the held-out photographs less
    than `gain` dB. What is left can be trained on.

    Visible is what `reduce.ranked` calls so, to cameras of photographs that were learnt from.
    """
    cloud = trainer.parameters.cloud()
    views = [photos.shots[i].camera for i in _spread(len(photos.shots), VIEWS)]
    order = ranked(cloud, views)
    ways = ((most, cloud[torch.from_numpy(np.sort(order[:most]))]) for most in _tenths(len(order)))
    choices = _while_not_missed("gaussians", ways, photos, gain)
    kept = min((choice.after for choice in choices if choice.taken), default=len(order))
    trainer.parameters.take(np.sort(order[:kept]))
    return choices


def _while_not_missed(
    what: Literal["degree", "gaussians"], ways: Iterator[tuple[int, GaussianCloud]], photos: Photos, gain: float
) -> list[Choice]:
    """Go from the first of ever smaller clouds to the next while that costs less than `gain`."""
    before, cloud = next(ways)
    psnr, choices = measure(cloud, photos.held).psnr, list[Choice]()
    for after, cloud in ways:
        less = measure(cloud, photos.held).psnr
        choices.append(Choice(what, before, after, (psnr, less), psnr - less < gain))
        if not choices[-1].taken:
            break
        before, psnr = after, less
    return choices


def _tenths(count: int) -> Iterator[int]:
    """A number, and again and again what is left of it without a tenth."""
    while count > 0:
        yield count
        count = int(TENTH * count)


def _spread(count: int, most: int) -> Sequence[int]:
    """At most so many of `count` places, evenly spread."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int)).tolist()
