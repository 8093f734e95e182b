"""Builders of furniture of offices, schools and halls: boards, lockers, machines, a stage."""

from __future__ import annotations

import numpy as np

from ..modeling.materials import STEEL, Material, Tone
from ..modeling.parts import Rng, chance
from ..modeling.round_shapes import lathe, rod
from ..modeling.shapes import Piece, box, boxes, join, panel
from ..registry import kind

Rows = list[tuple[float, ...]]


@kind("printer", palette="appliance")
def printer(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(0.4, 0.46), rng.uniform(0.36, 0.42), rng.uniform(0.24, 0.32), tone.main
    dark = tone.plain("#2a2c30")
    display = panel(w * 0.26, h * 0.14, (w * 0.28, -d / 2 - 0.002, h * 0.6))
    return [
        box(w, d, h * 0.8, (0, 0, 0), 0.015).named("body", mat),
        box(w * 0.96, d * 0.9, h * 0.14, (0, 0.01, h * 0.82), 0.012).named("lid", mat.shaded(0.9)),
        box(w * 0.8, 0.02, h * 0.16, (0, -d / 2 + 0.005, h * 0.38), 0.004).named("slot", dark),
        box(w * 0.62, d * 0.35, 0.012, (0, -d * 0.58, h * 0.36), 0.003).named("tray", mat.shaded(0.8)),
        box(w * 0.55, d * 0.3, 0.006, (0, -d * 0.58, h * 0.37 + 0.01), 0.0).named("paper", tone.plain("#fbfbf9")),
        display.named("display", Material((0.2, 0.5, 0.75), "screen", seed=2)),
    ]


@kind("bulletin board", palette="wood")
def bulletin_board(rng: Rng, tone: Tone) -> list[Piece]:
    w, h, t = rng.uniform(0.95, 1.15), rng.uniform(0.65, 0.85), 0.035
    cork = Material(tone.color if tone.asked else (0.76, 0.58, 0.38), "fur", main=True)
    tone.color = cork.color
    bars: Rows = [(w, 0.03, t, 0, 0, z) for z in (0.0, h - t)] + [(t, 0.03, h, s * (w - t) / 2, 0, 0) for s in (-1, 1)]
    out = [
        boxes(bars, 0.004).named("frame", tone.wood()),
        box(w - t, 0.018, h - t, (0, 0, t / 2), 0.0).named("board", cork),
    ]
    tints = ("#f7f4ea", "#f2e27a", "#bfe0f2", "#f5b8c4", "#d5ecc2")
    for k in range(int(rng.integers(6, 10))):
        x, z = rng.uniform(-0.38, 0.38) * w, rng.uniform(0.12, 0.7) * h
        note = panel(rng.uniform(0.08, 0.16), rng.uniform(0.08, 0.18), (x, -0.012 - 0.001 * k, z))
        out.append(note.named("note", tone.plain(tints[k % len(tints)]), 1.2))
    return out


@kind("locker")
def locker(rng: Rng, tone: Tone) -> list[Piece]:
    n, d, h, mat = int(rng.integers(2, 4)), rng.uniform(0.45, 0.5), rng.uniform(1.78, 1.9), tone.main
    w = n * 0.31
    out = [
        box(w, d, h, (0, 0, 0), 0.006).named("body", mat),
        box(w * 0.98, d * 0.95, 0.08, (0, 0.01, 0), 0.0).named("plinth", mat.shaded(0.5)),
    ]
    doors: Rows = [(0.29, 0.014, h - 0.14, (k - (n - 1) / 2) * 0.31, -d / 2 - 0.003, 0.11) for k in range(n)]
    slots: Rows = [
        (0.16, 0.004, 0.012, (k - (n - 1) / 2) * 0.31, -d / 2 - 0.012, z)
        for k in range(n)
        for z in (h - 0.2, h - 0.24, h - 0.28, 0.3, 0.34)
    ]
    pulls: Rows = [(0.02, 0.02, 0.1, (k - (n - 1) / 2) * 0.31 + 0.11, -d / 2 - 0.018, h * 0.52) for k in range(n)]
    return [
        *out,
        boxes(doors, 0.004).named("door", mat.shaded(1.1)),
        boxes(slots, 0.0).named("slot", mat.shaded(0.35), 1.2),
        boxes(pulls).named("handle", STEEL),
    ]


@kind("cubby", palette="wood")
def cubby(rng: Rng, tone: Tone) -> list[Piece]:
    nx, nz, side, mat = int(rng.integers(2, 5)), int(rng.integers(2, 4)), rng.uniform(0.3, 0.36), tone.main
    w, h, d, t = nx * side, nz * side, rng.uniform(0.34, 0.4), 0.022
    rows: Rows = [(w, d, t, 0, 0, min(k * side, h - t)) for k in range(nz + 1)]
    rows += [(t, d - 0.004, h, -w / 2 + min(max(k * side, t / 2), w - t / 2), 0, 0) for k in range(nx + 1)]
    out = [boxes([*rows, (w, 0.01, h, 0, d / 2 - 0.006, 0)], 0.002).named("shelf", mat)]
    for i in range(nx):
        for k in range(nz):
            if chance(rng, 0.65):
                x, z, high = -w / 2 + (i + 0.5) * side, k * side + t, side * rng.uniform(0.5, 0.75)
                out.append(box(side * 0.78, d * 0.8, high, (x, -0.02, z), 0.012).named("bin", tone.accent()))
    return out


@kind("water cooler", palette="appliance")
def water_cooler(rng: Rng, tone: Tone) -> list[Piece]:
    mat, h = tone.in_white(), rng.uniform(0.92, 1.0)
    water = Material((0.45, 0.7, 0.9), "glass", (0.8, 0.92, 0.98))
    jug = lathe(
        [(0.05, 0.0), (0.06, 0.04), (0.13, 0.1), (0.135, 0.2), (0.13, 0.34), (0.09, 0.36), (0, 0.36)],
        (0, 0, h),
        smooth=21,
    )
    return [
        box(0.32, 0.32, h, (0, 0, 0), 0.03).named("body", mat),
        jug.named("jug", water),
        box(0.22, 0.02, 0.24, (0, -0.155, h * 0.62), 0.008).named("niche", tone.plain("#3a3d42")),
        *(
            box(0.025, 0.05, 0.03, (s * 0.045, -0.18, h * 0.8), 0.006).named("tap", tone.plain(c))
            for s, c in ((-1, "#2a5ac8"), (1, "#c8201e"))
        ),
        box(0.2, 0.07, 0.02, (0, -0.18, h * 0.6), 0.004).named("tray", STEEL),
    ]


@kind("sign")
def sign(rng: Rng, tone: Tone) -> list[Piece]:
    w, h, mat = rng.uniform(0.65, 1.05), rng.uniform(0.32, 0.46), tone.main
    pale = Material(tone.second)
    letters: Rows = []
    x = -w * 0.36
    while x < w * 0.34:
        wide, high = rng.uniform(0.04, 0.07), h * rng.uniform(0.3, 0.42)
        letters += [
            (0.016, 0.01, high, x, -0.022, h * 0.32),
            (wide, 0.01, 0.016, x + wide / 2, -0.022, h * 0.32 + high * float(rng.choice([0, 0.5, 0.95]))),
        ]
        x += wide + 0.04
    return [
        box(w, 0.03, h, (0, 0, 0), 0.01).named("plate", mat),
        boxes([(w * 0.95, 0.006, 0.012, 0, -0.017, z * h) for z in (0.08, 0.9)]).named("line", pale),
        boxes(letters, 0.002).named("letter", pale, 1.3),
    ]


@kind("ladder", palette="wood")
def ladder(rng: Rng, tone: Tone) -> list[Piece]:
    w, h, mat = rng.uniform(0.42, 0.5), rng.uniform(1.8, 2.1), tone.main
    lean = 0.12
    sides = [rod((s * w / 2, -lean, 0), (s * w * 0.42, lean, h), 0.022) for s in (-1, 1)]
    rungs = [
        rod((-w * 0.47, -lean + 2 * lean * f, h * f), (w * 0.47, -lean + 2 * lean * f, h * f), 0.016)
        for f in np.linspace(0.12, 0.92, 6)
    ]
    return [join(*sides).named("side", mat), join(*rungs).named("rung", mat)]


@kind("stage", palette="wood")
def stage(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(2.4, 3.0), rng.uniform(1.4, 1.8), rng.uniform(0.28, 0.4), tone.main
    boards = Material(mat.color, "planks", mat.second, 0.15, 0, tone.seed, True)
    return [
        box(w, d, 0.04, (0, 0, h - 0.04), 0.008).named("deck", boards),
        box(w - 0.04, d - 0.04, h - 0.04, (0, 0, 0), 0.004).named("skirt", tone.plain("#232326")),
        box(0.7, 0.3, h / 2, (w * 0.3, -d / 2 - 0.15, 0), 0.006).named("step", boards),
    ]
