"""No more than a scene needs: bands of harmonics and Gaussians stay where held-out photographs gain by them.

Knows how to find what is not missed. Refuses to know when it is asked. Bands are trained first and left out then: what
they gain in a short trial is lost in the noise of steps, what they are worth when trained is not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import torch

from ..reduce import ranked
from .photos import Photos
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
    cloud, choices = trainer.parameters.cloud(), []
    psnr = measure(cloud, photos.held).psnr
    for degree in range(cloud.degree, 0, -1):
        less = measure(cloud.with_degree(degree - 1), photos.held).psnr
        choices.append(Choice("degree", degree, degree - 1, (psnr, less), psnr - less < gain))
        if not choices[-1].taken:
            break
        psnr = less
        trainer.parameters.narrow(degree - 1)
    return choices


def fewer_gaussians(trainer: Trainer, photos: Photos, gain: float) -> list[Choice]:
    """Leave out the least visible tenth of the Gaussians, and again, while that costs the held-out photographs less
    than `gain` dB. What is left can be trained on.

    Visible is what `reduce.ranked` calls so, to cameras of photographs that were learnt from.
    """
    cloud = trainer.parameters.cloud()
    views = [photos.shots[i].camera for i in _spread(len(photos.shots), VIEWS)]
    order = ranked(cloud, views)
    psnr, kept, choices = measure(cloud, photos.held).psnr, len(order), []
    while int(TENTH * kept) > 0:
        some = np.sort(order[: int(TENTH * kept)])
        less = measure(cloud[torch.from_numpy(some)], photos.held).psnr
        choices.append(Choice("gaussians", kept, len(some), (psnr, less), psnr - less < gain))
        if not choices[-1].taken:
            break
        psnr, kept = less, len(some)
    trainer.parameters.take(np.sort(order[:kept]))
    return choices


def _spread(count: int, most: int) -> Sequence[int]:
    """At most so many of `count` places, evenly spread."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int)).tolist()
