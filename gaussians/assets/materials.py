"""What pieces are made of: colours, surface patterns, and the palette a design draws from.

Knows how a colour varies over a surface. Refuses to know geometry beyond sample positions, and light.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from .. import color as colors
from ..color import Rgb

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Material:
    """Colour and pattern of a surface.

    Attributes:
        color: display RGB in [0, 1].
        pattern: a key of `PATTERNS`.
        second: the other colour of a two-coloured pattern.
        scale: period or feature size, metres.
        axis: 0, 1, 2: along which axis a directed pattern runs.
        seed: phase of its irregularities.
        main: whether it carries the colour the object is named by.
    """

    color: Rgb
    pattern: str = "plain"
    second: Rgb = (1.0, 1.0, 1.0)
    scale: float = 0.1
    axis: int = 0
    seed: int = 0
    main: bool = False

    def along(self, axis: int) -> Self:
        """The same material running along another axis."""
        return replace(self, axis=axis)

    def shaded(self, factor: float) -> Self:
        """A darker (< 1) or lighter (> 1) version."""
        return replace(self, color=shade(self.color, factor), second=shade(self.second, factor))


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


def shade(rgb: Rgb, factor: float) -> Rgb:
    """Scale towards black (< 1), or mix towards white by `factor - 1` (> 1)."""
    if factor <= 1:
        return (rgb[0] * factor, rgb[1] * factor, rgb[2] * factor)
    t = min(factor - 1, 1.0)
    return (rgb[0] + (1 - rgb[0]) * t, rgb[1] + (1 - rgb[1]) * t, rgb[2] + (1 - rgb[2]) * t)


def mix(a: Rgb, b: Rgb, t: float) -> Rgb:
    """`a` at 0, `b` at 1."""
    return (a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t)


# --- patterns --------------------------------------------------------------------------------------------------------

Pattern = Callable[[Surface, Material], Array]
PATTERNS: dict[str, Pattern] = {}


def pattern(name: str) -> Callable[[Pattern], Pattern]:
    """Register a pattern: samples and material to RGB `[N, 3]`."""

    def keep(fn: Pattern) -> Pattern:
        PATTERNS[name] = fn
        return fn

    return keep


# Patterns whose colour changes within centimetres deserve denser samples.
FINE = {"stripes": 1.3, "checks": 1.35, "dots": 1.4, "leaves": 1.3, "picture": 1.5, "screen": 1.3, "wicker": 1.25,
        "clock": 1.6, "rug": 1.4, "keys": 1.5, "wood": 1.1}  # fmt: skip


def paint(surface: Surface, material: Material) -> Array:
    """RGB `[N, 3]` of the samples."""
    return np.clip(PATTERNS[material.pattern](surface, material), 0.0, 1.0)


def _noise(x: Array, seed: int, octaves: int = 3) -> Array:
    """Smooth values about 0, roughly in [-1, 1], from positions `[N, D]` in feature sizes: a few plane waves."""
    rng = np.random.default_rng(seed)
    out = np.zeros(len(x))
    for o in range(octaves):
        for _ in range(3):
            k = rng.normal(size=x.shape[1])
            k *= 2.0**o * 3.0 / np.linalg.norm(k)
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
    """Boards side by side, each its own shade, with a wavy grain along the axis."""
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
    """Metal: bright bands by the direction a surface faces, as if reflecting a room."""
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
    """Floor boards along x: each its own shade, thin dark joints, a little grain."""
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
    """What is seen through a window: sky above, far trees below."""
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
    """A dial about its own centre in the x, z plane: twelve marks and two hands."""
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


# --- palettes --------------------------------------------------------------------------------------------------------

WOODS = ("#b5894f", "#8a5a33", "#5d432c", "#d8b27c", "#6e3b22", "#a8743f", "#c79a63", "#42301f")
METALS = ("#b9bcc0", "#8f9398", "#3a3b3e", "#c0a062", "#a8643c", "#d7d9db")
PALETTES: dict[str, tuple[str, ...]] = {
    # two or three shades of each basic colour term, so that colour words can be learnt and measured
    "any": ("#c8201e", "#a61c28", "#f07c1c", "#e06a2a", "#f2d31b", "#e3bc2e", "#3c9a3f", "#2f7d46", "#6fae4a", "#128080",
            "#2a9a94", "#2a5ac8", "#3f79c9", "#1f3f8f", "#7d3fa6", "#6a3a8c", "#f08fb4", "#e87aa4", "#7a4a26", "#d9c4a0",
            "#202024", "#808080", "#6c7076", "#f2f2f2", "#e8e6e0"),
    "fabric": ("#c8201e", "#8f2430", "#e07b30", "#e3bc2e", "#3c7a4a", "#5f8f5a", "#128080", "#2a5ac8", "#33508a", "#6f8fb8",
               "#7d3fa6", "#e58fae", "#7a4a26", "#d9c4a0", "#c9b48f", "#2a2a2e", "#808080", "#5e6166", "#ece8df"),
    "wood": (*WOODS, *WOODS[:4], "#ece9e2", "#2a2826", "#4d6a8a", "#5d7d60", "#8d8f92"),
    "appliance": ("#f0f0ee", "#e6e6e4", "#b9bcc0", "#2a2b2e", "#b02a2a", "#9fc9c2", "#e8d9b0", "#4a6fa5"),
    "dark": ("#1d1e21", "#26272b", "#3a3b3f", "#8f9398", "#c9cbce", "#ededeb"),
    "leaf": ("#2f7d32", "#3f9142", "#5a9a3a", "#2c6b45", "#76a843"),
    "light": ("#f2f0ea", "#efe3c8", "#e8d5a8", "#f2e9d5", "#d96f4a", "#4f9a9a", "#c8b48a", "#e2b93b", "#7a9ac2"),
}  # fmt: skip


class Tone:
    """The colours of one design: the main one, as asked for or drawn from the kind's palette, and companions."""

    def __init__(self, rng: np.random.Generator, palette: str, wanted: Rgb | None = None) -> None:
        self.rng = rng
        drawn = _jitter(rng, _pick(rng, PALETTES[palette]))  # drawn even if not used: the design stays the same
        wooden = palette == "wood" and (_is_brown(wanted) if wanted else _is_brown(drawn))
        self.color: Rgb = wanted if wanted is not None else drawn
        self.asked = wanted is not None
        self.wooden = wooden
        self.seed = int(rng.integers(1 << 30))
        self.second: Rgb = self._companion()

    def _companion(self) -> Rgb:
        """A second colour that stays apart from the main one without taking over its name."""
        light = 0.3 * self.color[0] + 0.59 * self.color[1] + 0.11 * self.color[2]
        if self.rng.random() < 0.6:
            return mix(self.color, (0.97, 0.96, 0.93), 0.75) if light < 0.6 else shade(self.color, 0.55)
        return mix(self.color, (0.08, 0.08, 0.1), 0.6) if light > 0.35 else mix(self.color, (1, 1, 1), 0.55)

    @property
    def main(self) -> Material:
        """Main colour on hard surfaces: wood grain where it is a wood colour, plain paint otherwise."""
        return Material(self.color, "wood" if self.wooden else "plain", self.second, seed=self.seed, main=True)

    def textile(self, scale: float = 0.08, plain: float = 0.55) -> Material:
        """Main colour on cloth: plain or woven with probability `plain`, else stripes, checks, dots or leaves."""
        kind = str(self.rng.choice(["stripes", "checks", "dots", "leaves"]))
        chosen = str(self.rng.choice(["plain", "weave"])) if self.rng.random() < plain else kind
        size = float(scale * self.rng.uniform(0.8, 1.6))
        second = mix(self.color, self.second, 0.8)
        return Material(self.color, chosen, second, size, int(self.rng.integers(0, 2)), self.seed, True)

    def glazed(self, scale: float = 0.03) -> Material:
        """Main colour on pottery: plain, banded, or dotted."""
        chosen = str(self.rng.choice(["plain", "plain", "stripes", "dots", "marble"]))
        return Material(self.color, chosen, mix(self.color, self.second, 0.8), scale, 2, self.seed, True)

    def wood(self) -> Material:
        """Some wood, for legs and frames."""
        return Material(_jitter(self.rng, _pick(self.rng, WOODS)), "wood", seed=self.seed + 1, axis=2)

    def metal(self) -> Material:
        """Some metal: steel, black, brass or copper."""
        return Material(_pick(self.rng, METALS), "brushed", seed=self.seed)

    def accent(self) -> Material:
        """Another colour altogether, for books, cushions and trims."""
        return Material(_jitter(self.rng, _pick(self.rng, PALETTES["any"])), seed=int(self.rng.integers(1 << 20)))

    def frame(self) -> Material:
        """Wood or metal."""
        return self.wood() if self.rng.random() < 0.6 else self.metal()

    @staticmethod
    def plain(text: str, name: str = "plain", **options: float | int | str | Rgb) -> Material:
        """A fixed colour."""
        return Material(colors.parse(text), name, **options)  # type: ignore[arg-type]


def _pick(rng: np.random.Generator, table: tuple[str, ...]) -> Rgb:
    return colors.parse(table[int(rng.integers(len(table)))])


def _jitter(rng: np.random.Generator, rgb: Rgb) -> Rgb:
    gain = rng.uniform(0.9, 1.08)
    r, g, b = (float(np.clip(c * gain + rng.normal(0, 0.012), 0.02, 0.98)) for c in rgb)
    return (r, g, b)


def _is_brown(rgb: Rgb) -> bool:
    r, g, b = rgb
    return r > 1.12 * g > 1.12 * b and r - b > 0.08
