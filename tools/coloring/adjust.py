"""Relative changes of colour as maps: darker, lighter, more or less saturated, warmer, cooler.

They change the light or the pigment of everything in a selection alike: the ratio of two colours stays what it was, and
what is grey stays grey.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from ...gaussians.color import lab_to_rgb
from ...gaussians.harmonics import SH_C0, dc_to_color
from ...gaussians.language.field.measure import Sample
from ..color_map import LUMA, ColorMap
from .quantiles import quantile
from .seen import lit_color, lit_face

_STEP = 0.75  # share of the lightness (or, lighter, of what is missing to white) that the amount 1 changes
_HIGHLIGHT = 0.995  # quantile of the brightest channel that is not to be clipped
_TOP = 0.985  # display value that it reaches at most
_DARKEST = 10.0  # Lab lightness that is lightened as if it were this: near black, a factor shows nothing
_ABOVE, _BELOW = 0.02, 0.08  # display values outside the range by less are not seen as clipped
_WEIGHTS = torch.tensor(LUMA, dtype=torch.float64)
_NO_OFFSET = torch.zeros(3, dtype=torch.float64)
_SAME = torch.eye(3, dtype=torch.float64)


def darker(colors: Sample, amount: float) -> ColorMap:
    """Less light or a darker pigment: one factor for all colours, so that lit faces lose `_STEP` of `amount` of their
    lightness."""
    lightness = float(lit_face(colors)[0])
    return ColorMap(_factor(lightness, lightness * (1 - _STEP * amount)) * _SAME, _NO_OFFSET)


@dataclass(frozen=True, eq=False)
class Lift:
    """A lightening without clipping: what is bright gets a smaller gain than what is dark.

    Around a place of luma S the gain is `gain / (1 + (gain - 1) S)`, which leaves black and white where they are. S is
    smooth, so that colours beside each other keep their ratios, and what is grey by mixture stays grey. A Gaussian with
    a channel that would be clipped gets a smaller gain. All of this is linear in the Gaussian's colour, so all bands of
    its harmonics get the same factor.

    Attributes:
        gain: that of the darkest places, at least 1.
    """

    gain: float

    def on_harmonics(self, sh: Tensor, shading: Tensor | None = None) -> Tensor:
        """Coefficients `[N, K, 3]` of the lightened colours, in every direction.

        Args:
            shading: `[N]` low frequencies of the luma at the Gaussians; None: each Gaussian's own luma.
        """
        gain = self._of(dc_to_color(sh[:, 0].double()), shading)
        made = sh * gain[:, None, None].to(sh)
        made[:, 0] += (0.5 * (gain - 1) / SH_C0)[:, None].to(sh)
        return made

    def __call__(self, rgb: Tensor, shading: Tensor | None = None) -> Tensor:
        """Lightened colours `[M, 3]`."""
        return rgb * self._of(rgb.double(), shading)[:, None].to(rgb)

    def _of(self, rgb: Tensor, shading: Tensor | None) -> Tensor:
        """Gain `[M]` of colours `[M, 3]` float64."""
        around = (_luma(rgb)[:, 0] if shading is None else shading.double()).clamp(0, 1)
        gain = self.gain / (1 + (self.gain - 1) * around)
        return gain.minimum((_TOP / rgb.max(dim=1).values.clamp(min=1e-6)).clamp(min=1.0))


def _luma(rgb: Tensor) -> Tensor:
    """`[..., 1]`, float64."""
    return (rgb @ _WEIGHTS)[..., None]


def lighter(colors: Sample, amount: float) -> ColorMap | Lift:
    """More light or a lighter pigment: one factor for all colours if highlights permit, else a `Lift`."""
    lightness = max(float(lit_face(colors)[0]), _DARKEST)
    wanted = min(lightness + _STEP * amount * (100 - lightness), lightness / (1 - _STEP * amount))
    gain = _factor(lightness, wanted)
    peak = quantile(colors.rgb.max(dim=1).values, colors.weight, _HIGHLIGHT)
    if gain * peak <= _TOP:
        return ColorMap(gain * _SAME, _NO_OFFSET)
    lit = min(max(float(lit_color(colors) @ _WEIGHTS), 0.02), 0.97)
    goal = min(gain * lit, 0.5 * (1 + lit))
    return Lift(max(1.0, goal * (1 - lit) / (lit * (1 - goal))))


@dataclass(frozen=True, eq=False)
class Saturation:
    """Chroma times a factor about each colour's own grey: `c -> Y tint + factor (c - Y tint)`, Y its luma.

    A Gaussian whose colour would leave the display's range gets a smaller factor, never below 1, so that its hue stays.
    The map is linear in the Gaussian's colour, so all bands of its harmonics get the same matrix.

    Attributes:
        factor: at least 0; 1 leaves colours as they are.
        tint: `[3]` colour of the light with luma 1, in which a grey thing shows.
    """

    factor: float
    tint: Tensor

    def on_harmonics(self, sh: Tensor) -> Tensor:
        """Coefficients `[N, K, 3]` of the colours with their new chroma, in every direction."""
        color = sh.to(torch.float64, copy=True)
        color[:, 0] += 0.5 / SH_C0
        factor = self._factors(color[:, 0] * SH_C0)[:, None, None]
        color = factor * color + (1 - factor) * _luma(color) * self.tint
        color[:, 0] -= 0.5 / SH_C0
        return color.to(sh.dtype)

    def __call__(self, rgb: Tensor) -> Tensor:
        """Colours `[M, 3]` with their new chroma."""
        factor = self._factors(rgb.double())[:, None]
        return (factor * rgb + (1 - factor) * _luma(rgb.double()) * self.tint).to(rgb.dtype)

    def _factors(self, rgb: Tensor) -> Tensor:
        """Factor `[M]` of each colour `[M, 3]`, float64."""
        if self.factor <= 1:
            return torch.full((len(rgb),), self.factor, dtype=torch.float64)
        grey = _luma(rgb) * self.tint
        departure = rgb - grey
        room = torch.where(departure > 0, _TOP - grey, grey) / departure.abs().clamp(min=1e-6)
        return room.min(dim=1).values.clamp(1.0, self.factor)


Change = ColorMap | Lift | Saturation


def warmth(amount: float) -> ColorMap:
    """White balance: positive strengthens red and weakens blue, at constant luma of grey."""
    gain = torch.tensor([1 + 0.35 * amount, 1.0, 1 - 0.45 * amount], dtype=torch.float64)
    return ColorMap(torch.diag(gain / (gain @ _WEIGHTS)), _NO_OFFSET)


def shown_warmth(colors: Sample, amount: float) -> ColorMap:
    """`warmth`, dimmed as far as the highlights need it to keep their tint."""
    change = warmth(amount)
    was, now = (quantile(c.max(dim=1).values, colors.weight, _HIGHLIGHT) for c in (colors.rgb, change(colors.rgb)))
    dim = min(1.0, max(_TOP, min(was, 1.0)) / max(now, 1e-3))
    return ColorMap(max(dim, 0.8) * change.matrix, change.offset)


def clipped(was: Tensor, now: Tensor, weight: Tensor) -> float:
    """Share of the weight `[M]` of the colours `[M, 3]` that a change took out of the display's range, visibly."""
    out = (now > 1 + _ABOVE) & (was <= 1 + _ABOVE) | (now < -_BELOW) & (was >= -_BELOW)
    return float(weight[out.any(dim=1)].sum())


def _factor(was: float, now: float) -> float:
    """Factor of display values that takes a grey of lightness `was` to lightness `now`."""
    greys = torch.tensor([[max(was, 0.5), 0.0, 0.0], [max(now, 0.5), 0.0, 0.0]], dtype=torch.float64)
    old, new = lab_to_rgb(greys)[:, 1].tolist()
    return float(new / max(old, 1e-3))
