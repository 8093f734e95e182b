"""Builders of kitchen appliances and the sink. Each builder returns the pieces of one design."""

from __future__ import annotations

from ..modeling.materials import Material, Tone
from ..modeling.parts import Rng, chance, fronts
from ..modeling.round_shapes import ball, cylinder, lathe, ring, rod, tube
from ..modeling.shapes import Piece, box, boxes, extrude, rounded_rectangle
from ..registry import kind


@kind("toaster", palette="appliance")
def toaster(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(0.26, 0.34), rng.uniform(0.16, 0.2), rng.uniform(0.18, 0.21), tone.main
    body = (
        extrude(rounded_rectangle(w, h * 0.94, rng.uniform(0.02, 0.07)), d, 0.02)
        .turned("x", 90)
        .moved(0, d / 2, h * 0.53)
    )
    dark = tone.plain("#1d1d1f")
    out = [
        body.named("body", mat),
        boxes([(w * 0.74, 0.022, 0.006, 0, s * d * 0.18, h * 0.995) for s in (-1, 1)], 0.001).named("slot", dark),
        box(w * 0.96, d * 0.9, 0.02).named("base", dark),
    ]
    out += [
        box(0.03, 0.02, 0.015, (w / 2 + 0.005, 0, h * 0.65)).named("lever", dark),
        cylinder(0.016, 0.012).turned("x", 90).moved(w * 0.3, -d / 2, h * 0.3).named("knob", dark, 1.3),
    ]
    if chance(rng, 0.6):
        out += [
            box(w * 0.6, 0.014, 0.06, (0, s * d * 0.18, h * 0.98), 0.006).named("toast", tone.plain("#c08a48"))
            for s in (-1, 1)
        ]
    return out


@kind("fridge", palette="appliance")
def fridge(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, style = rng.uniform(0.58, 0.72), rng.uniform(0.6, 0.68), rng.uniform(1.5, 1.95), int(rng.integers(4))
    mat, steel, r = tone.main, tone.metal(), rng.uniform(0.01, 0.05)
    y = -d / 2 - 0.015
    out = [
        box(w, d, h - 0.04, (0, 0, 0.04), 0.01).named("body", mat.shaded(0.93)),
        box(w * 0.9, d * 0.9, 0.05, (0, 0, 0)).named("base", tone.plain("#26272a")),
    ]
    split = {
        0: [(0.04, h * 0.64), (h * 0.65 + 0.01, h)],
        1: [(0.04, h * 0.34), (h * 0.35, h)],
        2: [(0.04, h)],
        3: [(0.04, h)],
    }[style]
    if style == 3:
        w2 = w / 2
        for s in (-1, 1):
            out += [
                box(w2 - 0.006, 0.04, h - 0.05, (s * w2 / 2, y, 0.045), r).named("door", mat),
                box(0.02, 0.03, h * 0.4, (s * 0.04, y - 0.04, h * 0.35), 0.006).named("handle", steel),
            ]
        return out
    for low, high in split:
        handle = box(0.022, 0.03, min((high - low) * 0.4, 0.4), (-w * 0.4, y - 0.04, low + (high - low) * 0.4), 0.006)
        out += [box(w, 0.04, high - low - 0.006, (0, y, low), r).named("door", mat), handle.named("handle", steel)]
    if chance(rng, 0.3):
        for _ in range(4):
            note = box(0.06, 0.003, 0.06, (rng.uniform(-0.1, 0.2), y - 0.022, h * rng.uniform(0.65, 0.85)))
            out.append(note.named("magnet", tone.accent()))
    return out


@kind("stove", palette="appliance")
def stove(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(0.58, 0.8), 0.62, rng.uniform(0.86, 0.92), tone.main
    dark, steel, y = tone.plain("#1c1d1f"), tone.metal(), -0.31
    out = [
        box(w, d, h - 0.02, (0, 0, 0), 0.008).named("body", mat),
        box(w, d, 0.02, (0, 0, h - 0.02), 0.005).named("hob", dark if chance(rng, 0.6) else steel),
    ]
    for sx in (-1, 1):
        for sy in (-1, 1):
            r = rng.uniform(0.07, 0.1)
            at = (sx * w * 0.25, sy * 0.14, h + 0.006)
            out += [
                ring(r, 0.007, at).named("burner", dark if chance(rng, 0.5) else steel),
                ring(r * 0.5, 0.007, at).named("burner", dark),
            ]
    out += [
        box(w * 0.88, 0.02, h * 0.5, (0, y - 0.005, 0.14), 0.006).named("door", mat.shaded(0.85)),
        box(w * 0.66, 0.006, h * 0.28, (0, y - 0.017, 0.22)).named("window", dark),
        rod((-w * 0.38, y - 0.04, h * 0.68), (w * 0.38, y - 0.04, h * 0.68), 0.012).named("handle", steel),
    ]
    n = int(rng.integers(4, 6))
    out += [
        cylinder(0.022, 0.025, bevel=0.005)
        .turned("x", 90)
        .moved((k / (n - 1) - 0.5) * w * 0.76, y, h * 0.87)
        .named("knob", steel if chance(rng, 0.5) else dark, 1.2)
        for k in range(n)
    ]
    if chance(rng, 0.35):
        out.append(box(w, 0.04, 0.16, (0, d / 2 - 0.02, h - 0.01)).named("backsplash", mat))
    return out


@kind("sink", palette="appliance")
def sink(rng: Rng, tone: Tone) -> list[Piece]:
    mat, steel, style = tone.main, tone.metal(), int(rng.integers(3))
    white = tone.plain("#f4f4f2") if chance(rng, 0.6) else Material((0.75, 0.77, 0.79), "brushed")
    h = rng.uniform(0.82, 0.88)
    if style == 0:  # pedestal
        w, d = rng.uniform(0.5, 0.62), 0.44
        bowl_ = (
            lathe([(0.08, -0.18), (0.2, -0.12), (0.25, 0.0), (0.22, 0.0), (0.18, -0.08), (0, -0.12)], smooth=17)
            .stretched(w / 0.5, d / 0.5, 1)
            .moved(0, 0, h)
        )
        out = [
            bowl_.named("basin", mat),
            lathe([(0.13, 0), (0.08, 0.15), (0.07, h * 0.6), (0.11, h - 0.14)], smooth=11).named("pedestal", mat),
        ]
        y = d / 2 - 0.04
    else:  # built into a cupboard
        w, d = rng.uniform(0.7, 1.1) if style == 1 else rng.uniform(0.55, 0.7), 0.55
        bw, bd = w * 0.55, d * 0.62
        rim = boxes(
            [(w, (d - bd) / 2, 0.04, 0, s * (d + bd) / 4, h - 0.04) for s in (-1, 1)]
            + [((w - bw) / 2, bd, 0.04, s * (w + bw) / 4, 0, h - 0.04) for s in (-1, 1)]
        )
        walls: list[tuple[float, ...]] = [(bw, 0.01, 0.15, 0, s * bd / 2, h - 0.17) for s in (1, -1)]
        walls += [(0.01, bd, 0.15, s * bw / 2, 0, h - 0.17) for s in (1, -1)]
        well = boxes([(bw, bd, 0.01, 0, 0, h - 0.17), *walls])
        out = [
            boxes(
                [
                    (w, d, h - 0.19, 0, 0, 0.02),
                    (w, 0.02, 0.16, 0, -d / 2 + 0.01, h - 0.18),
                    (0.02, d, 0.16, -w / 2 + 0.01, 0, h - 0.18),
                    (0.02, d, 0.16, w / 2 - 0.01, 0, h - 0.18),
                ]
            ).named("cupboard", mat),
            rim.named("worktop", white),
            well.named("basin", white.shaded(0.85)),
            *fronts(rng, w - 0.04, h - 0.12, (0, -d / 2, 0.06), 2, 1, mat.shaded(1.05), steel),
        ]
        y = d / 2 - 0.06
    spout = [(0, y, h), (0, y, h + 0.22), (0, y - 0.08, h + 0.27), (0, y - 0.16, h + 0.2)]
    out.append(tube(spout, 0.012, smooth=19).named("tap", steel, 1.3))
    return [*out, *(ball(0.02, (s * 0.09, y, h + 0.03)).named("tap", steel, 1.3) for s in (-1, 1))]


@kind("microwave", palette="appliance")
def microwave(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(0.45, 0.52), rng.uniform(0.32, 0.38), rng.uniform(0.26, 0.3), tone.main
    y, dark = -d / 2 - 0.004, tone.plain("#17181a")
    digits = Material((0.1, 0.1, 0.1), "plain")
    return [
        box(w, d, h, (0, 0, 0), 0.01).named("body", mat),
        box(w * 0.7, 0.015, h * 0.9, (-w * 0.13, y, h * 0.05), 0.005).named("door", mat.shaded(0.9)),
        box(w * 0.54, 0.006, h * 0.62, (-w * 0.15, y - 0.008, h * 0.18)).named("window", dark),
        box(0.016, 0.025, h * 0.6, (w * 0.19, y - 0.018, h * 0.2), 0.005).named("handle", tone.metal()),
        box(w * 0.18, 0.006, h * 0.16, (w * 0.37, y, h * 0.72)).named("display", digits),
        boxes(
            [(0.022, 0.006, 0.018, w * 0.37 + i * 0.03, y, h * 0.2 + j * 0.035) for i in (-1, 0, 1) for j in range(4)],
            0.002,
        ).named("button", mat.shaded(0.6), 0.8),
    ]
