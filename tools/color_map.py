"""Fit one affine colour map that recolours an object: the target colour in CIE Lab is met, shading and texture stay.

A display colour splits into brightness and its departure from the object's own hue:

    c = Y(c) + r(c),   Y = w·c the luma,   r(c) = c - m Y(c) / Y(m) its departure from the mean colour m, with Y(r) = 0

and is mapped to

    T(c) = t + k d (Y(c) - Y(m)) + H r(c)

t is the requested colour under the target's average light. People name an object's colour after its lit faces (see
gaussians.language.field.measure), so the lit faces get the requested colour and shaded ones are darker. d is the
direction in which the requested colour changes with the light on it (toward black for most colours, along grey for
near-black and near-white ones), k keeps the spread of lightness, and H rotates and scales the departures so that a
pattern stays visible without its old hue. So shading and texture stay, and hue and chroma move with the lit faces.

T is affine because harmonics are linear in colour: with T(c) = A c + b the constant band becomes
A dc + (b + A h - h) / C0 (h = 0.5, the offset of display colour), every other band becomes A times itself, and the
recoloured Gaussian shows exactly T of its old colour from *any* direction. A map in Lab for each Gaussian would need a
Jacobian, which is right to first order only and would tint highlights.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from ..gaussians.color import lab_to_rgb, rgb_to_lab
from ..gaussians.harmonics import SH_C0
from ..gaussians.language.field.measure import Sample, lightness_spread, lit_of, mean_lab

LUMA = (0.2126, 0.7152, 0.0722)  # ITU-R BT.709
PATTERN_SHARE = 0.35  # departures from the mean hue keep at most this share of the requested chroma
_STRENGTHS = (1.0, 0.4, 0.1)  # candidate strengths of the pattern
# Largest allowed CIE94 distance of the lit faces from the requested colour. A pure colour at the end of the display's
# range has to change its lightness to leave room for light and shadow: a distance of 5 is usual, and twice that for a
# target of several colours whose pattern stays visible. At half as much again another colour name begins.
NEAR = 15.0
_ITERATIONS = 3  # of the fit; each removes most of the remaining distance
_FIT_ROWS = 600  # colours that the map is fitted on: their mean is known to about 4 % of the spread
_GAINS = (0.15, 0.3, 0.5, 0.75, 1.0)  # candidate shares of the lightness spread
_DIM_FACTORS = (1.0, 0.94, 0.88, 0.8, 0.72)  # candidate brightnesses of the requested colour
_LIFTS = (0.04, 0.08, 0.12)  # candidate lifts from black
_MIN_MEAN = 0.5  # the mean keeps at least this share of the lit faces' lightness
# A darker colour is expected to keep this share of the lightness spread; with less, recolouring back would look flat.
_MIN_SPREAD = 0.75
_MIN_CHROMA = 6.0  # below this Lab chroma a colour counts as grey, without a hue


@dataclass(frozen=True, eq=False)
class ColorMap:
    """`c -> matrix @ c + offset` on display colours.

    Attributes:
        matrix: `[3, 3]` float64.
        offset: `[3]` float64.
    """

    matrix: Tensor
    offset: Tensor

    def __call__(self, rgb: Tensor) -> Tensor:
        """Mapped colours `[..., 3]`."""
        return rgb @ self.matrix.T.to(rgb.dtype) + self.offset.to(rgb.dtype)

    def on_harmonics(self, sh: Tensor) -> Tensor:
        """Coefficients `[N, K, 3]` that show the mapped colour in every direction."""
        turned = sh @ self.matrix.T.to(sh)
        half = torch.full((3,), 0.5, dtype=torch.float64)
        return torch.cat([turned[:, :1] + ((self(half) - half) / SH_C0).to(sh), turned[:, 1:]], dim=1)


def toward_color(colors: Sample, asked: Tensor, *, keep_pattern: bool = False) -> ColorMap:
    """The map that brings the sample's lit faces (`lit_lab`) near `asked` Lab `[3]`, keeping shading and texture.

    A display shows nothing lighter than a pure red or white, so the lit faces may stay a little darker (or, for black,
    lighter) than requested. Brightness gain and aim are chosen together on a small grid by the distance from the
    requested colour, the loss of lightness spread, and the amount outside the display's range.

    Args:
        keep_pattern: leave departures from the mean hue as strong as they are (for adjustments), rather than limiting
            them to a share of the requested chroma (for a new colour).
    """
    small = _thinned(colors)
    weights = torch.tensor(LUMA, dtype=torch.float64)
    mean = (small.weight[:, None] * small.rgb).sum(dim=0)
    luma = float(weights @ mean)
    own_hue = mean / luma if luma > 0.02 else torch.ones(3, dtype=torch.float64)  # too dark to have a hue
    departures = torch.eye(3, dtype=torch.float64) - torch.outer(own_hue, weights)
    pattern = _pattern_turn(small, departures, mean_lab(small), asked, keep_pattern) @ departures
    goals, gains = _candidates(asked)
    best, lowest = None, math.inf
    for strength in _STRENGTHS:  # weaken a strong pattern only if it leaves the display's range
        fit = _Fit(small, mean, strength * pattern)
        matrices, offsets = fit.solve(goals, gains)
        off, cost = fit.cost(matrices, offsets, asked)
        index = int(cost.argmin())
        if float(cost[index]) < lowest:
            best, lowest = ColorMap(matrices[index], offsets[index]), float(cost[index])
        if float(off[index]) < 0.6 * NEAR:
            break
    assert best is not None
    return best


def distance(shown: Tensor, asked: Tensor) -> Tensor:
    """CIE94 distance of Lab colours `[..., 3]` from the requested one, graphic-arts weights.

    CIE76 gives a slightly darker pure red the same distance as a pink; CIE94 divides chroma differences at a chroma of
    100 by 5.5.
    """
    lightness, chroma = shown[..., 0] - asked[..., 0], torch.linalg.vector_norm(asked[..., 1:], dim=-1)
    off_chroma = torch.linalg.vector_norm(shown[..., 1:], dim=-1) - chroma
    off_plane = torch.linalg.vector_norm(shown[..., 1:] - asked[..., 1:], dim=-1)
    off_hue = (off_plane**2 - off_chroma**2).clamp(min=0).sqrt()
    by_chroma, by_hue = off_chroma / (1 + 0.045 * chroma), off_hue / (1 + 0.015 * chroma)
    return torch.sqrt(lightness**2 + by_chroma**2 + by_hue**2)


def _thinned(colors: Sample) -> Sample:
    step = max(1, len(colors.rgb) // _FIT_ROWS)
    weight = colors.weight[::step]
    return Sample(colors.rgb[::step], weight / weight.sum().clamp(min=1e-30))


def _candidates(asked: Tensor) -> tuple[Tensor, Tensor]:
    """Candidate lit colours `[B, 3]` (Lab): as requested, dimmed or lifted from black; and spread shares `[B]`."""
    rgb = lab_to_rgb(asked).clamp(0, 1)
    lit = [rgb * dim for dim in _DIM_FACTORS] + [(rgb + lift).clamp(max=1) for lift in _LIFTS]
    labs, gains = rgb_to_lab(torch.stack(lit)), torch.tensor(_GAINS, dtype=torch.float64)
    return labs.repeat_interleave(len(gains), dim=0), gains.repeat(len(labs))


def _in_shade(lit: Tensor, drop: Tensor) -> Tensor:
    """The mean Lab `[B, 3]` of an object that is `drop` `[B]` darker on average than its lit faces `[B, 3]`."""
    return torch.cat([torch.maximum(lit[:, 0] - drop, _MIN_MEAN * lit[:, 0])[:, None], lit[:, 1:]], dim=1)


@dataclass(frozen=True, eq=False)
class _Fit:
    """`B` candidate maps at once; `pattern` is H r of the module's docstring as a matrix."""

    colors: Sample
    mean: Tensor
    pattern: Tensor

    def solve(self, goals: Tensor, gains: Tensor) -> tuple[Tensor, Tensor]:
        """Maps `[B, 3, 3]`, `[B, 3]` that keep `gains` of the spread and whose lit faces meet `goals`, within limits.

        The aim is corrected for the shift by the clamp and the curvature of Lab, but stays within the display's range:
        beyond it the last step toward the goal would cost texture.
        """
        weight, spreads = self.colors.weight, gains * lightness_spread(self.colors)
        drop = (lit_of(weight, self.colors.lab) - mean_lab(self.colors))[0].clamp(min=0)
        means = _in_shade(goals, gains * drop)
        aims = means.clone()
        for _ in range(_ITERATIONS):
            shown = rgb_to_lab(self._mapped(*self._compose(aims, spreads)).clamp(0, 1))
            off = means - torch.einsum("m,bmc->bc", weight, shown)
            off[:, 0] = goals[:, 0] - lit_of(weight, shown)[:, 0]
            aims = rgb_to_lab(lab_to_rgb(aims + off.clamp(-6, 6)).clamp(0, 1))
        return self._compose(aims, spreads)

    def cost(self, matrices: Tensor, offsets: Tensor, asked: Tensor) -> tuple[Tensor, Tensor]:
        """Distance from the requested colour `[B]` and total cost `[B]`.

        The cost is the sum of three terms, each 1 for a distance of 6 units, for a spread wrong by a factor of 1.6,
        and for 0.04 RMS outside the display's range.
        """
        rgb = self._mapped(matrices, offsets)
        lab = rgb_to_lab(rgb.clamp(0, 1))
        off = distance(lit_of(self.colors.weight, lab), asked)
        flat = ((_spread(self.colors.weight, lab) + 0.5) / (self._expected_spread(asked) + 0.5)).log()
        outside = (self.colors.weight[:, None] * (rgb - rgb.clamp(0, 1)) ** 2).sum(dim=(1, 2)).sqrt()
        return off, (off / 6) ** 2 + (flat / 0.47) ** 2 + (outside / 0.04) ** 2

    def _expected_spread(self, asked: Tensor) -> float:
        """The lightness spread expected of the requested colour: smaller on a darker one, which reflects less light."""
        lit = float(lit_of(self.colors.weight, self.colors.lab)[0])
        return lightness_spread(self.colors) * min(1.0, max(_MIN_SPREAD, (float(asked[0]) + 16) / (lit + 16)))

    def _compose(self, aims: Tensor, spreads: Tensor) -> tuple[Tensor, Tensor]:
        weights = torch.tensor(LUMA, dtype=torch.float64)
        targets = lab_to_rgb(aims)
        light = _light_directions(targets, weights)
        steps = self.colors.rgb @ weights - weights @ self.mean
        deviation = float((self.colors.weight * steps**2).sum().sqrt())
        # Lab lightness is about 116 v^(2.2 / 3) - 16 in display luma v, so its slope is 85 v^-0.27.
        slope = 85 * (targets.clamp(0, 1) @ weights).clamp(min=0.02) ** -0.27
        gain = spreads / (slope * deviation) if deviation > 1e-6 else torch.ones_like(spreads)
        matrices = (gain[:, None] * light)[:, :, None] * weights + self.pattern
        return matrices, targets - matrices @ self.mean

    def _mapped(self, matrices: Tensor, offsets: Tensor) -> Tensor:
        return self.colors.rgb @ matrices.transpose(1, 2) + offsets[:, None]  # [B, M, 3]


def _spread(weight: Tensor, lab: Tensor) -> Tensor:
    lightness = lab[..., 0]
    return (weight * (lightness - (weight * lightness).sum(dim=1, keepdim=True)) ** 2).sum(dim=1).sqrt()


def saturation(factor: float) -> ColorMap:
    """Chroma times `factor` about each colour's own grey: `c -> Y + factor (c - Y)`."""
    grey = torch.tensor(LUMA, dtype=torch.float64).expand(3, 3)
    return ColorMap(
        factor * torch.eye(3, dtype=torch.float64) + (1 - factor) * grey, torch.zeros(3, dtype=torch.float64)
    )


def warmth(amount: float) -> ColorMap:
    """White balance: positive strengthens red and weakens blue, at constant luma of grey."""
    gain = torch.tensor([1 + 0.35 * amount, 1.0, 1 - 0.45 * amount], dtype=torch.float64)
    gain = gain / (gain @ torch.tensor(LUMA, dtype=torch.float64))
    return ColorMap(torch.diag(gain), torch.zeros(3, dtype=torch.float64))


def _light_directions(targets: Tensor, weights: Tensor) -> Tensor:
    """Directions `[B, 3]` of unit luma in which colours change with light: their own, mixed with grey when dark."""
    luma = (targets @ weights)[:, None]
    share = (luma / 0.1).clamp(0, 1)
    mixed = share * targets / luma.clamp(min=1e-6) + (1 - share)
    return mixed / (mixed @ weights)[:, None]


def _pattern_turn(colors: Sample, departures: Tensor, mean: Tensor, asked: Tensor, keep: bool) -> Tensor:
    """H, `[3, 3]`: rotates and scales departures from the mean hue within the plane of constant luma."""
    identity = torch.eye(3, dtype=torch.float64)
    had, want = (float(torch.linalg.vector_norm(c[1:])) for c in (mean, asked))
    if keep:
        return identity
    spread = float((colors.weight[:, None] * (colors.rgb @ departures.T) ** 2).sum().sqrt())
    scale = min(1.0, want / max(had, 1e-6)) if had > _MIN_CHROMA else 1.0
    # One unit of display colour away from grey is about 110 units of Lab chroma.
    scale = min(scale, PATTERN_SHARE * want / max(110 * spread, 1e-6))
    if had < _MIN_CHROMA or want < _MIN_CHROMA:
        return scale * identity
    angle = math.atan2(float(asked[2]), float(asked[1])) - math.atan2(float(mean[2]), float(mean[1]))
    return scale * _hue_rotation(angle)


def _hue_rotation(angle: float) -> Tensor:
    """Rotation of the plane of constant luma by a hue angle (radians, Lab's sense), as a `[3, 3]` map that keeps luma.
    The plane's axes are the display colours in Lab's +a and +b directions from mid grey."""
    grey = torch.tensor([60.0, 0.0, 0.0], dtype=torch.float64)
    toward = lab_to_rgb(grey + torch.eye(3, dtype=torch.float64)[1:]) - lab_to_rgb(grey)
    weights = torch.tensor(LUMA, dtype=torch.float64)
    ones = torch.ones(3, dtype=torch.float64)
    plane = torch.stack([ones, *(v - ones * (weights @ v) for v in toward)], dim=1)
    c, s = math.cos(angle), math.sin(angle)
    turn = torch.tensor([[1, 0, 0], [0, c, -s], [0, s, c]], dtype=torch.float64)
    turned: Tensor = plane @ turn @ torch.linalg.inv(plane)
    return turned
