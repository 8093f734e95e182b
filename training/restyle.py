"""Vary the look of an object for training: its form, its colours, what is printed on it, and its light.

Names must not hang on the colours, the textures and the proportions of our own assets. Every function draws from the
given random generator.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray

from ..gaussians.assets import Asset
from ..gaussians.assets.modeling import light, make
from ..gaussians.assets.modeling.sampling import Samples
from ..gaussians.cloud import GaussianCloud

Array = NDArray[np.float64]
NATURAL = 0.3  # saturation of most random colours at most


@dataclass(frozen=True, eq=False)
class Surface:
    """An unlit surface as `N` samples.

    Attributes:
        samples: cells; their sizes are the lengths of Gaussians before `cover`.
        albedo: `[N, 3]` display colours without light.
        part: `[N]` number of the part that each sample belongs to.
        two_sided: `[N]` bool, samples that are lit from both sides.
    """

    samples: Samples
    albedo: Array
    part: NDArray[np.int64]
    two_sided: NDArray[np.bool_]


def of_asset(asset: Asset) -> Surface:
    """The surface of one of our assets."""
    unlit = asset.unlit
    return Surface(unlit.samples, unlit.albedo, asset.parts.labels.numpy().astype(np.int64), unlit.two_sided)


def restyled(surface: Surface, rng: np.random.Generator, cover: float = make.COVER) -> GaussianCloud:
    """A variant of the surface as Gaussians, in the same order; each kind of change is drawn independently."""
    samples, albedo = surface.samples, surface.albedo
    if rng.random() < 0.6:
        samples = warped(samples, rng)
    if rng.random() < 0.45:
        albedo = recolored(albedo, surface.part, rng)
    if rng.random() < 0.45:
        albedo = printed(albedo, samples.xyz, rng)
    changed = replace(surface, samples=samples, albedo=albedo)
    return flat(changed, shading(samples, surface.two_sided, rng), cover)


def flat(surface: Surface, bright: Array, cover: float = make.COVER) -> GaussianCloud:
    """The surface as flat Gaussians of brightness `[N]`."""
    return make.flat_gaussians(surface.samples, surface.albedo * bright[:, None], cover)


def baked(samples: Samples, two_sided: NDArray[np.bool_], sun: Array = light.SUN) -> Array:
    """Brightness `[N]` with soft shadows, as our assets have it."""
    return light.bake(samples.xyz, samples.normal, light.occupancy(samples.xyz), sun, two_sided)


def warped(samples: Samples, rng: np.random.Generator) -> Samples:
    """Taper, bulge, lean and stretch the form. Normals are kept, since the changes are small."""
    low, high = samples.xyz.min(axis=0), samples.xyz.max(axis=0)
    size = np.maximum(high - low, 1e-6)
    unit = (samples.xyz - low) / size - 0.5  # [N, 3] in [-0.5, 0.5]
    height = unit[:, 2]
    level = 1 + rng.normal() * 0.18 * height + rng.normal() * 0.12 * np.cos(np.pi * height)
    stretch = np.exp(rng.normal(size=3) * 0.16)
    lean = rng.normal(size=2) * 0.05
    xyz = np.concatenate([unit[:, :2] * level[:, None] + lean * height[:, None], unit[:, 2:]], axis=1) * stretch * size
    grow = float(np.prod(stretch) ** (1 / 3)) * np.maximum(level, 1.0)[:, None]
    xyz[:, 2] -= xyz[:, 2].min()
    return replace(samples, xyz=xyz, size=samples.size * grow * max(1.0, float(stretch.max()) ** 0.5))


def recolored(albedo: Array, part: NDArray[np.int64], rng: np.random.Generator) -> Array:
    """Other colours: one for all, one of a few for each part, or the old ones drawn towards one colour."""
    way = rng.random()
    if way < 0.2:
        return np.tile(color(rng), (len(albedo), 1))
    if way < 0.7:
        palette = np.stack([color(rng) for _ in range(int(rng.integers(1, 5)))])
        names, index = np.unique(part, return_inverse=True)
        chosen = palette[rng.integers(len(palette), size=len(names))][index.reshape(-1)]
        keep = (rng.random(len(names)) < 0.3)[index.reshape(-1), None]
        shade = albedo.mean(axis=1, keepdims=True) / max(1e-3, float(albedo.mean()))
        return np.where(keep, albedo, np.clip(chosen * shade ** rng.uniform(0, 0.6), 0.02, 1))
    share = rng.uniform(0.3, 0.9)
    return np.clip((1 - share) * albedo + share * color(rng), 0.02, 1)


def color(rng: np.random.Generator) -> Array:
    """A random display colour `[3]`; most are greys, browns and pale shades, as in rooms."""
    value = rng.uniform(0.08, 0.97)
    hue = rng.uniform(0, 1) if rng.random() < 0.6 else rng.normal(0.08, 0.03)
    saturation = rng.uniform(0, NATURAL) if rng.random() < 0.55 else rng.uniform(0.3, 1.0)
    ramp = np.clip(np.abs(np.mod(hue + np.array([0, 2 / 3, 1 / 3]), 1) * 6 - 3) - 1, 0, 1)  # HSV
    return np.asarray(value * (1 - saturation + saturation * ramp))


def printed(albedo: Array, xyz: Array, rng: np.random.Generator) -> Array:
    """A pattern in space over the colours: grain, stripes, checks, blots or speckles."""
    size = float(np.max(np.ptp(xyz, axis=0)))
    unit = (xyz - xyz.mean(axis=0)) / max(size, 1e-6)
    way = rng.integers(5)
    if way == 0:  # grain: waves, long along one axis
        axis = np.where(np.arange(3) == rng.integers(3), 0.15, 1.0)
        field = _waves(unit * axis, rng, rng.uniform(4, 25))
    elif way == 1:
        normal = rng.normal(size=3)
        field = np.sign(np.sin(unit @ normal / np.linalg.norm(normal) * rng.uniform(8, 80)))
    elif way == 2:
        field = np.prod(np.sign(np.sin(unit * rng.uniform(8, 50) + rng.uniform(0, 6, size=3))), axis=1)
    elif way == 3:
        field = np.tanh(4 * _waves(unit, rng, rng.uniform(1.5, 12)))
    else:
        field = rng.normal(size=len(unit))
    amount = rng.uniform(0.03, 0.35) * (0.5 if way == 4 else 1.0)
    if rng.random() < 0.5:
        return np.asarray(np.clip(albedo * (1 + amount * field[:, None]), 0.01, 1))
    mask = (field > rng.uniform(-0.3, 0.8))[:, None] * min(1.0, 2 * amount + 0.2)
    return np.asarray(albedo * (1 - mask) + mask * color(rng))


def _waves(unit: Array, rng: np.random.Generator, rate: float) -> Array:
    """Smooth noise `[N]`, about -1 to 1: a few sines in random directions."""
    directions = rng.normal(size=(5, 3)) * rate
    return np.asarray(np.sin(unit @ directions.T + rng.uniform(0, 6.3, size=5)).mean(axis=1) * 1.6)


def shading(samples: Samples, two_sided: NDArray[np.bool_], rng: np.random.Generator) -> Array:
    """Brightness `[N]`: light with soft shadows from any side, plain light by the normal, or hardly any."""
    sun = rng.normal(size=3) + np.array([0.0, -0.4, 0.9])
    sun /= np.linalg.norm(sun)
    gain = float(np.exp(rng.normal() * 0.15))
    if rng.random() < 0.65:
        return gain * baked(samples, two_sided, sun)
    facing = samples.normal @ sun
    facing = np.where(two_sided, np.abs(facing), np.clip(facing, 0, None))
    depth = rng.uniform(0.0, 1.0)
    return np.asarray(gain * (1 - 0.4 * depth + 0.1 * depth * samples.normal[:, 2] + 0.45 * depth * facing))


def with_cloud(asset: Asset, cloud: GaussianCloud) -> Asset:
    """The asset with other Gaussians in the same order."""
    assert len(cloud) == len(asset.cloud)
    low, high = cloud.means.amin(dim=0), cloud.means.amax(dim=0)
    w, d, h = (float(v) for v in high - low)
    return replace(asset, cloud=cloud, size=(w, d, h))


def as_fitted(cloud: GaussianCloud, rng: np.random.Generator) -> GaussianCloud:
    """The look of Gaussians that were trained on photographs: uneven, thick, partly transparent, of noisy colours, with
    floaters around them."""
    strength = rng.uniform(0.3, 1.0)
    plain = cloud.with_degree(0)
    plain = plain[torch.from_numpy(rng.random(len(plain)) >= rng.uniform(0, 0.6))]
    n = len(plain)
    if n < 20:
        return cloud
    scales = plain.scales.double().numpy()
    longest = scales.max(axis=1, keepdims=True)
    scales = np.maximum(scales, longest * rng.uniform(0.05, 0.5)) * rng.lognormal(0.15, 0.45 * strength, size=(n, 3))
    scales *= (len(cloud) / n) ** 0.5
    spread = float(np.median(longest))
    means = plain.means.double().numpy() + rng.normal(size=(n, 3)) * spread * rng.uniform(0.2, 1.2) * strength
    noise = rng.normal(size=(n, 1, 3)) * 0.12 + rng.normal(size=(n, 1, 1)) * 0.2
    sh = plain.sh.double().numpy() + noise * strength
    quats = plain.quats + torch.from_numpy(rng.normal(size=(n, 4)) * 0.15 * strength).float()
    opacities = np.clip(rng.beta(4, 1.5, size=n), 0.05, 0.99)
    result = plain.replace(
        means=torch.from_numpy(means).float(),
        quats=torch.nn.functional.normalize(quats, dim=1),
        scales=torch.from_numpy(scales).float(),
        opacities=torch.from_numpy(opacities).float(),
        sh=torch.from_numpy(sh).float(),
    )
    return _with_floaters(result, rng) if rng.random() < 0.6 else result


def _with_floaters(cloud: GaussianCloud, rng: np.random.Generator) -> GaussianCloud:
    """A few large faint Gaussians around the object, of its own colours or of the room's."""
    n = int(rng.integers(3, 25))
    points = cloud.means.double().numpy()
    low, high = np.quantile(points, 0.01, axis=0), np.quantile(points, 0.99, axis=0)
    size = high - low
    at = low + (rng.random((n, 3)) * 1.4 - 0.2) * size
    length = float(np.linalg.norm(size)) * rng.uniform(0.01, 0.06, size=(n, 3))
    sh = cloud.sh[torch.from_numpy(rng.integers(len(cloud), size=n))]
    if rng.random() < 0.5:
        sh = torch.from_numpy(np.tile((color(rng) - 0.5) / make.SH_C0, (n, 1, 1))).float()
    quats = torch.nn.functional.normalize(torch.from_numpy(rng.normal(size=(n, 4))).float(), dim=1)
    opacities = torch.from_numpy(rng.uniform(0.05, 0.5, size=n)).float()
    columns = (torch.from_numpy(at).float(), quats, torch.from_numpy(length).float(), opacities, sh)
    names = ("means", "quats", "scales", "opacities", "sh")
    return GaussianCloud.create(*(torch.cat([getattr(cloud, k), v]) for k, v in zip(names, columns, strict=True)))
