"""Estimate the light of a scene: the display colour that a white surface has in it (exposure and white balance).

A colour word means a pigment. What a camera shows is pigment times light, channel by channel, so "dark purple" in a dim
warm room is darker and warmer than on a paint card. The reference is what surfaces of known colour look like: among
the bright surfaces of a scene the near-neutral ones (walls, ceilings, paper, crockery) are taken as white.

Display values are used throughout: for a display whose transfer is a power law, a product of linear light is a product
of display values too.
"""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.color import rgb_to_lab
from ...gaussians.language.field.measure import Sample, sample
from ..color_map import LUMA
from .quantiles import quantile

WHITE = 0.92  # display luma of white paint in a well-exposed picture
_SAMPLE = 1 << 14
_FEW = 1 << 12  # Gaussians that the extent of a thing is measured on
_NEUTRAL = 16.0  # Lab chroma up to which a bright surface may be white in tinted light
_PURE = 4.0  # Lab chroma up to which it is white in neutral light
_BRIGHT = 0.95  # quantile of the luma of near-neutral surfaces that white paint has
_BRIGHTEST = 0.99  # quantile of the luma of all surfaces that white paint would have, where none is near-neutral
_FALLOFF = 0.8  # of that luma, from which a surface counts as bright
_ENOUGH = 0.02  # share of the scene by area that bright near-neutral surfaces must have
_TRUST = 0.8  # share of a measured cast that is taken for light, the rest for paint
_AROUND = 2.5  # times the radius of a thing: its surroundings
_FEWEST = 200  # Gaussians in them, or they are unknown
_BELIEVED = 0.45  # exponent of what is missing there that is taken for a lack of light
_OWN = 0.05  # the same of the thing's own darkness
TYPICAL = 0.45  # display luma of an ordinary thing in good light
_SHADE = 0.9  # the dimmest that a place counts as, relative to the scene
_DIMMEST = 0.72  # exposures below count as this: a viewer's eye adapts to a dim picture as a whole


@dataclass(frozen=True)
class SceneLight:
    """The light of a scene.

    Attributes:
        white: display colour of white paint, relative to a well-exposed neutral picture; (1, 1, 1) if unknown.
        share: share of the scene's surfaces, by area, that it was estimated from; 0 if it is unknown.
    """

    white: tuple[float, float, float] = (1.0, 1.0, 1.0)
    share: float = 0.0

    @property
    def level(self) -> float:
        """Luma of white relative to a well-exposed picture."""
        return sum(w * v for w, v in zip(LUMA, self.white, strict=True))

    @property
    def tint(self) -> Tensor:
        """`[3]` float64, colour of the light with luma 1."""
        return torch.tensor(self.white, dtype=torch.float64) / self.level

    def on(self, rgb: Tensor) -> Tensor:
        """Display colours `[..., 3]` of pigments that have the colours `rgb` in good neutral light."""
        return rgb * torch.tensor(self.white, dtype=rgb.dtype)

    def note(self) -> str | None:
        """What a user should know of it, or None if it is close to good neutral light."""
        if self.share <= 0:
            return None
        chroma = float(torch.linalg.vector_norm(rgb_to_lab(0.9 * self.tint)[1:]))
        told = []
        if self.level < 0.97:
            told.append(f"white shows at {self.level:.0%} of full brightness")
        if chroma > 2:
            red, _, blue = self.white
            told.append("the light is warm" if red > blue else "the light is cool")
        return f"colours are meant in the scene's light: {', '.join(told)}" if told else None


_KNOWN: WeakKeyDictionary[GaussianCloud, SceneLight] = WeakKeyDictionary()


def scene_light(cloud: GaussianCloud) -> SceneLight:
    """Estimate the light from the colours of a cloud's surfaces; the neutral light if too few can be white.

    A cloud does not change, so its light is estimated once.
    """
    if (found := _KNOWN.get(cloud)) is None:
        there = cloud if cloud.rest is None else cloud.rest.evenly(cloud, -(-cloud.rest.count(cloud) // _SAMPLE))
        found = _KNOWN[cloud] = light_of(sample(there, size=_SAMPLE))
    return found


def light_of(colors: Sample) -> SceneLight:
    """As `scene_light`, from sampled colours and their areas."""
    lab, weight = colors.lab, colors.weight
    chroma = torch.linalg.vector_norm(lab[:, 1:], dim=1)
    luma = colors.rgb.clamp(0, 1) @ torch.tensor(LUMA, dtype=torch.float64)
    neutral = (chroma < _NEUTRAL) & (luma > 0.25)
    if float(weight[neutral].sum()) < _ENOUGH:
        exposure = min(1.0, max(_DIMMEST, quantile(luma, weight, _BRIGHTEST) / WHITE))
        return SceneLight((exposure, exposure, exposure))
    level = quantile(luma[neutral], weight[neutral], _BRIGHT)
    bright = neutral & (luma >= _FALLOFF * level)
    share = float(weight[bright].sum())
    tint = _tint(colors, bright, chroma)
    exposure = min(1.0, max(_DIMMEST, level / WHITE))
    red, green, blue = (exposure * tint).tolist()
    return SceneLight((red, green, blue), share)


def _tint(colors: Sample, bright: Tensor, chroma: Tensor) -> Tensor:
    """Colour `[3]` of the light with luma 1, from the bright near-neutral surfaces.

    Where a good part of them is neutral, so is the light, and the others are painted.
    """
    pure = bright & (chroma < _PURE)
    even = torch.ones(3, dtype=torch.float64)
    weight = colors.weight
    if float(weight[pure].sum()) > 0.25 * float(weight[bright].sum()):
        return even
    shares = weight[bright] / weight[bright].sum()
    seen = torch.stack([_middle(colors.rgb[bright, c], shares) for c in range(3)])
    tint = 1 + _TRUST * (seen / (seen @ torch.tensor(LUMA, dtype=torch.float64)) - 1)
    return tint / (tint @ torch.tensor(LUMA, dtype=torch.float64))


def _middle(values: Tensor, weight: Tensor) -> Tensor:
    return torch.tensor(quantile(values, weight, 0.5), dtype=torch.float64)


def light_around(cloud: GaussianCloud, rows: Tensor, light: SceneLight, lit: float = TYPICAL) -> SceneLight:
    """The light at a thing, the rows `[M]` of a cloud: that of the scene, dimmed where the surroundings are dim.

    What stands around a thing, and the thing itself, may be dark by pigment and not for lack of light, so what is
    missing counts in part (`_BELIEVED`, `_OWN`), and the light is never below `_SHADE` of the scene's.

    Args:
        lit: luma of the thing's lit faces; a dark thing is a little more probably in the shade.
    """
    if not len(rows):
        return light
    own = min(1.0, max(lit, 0.02) / (TYPICAL * light.level)) ** _OWN
    shade = max(_SHADE, own * _dimness(cloud, rows, light))
    red, green, blue = (shade * w for w in light.white)
    return SceneLight((red, green, blue), light.share)


def _dimness(cloud: GaussianCloud, rows: Tensor, light: SceneLight) -> float:
    """Brightness of what is around a thing, relative to what the scene's light lets expect, at most 1."""
    few = cloud.means[rows[:: max(1, len(rows) // _FEW)]]
    middle = few.median(dim=0).values
    apart = torch.linalg.vector_norm(few - middle, dim=1)
    radius = float(apart.kthvalue(max(1, int(0.9 * len(apart)))).values)
    around = _AROUND * radius
    if cloud.rest is None:
        every = torch.arange(0, len(cloud), max(1, len(cloud) // (2 * _SAMPLE)))
    else:
        step = max(1, cloud.rest.count(cloud) // (2 * _SAMPLE))
        cloud = cloud.rest.evenly(cloud, step, (middle, around))
        every = torch.arange(len(cloud))
    near = every[torch.linalg.vector_norm(cloud.means[every] - middle, dim=1) < around]
    if light.share <= 0 or len(near) < _FEWEST:
        return 1.0
    colors = sample(cloud, near, _SAMPLE)
    level = quantile(colors.rgb.clamp(0, 1) @ torch.tensor(LUMA, dtype=torch.float64), colors.weight, _BRIGHT)
    return float(min(1.0, (level / (WHITE * light.level)) ** _BELIEVED))
