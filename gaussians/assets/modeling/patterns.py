"""Patterns that vary a material's colour over a surface: grain, stripes, weaves, screens, pictures.

A new pattern is one function with the decorator `pattern`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...color import Rgb
from .materials import Material

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Surface:
    """Samples of one material: `xyz [N, 3]` object frame, `normal [N, 3]`, `uv [N, 2]` grid parameters in [0, 1]."""

    xyz: Array
    normal: Array
    uv: Array

    def plane(self) -> Array:
        """`[N, 2]` metres: the two object axes most across the normal (a triplanar projection)."""
        n = np.abs(self.normal)
        facing = np.argmax(n, axis=1)
        first = np.where(facing == 0, self.xyz[:, 1], self.xyz[:, 0])
        second = np.where(facing == 2, self.xyz[:, 1], self.xyz[:, 2])
        return np.stack([first, second], axis=1)


Pattern = Callable[[Surface, Material], Array]
PATTERNS: dict[str, Pattern] = {}


def pattern(name: str) -> Callable[[Pattern], Pattern]:
    """Register a pattern: a function of samples and material that returns RGB `[N, 3]`."""

    def keep(fn: Pattern) -> Pattern:
        PATTERNS[name] = fn
        return fn

    return keep


# Factor on the density of samples for patterns whose colour changes within centimetres.
FINE = {"stripes": 1.3, "checks": 1.35, "dots": 1.4, "leaves": 1.3, "picture": 1.5, "screen": 1.3, "wicker": 1.25,
        "clock": 1.6, "rug": 1.4, "keys": 1.5, "wood": 1.1}  # fmt: skip


def paint(surface: Surface, material: Material) -> Array:
    """RGB `[N, 3]` of the samples."""
    return np.clip(PATTERNS[material.pattern](surface, material), 0.0, 1.0)


def _noise(x: Array, seed: int, octaves: int = 3) -> Array:
    """Smooth noise around 0, roughly in [-1, 1], at positions `[N, D]` in units of the feature size: plane waves."""
    rng = np.random.default_rng(seed)
    out: Array = np.zeros(len(x))
    for o in range(octaves):
        for _ in range(3):
            k = rng.normal(size=x.shape[1])
            k = k * (2.0**o * 3.0 / float(np.linalg.norm(k)))
            out += np.sin(x @ k + rng.uniform(0, 6.3)) / (3 * 1.5**o)
    return out


def _two(material: Material, mask: Array) -> Array:
    a, b = np.array(material.color), np.array(material.second)
    return np.asarray(a + (b - a) * mask[:, None])


def _tint(rgb: Rgb | Array, gain: Array) -> Array:
    return np.asarray(np.asarray(rgb) * (1 + gain[:, None]))


@pattern("plain")
def _plain(s: Surface, m: Material) -> Array:
    return _tint(m.color, 0.025 * _noise(s.xyz / 0.15, m.seed, 1))


@pattern("flat")
def _flat(s: Surface, m: Material) -> Array:
    return np.broadcast_to(np.array(m.color), (len(s.xyz), 3))


@pattern("wood")
def _wood(s: Surface, m: Material) -> Array:
    """Boards side by side, each of its own shade, with a wavy grain along the axis."""
    first, second = [k for k in range(3) if k != m.axis]
    facing = np.abs(s.normal[:, first]) > np.abs(s.normal[:, second])
    across = np.where(facing, s.xyz[:, second], s.xyz[:, first])
    run = s.xyz[:, m.axis]
    board = np.floor(across / 0.14 + 0.37 * (m.seed % 5))
    tone = np.mod(np.sin(board * 12.9898 + m.seed % 89) * 43758.5453, 1.0) - 0.5
    wave = 0.55 * np.sin(run * 3.1 + 4 * tone) + 0.3 * np.sin(run * 7.3 + m.seed % 7 + 9 * tone)
    grain = np.sin(2 * np.pi * (across / 0.075 + 0.45 * wave + tone)) + 0.4 * np.sin(
        2 * np.pi * (across / 0.031 + wave)
    )
    return _tint(m.color, 0.055 * grain + 0.09 * tone)


@pattern("stripes")
def _stripes(s: Surface, m: Material) -> Array:
    return _two(m, (np.mod(s.xyz[:, m.axis] / m.scale + (m.seed % 10) / 10, 1.0) < 0.45).astype(float))


@pattern("checks")
def _checks(s: Surface, m: Material) -> Array:
    """Gingham: two crossed bands, half tone where one covers, full where both do."""
    cell = np.mod(s.plane() / m.scale, 1.0) < 0.5
    return _two(m, 0.5 * cell.sum(axis=1))


@pattern("dots")
def _dots(s: Surface, m: Material) -> Array:
    p = s.plane() / m.scale
    p[:, 0] += 0.5 * np.mod(np.floor(p[:, 1]), 2)
    return _two(m, (np.linalg.norm(np.mod(p, 1.0) - 0.5, axis=1) < 0.3).astype(float))


@pattern("weave")
def _weave(s: Surface, m: Material) -> Array:
    p = s.plane() / 0.02
    return _tint(
        m.color, 0.05 * np.sin(2 * np.pi * p[:, 0]) * np.sin(2 * np.pi * p[:, 1]) + 0.04 * _noise(s.xyz / 0.08, m.seed)
    )


@pattern("leaves")
def _leaves(s: Surface, m: Material) -> Array:
    """A printed fabric: scattered slanted ellipses."""
    p = s.plane() / m.scale
    cell = np.floor(p)
    slant = np.where(np.mod(cell.sum(axis=1), 2) < 1, 1.0, -1.0)
    q = np.mod(p, 1.0) - 0.5
    a, b = q[:, 0] + slant * q[:, 1], q[:, 1] - slant * q[:, 0]
    return _two(m, ((a / 0.62) ** 2 + (b / 0.26) ** 2 < 1).astype(float))


@pattern("marble")
def _marble(s: Surface, m: Material) -> Array:
    vein = np.abs(np.sin(s.xyz @ np.array([7.0, 9.0, 6.0]) + 2.5 * _noise(s.xyz / 0.3, m.seed)))
    return _two(m, 0.8 * np.exp(-((vein / 0.13) ** 2)))


@pattern("wicker")
def _wicker(s: Surface, m: Material) -> Array:
    p = s.plane() / m.scale
    over = np.mod(np.floor(p[:, 0]) + np.floor(p[:, 1]), 2)
    bulge = np.sin(np.pi * np.mod(p[:, 0], 1)) * np.sin(np.pi * np.mod(p[:, 1], 1))
    return _tint(m.color, -0.22 + 0.25 * over * bulge + 0.12 * bulge)


@pattern("brushed")
def _brushed(s: Surface, m: Material) -> Array:
    """Metal: bright bands that depend on the normal, like reflections of a room."""
    sky = 0.5 + 0.5 * s.normal[:, 2]
    band = 0.16 * np.sin(5.0 * s.normal[:, 0] + 3.0 * s.normal[:, 2] + 1.0)
    return _tint(m.color, 0.25 * (sky - 0.5) + band)


@pattern("glow")
def _glow(s: Surface, m: Material) -> Array:
    """A lit shade: brightest at mid height."""
    z = s.xyz[:, 2]
    t = (z - z.min()) / max(float(np.ptp(z)), 1e-6)
    return _two(m, 0.55 * np.exp(-(((t - 0.45) / 0.35) ** 2)))


@pattern("fur")
def _fur(s: Surface, m: Material) -> Array:
    return _tint(m.color, 0.10 * _noise(s.xyz / 0.02, m.seed, 2))


@pattern("rug")
def _rug(s: Surface, m: Material) -> Array:
    """Border bands and a lattice of diamonds in the middle, in grid parameters."""
    edge = np.min(np.concatenate([s.uv, 1 - s.uv], axis=1), axis=1)
    count = 2 + m.seed % 4
    q = np.abs(np.mod(s.uv * np.array([2, 3]) * count / 2, 1.0) - 0.5).sum(axis=1)
    lattice = 0.75 * (q < 0.28) + 0.4 * ((q > 0.4) & (q < 0.47))
    return _two(m, np.where(edge < 0.05, 1.0, np.where(edge < 0.09, 0.0, np.where(edge < 0.12, 0.8, lattice))))


@pattern("planks")
def _planks(s: Surface, m: Material) -> Array:
    """Floor boards along x: each of its own shade, with thin dark joints and a little grain."""
    row = np.floor(s.xyz[:, 1] / m.scale)
    along = s.xyz[:, 0] / 1.3 + np.mod(row * 0.618, 1.0)
    board = np.mod(np.sin(row * 12.9898 + np.floor(along) * 78.233 + m.seed % 97) * 43758.5453, 1.0)
    joint = (np.mod(s.xyz[:, 1] / m.scale, 1.0) < 0.04) | (np.mod(along, 1.0) < 0.008)
    grain = np.sin(s.xyz[:, 1] * 160 + 3 * np.sin(s.xyz[:, 0] * 2 + 9 * board))
    return _tint(m.color, 0.22 * (board - 0.5) + 0.035 * grain - 0.2 * joint)


@pattern("tiles")
def _tiles(s: Surface, m: Material) -> Array:
    """A chequered floor."""
    p = np.floor(s.plane() / m.scale)
    return _two(m, np.mod(p.sum(axis=1), 2))


@pattern("rings")
def _rings(s: Surface, m: Material) -> Array:
    """Concentric bands about the z axis (round rugs, plates)."""
    r = np.linalg.norm(s.xyz[:, :2], axis=1)
    return _two(m, (np.mod(r / m.scale + 0.5, 1.0) < 0.4).astype(float))


@pattern("glass")
def _glass(s: Surface, m: Material) -> Array:
    """A pane or mirror: a cool gradient with slanted light streaks."""
    p = s.plane()
    span = np.maximum(np.ptp(p, axis=0), 1e-6)
    p = (p - p.min(axis=0)) / span
    streak = np.mod((p[:, 0] + p[:, 1]) * 1.3 + (m.seed % 10) / 10, 1.0)
    return _two(
        m, 0.25 * p[:, 1] + 0.45 * ((streak > 0.35) & (streak < 0.5)) + 0.3 * ((streak > 0.56) & (streak < 0.6))
    )


@pattern("sky")
def _sky(s: Surface, m: Material) -> Array:
    """The view through a window: sky above, distant trees below."""
    u, v = s.uv[:, 0], s.uv[:, 1]
    horizon = 0.28 + 0.05 * np.sin(9 * v + m.seed % 7) + 0.03 * np.sin(23 * v + m.seed % 11)
    blue = np.array([0.62, 0.80, 0.95]) + (1 - u)[:, None] * np.array([0.28, 0.15, 0.04])
    cloud = np.clip(_noise(np.stack([u * 3, v * 2], 1), m.seed) - 0.35, 0, 0.6)[:, None]
    trees = np.array([0.35, 0.52, 0.30]) * (0.85 + 0.2 * np.sin(40 * v + 9 * u))[:, None]
    return np.where((u < horizon)[:, None], trees, blue + cloud * (1 - blue))


@pattern("screen")
def _screen(s: Surface, m: Material) -> Array:
    """A display: off (dark with a sheen), a desktop with windows, or a film still."""
    u, v = s.uv[:, 0], s.uv[:, 1]
    kind = m.seed % 3
    if kind == 0:
        return np.array([0.06, 0.065, 0.08]) + (0.10 * np.clip(u + v - 0.9, 0, 1))[:, None]
    if kind == 1:
        base = np.array([0.16, 0.30, 0.52]) + 0.25 * u[:, None] * np.array([0.5, 0.4, 0.6])
        window = (u > 0.25) & (u < 0.85) & (v > 0.15) & (v < 0.6)
        lines = (np.mod(u * 14, 1) < 0.45) & (v > 0.2) & (v < 0.52)
        page = np.where(lines[:, None], 0.45, 0.95) * np.ones(3)
        return np.where(window[:, None], page, np.where((u < 0.07)[:, None], 0.12, base))
    return _landscape(u, v, m.seed)


@pattern("keys")
def _keys(s: Surface, m: Material) -> Array:
    """Rows of keycaps: `color` the caps, `second` the gaps."""
    gap_u, gap_v = np.mod(s.uv[:, 0] * 5, 1.0), np.mod(s.uv[:, 1] * 14, 1.0)
    return _two(m, ((gap_u < 0.16) | (gap_v < 0.16)).astype(float))


@pattern("clock")
def _clock(s: Surface, m: Material) -> Array:
    """A clock face around its own centre in the x, z plane: twelve marks and two hands."""
    centre = (s.xyz.min(axis=0) + s.xyz.max(axis=0)) / 2
    x, z = s.xyz[:, 0] - centre[0], s.xyz[:, 2] - centre[2]
    r = np.hypot(x, z) / max(float(np.ptp(s.xyz[:, 2])) / 2, 1e-6)
    turn = np.arctan2(x, z) / (2 * np.pi)
    marks = (r > 0.72) & (r < 0.9) & (np.abs(np.mod(turn * 12 + 0.5, 1.0) - 0.5) < 0.14)
    hands = np.zeros(len(x), dtype=bool)
    for angle, reach, wide in ((0.83 + m.seed % 12 / 12, 0.5, 0.075), (0.16 + m.seed % 5 / 5, 0.7, 0.05)):
        dx, dz = np.sin(2 * np.pi * angle), np.cos(2 * np.pi * angle)
        size = max(float(np.ptp(s.xyz[:, 2])) / 2, 1e-6)
        along, across = (x * dx + z * dz) / size, (x * dz - z * dx) / size
        hands |= (np.abs(across) < wide) & (along > -0.1) & (along < reach)
    return _two(m, (marks | hands).astype(float))


def _landscape(u: Array, v: Array, seed: int) -> Array:
    """Layered hills, a sky and a sun, `u` up and `v` right in [0, 1]."""
    rng = np.random.default_rng(seed)
    top, low = rng.uniform(0.3, 1.0, 3), rng.uniform(0.55, 1.0, 3)
    out = low + (top - low) * u[:, None]
    sun = np.hypot(v - rng.uniform(0.2, 0.8), (u - rng.uniform(0.65, 0.85)) * 0.8) < rng.uniform(0.06, 0.12)
    out = np.where(sun[:, None], np.array([1.0, 0.9, 0.6]), out)
    hue = rng.uniform(0.1, 0.7, 3)
    for k in range(3):
        ridge = 0.62 - 0.2 * k + 0.08 * np.sin(v * rng.uniform(3, 9) + rng.uniform(0, 6)) + 0.03 * np.sin(v * 17 + k)
        out = np.where((u < ridge)[:, None], hue * (1.05 - 0.28 * k), out)
    return np.asarray(out)


@pattern("picture")
def _picture(s: Surface, m: Material) -> Array:
    """A painting: landscape, colour fields, circles, a bust, or flowers, tinted towards the main colour."""
    u, v = s.uv[:, 0], s.uv[:, 1]
    rng = np.random.default_rng(m.seed)
    kind = m.seed % 5
    main, ground = np.array(m.color), np.array(m.second)
    if kind == 0:
        return 0.45 * _landscape(u, v, m.seed) + 0.55 * (main * (0.45 + 0.75 * u[:, None]))
    out = np.broadcast_to(main, (len(u), 3)).copy()
    if kind == 1:
        for _ in range(5):
            a, b, c, d = rng.uniform(0, 0.8), rng.uniform(0, 0.8), rng.uniform(0.12, 0.4), rng.uniform(0.12, 0.4)
            tone = rng.uniform(0.1, 1.0, 3) * 0.6 + main * 0.4
            out[(u > a) & (u < a + c) & (v > b) & (v < b + d)] = tone
        return out
    if kind == 2:
        for _ in range(5):
            r = np.hypot(u - rng.uniform(0.1, 0.9), v - rng.uniform(0.1, 0.9))
            out[r < rng.uniform(0.08, 0.22)] = rng.uniform(0.2, 1.0, 3) * 0.6 + ground * 0.4
        return out
    if kind == 3:
        skin = np.array([0.86, 0.66, 0.52]) * rng.uniform(0.5, 1.05)
        body = np.hypot((v - 0.5) / 0.42, (u - 0.02) / 0.38) < 1
        hair = np.hypot((v - 0.5) / 0.2, (u - 0.62) / 0.25) < 1
        face = np.hypot((v - 0.5) / 0.15, (u - 0.56) / 0.2) < 1
        for mask, tone in ((body, ground * 0.7), (hair, rng.uniform(0.05, 0.4, 3)), (face, skin)):
            out[mask] = tone
        return out
    stems = (np.abs(v - 0.5 - 0.25 * (u - 0.1) * np.sign(np.sin(v * 20))) < 0.03) & (u < 0.6)
    out[stems] = (0.2, 0.4, 0.15)
    for _ in range(9):
        r = np.hypot(u - rng.uniform(0.45, 0.85), v - rng.uniform(0.2, 0.8))
        out[r < 0.09] = np.clip(ground * 0.5 + rng.uniform(0, 0.5, 3), 0, 1)
        out[r < 0.03] = (0.95, 0.8, 0.2)
    out[(u < 0.3) & (np.abs(v - 0.5) < 0.14)] = ground * 0.6
    return out
