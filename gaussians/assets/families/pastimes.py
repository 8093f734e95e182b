"""Builders of furniture and equipment for rest, play and training. Each builder returns the pieces of one design."""

from __future__ import annotations

import numpy as np

from ..modeling.materials import STEEL, Material, Tone
from ..modeling.parts import CORNERS, Rng, chance, polar, shell
from ..modeling.round_shapes import ball, blob, cylinder, disc, rod, tube
from ..modeling.shapes import Piece, box, boxes, join, legs4, panel
from ..registry import kind

Rows = list[tuple[float, ...]]


@kind("beanbag", palette="fabric")
def beanbag(rng: Rng, tone: Tone) -> list[Piece]:
    cloth, w = tone.textile(0.07, 0.8), rng.uniform(0.7, 0.85)
    out = [
        blob(w, w, 0.42, (0, 0, 0.21), 1.0, 0.75).named("seat", cloth),
        blob(w * 0.8, w * 0.5, 0.5, (0, w * 0.22, 0.38), 1.0, 0.8).named("back", cloth),
    ]
    if chance(rng, 0.5):
        loop = tube([(0, w * 0.3, 0.6), (0, w * 0.36, 0.68), (0, w * 0.42, 0.58)], 0.012, smooth=9)
        out.append(loop.named("loop", cloth.shaded(0.7)))
    return out


@kind("crib", palette="wood")
def crib(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(0.7, 0.76), rng.uniform(1.3, 1.38), rng.uniform(0.92, 1.02), tone.main
    bars: Rows = [
        (0.018, 0.018, h - 0.3, s * (w / 2 - 0.02), y, 0.24)
        for s in (-1, 1)
        for y in np.linspace(-d * 0.44, d * 0.44, 13)
    ]
    bars += [
        (0.018, 0.018, h - 0.3, x, s * (d / 2 - 0.02), 0.24)
        for s in (-1, 1)
        for x in np.linspace(-w * 0.38, w * 0.38, 6)
    ]
    rails: Rows = [(0.04, d, 0.045, s * (w / 2 - 0.02), 0, z) for s in (-1, 1) for z in (0.22, h - 0.08)]
    rails += [(w, 0.04, 0.045, 0, s * (d / 2 - 0.02), z) for s in (-1, 1) for z in (0.22, h - 0.08)]
    return [
        legs4(w, d, h, 0.05).named("post", mat.along(2)),
        boxes(rails, 0.008).named("rail", mat.along(1)),
        boxes(bars, 0.002).named("bar", mat.along(2), 0.8),
        box(w - 0.06, d - 0.06, 0.12, (0, 0, 0.28), 0.03).named("mattress", tone.plain("#f5f2ea")),
        box(w - 0.05, d * 0.5, 0.13, (0, -d * 0.2, 0.285), 0.03).named("blanket", tone.accent()),
    ]


@kind("arcade machine")
def arcade_machine(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(0.62, 0.7), rng.uniform(0.76, 0.86), rng.uniform(1.68, 1.8), tone.main
    dark = tone.plain("#1b1c20")
    knobs = [cylinder(0.018, 0.02, (x, -d * 0.4, 0.98)) for x in (0.05, 0.11, 0.17)]
    return [
        box(w, d * 0.8, 0.92, (0, d * 0.1, 0), 0.01).named("body", mat),
        box(w, d * 0.45, h - 0.92, (0, d * 0.27, 0.92), 0.01).named("body", mat),
        box(w * 0.94, d * 0.34, 0.07, (0, -d * 0.32, 0.9), 0.012).named("console", dark),
        box(w, d * 0.3, 0.2, (0, d * 0.0, h - 0.2), 0.01).named("hood", mat),
        panel(w * 0.86, 0.14, (0, -d * 0.155, h - 0.17)).named("sign", Material((1.0, 0.85, 0.3), "glow", (1, 1, 0.9))),
        panel(w * 0.8, 0.5, (0, d * 0.04, 1.0)).named("screen", Material((0.3, 0.2, 0.7), "screen", seed=tone.seed)),
        rod((-0.14, -d * 0.38, 0.96), (-0.14, -d * 0.38, 1.06), 0.008).named("stick", STEEL),
        ball(0.026, (-0.14, -d * 0.38, 1.07)).named("knob", tone.plain("#c8201e")),
        join(*knobs).named("button", tone.plain("#f2d31b")),
        box(w * 0.4, 0.012, 0.3, (0, -d * 0.305, 0.3), 0.004).named("coin door", dark),
    ]


@kind("dart board")
def dart_board(rng: Rng, tone: Tone) -> list[Piece]:
    r, cream = rng.uniform(0.22, 0.27), tone.plain("#eadfbf")
    black = Material(tone.color if tone.asked else (0.1, 0.1, 0.11), main=True)
    tone.color = black.color
    out = [cylinder(r, 0.035, bevel=0.004).named("rim", black)]
    for k in range(20):
        a, b = 2 * np.pi * k / 20, 2 * np.pi * (k + 1) / 20
        for lo, hi, tints in (
            (0.02, 0.1, (cream, black)),
            (0.1, 0.112, ("r", "g")),
            (0.112, 0.16, (cream, black)),
            (0.16, 0.172, ("r", "g")),
        ):
            mat = tints[k % 2]
            mat = mat if isinstance(mat, Material) else tone.plain("#c8201e" if mat == "r" else "#2f7d46")
            from_to = [[polar(q, a, 0.037), polar(q, b, 0.037)] for q in (lo, hi)]
            out.append(shell(np.array(from_to)).named("segment", mat, 0.7))
    out.append(disc(0.02, (0, 0, 0.038)).named("bull", tone.plain("#c8201e")))
    out.append(
        join(
            *(rod((x, z, 0.035), (x + 0.01, z, 0.1), 0.003) for x, z in ((0.03, 0.05), (-0.06, 0.08), (0.08, -0.04)))
        ).named("dart", tone.plain("#f2c53d"), 0.8)
    )
    return [p.turned("x", 90).moved(0, 0, r) for p in out]


@kind("dumbbell rack", palette="dark")
def dumbbell_rack(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(1.15, 1.45), rng.uniform(0.5, 0.58), rng.uniform(0.75, 0.88), tone.main
    rows: Rows = [(0.05, d, 0.05, s * (w / 2 - 0.03), 0, 0) for s in (-1, 1)] + [
        (0.05, 0.06, h, s * (w / 2 - 0.03), d * 0.3, 0) for s in (-1, 1)
    ]
    iron, grips, ends = tone.plain("#26272a"), [], []
    for k in range(2):
        y, z = d * (0.16 - 0.34 * (1 - k)), h * (0.38 + 0.52 * k)
        rows += [(w, 0.05, 0.03, 0, y + s * 0.09, z - 0.03) for s in (-1, 1)]
        rows += [(0.04, d * 0.6, 0.04, s * (w / 2 - 0.03), y + 0.1, z - 0.06) for s in (-1, 1)]
        for x in np.linspace(-w * 0.4, w * 0.4, 7):
            r = 0.05 - 0.006 * k
            grips.append(rod((x, y - 0.1, z + r * 0.9), (x, y + 0.1, z + r * 0.9), 0.014))
            ends += [
                cylinder(r, 0.06, bevel=0.008).turned("x", 90).moved(x, y + s * 0.1 + 0.03, z + r * 0.9)
                for s in (-1, 1)
            ]
    return [
        boxes(rows, 0.006).named("frame", mat),
        join(*grips).named("grip", STEEL, 0.8),
        join(*ends).named("weight", iron, 0.8),
    ]


@kind("aquarium", palette="dark")
def aquarium(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat, t = rng.uniform(0.7, 0.95), rng.uniform(0.34, 0.4), rng.uniform(0.4, 0.46), tone.main, 0.025
    back = Material((0.3, 0.62, 0.82), "glass", (0.62, 0.86, 0.95))
    posts: Rows = [(t, t, h, sx * (w - t) / 2, sy * (d - t) / 2, 0) for sx, sy in CORNERS]
    weed = [
        rod((x, y, 0.06), (x + rng.uniform(-0.05, 0.05), y, h * rng.uniform(0.4, 0.75)), 0.012, 0.003)
        for x, y in zip(rng.uniform(-0.4, 0.4, 9) * w, rng.uniform(-0.1, 0.35, 9) * d, strict=True)
    ]
    out = [
        box(w, d, 0.05, (0, 0, 0), 0.006).named("base", mat),
        box(w, d, 0.06, (0, 0, h - 0.06), 0.008).named("lid", mat),
        boxes(posts).named("frame", mat),
        box(w - t, 0.008, h - 0.1, (0, d / 2 - 0.02, 0.05), 0.0).named("water", back),
        box(w - t, d - t, 0.03, (0, 0, 0.05), 0.008).named("gravel", Material((0.85, 0.74, 0.55), "fur")),
        join(*weed).named("weed", tone.plain("#2f8a3a")),
    ]
    for k in range(6):
        x, y, z = rng.uniform(-0.38, 0.38) * w, rng.uniform(-0.3, 0.2) * d, rng.uniform(0.3, 0.75) * h
        out.append(
            blob(0.06, 0.02, 0.035, (x, y, z)).named("fish", tone.plain(("#f07c1c", "#f2d31b", "#c8201e")[k % 3]))
        )
    return out
