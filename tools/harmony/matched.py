"""Fit the colours of a new thing to the light of the scene that it is put into.

Assets are painted as in good neutral light with one lamp above. What a scene's light is told by its white surfaces
(exposure and white balance), by its darkest (contrast), and by how its things are shaded (`shading`). The colours of a
new thing are multiplied by the scene's white, its black is raised to the scene's. Where its pigments are known they are
lit anew (`form`), and wear a little, as nothing that stands in a real room is of one even colour; else its shading is
turned to the scene's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.harmonics import SH_C0, dc_to_color
from ...gaussians.language.field.measure import Sample, sample
from ...gaussians.rotations import to_matrix
from ...gaussians.rows import rows_within
from ...gaussians.scene import Scene
from ..color_map import LUMA
from ..coloring.quantiles import quantile
from ..coloring.scene_light import WHITE, SceneLight, scene_light
from ..finishing.noise import fractal
from .falling import slope_at
from .form import Pigment, Surround, form_light
from .shading import is_signed, lumas, normals_of, shading_of, solved

F64 = NDArray[np.float64]
_SAMPLE = 1 << 14
_AROUND = 2.5  # times the radius of a thing: its surroundings
_FEWEST = 200  # Gaussians in them, or they are unknown
_BRIGHT = 0.95  # quantile of their luma that white paint would have
_BELOW, _FEW = 0.3, 20  # of its surroundings: up to which height the support shows, and the fewest Gaussians of it
_BELIEVED, _DIMMEST = (
    0.7,
    0.48,
)  # exponent of what is missing there that is taken for a lack of light; the dimmest place
_CAST, _CAST_AT_MOST = 0.2, (0.7, 1.2)  # exponent of the hue of what is below that its light has, and its bounds
_COOL = 0.9  # that exponent where the hue is cool: floors and ground are warm by pigment, and cool by light
_CAST_ON_ASKED, _DIMMEST_ASKED = 0.12, 0.75  # the same of a thing whose colour was asked for
_PAINT, _PURER = 0.15, 0.45  # purity up to which a pigment nobody asked for is kept, and what counts of more
_WORN, _WORN_FINE = 0.09, 0.07  # by how much pigments vary over a thing, and over its details
_BESIDE = 6  # Gaussians over which a pigment is averaged
_LARGE, _SMALL = 0.35, 0.04  # of a thing's extent: size of these
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


def matched(
    cloud: GaussianCloud, scene: Scene, free: bool = True, pigment: Pigment | None = None
) -> tuple[GaussianCloud, Fitted]:
    """A new thing, in place, with its colours fitted to a scene; only its harmonics change.

    Args:
        cloud: the thing, lit by one lamp as assets are, or photographed in good light.
        free: whether its colours are free to be less pure, as nobody asked for one.
        pigment: its colours without light, if they are known.
    """
    light = _light_at(scene, cloud, free)
    gain = torch.tensor(light.white, dtype=torch.float64)
    raised = _black(scene)
    if pigment is None or not is_signed(cloud):
        shade = torch.from_numpy(_turned(cloud, scene))
        base = dc_to_color(cloud.sh[:, 0]).clamp(min=0).to(torch.float64)
        factor = gain[None] * shade[:, None]  # [N, 3]
        told = float(shade.log().square().mean().sqrt()) if len(shade) else 0.0
    else:
        base = _worn(_paint(torch.from_numpy(pigment.rgb).to(torch.float64), free and pigment.drawn), cloud)
        points, normals = _surface(cloud)
        below = pigment.two_sided & (normals @ scene.frame.up_vector < 0)
        normals = np.where(below[:, None], -normals, normals)
        formed = torch.from_numpy(form_light(points, normals, _surround(scene, cloud, light)))
        factor = gain[None] * formed
        told = float(formed.log().square().mean().sqrt()) if len(formed) else 0.0
    base = base * factor
    keep = _chroma_kept(base, scene) if free else 1.0
    grey = (base @ torch.tensor(LUMA, dtype=torch.float64))[:, None]
    base = grey + keep * (base - grey)
    base = raised + (1 - raised) * base if raised > 0 else base
    sh = cloud.sh * (factor * (1 - raised)).to(cloud.sh)[:, None, :]
    sh[:, 0] = ((base - 0.5) / SH_C0).to(cloud.sh)
    return cloud.replace(sh=sh), Fitted(light.white, raised, told)


def _surface(cloud: GaussianCloud) -> tuple[F64, F64]:
    """`[N, 3]` positions and outward normals of a thing made from surfaces."""
    return cloud.means.to(torch.float64).cpu().numpy(), to_matrix(cloud.quats)[:, :, 2].to(torch.float64).cpu().numpy()


def _paint(rgb: Tensor, free: bool) -> Tensor:
    """Pigments as they are in used rooms: what is pure without having been asked for is less so."""
    if not free:
        return rgb
    purity = _purity(rgb)[:, None]
    kept = torch.where(purity > _PAINT, (_PAINT + _PURER * (purity - _PAINT)) / purity.clamp(min=1e-6), 1.0)
    grey = (rgb @ torch.tensor(LUMA, dtype=torch.float64))[:, None]
    return grey + kept * (rgb - grey)


def _worn(rgb: Tensor, cloud: GaussianCloud) -> Tensor:
    """Pigments that vary a little over the surface, and whose borders are as soft as its Gaussians are wide."""
    from scipy.spatial import cKDTree

    points = cloud.means.to(torch.float32).cpu().numpy()
    beside = cKDTree(points).query(points, k=min(_BESIDE, len(points)))[1].reshape(len(points), -1)
    rgb = rgb[torch.from_numpy(beside)].mean(dim=1)
    extent = float(np.ptp(points, axis=0).max())
    blur = cloud.scales.amax(dim=1).to(torch.float32).cpu().numpy()
    large = fractal(points, _LARGE * extent, blur, 5, 2)
    small = fractal(points, _SMALL * extent, blur, 6, 2)
    return rgb * torch.from_numpy(np.exp(_WORN * large + _WORN_FINE * small).astype(np.float64))[:, None]


def _surround(scene: Scene, cloud: GaussianCloud, light: SceneLight) -> Surround:
    """What lights a thing in a scene: the side from which its things are lit, and the colour of what is below."""
    up = scene.frame.up_vector
    points = cloud.means.to(torch.float64).cpu().numpy()
    low, high = points.min(axis=0), points.max(axis=0)
    foot = float((points @ up).min())
    near = _below(scene, low, high)
    bounce = np.full(3, 0.5)
    if len(near) >= _FEW:
        taken = sample(scene.cloud, near, _SAMPLE)
        share = (taken.weight / taken.weight.sum().clamp(min=1e-12))[:, None]
        seen = (taken.rgb.clamp(0, 1) * share).sum(dim=0) / torch.tensor(light.white, dtype=torch.float64)
        bounce = seen.clamp(0.05, 0.9).cpu().numpy()
    return Surround(up, slope_at(scene, (low + high) / 2), bounce, foot)


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
    low, high = means.amin(dim=0).cpu().numpy(), means.amax(dim=0).cpu().numpy()
    below = _below(scene, low, high)
    tint = _tint(sample(scene.cloud, below, _SAMPLE) if len(below) >= _FEW else taken)
    usual = _tint(sample(scene.cloud, size=_SAMPLE))
    cast = (tint / usual).clamp(min=0.1)
    cast = cast ** (_CAST_ON_ASKED if not free else _COOL if cast[2] > cast[0] else _CAST)
    cast = _luma_one(cast.clamp(*_CAST_AT_MOST))
    dimmest = _DIMMEST if free else _DIMMEST_ASKED
    dim = float(np.clip((level / (WHITE * light.level)) ** _BELIEVED, min(1.0, dimmest / light.level), 1.0))
    red, green, blue = (dim * w * float(c) for w, c in zip(light.white, cast, strict=True))
    return SceneLight((red, green, blue), light.share)


def _tint(taken: Sample) -> Tensor:
    """`[3]` colour of luma 1 of some surfaces, the brighter counting more: what is lit tells the hue of light."""
    rgb = taken.rgb.clamp(0, 1)
    luma = rgb @ torch.tensor(LUMA, dtype=rgb.dtype)
    return _luma_one((rgb * (taken.weight * luma.square())[:, None]).sum(dim=0)).clamp(min=1e-2)


def _below(scene: Scene, low: F64, high: F64) -> Tensor:
    """Rows of what is around the foot of a thing with a box from low to high (world)."""
    reach = 0.5 * float((high - low).max())
    up = scene.frame.up_vector
    foot = float(np.where(up > 0, low, high) @ up)
    near = rows_within(scene.cloud.means, low - reach, high + reach)
    return near[scene.cloud.means[near].to(torch.float64).cpu().numpy() @ up < foot + _BELOW * reach]


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
