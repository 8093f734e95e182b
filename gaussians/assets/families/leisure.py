"""Builders of toys, musical instruments, bicycles and balls. Each builder returns the pieces of one design."""

from __future__ import annotations

import numpy as np

from ..modeling.materials import Material, Tone, mix
from ..modeling.parts import Rng, around, chance, polar
from ..modeling.round_shapes import ball, blob, cylinder, lathe, ring, rod, tube
from ..modeling.shapes import Array, Piece, box, boxes, extrude, join, rounded_rectangle
from ..registry import kind


@kind("teddy bear")
def teddy_bear(rng: Rng, tone: Tone) -> list[Piece]:
    s = rng.uniform(0.8, 1.4)
    fur = Material(tone.color, "fur", seed=tone.seed, main=True)
    pale, black = Material(mix(tone.color, (0.95, 0.87, 0.75), 0.65), "fur"), tone.plain("#161412")
    out = [
        blob(0.17, 0.15, 0.19, (0, 0, 0.1)).named("body", fur),
        blob(0.1, 0.03, 0.11, (0, -0.066, 0.1)).named("belly", pale),
        blob(0.15, 0.13, 0.13, (0, -0.01, 0.25)).named("head", fur),
    ]
    for k in (-1, 1):
        spread = rng.uniform(0.3, 1.0)
        arm = tube(
            [
                (k * 0.07, 0, 0.16),
                (k * (0.1 + 0.03 * spread), -0.03, 0.13 + 0.06 * spread),
                (k * (0.11 + 0.04 * spread), -0.06, 0.1 + 0.12 * spread),
            ],
            [0.03, 0.032, 0.028],
            smooth=11,
        )
        leg = tube(
            [(k * 0.05, -0.02, 0.05), (k * 0.07, -0.09, 0.035), (k * 0.08, -0.13, 0.035)],
            [0.04, 0.038, 0.036],
            smooth=9,
        )
        out += [
            arm.named("arm", fur),
            leg.named("leg", fur),
            blob(0.055, 0.02, 0.06, (k * 0.081, -0.158, 0.037)).named("paw", pale),
            blob(0.055, 0.025, 0.055, (k * 0.06, 0, 0.31)).named("ear", fur),
            blob(0.034, 0.02, 0.034, (k * 0.06, -0.008, 0.31)).named("ear", pale),
            ball(0.0085, (k * 0.03, -0.072, 0.268)).named("eye", black, 1.4),
        ]
    out += [
        blob(0.06, 0.05, 0.048, (0, -0.07, 0.232)).named("muzzle", pale),
        blob(0.022, 0.014, 0.015, (0, -0.096, 0.245)).named("nose", black, 1.4),
    ]
    if chance(rng, 0.45):
        bow = tone.accent()
        out += [blob(0.05, 0.02, 0.034, (k * 0.027, -0.07, 0.185)).named("bow", bow) for k in (-1, 1)]
    return [p.stretched(s, s, s) for p in out]


def _guitar_outline(w: float, h: float, electric: bool) -> Array:
    """`[40, 2]` outline of a guitar's body, counter-clockwise, from y = 0 to y = `h`."""
    t = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    wide = w / 2 * (1 - 0.17 * np.cos(2 * t) - 0.12 * np.sin(t)) / 1.17
    x, y = wide * np.cos(t) * (1 - 0.22 * np.exp(-(((np.sin(t) - 0.15) / 0.22) ** 2))), h / 2 * np.sin(t)
    if electric:
        horn = 0.12 * w * np.exp(-(((t - 0.95) / 0.22) ** 2)) + 0.16 * w * np.exp(-(((t - 2.15) / 0.2) ** 2))
        y = y + horn
    return np.stack([x, y + h / 2], 1)


@kind("guitar")
def guitar(rng: Rng, tone: Tone) -> list[Piece]:
    electric = chance(rng, 0.4)
    w, h, deep = (0.32, 0.4, 0.045) if electric else (rng.uniform(0.34, 0.4), rng.uniform(0.45, 0.5), 0.1)
    outline = _guitar_outline(w, h, electric)
    body = Material(tone.color, "wood" if chance(rng, 0.5) else "plain", seed=tone.seed, axis=1, main=True)
    neck, black = Material((0.3, 0.18, 0.1), "wood", axis=1), tone.plain("#18181a")
    out = [extrude(outline, deep, 0.008).named("body", body)]
    long = h + rng.uniform(0.42, 0.5)
    out += [
        box(0.052, long - h * 0.62, 0.02, (0, (long + h * 0.62) / 2, deep - 0.004), 0.004).named("neck", neck),
        box(0.07, 0.15, 0.018, (0, long + 0.07, deep - 0.008), 0.004).named("head", body if chance(rng, 0.5) else neck),
    ]
    out += [
        ball(0.009, (s * 0.042, long + y, deep)).named("peg", tone.metal(), 1.2)
        for s in (-1, 1)
        for y in (0.03, 0.07, 0.11)
    ]
    out.append(box(0.1, 0.024, 0.012, (0, h * 0.24, deep), 0.003).named("bridge", neck))
    if electric:
        guard = extrude(_guitar_outline(w * 0.6, h * 0.55, False), 0.004).moved(0.02, h * 0.2, deep)
        out += [
            guard.named("pickguard", tone.plain("#f3efe4")),
            *(box(0.075, 0.02, 0.012, (0, h * f, deep), 0.003).named("pickup", black) for f in (0.4, 0.55)),
            *(cylinder(0.012, 0.012, (0.09, h * f, deep)).named("knob", tone.metal(), 1.2) for f in (0.22, 0.32)),
        ]
    else:
        out += [
            lathe([(0.045, 0.001), (0, 0.001)]).moved(0, h * 0.56, deep).named("hole", black),
            ring(0.05, 0.004, (0, h * 0.56, deep)).named("rosette", neck),
        ]
    out += [
        rod((x, h * 0.24, deep + 0.012), (x * 0.8, long + 0.02, deep + 0.02), 0.0011).named(
            "string", tone.plain("#d8d4c8"), 0.8
        )
        for x in np.linspace(-0.022, 0.022, 6)
    ]
    lean = rng.uniform(0, 10)
    up = [p.turned("x", 90).turned("x", -lean) for p in out]
    if chance(rng, 0.6):  # a stand
        feet = [rod((s * 0.14, -0.12, -0.04), (0, 0.12, 0.3), 0.009) for s in (-1, 1)] + [
            rod((0, 0.28, -0.04), (0, 0.12, 0.3), 0.009),
            rod((-0.12, -0.08, 0.0), (0.12, -0.08, 0.0), 0.008),
        ]
        up.append(join(*feet).named("stand", black))
    return up


@kind("bicycle")
def bicycle(rng: Rng, tone: Tone) -> list[Piece]:
    r, frame, black = rng.uniform(0.31, 0.35), tone.main, tone.plain("#1c1c1e")
    steel = Material((0.75, 0.76, 0.78), "brushed")
    tyre = black if chance(rng, 0.7) else tone.plain("#e5d9bd")
    gap = rng.uniform(0.98, 1.08)
    rear, front = (gap / 2, r), (-gap / 2, r)  # (y, z): it rides towards -y
    out: list[Piece] = []
    for y, z in (rear, front):
        spokes = [
            rod((0, y, z), (0, y + (r - 0.02) * np.cos(a), z + (r - 0.02) * np.sin(a)), 0.0018) for a in around(16)
        ]
        out += [
            ring(r - 0.018, 0.018, (0, y, z), "x").named("tyre", tyre, 0.8),
            ring(r - 0.04, 0.009, (0, y, z), "x").named("rim", steel, 0.7),
            join(*spokes).named("spoke", steel, 0.8),
            rod((-0.04, y, z), (0.04, y, z), 0.02).named("hub", steel),
        ]
    crank, seat, head = (0.06, 0.28), (0.2, 0.74), (-0.34, 0.78)
    step = chance(rng, 0.3)
    top = (0.11, 0.5) if step else (0.19, 0.7)
    bars = [
        (crank, seat),
        (crank, (head[0], head[1] - 0.1)),
        (top, head if not step else (head[0], head[1] - 0.04)),
        (rear, crank),
        (rear, top),
    ]
    out.append(
        join(
            *(rod((0, *a), (0, *b), 0.019) for a, b in bars[:3]),
            *(rod((s * 0.03, *a), (s * 0.012, *b), 0.01) for a, b in bars[3:] for s in (-1, 1)),
        ).named("frame", frame, 1.6)
    )
    out.append(
        join(
            rod((0, head[0] - 0.02, head[1] + 0.09), (0, head[0] + 0.0, head[1] - 0.12), 0.018),
            *(
                tube(
                    [(s * 0.03, head[0], head[1] - 0.12), (s * 0.045, -gap / 2 + 0.05, 0.55), (s * 0.045, *front)],
                    0.011,
                    smooth=9,
                )
                for s in (-1, 1)
            ),
        ).named("fork", frame, 1.6)
    )
    bar_z = head[1] + 0.12
    if chance(rng, 0.4):  # dropped bars
        grip = [
            [
                (0, head[0] - 0.02, bar_z),
                (s * 0.2, head[0] - 0.03, bar_z),
                (s * 0.21, head[0] - 0.14, bar_z - 0.02),
                (s * 0.21, head[0] - 0.12, bar_z - 0.13),
                (s * 0.21, head[0] + 0.0, bar_z - 0.14),
            ]
            for s in (-1, 1)
        ]
    else:
        grip = [
            [
                (0, head[0] - 0.02, bar_z),
                (s * 0.14, head[0] - 0.02, bar_z + 0.05),
                (s * 0.28, head[0] + 0.12, bar_z + 0.03),
            ]
            for s in (-1, 1)
        ]
    out += [tube(g, 0.012, smooth=15).named("handlebar", steel if chance(rng, 0.5) else black, 1.2) for g in grip]
    saddle = blob(0.14, 0.26, 0.06, (0, seat[0] + 0.04, seat[1] + 0.1), 1.0, 0.8)
    out += [
        rod((0, seat[0], seat[1] - 0.03), (0, seat[0] + 0.03, seat[1] + 0.09), 0.012).named("seatpost", steel),
        saddle.named("saddle", black if chance(rng, 0.6) else tone.plain("#7a4a26")),
    ]
    out += [
        ring(0.085, 0.006, (0.045, *crank), "x").named("chainring", steel),
        rod((0.07, crank[0], crank[1]), (0.07, crank[0] - 0.1, crank[1] - 0.13), 0.01).named("crank", steel),
        rod((-0.07, crank[0], crank[1]), (-0.07, crank[0] + 0.1, crank[1] + 0.13), 0.01).named("crank", steel),
        box(0.09, 0.07, 0.02, (0.115, crank[0] - 0.1, crank[1] - 0.14)).named("pedal", black),
        box(0.09, 0.07, 0.02, (-0.115, crank[0] + 0.1, crank[1] + 0.12)).named("pedal", black),
        rod((0.045, rear[0], rear[1] + 0.03), (0.045, crank[0], crank[1] + 0.085), 0.005).named("chain", black),
    ]
    if chance(rng, 0.35):
        out.append(
            boxes(
                [
                    (0.3, 0.22, 0.02, 0, -0.55, 0.76),
                    (0.3, 0.012, 0.16, 0, -0.44, 0.76),
                    (0.3, 0.012, 0.16, 0, -0.66, 0.76),
                    (0.012, 0.22, 0.16, 0.15, -0.55, 0.76),
                    (0.012, 0.22, 0.16, -0.15, -0.55, 0.76),
                ]
            ).named("basket", Material((0.65, 0.48, 0.28), "wicker", scale=0.03))
        )
    if chance(rng, 0.5):
        for y, z in (rear, front):
            arc = [(0, y + (r + 0.03) * np.cos(a), z + (r + 0.03) * np.sin(a)) for a in np.linspace(0.4, 2.7, 13)]
            out.append(tube(arc, 0.02).named("mudguard", frame))
    return out


@kind("piano", palette="dark")
def piano(rng: Rng, tone: Tone) -> list[Piece]:
    wood = Material(tone.color, "wood" if chance(rng, 0.5) else "plain", seed=tone.seed, axis=0, main=True)
    if chance(rng, 0.35) and not tone.asked:
        wood = Material(tone.wood().color, "wood", seed=tone.seed, axis=0, main=True)
        tone.color = wood.color
    ivory, black = tone.plain("#f7f3e6"), tone.plain("#131314")
    w, z = rng.uniform(1.38, 1.5), 0.68

    def keys(y: float) -> list[Piece]:
        n = 44
        white = boxes(
            [((w - 0.2) / n - 0.002, 0.15, 0.022, (k + 0.5 - n / 2) * (w - 0.2) / n, y, z) for k in range(n)], 0.0
        )
        dark = boxes(
            [
                (0.014, 0.09, 0.014, (k + 1 - n / 2) * (w - 0.2) / n, y + 0.03, z + 0.022)
                for k in range(n - 1)
                if k % 7 not in (2, 6)
            ],
            0.0,
        )
        return [white.named("key", ivory, 0.6), dark.named("key", black, 0.6)]

    if chance(rng, 0.3):  # a grand: a curved case on three legs
        d = rng.uniform(1.4, 1.7)
        outline = np.array(
            [
                (-w / 2, -d / 2 + 0.2),
                (w / 2, -d / 2 + 0.2),
                (w / 2, 0),
                (w * 0.4, d * 0.2),
                (w * 0.1, d * 0.35),
                (-w * 0.05, d * 0.48),
                (-w * 0.25, d / 2),
                (-w / 2, d * 0.45),
            ]
        )
        lid = extrude(outline, 0.02, 0.005).moved(0, 0, 1.02)
        legs = [
            rod((x, y, 0), (x, y, z), 0.03, 0.05)
            for x, y in ((-w * 0.42, -d * 0.3), (w * 0.42, -d * 0.3), (-w * 0.22, d * 0.36))
        ]
        arm = boxes([(0.06, 0.24, 0.12, s * (w / 2 - 0.03), -d / 2 + 0.12, z - 0.03) for s in (-1, 1)])
        return [
            extrude(outline, 0.3, 0.01).moved(0, 0, z).named("case", wood),
            lid.turned("y", -rng.uniform(0, 25), (-w / 2, 0, 1.0)).named("lid", wood),
            join(*legs).named("leg", wood),
            box(w, 0.24, 0.06, (0, -d / 2 + 0.12, z - 0.06)).named("keybed", wood),
            *keys(-d / 2 + 0.1),
            arm.named("arm", wood),
        ]
    h, d = rng.uniform(1.08, 1.3), rng.uniform(0.55, 0.62)
    y = -d / 2 + 0.12
    case = boxes(
        [(w, d - 0.26, h, 0, 0.13, 0), (w, 0.28, 0.06, 0, y + 0.01, z - 0.06), (w + 0.04, d - 0.22, 0.03, 0, 0.13, h)],
        0.008,
    )
    arms = boxes(
        [(0.06, 0.27, 0.13, s * (w / 2 - 0.03), y + 0.01, z - 0.03) for s in (-1, 1)]
        + [(0.06, 0.06, z - 0.06, s * (w / 2 - 0.05), y - 0.06, 0) for s in (-1, 1)]
    )
    pedal = boxes([(0.04, 0.1, 0.02, x, -0.02, 0.06) for x in (-0.1, 0, 0.1)])
    out = [
        case.named("case", wood),
        arms.named("arm", wood),
        *keys(y - 0.01),
        box(w * 0.6, 0.02, 0.18, (0, -d / 2 + 0.25, z + 0.16)).named("music stand", wood.shaded(0.8)),
        pedal.named("pedal", Material((0.8, 0.65, 0.3), "brushed")),
    ]
    if chance(rng, 0.5):
        sheet_music = box(0.34, 0.01, 0.24, (0, -d / 2 + 0.235, z + 0.2)).turned("x", -8, (0, 0, z + 0.2))
        out.append(sheet_music.named("sheet music", tone.plain("#faf7ee")))
    return out


@kind("ball")
def toy_ball(rng: Rng, tone: Tone) -> list[Piece]:
    r, style = (
        float(rng.choice([rng.uniform(0.09, 0.13), rng.uniform(0.25, 0.32)], p=[0.75, 0.25])),
        int(rng.integers(4)),
    )
    second = mix(tone.color, tone.second, 0.9)
    if style == 0:
        return [
            ball(r, (0, 0, r)).named("ball", Material(tone.color, "dots", second, r * 0.8, seed=tone.seed, main=True))
        ]
    if style == 1:
        seams = [ring(r * 1.002, r * 0.025, (0, 0, r), a) for a in "xyz"]
        return [ball(r, (0, 0, r)).named("ball", tone.main), join(*seams).named("seam", Material((0.12, 0.1, 0.1)))]
    if style == 2:
        return [
            ball(r, (0, 0, r))
            .named("ball", Material(tone.color, "stripes", second, r * 0.66, 2, tone.seed, True))
            .turned("x", 25, (0, 0, r))
        ]
    return [
        ball(r, (0, 0, r)).named("ball", tone.main),
        cylinder(r * 0.08, 0.01, (0, 0, 2 * r - 0.006)).named("valve", Material(second)),
    ]


@kind("toy car")
def toy_car(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, mat, black = rng.uniform(0.09, 0.12), rng.uniform(0.2, 0.26), tone.main, tone.plain("#1d1d20")
    glass, r = tone.plain("#a9cbe0"), 0.026
    truck = chance(rng, 0.35)
    out = [extrude(rounded_rectangle(w, d, 0.025), 0.045, 0.01).moved(0, 0, 0.02).named("body", mat)]
    if truck:
        out += [
            box(w * 0.92, d * 0.28, 0.06, (0, -d * 0.26, 0.06), 0.01).named("cab", mat),
            box(w * 0.96, d * 0.5, 0.075, (0, d * 0.2, 0.062), 0.006).named("load", Material(tone.second)),
            box(w * 0.8, 0.004, 0.03, (0, -d * 0.4 - 0.001, 0.08)).named("window", glass),
        ]
    else:
        out += [
            blob(w * 0.88, d * 0.56, 0.09, (0, d * 0.04, 0.065), 0.5, 0.6).named("cab", mat),
            blob(w * 0.9, d * 0.44, 0.05, (0, d * 0.04, 0.082), 0.5, 0.5).named("window", glass),
            box(w * 0.6, d * 0.3, 0.008, (0, d * 0.04, 0.104), 0.003).named("roof", mat),
        ]
    out += [
        cylinder(r, 0.022, bevel=0.004).turned("y", 90).moved(s * w / 2 - 0.011, y * d * 0.3, r).named("wheel", black)
        for s in (-1, 1)
        for y in (-1, 1)
    ]
    return [*out, *(ball(0.009, (s * w * 0.32, -d / 2, 0.045)).named("lamp", tone.plain("#f8e9a0")) for s in (-1, 1))]


@kind("drum")
def drum(rng: Rng, tone: Tone) -> list[Piece]:
    r, h, mat, steel = rng.uniform(0.17, 0.26), rng.uniform(0.22, 0.45), tone.main, tone.metal()
    z = 0.02
    skin = tone.plain("#f1ead8")
    lugs = [rod(polar(r + 0.008, a, z), polar(r + 0.008, a, z + h), 0.005) for a in around(8)]
    out = [
        lathe([(r, z), (r, z + h)]).named("shell", mat),
        lathe([(r, z + h), (0, z + h)]).named("skin", skin),
        ring(r, 0.012, (0, 0, z + h)).named("hoop", steel),
        ring(r, 0.012, (0, 0, z)).named("hoop", steel),
        join(*lugs).named("lug", steel),
    ]
    if chance(rng, 0.4):
        sticks = [rod((-0.15, 0.05 * s, z + h + 0.014), (0.16, -0.06 * s, z + h + 0.016), 0.007) for s in (-1, 1)]
        out.append(join(*sticks).named("stick", tone.wood()))
    return out
