"""Builders of crockery, pots and food. Each builder returns the pieces of one design."""

from __future__ import annotations

import numpy as np

from ..modeling.materials import Material, Tone, mix
from ..modeling.parts import Rng, around, chance, polar
from ..modeling.round_shapes import ball, blob, cylinder, disc, lathe, ring, rod, tube
from ..modeling.shapes import Piece, join, leaf
from ..registry import kind


def _vessel(
    outer: list[tuple[float, float]], thick: float, mat: Material, inside: Material, smooth: int = 17
) -> list[Piece]:
    """A hollow vessel of revolution with the outer profile `outer` (bottom to rim) and a rounded rim."""
    inner = [*((max(r - thick, 0.0), max(z, thick)) for r, z in outer[:0:-1]), (0.0, outer[0][1] + thick)]
    rim_r, rim_z = outer[-1]
    return [
        lathe(outer, smooth=smooth).named("body", mat),
        lathe(inner, smooth=smooth).named("inside", inside),
        ring(rim_r - thick / 2, thick * 0.6, (0, 0, rim_z)).named("rim", mat),
    ]


@kind("mug")
def mug(rng: Rng, tone: Tone) -> list[Piece]:
    r, h, style = rng.uniform(0.038, 0.046), rng.uniform(0.085, 0.11), int(rng.integers(4))
    profile = [
        [(0, 0), (r * 0.95, 0), (r, 0.006), (r, h)],
        [(0, 0), (r * 0.7, 0), (r * 0.85, h * 0.4), (r * 1.1, h)],
        [(0, 0), (r * 0.6, 0), (r * 1.05, h * 0.45), (r * 0.95, h)],
        [(0, 0), (r * 0.75, 0), (r * 1.2, h * 0.55), (r * 1.3, h * 0.75)],
    ][style]
    mat, inside = tone.glazed(0.03), tone.plain("#f4f1ea") if chance(rng, 0.6) else tone.main.shaded(0.7)
    top, edge = profile[-1][1], profile[-1][0]
    out = _vessel(profile, 0.004, mat, inside, 15 if style else 0)
    ear = [
        (edge * 0.95, 0, top * 0.85),
        (edge + 0.028, 0, top * 0.78),
        (edge + 0.026, 0, top * 0.4),
        (edge * 0.88, 0, top * 0.25),
    ]
    out.append(tube(ear, 0.0055, smooth=15).named("handle", tone.main))
    if chance(rng, 0.5):
        drink = tone.plain(str(rng.choice(["#3b2314", "#c28a4a", "#7a1f1f"])))
        out.append(disc(edge * 0.9, (0, 0, top * 0.86)).named("drink", drink))
    if style == 3:
        saucer = lathe([(0, 0), (0.04, 0), (0.072, 0.012), (0.068, 0.014), (0.03, 0.006)], smooth=11)
        out.append(saucer.named("saucer", tone.main))
    return out


@kind("bowl")
def bowl(rng: Rng, tone: Tone) -> list[Piece]:
    r, deep = rng.uniform(0.09, 0.15), rng.uniform(0.45, 0.75)
    h = r * deep
    profile = (
        [(0, 0), (r * 0.4, 0), (r * 0.45, h * 0.08), (r * 0.85, h * 0.5), (r, h)]
        if chance(rng, 0.7)
        else [(0, 0), (r * 0.7, 0), (r * 0.95, h * 0.5), (r, h)]
    )
    out = _vessel(profile, 0.005, tone.glazed(0.035), tone.main.shaded(rng.uniform(0.7, 1.35)))
    if chance(rng, 0.35):
        fruit = [str(rng.choice(["#c8281e", "#e9a21f", "#7fae32", "#e0c020"])) for _ in range(4)]
        for k in range(4):
            a = 1.57 * k
            out.append(ball(r * 0.28, polar(r * 0.36, a, h * 0.75)).named("fruit", tone.plain(fruit[k])))
    return out


@kind("plate")
def plate(rng: Rng, tone: Tone) -> list[Piece]:
    r = rng.uniform(0.1, 0.14)
    mat = (
        tone.main
        if chance(rng, 0.5)
        else Material(
            tone.color, "rings", mix(tone.color, tone.second, 0.8), r * rng.uniform(0.4, 0.8), seed=tone.seed, main=True
        )
    )
    deep = rng.uniform(0.016, 0.03)
    top = lathe([(r, deep), (r * 0.68, deep * 0.45), (r * 0.6, 0.006), (0, 0.006)], smooth=15)
    low = lathe([(0, 0), (r * 0.6, 0), (r * 0.7, deep * 0.3), (r, deep - 0.003)], smooth=15)
    out = [
        top.named("top", mat),
        low.named("underside", tone.main),
        ring(r, 0.003, (0, 0, deep - 0.001)).named("rim", tone.main),
    ]
    if chance(rng, 0.25):
        food = [
            blob(r * 0.5, r * 0.45, 0.04, (-r * 0.15, r * 0.1, 0.02)).named("food", tone.plain("#a8642a")),
            blob(r * 0.4, r * 0.3, 0.03, (r * 0.25, -r * 0.15, 0.018)).named("food", tone.plain("#5f9a35")),
        ]
        out += food
    return out


@kind("bottle")
def bottle(rng: Rng, tone: Tone) -> list[Piece]:
    r, h, style = rng.uniform(0.034, 0.045), rng.uniform(0.22, 0.32), int(rng.integers(4))
    profile = [
        [(0, 0), (r, 0), (r, h * 0.6), (r * 0.38, h * 0.78), (r * 0.34, h * 0.94)],
        [(0, 0), (r, 0), (r, h * 0.66), (r * 0.85, h * 0.72), (r * 0.36, h * 0.76), (r * 0.34, h * 0.94)],
        [(0, 0), (r * 1.2, 0), (r * 1.25, h * 0.15), (r * 0.6, h * 0.45), (r * 0.36, h * 0.7), (r * 0.36, h * 0.94)],
        [
            (0, 0),
            (r, 0),
            (r * 1.02, h * 0.3),
            (r * 0.86, h * 0.45),
            (r * 1.02, h * 0.62),
            (r * 0.5, h * 0.82),
            (r * 0.45, h * 0.94),
        ],
    ][style]
    sheen = Material(tone.color, "brushed", seed=tone.seed, main=True)
    neck = profile[-1][0]
    out = [
        lathe(profile, smooth=23).named("body", sheen),
        cylinder(neck * 1.15, h * 0.08, (0, 0, h * 0.92), bevel=0.003).named("cap", tone.accent()),
    ]
    if style < 2 or chance(rng, 0.4):
        label = lathe([(r * 1.015, h * 0.18), (r * 1.015, h * 0.45)])
        out.append(label.named("label", tone.plain(str(rng.choice(["#f4efdf", "#e9d9a8", "#ffffff"])))))
    return out


@kind("wine glass", palette="light")
def wine_glass(rng: Rng, tone: Tone) -> list[Piece]:
    r, h = rng.uniform(0.032, 0.044), rng.uniform(0.16, 0.22)
    glass = Material(mix(tone.color, (0.85, 0.92, 0.95), 0.4), "brushed", main=True)
    cup = [(0.004, h * 0.5), (r * 0.7, h * 0.56), (r * 1.05, h * 0.72), (r * 0.85, h)]
    stem = lathe([(0, 0), (r * 0.85, 0), (r * 0.5, 0.006), (0.004, 0.014), (0.004, h * 0.5)], smooth=15)
    out = [
        stem.named("stem", glass),
        lathe(cup, smooth=13).named("cup", glass),
        lathe([(r * 0.82, h), (r, h * 0.74), (0, h * 0.58)], smooth=11).named("inside", glass.shaded(0.8)),
        ring(r * 0.84, 0.0016, (0, 0, h)).named("rim", glass),
    ]
    if chance(rng, 0.5):
        out.append(disc(r * 0.98, (0, 0, h * 0.76)).named("drink", tone.plain(str(rng.choice(["#6b1020", "#e9d48a"])))))
    return out


@kind("kettle", palette="appliance")
def kettle(rng: Rng, tone: Tone) -> list[Piece]:
    r, style, mat = rng.uniform(0.075, 0.095), int(rng.integers(3)), tone.main
    black = tone.plain("#222325")
    if style == 0:  # electric jug
        h = r * 2.5
        out = [
            cylinder(r * 1.02, 0.02).named("base", black),
            lathe([(r, 0.02), (r * 0.95, h * 0.5), (r * 0.75, h)], smooth=11).named("body", mat),
            cylinder(r * 0.74, 0.02, (0, 0, h - 0.005), bevel=0.008).named("lid", black),
        ]
        out += [
            tube(
                [(r * 0.7, 0, h * 0.97), (r * 1.5, 0, h * 0.85), (r * 1.45, 0, h * 0.35), (r * 0.95, 0, h * 0.2)],
                0.012,
                smooth=15,
            ).named("handle", black),
            rod((-r * 0.6, 0, h * 0.82), (-r * 1.05, 0, h * 0.98), 0.03, 0.014).named("spout", mat),
        ]
        return out
    squat = (
        [(0, 0), (r * 0.95, 0), (r * 1.05, r * 0.5), (r * 0.7, r * 1.25), (r * 0.35, r * 1.45)]
        if style == 1
        else [(0, 0), (r * 0.6, 0), (r * 1.05, r * 0.75), (r * 0.5, r * 1.45)]
    )
    top = squat[-1][1]
    out = [
        lathe(squat, smooth=17).named("body", mat),
        lathe([(r * 0.4, top), (r * 0.3, top + 0.012), (0, top + 0.018)], smooth=7).named("lid", mat),
        ball(0.014, (0, 0, top + 0.028)).named("knob", black),
    ]
    out.append(
        tube(
            [(-r * 0.8, 0, r * 0.6), (-r * 1.25, 0, r * 0.8), (-r * 1.5, 0, r * 1.3)], [0.024, 0.016, 0.011], smooth=11
        ).named("spout", mat)
    )
    if style == 1:
        arc = [(-r * 0.65, 0, r * 1.2), (-r * 0.5, 0, r * 2.1), (r * 0.5, 0, r * 2.1), (r * 0.65, 0, r * 1.2)]
    else:
        arc = [(r * 0.75, 0, r * 1.2), (r * 1.5, 0, r * 1.2), (r * 1.45, 0, r * 0.5), (r * 0.95, 0, r * 0.4)]
    out.append(tube(arc, 0.009, smooth=17).named("handle", black if style == 1 else mat))
    return out


@kind("cooking pot", palette="appliance")
def cooking_pot(rng: Rng, tone: Tone) -> list[Piece]:
    r, style, mat = rng.uniform(0.1, 0.14), int(rng.integers(3)), tone.main
    dark = tone.plain("#232426")
    if style == 0:  # frying pan
        h = 0.045
        out = _vessel([(0, 0), (r * 0.85, 0), (r, h)], 0.004, mat, dark, 0)
        return [*out, rod((r * 0.97, 0, h * 0.8), (r * 2.3, 0, h * 1.3), 0.011).named("handle", dark)]
    h = r * rng.uniform(0.9, 1.3)
    out = _vessel([(0, 0), (r * 0.97, 0), (r, 0.01), (r, h)], 0.004, mat, mat.shaded(0.6), 0)
    out += [
        lathe([(r * 1.02, h), (r * 0.9, h + 0.02), (r * 0.3, h + 0.04), (0, h + 0.042)], smooth=9).named("lid", mat),
        ball(0.018, (0, 0, h + 0.055)).named("knob", dark),
    ]
    if style == 1:
        return [*out, *(ring(0.035, 0.007, (s * (r + 0.012), 0, h * 0.8)).named("handle", dark, 1.2) for s in (-1, 1))]
    return [*out, rod((r * 0.97, 0, h * 0.8), (r * 2.2, 0, h * 0.9), 0.011).named("handle", dark)]


@kind("apple")
def apple(rng: Rng, tone: Tone) -> list[Piece]:
    r = rng.uniform(0.034, 0.044)
    k = rng.uniform(0.85, 1.1)
    skin = Material(tone.color, str(rng.choice(["plain", "fur"])), tone.second, seed=tone.seed, main=True)
    body = lathe(
        [
            (0, r * 0.15),
            (r * 0.35, 0.0),
            (r * 0.85, r * 0.5 * k),
            (r, r * 1.15 * k),
            (r * 0.7, r * 1.75 * k),
            (r * 0.3, r * 1.8 * k),
            (0, r * 1.5 * k),
        ],
        smooth=21,
    )
    stem = tube([(0, 0, r * 1.5 * k), (0.003, 0, r * 1.9 * k), (0.008, 0, r * 2.1 * k)], 0.0022)
    out = [
        body.named("body", skin),
        stem.named("stem", tone.plain("#4a3018"), 1.3),
    ]
    if chance(rng, 0.6):
        out.append(leaf(0.035, 0.02, 0.4, 0.4).moved(0.004, 0, r * 1.9 * k).named("leaf", tone.plain("#3d8b37")))
    return out


@kind("banana")
def banana(rng: Rng, tone: Tone) -> list[Piece]:
    ripe = (0.94, 0.8, 0.2) if chance(rng, 0.75) else (0.62, 0.75, 0.2)
    if not tone.asked:
        tone.color = ripe
    skin = Material(tone.color, main=True)
    n = int(rng.integers(1, 5))
    bend, long = rng.uniform(0.7, 1.1), rng.uniform(0.085, 0.11)
    a = np.linspace(-bend, bend, 11)
    fat = 0.018 * np.array([0.35, 0.75, 0.95, 1, 1.05, 1.05, 1.05, 1, 0.9, 0.6, 0.3])
    reach = long / bend
    path = np.stack([reach * np.sin(a), 0 * a, reach * (1 - np.cos(a)) + 0.018], 1)
    end = path[-1]
    out = []
    for k in range(n):
        lean = 24 * (k - (n - 1) / 2)
        one = tube(path, fat, smooth=15).turned("x", lean, (0, 0, 0.08))
        tip = ball(0.008, (end[0], end[1], end[2])).turned("x", lean, (0, 0, 0.08))
        out += [
            one.moved(0, 0.03 * (k - (n - 1) / 2), 0).named("skin", skin),
            tip.moved(0, 0.03 * (k - (n - 1) / 2), 0).named("tip", tone.plain("#4a3a1a")),
        ]
    return out


@kind("cake")
def cake(rng: Rng, tone: Tone) -> list[Piece]:
    r, tiers, icing = rng.uniform(0.1, 0.14), int(rng.integers(1, 3)), tone.main
    out, z = (
        [
            lathe([(0, 0), (r * 0.5, 0), (r * 1.2, 0.012), (r * 1.2, 0.015), (0, 0.012)]).named(
                "plate", tone.plain("#f3f1ec")
            )
        ],
        0.012,
    )
    cream = tone.plain("#fbf4e4") if sum(tone.color) < 2.4 else tone.accent()
    for k in range(tiers):
        rr = r * (1 - 0.38 * k)
        h = 0.075 if tiers > 1 else 0.09
        out += [
            cylinder(rr, h, (0, 0, z), bevel=0.012).named("cake", icing),
            ring(rr, 0.011, (0, 0, z + 0.008)).named("cream", cream),
        ]
        n = 12 - 4 * k
        out.append(join(*(ball(0.014, polar(rr * 0.85, a, z + h + 0.006)) for a in around(n))).named("cream", cream))
        z += h
    if chance(rng, 0.6):
        out += [cylinder(0.004, 0.05, polar(0.03, a, z)).named("candle", tone.accent(), 1.3) for a in (0.3, 2.4, 4.5)]
    else:
        out.append(ball(0.02, (0, 0, z + 0.015)).named("cherry", tone.plain("#b8141c")))
    return out
