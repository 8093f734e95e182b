"""Builders of flower stands, bar stools and TV stands. Each builder returns the pieces of one design."""

from __future__ import annotations

import numpy as np

from ..modeling.materials import Material, Tone
from ..modeling.parts import CORNERS, Rng, chance, fronts, polar
from ..modeling.round_shapes import ball, blob, cylinder, disc, lathe, ring, rod, tube
from ..modeling.shapes import Piece, box, boxes, join, legs4
from ..registry import kind


@kind("flower stand", palette="wood")
def flower_stand(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, steps, mat = rng.uniform(0.9, 1.5), rng.uniform(0.6, 0.9), int(rng.integers(2, 4)), tone.main
    rise = rng.uniform(0.24, 0.34)
    out: list[Piece] = []
    blooms: dict[int, list[Piece]] = {}
    leaves, pots = [], []
    tints = ("#e0457b", "#f2c53d", "#f4f0ea", "#c8201e", "#8d5fc0", "#f08a3c")
    for k in range(steps):
        y, z, deep = -d / 2 + (k + 0.5) * d / steps, (k + 1) * rise, d / steps
        out.append(box(w, deep, 0.03, (0, y, z - 0.03), 0.005).named("shelf", mat.along(0)))
        posts = [(0.035, 0.035, z - 0.03, s * (w / 2 - 0.03), y, 0) for s in (-1, 1)]
        out.append(boxes(posts, 0.003).named("leg", mat.along(2)))
        count = max(int(w / 0.26), 2)
        for i in range(count):
            x, r, high = (i + 0.5 - count / 2) * w / count, rng.uniform(0.065, 0.085), rng.uniform(0.13, 0.2)
            pots.append(lathe([(0, 0), (r * 0.75, 0), (r, high), (r * 0.85, high * 0.9), (0, high * 0.9)], (x, y, z)))
            leaves.append(blob(r * 2.3, r * 2.3, 0.14, (x, y, z + high + 0.03)))
            tint = int(rng.integers(len(tints)))
            for a in rng.uniform(0, 2 * np.pi, 7):
                spread = r * rng.uniform(0.2, 1.1)
                at = (x + spread * np.cos(a), y + spread * np.sin(a), z + high + rng.uniform(0.08, 0.15))
                blooms.setdefault(tint, []).append(ball(0.03, at))
    steel = tone.metal() if chance(rng, 0.5) else tone.accent()
    out += [
        join(*pots).named("pot", steel, 0.7),
        join(*leaves).named("leaves", Material((0.25, 0.5, 0.24), "fur", seed=1), 0.7),
    ]
    return out + [join(*found).named("flower", tone.plain(tints[k]), 0.6) for k, found in blooms.items()]


@kind("bar stool")
def bar_stool(rng: Rng, tone: Tone) -> list[Piece]:
    r, h, style = rng.uniform(0.17, 0.2), rng.uniform(0.66, 0.78), int(rng.integers(4))
    seat, frame = (tone.textile(0.05, 0.8) if chance(rng, 0.5) else tone.main), tone.frame()
    out: list[Piece] = []
    if style == 0:  # on a column
        spokes = [rod((0, 0, h * 0.36), polar(r * 0.75, a, h * 0.36), 0.008) for a in (0.5, 2.6, 4.7)]
        out += [
            lathe([(0, 0), (r * 1.15, 0), (r * 1.15, 0.012), (0.05, 0.05), (0.028, 0.06)]).named("foot", frame),
            rod((0, 0, 0.04), (0, 0, h - 0.06), 0.026).named("column", frame),
            ring(r * 0.75, 0.01, (0, 0, h * 0.36)).named("footrest", frame),
            join(*spokes).named("footrest", frame),
        ]
    else:
        low, top = r * 1.05, r * 0.72
        leg = join(*(rod((sx * low, sy * low, 0), (sx * top, sy * top, h - 0.05), 0.013, 0.017) for sx, sy in CORNERS))
        out.append(leg.named("leg", frame))
        k = low + (top - low) * 0.34
        edge = [(-k, -k), (k, -k), (k, k), (-k, k)]
        bars = [rod((*edge[i], h * 0.34), (*edge[(i + 1) % 4], h * 0.34), 0.009) for i in range(4)]
        out.append(join(*bars).named("footrest", frame))
    if style == 3:
        out.append(box(2 * r, 2 * r * 0.92, 0.05, (0, 0, h - 0.05), 0.018).named("seat", seat))
    else:
        out += [
            cylinder(r, 0.065, (0, 0, h - 0.06), bevel=0.022).named("seat", seat),
            disc(r * 0.9, (0, 0, h - 0.061), False).named("under", frame),
        ]
    if style in (2, 3):
        arc = [polar(r * 0.9, a, h + 0.24) for a in np.linspace(0.35, np.pi - 0.35, 9)]
        posts = [rod((s * r * 0.62, r * 0.6, h - 0.02), (s * r * 0.6, r * 0.68, h + 0.24), 0.012) for s in (-1, 1)]
        out += [tube(arc, 0.032, smooth=13).named("back", seat), join(*posts).named("post", frame)]
    return out


@kind("tv stand", palette="wood")
def tv_stand(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(1.2, 1.9), rng.uniform(0.36, 0.45), rng.uniform(0.42, 0.58), tone.main
    foot, t, style = rng.uniform(0.05, 0.15), 0.022, int(rng.integers(3))
    body = h - foot
    plates: list[tuple[float, ...]] = [(w, d, t, 0, 0, z) for z in (h - t, foot)]
    plates += [(w, t, body, 0, d / 2 - t / 2, foot)]
    plates += [(t, d, body - 2 * t, s * (w / 2 - t / 2), 0, foot + t) for s in (-1, 1)]
    feet = box(0.04, 0.04, foot)
    out = [boxes(plates).named("body", mat.along(0)), legs4(w, d, foot, feet, 0.05).named("leg", tone.frame())]
    third = (w - 2 * t) / 3
    out.append(boxes([(t, d - t, body - 2 * t, s * third / 2, 0, foot + t) for s in (-1, 1)]).named("divider", mat))
    doors = (-1, 1) if style == 0 else (0,) if style == 1 else (-1, 0, 1)
    for k in doors:
        at, rows = (k * third, -d / 2 + 0.012, foot + t), 1 if k else 2
        out += fronts(rng, third - 0.01, body - 2 * t, at, 1, rows, mat.shaded(0.88), tone.metal())
    if len(doors) < 3:
        shelf = boxes([(third, d - 0.05, 0.016, k * third, 0, foot + body * 0.5) for k in (-1, 0, 1) if k not in doors])
        out.append(shelf.named("shelf", mat))
    return out
