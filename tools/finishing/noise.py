"""Gradient noise and cellular noise in three dimensions, as arrays; the same seed gives the same values.

Gradient noise after Perlin, "Improving Noise" (SIGGRAPH 2002); cellular noise after Worley, "A Cellular Texture Basis
Function" (SIGGRAPH 1996). Cells are hashed, so there is no table and no period.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
_PRIMES = tuple(np.uint32(p) for p in (0x8DA6B343, 0xD8163841, 0xCB1AB31F))
_BLUR = 2.0  # (pi times the feature's share of a period) squared: how fast a blur takes the contrast of a feature
_CORNERS = tuple((i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1))


def hashed(cells: NDArray[np.int32], seed: int) -> NDArray[np.uint32]:
    """`[N]` hash of cells `[N, D]`, D at most 3: every bit depends on every coordinate."""
    mixed = np.full(len(cells), np.uint32(seed * 0x9E3779B1 & 0xFFFFFFFF), dtype=np.uint32)
    for axis in range(cells.shape[1]):
        mixed ^= cells[:, axis].astype(np.uint32) * _PRIMES[axis]
        mixed ^= mixed >> np.uint32(15)
        mixed *= np.uint32(0x2C1B3C6D)
        mixed ^= mixed >> np.uint32(12)
    mixed *= np.uint32(0x297A2D39)
    mixed ^= mixed >> np.uint32(15)
    return mixed


def random(cells: NDArray[np.int32], seed: int) -> F32:
    """`[N]` number in [0, 1) of each cell `[N, D]`."""
    return (hashed(cells, seed) >> np.uint32(8)).astype(np.float32) * np.float32(2.0**-24)


def _gradient(cells: NDArray[np.int32], offset: F32, seed: int) -> F32:
    """`[N]` dot product of the offsets `[N, 3]` and the cells' gradients, which are the edges of a cube."""
    h = hashed(cells, seed) & np.uint32(15)
    x, y, z = offset.T
    u = np.where(h < 8, x, y)
    v = np.where(h < 4, y, np.where((h == 12) | (h == 14), x, z))
    return np.asarray(np.where(h & 1, -u, u) + np.where(h & 2, -v, v), dtype=np.float32)


def gradient_noise(points: F32, seed: int) -> F32:
    """`[N]` smooth noise about 0, mostly in [-0.7, 0.7], with features of size 1, at points `[N, 3]`."""
    base = np.floor(points)
    cells, f = base.astype(np.int32), (points - base).astype(np.float32)
    fade = f * f * f * (f * (f * 6 - 15) + 10)
    out = np.zeros(len(points), dtype=np.float32)
    for corner in _CORNERS:
        step = np.array(corner)
        weight = np.prod(np.where(step, fade, 1 - fade), axis=1, dtype=np.float32)
        out += weight * _gradient(cells + step.astype(np.int32), f - step.astype(np.float32), seed)
    return out


def fractal(points: F32, size: float, blur: F32, seed: int, octaves: int = 4) -> F32:
    """`[N]` sum of noises of size `size`, `size / 2`, ..., each with half the contrast of the one before.

    Args:
        points: `[N, 3]`, metres.
        blur: `[N]` standard deviation over which a point stands for the surface, metres: features that are finer than
            it have no contrast.
    """
    out = np.zeros(len(points), dtype=np.float32)
    for octave in range(octaves):
        feature = size / 2**octave
        out += faded(blur, feature) * gradient_noise(points / np.float32(feature), seed + octave) * 0.5**octave
    return out


def faded(blur: F32, feature: float) -> F32:
    """`[N]` share of its contrast that a feature of a size (metres) has left after a blur."""
    return np.asarray(np.exp(-_BLUR * (blur / feature) ** 2), dtype=np.float32)


class Cells(NamedTuple):
    """Cellular noise.

    Attributes:
        edge: `[N]` distance to the border of the nearest cell, about; in sizes of a cell.
        chance: `[N]` random number in [0, 1) of the cell.
    """

    edge: F32
    chance: F32


def cellular(points: F32, size: float, seed: int) -> Cells:
    """Irregular cells of about `size` metres around one random point each, at points `[N, 3]`."""
    scaled = points / np.float32(size)
    base = np.floor(scaled).astype(np.int32)
    nearest = np.full(len(points), np.inf, dtype=np.float32)
    second, chance = nearest.copy(), np.zeros(len(points), dtype=np.float32)
    for i in (-1, 0, 1):
        for j in (-1, 0, 1):
            for k in (-1, 0, 1):
                cell = base + np.array([i, j, k], dtype=np.int32)
                place = np.stack([random(cell, seed + axis) for axis in range(3)], axis=1)
                far = np.linalg.norm(cell + place - scaled, axis=1).astype(np.float32)
                closer = far < nearest
                second = np.where(closer, nearest, np.minimum(second, far))
                chance = np.where(closer, random(cell, seed + 3), chance)
                nearest = np.minimum(nearest, far)
    return Cells((second - nearest).astype(np.float32), chance.astype(np.float32))
