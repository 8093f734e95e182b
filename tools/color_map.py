"""One affine map of colour for one recolouring, fitted to what the edit means in CIE Lab.

A display colour splits into brightness and what departs from the object's own hue:

    c = Y(c) + r(c),   Y = w·c the luma,   r(c) = c - m Y(c) / Y(m) its departure from the mean colour m, with Y(r) = 0

and is mapped to

    T(c) = t + k d (Y(c) - Y(m)) + H r(c)

t is the asked colour in the light that the target has on average: what people call a thing's colour is that of its
lit faces (see gaussians.language.measure), so these meet the asked colour and shading goes down from there. d is the
way the asked colour goes when light on it changes (toward black for most colours, along grey for near-black and
near-white ones), k keeps the spread of lightness, and H turns and scales the departures so that a pattern stays
visible without its old hue. So shading and texture stay, hue and chroma move with the lit faces.

T is affine, and that is why it was chosen over a map in Lab for each Gaussian: harmonics are linear in colour, so
with T(c) = A c + b the constant band becomes A dc + (b + A h - h) / C0 (h = 0.5, the offset of display colour), every
other band becomes A times itself, and the recoloured Gaussian seen from *any* direction shows exactly T of what it
showed. A Jacobian for each Gaussian would be right to first order only and would tint highlights.

Knows colours. Refuses to know Gaussians' places and words.
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
PATTERN = 0.35  # departures from the mean hue keep at most this share of the asked chroma
_STRENGTHS = (1.0, 0.4, 0.1)  # tried strengths of the pattern
# How near (CIE94) the lit faces have to come. A pure colour at the end of the display's range has to give up lightness
# for light and shadow: 5 off are usual, and a target of several colours whose pattern stays visible doubles that.
# Half as far again is the border to another colour name.
NEAR = 15.0
_ROUNDS = 3  # of the fit; each closes most of the remaining distance
_FIT_ROWS = 600  # colours the map is fitted on: its mean is known to about 4 % of the spread
_GAINS = (0.15, 0.3, 0.5, 0.75, 1.0)  # tried shares of the lightness spread
_DIMMED = (1.0, 0.94, 0.88, 0.8, 0.72)  # tried brightnesses of the asked colour
_LIFTED = (0.04, 0.08, 0.12)  # tried lifts from black
_DEEPEST = 0.5  # the mean keeps at least this share of the lit faces' lightness
_DUE = 0.75  # at least this share of the spread is due on a darker colour, or a way back to the old one would be flat
_GREY_CHROMA = 6.0  # below this Lab chroma a colour has no hue to speak of


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
        lift = (self(half) - half) / SH_C0
        return torch.cat([turned[:, :1] + lift.to(sh), turned[:, 1:]], dim=1)


def toward_color(taken: Sample, asked: Tensor, *, keep_pattern: bool = False) -> ColorMap:
    """The map that brings the sample's lit faces (`lit_lab`) near `asked` Lab `[3]`, keeping shading and texture.

    A pure red or white leaves no room on a display for lighter places, so the lit faces may stay a little darker (or,
    for black, lighter) than asked: brightness gain and aim are chosen together on a small grid, weighing the distance
    from the asked colour, the loss of lightness spread, and what would leave the display.

    Args:
        keep_pattern: leave departures from the mean hue as strong as they are (for adjustments), rather than letting
            them keep only a share of the asked chroma (for a new colour).
    """
    small = _thinned(taken)
    weights = torch.tensor(LUMA, dtype=torch.float64)
    mean = (small.weight[:, None] * small.rgb).sum(dim=0)
    luma = float(weights @ mean)
    own_hue = mean / luma if luma > 0.02 else torch.ones(3, dtype=torch.float64)  # too dark to have a hue
    departures = torch.eye(3, dtype=torch.float64) - torch.outer(own_hue, weights)
    pattern = _pattern_turn(small, departures, mean_lab(small), asked, keep_pattern) @ departures
    goals, gains = _candidates(asked)
    best, lowest = None, math.inf
    for strength in _STRENGTHS:  # a loud pattern may leave the display; then, and only then, it is toned down
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
    """CIE94 distance of Lab colours `[..., 3]` from the asked one, graphic-arts weights.

    CIE76 would call a slightly darker pure red as far off as a pink; here a chroma of 100 counts 5.5 times less.
    """
    lightness, chroma = shown[..., 0] - asked[..., 0], torch.linalg.vector_norm(asked[..., 1:], dim=-1)
    off_chroma = torch.linalg.vector_norm(shown[..., 1:], dim=-1) - chroma
    off_plane = torch.linalg.vector_norm(shown[..., 1:] - asked[..., 1:], dim=-1)
    off_hue = (off_plane**2 - off_chroma**2).clamp(min=0).sqrt()
    by_chroma, by_hue = off_chroma / (1 + 0.045 * chroma), off_hue / (1 + 0.015 * chroma)
    return torch.sqrt(lightness**2 + by_chroma**2 + by_hue**2)


def _thinned(taken: Sample) -> Sample:
    step = max(1, len(taken.rgb) // _FIT_ROWS)
    weight = taken.weight[::step]
    return Sample(taken.rgb[::step], weight / weight.sum().clamp(min=1e-30))


def _candidates(asked: Tensor) -> tuple[Tensor, Tensor]:
    """Lit colours `[B, 3]` (Lab) and shares of the lightness spread `[B]` to try: as asked, dimmed, or off black."""
    rgb = lab_to_rgb(asked).clamp(0, 1)
    lit = [rgb * dim for dim in _DIMMED] + [(rgb + lift).clamp(max=1) for lift in _LIFTED]
    labs, gains = rgb_to_lab(torch.stack(lit)), torch.tensor(_GAINS, dtype=torch.float64)
    return labs.repeat_interleave(len(gains), dim=0), gains.repeat(len(labs))


def _in_shade(lit: Tensor, drop: Tensor) -> Tensor:
    """The mean Lab `[B, 3]` of what is `drop` `[B]` darker on average than its lit faces `[B, 3]`."""
    return torch.cat([torch.maximum(lit[:, 0] - drop, _DEEPEST * lit[:, 0])[:, None], lit[:, 1:]], dim=1)


@dataclass(frozen=True, eq=False)
class _Fit:
    """Many candidate maps at once, `B` of them; `pattern` is H r of the module's docstring as a matrix."""

    taken: Sample
    mean: Tensor
    pattern: Tensor

    def solve(self, goals: Tensor, gains: Tensor) -> tuple[Tensor, Tensor]:
        """Maps `[B, 3, 3]`, `[B, 3]` that keep `gains` of the spread and whose lit faces meet `goals`, within limits.

        The aim is corrected for what the clamp and the curvature of Lab shift, but never leaves the display: that
        would buy the last step with the texture.
        """
        weight, spreads = self.taken.weight, gains * lightness_spread(self.taken)
        drop = (lit_of(weight, self.taken.lab) - mean_lab(self.taken))[0].clamp(min=0)
        means = _in_shade(goals, gains * drop)
        aims = means.clone()
        for _ in range(_ROUNDS):
            shown = self._shown(*self._compose(aims, spreads))
            off = means - _mean(weight, shown)
            off[:, 0] = goals[:, 0] - lit_of(weight, shown)[:, 0]
            aims = rgb_to_lab(lab_to_rgb(aims + off.clamp(-6, 6)).clamp(0, 1))
        return self._compose(aims, spreads)

    def cost(self, matrices: Tensor, offsets: Tensor, asked: Tensor) -> tuple[Tensor, Tensor]:
        """Distance from the asked colour `[B]`, and all that is wrong `[B]`.

        The latter is 1 for 6 units off, for a spread off by a factor 1.6, for 0.04 rms outside the display.
        """
        rgb = self._mapped(matrices, offsets)
        lab = rgb_to_lab(rgb.clamp(0, 1))
        off = distance(lit_of(self.taken.weight, lab), asked)
        flat = ((_spread(self.taken.weight, lab) + 0.5) / (self._due(asked) + 0.5)).log()
        outside = (self.taken.weight[:, None] * (rgb - rgb.clamp(0, 1)) ** 2).sum(dim=(1, 2)).sqrt()
        return off, (off / 6) ** 2 + (flat / 0.47) ** 2 + (outside / 0.04) ** 2

    def _due(self, asked: Tensor) -> float:
        """The lightness spread that is due on the asked colour: a darker one shows less, as less light comes back."""
        lit = float(lit_of(self.taken.weight, self.taken.lab)[0])
        return lightness_spread(self.taken) * min(1.0, max(_DUE, (float(asked[0]) + 16) / (lit + 16)))

    def _compose(self, aims: Tensor, spreads: Tensor) -> tuple[Tensor, Tensor]:
        weights = torch.tensor(LUMA, dtype=torch.float64)
        targets = lab_to_rgb(aims)
        light = _light_directions(targets, weights)
        steps = self.taken.rgb @ weights - weights @ self.mean
        deviation = float((self.taken.weight * steps**2).sum().sqrt())
        # Lab lightness is about 116 v^(2.2 / 3) - 16 in display luma v, so its slope is 85 v^-0.27.
        slope = 85 * (targets.clamp(0, 1) @ weights).clamp(min=0.02) ** -0.27
        gain = spreads / (slope * deviation) if deviation > 1e-6 else torch.ones_like(spreads)
        matrices = (gain[:, None] * light)[:, :, None] * weights + self.pattern
        return matrices, targets - matrices @ self.mean

    def _mapped(self, matrices: Tensor, offsets: Tensor) -> Tensor:
        return self.taken.rgb @ matrices.transpose(1, 2) + offsets[:, None]  # [B, M, 3]

    def _shown(self, matrices: Tensor, offsets: Tensor) -> Tensor:
        return rgb_to_lab(self._mapped(matrices, offsets).clamp(0, 1))


def _mean(weight: Tensor, lab: Tensor) -> Tensor:
    return torch.einsum("m,bmc->bc", weight, lab)


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
    """Directions `[B, 3]` of unit luma along which targets vary with light: their own, mixed with grey when dark."""
    luma = (targets @ weights)[:, None]
    share = (luma / 0.1).clamp(0, 1)
    mixed = share * targets / luma.clamp(min=1e-6) + (1 - share)
    return mixed / (mixed @ weights)[:, None]


def _pattern_turn(taken: Sample, departures: Tensor, mean: Tensor, asked: Tensor, keep: bool) -> Tensor:
    """H: how departures from the mean hue are turned and scaled, `[3, 3]`, within the plane of constant luma."""
    identity = torch.eye(3, dtype=torch.float64)
    had, want = (float(torch.linalg.vector_norm(c[1:])) for c in (mean, asked))
    if keep:
        return identity
    spread = float((taken.weight[:, None] * (taken.rgb @ departures.T) ** 2).sum().sqrt())
    scale = min(1.0, want / max(had, 1e-6)) if had > _GREY_CHROMA else 1.0
    # A unit of display colour away from grey is about 110 units of Lab chroma.
    scale = min(scale, PATTERN * want / max(110 * spread, 1e-6))
    if had < _GREY_CHROMA or want < _GREY_CHROMA:
        return scale * identity
    angle = math.atan2(float(asked[2]), float(asked[1])) - math.atan2(float(mean[2]), float(mean[1]))
    return scale * _hue_rotation(angle)


def _hue_rotation(angle: float) -> Tensor:
    """Turn of the plane of constant luma by a hue angle (radians, Lab's sense), as a `[3, 3]` map that keeps luma.

    The plane's axes are the display colours that Lab calls +a and +b from mid grey.
    """
    grey = torch.tensor([60.0, 0.0, 0.0], dtype=torch.float64)
    h = 1.0
    toward = [
        (lab_to_rgb(grey + torch.tensor(v, dtype=torch.float64)) - lab_to_rgb(grey)) / h for v in ((0, h, 0), (0, 0, h))
    ]
    weights = torch.tensor(LUMA, dtype=torch.float64)
    ones = torch.ones(3, dtype=torch.float64)
    plane = torch.stack([ones, *(v - ones * (weights @ v) for v in toward)], dim=1)
    c, s = math.cos(angle), math.sin(angle)
    turn = torch.tensor([[1, 0, 0], [0, c, -s], [0, s, c]], dtype=torch.float64)
    turned: Tensor = plane @ turn @ torch.linalg.inv(plane)
    return turned
