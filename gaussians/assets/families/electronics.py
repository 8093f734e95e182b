"""Builders of screens, audio and other electric devices. Each builder returns the pieces of one design."""

from __future__ import annotations

import numpy as np

from ..modeling.materials import Material, Tone
from ..modeling.parts import CORNERS, Rng, around, chance, tapered_legs
from ..modeling.round_shapes import ball, blob, cylinder, disc, lathe, ring, rod, tube
from ..modeling.shapes import Piece, box, boxes, extrude, join, leaf, panel, rounded_rectangle
from ..registry import kind


def _display(rng: Rng, w: float, h: float, z: float, tone: Tone, rim: float, thick: float = 0.03) -> list[Piece]:
    """A flat screen facing -y with its lower edge at z."""
    picture = Material((0.1, 0.1, 0.1), "screen", seed=tone.seed)
    return [
        box(w, thick, h, (0, 0, z), 0.006).named("case", tone.main),
        panel(w - 2 * rim, h - 2 * rim, (0, -thick / 2 - 0.002, z + rim)).named("screen", picture),
    ]


@kind("television", palette="dark")
def television(rng: Rng, tone: Tone) -> list[Piece]:
    style = int(rng.integers(4))
    if style == 3:  # a cathode-ray set with aerials
        w, d, h = rng.uniform(0.6, 0.75), 0.4, rng.uniform(0.45, 0.52)
        case = tone.wood() if chance(rng, 0.5) else tone.main
        glass = (
            extrude(rounded_rectangle(w * 0.68, h * 0.78, 0.06), 0.02, 0.008)
            .turned("x", 90)
            .moved(-w * 0.1, -d / 2 + 0.005, 0.05 + h / 2)
        )
        out = [
            box(w, d, h, (0, 0, 0.05), 0.02).named("case", tone.main if chance(rng, 0.6) else case),
            glass.named("screen", Material((0.2, 0.24, 0.25), "screen", seed=3 * (tone.seed // 3))),
        ]
        out += [
            cylinder(0.022, 0.02).turned("x", 90).moved(w * 0.36, -d / 2, 0.05 + h * f).named("knob", tone.metal())
            for f in (0.75, 0.6)
        ]
        out += [rod((0, 0, h + 0.05), (s * 0.16, 0, h + 0.36), 0.004).named("aerial", tone.metal()) for s in (-1, 1)]
        return [
            *out,
            boxes([(0.05, 0.05, 0.06, sx * w * 0.4, sy * d * 0.35, 0) for sx, sy in CORNERS]).named("foot", case),
        ]
    w = rng.uniform(0.9, 1.4)
    h, lift = w * 0.57, 0.06
    out = _display(rng, w, h, lift, tone, 0.016, 0.045)
    if style == 0:
        out += [
            box(w * 0.36, 0.22, 0.012, (0, 0, 0)).named("stand", tone.main),
            box(0.12, 0.03, lift + 0.02, (0, 0.02, 0)).named("stand", tone.main),
        ]
    elif style == 1:
        feet = [
            rod((s * w * 0.36, 0, lift + 0.01), (s * w * 0.38, y, 0.006), 0.008) for s in (-1, 1) for y in (-0.12, 0.12)
        ]
        out.append(join(*feet).named("stand", tone.main, 1.2))
    else:
        out.append(box(w * 0.8, 0.08, lift - 0.005, (0, 0, 0), 0.02).named("soundbar", tone.main))
    return out


@kind("monitor", palette="dark")
def monitor(rng: Rng, tone: Tone) -> list[Piece]:
    w = rng.uniform(0.5, 0.72)
    h, z = w * rng.uniform(0.5, 0.62), rng.uniform(0.1, 0.15)
    out = _display(rng, w, h, z, tone, 0.012, 0.022)
    neck = (
        box(0.05, 0.02, z + h * 0.4, (0, 0.03, 0.01))
        if chance(rng, 0.6)
        else rod((0, 0.07, 0.01), (0, 0.02, z + h * 0.4), 0.018)
    )
    foot = (
        box(w * 0.4, 0.18, 0.012, (0, 0.03, 0)) if chance(rng, 0.5) else cylinder(0.1, 0.012, (0, 0.03, 0), bevel=0.004)
    )
    stand = tone.main if chance(rng, 0.5) else tone.metal()
    return [*out, neck.named("neck", stand), foot.named("foot", stand)]


@kind("laptop", palette="dark")
def laptop(rng: Rng, tone: Tone) -> list[Piece]:
    w, d = rng.uniform(0.31, 0.37), rng.uniform(0.21, 0.25)
    body = tone.main
    keys = Material((0.12, 0.12, 0.13), "keys", body.color)
    screen = panel(w - 0.016, d - 0.02, (0, -0.0055, 0.012))
    lid = [
        box(w, 0.008, d, (0, 0, 0), 0.003).named("lid", body),
        screen.named("screen", Material((0.1, 0.1, 0.1), "screen", seed=tone.seed | 1)),
    ]
    angle = -rng.uniform(8, 32)
    out = [box(w, d, 0.016, (0, 0, 0), 0.004).named("base", body)]
    out += [p.turned("x", angle).moved(0, d / 2, 0.016) for p in lid]
    deck = panel(w * 0.86, d * 0.45).turned("x", -90).moved(0, -0.01, 0.0175)
    pad = panel(w * 0.3, d * 0.25).turned("x", -90).moved(0, -d * 0.47, 0.0175)
    return [*out, deck.named("keyboard", keys), pad.named("touchpad", body.shaded(0.8))]


@kind("keyboard")
def keyboard(rng: Rng, tone: Tone) -> list[Piece]:
    w, d = rng.uniform(0.34, 0.45), rng.uniform(0.12, 0.16)
    caps = tone.plain(str(rng.choice(["#f0f0ee", "#232427", "#d8d2c4"])))
    shell = extrude(rounded_rectangle(w, d, rng.uniform(0.006, 0.03)), 0.016, 0.004)
    rows, n = [], 14
    step_x, step_y = (w - 0.02) / n, (d - 0.02) / 5
    for j in range(5):
        for i in range(n):
            if j == 0 and 4 <= i <= 9:
                continue
            x, y = -w / 2 + 0.01 + step_x * (i + 0.5), -d / 2 + 0.01 + step_y * (j + 0.5)
            rows.append((step_x * 0.82, step_y * 0.82, 0.008, x, y, 0.015))
    rows.append((step_x * 5.7, step_y * 0.82, 0.008, -w / 2 + 0.01 + step_x * 7, -d / 2 + 0.01 + step_y * 0.5, 0.015))
    same = chance(rng, 0.35)
    return [
        shell.named("case", tone.main),
        boxes(rows, 0.0).named("key", tone.main.shaded(1.25) if same else caps, 0.55),
    ]


@kind("computer mouse")
def computer_mouse(rng: Rng, tone: Tone) -> list[Piece]:
    body = blob(0.062, 0.11, 0.072, (0, 0, 0), 0.75, 0.9)
    from ..modeling.parts import clipped_below

    return [
        clipped_below(body, 0.0).named("body", tone.main),
        cylinder(0.009, 0.007).turned("y", 90).moved(-0.0035, -0.03, 0.029).named("wheel", tone.plain("#333336")),
        box(0.002, 0.05, 0.002, (0, -0.032, 0.031)).named("seam", tone.plain("#222222")),
    ]


@kind("speaker", palette="dark")
def speaker(rng: Rng, tone: Tone) -> list[Piece]:
    tall = chance(rng, 0.35)
    w, d, h = (
        rng.uniform(0.17, 0.24),
        rng.uniform(0.18, 0.26),
        rng.uniform(0.75, 1.0) if tall else rng.uniform(0.26, 0.38),
    )
    cone = tone.plain(str(rng.choice(["#1b1b1d", "#d9b84a", "#e8e8e6", "#5a5c60"])))
    out = [box(w, d, h, (0, 0, 0), 0.01).named("case", tone.main)]
    spots = (
        [(w * 0.38, h - w * 0.9), (w * 0.22, h - w * 0.28)]
        if not tall
        else [(w * 0.38, h * 0.3), (w * 0.38, h * 0.6), (w * 0.22, h * 0.85)]
    )
    for r, z in spots:
        dish = (
            lathe([(r, 0.0), (r * 0.85, -0.004), (r * 0.3, -0.02), (0, -0.01)], smooth=9)
            .turned("x", 90)
            .moved(0, -d / 2 - 0.006, z)
        )
        out += [dish.named("cone", cone), ring(r, 0.008, (0, -d / 2 - 0.004, z), "y").named("rim", tone.metal())]
    return out


@kind("radio")
def radio(rng: Rng, tone: Tone) -> list[Piece]:
    w, d = rng.uniform(0.24, 0.38), rng.uniform(0.09, 0.14)
    h = w * rng.uniform(0.55, 0.7)
    y = -d / 2 - 0.003
    body = extrude(rounded_rectangle(w, h, rng.uniform(0.01, 0.06)), d, 0.008).turned("x", 90).moved(0, d / 2, h / 2)
    grill = Material((0.86, 0.82, 0.7), "checks", (0.55, 0.5, 0.42), 0.014)
    out = [body.named("case", tone.main)]
    if chance(rng, 0.5):
        out.append(box(w * 0.5, 0.006, h * 0.7, (-w * 0.18, y, h * 0.15), 0.002).named("grill", grill))
    else:
        cover = lathe([(h * 0.34, 0), (h * 0.3, 0.006), (0, 0.006)]).turned("x", 90).moved(-w * 0.18, y, h * 0.5)
        out.append(cover.named("grill", grill))
    out.append(box(w * 0.3, 0.006, h * 0.22, (w * 0.28, y, h * 0.6), 0.002).named("dial", tone.plain("#f6efd8")))
    out += [
        cylinder(h * 0.09, 0.016, bevel=0.003)
        .turned("x", 90)
        .moved(w * x, y, h * 0.32)
        .named("knob", tone.metal(), 1.3)
        for x in (0.2, 0.36)
    ]
    if chance(rng, 0.6):
        out.append(rod((w * 0.42, 0, h), (w * 0.62, 0, h * 1.6), 0.003).named("aerial", tone.metal(), 1.2))
    if chance(rng, 0.5):
        handle = tube([(-w * 0.4, 0, h), (-w * 0.38, 0, h * 1.2), (w * 0.38, 0, h * 1.2), (w * 0.4, 0, h)], 0.007)
        out.append(handle.named("handle", tone.main.shaded(0.7), 1.2))
    return out


@kind("fan")
def fan(rng: Rng, tone: Tone) -> list[Piece]:
    r = rng.uniform(0.15, 0.22)
    z = rng.uniform(0.28, 0.38) if chance(rng, 0.5) else rng.uniform(0.85, 1.1)
    cage = tone.main if chance(rng, 0.5) else tone.metal()
    wires = []
    for a in around(24):
        c, s = np.cos(a), np.sin(a)
        wires.append(
            tube(
                [(0.04 * c, -0.07, 0.04 * s), (r * 0.8 * c, -0.06, r * 0.8 * s), (r * c, 0, r * s)], 0.0022, segments=5
            )
        )
    hoops = [ring(r, 0.006, (0, 0, 0), "y"), ring(r * 0.6, 0.003, (0, -0.065, 0), "y")]
    blades = []
    for k in range(int(rng.choice([3, 4]))):
        one = leaf(r * 0.88, r * 0.75, 0.0, 0.0).turned("x", 20).turned("x", 90)
        blades.append(one.turned("y", k * 360 / (3 if r < 0.18 else 4)))
    head = [
        join(*wires).named("cage", cage, 0.8),
        join(*hoops).named("cage", cage),
        join(*blades).named("blade", tone.main),
        cylinder(0.04, 0.13, bevel=0.01).turned("x", -90).moved(0, -0.03, 0).named("motor", tone.main),
    ]
    out = [p.moved(0, 0, z) for p in head]
    return [
        *out,
        cylinder(r * 0.75, 0.025, (0, 0.06, 0), bevel=0.01).named("base", tone.main),
        rod((0, 0.06, 0.02), (0, 0.06, z), 0.016).named("pole", tone.main, 1.2),
    ]


@kind("telephone")
def telephone(rng: Rng, tone: Tone) -> list[Piece]:
    mat, w = tone.main, rng.uniform(0.17, 0.21)
    base = extrude([(-w / 2, -w * 0.45), (w / 2, -w * 0.45), (w * 0.36, w * 0.4), (-w * 0.36, w * 0.4)], 0.06, 0.015)
    top = cylinder(w * 0.32, 0.035, (0, 0, 0.05), top=w * 0.22)
    grip = tube(
        [(-w * 0.56, 0.03, 0.1), (-w * 0.4, 0.03, 0.125), (w * 0.4, 0.03, 0.125), (w * 0.56, 0.03, 0.1)],
        [0.024, 0.016, 0.016, 0.024],
        smooth=17,
    )
    ends = [cylinder(0.028, 0.035, (s * w * 0.55, 0.03, 0.075), bevel=0.008) for s in (-1, 1)]
    dial = disc(w * 0.26, (0, 0, 0)).turned("x", 25).moved(0, -w * 0.18, 0.085)
    holes = [
        cylinder(0.009, 0.004)
        .turned("x", 25)
        .moved(w * 0.18 * np.cos(a), -w * 0.18 + w * 0.16 * np.sin(a), 0.086 + 0.42 * w * 0.18 * np.sin(a))
        for a in np.linspace(-0.6, 4.2, 10)
    ]
    return [
        base.named("base", mat),
        top.named("cradle", mat),
        join(grip, *ends).named("handset", mat, 1.2),
        dial.named("dial", tone.plain("#f0ead8")),
        join(*holes).named("dial", tone.plain("#26262a"), 1.2),
    ]


@kind("record player", palette="wood")
def record_player(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h = rng.uniform(0.4, 0.48), rng.uniform(0.33, 0.38), rng.uniform(0.09, 0.13)
    out = [
        box(w, d, h, (0, 0, 0.02), 0.008).named("case", tone.main.along(0)),
        tapered_legs(rng, w, d, 0.025, 0.04).named("foot", tone.plain("#222222")),
    ]
    z = h + 0.02
    disc_ = Material((0.07, 0.07, 0.08), "rings", (0.14, 0.14, 0.15), 0.012)
    out += [
        cylinder(d * 0.42, 0.012, (-w * 0.1, 0, z)).moved(w * 0.1, 0, 0).named("platter", disc_).moved(-w * 0.1, 0, 0),
        cylinder(d * 0.13, 0.002, (-w * 0.1, 0, z + 0.012)).named("label", tone.accent()),
        rod((w * 0.38, d * 0.3, z + 0.03), (w * 0.12, -d * 0.1, z + 0.022), 0.005).named("arm", tone.metal(), 1.2),
        cylinder(0.02, 0.03, (w * 0.38, d * 0.3, z)).named("arm", tone.metal()),
    ]
    out += [ball(0.014, (w * 0.38, -d * 0.35, z + 0.006)).named("knob", tone.metal(), 1.2)]
    if chance(rng, 0.5):
        lid = box(w, 0.012, d * 0.9, (0, 0, 0), 0.003).turned("x", -18).moved(0, d / 2, z)
        out.append(lid.named("lid", tone.main.along(0)))
    return out
