"""Builders of furniture of game rooms, gyms, class rooms and children's rooms. Each returns one design's pieces."""

from __future__ import annotations

import numpy as np

from ..modeling.materials import Material, Tone
from ..modeling.parts import CORNERS, Rng, chance, tapered_legs
from ..modeling.round_shapes import ball, cushion, cylinder, disc, rod
from ..modeling.shapes import Piece, box, boxes, join, legs4, panel
from ..registry import kind


@kind("whiteboard", palette="light")
def whiteboard(rng: Rng, tone: Tone) -> list[Piece]:
    w, h, t = rng.uniform(1.2, 2.0), rng.uniform(0.85, 1.15), 0.03
    face = Material(tone.color if tone.asked else (0.96, 0.97, 0.97), main=True)
    tone.color = face.color
    steel = Material((0.75, 0.76, 0.78), "brushed")
    bars: list[tuple[float, ...]] = [(w, 0.03, t, 0, 0, z) for z in (0.0, h - t)]
    bars += [(t, 0.03, h - 2 * t, s * (w - t) / 2, 0, t) for s in (-1, 1)]
    inks = [tone.plain(c) for c in ("#2a5ac8", "#c8201e", "#23262b")]
    out = [
        boxes(bars, 0.004).named("frame", steel),
        box(w - t, 0.016, h - t, (0, 0, t / 2), 0.0).named("board", face),
        box(w * 0.5, 0.06, 0.015, (0, -0.035, 0.0), 0.004).named("tray", steel),
    ]
    for ink in inks[: int(rng.integers(1, 4))]:
        x, z = rng.uniform(-0.3, 0.1) * w, rng.uniform(0.35, 0.75) * h
        lines = [(w * rng.uniform(0.12, 0.3), 0.003, 0.016, x, -0.011, z - 0.07 * k) for k in range(3)]
        out.append(boxes(lines, 0.0).named("writing", ink, 1.2))
    pens = [rod((x, -0.04, 0.024), (x + 0.11, -0.04, 0.024), 0.008) for x in (-0.2, 0.0, 0.15)]
    return [*out, join(*pens).named("pen", inks[0])]


@kind("treadmill", palette="dark")
def treadmill(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(0.74, 0.84), rng.uniform(1.6, 1.85), rng.uniform(1.3, 1.42), tone.main
    black, steel = tone.plain("#1d1d1f"), Material((0.7, 0.71, 0.73), "brushed")
    head = d / 2 - 0.28  # the console is at the back: its user faces +y, away from a viewer in front
    posts = [rod((s * (w / 2 - 0.05), head, 0.12), (s * (w / 2 - 0.08), head - 0.06, h - 0.1), 0.032) for s in (-1, 1)]
    rails = [
        rod((s * (w / 2 - 0.08), head - 0.05, h - 0.2), (s * (w / 2 - 0.08), head - 0.55, h - 0.35), 0.022)
        for s in (-1, 1)
    ]
    console = box(w * 0.82, 0.05, 0.3, (0, 0, 0), 0.015).named("console", mat)
    screen = panel(w * 0.5, 0.2, (0, -0.028, 0.06)).named(
        "screen", Material((0.15, 0.5, 0.75), "screen", seed=tone.seed)
    )
    foot = boxes([(0.08, 0.08, 0.03, s * (w / 2 - 0.06), y, 0) for s in (-1, 1) for y in (-d * 0.42, d * 0.42)])
    return [
        boxes([(0.1, d, 0.13, s * (w / 2 - 0.05), 0, 0.03) for s in (-1, 1)], 0.02).named("side", mat),
        box(w - 0.18, d - 0.06, 0.05, (0, 0, 0.1), 0.01).named("belt", black),
        box(w * 0.84, 0.34, 0.2, (0, d / 2 - 0.17, 0.05), 0.05).named("hood", mat),
        foot.named("foot", black),
        join(*posts).named("post", steel),
        join(*rails).named("handle", black),
        *(p.turned("x", -22).moved(0, head - 0.08, h - 0.3) for p in (console, screen)),
    ]


@kind("pool table", palette="leaf")
def pool_table(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h = rng.uniform(2.2, 2.6), rng.uniform(1.2, 1.4), rng.uniform(0.78, 0.84)
    cloth, wood = Material(tone.color, "flat", seed=tone.seed, main=True), tone.wood()
    t, black = 0.13, tone.plain("#17171a")
    rails: list[tuple[float, ...]] = [(w, t, 0.1, 0, s * (d - t) / 2, h - 0.1) for s in (-1, 1)] + [
        (t, d - 2 * t, 0.1, s * (w - t) / 2, 0, h - 0.1) for s in (-1, 1)
    ]
    edge: list[tuple[float, ...]] = [(w - 2 * t, 0.04, 0.05, 0, s * (d / 2 - t - 0.02), h - 0.09) for s in (-1, 1)]
    edge += [(0.04, d - 2 * t, 0.05, s * (w / 2 - t - 0.02), 0, h - 0.09) for s in (-1, 1)]
    holes = [disc(0.06, (x, y * (d / 2 - t + 0.005), h + 0.002)) for x in (-w / 2 + t, 0.0, w / 2 - t) for y in (-1, 1)]
    leg = 0.17 if chance(rng, 0.5) else 0.12
    out = [
        box(w - 2 * t + 0.04, d - 2 * t + 0.04, 0.06, (0, 0, h - 0.115), 0.0).named("cloth", cloth),
        boxes(edge, 0.01).named("cushion", cloth),
        boxes(rails, 0.02).named("rail", wood.along(0)),
        box(w - 0.1, d - 0.1, 0.2, (0, 0, h - 0.3), 0.02).named("body", wood.along(0)),
        legs4(w - 0.3, d - 0.3, h - 0.28, leg).named("leg", wood),
        join(*holes).named("pocket", black, 1.4),
    ]
    tints = ("#f2d31b", "#2a5ac8", "#c8201e", "#7d3fa6", "#f07c1c", "#2f7d46", "#8f2430", "#18181a", "#f4f2ea")
    for tint in tints:
        x, y = rng.uniform(-0.38, 0.38) * w, rng.uniform(-0.3, 0.3) * d
        out.append(ball(0.03, (x, y, h - 0.025)).named("ball", tone.plain(tint), 0.8))
    if chance(rng, 0.6):
        out.append(
            rod((-w * 0.3, -d * 0.1, h - 0.02), (w * 0.25, d * 0.28, h + 0.04), 0.011, 0.006).named("cue", tone.wood())
        )
    return out


@kind("ping pong table")
def ping_pong_table(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, white = 2.74, 1.525, 0.76, tone.plain("#f4f4f1")
    if not tone.asked:
        tone.color = ((0.12, 0.3, 0.55), (0.13, 0.4, 0.28), (0.16, 0.2, 0.3))[int(rng.integers(3))]
    top, black = Material(tone.color, "flat", main=True), tone.plain("#202123")
    lines: list[tuple[float, ...]] = [(w, 0.025, 0.004, 0, s * (d / 2 - 0.0125), h) for s in (-1, 1)] + [
        (0.025, d, 0.004, s * (w / 2 - 0.0125), 0, h) for s in (-1, 1)
    ]
    lines.append((w, 0.012, 0.004, 0, 0, h))
    net = Material((0.9, 0.9, 0.9), "checks", (0.25, 0.27, 0.3), 0.02)
    leg = boxes([(0.05, 0.05, h - 0.06, sx * w * k, sy * d * 0.36, 0) for sx, sy in CORNERS for k in (0.12, 0.42)])
    beam = boxes([(0.05, d * 0.8, 0.05, s * w * k, 0, h - 0.09) for s in (-1, 1) for k in (0.12, 0.42)])
    out = [
        box(w, d, 0.03, (0, 0, h - 0.03), 0.004).named("top", top),
        boxes(lines, 0.0).named("line", white, 1.3),
        box(0.008, d + 0.2, 0.13, (0, 0, h + 0.015), 0.0).named("net", net),
        box(0.012, d + 0.2, 0.015, (0, 0, h + 0.14), 0.0).named("tape", white),
        beam.named("beam", black),
        leg.named("leg", black),
    ]
    bat = tone.plain("#c8201e") if chance(rng, 0.5) else black
    for s in (-1, 1):
        x, y = s * w * rng.uniform(0.28, 0.4), rng.uniform(-0.25, 0.25) * d
        out.append(cylinder(0.078, 0.014, (x, y, h + 0.002)).named("bat", bat))
        out.append(box(0.1, 0.026, 0.018, (x + s * 0.12, y, h + 0.002), 0.005).named("handle", tone.wood()))
    return [*out, ball(0.02, (w * 0.2, d * 0.1, h + 0.02)).named("ball", white)]


@kind("foosball table", palette="wood")
def foosball_table(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(1.3, 1.45), rng.uniform(0.7, 0.78), rng.uniform(0.88, 0.94), tone.main
    steel, t = Material((0.75, 0.76, 0.78), "brushed"), 0.035
    walls = [(w, t, 0.24, 0, s * (d - t) / 2, h - 0.24) for s in (-1, 1)] + [
        (t, d, 0.24, s * (w - t) / 2, 0, h - 0.24) for s in (-1, 1)
    ]
    field, white = tone.plain("#3c8a46", "flat"), tone.plain("#f2f2ee")
    out = [
        boxes(walls, 0.008).named("side", mat.along(0)),
        box(w - 0.05, d - 0.05, 0.02, (0, 0, h - 0.16), 0.0).named("field", field),
        boxes([(0.02, d - 0.08, 0.003, 0, 0, h - 0.14)]).named("line", white),
        box(w - 0.1, d - 0.1, 0.06, (0, 0, h - 0.28), 0.0).named("under", mat.shaded(0.7)),
        legs4(w - 0.06, d - 0.06, h - 0.22, 0.09).named("leg", mat),
    ]
    rods, teams = [], ([], [])  # type: tuple[list[Piece], tuple[list[Piece], list[Piece]]]
    for k in range(8):
        x, side = (k - 3.5) * w * 0.112, 1 if k in (0, 1, 3, 5) else -1
        rods.append(rod((x, -d / 2 - 0.16, h - 0.06), (x, d / 2 + 0.16, h - 0.06), 0.008))
        rods.append(rod((x, side * (d / 2 + 0.08), h - 0.06), (x, side * (d / 2 + 0.2), h - 0.06), 0.018))
        count = {0: 1, 7: 1, 1: 2, 6: 2}.get(k, 4)
        men = [box(0.026, 0.03, 0.1, (x, (j - (count - 1) / 2) * d * 0.2, h - 0.13), 0.008) for j in range(count)]
        teams[side > 0].extend(men)
    return [
        *out,
        join(*rods).named("rod", steel),
        join(*teams[0]).named("player", tone.plain("#c8201e"), 0.8),
        join(*teams[1]).named("player", tone.plain("#2a5ac8"), 0.8),
    ]


@kind("bunk bed", palette="wood")
def bunk_bed(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(1.02, 1.15), rng.uniform(2.0, 2.12), rng.uniform(1.58, 1.8), tone.main
    t, linen = rng.uniform(0.06, 0.08), tone.plain("#f3f0e8")
    spreads = [tone.accent(), tone.accent()]
    out = [legs4(w, d, h, t).named("post", mat.along(2))]
    for k, z in enumerate((0.28, h * 0.68)):
        rails: list[tuple[float, ...]] = [(t * 0.5, d - 2 * t, 0.12, s * (w / 2 - t / 4), 0, z) for s in (-1, 1)]
        rails += [(w - 2 * t, t * 0.5, 0.12, 0, s * (d / 2 - t / 4), z) for s in (-1, 1)]
        out += [
            boxes(rails, 0.006).named("frame", mat.along(1)),
            cushion(w - t, d - t, 0.17, (0, 0, z + 0.05), 0.12).named("mattress", linen),
            cushion(w - t + 0.02, d * 0.6, 0.19, (0, -d * 0.16, z + 0.055), 0.12).named("blanket", spreads[k]),
            cushion(w * 0.6, 0.36, 0.12, (0, d / 2 - 0.3, z + 0.19), 0.3).named("pillow", linen),
        ]
    ends: list[tuple[float, ...]] = [
        (w - 2 * t, 0.025, 0.07, 0, s * (d / 2 - t / 2), z) for s in (-1, 1) for z in (0.5, h * 0.84, h - 0.1)
    ]
    guards: list[tuple[float, ...]] = [
        (0.025, d * (0.62 if s < 0 else 0.96), 0.07, s * (w / 2 - t / 2), d * 0.16 if s < 0 else 0, z)
        for s in (-1, 1)
        for z in (h * 0.88, h - 0.08)
    ]
    out.append(boxes(ends + guards, 0.006).named("guard", mat))
    side, at = -w / 2 - 0.02, -d * 0.38
    rungs = [rod((side, at - 0.16, z), (side, at + 0.16, z), 0.017) for z in np.linspace(0.25, h * 0.72, 5)]
    sides = [(0.03, 0.04, h * 0.92, side, at + s * 0.17, 0) for s in (-1, 1)]
    return [*out, boxes(sides, 0.006).named("ladder", mat), join(*rungs).named("rung", mat)]


@kind("lectern", palette="wood")
def lectern(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(0.5, 0.65), rng.uniform(0.42, 0.5), rng.uniform(1.08, 1.18), tone.main
    slope = box(w, d, 0.03, (0, 0, 0), 0.006).turned("x", 15).moved(0, 0, h - 0.09)
    out = [
        box(w * 1.04, d * 1.04, 0.06, (0, 0, 0), 0.01).named("base", mat.shaded(0.75)),
        slope.named("top", mat.along(0)),
    ]
    if chance(rng, 0.6):
        out.append(box(w * 0.9, d * 0.8, h - 0.16, (0, 0, 0.06), 0.01).named("body", mat.along(2)))
        out.append(
            box(w * 0.6, 0.012, (h - 0.16) * 0.7, (0, -d * 0.4, 0.16), 0.004).named("panel", mat.shaded(0.82).along(2))
        )
    else:
        out.append(box(0.1, 0.1, h - 0.12, (0, 0, 0.05), 0.01).named("post", tone.frame()))
    return out


@kind("easel", palette="wood")
def easel(rng: Rng, tone: Tone) -> list[Piece]:
    w, h, mat = rng.uniform(0.55, 0.7), rng.uniform(1.5, 1.75), tone.main
    legs = [rod((s * w / 2, -0.22, 0), (s * 0.06, 0.06, h), 0.018) for s in (-1, 1)] + [
        rod((0, 0.42, 0), (0, 0.08, h * 0.94), 0.016)
    ]
    lean = 9.0
    picture = panel(w * 0.9, 0.58, (0, -0.015, 0.02))
    canvas = [
        box(w * 0.95, 0.025, 0.62, (0, 0, 0), 0.003).named("canvas", tone.plain("#f4f1e8")),
        picture.named("picture", Material((0.4, 0.6, 0.8), "picture", (0.9, 0.7, 0.4), seed=tone.seed)),
    ]
    return [
        join(*legs).named("leg", mat, 1.2),
        box(w, 0.07, 0.03, (0, -0.11, h * 0.46), 0.004).named("ledge", mat.along(0)),
        *(p.turned("x", -lean).moved(0, -0.1, h * 0.48) for p in canvas),
    ]


@kind("school desk", palette="wood")
def school_desk(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(0.6, 1.2), rng.uniform(0.48, 0.56), rng.uniform(0.66, 0.74), tone.main
    steel = tone.plain(str(rng.choice(["#5a5f66", "#3d5a80", "#8f9398"])))
    legs = (
        tapered_legs(rng, w * 0.92, d * 0.9, h - 0.02, 0.035)
        if chance(rng, 0.4)
        else legs4(w * 0.92, d * 0.9, h - 0.02, 0.03)
    )
    return [
        box(w, d, 0.025, (0, 0, h - 0.025), 0.008).named("top", mat.along(0)),
        box(w * 0.8, d * 0.75, 0.08, (0, 0.03, h - 0.13), 0.005).named("tray", steel),
        legs.named("leg", steel),
        rod((-w * 0.43, d * 0.38, 0.12), (w * 0.43, d * 0.38, 0.12), 0.012).named("bar", steel),
    ]
