"""No more than a scene needs: bands of harmonics and Gaussians stay where held-out photographs gain by them.

Knows how to train a change beside its absence, and how to find what is not missed. Refuses to know when it is asked.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import torch

from ..reduce import ranked
from .photos import Photos
from .quality import measure
from .train import EVERY, Trainer

GAIN = 0.05  # dB, below which a band, or a tenth of the Gaussians, is not worth its numbers
HIGHEST = 3  # degree of harmonics
TRIAL = 0.02  # of the training that bands are given to show what they gain
LOOKS, APART = 6, 25  # looks at the end of a trial, and steps between them: one alone is off by a tenth of a dB
TENTH = 0.9  # of the Gaussians stay when the least of them are left out
VIEWS = 48  # photographs by which a Gaussian is judged


@dataclass(frozen=True)
class Choice:
    """One change that was tried.

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


def bands(trainer: Trainer, photos: Photos, gain: float, stepped: Callable[[float], None]) -> Choice:
    """Train for a while without and with all bands of harmonics, from the same state, on the same photographs in the
    same order; go on with them if the held-out photographs gain by `gain` dB, else without. The time of both counts.

    All at once: in so short a time what one band gains is lost in the noise of steps, what three gain is not.

    Args:
        trainer: right after a `changed` step.
        stepped: called after every step, with its loss.
    """
    degree, count = trainer.parameters.degree, _trial(trainer)
    before = copy.deepcopy(trainer.state())
    plain = _run(trainer, photos, count, stepped)
    without, spent = copy.deepcopy(trainer.state()), trainer.seconds
    trainer.restore(*before)
    trainer.seconds = spent
    trainer.parameters.widen(HIGHEST)
    wider = _run(trainer, photos, count, stepped)
    taken = wider - plain >= gain
    if not taken:
        spent = trainer.seconds
        trainer.restore(*without)
        trainer.seconds = spent
    return Choice("degree", degree, HIGHEST, (plain, wider), taken)


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


def _trial(trainer: Trainer) -> int:
    """Steps of a trial: whole rounds between two changes, so that a state after it is whole."""
    return max(1, round(TRIAL * trainer.steps / trainer.done / EVERY)) * EVERY


def _run(trainer: Trainer, photos: Photos, steps: int, stepped: Callable[[float], None]) -> float:
    """Train on; the mean PSNR at the last looks."""
    seen = []
    for i in range(steps):
        stepped(trainer.step())
        left = steps - 1 - i
        if left % APART == 0 and left < LOOKS * APART:
            seen.append(measure(trainer.parameters.cloud(), photos.held).psnr)
    return float(np.mean(seen))


def _spread(count: int, most: int) -> Sequence[int]:
    """At most so many of `count` places, evenly spread."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int)).tolist()
