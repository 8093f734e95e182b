"""Draw training crops: pasted and recoloured things, other scales, and the faults of real cameras and trained scenes.

Borders of things are known for every change, since each pixel carries the number of its thing.
"""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import gaussian_filter, uniform_filter

from .dataset import Pictures
from .model import CHANNELS

F32 = NDArray[np.float32]
WALLS = (2, 3, 4, 5)  # numbers of the walls of a room: where two meet there may or may not be a border
VOID = 0


@dataclass(frozen=True, eq=False)
class Sample:
    """One crop.

    Attributes:
        channels: `[8, S, S]` float32, the network's input.
        border: `[S, S]` uint8: 1 where a border passes within a pixel, 2 where nobody can tell, else 0.
    """

    channels: F32
    border: NDArray[np.uint8]


def borders(things: NDArray[np.integer]) -> NDArray[np.uint8]:
    """Border map `[H, W]` of an image of thing numbers: both pixels beside each change count."""
    result = np.zeros(things.shape, np.uint8)
    wall = np.isin(things, WALLS)
    for a, b in (
        ((slice(None), slice(1, None)), (slice(None), slice(None, -1))),
        ((slice(1, None),), (slice(None, -1),)),
    ):
        differ = things[a] != things[b]
        open_ = differ & wall[a] & wall[b]
        value = np.where(open_, 2, differ.astype(np.uint8)).astype(np.uint8)
        for side in (a, b):
            known = result[side]
            result[side] = np.where((known == 1) | (value == 1), 1, np.maximum(known, value))
    return result


def sample(data: Pictures, rng: np.random.Generator, side: int) -> Sample:
    """A random crop of `side` pixels with every kind of change."""
    index = int(rng.integers(len(data)))
    rgb, things, inverse = _crop(data, index, rng, side)
    for _ in range(int(rng.choice([0, 1, 2, 4], p=[0.4, 0.3, 0.2, 0.1]))):
        rgb, things, inverse = _paste((rgb, things, inverse), _crop(data, int(rng.integers(len(data))), rng, side), rng)
    if rng.random() < 0.5:
        rgb = _recoloured(rgb, things, rng, _crop(data, int(rng.integers(len(data))), rng, side)[0])
    if rng.random() < 0.6:
        rgb = _patterned(rgb, things, rng)
    border = borders(things)
    geometry = _geometry(inverse, float(data.focal[index]), rng)
    channels = np.concatenate([photographed(rgb, rng).transpose(2, 0, 1), geometry])
    return Sample(np.ascontiguousarray(channels, np.float32), border)


def whole(data: Pictures, index: int, depth: bool) -> Sample:
    """One whole picture without changes, for measurement."""
    picture = data.picture[index].astype(np.float32) / 255
    inverse = data.inverse[index].astype(np.float32)
    geometry = geometry_of(inverse, float(data.focal[index])) if depth else np.zeros((5, *inverse.shape), np.float32)
    return Sample(np.concatenate([picture.transpose(2, 0, 1), geometry]), borders(data.things[index]))


def _crop(data: Pictures, index: int, rng: np.random.Generator, side: int) -> tuple[F32, NDArray[np.int32], F32]:
    """Colours, thing numbers and inverse depth of a random square, scaled by 0.75 to 1.6, perhaps mirrored."""
    height, width = data.things.shape[1:]
    span = min(height, round(side / float(np.exp(rng.uniform(np.log(0.75), np.log(1.6))))))
    row, col = int(rng.integers(height - span + 1)), int(rng.integers(width - span + 1))
    window = (index, slice(row, row + span), slice(col, col + span))
    image = Image.fromarray(data.picture[window]).resize((side, side), Image.Resampling.BILINEAR)
    at = np.minimum(((np.arange(side) + 0.5) * span / side).astype(int), span - 1)
    things = data.things[window][at][:, at].astype(np.int32)
    inverse = data.inverse[window][at][:, at].astype(np.float32)
    rgb = np.asarray(image, np.float32) / 255
    if rng.random() < 0.5:
        rgb, things, inverse = rgb[:, ::-1], things[:, ::-1], inverse[:, ::-1]
    return np.asarray(rgb, np.float32), things, inverse


Layers = tuple[F32, NDArray[np.int32], F32]


def _paste(under: Layers, over: Layers, rng: np.random.Generator) -> Layers:
    """Some things of one picture in front of another, with a soft shadow round them in half of the cases."""
    numbers, counts = np.unique(over[1], return_counts=True)
    fit = numbers[(counts > 60) & (counts < 0.3 * over[1].size) & (numbers > 6)]
    if len(fit) == 0:
        return under
    mask = np.isin(over[1], rng.permutation(fit)[: int(rng.integers(1, 4))])
    rgb = under[0]
    if rng.random() < 0.5:
        shadow = gaussian_filter(np.roll(mask, rng.integers(-8, 9, 2), (0, 1)).astype(np.float32), rng.uniform(1, 8))
        rgb = rgb * (1 - rng.uniform(0.2, 0.9) * shadow)[..., None]
    soft = gaussian_filter(mask.astype(np.float32), 0.5)[..., None]
    light = np.exp(rng.normal() * 0.15).astype(np.float32)
    rgb = rgb * (1 - soft) + over[0] * light * soft
    number = np.where(mask, over[1] + 256 * (1 + int(under[1].max()) // 256), under[1])
    near = float(np.quantile(under[2], 0.9)) / max(1e-3, float(np.median(over[2][mask])))
    inverse = np.where(mask, over[2] * max(near, 1e-3), under[2])
    return rgb.astype(np.float32), number.astype(np.int32), inverse.astype(np.float32)


def _recoloured(rgb: F32, things: NDArray[np.int32], rng: np.random.Generator, pattern: F32) -> F32:
    """Things take a new tint, the mean colour of another thing, or another picture as a texture."""
    result = rgb.copy()
    numbers = np.unique(things)
    grain = pattern / np.maximum(pattern.mean(axis=(0, 1)), 0.05)
    means = np.array([rgb[things == n].mean(axis=0) for n in numbers])
    for i, number in enumerate(numbers):
        draw, mask = rng.random(), things == number
        if draw < 0.35:
            gain = np.exp(rng.normal() * 0.35 + rng.normal(size=3) * 0.15)
        elif draw < 0.55:  # low contrast: as bright and as coloured as another thing
            gain = means[int(rng.integers(len(means)))] / np.maximum(means[i], 0.03) * np.exp(rng.normal(size=3) * 0.04)
        else:
            continue
        result[mask] *= np.clip(gain, 0.1, 6).astype(np.float32)
    for number in rng.permutation(numbers)[: int(rng.integers(0, 3))]:
        mask = things == number
        result[mask] *= grain[mask] ** np.float32(rng.uniform(0.1, 0.9))
    return np.clip(result, 0, 1)


def _patterned(rgb: F32, things: NDArray[np.int32], rng: np.random.Generator) -> F32:
    """Stripes, grids, checks, weaves or grain over one to three of the larger things, at any angle and scale."""
    numbers, counts = np.unique(things, return_counts=True)
    chosen = rng.permutation(numbers[counts > 0.02 * things.size])[: int(rng.integers(1, 4))]
    side = len(things)
    y, x = np.meshgrid(np.arange(side, dtype=np.float32), np.arange(side, dtype=np.float32), indexing="ij")
    result = rgb.copy()
    for number in chosen:
        mask = things == number
        a, lean = rng.uniform(0, np.pi), rng.uniform(-0.6, 0.6)
        f = np.exp(rng.uniform(np.log(0.015), np.log(0.3), 2))
        if rng.random() < 0.5:
            f[1] = f[0]
        far = 1 + rng.uniform(0, 0.006) * y[mask]  # perspective
        u = f[0] * (np.cos(a) * x[mask] + np.sin(a) * y[mask]) * far
        v = f[1] * (-np.sin(a + lean) * x[mask] + np.cos(a + lean) * y[mask]) * far
        kind = int(rng.integers(5))
        if kind == 0:
            wave = np.where(u % 1 < rng.uniform(0.1, 0.9), 1.0, 0.0)
        elif kind == 1:
            line = rng.uniform(0.03, 0.15)
            wave = np.where((u % 1 < line) | (v % 1 < line), 1.0, 0.0)
        elif kind == 2:
            wave = (np.floor(u) + np.floor(v)) % 2
        elif kind == 3:
            wave = 0.5 + 0.5 * np.sin(2 * np.pi * u) * np.sin(2 * np.pi * v)
        else:
            grain = gaussian_filter(rng.normal(size=things.shape), float(rng.uniform(0.6, 4)))
            wave = 0.5 + 0.5 * (grain / max(1e-6, float(grain.std())))[mask]
        amount = rng.uniform(0.05, 0.6) * rng.choice([-1.0, 1.0])
        tint = np.clip(1 + rng.normal(size=3) * 0.3, 0.3, 1.7)
        result[mask] *= np.clip(1 + amount * wave[:, None] * tint, 0.05, 3).astype(np.float32)
    return np.clip(result, 0, 1)


def photographed(rgb: F32, rng: np.random.Generator) -> F32:
    """Exposure, white balance, contrast, vignetting, blur, noise, sharpening and JPEG, each at random."""
    side = rgb.shape[0]
    out = np.clip(rgb, 0, 1) ** np.exp(rng.normal() * 0.25)
    out = out * np.exp(rng.normal() * 0.25) * np.exp(rng.normal(size=3) * 0.08)
    if rng.random() < 0.25:
        grey = out.mean(axis=2, keepdims=True)
        out = grey + (out - grey) * rng.uniform(0, 1.6)
    if rng.random() < 0.3:
        out = 0.5 + (out - 0.5) * rng.uniform(0.4, 1.3) + rng.normal() * 0.05
    if rng.random() < 0.3:
        y, x = np.meshgrid(*(np.linspace(-1, 1, side) - rng.uniform(-0.7, 0.7) for _ in range(2)), indexing="ij")
        out = out * (1 - rng.uniform(0, 0.6) * np.clip(x * x + y * y, 0, 1.5))[..., None]
    draw = rng.random()
    if draw < 0.35:
        out = gaussian_filter(out, (s := float(rng.uniform(0.3, 1.6)), s, 0))
    elif draw < 0.45:
        out = uniform_filter(
            out, (1, int(rng.integers(2, 6)), 1) if rng.random() < 0.5 else (int(rng.integers(2, 6)), 1, 1)
        )
    elif draw < 0.6:  # sharpened, as cameras do
        out = out + rng.uniform(0.3, 1.2) * (out - gaussian_filter(out, (1, 1, 0)))
    if rng.random() < 0.5:
        noise = rng.normal(size=out.shape).astype(np.float32)
        if rng.random() < 0.5:
            noise = gaussian_filter(noise, (0.7, 0.7, 0)) * 2
        out = out + noise * rng.uniform(0, 0.06) * (0.4 + np.clip(out, 0, 1))
    out = np.clip(out, 0, 1)
    if rng.random() < 0.35:
        stream = io.BytesIO()
        Image.fromarray((out * 255).astype(np.uint8)).save(stream, "JPEG", quality=int(rng.integers(25, 95)))
        out = np.asarray(Image.open(stream), np.float32) / 255
    return np.asarray(out, np.float32)


def _geometry(inverse: F32, focal: float, rng: np.random.Generator) -> F32:
    """Depth and normals `[5, S, S]` with the faults of a fitted scene; nothing at all in half of the pictures."""
    if rng.random() < 0.5:
        return np.zeros((CHANNELS - 3, *inverse.shape), np.float32)
    side = len(inverse)
    draw = rng.random()
    if draw < 0.7:
        inverse = gaussian_filter(inverse, float(rng.uniform(0.3, 2.5)))
    if rng.random() < 0.7:
        coarse = rng.normal(size=(side // 6 + 1, side // 6 + 1)).astype(np.float32)
        noise = np.asarray(Image.fromarray(coarse).resize((side, side), Image.Resampling.BICUBIC))
        inverse = inverse * np.exp(rng.uniform(0, 0.04) * noise)
    if rng.random() < 0.5:
        inverse = inverse * np.exp(rng.normal(size=inverse.shape) * rng.uniform(0, 0.01))
    if rng.random() < 0.4:  # nothing was reconstructed here
        blob = gaussian_filter(rng.normal(size=inverse.shape), float(rng.uniform(4, 16)))
        inverse = np.where(blob > np.quantile(blob, rng.uniform(0.6, 0.97)), 0, inverse)
    return geometry_of(inverse.astype(np.float32), focal)


def geometry_of(inverse: F32, focal: float) -> F32:
    """The channels `[5, H, W]` of an inverse depth map `[H, W]`, 0 where unknown: it divided by its median, the unit
    normal in camera axes from differences of neighbouring points, and where both are known."""
    height, width = inverse.shape
    known = inverse > 1e-4
    depth = 1 / np.where(known, inverse, 1)
    y, x = np.meshgrid(np.arange(height) + 0.5 - height / 2, np.arange(width) + 0.5 - width / 2, indexing="ij")
    point = np.stack([x * depth / focal, y * depth / focal, depth], axis=2)
    normal = np.cross(np.gradient(point, axis=0), np.gradient(point, axis=1))
    normal /= np.maximum(np.linalg.norm(normal, axis=2, keepdims=True), 1e-12)
    normal *= np.where((normal * point).sum(axis=2, keepdims=True) > 0, -1, 1)
    median = float(np.median(inverse[known])) if known.any() else 1.0
    layers = np.concatenate(
        [np.minimum(inverse / median, 8)[None], normal.transpose(2, 0, 1), np.ones((1, height, width))]
    )
    return np.asarray(layers * known, np.float32)
