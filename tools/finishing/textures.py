"""The textures of materials: the pigment of a surface at points on it.

A texture is one function with the decorator `texture`; it takes points and a look and returns display colours. Every
feature loses contrast where a point stands for more of the surface than the feature is wide, so nothing flickers, and
a brick wall that is seen through large Gaussians has the mean colour of brick and joints.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...gaussians.world.finishes import FinishName
from .noise import F32, cellular, faded, fractal, gradient_noise, random


@dataclass(frozen=True, eq=False)
class Spots:
    """Points on a surface.

    Attributes:
        xyz: `[N, 3]` metres, in the frame of the thing: two level axes and up.
        plane: `[N, 2]` metres along the surface: across, and up or along.
        normal: `[N, 3]` unit, in the same frame.
        blur: `[N]` standard deviation over which each point stands for the surface, metres.
        grain: which axis of `xyz` a grain runs along.
    """

    xyz: F32
    plane: F32
    normal: F32
    blur: F32
    grain: int


@dataclass(frozen=True)
class Look:
    """How a finish looks this time.

    Attributes:
        color, second: display colours in good neutral light.
        unit: length of the largest repeated unit, metres.
        seed: of what is irregular.
    """

    color: tuple[float, float, float]
    second: tuple[float, float, float]
    unit: float
    seed: int


Floats = NDArray[np.floating]
Texture = Callable[[Spots, Look], F32]
TEXTURES: dict[str, Texture] = {}


def texture(*names: str) -> Callable[[Texture], Texture]:
    """Register the texture of one or more finishes."""

    def keep(made: Texture) -> Texture:
        TEXTURES.update(dict.fromkeys(names, made))
        return made

    return keep


def pigment(finish: FinishName, look: Look, spots: Spots) -> F32:
    """Display colours `[N, 3]` in [0, 1] of a finish, at points."""
    return np.clip(TEXTURES[finish](spots, look), 0.0, 1.0).astype(np.float32)


def _mixed(look: Look, share: Floats, gain: Floats | float = 1.0) -> F32:
    """Between the two colours, `share` `[N]` of the second, times a gain `[N]`."""
    a, b = np.array(look.color, np.float32), np.array(look.second, np.float32)
    gains = np.broadcast_to(np.asarray(gain, np.float32), share.shape)
    return np.asarray((a + (b - a) * np.clip(share, 0, 1)[:, None]) * gains[:, None], dtype=np.float32)


def _toned(look: Look, gain: Floats) -> F32:
    """The first colour times a gain `[N]`."""
    return np.asarray(np.array(look.color, np.float32) * gain[:, None], dtype=np.float32)


def _step(x: Floats, blur: Floats) -> F32:
    """`[N]` 0 below 0 and 1 above, over a blur."""
    return np.asarray(0.5 * (1 + np.tanh(x / np.maximum(1.25 * blur, 1e-6))), dtype=np.float32)


def _gap(x: Floats, period: float, width: float, blur: F32) -> F32:
    """`[N]` share of gaps of a width around every multiple of a period, at positions `[N]`, over a blur."""
    off = np.abs(x - period * np.round(x / period))
    shown = _step(width / 2 - off, blur)
    return np.asarray(width / period + faded(blur, 0.6 * period) * (shown - width / period), dtype=np.float32)


def _columns(*values: NDArray[np.floating]) -> NDArray[np.int32]:
    return np.stack([np.floor(v).astype(np.int32) for v in values], axis=1)


# -- wood -------------------------------------------------------------------------------------------------------------


def _grain(along: F32, across: F32, depth: F32, blur: F32, look: Look, shift: F32) -> F32:
    """`[N]` gain of wood fibres: rings that waver along the grain, and fine pores. `shift` `[N]`: another trunk."""
    warp = np.stack([along * 0.6 + 7 * shift, across * 2.5, depth * 2.5], axis=1).astype(np.float32)
    waver = gradient_noise(warp * 2.2, look.seed) + 0.4 * gradient_noise(warp * 6.0, look.seed + 1)
    width = look.unit / 9
    ring = np.sin(2 * np.pi * ((across + 0.6 * depth) / (2 * width) + 1.6 * waver + 5 * shift))
    fine = np.stack([along * 9, across * 150, depth * 150 + 11 * shift], axis=1).astype(np.float32)
    pores = gradient_noise(fine, look.seed + 2)
    return np.asarray(1 + 0.10 * faded(blur, width) * ring + 0.16 * faded(blur, 0.006) * pores, dtype=np.float32)


@texture("wood")
def _wood(s: Spots, look: Look) -> F32:
    """One piece of wood whose grain runs along the thing's length."""
    others = [axis for axis in range(3) if axis != s.grain]
    along, across, depth = s.xyz[:, s.grain], s.xyz[:, others[0]], s.xyz[:, others[1]]
    tone = fractal(s.xyz * np.where(np.arange(3) == s.grain, 0.25, 1.0).astype(np.float32), 0.2, s.blur, look.seed, 2)
    return _toned(look, _grain(along, across, depth, s.blur, look, np.zeros_like(along)) * (1 + 0.12 * tone))


def _boards(s: Spots, look: Look, length: float) -> F32:
    """Boards side by side, each from another trunk, with dark joints."""
    rising = np.abs(s.normal[:, 2]) < 0.5
    across, along = s.plane[:, 0], s.plane[:, 1]
    if s.grain == 0 and not rising.all():
        across, along = np.where(rising, across, s.plane[:, 1]), np.where(rising, along, s.plane[:, 0])
    row = np.floor(across / look.unit)
    moved = along + length * random(_columns(row, np.zeros_like(row)), look.seed)
    board = random(_columns(row, np.floor(moved / length)), look.seed + 1)
    joint = np.maximum(_gap(across, look.unit, 0.004, s.blur), _gap(moved, length, 0.004, s.blur))
    gain = _grain(moved, across, np.zeros_like(across), s.blur, look, board) * (
        1 + 0.26 * faded(s.blur, look.unit) * (board - 0.5)
    )
    return _mixed(look, 0.85 * joint, gain)


@texture("planks")
def _planks(s: Spots, look: Look) -> F32:
    return _boards(s, look, max(1.2, 8 * look.unit))


@texture("parquet")
def _parquet(s: Spots, look: Look) -> F32:
    """Squares of five short boards, turned by 90 degrees from one square to the next."""
    side = 5 * look.unit
    cell = _columns(s.plane[:, 0] / side, s.plane[:, 1] / side)
    turned = (cell.sum(axis=1) % 2).astype(bool)
    across = np.where(turned, s.plane[:, 1], s.plane[:, 0])
    along = np.where(turned, s.plane[:, 0], s.plane[:, 1])
    row = np.floor(across / look.unit)
    board = random(np.concatenate([cell, row[:, None].astype(np.int32)], axis=1), look.seed)
    joint = np.maximum(_gap(across, look.unit, 0.002, s.blur), _gap(along, side, 0.002, s.blur))
    gain = _grain(along, across, np.zeros_like(across), s.blur, look, board)
    return _mixed(look, 0.8 * joint, gain * (1 + 0.22 * faded(s.blur, look.unit) * (board - 0.5)))


# -- stone ------------------------------------------------------------------------------------------------------------


@texture("marble")
def _marble(s: Spots, look: Look) -> F32:
    """A pale body with clouds, and veins of two widths that waver and fade."""
    warp = np.stack([fractal(s.xyz, look.unit, s.blur, look.seed + 10 * k, 4) for k in range(3)], axis=1)
    bent = ((s.xyz + 0.55 * look.unit * warp) / look.unit).astype(np.float32)
    large = np.abs(gradient_noise(bent * 0.9, look.seed + 40))
    small = np.abs(gradient_noise(bent * 2.3 + 5, look.seed + 41))
    strength = np.clip(0.55 + 0.9 * gradient_noise(bent * 0.7 + 9, look.seed + 42), 0, 1)
    veins = 0.85 * strength * np.exp(-((large / 0.045) ** 2)) + 0.35 * np.exp(-((small / 0.05) ** 2)) * strength
    cloud = 0.16 * np.clip(0.5 + warp[:, 0], 0, 1)
    return _mixed(look, veins * faded(s.blur, 0.08 * look.unit) + 0.06 * (1 - faded(s.blur, 0.08 * look.unit)) + cloud)


@texture("granite")
def _granite(s: Spots, look: Look) -> F32:
    """Crystals of three tones."""
    cells = cellular(s.xyz, look.unit * 0.5, look.seed)
    shown = faded(s.blur, look.unit * 0.5)
    tone = np.where(cells.chance < 0.25, -0.55, np.where(cells.chance < 0.6, 0.0, 0.28))
    return _toned(look, np.asarray(1 + shown * (tone + 0.04), np.float32))


@texture("slate")
def _slate(s: Spots, look: Look) -> F32:
    layers = s.xyz * np.array([1.0, 1.0, 3.0], np.float32)
    return _toned(look, 1 + 0.3 * fractal(layers, look.unit, s.blur, look.seed, 5))


def _courses(s: Spots, look: Look, height: float, joint: float) -> tuple[F32, NDArray[np.int32]]:
    """Share of joints `[N]` of a wall in stretcher bond, and the brick `[N, 2]` of each point."""
    row = np.floor(s.plane[:, 1] / height)
    along = s.plane[:, 0] + np.where(row % 2 == 1, look.unit / 2, 0.0).astype(np.float32)
    # Joints lie in the middle of their gap, on the multiples of the unit and of the height.
    gaps = np.maximum(_gap(along, look.unit, joint, s.blur), _gap(s.plane[:, 1], height, joint, s.blur))
    return gaps, _columns(along / look.unit, row)


@texture("brick")
def _brick(s: Spots, look: Look) -> F32:
    """Stretcher bond: each brick of its own shade, rough, with pale joints."""
    gaps, brick = _courses(s, look, look.unit / 3, 0.05 * look.unit)
    own = faded(s.blur, 0.5 * look.unit) * (random(brick, look.seed) - 0.5)
    warm = faded(s.blur, 0.5 * look.unit) * (random(brick, look.seed + 1) - 0.5)
    rough = fractal(s.xyz, 0.03, s.blur, look.seed + 2, 3)
    body = _toned(look, 1 + 0.42 * own + 0.16 * rough)
    body *= (1 + 0.12 * warm[:, None] * np.array([1.0, 0.0, -1.0])).astype(np.float32)
    mortar = _mixed(look, np.ones(len(gaps), np.float32), 1 + 0.12 * fractal(s.xyz, 0.02, s.blur, look.seed + 5, 2))
    return np.asarray(body + gaps[:, None] * (mortar - body), dtype=np.float32)


@texture("stone")
def _stone(s: Spots, look: Look) -> F32:
    """Dressed blocks in courses, rough, each of its own shade."""
    waver = 0.02 * gradient_noise(s.xyz * 6, look.seed + 7)
    bent = Spots(s.xyz, s.plane + waver[:, None], s.normal, s.blur, s.grain)
    gaps, block = _courses(bent, look, look.unit * 0.55, 0.04 * look.unit)
    own = faded(s.blur, 0.5 * look.unit) * (random(block, look.seed) - 0.5)
    rough = fractal(s.xyz, 0.12, s.blur, look.seed + 2, 5)
    return _mixed(look, gaps, 1 + 0.3 * own + 0.28 * rough)


@texture("tiles")
def _tiles(s: Spots, look: Look) -> F32:
    """Square glazed tiles with thin joints, each of nearly the same shade."""
    width = min(0.004, 0.04 * look.unit)
    gaps = np.maximum(*(_gap(s.plane[:, k], look.unit, width, s.blur) for k in (0, 1)))
    tile = _columns(s.plane[:, 0] / look.unit, s.plane[:, 1] / look.unit)
    own = faded(s.blur, 0.5 * look.unit) * (random(tile, look.seed) - 0.5)
    cloud = fractal(s.xyz, 0.5 * look.unit, s.blur, look.seed + 2, 2)
    return _mixed(look, gaps, 1 + 0.05 * own + 0.03 * cloud)


@texture("concrete")
def _concrete(s: Spots, look: Look) -> F32:
    """Blotches, fine grit and pores."""
    blotch = fractal(s.xyz, look.unit, s.blur, look.seed, 5)
    pores = cellular(s.xyz, 0.05, look.seed + 9)
    pit = faded(s.blur, 0.02) * _step(pores.edge - 0.75, s.blur / 0.05) * (pores.chance < 0.5)
    return _mixed(look, 0.5 + blotch, 1 + 0.07 * fractal(s.xyz, 0.012, s.blur, look.seed + 3, 2) - 0.25 * pit)


@texture("plaster", "terracotta", "sand")
def _plaster(s: Spots, look: Look) -> F32:
    """Soft clouds and a fine roughness."""
    cloud = fractal(s.xyz, look.unit, s.blur, look.seed, 4)
    return _mixed(look, 0.45 + 0.8 * cloud, 1 + 0.05 * fractal(s.xyz, 0.015, s.blur, look.seed + 3, 2))


# -- what is soft -----------------------------------------------------------------------------------------------------


@texture("fabric")
def _fabric(s: Spots, look: Look) -> F32:
    """A plain weave: threads that go over and under each other, and an uneven dye."""
    u, v = s.plane[:, 0] / look.unit, s.plane[:, 1] / look.unit
    over = np.sign(np.sin(2 * np.pi * u) * np.sin(2 * np.pi * v))
    thread = np.abs(np.where(over > 0, np.sin(2 * np.pi * u), np.sin(2 * np.pi * v)))
    slub = np.where(over > 0, gradient_noise(_stretched(s.plane, 20, 120), look.seed),
                    gradient_noise(_stretched(s.plane, 120, 20), look.seed + 1))  # fmt: skip
    woven = 0.30 * (thread - 0.64) + 0.07 * over + 0.25 * slub
    dye = fractal(s.xyz, 0.12, s.blur, look.seed + 2, 3)
    return _toned(look, 1 + faded(s.blur, 0.7 * look.unit) * woven.astype(np.float32) + 0.07 * dye)


def _stretched(plane: F32, across: float, along: float) -> F32:
    flat = plane * np.array([across, along], np.float32)
    return np.concatenate([flat, np.zeros((len(flat), 1), np.float32)], axis=1)


@texture("velvet")
def _velvet(s: Spots, look: Look) -> F32:
    """Pile that was stroked one way and the other."""
    stroke = fractal(s.xyz, look.unit, s.blur, look.seed, 3)
    pile = gradient_noise(s.xyz * 160, look.seed + 4) * faded(s.blur, 0.006)
    return _toned(look, 1 + 0.30 * np.tanh(2.5 * stroke) + 0.12 * pile)


@texture("leather")
def _leather(s: Spots, look: Look) -> F32:
    """A grain of small cells with creases between them, and wear."""
    cells = cellular(s.xyz, look.unit * 0.6, look.seed)
    crease = faded(s.blur, 0.5 * look.unit) * (1 - _step(cells.edge - 0.12, s.blur / look.unit))
    wear = fractal(s.xyz, 0.25, s.blur, look.seed + 5, 4)
    share = 0.8 * crease + 0.25 * (1 - faded(s.blur, 0.5 * look.unit))
    return _mixed(look, share, 1 + 0.18 * wear + 0.06 * (cells.chance - 0.5) * faded(s.blur, look.unit))


@texture("fur", "carpet", "grass")
def _fibres(s: Spots, look: Look) -> F32:
    """Short fibres in tufts, between two shades."""
    tuft = fractal(s.xyz, 4 * look.unit, s.blur, look.seed, 4)
    fibre = gradient_noise(s.xyz * np.array([2.0, 2.0, 0.8], np.float32) / (0.4 * look.unit), look.seed + 6)
    return _mixed(look, 0.5 + 0.7 * tuft + 0.9 * fibre * faded(s.blur, 0.3 * look.unit), 1 + 0.18 * tuft)


@texture("wicker")
def _wicker(s: Spots, look: Look) -> F32:
    """Canes that go over and under each other."""
    u, v = s.plane[:, 0] / look.unit, s.plane[:, 1] / look.unit
    over = (np.floor(u) + np.floor(v)) % 2
    bulge = np.abs(np.sin(np.pi * np.where(over > 0, u, v)) * np.sin(np.pi * u) * np.sin(np.pi * v))
    return _mixed(look, 0.42 + faded(s.blur, 0.6 * look.unit) * (0.5 - 1.1 * bulge - 0.06 * over).astype(np.float32))


# -- metal and glaze --------------------------------------------------------------------------------------------------


@texture("metal", "gold", "copper")
def _metal(s: Spots, look: Look) -> F32:
    """Brushed metal: streaks, and bands that depend on the normal as the reflections of a room do."""
    streak = gradient_noise(_stretched(s.plane, 3 / look.unit * 0.1, 14 / look.unit), look.seed)
    sky = 0.28 * (s.normal[:, 2] - 0.2) + 0.16 * np.sin(5.5 * s.normal[:, 0] + 3.5 * s.normal[:, 1] + 1.0)
    return _toned(look, np.asarray(1 + 0.10 * streak * faded(s.blur, 0.1 * look.unit) + sky, np.float32))


@texture("gravel")
def _gravel(s: Spots, look: Look) -> F32:
    """Pebbles of several greys with dark gaps."""
    cells = cellular(s.xyz, look.unit, look.seed)
    shown = faded(s.blur, 0.6 * look.unit)
    gap = shown * (1 - _step(cells.edge - 0.12, s.blur / look.unit))
    return _mixed(look, gap + 0.36 * (1 - shown), 1 + 0.5 * shown * (cells.chance - 0.5))


_CHIPS = 0.21  # share of chips of a terrazzo


@texture("terrazzo")
def _terrazzo(s: Spots, look: Look) -> F32:
    """Chips of stone of four tones in a pale cement."""
    chips = cellular(s.xyz, look.unit, look.seed)
    shown = faded(s.blur, 0.5 * look.unit)
    covered = _step(chips.edge - 0.22, s.blur / look.unit) * (chips.chance < 0.62)
    inside = _CHIPS + shown * (covered - _CHIPS)
    tones = np.array([[0.62, 0.33, 0.24], [0.30, 0.31, 0.33], [0.93, 0.91, 0.87], [0.66, 0.57, 0.42]], np.float32)
    own = tones[np.minimum((chips.chance / 0.155).astype(np.int64), 3)]
    chip = tones.mean(axis=0) + shown[:, None] * (own - tones.mean(axis=0))
    body = _toned(look, 1 + 0.05 * fractal(s.xyz, 0.02, s.blur, look.seed + 3, 2))
    return np.asarray(body + inside[:, None] * (chip - body), dtype=np.float32)


@texture("plastic", "porcelain", "glass")
def _plain(s: Spots, look: Look) -> F32:
    """One even pigment."""
    return _toned(look, np.ones(len(s.xyz), np.float32))


# -- patterns of two colours ------------------------------------------------------------------------------------------


@texture("stripes")
def _stripes(s: Spots, look: Look) -> F32:
    """Upright stripes on what stands, stripes along the length on what lies, half and half."""
    across = np.where(np.abs(s.normal[:, 2]) > 0.7, s.plane[:, 1 if s.grain == 0 else 0], s.plane[:, 0])
    return _mixed(look, _gap(across.astype(np.float32), look.unit, 0.5 * look.unit, s.blur))


@texture("checks")
def _checks(s: Spots, look: Look) -> F32:
    """A chequerboard: the unit is the side of two squares."""
    u, v = (2 * _gap(s.plane[:, k], look.unit, 0.5 * look.unit, s.blur) - 1 for k in (0, 1))
    return _mixed(look, np.asarray(0.5 + 0.5 * u * v, np.float32))


@texture("dots")
def _dots(s: Spots, look: Look) -> F32:
    """Dots in rows that are shifted by half a unit."""
    p = s.plane / np.float32(look.unit)
    row = np.floor(p[:, 1])
    across = p[:, 0] + 0.5 * (row % 2)
    off = np.stack([across - np.floor(across) - 0.5, p[:, 1] - row - 0.5], axis=1)
    inside = _step((0.29 - np.linalg.norm(off, axis=1)).astype(np.float32), s.blur / look.unit)
    return _mixed(look, np.asarray(0.26 + faded(s.blur, 0.6 * look.unit) * (inside - 0.26), np.float32))


def _motif(s: Spots, look: Look) -> tuple[F32, F32, NDArray[np.int32], F32]:
    """Places in cells of half the unit, whose rows are shifted by half a cell: radius and angle about the middle, the
    cell, and a blur in cells."""
    p = s.plane / np.float32(0.5 * look.unit)
    row = np.floor(p[:, 1])
    across = p[:, 0] + 0.5 * (row % 2)
    cell = _columns(across, row)
    off = np.stack([across - np.floor(across) - 0.5, p[:, 1] - row - 0.5], axis=1).astype(np.float32)
    radius = np.linalg.norm(off, axis=1).astype(np.float32)
    angle = np.arctan2(off[:, 1], off[:, 0]).astype(np.float32)
    return radius, angle, cell, (s.blur / np.float32(0.5 * look.unit)).astype(np.float32)


# Shares of leaves (of the ground), petals (of both) and hearts (of all) in a floral pattern.
_FLOWERS = (0.19, 0.14, 0.015)


@texture("floral")
def _floral(s: Spots, look: Look) -> F32:
    """Flowers of five petals with leaves, each turned its own way, in rows that are shifted."""
    radius, angle, cell, blur = _motif(s, look)
    turn = 2 * np.pi * random(cell, look.seed)
    shown = faded(s.blur, 0.3 * look.unit)[:, None]
    petals = _step(0.20 + 0.09 * np.cos(5 * (angle + turn)) - radius, blur)
    middle = _step(0.07 - radius, blur)
    lobes = np.cos(3 * (angle - turn))
    leaves = _step(0.36 + 0.10 * lobes - radius, blur) * _step(lobes - 0.55, blur)
    a, b = np.array(look.color, np.float32), np.array(look.second, np.float32)
    green = (0.45 * b + 0.55 * np.array([0.33, 0.46, 0.29], np.float32)).astype(np.float32)
    heart = (0.5 * b + 0.5 * a).astype(np.float32)
    out = np.broadcast_to(a, (len(radius), 3)).astype(np.float32)
    even = a
    for share, mean, ink in zip((leaves, petals, middle), _FLOWERS, (green, b, heart), strict=True):
        out = out + share[:, None] * (ink - out)
        even = even + mean * (ink - even)
    return np.asarray(even + shown * (out - even), dtype=np.float32)


@texture("ornament")
def _ornament(s: Spots, look: Look) -> F32:
    """Rosettes in diamonds with fine borders, as on carpets and damask."""
    u, v = (2 * np.pi * s.plane[:, k] / look.unit for k in (0, 1))
    blur = s.blur / np.float32(look.unit)
    lattice = np.cos(u) + np.cos(v)
    rosette = np.cos(2 * u) * np.cos(2 * v) + 0.5 * np.cos(3 * (u + v)) * np.cos(3 * (u - v))
    border = _step(0.22 - np.abs(lattice), 6 * blur)
    inner = _step((rosette - 0.35).astype(np.float32), 8 * blur) * _step(
        (np.abs(lattice) - 0.5).astype(np.float32), 6 * blur
    )
    share = 0.33 + faded(s.blur, 0.3 * look.unit) * (np.maximum(border, inner) - 0.33)
    return _mixed(look, np.asarray(share, np.float32))


@texture("stars")
def _stars(s: Spots, look: Look) -> F32:
    """Five-pointed stars in rows that are shifted, each turned its own way."""
    radius, angle, cell, blur = _motif(s, look)
    turned = (angle + 2 * np.pi * random(cell, look.seed)) % (0.4 * np.pi) - 0.2 * np.pi
    edge = 0.11 / np.maximum(np.cos(np.abs(turned)) - 0.62 * (0.2 * np.pi - np.abs(turned)) * 1.59, 0.25)
    inside = _step((np.minimum(edge, 0.3) - radius).astype(np.float32), blur)
    return _mixed(look, np.asarray(0.12 + faded(s.blur, 0.3 * look.unit) * (inside - 0.12), np.float32))
