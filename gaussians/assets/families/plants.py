"""Builders of plants, flowers, pots and vases. Each builder returns the pieces of one design."""

from __future__ import annotations

import numpy as np

from ..modeling.materials import Material, Tone, shade
from ..modeling.parts import Rng, chance
from ..modeling.round_shapes import ball, blob, cylinder, disc, lathe, rod, tube
from ..modeling.shapes import Piece, box, join, leaf
from ..registry import kind


def _pot(rng: Rng, r: float, h: float, mat: Material) -> list[Piece]:
    """A pot of one of four shapes, with soil."""
    style = int(rng.integers(4))
    soil = disc(r * 0.9, (0, 0, h * 0.9)).named("soil", Material((0.22, 0.15, 0.1)))
    if style == 0:
        wall = lathe(
            [
                (0, 0),
                (r * 0.7, 0),
                (r * 0.95, h * 0.82),
                (r * 1.05, h * 0.82),
                (r * 1.05, h),
                (r * 0.9, h),
                (r * 0.88, h * 0.85),
            ]
        )
    elif style == 1:
        wall = lathe([(0, 0), (r * 0.98, 0), (r, h), (r * 0.92, h), (r * 0.9, h * 0.85)])
    elif style == 2:
        wall = lathe([(0, 0), (r * 0.6, 0), (r * 1.1, h * 0.5), (r * 0.92, h), (r * 0.86, h * 0.88)], smooth=15)
    else:
        s = 1.75 * r
        walls = [box(s, 0.02, h, (0, k * (s / 2 - 0.01), 0)) for k in (-1, 1)] + [
            box(0.02, s, h, (k * (s / 2 - 0.01), 0, 0)) for k in (-1, 1)
        ]
        return [
            join(*walls, box(s - 0.02, s - 0.02, 0.02)).named("pot", mat),
            box(s - 0.03, s - 0.03, 0.02, (0, 0, h * 0.86)).named("soil", soil.material or mat),
        ]
    return [wall.named("pot", mat), soil]


def _leaves(rng: Rng, count: int, length: float, width: float, z: float, rise: float, bend: float) -> Piece:
    """Leaves around (0, 0, z) at multiples of the golden angle, the first ones flatter."""
    out = []
    for k in range(count):
        t = k / max(count - 1, 1)
        size = length * rng.uniform(0.75, 1.1)
        one = leaf(size, width * rng.uniform(0.8, 1.2), bend * rng.uniform(0.7, 1.3), rise * (0.4 + 1.1 * t))
        out.append(one.turned("z", 137.5 * k + rng.uniform(-12, 12)).moved(0, 0, z))
    return join(*out)


def _crown(rng: Rng, count: int, r: float, at: tuple[float, float, float], length: float, width: float) -> Piece:
    """Leaves that point outward all over a sphere of radius `r` around `at`."""
    out = []
    for k in range(count):
        z = 1 - 2 * (k + 0.5) / count
        a, e = 137.5 * k, np.degrees(np.arcsin(z))
        rad = r * rng.uniform(0.55, 1.0)
        ca = np.radians(a)
        c = np.cos(np.radians(e))
        where = (at[0] + rad * c * np.cos(ca), at[1] + rad * c * np.sin(ca), at[2] + rad * z)
        one = leaf(length * rng.uniform(0.8, 1.2), width, 0.35, 0.3).turned("y", -0.6 * e)
        out.append(one.turned("z", a).moved(*where))
    return join(*out)


@kind("potted plant", palette="leaf")
def potted_plant(rng: Rng, tone: Tone) -> list[Piece]:
    style, green = int(rng.integers(7)), Material(tone.color, seed=tone.seed, main=True)
    big = chance(rng, 0.6)
    r, h = (
        (rng.uniform(0.14, 0.2), rng.uniform(0.22, 0.34)) if big else (rng.uniform(0.08, 0.12), rng.uniform(0.12, 0.18))
    )
    s = r / 0.15
    clay = tone.plain("#b5623c") if chance(rng, 0.3) else tone.accent()
    out, top = _pot(rng, r, h, clay), h * 0.9
    stem = Material((0.36, 0.28, 0.16), seed=1)
    if style == 0:  # broad leaves from the soil
        out.append(_leaves(rng, 18, 0.45 * s, 0.13 * s, top, 1.1, 0.9).named("leaf", green))
    elif style == 1:  # sword leaves, upright
        out.append(
            _leaves(rng, 14, 0.16 * s, 0.06 * s, 0, 4.2, 0.1).stretched(1, 1, 1).moved(0, 0, top).named("leaf", green)
        )
    elif style == 2:  # palm: fronds on a trunk
        trunk = rng.uniform(0.3, 0.6) * s
        out += [
            tube([(0, 0, top), (0.02, 0, top + trunk / 2), (0, 0.02, top + trunk)], 0.02 * s, smooth=9).named(
                "trunk", stem
            ),
            _leaves(rng, 24, 0.5 * s, 0.06 * s, top + trunk, 1.0, 1.2).named("leaf", green),
        ]
    elif style == 3:  # little tree
        trunk = rng.uniform(0.35, 0.7) * s
        out += [
            rod((0, 0, top), (0, 0, top + trunk), 0.016 * s).named("trunk", stem),
            _crown(rng, 70, 0.22 * s, (0, 0, top + trunk + 0.12 * s), 0.13 * s, 0.07 * s).named("leaf", green),
        ]
    elif style == 4:  # cactus
        tall = rng.uniform(0.25, 0.5) * s
        out += [blob(0.16 * s, 0.16 * s, tall * 1.1, (0, 0, top + tall / 2), 1.0, 0.6).named("stem", green)]
        for k in (-1, 1)[: int(rng.integers(0, 3))]:
            arm = [
                (k * 0.05 * s, 0, top + tall * 0.45),
                (k * 0.14 * s, 0, top + tall * 0.5),
                (k * 0.15 * s, 0, top + tall * 0.85),
            ]
            out.append(tube(arm, 0.035 * s, smooth=9).named("stem", green))
        if chance(rng, 0.4):
            out.append(ball(0.03 * s, (0, 0, top + tall * 1.06)).named("flower", tone.plain("#e8559a")))
    elif style == 5:  # bush with round leaves
        out.append(_crown(rng, 85, 0.24 * s, (0, 0, top + 0.16 * s), 0.12 * s, 0.09 * s).named("leaf", green))
    else:  # rubber plant: leaves along stems
        for j in range(3):
            a, tall = 120 * j + 20, rng.uniform(0.45, 0.8) * s
            lean = 0.08 * s
            tip = (lean * np.cos(np.radians(a)), lean * np.sin(np.radians(a)), top + tall)
            out.append(rod((0, 0, top), tip, 0.01 * s).named("trunk", stem))
            for k in range(7):
                t = 0.25 + 0.75 * k / 6
                one = (
                    leaf(0.2 * s, 0.1 * s, 0.5, 0.6)
                    .turned("z", 137.5 * (k + 3 * j))
                    .moved(tip[0] * t, tip[1] * t, top + tall * t)
                )
                out.append(one.named("leaf", green))
    return out


@kind("flowers")
def flowers(rng: Rng, tone: Tone) -> list[Piece]:
    h, n = rng.uniform(0.14, 0.2), int(rng.integers(5, 12))
    green, bloom = Material((0.2, 0.45, 0.2)), tone.main
    glass = tone.plain(str(rng.choice(["#dfe9ec", "#f2efe8", "#2f4a6d", "#c9a27a"])))
    out = [lathe([(0, 0), (0.035, 0), (0.05, h * 0.4), (0.028, h * 0.8), (0.04, h)], smooth=15).named("vase", glass)]
    stems, petals, hearts = [], [], []
    tulip = chance(rng, 0.5)
    for k in range(n):
        a, lean = 137.5 * k, 0.1 * np.sqrt((k + 0.5) / n)
        tip = (lean * np.cos(np.radians(a)), lean * np.sin(np.radians(a)), h + rng.uniform(0.1, 0.2))
        stems.append(rod((tip[0] * 0.15, tip[1] * 0.15, h * 0.7), tip, 0.003))
        if tulip:
            petals.append(blob(0.045, 0.045, 0.065, (tip[0], tip[1], tip[2] + 0.02), 1.0, 0.8))
        else:
            for j in range(6):
                petals.append(leaf(0.042, 0.03, 0.5, 0.35).turned("z", 60 * j + a).moved(*tip))
            hearts.append(ball(0.012, (tip[0], tip[1], tip[2] + 0.004)))
    greens = [leaf(0.13, 0.035, 0.5, 1.4).turned("z", 100 * k + 20).moved(0, 0, h * 0.9) for k in range(4)]
    out += [
        join(*stems).named("stem", green),
        join(*greens).named("leaf", green),
        join(*petals).named("petal", bloom, 1.5),
    ]
    if hearts:
        out.append(join(*hearts).named("heart", Material((0.95, 0.78, 0.2))))
    return out


@kind("vase")
def vase(rng: Rng, tone: Tone) -> list[Piece]:
    h, style, mat = rng.uniform(0.2, 0.42), int(rng.integers(6)), tone.glazed(rng.uniform(0.04, 0.1))
    r = h * rng.uniform(0.2, 0.32)
    profiles = [
        [(0, 0), (r * 0.6, 0), (r, h * 0.4), (r * 0.35, h * 0.8), (r * 0.55, h)],
        [(0, 0), (r * 0.45, 0), (r * 0.95, h * 0.7), (r * 0.5, h * 0.92), (r * 0.6, h)],
        [(0, 0), (r, h * 0.02), (r * 1.1, h * 0.3), (r * 0.18, h * 0.55), (r * 0.16, h)],
        [(0, 0), (r * 0.7, 0), (r * 0.6, h * 0.5), (r * 0.9, h)],
        [(0, 0), (r * 0.7, 0), (r * 0.72, h * 0.96), (r * 0.68, h)],
        [
            (0, 0),
            (r * 0.5, 0),
            (r * 0.8, h * 0.18),
            (r * 0.5, h * 0.4),
            (r * 0.85, h * 0.65),
            (r * 0.35, h * 0.88),
            (r * 0.5, h),
        ],
    ]
    outer = profiles[style]
    rim = outer[-1][0]
    inner = [(rim * 0.93, h), (rim * 0.8, h * 0.9), (0, h * 0.75)]
    out = [lathe(outer, smooth=23).named("body", mat), lathe(inner).named("inside", Material(shade(tone.color, 0.4)))]
    if chance(rng, 0.25):
        for s in (-1, 1):
            ear = [(s * r * 0.4, 0, h * 0.85), (s * r * 1.15, 0, h * 0.82), (s * r * 0.9, 0, h * 0.5)]
            out.append(tube(ear, h * 0.02, smooth=11).named("handle", mat))
    return out


@kind("flower pot")
def flower_pot(rng: Rng, tone: Tone) -> list[Piece]:
    r, h = rng.uniform(0.1, 0.18), rng.uniform(0.14, 0.3)
    out = _pot(rng, r, h, tone.glazed(0.05))
    if chance(rng, 0.5):
        out = [p.moved(0, 0, 0.012) for p in out] + [
            cylinder(r * 1.1, 0.015, top=r * 1.2).named("saucer", tone.main.shaded(0.8))
        ]
    return out
