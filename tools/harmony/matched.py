"""Fit the colours of a new thing to the light of the scene that it is put into.

Assets are painted as in good neutral light with one lamp above. What a scene's light is told by its white surfaces
(exposure and white balance), by its darkest (contrast), and by how its things are shaded (`shading`). The colours of a
new thing are multiplied by the scene's white, its shading is turned to the scene's, its black is raised to the scene's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.harmonics import SH_C0, dc_to_color
from ...gaussians.language.field.measure import sample
from ...gaussians.rows import rows_within
from ...gaussians.scene import Scene
from ..color_map import LUMA
from ..coloring.quantiles import quantile
from ..coloring.scene_light import WHITE, SceneLight, scene_light
from .shading import is_signed, lumas, normals_of, shading_of, solved

F64 = NDArray[np.float64]
_SAMPLE = 1 << 14
_AROUND = 2.5  # times the radius of a thing: its surroundings
_FEWEST = 200  # Gaussians in them, or they are unknown
_BRIGHT = 0.95  # quantile of their luma that white paint would have
_BELIEVED, _DIMMEST = 0.6, 0.6  # exponent of what is missing there that is taken for a lack of light; the dimmest place
_CAST, _CAST_AT_MOST = 0.4, (0.75, 1.25)  # exponent of the hue of what is around that its light has, and its bounds
_CAST_ON_ASKED, _DIMMEST_ASKED = 0.12, 0.75  # the same of a thing whose colour was asked for
_PURE, _PALEST = 0.95, 0.65  # quantile of purity that is compared, and the least that is kept of a thing's chroma
_DARK = 0.005  # quantile of a scene's luma that its black has
_RAISED = 0.05  # to which black is raised at most
_TURNED = 0.35  # logarithm by which a surface becomes brighter or darker at most
_SAME = 0.03  # share of a change that is not worth telling
_WARM = 0.025  # difference of red and blue gain from which light is warmer or cooler


@dataclass(frozen=True)
class Fitted:
    """What was done to a thing's colours.

    Attributes:
        gain: by which red, green and blue were multiplied, on average.
        raised: display luma of its black now, 0 if unchanged.
        turned: root mean square of the logarithm by which its shading changed.
    """

    gain: tuple[float, float, float]
    raised: float
    turned: float

    def describe(self) -> str:
        """ "12 % darker, warmer"; "" if hardly anything changed."""
        level = sum(g * v for g, v in zip(self.gain, LUMA, strict=True))
        said = []
        if abs(level - 1) > _SAME:
            said.append(f"{abs(level - 1):.0%} {'darker' if level < 1 else 'brighter'}".replace("%", " %"))
        lean = (self.gain[0] - self.gain[2]) / max(level, 1e-9)
        if abs(lean) > _WARM:
            said.append("warmer" if lean > 0 else "cooler")
        if self.raised > _SAME:
            said.append("softer blacks")
        if self.turned > _SAME:
            said.append("shaded by the light of the scene")
        return ", ".join(said)


def matched(cloud: GaussianCloud, scene: Scene, free: bool = True) -> tuple[GaussianCloud, Fitted]:
    """A new thing, in place, with its colours fitted to a scene; only its harmonics change.

    Args:
        cloud: the thing, lit by one lamp as assets are, or photographed in good light.
        free: whether its colours are free to be less pure, as nobody asked for one.
    """
    light = _light_at(scene, cloud, free)
    gain = torch.tensor(light.white, dtype=torch.float64)
    shade = _turned(cloud, scene)
    raised = _black(scene)
    factor = gain[None] * torch.from_numpy(shade)[:, None]  # [N, 3]
    base = dc_to_color(cloud.sh[:, 0]).clamp(min=0).to(torch.float64) * factor
    keep = _chroma_kept(base, scene) if free else 1.0
    grey = (base @ torch.tensor(LUMA, dtype=torch.float64))[:, None]
    base = grey + keep * (base - grey)
    base = raised + (1 - raised) * base if raised > 0 else base
    sh = cloud.sh * (factor * (1 - raised)).to(cloud.sh)[:, None, :]
    sh[:, 0] = ((base - 0.5) / SH_C0).to(cloud.sh)
    told = Fitted(light.white, raised, float(np.sqrt(np.mean(np.log(shade) ** 2))) if len(shade) else 0.0)
    return cloud.replace(sh=sh), told


def _light_at(scene: Scene, cloud: GaussianCloud, free: bool) -> SceneLight:
    """The light of the scene, dimmed as far as what is around the thing is darker than its light lets expect. That may
    be dark by pigment, so what is missing counts in part."""
    light = scene_light(scene.cloud)
    if light.share <= 0:
        return SceneLight()  # no surface tells it
    means = cloud.means.to(torch.float64)
    middle, radius = means.mean(dim=0), float((means - means.mean(dim=0)).norm(dim=1).quantile(0.9))
    near = rows_within(scene.cloud.means, *((middle + s * _AROUND * radius).cpu().numpy() for s in (-1, 1)))
    if len(near) < _FEWEST:
        return light
    taken = sample(scene.cloud, near, _SAMPLE)
    level = quantile(taken.rgb.clamp(0, 1) @ torch.tensor(LUMA, dtype=torch.float64), taken.weight, _BRIGHT)
    tint = (taken.rgb.clamp(0, 1) * taken.weight[:, None]).sum(dim=0)
    whole = sample(scene.cloud, size=_SAMPLE)
    usual = (whole.rgb.clamp(0, 1) * whole.weight[:, None]).sum(dim=0)
    cast = (_luma_one(tint) / _luma_one(usual)).clamp(min=0.1) ** (_CAST if free else _CAST_ON_ASKED)
    cast = _luma_one(cast.clamp(*_CAST_AT_MOST))
    dimmest = _DIMMEST if free else _DIMMEST_ASKED
    dim = float(np.clip((level / (WHITE * light.level)) ** _BELIEVED, min(1.0, dimmest / light.level), 1.0))
    red, green, blue = (dim * w * float(c) for w, c in zip(light.white, cast, strict=True))
    return SceneLight((red, green, blue), light.share)


def _luma_one(rgb: Tensor) -> Tensor:
    return rgb / (rgb @ torch.tensor(LUMA, dtype=rgb.dtype)).clamp(min=1e-3)


def _chroma_kept(rgb: Tensor, scene: Scene) -> float:
    """By what the chroma of a thing is multiplied so that it is not purer than the scene's pure colours are."""
    taken = sample(scene.cloud, size=_SAMPLE)
    theirs = quantile(_purity(taken.rgb.clamp(0, 1)), taken.weight, _PURE)
    own = float(_purity(rgb).quantile(_PURE)) if len(rgb) else 0.0
    return float(np.clip(theirs / max(own, 1e-6), _PALEST, 1.0))


def _purity(rgb: Tensor) -> Tensor:
    """`[M]` difference of the largest and the least of red, green and blue."""
    return rgb.amax(dim=1) - rgb.amin(dim=1)


def _black(scene: Scene) -> float:
    """The display luma of the darkest surfaces of a scene."""
    taken = sample(scene.cloud, size=_SAMPLE)
    luma = taken.rgb.clamp(0, 1) @ torch.tensor(LUMA, dtype=torch.float64)
    return min(_RAISED, quantile(luma, taken.weight, _DARK)) if len(luma) else 0.0


def _turned(cloud: GaussianCloud, scene: Scene) -> F64:
    """`[N]` by what the brightness of each Gaussian is multiplied so that it depends on its normal as in the scene.

    Normals of fitted scenes are noisy, which makes the slope too small: it tells the direction of the light, and the
    thing keeps the strength of its shading unless the scene's is stronger.
    """
    rows = torch.arange(len(cloud), device=cloud.device)
    normals, flat = normals_of(cloud, rows)
    if not is_signed(cloud):
        away = cloud.means.to(torch.float64).cpu().numpy()
        away = away - away.mean(axis=0)
        normals = normals * np.where(np.einsum("ij,ij->i", normals, away) < 0, -1.0, 1.0)[:, None]
    scene_slope = shading_of(scene).slope
    values = np.log(np.maximum(lumas(cloud, rows)[flat], 0.02))
    own = solved(normals[flat], values, np.zeros(len(values), np.int64), scene.frame.up_vector).slope
    strength = max(float(np.linalg.norm(own)), float(np.linalg.norm(scene_slope)))
    wanted = scene_slope / max(float(np.linalg.norm(scene_slope)), 1e-12) * strength
    change = np.where(flat, normals @ (wanted - own), 0.0)
    change = change - float(np.mean(change)) if len(change) else change
    return np.asarray(np.exp(np.clip(change, -_TURNED, _TURNED)))
