"""Builders of lamps, lanterns and candles. Each builder returns the pieces of one design."""

from __future__ import annotations

from ..modeling.materials import Material, Tone, mix
from ..modeling.parts import CORNERS, Rng, around, chance, polar
from ..modeling.round_shapes import ball, blob, cylinder, lathe, ring, rod, tube
from ..modeling.shapes import Piece, Point, box, extrude, join, rounded_rectangle
from ..registry import kind


def _shade(rng: Rng, r: float, h: float, at: Point, tone: Tone, style: int) -> list[Piece]:
    """A lamp shade from `at` upwards: 0 cone, 1 drum, 2 globe, 3 dome, 4 bell, 5 pleated, 6 empire."""
    lit = Material(tone.color, "glow", mix(tone.color, (1.0, 0.97, 0.85), 0.6), seed=tone.seed, main=True)
    if style == 2:
        return [ball(r * 0.85, (at[0], at[1], at[2] + r * 0.85)).named("shade", lit)]
    profile = {
        0: [(r, 0), (r * 0.35, h)],
        1: [(r * 0.9, 0), (r * 0.9, h)],
        3: [(r, 0), (r * 0.93, h * 0.4), (r * 0.6, h * 0.75), (r * 0.12, h * 0.9)],
        4: [(r, 0), (r * 0.72, h * 0.3), (r * 0.55, h * 0.7), (r * 0.5, h)],
        5: [(r, 0), (r * 0.6, h)],
        6: [(r * 0.95, 0), (r * 0.7, h)],
    }[style]
    wall = lathe(profile, at, smooth=11 if style in (3, 4) else 0)
    out = [
        wall.named("shade", lit),
        lathe([(p[0] - 0.004, p[1]) for p in profile[::-1]], at).named("inside", tone.plain("#fff3cf")),
    ]
    if style == 5:
        ribs = [rod(polar(r, a), polar(0.6 * r, a, h), 0.004) for a in around(16)]
        out.append(join(*ribs).moved(*at).named("rib", lit.shaded(0.7)))
    if chance(rng, 0.5):
        trim = Material(tone.second, seed=tone.seed)
        out += [
            ring(profile[0][0], 0.006, at).named("trim", trim),
            ring(profile[-1][0], 0.005, (at[0], at[1], at[2] + profile[-1][1])).named("trim", trim),
        ]
    return out


@kind("floor lamp", palette="light")
def floor_lamp(rng: Rng, tone: Tone) -> list[Piece]:
    h, style, shade = rng.uniform(1.35, 1.7), int(rng.integers(4)), int(rng.integers(7))
    metal = tone.metal() if chance(rng, 0.7) else tone.wood()
    r, sh = rng.uniform(0.18, 0.26), rng.uniform(0.22, 0.34)
    if style == 0:
        out = [
            cylinder(rng.uniform(0.13, 0.17), 0.025, bevel=0.01).named("base", metal),
            rod((0, 0, 0.02), (0, 0, h - sh * 0.4), 0.013).named("pole", metal, 1.3),
        ]
    elif style == 1:
        legs = [rod(polar(0.28, a), polar(0.02, a, h - sh * 0.6), 0.013, 0.017) for a in (0.4, 2.5, 4.6)]
        out = [join(*legs).named("leg", metal, 1.2)]
    elif style == 2:  # an arc lamp
        reach = rng.uniform(0.45, 0.7)
        path = [
            (-reach / 2, 0, 0.02),
            (-reach / 2, 0, h * 0.65),
            (-reach * 0.2, 0, h),
            (reach * 0.35, 0, h + 0.02),
            (reach / 2, 0, h - 0.12),
        ]
        out = [
            cylinder(0.16, 0.04, (-reach / 2, 0, 0), bevel=0.01).named("base", metal),
            tube(path, 0.012, smooth=29).named("pole", metal, 1.2),
        ]
        out += _shade(rng, r * 0.85, sh * 0.7, (reach / 2, 0, h - 0.12 - sh * 0.7), tone, int(rng.choice([0, 3, 3, 2])))
        return out
    else:  # an uplighter bowl
        out = [
            cylinder(0.14, 0.03, bevel=0.01).named("base", metal),
            rod((0, 0, 0.02), (0, 0, h), 0.014).named("pole", metal, 1.3),
        ]
        bowl = Material(tone.color, "glow", mix(tone.color, (1, 1, 0.9), 0.6), main=True)
        inside = lathe([(r - 0.005, 0.14), (r * 0.7, 0.06), (0, 0.03)], (0, 0, h), smooth=9)
        return [
            *out,
            lathe([(0.02, 0), (r * 0.7, 0.05), (r, 0.14)], (0, 0, h), smooth=9).named("shade", bowl),
            inside.named("inside", tone.plain("#fff3cf")),
        ]
    return out + _shade(rng, r, sh, (0, 0, h - sh * 0.5), tone, shade)


@kind("table lamp", palette="light")
def table_lamp(rng: Rng, tone: Tone) -> list[Piece]:
    h, style = rng.uniform(0.22, 0.34), int(rng.integers(5))
    r, sh, shade = rng.uniform(0.11, 0.17), rng.uniform(0.14, 0.22), int(rng.integers(7))
    body = tone.frame() if chance(rng, 0.6) else tone.accent()
    if style == 0:
        base = [
            cylinder(0.075, 0.015, bevel=0.005).named("base", body),
            rod((0, 0, 0.01), (0, 0, h), 0.009).named("pole", body, 1.3),
        ]
    elif style == 1:
        k = rng.uniform(0.06, 0.1)
        base = [
            lathe(
                [(0, 0), (k * 0.7, 0), (k, h * 0.35), (k * 0.45, h * 0.75), (0.012, h * 0.85), (0.012, h)], smooth=19
            ).named("base", body)
        ]
    elif style == 2:
        stack = [ball(0.035 + 0.012 * (2 - k), (0, 0, 0.05 + 0.075 * k)) for k in range(3)]
        base = [join(*stack, rod((0, 0, 0.1), (0, 0, h), 0.008)).named("base", body)]
    elif style == 3:
        base = [
            box(0.11, 0.11, h * 0.8, (0, 0, 0), 0.012).named("base", body),
            rod((0, 0, h * 0.8), (0, 0, h), 0.009).named("pole", body),
        ]
    else:  # an egg-shaped shade without a stem
        lit = Material(tone.color, "glow", mix(tone.color, (1.0, 0.97, 0.85), 0.6), main=True)
        return [
            cylinder(r * 0.5, 0.02).named("base", body),
            blob(2 * r, 2 * r, 2.2 * r, (0, 0, 1.1 * r + 0.015)).named("shade", lit),
        ]
    return base + _shade(rng, r, sh, (0, 0, h - sh * 0.35), tone, shade)


@kind("desk lamp")
def desk_lamp(rng: Rng, tone: Tone) -> list[Piece]:
    mat, h, reach = tone.main, rng.uniform(0.34, 0.46), rng.uniform(0.14, 0.22)
    elbow, head = (0.0, reach * 0.8, h * 0.55), (0.0, -reach * 0.5, h)
    arms = [rod((0, 0, 0.02), elbow, 0.008), rod(elbow, head, 0.008), ball(0.014, elbow), ball(0.012, head)]
    if chance(rng, 0.4):
        arms = [tube([(0, 0, 0.01), (0, 0.03, h * 0.5), (0, 0, h), (0, -reach * 0.5, h * 1.02)], 0.008, smooth=21)]
    r = rng.uniform(0.06, 0.085)
    cup = join(
        lathe([(r, 0), (r * 0.85, 0.05), (r * 0.4, 0.1), (0.02, 0.12)], smooth=9),
        lathe([(0.0, 0.08), (r - 0.004, 0.004)]),
    )
    out = [
        cylinder(rng.uniform(0.07, 0.1), 0.02, bevel=0.006).named("base", mat),
        join(*arms).named("arm", mat if chance(rng, 0.5) else tone.metal(), 1.2),
    ]
    return [
        *out,
        cup.turned("x", rng.uniform(-35, -10)).moved(0, head[1] - 0.02, head[2] - 0.08).named("head", mat, 1.1),
    ]


@kind("pendant lamp")
def pendant_lamp(rng: Rng, tone: Tone) -> list[Piece]:
    r, sh, cord = rng.uniform(0.14, 0.28), rng.uniform(0.16, 0.3), rng.uniform(0.35, 0.7)
    out = _shade(rng, r, sh, (0, 0, 0), tone, int(rng.integers(7)))
    return [
        *out,
        rod((0, 0, sh * 0.8), (0, 0, sh + cord), 0.006).named("cord", tone.plain("#2b2b2b")),
        cylinder(0.05, 0.025, (0, 0, sh + cord)).named("rose", tone.metal()),
    ]


@kind("candle", palette="light")
def candle(rng: Rng, tone: Tone) -> list[Piece]:
    style, wax = int(rng.integers(3)), tone.main
    r, h, z = rng.uniform(0.028, 0.04), rng.uniform(0.08, 0.16), 0.0
    out: list[Piece] = []
    if style == 0:
        out.append(lathe([(0, 0), (r * 1.8, 0), (r * 1.9, 0.012), (r * 1.2, 0.01)]).named("dish", tone.metal()))
        z = 0.01
    elif style == 1:
        r, h, z = 0.013, rng.uniform(0.14, 0.22), rng.uniform(0.06, 0.14)
        out.append(
            lathe(
                [
                    (0, 0),
                    (0.045, 0),
                    (0.04, 0.012),
                    (0.009, 0.03),
                    (0.012, z * 0.6),
                    (0.008, z * 0.8),
                    (0.02, z),
                    (0.0, z),
                ],
                smooth=19,
            ).named("holder", tone.metal())
        )
    out.append(cylinder(r, h, (0, 0, z), bevel=0.003).named("wax", wax))
    out += [rod((0, 0, z + h), (0, 0, z + h + 0.012), 0.0015).named("wick", tone.plain("#222222"))]
    if chance(rng, 0.6):
        flame = Material((1.0, 0.78, 0.25), "glow", (1.0, 0.95, 0.7))
        fire = lathe([(0, 0), (0.008, 0.01), (0.005, 0.024), (0, 0.04)], (0, 0, z + h + 0.008), smooth=9)
        out.append(fire.named("flame", flame, 1.3))
    return out


@kind("lantern")
def lantern(rng: Rng, tone: Tone) -> list[Piece]:
    w, h, mat = rng.uniform(0.14, 0.2), rng.uniform(0.22, 0.34), tone.main
    posts = join(
        *(box(0.014, 0.014, h, (sx * (w / 2 - 0.007), sy * (w / 2 - 0.007), 0.02), 0.003) for sx, sy in CORNERS)
    )
    roof = cylinder(w * 0.62, w * 0.4, (0, 0, h + 0.03), top=w * 0.12)
    glow = Material((1.0, 0.86, 0.5), "glow", (1.0, 0.97, 0.8))
    bars = join(*(box(w, 0.012, 0.014, (0, s * (w / 2 - 0.006), z), 0.002) for s in (-1, 1) for z in (0.02, h)))
    return [
        extrude(rounded_rectangle(w * 1.1, w * 1.1, 0.02), 0.025, 0.004).named("base", mat),
        posts.named("frame", mat),
        bars.named("frame", mat),
        roof.named("roof", mat),
        cylinder(w * 0.2, h * 0.55, (0, 0, 0.03)).named("candle", glow),
        ring(w * 0.24, 0.005, (0, 0, h + w * 0.55 + 0.03), "y").named("handle", mat, 1.3),
    ]
