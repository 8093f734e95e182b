"""Makes one object of a kind as Gaussians (`make`).

Steps: build pieces -> fit to size, stand on the ground -> cut into cells -> paint -> bake light -> flat Gaussians.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...camera import Vec3
from ...cloud import GaussianCloud
from ...color import Rgb, name_of, rgb_to_lab, shade_of
from ...errors import UserError
from ...world import kinds as world
from .. import registry
from . import light, sampling, shapes
from .materials import Tone
from .shapes import Piece

Array = NDArray[np.float64]
SH_C0 = 0.28209479177387814  # Y_0^0, Kerbl et al. 2023
OPACITY = 0.97
COVER = sampling.COVER
MAX_GAUSSIANS = 8500  # of one object at detail 1, approximately
THICKNESS = 0.06  # of a Gaussian, as a share of its shorter tangent


@dataclass(frozen=True, eq=False)
class Parts:
    """Which part of the object each Gaussian belongs to.

    Attributes:
        labels: `[N]` int32 index into `names`.
        names: part names.
    """

    labels: Tensor
    names: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Unlit:
    """An object before lighting: cells, their colours `[N, 3]`, and which of them are lit from both sides `[N]`."""

    samples: sampling.Samples
    albedo: Array
    two_sided: NDArray[np.bool_]
    is_pigment: ClassVar[bool] = True  # whether `albedo` is without light

    def cloud(self, sun: Array) -> GaussianCloud:
        """The Gaussians lit by a lamp in the direction `sun`, object frame."""
        s = self.samples
        bright = light.bake(s.xyz, s.normal, light.occupancy(s.xyz), sun, self.two_sided)
        return flat_gaussians(s, self.albedo * bright[:, None])


@dataclass(frozen=True, eq=False)
class Asset:
    """One object, standing on z = 0, centred in x and y, its front facing -y, metres.

    Attributes:
        cloud: the lit Gaussians, SH degree 0.
        kind: canonical name.
        size: (w, d, h) of its bounding box, metres.
        color: basic name of its main colour ("red", "gray", ...).
        parts: part label of each Gaussian.
        main: `[N]` bool, the Gaussians that have the main colour.
        seed: the seed of its design.
        unlit: the object before lighting, for `relit`.
    """

    cloud: GaussianCloud
    kind: str
    size: Vec3
    color: str
    parts: Parts
    main: Tensor
    seed: int
    unlit: Unlit

    def relit(self, sun: Vec3) -> GaussianCloud:
        """The Gaussians lit by another lamp; `sun` points towards the lamp, object frame."""
        return self.unlit.cloud(np.asarray(sun, dtype=np.float64))


def kinds(shown: bool = False) -> tuple[str, ...]:
    """Names of everything `make` can make, sorted; with `shown` only of what the embedded encoder was trained on."""
    return tuple(sorted(name for name, known in registry.KINDS.items() if known.known.shown or not shown))


def make(kind: str, seed: int = 0, *, color: str | None = None, size: Vec3 | None = None, detail: float = 1.0) -> Asset:
    """One object of a kind; the same arguments give the same bytes.

    Args:
        kind: a name from `kinds()` or a synonym.
        seed: chooses design, proportions, colours and patterns.
        color: main colour: a basic term in its typical shade, anything else as `color.parse` takes it; drawn from
            the seed if None.
        size: (w, d, h) in metres to stretch the design to; its own if None.
        detail: factor on the number of Gaussians, 0.05 to 8.

    Raises:
        UserError: for an unknown kind or colour, or a size or detail out of range.
    """
    known, meant = registry.find(kind), world.find(kind)
    assert meant is not None
    if not 0.05 <= detail <= 8:
        raise UserError(f"detail must be between 0.05 and 8, got {detail:g}")
    if size is not None and not all(0.005 <= s <= 50 for s in size):
        raise UserError(f"size must be three lengths (w, d, h) between 0.005 and 50 metres, got {size}")
    pieces, tone = design(known, seed, shade_of(color) if color is not None else None)
    wanted = size if size is not None else _typical(pieces, meant)
    return to_asset(fit_to_size(pieces, wanted), meant.name, tone.color, seed, detail)


def to_asset(pieces: Sequence[Piece], kind: str, rgb: Rgb, seed: int = 0, detail: float = 1.0) -> Asset:
    """An asset of pieces that stand on z = 0, centred in x and y; its main colour is `rgb`."""
    samples = _sampled(pieces, detail)
    sided = np.array([p.two_sided for p in pieces])[samples.piece]
    unlit = Unlit(samples, sampling.albedo(pieces, samples), sided)
    low, high = shapes.bounds(pieces)
    names = tuple(dict.fromkeys(p.part for p in pieces))
    labels = np.array([names.index(p.part) for p in pieces], dtype=np.int32)[samples.piece]
    main = np.array([bool(p.material and p.material.main) for p in pieces])[samples.piece]
    return Asset(
        cloud=unlit.cloud(light.SUN),
        kind=kind,
        size=(float(high[0] - low[0]), float(high[1] - low[1]), float(high[2] - low[2])),
        color=basic_name(rgb),
        parts=Parts(torch.from_numpy(labels), names),
        main=torch.from_numpy(main),
        seed=seed,
        unlit=unlit,
    )


def design(known: registry.Kind, seed: int, wanted: Rgb | None = None) -> tuple[list[Piece], Tone]:
    """The pieces of one design in their own size, and the colours it uses."""
    rng = np.random.default_rng([zlib.crc32(known.name.encode()), seed & 0xFFFFFFFF])
    tone = Tone(rng, known.palette, wanted)
    return known.build(rng, tone), tone


def _typical(pieces: Sequence[Piece], meant: world.Kind) -> Vec3:
    """The design's own size, clipped to the range that its builder may draw; a kind that is drawn as another one is
    clipped to its own range of sizes."""
    low, high = shapes.bounds(pieces)
    limits = world.extent(meant.name) if meant.asset == meant.name else meant.size
    w, d, h = np.clip(np.maximum(high - low, 1e-6), *np.array(limits).T).tolist()
    return (w, d, h)


def fit_to_size(pieces: Sequence[Piece], size: Vec3) -> list[Piece]:
    """The pieces stretched to `size`, standing on z = 0, centred in x and y."""
    low, high = shapes.bounds(pieces)
    middle = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    gain = np.array(size) / np.maximum(high - low, 1e-6)
    return [p.transformed(np.diag(gain), -gain * middle) for p in pieces]


def spacing(pieces: Sequence[Piece], detail: float) -> float:
    """Cell length, metres, that gives an object about 1,000 to 6,000 Gaussians depending on its area."""
    total = sampling.area(pieces)
    count = float(np.clip(1900 + 900 * math.sqrt(total), 900, 7000)) * detail
    return math.sqrt(total / count)


def _sampled(pieces: Sequence[Piece], detail: float) -> sampling.Samples:
    """Cells of an object; one of many small parts, each at least one cell per side, is sampled more coarsely."""
    step = spacing(pieces, detail)
    samples = sampling.sample(pieces, step)
    if (excess := len(samples.xyz) / (MAX_GAUSSIANS * detail)) > 1:
        samples = sampling.sample(pieces, step * excess**0.5 * 1.05)
    return samples[~sampling.covered(samples)]


def flat_gaussians(samples: sampling.Samples, rgb: Array, cover: float = COVER) -> GaussianCloud:
    """One flat Gaussian per cell, SH degree 0.

    `rgb [N, 3]` are display colours; `cover` is the standard deviation as a share of the cell's length.
    """
    tangent = samples.size * cover
    tangent = np.maximum(tangent, 0.08 * tangent.max(axis=1, keepdims=True))  # avoids needle-shaped Gaussians
    scales = np.concatenate([tangent, np.maximum(THICKNESS * tangent.min(axis=1, keepdims=True), 2e-4)], axis=1)
    n = len(rgb)
    return GaussianCloud.create(
        means=torch.from_numpy(samples.xyz.astype(np.float32)),
        quats=torch.from_numpy(quaternions(samples.frame).astype(np.float32)),
        scales=torch.from_numpy(scales.astype(np.float32)),
        opacities=torch.full((n,), OPACITY),
        sh=torch.from_numpy(((np.clip(rgb, 0.004, 1.0) - 0.5) / SH_C0).astype(np.float32))[:, None],
    )


def quaternions(frames: Array) -> Array:
    """Rotation matrices `[N, 3, 3]` to unit quaternions wxyz `[N, 4]`, from the largest component (Shepperd 1978)."""
    m = frames
    t = np.einsum("nii->n", m)
    squares = np.stack([1 + t, *(1 - t + 2 * m[:, i, i] for i in range(3))], axis=1)  # 4 q_i^2
    pick = np.argmax(squares, axis=1)
    a, b, c = m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0], m[:, 1, 0] - m[:, 0, 1]
    d, e, f = m[:, 0, 1] + m[:, 1, 0], m[:, 0, 2] + m[:, 2, 0], m[:, 1, 2] + m[:, 2, 1]
    s = squares
    rows = np.stack(
        [np.stack([s[:, 0], a, b, c], 1), np.stack([a, s[:, 1], d, e], 1),
         np.stack([b, d, s[:, 2], f], 1), np.stack([c, e, f, s[:, 3]], 1)], axis=1,
    )  # fmt: skip
    q = rows[np.arange(len(m)), pick]
    return np.asarray(q / np.linalg.norm(q, axis=1, keepdims=True))


def basic_name(rgb: Rgb) -> str:
    """Basic colour term of an RGB, without "dark" or "light"."""
    return name_of(rgb_to_lab(torch.tensor(rgb))).split()[-1]
