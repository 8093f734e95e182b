"""Fit the map that gives a surface a new pigment and leaves the light on it: albedo is replaced, shading stays.

A display colour splits into brightness and its departure from the surface's own hue:

    c = Y m / Y(m) + r,   Y = w·c the luma,   m the colour of its lit faces, w·r = 0

Shading is the luma relative to that of the lit faces, s = Y / Y(m): the product of light and fine texture. The new
pigment t, as its lit faces show in the scene's light, is multiplied by it:

    T(c) = t s + H r

H turns the departures to the new hue and weakens them, so that a pattern stays visible without its old hue. On a scan s
also holds differences between the materials of a thing, and where the new pigment is much lighter than the old one,
multiplying would enlarge noise and clip. So s is split into its low frequencies S (folds, sides, cast shadows; see
`shading`) and the fine contrast s / S around them, and both can be compressed:

    T(c) = B(S) / S (t ((1 - k) S + k s) + H r),   B(S) = S^p below lit faces, S^q above

A pigment that is as dark as the old one or darker has p = k = 1: ratios of neighbouring colours stay. One that is very
dark has k > 1, because what a surface mirrors does not depend on its pigment.

T is affine in c. Harmonics are linear in colour: with T(c) = A c + b the constant band becomes
A dc + (b + A h - h) / C0 (h = 0.5), every other band becomes A times itself, and a Gaussian shows exactly T of its old
colour in every direction. A and b vary as slowly over the surface as S does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from ...gaussians.color import lab_to_rgb, rgb_to_lab
from ...gaussians.harmonics import SH_C0
from ...gaussians.language.field.measure import Sample, lightness_spread
from ..color_map import LUMA
from .quantiles import quantile
from .seen import lit_color

PATTERN_SHARE = 0.2  # departures from the own hue keep at most this share of the requested chroma
BLACKEST = 0.1  # brightest channel of the darkest pigment: black cloth and paint reflect some light
_FIT_ROWS = 4096  # colours that the map is fitted on
_MIN_CHROMA = 6.0  # below this Lab chroma a colour counts as grey, without a hue
_MIN_LUMA = 0.01  # of lit faces: below it a surface is too dark to have shading
_CANDIDATES = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4)  # of k
_CLIPPED = 0.6  # share of k that stays even if highlights are clipped for it
_LEAST_FINE = 0.35  # share of fine contrast that always stays
_COARSE = 0.5  # p = k^_COARSE: large folds and sides keep more than fine contrast
_BRIGHT_SIDE, _LEAST_BRIGHT = 0.55, 0.15  # exponent of low frequencies above the lit faces, q
_VERY_DARK, _MIRRORED = 0.35, 0.4  # gain below which fine contrast grows on darker pigments, and with which exponent
_MOST_FINE = 1.6
_DIMMEST = 0.94  # the pigment is dimmed at most to this to leave room for highlights
_HIGHLIGHT = 0.97  # quantile of the shading that has to fit into the display's range
_RANGE = (0.04, 4.0)  # of S
_WEIGHTS = torch.tensor(LUMA, dtype=torch.float64)


@dataclass(frozen=True, eq=False)
class Repaint:
    """`T` of the module's docstring.

    Attributes:
        pigment: `[3]` float64, display colour of lit faces, t.
        pattern: `[3, 3]` float64, r turned and weakened: c to H r.
        lit: luma of the lit faces before, Y(m).
        fine: k.
        coarse: p.
        bright: q.
        amount: share of the way that it goes, 0 to 1; the rest stays the old colour.
    """

    pigment: Tensor
    pattern: Tensor
    lit: float
    fine: float
    coarse: float
    bright: float = _BRIGHT_SIDE
    amount: float = 1.0

    def __call__(self, rgb: Tensor, shading: Tensor | None = None) -> Tensor:
        """New colours `[M, 3]` of colours `[M, 3]`; `shading` as in `on_harmonics`."""
        matrix, gain, offset = self._parts(shading)
        made = self.amount * (gain * (rgb.double() @ matrix.T) + offset) + (1 - self.amount) * rgb.double()
        return made.to(rgb.dtype)

    def on_harmonics(self, sh: Tensor, shading: Tensor | None = None) -> Tensor:
        """Coefficients `[M, K, 3]` that show the new colour in every direction.

        Args:
            shading: `[M]` low frequencies of the luma at the Gaussians; None: those of lit faces everywhere.
        """
        matrix, gain, offset = self._parts(shading)
        half = torch.full((3,), 0.5, dtype=torch.float64)
        share = self.amount
        turned = (sh.reshape(-1, 3) @ matrix.T.to(sh)).reshape(sh.shape)
        turned *= (share * gain)[:, None].to(sh)
        if share < 1:
            turned += (1 - share) * sh
        shift = share * (gain * (matrix @ half) + offset - half) / SH_C0
        turned[:, 0] += shift.to(sh)
        return turned

    def mixed(self, amount: float) -> Repaint:
        """The map that goes only part of the way, 0 to 1."""
        return replace(self, amount=amount)

    def _parts(self, shading: Tensor | None) -> tuple[Tensor, Tensor, Tensor]:
        """A without its gain `[3, 3]`, the gain `[M, 1]` and b `[M, 3]`; M is 1 without shading."""
        matrix = torch.outer(self.fine / self.lit * self.pigment, _WEIGHTS) + self.pattern
        if shading is None:
            relative = torch.ones(1, dtype=torch.float64)
        else:
            relative = (shading.double() / self.lit).clamp(*_RANGE)
        base = torch.where(relative < 1, relative**self.coarse, relative**self.bright)
        return matrix, (base / relative)[:, None], (1 - self.fine) * base[:, None] * self.pigment


def fit(colors: Sample, aim: Tensor) -> Repaint:
    """The map that brings the lit faces of a surface to `aim`, a display colour `[3]` as the scene shows it.

    A display shows nothing lighter than a pure red or white, so the lit faces may stay a little darker than `aim` to
    leave room for highlights; nothing is painted blacker than `BLACKEST`.

    Args:
        colors: of the surface, before; not empty.
    """
    step = max(1, len(colors.rgb) // _FIT_ROWS)
    weight = colors.weight[::step]
    small = Sample(colors.rgb[::step], weight / weight.sum().clamp(min=1e-30))
    own = lit_color(small)
    lit = max(float(own @ _WEIGHTS), _MIN_LUMA)
    peak = max(quantile(small.rgb @ _WEIGHTS, small.weight, _HIGHLIGHT) / lit, 1.02)
    pigment = aim.clamp(0, 1) + max(0.0, BLACKEST - float(aim.clamp(0, 1).max()))
    gain = float(pigment @ _WEIGHTS) / lit
    fine, pigment = _within_display(pigment, _fine(small, pigment, lit), peak)
    # Low frequencies above the lit faces have to fit into the display's range too.
    room = -math.log(min(float(pigment.max()), 0.999)) / math.log(peak)
    bright = min(_BRIGHT_SIDE, max(room, _LEAST_BRIGHT))
    pattern = _pattern(small, own, rgb_to_lab(aim), min(1.0, gain))
    return Repaint(pigment, pattern, lit, fine, min(1.0, fine**_COARSE), bright)


def _fine(colors: Sample, pigment: Tensor, lit: float) -> float:
    """k: the largest with which the lightness of a lighter pigment varies no more than that of the old one; of a very
    dark one it is above 1."""
    gain = float(pigment @ _WEIGHTS) / lit
    if gain <= 1:
        return float(min(max((_VERY_DARK / gain) ** _MIRRORED, 1.0), _MOST_FINE))
    shading = (colors.rgb @ _WEIGHTS / lit)[:, None]
    allowed = lightness_spread(colors)
    for fine in _CANDIDATES:
        rgb = (pigment * (1 - fine + fine * shading)).clamp(0, 1)
        if lightness_spread(Sample(rgb, colors.weight)) <= allowed:
            return fine
    return _LEAST_FINE


def _within_display(pigment: Tensor, fine: float, peak: float) -> tuple[float, Tensor]:
    """k and pigment with which highlights, `peak` times as bright as lit faces, can be shown."""
    top = float(pigment.max())
    dim = max(_DIMMEST, min(1.0, 1 / (top * (1 + fine * (peak - 1)))))
    room = (1 / (top * dim) - 1) / (peak - 1)
    return min(fine, max(room, _LEAST_FINE, _CLIPPED * fine)), dim * pigment


def _pattern(colors: Sample, own: Tensor, asked: Tensor, gain: float) -> Tensor:
    """`[3, 3]`: a colour to H applied to its departure from the own hue."""
    luma = float(_WEIGHTS @ own)
    own_hue = own / luma if luma > 0.02 else torch.ones(3, dtype=torch.float64)  # too dark to have a hue
    departures = torch.eye(3, dtype=torch.float64) - torch.outer(own_hue, _WEIGHTS)
    was = rgb_to_lab(own.clamp(0, 1))
    had, want = (float(torch.linalg.vector_norm(c[1:])) for c in (was, asked))
    spread = float((colors.weight[:, None] * (colors.rgb @ departures.T) ** 2).sum().sqrt())
    scale = min(gain, want / had) if had > _MIN_CHROMA else gain
    # One unit of display colour away from grey is about 110 units of Lab chroma.
    scale = min(scale, PATTERN_SHARE * want / max(110 * spread, 1e-6))
    if had < _MIN_CHROMA or want < _MIN_CHROMA:
        return scale * departures
    angle = math.atan2(float(asked[2]), float(asked[1])) - math.atan2(float(was[2]), float(was[1]))
    return scale * _hue_rotation(angle) @ departures


def _hue_rotation(angle: float) -> Tensor:
    """Rotation of the plane of constant luma by a hue angle (radians, Lab's sense), as a `[3, 3]` map that keeps luma.
    The plane's axes are the display colours in Lab's +a and +b directions from mid grey."""
    grey = torch.tensor([60.0, 0.0, 0.0], dtype=torch.float64)
    toward = lab_to_rgb(grey + torch.eye(3, dtype=torch.float64)[1:]) - lab_to_rgb(grey)
    ones = torch.ones(3, dtype=torch.float64)
    plane = torch.stack([ones, *(v - ones * (_WEIGHTS @ v) for v in toward)], dim=1)
    c, s = math.cos(angle), math.sin(angle)
    turn = torch.tensor([[1, 0, 0], [0, c, -s], [0, s, c]], dtype=torch.float64)
    turned: Tensor = plane @ turn @ torch.linalg.inv(plane)
    return turned
