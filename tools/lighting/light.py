"""A change of light, and the colours of Gaussians under it.

Colours are re-weighted, no light is traced: display values are multiplied (for a display whose transfer is a power law
that multiplies linear light too), so a pixel becomes the same multiple of what it was, and all bands of the harmonics
follow. What would leave the display's range is rolled off: black stays black and white stays white.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.harmonics import color_to_dc, dc_to_color
from ...gaussians.language.field.measure import Sample, sample
from ...gaussians.rows import copied, empty
from .whites import F64, LUMINANCE, luminance, to_linear

KNEE = 0.9  # display value from which what becomes brighter is rolled off
_SAMPLE = 1 << 14  # Gaussians that the exposure is measured on
_STEPS = 40  # of the search for a gain
_GAINS = (1e-3, 30.0)
_MORE = 1.02  # display gain above that without a roll-off, which makes up for what it takes
_NONE = np.ones((1, 3), dtype=np.float32)


@dataclass(frozen=True, eq=False)
class Light:
    """A change of the light that is there, the same everywhere.

    Attributes:
        exposure: factor of the mean luminance.
        matrix: `[3, 3]` map of display colours (white balance, saturation).
        contrast: exponent of display values about the scene's mean; 1 leaves it.
    """

    exposure: float = 1.0
    matrix: F64 = field(default_factory=lambda: np.eye(3))
    contrast: float = 1.0

    @property
    def changes(self) -> bool:
        """Whether it changes any colour."""
        return self.exposure != 1.0 or self.contrast != 1.0 or not np.array_equal(self.matrix, np.eye(3))


@dataclass(frozen=True)
class Tone:
    """What is multiplied, once the gain that an exposure needs is known.

    Attributes:
        gain: of display values.
        contrast: exponent.
        pivot: display luma that contrast leaves.
    """

    gain: float = 1.0
    contrast: float = 1.0
    pivot: float = 0.5

    def row(self, knee: float = KNEE) -> Tensor:
        """`[4]` as the kernel takes it."""
        return torch.tensor([self.gain, self.contrast - 1, self.pivot, knee], dtype=torch.float32)


def colors_of(cloud: GaussianCloud, rows: Tensor | None = None) -> Sample:
    """Colours and visible areas of a sample of some rows `[M]` of a cloud, all by default."""
    return sample(cloud, rows, _SAMPLE)


def mean_luminance(rgb: Tensor, weight: Tensor) -> float:
    """Weighted mean of the relative luminance of display colours `[M, 3]`."""
    return float(luminance(rgb.double().numpy()) @ weight.double().numpy())


def tone_of(light: Light, colors: Sample, received: Tensor | None = None) -> Tone:
    """The tone that gives sampled surfaces the mean luminance that a light asks for, found by bisection.

    What the roll-off takes from bright surfaces is made up for by the others up to `_MORE`.

    Args:
        received: `[M, 3]` factors of linear light at the samples, None for one everywhere.
    """
    was = colors.rgb.clamp(0, 1)
    pivot = float(np.clip(luminance(was.numpy()) @ colors.weight.numpy(), 1e-4, 1.0) ** (1 / 2.2))
    start = Tone(1.0, light.contrast, pivot)
    if not light.changes and received is None:
        return start
    now = toned(was, light.matrix, start, received, knee=1e9)
    wanted = light.exposure * mean_luminance(was, colors.weight)
    if wanted <= 0 or mean_luminance(now, colors.weight) <= 0:
        return start
    free = _solved(lambda gain: float(_linear(gain * now) @ colors.weight.numpy()), wanted)

    def shown(gain: float) -> float:
        tone = Tone(gain, light.contrast, pivot)
        return mean_luminance(toned(was, light.matrix, tone, received), colors.weight)

    gain = free if shown(free) >= wanted else min(_solved(shown, wanted), _MORE * free)
    return Tone(gain, light.contrast, pivot)


def _linear(rgb: Tensor) -> F64:
    """Luminance of display colours, not clamped above."""
    return np.asarray(to_linear(rgb.clamp(min=0).double().numpy()) @ LUMINANCE)


def _solved(measure: Callable[[float], float], wanted: float) -> float:
    """The gain for which a rising function takes a value, by bisection of its logarithm."""
    low, high = np.log(_GAINS[0]), np.log(_GAINS[1])
    for _ in range(_STEPS):
        middle = (low + high) / 2
        low, high = (middle, high) if measure(float(np.exp(middle))) < wanted else (low, middle)
    return float(np.exp((low + high) / 2))


def toned(rgb: Tensor, matrix: F64, tone: Tone, received: Tensor | None = None, knee: float = KNEE) -> Tensor:
    """Display colours `[M, 3]` under another light.

    Args:
        received: `[M, 3]` factors of linear light, None for one everywhere.
    """
    sh = color_to_dc(rgb.float())[:, None]
    return dc_to_color(_run(sh, torch.arange(len(rgb)), matrix, tone.row(knee), received, empty(sh.shape, sh))[:, 0])


def relit(
    cloud: GaussianCloud, rows: Tensor | None, matrix: F64, tone: Tone, received: Tensor | None = None
) -> GaussianCloud:
    """The cloud with some rows `[M]` under another light, all by default; the others stay bit for bit.

    Args:
        received: `[M, 3]` factors of linear light, None for one everywhere.
    """
    sh = cloud.sh.cpu().contiguous()
    every = rows is None or len(rows) == len(cloud)
    out = empty(sh.shape, sh) if every else copied(sh)
    chosen = torch.arange(len(cloud)) if rows is None else rows.cpu()
    return cloud.replace(sh=_run(sh, chosen, matrix, tone.row(), received, out).to(cloud.device))


def _run(sh: Tensor, rows: Tensor, matrix: F64, tone: Tensor, received: Tensor | None, out: Tensor) -> Tensor:
    from ...gaussians.compiled import run, workers
    from .kernels import relight

    light = _NONE if received is None else received.contiguous().numpy()
    if len(rows):
        arguments = (rows.numpy(), sh.numpy(), light, matrix.astype(np.float32), tone.numpy(), out.numpy())
        run(relight, workers(), *arguments)
    return out
