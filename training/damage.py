"""Simulate defects of segmented objects for training: cuts, unseen sides, thinning, residue, wrong merges.

Every function returns a new cloud and draws from the given random generator.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..gaussians import rotations
from ..gaussians.cloud import GaussianCloud

Array = NDArray[np.float64]
_C0 = 0.28209479177387814


def extent(cloud: GaussianCloud) -> tuple[Array, Array]:
    """Lower and upper corner `[3]` of the centres, without the outermost 0.5 % on each side."""
    points = cloud.means.double().numpy()
    return np.quantile(points, 0.005, axis=0), np.quantile(points, 0.995, axis=0)


def moved(cloud: GaussianCloud, offset: Array, yaw: float = 0.0, scale: float = 1.0) -> GaussianCloud:
    """Scaled and turned about the vertical axis (radians) around the origin, then shifted. Harmonics beyond degree 0
    are dropped instead of rotated, since training uses base colours only."""
    turn = rotations.from_axis_angle(torch.tensor([0.0, 0.0, 1.0]), torch.tensor(float(yaw)))
    matrix = rotations.to_matrix(turn).to(torch.float32)
    plain = cloud.with_degree(0)
    return plain.replace(
        means=scale * plain.means @ matrix.T + torch.tensor(offset, dtype=torch.float32),
        quats=rotations.normalize(rotations.multiply(turn.expand_as(plain.quats).to(torch.float32), plain.quats)),
        scales=plain.scales * scale,
    )


def join(clouds: list[GaussianCloud]) -> GaussianCloud:
    """Concatenate clouds; ids start at 0."""
    parts = [c.with_degree(0) for c in clouds]
    columns = ("means", "quats", "scales", "opacities", "sh")
    return GaussianCloud.create(*(torch.cat([getattr(c, name) for c in parts]) for name in columns))


def direction(rng: np.random.Generator, level: bool = False) -> Array:
    """A random unit vector; horizontal if `level`."""
    v = rng.normal(size=3) * (1.0, 1.0, 0.0 if level else 1.0)
    unit: Array = v / np.linalg.norm(v)
    return unit


def cut(cloud: GaussianCloud, rng: np.random.Generator, keep: float, toward: Array | None = None) -> GaussianCloud:
    """Cut off the side in direction `toward` (random if None) and keep the share `keep` of the Gaussians. The cut is a
    slightly rough plane, as borders of segments are."""
    toward = direction(rng) if toward is None else toward
    low, high = extent(cloud)
    along = cloud.means.double().numpy() @ toward + rng.normal(size=len(cloud)) * 0.01 * np.linalg.norm(high - low)
    return cloud[torch.from_numpy(along <= np.quantile(along, keep))]


def thinned(cloud: GaussianCloud, rng: np.random.Generator, drop: float) -> GaussianCloud:
    """Drop the share `drop` at random and grow, move and fade the rest a little, as in trained scenes."""
    kept = cloud[torch.from_numpy(rng.random(len(cloud)) >= drop)]
    n = len(kept)
    shift = torch.from_numpy(rng.normal(size=(n, 3)).astype(np.float32)) * kept.scales.amax(dim=1, keepdim=True) * 0.4
    wider = (1 - drop) ** -0.45  # the remaining Gaussians must cover nearly the same area
    grow = torch.from_numpy((wider * rng.lognormal(0.1, 0.3, size=(n, 1))).astype(np.float32))
    fade = torch.from_numpy(rng.uniform(0.55, 1.0, size=n).astype(np.float32))
    return kept.replace(means=kept.means + shift, scales=kept.scales * grow, opacities=kept.opacities * fade)


def slab(rng: np.random.Generator, width: float, height: float, upright: bool, count: int = 1200) -> GaussianCloud:
    """A flat patch of wall (facing -y) or floor, `width` by `height` metres around the origin, ragged at its border,
    with the soft shades and lines that plaster, boards and tiles have."""
    uv = (rng.random((count, 2)) - 0.5) * (width, height)
    radius = np.hypot(uv[:, 0] / width, uv[:, 1] / height)
    uv = uv[radius < rng.uniform(0.42, 0.8) + 0.05 * rng.normal(size=count)]
    n = len(uv)
    spot = rng.normal(size=(n, 1)) * rng.uniform(0, 0.06)
    slope = 0.25 * (uv @ rng.normal(size=2))[:, None] / max(width, height) * rng.random()
    lines = 0.12 * (np.mod(uv[:, :1] / width * rng.integers(3, 12), 1) < 0.12) * (rng.random() < 0.35)
    base = rng.uniform(0.25, 0.95) + (rng.uniform(-0.2, 0.2, size=3) if rng.random() < 0.5 else np.zeros(3))
    flat = np.zeros((n, 1)) + rng.normal(size=(n, 1)) * 0.002
    xyz = np.concatenate([uv[:, :1], flat, uv[:, 1:]] if upright else [uv, flat], axis=1)
    size = 1.1 * np.sqrt(width * height / count)
    scales = np.full((n, 3), size)
    scales[:, 1 if upright else 2] = 0.004
    sh = (np.clip(base + spot + slope - lines, 0.03, 1) - 0.5) / _C0
    quats = np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
    return GaussianCloud.create(_f32(xyz), _f32(quats), _f32(scales), _f32(np.full(n, 0.95)), _f32(sh).reshape(n, 1, 3))


def with_residue(cloud: GaussianCloud, rng: np.random.Generator) -> GaussianCloud:
    """The thing with a ragged patch of floor left under it, or of wall behind it."""
    low, high = extent(cloud)
    middle, size = (low + high) / 2, high - low
    grow = rng.uniform(0.7, 1.25, size=2)
    if rng.random() < 0.8:
        patch = slab(rng, max(0.05, size[0] * grow[0]), max(0.05, size[1] * grow[1]), upright=False, count=500)
        return join([cloud, moved(patch, np.array([middle[0], middle[1], low[2]]))])
    patch = slab(rng, max(0.05, size[0] * grow[0]), max(0.05, size[2] * grow[1]), upright=True, count=500)
    return join([cloud, moved(patch, np.array([middle[0], high[1], middle[2]]))])


def with_fragment(cloud: GaussianCloud, other: GaussianCloud, rng: np.random.Generator) -> GaussianCloud:
    """The thing with a small piece of a neighbour stuck to a side or lying on top."""
    piece = cut(cut(other, rng, rng.uniform(0.2, 0.5)), rng, rng.uniform(0.4, 0.8))
    return _beside(cloud, piece, rng, share=rng.uniform(0.15, 0.35))


def several(clouds: list[GaussianCloud], rng: np.random.Generator) -> GaussianCloud:
    """Merge objects, scaled to comparable size, into one: side by side or on top of each other."""
    merged = clouds[0]
    for other in clouds[1:]:
        merged = _beside(merged, other, rng, share=rng.uniform(0.5, 1.1))
    return merged


def _beside(cloud: GaussianCloud, other: GaussianCloud, rng: np.random.Generator, share: float) -> GaussianCloud:
    """`other`, scaled so that its longest side is `share` of the cloud's, placed at a random side of it or on it."""
    low, high = extent(cloud)
    other_low, other_high = extent(other)
    scale = share * float((high - low).max()) / max(1e-6, float((other_high - other_low).max()))
    other_low, other_high = other_low * scale, other_high * scale
    reach = (other_high - other_low) / 2
    middle = (low + high) / 2
    if rng.random() < 0.35:
        spot = np.array([rng.uniform(low[0], high[0]), rng.uniform(low[1], high[1]), high[2] + reach[2]])
    else:
        way = direction(rng, level=True)
        half = (high - low) / 2
        spot = middle + way * (np.abs(way) @ (half + reach)) * rng.uniform(0.75, 1.1)
        spot[2] = low[2] + reach[2]
    return join([cloud, moved(other, spot - (other_low + other_high) / 2, scale=scale)])


def _f32(values: Array) -> Tensor:
    return torch.from_numpy(np.ascontiguousarray(values, dtype=np.float32))
