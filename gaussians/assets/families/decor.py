"""Builders of decoration: rugs, pictures, mirrors, clocks, globes. Each builder returns the pieces of one design.

The back of pieces that hang on a wall is at their largest y.
"""

from __future__ import annotations

import numpy as np

from ..modeling.materials import Material, Tone, mix, shade
from ..modeling.parts import CORNERS, Rng, around, chance
from ..modeling.round_shapes import ball, blob, cylinder, lathe, ring, rod, tube
from ..modeling.shapes import Array, Piece, box, boxes, ellipse, extrude, join, panel, rounded_rectangle, surface
from ..registry import kind


@kind("rug", palette="fabric")
def rug(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h = rng.uniform(1.5, 2.6), rng.uniform(1.1, 1.8), 0.018
    name = str(rng.choice(["rug", "rug", "stripes", "checks", "weave", "dots", "leaves"]))
    soft = mix(tone.color, tone.second, 0.7)
    mat = Material(tone.color, name, soft, rng.uniform(0.12, 0.3), int(rng.integers(0, 2)), tone.seed, True)
    if chance(rng, 0.25):
        r = rng.uniform(1.2, 1.9)
        name = str(rng.choice(["rings", "weave", "dots"]))
        return [
            extrude(ellipse(r, r if chance(rng, 0.7) else r * 0.7, 32), h, 0.004).named(
                "pile", Material(tone.color, name, soft, rng.uniform(0.15, 0.4), seed=tone.seed, main=True)
            )
        ]
    t = np.linspace(-1, 1, 2)
    u, v = np.meshgrid(t, t, indexing="ij")
    top = surface(np.stack([-u * 0 + v * w / 2, u * d / 2, 0 * u + h], -1)[:, ::-1]).named("pile", mat)
    rim = boxes(
        [(w, 0.012, h * 0.9, 0, s * d / 2, 0) for s in (-1, 1)]
        + [(0.012, d, h * 0.9, s * w / 2, 0, 0) for s in (-1, 1)],
        0.003,
    )
    out = [top, rim.named("rim", Material(tone.color, main=True))]
    if chance(rng, 0.4):
        ends = [
            (0.05, 0.008, 0.006, s * (w / 2 + 0.03), y, 0)
            for s in (-1, 1)
            for y in np.linspace(-d / 2 + 0.02, d / 2 - 0.02, 24)
        ]
        out.append(boxes(ends, 0.002).named("fringe", Material(mix(tone.color, (0.95, 0.92, 0.85), 0.8))))
    return out


def _frame(w: float, h: float, t: float, deep: float, mat: Material) -> Piece:
    """Four bars of width `t` around a w x h opening whose lower edge is at z = 0."""
    rows = [
        (w + 2 * t, deep, t, 0, 0, -t),
        (w + 2 * t, deep, t, 0, 0, h),
        (t, deep, h, w / 2 + t / 2, 0, 0),
        (t, deep, h, -w / 2 - t / 2, 0, 0),
    ]
    return boxes(rows, 0.006).named("frame", mat)


@kind("painting")
def painting(rng: Rng, tone: Tone) -> list[Piece]:
    long, ratio = rng.uniform(0.45, 1.1), rng.uniform(0.62, 1.0)
    w, h = (long, long * ratio) if chance(rng, 0.6) else (long * ratio, long)
    art = Material(tone.color, "picture", tone.second, seed=tone.seed, main=True)
    style = int(rng.integers(4))
    if style == 0:  # bare canvas
        return [
            box(w, 0.03, h).named("canvas", Material((0.93, 0.91, 0.86))),
            panel(w, h, (0, -0.0155, 0)).named("picture", art),
        ]
    t = rng.uniform(0.015, 0.06)
    frame = Material((0.78, 0.62, 0.28), "brushed") if style == 1 else tone.frame()
    out = [
        _frame(w, h, t, 0.03, frame.along(0)),
        box(w, 0.01, h, (0, 0.008, 0), 0.001).named("back", Material((0.4, 0.35, 0.3))),
    ]
    if style == 3:
        m = 0.12 * min(w, h)
        out += [
            panel(w, h, (0, 0.0, 0)).named("mat", Material((0.96, 0.95, 0.92))),
            panel(w - 2 * m, h - 2 * m, (0, -0.003, m)).named("picture", art),
        ]
    else:
        out.append(panel(w, h, (0, 0.0, 0)).named("picture", art))
    return out


@kind("mirror", palette="wood")
def mirror(rng: Rng, tone: Tone) -> list[Piece]:
    glass = Material((0.66, 0.76, 0.82), "glass", (0.93, 0.97, 0.99), seed=tone.seed)
    style, t = int(rng.integers(4)), rng.uniform(0.025, 0.06)
    frame = tone.main
    if style == 0:
        w, h = rng.uniform(0.4, 0.7), rng.uniform(0.7, 1.6)
        return [
            _frame(w, h, t, 0.03, frame.along(2)),
            panel(w, h).named("glass", glass),
            box(w, 0.01, h, (0, 0.008, 0)).named("back", Material((0.3, 0.3, 0.3))),
        ]
    w = rng.uniform(0.5, 0.8)
    h = w if style == 1 else w * rng.uniform(1.3, 1.7)
    outline: Array = ellipse(w, h, 32) if style < 3 else _arch(w, h)
    face = extrude(outline, 0.012, 0.003).turned("x", 90)
    path = np.concatenate([outline, outline[:1]])
    rim = tube(np.stack([path[:, 0], 0 * path[:, 0] - 0.005, path[:, 1]], 1), t / 2, closed=True, segments=8)
    out = [face.named("glass", glass), rim.named("frame", frame)]
    if style == 1 and chance(rng, 0.4):  # a sunburst
        rays = [
            rod((w / 2 * np.cos(a), 0, w / 2 * np.sin(a)), (w * 0.7 * np.cos(a), 0, w * 0.7 * np.sin(a)), 0.012, 0.004)
            for a in around(20)
        ]
        out.append(join(*rays).named("ray", frame))
    return out


def _arch(w: float, h: float) -> Array:
    """A rectangle with a round top, counter-clockwise."""
    a = np.linspace(0, np.pi, 17)
    top = np.stack([w / 2 * np.cos(a), h / 2 - w / 2 + w / 2 * np.sin(a)], 1)
    return np.concatenate([top, [[-w / 2, 0], [-w / 2, -h / 2], [0, -h / 2], [w / 2, -h / 2], [w / 2, 0]]])


@kind("clock")
def clock(rng: Rng, tone: Tone) -> list[Piece]:
    r, style = rng.uniform(0.12, 0.19), int(rng.integers(4))
    pale = chance(rng, 0.6)
    dial = (
        Material((0.96, 0.95, 0.9), "clock", (0.08, 0.08, 0.1), seed=tone.seed)
        if pale
        else Material(tone.color, "clock", tone.second, seed=tone.seed, main=True)
    )
    face = lathe([(r * 0.93, 0), (0, 0)]).turned("x", 90)
    case = tone.main
    if style == 3:
        w = 2 * r
        return [
            extrude(rounded_rectangle(w * 1.06, w * 1.06, w * 0.12), 0.035, 0.01).turned("x", 90).named("case", case),
            lathe([(r * 0.93, 0), (0, 0)]).turned("x", 90).moved(0, -0.037, 0).named("dial", dial, 1.2),
        ]
    body = cylinder(r, 0.035, bevel=0.008).turned("x", 90)
    out = [
        body.named("case", case),
        face.moved(0, -0.037, 0).named("dial", dial, 1.2),
        ring(r * 0.97, r * rng.uniform(0.05, 0.12), (0, -0.03, 0), "y").named("rim", case),
    ]
    if style == 2:  # an alarm clock with bells and feet
        out += [
            blob(r * 0.6, r * 0.5, r * 0.45, (s * r * 0.55, -0.015, r * 1.08)).named("bell", tone.metal())
            for s in (-1, 1)
        ]
        out += [
            rod((s * r * 0.5, -0.015, -r * 0.85), (s * r * 0.7, -0.015, -r * 1.2), 0.008).named("foot", tone.metal())
            for s in (-1, 1)
        ]
    return out


@kind("globe")
def globe(rng: Rng, tone: Tone) -> list[Piece]:
    r = rng.uniform(0.11, 0.16)
    stand = tone.frame()
    z = r + 0.09
    sea = Material(tone.color, "leaves", mix(tone.second, (0.3, 0.6, 0.3), 0.5), r * 0.7, seed=tone.seed, main=True)
    arc = [(r * 1.1 * np.sin(a), 0, z - r * 1.1 * np.cos(a)) for a in np.linspace(0.3, np.pi + 0.3, 15)]
    return [
        ball(r, (0, 0, z)).named("sphere", sea),
        tube(arc, 0.007).named("arm", tone.metal()),
        cylinder(0.09, 0.02, bevel=0.006).named("base", stand),
        rod((0, 0, 0.01), (0.03, 0, z - r * 1.05), 0.01).named("stem", stand),
    ]


@kind("sculpture")
def sculpture(rng: Rng, tone: Tone) -> list[Piece]:
    pattern = str(rng.choice(["plain", "marble", "brushed"]))
    mat = Material(tone.color, pattern, shade(tone.color, 0.7), seed=tone.seed, main=True)
    style = int(rng.integers(4))
    plinth = box(0.14, 0.14, 0.05, (0, 0, 0)).named(
        "plinth", tone.wood() if chance(rng, 0.5) else tone.plain("#2b2b2e")
    )
    if style == 0:  # a bust
        return [
            plinth,
            blob(0.22, 0.13, 0.14, (0, 0, 0.11)).named("body", mat),
            cylinder(0.035, 0.08, (0, 0, 0.15)).named("neck", mat),
            blob(0.11, 0.13, 0.16, (0, -0.01, 0.29)).named("head", mat),
            ball(0.014, (0, -0.08, 0.28)).named("nose", mat),
        ]
    if style == 1:  # a twisted loop
        t = np.linspace(0, 2 * np.pi, 41)
        path = np.stack([0.1 * np.sin(2 * t) * 0.8, 0.06 * np.cos(3 * t), 0.19 - 0.13 * np.cos(t)], 1)
        return [plinth, tube(path, 0.02 + 0.008 * np.sin(3 * t)).named("body", mat)]
    if style == 2:  # stacked stones
        out, z = [plinth], 0.05
        for k in range(int(rng.integers(3, 6))):
            s = 0.15 * 0.82**k
            stone = blob(s * rng.uniform(0.9, 1.2), s, s * 0.55, (rng.uniform(-0.01, 0.01), 0, z + s * 0.27))
            out.append(stone.named("stone", mat))
            z += s * 0.53
        return out
    legs = [rod((sx * 0.1, sy * 0.035, 0.05), (sx * 0.085, sy * 0.03, 0.2), 0.014, 0.02) for sx, sy in CORNERS]
    neck = tube([(-0.08, 0, 0.22), (-0.13, 0, 0.3), (-0.15, 0, 0.36)], [0.045, 0.035, 0.028], smooth=9)
    return [
        box(0.32, 0.13, 0.05).named("plinth", plinth.material or mat),
        blob(0.28, 0.11, 0.12, (0, 0, 0.24)).named("body", mat),
        join(*legs).named("leg", mat),
        neck.named("neck", mat),
        blob(0.12, 0.05, 0.06, (-0.18, 0, 0.36)).named("head", mat),
        tube([(0.13, 0, 0.25), (0.18, 0, 0.22), (0.19, 0, 0.12)], 0.012, smooth=9).named("tail", mat),
    ]
