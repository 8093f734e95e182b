"""Procedural textures: colours of surface points from a material and texture coordinates, one pixel at a time.

A material is a row of `WIDTH` numbers; `Slot` names its columns. Texture edges are no borders between things: the
network has to learn to ignore them.
"""

from __future__ import annotations

from enum import IntEnum
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

F32 = NDArray[np.float32]


class Slot(IntEnum):
    """Columns of a material."""

    KIND = 0
    RED, GREEN, BLUE = 1, 2, 3
    RED2, GREEN2, BLUE2 = 4, 5, 6
    SCALE = 7  # features a metre
    SEED = 8
    AMOUNT = 9  # strength in [0, 1]
    OWN = 10  # share of the mesh's own colours in the first colour
    GLOSS = 11  # strength of highlights
    SHARP = 12  # exponent of highlights
    BUMP = 13  # tilt of normals by noise
    TURN = 14  # radians


WIDTH = len(Slot)


class Kind(IntEnum):
    """Textures."""

    FLAT = 0
    NOISE = 1
    CLOUDS = 2
    STRIPES = 3
    CHECKS = 4
    TILES = 5
    PLANKS = 6
    GRAIN = 7
    DOTS = 8
    PATCHES = 9
    TEXT = 10
    WEAVE = 11
    PRINT = 12
    GRADIENT = 13
    LEAVES = 14


@njit(cache=True, inline="always")
def _hash(x: int, y: int, seed: int) -> float:
    """A number in [0, 1) that depends on a lattice point."""
    h = (x * 374761393 + y * 668265263 + seed * 974634777) & 0xFFFFFFFF
    h = ((h ^ (h >> 13)) * 1274126177) & 0xFFFFFFFF
    return ((h ^ (h >> 16)) & 0xFFFFFF) / 16777216.0


@njit(cache=True)
def _value(x: float, y: float, seed: int) -> float:
    """Value noise in [0, 1): smooth, features about 1 wide."""
    ix, iy = int(np.floor(x)), int(np.floor(y))
    fx, fy = x - ix, y - iy
    fx, fy = fx * fx * (3 - 2 * fx), fy * fy * (3 - 2 * fy)
    a = _hash(ix, iy, seed) * (1 - fx) + _hash(ix + 1, iy, seed) * fx
    b = _hash(ix, iy + 1, seed) * (1 - fx) + _hash(ix + 1, iy + 1, seed) * fx
    return a * (1 - fy) + b * fy


@njit(cache=True)
def _fractal(x: float, y: float, seed: int) -> float:
    """Four octaves of value noise, about [0, 1]."""
    total, weight = 0.0, 0.5
    for octave in range(4):
        total += weight * _value(x, y, seed + octave)
        x, y, weight = x * 2.03, y * 2.03, weight * 0.5
    return total / 0.9375


@njit(cache=True)
def _cell(x: float, y: float, seed: int) -> int:
    """Number of the nearest scattered point (Worley 1996)."""
    ix, iy = int(np.floor(x)), int(np.floor(y))
    best, found = 1e9, 0
    for dy in range(-1, 2):
        for dx in range(-1, 2):
            px, py = ix + dx + _hash(ix + dx, iy + dy, seed), iy + dy + _hash(ix + dx, iy + dy, seed + 1)
            d = (px - x) ** 2 + (py - y) ** 2
            if d < best:
                best, found = d, ((ix + dx) * 7919 + (iy + dy) * 104729) & 0xFFFFF
    return found


@njit(cache=True)
def _mixed(kind: int, x: float, y: float, seed: int) -> tuple[float, float]:
    """Share of the second colour and the relative brightness at `x, y`, in features."""
    if kind == 1:
        return 0.0, 0.6 * (_value(x * 8, y * 8, seed) - 0.5)
    if kind == 2:
        return min(1.0, max(0.0, 2.5 * _fractal(x, y, seed) - 0.75)), 0.0
    if kind == 3:
        wide = 0.2 + 0.6 * _hash(seed, 3, 1)
        return (1.0 if x - np.floor(x) < wide else 0.0), 0.1 * (_hash(int(np.floor(x)), 0, seed) - 0.5)
    if kind == 4:
        return float((int(np.floor(x)) + int(np.floor(y))) & 1), 0.05 * (_value(4 * x, 4 * y, seed) - 0.5)
    if kind == 5:
        grout = 0.02 + 0.06 * _hash(seed, 5, 1)
        gx, gy = x - np.floor(x), y - np.floor(y)
        line = 1.0 if gx < grout or gy < grout else 0.0
        shade = 0.25 * (_hash(int(np.floor(x)), int(np.floor(y)), seed) - 0.5) + 0.2 * (
            _fractal(3 * x, 3 * y, seed) - 0.5
        )
        return line, shade
    if kind == 6:
        lane = int(np.floor(x))
        along = y / 6 + 3.7 * _hash(lane, 1, seed)
        gx, gy = x - lane, along - np.floor(along)
        line = 1.0 if gx < 0.03 or gy < 0.005 else 0.0
        tone = _hash(lane, int(np.floor(along)), seed) - 0.5
        grain = _fractal(x * 9, y * 0.7 + 31 * tone, seed) - 0.5
        return 0.8 * line, 0.5 * tone * _hash(seed, 6, 1) + 0.4 * grain
    if kind == 7:
        ring = 3 * x + 2.5 * _fractal(0.8 * x, 0.15 * y, seed)
        wave = 0.5 + 0.5 * np.sin(6.2832 * ring)
        return wave * (0.3 + 0.7 * _hash(seed, 7, 1)), 0.25 * (_fractal(x * 14, y * 0.8, seed) - 0.5)
    if kind == 8:
        gx, gy = x - np.floor(x) - 0.5, y - np.floor(y) - 0.5
        radius = 0.12 + 0.3 * _hash(seed, 8, 1)
        return (1.0 if gx * gx + gy * gy < radius * radius else 0.0), 0.0
    if kind == 9:
        cell = _cell(x, y, seed)
        return _hash(cell, 0, seed), 0.8 * (_hash(cell, 1, seed) - 0.5)
    if kind == 10:
        row = int(np.floor(y * 4))
        word = int(np.floor(x * 7 + 3 * _hash(row, 2, seed)))
        ink = y * 4 - row < 0.55 and _hash(word, row, seed) < 0.75 and _hash(row, 9, seed) < 0.85
        return (1.0 if ink and _hash(int(x * 40), row, seed) < 0.8 else 0.0), 0.0
    if kind == 11:
        return 0.0, 0.9 * (_value(x * 25, y * 25, seed) - 0.5) + 0.4 * (_fractal(2 * x, 2 * y, seed) - 0.5)
    if kind == 13:
        return 0.5 + 0.5 * np.sin(x + 6.28 * _hash(seed, 1, 1)), 0.0
    cell = _cell(4 * x + 1.5 * _fractal(3 * x, 3 * y, seed), 4 * y, seed)
    return (1.0 if _hash(cell, 4, seed) < 0.4 else 0.0), 0.9 * (_hash(cell, 5, seed) - 0.5)


@njit(cache=True, error_model="numpy")
def paint(materials: Any, rows: Any, uv: Any, own: Any, prints: Any) -> Any:
    """Albedo `[M, 3]` in [0, 1] of points with material rows `[M]`, coordinates `[M, 2]` in metres and colours of
    their meshes `[M, 3]`; `prints [T, S, S, 3]` are the pictures of `Kind.PRINT`."""
    out = np.empty((len(rows), 3), np.float32)
    side = prints.shape[1]
    for i in range(len(rows)):
        m = materials[rows[i]]
        c, s = np.cos(m[14]), np.sin(m[14])
        x, y = (c * uv[i, 0] - s * uv[i, 1]) * m[7], (s * uv[i, 0] + c * uv[i, 1]) * m[7]
        kind, seed = int(m[0]), int(m[8])
        if kind == 12:
            number = (seed + int(np.floor(x)) * 3 + int(np.floor(y)) * 5) % len(prints)
            col, row = int((x - np.floor(x)) * side) % side, int((y - np.floor(y)) * side) % side
            for k in range(3):
                base = m[1 + k] * (1 - m[10]) + own[i, k] * m[10]
                out[i, k] = base * (1 - m[9]) + prints[number, row, col, k] * m[9]
            continue
        share, shade = (0.0, 0.0) if kind == 0 else _mixed(kind, x, y, seed)
        for k in range(3):
            base = m[1 + k] * (1 - m[10]) + own[i, k] * m[10]
            value = (base + (m[4 + k] - base) * share * m[9]) * (1 + shade * m[9])
            out[i, k] = min(1.0, max(0.0, value))
    return out


@njit(cache=True, error_model="numpy")
def bumps(materials: Any, rows: Any, uv: Any) -> Any:
    """Slopes `[M, 2]` of small bumps along the two texture coordinates."""
    out = np.zeros((len(rows), 2), np.float32)
    for i in range(len(rows)):
        m = materials[rows[i]]
        if m[13] > 0:
            x, y, seed = uv[i, 0] * m[7] * 3, uv[i, 1] * m[7] * 3, int(m[8])
            here = _fractal(x, y, seed)
            out[i, 0] = m[13] * (_fractal(x + 0.2, y, seed) - here) * 5
            out[i, 1] = m[13] * (_fractal(x, y + 0.2, seed) - here) * 5
    return out


def random_prints(rng: np.random.Generator, count: int = 40, side: int = 96) -> F32:
    """`[T, S, S, 3]` pictures of overlapping shapes, blobs and gradients, for posters, covers and printed cloth."""
    grid = (np.arange(side, dtype=np.float32) + 0.5) / side
    y, x = np.meshgrid(grid, grid, indexing="ij")
    result = np.empty((count, side, side, 3), np.float32)
    for number in range(count):
        a, b = rng.random((2, 3))
        picture = a + (b - a) * (x if rng.random() < 0.5 else y)[..., None]
        for _ in range(int(rng.integers(3, 40))):
            cx, cy = rng.random(2)
            w, h = 0.35 * rng.random(2) ** 1.5 + 0.02
            angle = rng.uniform(0, np.pi)
            u = ((x - cx) * np.cos(angle) + (y - cy) * np.sin(angle)) / w
            v = (-(x - cx) * np.sin(angle) + (y - cy) * np.cos(angle)) / h
            inside = (u * u + v * v < 1) if rng.random() < 0.5 else (np.maximum(np.abs(u), np.abs(v)) < 1)
            picture = np.where(inside[..., None], rng.random(3) * rng.uniform(0.5, 1.2), picture)
        result[number] = np.clip(picture, 0, 1)
    return result
