"""Builders of fixtures at walls: windows, doors, curtains, radiators. Each builder returns the pieces of one design."""

from __future__ import annotations

import numpy as np

from ..modeling.materials import Material, Tone, mix
from ..modeling.parts import Rng, chance
from ..modeling.round_shapes import ball, blob, cylinder, lathe, ring, rod
from ..modeling.shapes import Piece, box, boxes, join, panel, surface
from ..registry import kind


@kind("window", palette="wood")
def window(rng: Rng, tone: Tone) -> list[Piece]:
    w, h, t = rng.uniform(0.8, 1.6), rng.uniform(1.0, 1.45), rng.uniform(0.045, 0.07)
    frame = tone.main
    if chance(rng, 0.5) and not tone.asked:
        frame = Material((0.95, 0.95, 0.93), main=True)
        tone.color = frame.color
    rows = [
        (w, 0.07, t, 0, 0, 0),
        (w, 0.07, t, 0, 0, h - t),
        (t, 0.07, h, w / 2 - t / 2, 0, 0),
        (t, 0.07, h, -w / 2 + t / 2, 0, 0),
    ]
    nx, nz = int(rng.integers(1, 4)), int(rng.integers(1, 4))
    rows += [(0.03, 0.05, h - 2 * t, -w / 2 + w * k / nx, 0, t) for k in range(1, nx)]
    rows += [(w - 2 * t, 0.05, 0.03, 0, 0, h * k / nz - 0.015) for k in range(1, nz)]
    out = [
        boxes(rows, 0.006).named("frame", frame),
        panel(w - t, h - t, (0, 0.01, t / 2)).named("glass", Material((0.7, 0.85, 0.95), "sky", seed=tone.seed)),
    ]
    if chance(rng, 0.7):
        out.append(box(w + 0.1, 0.2, 0.03, (0, -0.08, -0.03), 0.008).named("sill", frame))
    return out


@kind("door", palette="wood")
def door(rng: Rng, tone: Tone) -> list[Piece]:
    w, h, mat, style = rng.uniform(0.76, 0.92), rng.uniform(1.96, 2.1), tone.main.along(2), int(rng.integers(5))
    trim = mat.shaded(0.85) if chance(rng, 0.5) else tone.plain("#efeeea")
    side, y = (-1 if chance(rng, 0.5) else 1), -0.025
    out = [
        box(w, 0.045, h, (0, 0, 0), 0.004).named("leaf", mat),
        boxes(
            [(0.09, 0.07, h + 0.09, s * (w / 2 + 0.045), 0, 0) for s in (-1, 1)] + [(w, 0.07, 0.09, 0, 0, h)], 0.006
        ).named("frame", trim),
    ]
    inner = mat.shaded(0.82)
    if style == 0:
        out.append(
            boxes(
                [
                    (w * 0.34, 0.012, hh, s * w * 0.21, y, z)
                    for s in (-1, 1)
                    for z, hh in ((0.15, h * 0.32), (h * 0.5, h * 0.42))
                ],
                0.005,
            ).named("panel", inner)
        )
    elif style == 1:
        panels = boxes([(w * 0.7, 0.012, h * 0.2, 0, y, h * (0.06 + 0.235 * k)) for k in range(4)], 0.005)
        out.append(panels.named("panel", inner))
    elif style == 2:
        glass = panel(w * 0.62, h * 0.36, (0, y - 0.004, h * 0.56))
        out += [
            glass.named("glass", Material((0.72, 0.84, 0.88), "glass", (0.93, 0.97, 0.98))),
            boxes(
                [(w * 0.62, 0.02, 0.02, 0, y, h * z) for z in (0.55, 0.735, 0.92)]
                + [(0.02, 0.02, h * 0.37, x * w * 0.31, y, h * 0.555) for x in (-1, 0, 1)]
            ).named("bar", mat),
            box(w * 0.62, 0.012, h * 0.34, (0, y, h * 0.12)).named("panel", inner),
        ]
    elif style == 3:
        groove = boxes([(0.008, 0.006, h * 0.96, x * w, y + 0.001, h * 0.02) for x in np.linspace(-0.4, 0.4, 6)], 0.001)
        out.append(groove.named("groove", inner))
    metal = tone.metal()
    x = side * (w / 2 - 0.07)
    if chance(rng, 0.5):
        out += [ball(0.03, (x, y - 0.04, 1.0)).named("knob", metal, 1.4)]
    else:
        out += [
            box(0.04, 0.012, 0.18, (x, y - 0.004, 0.92)).named("plate", metal, 1.2),
            rod((x, y - 0.035, 1.02), (x - side * 0.12, y - 0.035, 1.02), 0.011).named("handle", metal, 1.4),
        ]
    return out


@kind("curtain", palette="fabric")
def curtain(rng: Rng, tone: Tone) -> list[Piece]:
    w, h, mat = rng.uniform(1.2, 1.9), rng.uniform(1.5, 2.2), tone.textile(0.14, 0.6)
    closed = chance(rng, 0.25)
    share = 0.5 if closed else rng.uniform(0.2, 0.36)
    gather = rng.uniform(0, 0.5) if not closed else 0.0
    out = []
    for s in (-1, 1):
        t, u = np.linspace(0, 1, 13)[:, None], np.linspace(0, 1, 41)[None]
        width = w * share * (1 - gather * np.exp(-(((t - 0.45) / 0.2) ** 2)))
        x = s * (w / 2 - u * width)
        folds = 0.03 * np.sin(2 * np.pi * u * rng.uniform(5, 8) + 1.5 * t) * (0.6 + 0.4 * (1 - t))
        grid = np.stack([x, folds + 0 * t, h * t + 0 * u], -1)
        out.append(surface(grid if s < 0 else grid[:, ::-1]).named("cloth", mat))
        if gather > 0.2:
            out.append(
                ring(
                    w * share * 0.28, 0.014, (s * (w / 2 - w * share * (1 - gather) / 2), 0, h * 0.45), squash=0.35
                ).named("tieback", mat.shaded(0.6))
            )
    metal = tone.frame()
    out += [
        rod((-w / 2 - 0.08, 0, h + 0.02), (w / 2 + 0.08, 0, h + 0.02), 0.014).named("rod", metal, 1.2),
        *(ball(0.03, (s * (w / 2 + 0.09), 0, h + 0.02)).named("finial", metal, 1.2) for s in (-1, 1)),
    ]
    return out


@kind("radiator", palette="appliance")
def radiator(rng: Rng, tone: Tone) -> list[Piece]:
    w, h, mat, foot = rng.uniform(0.7, 1.2), rng.uniform(0.45, 0.62), tone.main, 0.1
    if chance(rng, 0.5):
        n = int(w / 0.065)
        ribs = [blob(0.05, 0.12, h, ((k + 0.5 - n / 2) * 0.065, 0, foot + h / 2), 0.7, 0.35) for k in range(n)]
        pipes = [rod((-w / 2, 0, foot + z), (w / 2, 0, foot + z), 0.018) for z in (0.05, h - 0.05)]
        out = [join(*ribs).named("rib", mat, 0.7), join(*pipes).named("pipe", mat)]
    else:
        out = [
            box(w, 0.08, h, (0, 0, foot), 0.01).named("panel", mat),
            boxes(
                [
                    (0.018, 0.01, h * 0.88, x, -0.043, foot + h * 0.06)
                    for x in np.linspace(-w * 0.46, w * 0.46, int(w / 0.055))
                ],
                0.003,
            ).named("rib", mat.shaded(0.88), 0.8),
        ]
    valve = cylinder(0.02, 0.06, bevel=0.005).turned("y", 90).moved(w / 2, 0, foot + 0.06)
    return [
        *out,
        boxes([(0.03, 0.05, foot + 0.02, s * w * 0.4, 0, 0) for s in (-1, 1)]).named("foot", mat),
        valve.named("valve", tone.plain("#f0f0ee"), 1.2),
    ]


@kind("fireplace")
def fireplace(rng: Rng, tone: Tone) -> list[Piece]:
    w, h, d = rng.uniform(1.15, 1.5), rng.uniform(1.0, 1.2), rng.uniform(0.3, 0.42)
    stone = Material(
        tone.color,
        str(rng.choice(["plain", "marble", "checks"])),
        mix(tone.color, tone.second, 0.35),
        0.12,
        seed=tone.seed,
        main=True,
    )
    pw, oh = w * 0.22, h * 0.68
    iw = w - 2 * pw
    surround = boxes([(pw, d, h, s * (w - pw) / 2, 0, 0) for s in (-1, 1)] + [(iw, d, h - oh, 0, 0, oh)], 0.008)
    mantel = box(w + 0.16, d + 0.08, 0.06, (0, -0.03, h), 0.012)
    out = [
        surround.named("surround", stone),
        mantel.named("mantel", stone if chance(rng, 0.5) else tone.wood().along(0)),
        box(w + 0.1, d + 0.2, 0.03, (0, -0.1, 0), 0.006).named("hearth", tone.plain("#4a4644")),
    ]
    soot = tone.plain("#1c1816")
    out += [
        box(iw, 0.03, oh, (0, d / 2 - 0.02, 0.03)).named("inside", soot),
        *(box(0.02, d - 0.04, oh, (s * (iw / 2 - 0.01), 0, 0.03)).named("inside", soot) for s in (-1, 1)),
    ]
    logs = [
        rod((-iw * 0.32, y, z), (iw * 0.32, y + dy, z), 0.045)
        for y, dy, z in ((-0.05, 0.04, 0.09), (0.07, -0.04, 0.09), (0.0, 0.02, 0.17))
    ]
    out.append(join(*logs).named("log", Material((0.35, 0.22, 0.12), "wood", axis=0)))
    if chance(rng, 0.6):
        fire = Material((1.0, 0.55, 0.1), "glow", (1.0, 0.9, 0.4))
        flames = [
            lathe([(0.03, 0), (0.05, 0.06), (0.02, 0.16), (0, 0.24)], (x, 0.0, 0.17), smooth=9)
            for x in (-0.14, 0.0, 0.13)
        ]
        out.append(join(*flames).named("fire", fire))
    return out


@kind("folding screen")
def folding_screen(rng: Rng, tone: Tone) -> list[Piece]:
    n, h, w = int(rng.integers(3, 5)), rng.uniform(1.5, 1.8), rng.uniform(0.4, 0.48)
    cloth, wood = tone.textile(0.15, 0.4), tone.wood()
    out, x, y = [], 0.0, 0.0
    for k in range(n):
        turn = 28 if k % 2 else -28
        rows = [
            (w, 0.025, 0.05, 0, 0, 0.08),
            (w, 0.025, 0.05, 0, 0, h - 0.05),
            (0.035, 0.025, h, w / 2 - 0.018, 0, 0),
            (0.035, 0.025, h, -w / 2 + 0.018, 0, 0),
        ]
        leaf_ = [
            boxes(rows).named("frame", wood),
            box(w - 0.06, 0.01, h - 0.16, (0, 0, 0.12), 0.002).named("panel", cloth),
        ]
        dx, dy = w * np.cos(np.radians(turn)), w * np.sin(np.radians(turn))
        out += [p.turned("z", turn).moved(x + dx / 2, y + dy / 2) for p in leaf_]
        x, y = x + dx, y + dy
    return out
