"""Data augmentation on batches of crops: framing, resolution, light, hue and backgrounds. Deterministic by seed.

One loop over the pixels does all of it, since the training of a small network is as fast as its pictures are made.
"""

from __future__ import annotations

import math

import numpy as np
import torch
from numba import njit
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from .model import IMAGE_SIZE

_AXIS = np.full(3, 1 / math.sqrt(3))
_GREY, _TWO_TONE, _SOFT, _NOISY = range(4)  # kinds of background
_BACKGROUNDS = (0.8, 0.08, 0.07, 0.05)  # how often each is drawn


def augment(pixels: Tensor, seed: int, size: int = IMAGE_SIZE) -> Tensor:
    """`[B, S, S, 4]` uint8 premultiplied crops to `[B, 3, size, size]` float pictures in [0, 1]."""
    rng = np.random.default_rng(seed)
    n = len(pixels)
    frame = _framing(rng, n)
    side = np.where(rng.random(n) < 0.33, rng.integers(18, 45, size=n), 0)
    hue, curve = _light(rng, n)
    kind = rng.choice(4, size=n, p=_BACKGROUNDS)
    behind = _colors_behind(rng, kind)
    hidden = _hidden(rng, n)
    noise = rng.random(n) ** 3 * 0.28
    out = np.empty((n, size, size, 3), dtype=np.float32)
    _draw(pixels.numpy(), frame, side, hue, curve, kind, behind, hidden, noise, seed, out)
    return torch.from_numpy(out).permute(0, 3, 1, 2)


def plain(pixels: Tensor, size: int = IMAGE_SIZE) -> Tensor:
    """The crops without augmentation over neutral grey, `[B, 3, size, size]`, for evaluation."""
    rgba = pixels.permute(0, 3, 1, 2).float() / 255
    rgba = functional.interpolate(rgba, (size, size), mode="bilinear", antialias=True)
    return (rgba[:, :3] + (1 - rgba[:, 3:]) * 0.5).clamp(0, 1)


def _framing(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    """`[B, 2, 3]` maps from the picture to the crop, both in [-1, 1]: mirror, rotate a little, scale, stretch, shift;
    some borders are cut off."""
    turn = rng.normal(size=n) * 0.06
    scale = np.exp(rng.normal(size=n) * 0.1) * 0.97
    stretch = np.exp(rng.normal(size=n) * 0.05)
    flip = np.where(rng.random(n) < 0.5, -1.0, 1.0)
    rows = np.zeros((n, 2, 3))
    rows[:, 0, 0], rows[:, 0, 1] = flip * scale * stretch * np.cos(turn), -scale * np.sin(turn)
    rows[:, 1, 0], rows[:, 1, 1] = flip * scale * np.sin(turn), scale / stretch * np.cos(turn)
    rows[:, :, 2] = rng.normal(size=(n, 2)) * 0.05
    return rows


def _light(rng: np.random.Generator, n: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Hue matrices `[B, 3, 3]`, of which 60 % turn and fade the colours, and curves `[B, 3, 257]` of gain, gamma and
    tint: names depend on shape."""
    strong = rng.random(n) < 0.6
    angle = (rng.random(n) * 2 - 1) * math.pi * strong
    saturation = 1 + (rng.random(n) * 1.5 - 0.9) * strong
    along = np.outer(_AXIS, _AXIS)
    cross = np.array([[0.0, -_AXIS[2], _AXIS[1]], [_AXIS[2], 0.0, -_AXIS[0]], [-_AXIS[1], _AXIS[0], 0.0]])
    c, s = np.cos(angle)[:, None, None], np.sin(angle)[:, None, None]
    hue = along + saturation[:, None, None] * (c * (np.eye(3) - along) + s * cross)  # Rodrigues, about the grey axis
    gain = np.exp(rng.normal(size=(n, 1, 1)) * 0.25) * np.exp(rng.normal(size=(n, 3, 1)) * 0.08)
    gamma = np.exp(rng.normal(size=(n, 1, 1)) * 0.2)
    return hue, np.clip(gain * (np.arange(257) / 256) ** gamma, 0, 1)


def _colors_behind(rng: np.random.Generator, kind: NDArray[np.int64]) -> NDArray[np.float64]:
    """`[B, 5, 5, 3]` colours of the backgrounds: one grey, two tones (above and below), or soft clutter."""
    n = len(kind)
    grey = np.broadcast_to((0.5 + 0.03 * rng.normal(size=n))[:, None, None, None], (n, 5, 5, 3))
    clutter = rng.random((n, 5, 5, 3)) * 0.5 + rng.random((n, 1, 1, 1)) * 0.5
    tones = rng.random((n, 2, 1, 3)) * 0.25 + rng.random((n, 1, 1, 1)) * 0.75
    two = np.where(np.arange(5)[:, None, None] < rng.integers(1, 5, size=(n, 1, 1, 1)), tones[:, :1], tones[:, 1:])
    two = np.broadcast_to(two, (n, 5, 5, 3))
    kinds = kind[:, None, None, None]
    return np.where(kinds == _GREY, grey, np.where(kinds == _TWO_TONE, two, clutter)).clip(0, 1)


def _hidden(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    """`[B, 3]` a line (unit normal, offset) beyond which the object is hidden, in an eighth of the pictures."""
    angle = rng.random(n) * 2 * math.pi
    offset = np.where(rng.random(n) < 0.125, rng.uniform(0.3, 0.8, size=n), 10.0)
    return np.stack([np.cos(angle), np.sin(angle), offset], axis=1)


@njit(cache=True, fastmath=True, nogil=True)
def _draw(pixels, frame, side, hue, curve, kind, behind, hidden, noise, seed, out):  # type: ignore[no-untyped-def]
    """Fill `out` `[B, H, H, 3]`; see `augment` for the other arrays."""
    size = out.shape[1]
    first = np.empty((size, size, 4), dtype=np.float32)
    for b in range(len(pixels)):
        grid = side[b] if side[b] > 0 else size
        _sample(pixels[b], frame[b], grid, 1 if grid == size else 2, first)
        state = np.uint32((seed * 7919 + b * 104729 + 12345) & 0xFFFFFFFF)
        if state == 0:
            state = np.uint32(1)
        for y in range(size):
            for x in range(size):
                if grid == size:
                    r, g, v, a = first[y, x, 0], first[y, x, 1], first[y, x, 2], first[y, x, 3]
                else:
                    fy = min(max((y + 0.5) * grid / size - 0.5, 0.0), grid - 1.001)
                    fx = min(max((x + 0.5) * grid / size - 0.5, 0.0), grid - 1.001)
                    iy, ix = int(fy), int(fx)
                    wy, wx = fy - iy, fx - ix
                    c0, c1 = (1 - wy) * (1 - wx), (1 - wy) * wx
                    c2, c3 = wy * (1 - wx), wy * wx
                    p, q, s, t = first[iy, ix], first[iy, ix + 1], first[iy + 1, ix], first[iy + 1, ix + 1]
                    r = c0 * p[0] + c1 * q[0] + c2 * s[0] + c3 * t[0]
                    g = c0 * p[1] + c1 * q[1] + c2 * s[1] + c3 * t[1]
                    v = c0 * p[2] + c1 * q[2] + c2 * s[2] + c3 * t[2]
                    a = c0 * p[3] + c1 * q[3] + c2 * s[3] + c3 * t[3]
                px, py = 2 * (x + 0.5) / size - 1, 2 * (y + 0.5) / size - 1
                if hidden[b, 0] * px + hidden[b, 1] * py > hidden[b, 2]:
                    r, g, v, a = 0.0, 0.0, 0.0, 0.0
                by, bx = (y * 5) // size, (x * 5) // size
                if kind[b] == 2:  # soft clutter
                    gy, gx = y * 4.0 / size, x * 4.0 / size
                    by, bx = int(gy), int(gx)
                    wy, wx = gy - by, gx - bx
                over = max(a, 0.02)
                for k in range(3):
                    value = (hue[b, k, 0] * r + hue[b, k, 1] * g + hue[b, k, 2] * v) / over
                    value = curve[b, k, int(min(max(value, 0.0), 1.0) * 256)]
                    if kind[b] == 2:
                        top = behind[b, by, bx, k] * (1 - wx) + behind[b, by, bx + 1, k] * wx
                        low = behind[b, by + 1, bx, k] * (1 - wx) + behind[b, by + 1, bx + 1, k] * wx
                        back = top * (1 - wy) + low * wy
                    elif kind[b] == 3:
                        cell = np.uint32((y // 2) * 97 + (x // 2) * 1013 + k * 7 + b * 31)
                        cell = np.uint32(cell * np.uint32(2654435761))
                        cell ^= cell >> np.uint32(15)
                        cell = np.uint32(cell * np.uint32(2246822519))
                        cell ^= cell >> np.uint32(13)
                        back = (cell & np.uint32(0xFFFF)) / 65535.0
                    else:
                        back = behind[b, by, bx, k]
                    state ^= np.uint32(state << np.uint32(13))
                    state ^= state >> np.uint32(17)
                    state ^= np.uint32(state << np.uint32(5))
                    grain = ((state >> np.uint32(8)) & np.uint32(0xFFFF)) / 65535.0 - 0.5
                    out[b, y, x, k] = min(max(value * a + back * (1 - a) + grain * noise[b], 0.0), 1.0)


@njit(cache=True, fastmath=True, nogil=True)
def _sample(image, frame, grid, taps, out):  # type: ignore[no-untyped-def]
    """Sample a crop `[S, S, 4]` uint8 at `grid` x `grid` points of the picture, each the mean of `taps` x `taps`
    samples, into the corner of `out`, as numbers in [0, 1]; outside the crop they are 0."""
    source = image.shape[0]
    share = 1.0 / (255.0 * taps * taps)
    for y in range(grid):
        for x in range(grid):
            for k in range(4):
                out[y, x, k] = 0.0
            for sub in range(taps * taps):
                py = 2 * (y + (sub // taps + 0.5) / taps) / grid - 1
                px = 2 * (x + (sub % taps + 0.5) / taps) / grid - 1
                fx = ((frame[0, 0] * px + frame[0, 1] * py + frame[0, 2]) + 1) * source / 2 - 0.5
                fy = ((frame[1, 0] * px + frame[1, 1] * py + frame[1, 2]) + 1) * source / 2 - 0.5
                iy, ix = math.floor(fy), math.floor(fx)
                wy, wx = fy - iy, fx - ix
                for dy in range(2):
                    for dx in range(2):
                        yy, xx = iy + dy, ix + dx
                        if 0 <= yy < source and 0 <= xx < source:
                            w = (wy if dy else 1 - wy) * (wx if dx else 1 - wx) * share
                            for k in range(4):
                                out[y, x, k] += w * image[yy, xx, k]
