"""Builders of furniture and equipment of shops and cafés. Each builder returns the pieces of one design."""

from __future__ import annotations

import numpy as np

from ..modeling.materials import Material, Tone, mix
from ..modeling.parts import CORNERS, Rng, chance
from ..modeling.round_shapes import blob, cylinder, lathe, ring, rod, tube
from ..modeling.shapes import Piece, box, boxes, join, panel
from ..registry import kind

_CRUSTS = ("#c98a45", "#e0a860", "#8a5230", "#f0d9a8", "#d9738c", "#5a3220")
_GOODS = ("#c8201e", "#f2d31b", "#2a5ac8", "#3c9a3f", "#f07c1c", "#f2f2f2", "#7d3fa6", "#d9c4a0")


def _pastries(rng: Rng, tone: Tone, w: float, d: float, z: float) -> list[Piece]:
    """Cakes, rolls and tarts on a shelf of w x d at height z."""
    rows: dict[int, list[Piece]] = {}
    columns, lines = max(int(w / 0.16), 1), max(int(d / 0.16), 1)
    for i in range(columns):
        shade, form = int(rng.integers(len(_CRUSTS))), int(rng.integers(3))
        for j in range(lines):
            x, y = (i + 0.5) * w / columns - w / 2, (j + 0.5) * d / lines - d / 2
            r = rng.uniform(0.04, 0.055)
            if form == 0:
                piece = blob(2.3 * r, 1.3 * r, 1.1 * r, (x, y, z + 0.55 * r))
            elif form == 1:
                piece = cylinder(r, 0.055, (x, y, z), bevel=0.012)
            else:
                piece = ring(r * 0.75, r * 0.35, (x, y, z + r * 0.35))
            rows.setdefault(shade, []).append(piece)
    return [join(*found).named("pastry", tone.plain(_CRUSTS[shade]), 0.8) for shade, found in rows.items()]


@kind("counter", palette="wood")
def counter(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(1.4, 3.2), rng.uniform(0.55, 0.75), rng.uniform(0.95, 1.1), tone.main
    style, thick = int(rng.integers(4)), rng.uniform(0.035, 0.06)
    top = (
        mat.shaded(0.6) if style in (0, 2) else tone.plain(str(rng.choice(["#e9e4da", "#3a3634", "#cfc8bb"])), "marble")
    )
    out = [
        box(w - 0.08, d - 0.1, 0.08, (0, 0, 0), 0.004).named("plinth", tone.plain("#2b2a29")),
        box(w - 0.03, d - 0.06, h - 0.08 - thick, (0, 0, 0.08), 0.006).named("body", mat.along(2)),
        box(w, d, thick, (0, 0, h - thick), 0.01).named("top", top),
    ]
    y, z, high = -d / 2 + 0.022, 0.12, h - thick - 0.18
    if style == 0:  # upright boards
        n = max(int(w / 0.14), 3)
        slats = [(w * 0.94 / n - 0.014, 0.018, high, (k + 0.5 - n / 2) * w * 0.94 / n, y, z) for k in range(n)]
        out.append(boxes(slats, 0.003).named("board", mat.shaded(1.12).along(2)))
    elif style == 1:  # panels
        n = max(round(w / 0.6), 2)
        rows = [(w * 0.94 / n - 0.07, 0.016, high, (k + 0.5 - n / 2) * w * 0.94 / n, y, z) for k in range(n)]
        out.append(boxes(rows, 0.005).named("panel", mat.shaded(0.84).along(2)))
    elif style == 2:  # glazed tiles
        tile = Material(mat.color, "tiles", mix(mat.color, (1, 1, 1), 0.5), 0.1, seed=tone.seed, main=True)
        out.append(box(w * 0.96, 0.016, high, (0, y, z), 0.002).named("tile", tile, 1.3))
    else:
        out.append(boxes([(w * 0.96, 0.02, 0.05, 0, y, z + high * f) for f in (0.15, 0.5, 0.85)]).named("rail", mat))
    if chance(rng, 0.4):
        out.append(
            rod((-w * 0.47, -d / 2 - 0.05, 0.2), (w * 0.47, -d / 2 - 0.05, 0.2), 0.018).named("foot rail", tone.metal())
        )
    return out


@kind("display case", palette="wood")
def display_case(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(1.0, 1.9), rng.uniform(0.55, 0.75), rng.uniform(1.15, 1.4), tone.main
    low, t, metal = rng.uniform(0.42, 0.62), 0.025, tone.metal()
    levels = int(rng.integers(2, 4))
    out = [
        box(w, d, low, (0, 0, 0), 0.008).named("base", mat.along(0)),
        box(w * 0.94, 0.012, low * 0.7, (0, -d / 2 - 0.004, low * 0.14), 0.004).named("panel", mat.shaded(0.82)),
        boxes([(t, t, h - low, sx * (w - t) / 2, sy * (d - t) / 2, low) for sx, sy in CORNERS]).named("frame", metal),
        box(w, d, 0.03, (0, 0, h - 0.03), 0.006).named("top", mat.along(0)),
        box(w - t, 0.012, h - low - 0.04, (0, d / 2 - 0.012, low), 0.0).named("back", tone.plain("#f0e2c4")),
    ]
    rise = (h - low - 0.06) / levels
    for k in range(levels):
        deep = d * (0.84 - 0.16 * k)
        z, y = low + 0.012 + k * rise, (d * 0.92 - deep) / 2
        out.append(box(w - 0.06, deep, 0.012, (0, y, z), 0.002).named("shelf", tone.plain("#e8eef0")))
        out += [p.moved(0, y, 0) for p in _pastries(rng, tone, w - 0.14, deep - 0.08, z + 0.012)]
    if chance(rng, 0.6):
        light = box(w * 0.9, 0.03, 0.02, (0, -d / 2 + 0.05, h - 0.055))
        out.append(light.named("light", Material((1.0, 0.93, 0.75), "glow", (1, 1, 0.95))))
    return out


@kind("coffee machine", palette="appliance")
def coffee_machine(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(0.36, 0.72), rng.uniform(0.38, 0.5), rng.uniform(0.4, 0.5), tone.main
    steel, black = Material((0.78, 0.79, 0.8), "brushed"), tone.plain("#1b1b1d")
    groups = 1 if w < 0.5 else 2
    out = [
        box(w, d, 0.06, (0, 0, 0), 0.012).named("base", mat),
        box(w * 0.92, d * 0.5, 0.012, (0, -d * 0.2, 0.06), 0.003).named("tray", steel),
        box(w, d * 0.42, h * 0.62, (0, d * 0.28, 0.05), 0.015).named("body", mat),
        box(w, d * 0.85, h * 0.3, (0, d * 0.06, h * 0.68), 0.02).named("head", mat),
        boxes([(w * 0.9, 0.012, 0.05, 0, -d * 0.37, h * 0.8)]).named("panel", black),
    ]
    for k in range(groups):
        x = (k - (groups - 1) / 2) * w * 0.45
        cup = lathe([(0, 0), (0.025, 0), (0.038, 0.06), (0.032, 0.058), (0.02, 0.01), (0, 0.01)], (x, -d * 0.2, 0.072))
        out += [
            cylinder(0.035, 0.05, (x, -d * 0.17, h * 0.63), bevel=0.006).named("group", steel),
            rod((x, -d * 0.2, h * 0.64), (x, -d * 0.46, h * 0.6), 0.013).named("handle", black),
            cup.named("cup", tone.plain("#f4f1ea")),
        ]
    bends = (0.44, -0.32, 0.72), (0.46, -0.42, 0.5), (0.43, -0.4, 0.28)
    for s in (1,) if groups == 1 else (-1, 1):
        out.append(tube([(s * w * x, d * y, h * z) for x, y, z in bends], 0.007, smooth=9).named("wand", steel))
    stack = [
        cylinder(0.036, 0.05, (x, d * 0.12, h * 0.98), top=0.042)
        for x in np.linspace(-w * 0.36, w * 0.36, 2 + 2 * groups)
    ]
    return [*out, join(*stack).named("cups", tone.plain("#f4f1ea"))]


@kind("cash register", palette="dark")
def cash_register(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, mat = rng.uniform(0.32, 0.42), rng.uniform(0.34, 0.42), tone.main
    tilt = rng.uniform(18, 32)
    screen = box(w * 0.8, 0.025, 0.2, (0, 0, 0), 0.006)
    face = panel(w * 0.72, 0.165, (0, -0.0145, 0.017))
    turn = [(screen, "screen", mat), (face, "display", Material((0.2, 0.45, 0.75), "screen", seed=tone.seed))]
    keys = [(0.03, 0.024, 0.016, (i - 2) * 0.04, -d * 0.3 + j * 0.036, 0.11) for i in range(5) for j in range(3)]
    return [
        box(w, d, 0.11, (0, 0, 0), 0.01).named("drawer", mat),
        box(w * 0.9, 0.01, 0.07, (0, -d / 2 - 0.003, 0.02), 0.003).named("front", mat.shaded(1.25)),
        boxes(keys, 0.003).named("key", tone.plain("#e9e6df"), 0.8),
        rod((0, d * 0.12, 0.1), (0, d * 0.12, 0.2), 0.025).named("neck", mat),
        *(p.turned("x", -tilt).moved(0, d * 0.1, 0.18).named(name, m) for p, name, m in turn),
    ]


@kind("menu board", palette="dark")
def menu_board(rng: Rng, tone: Tone) -> list[Piece]:
    w, h, t = rng.uniform(0.8, 1.7), rng.uniform(0.7, 1.05), rng.uniform(0.03, 0.06)
    slate = tone.main if tone.asked else Material((0.13, 0.15, 0.14), main=True)
    tone.color = slate.color
    chalk, frame = tone.plain("#eeeae0"), tone.wood()
    bars: list[tuple[float, ...]] = [(w, 0.035, t, 0, 0, z) for z in (0.0, h - t)]
    bars += [(t, 0.035, h - 2 * t, s * (w - t) / 2, 0, t) for s in (-1, 1)]
    columns = 1 if w < 1.1 else 2
    lines: list[tuple[float, ...]] = [(w * 0.4, 0.003, 0.028, 0, -0.013, h - t - 0.1)]
    for c in range(columns):
        middle, wide = (c - (columns - 1) / 2) * w / columns, w / columns * 0.72
        for k in range(int((h - 0.32) / 0.09)):
            long, z = wide * rng.uniform(0.4, 0.7), h - t - 0.2 - 0.09 * k
            lines.append((long, 0.003, 0.014, middle - wide / 2 + long / 2, -0.013, z))
            lines.append((0.06, 0.003, 0.014, middle + wide / 2 - 0.03, -0.013, z))
    return [
        boxes(bars, 0.004).named("frame", frame),
        box(w - t, 0.02, h - t, (0, 0, t / 2), 0.0).named("board", slate, 1.2),
        boxes(lines, 0.0).named("writing", chalk, 1.2),
    ]


@kind("aisle shelf", palette="light")
def aisle_shelf(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(1.1, 2.1), rng.uniform(0.5, 0.9), rng.uniform(1.35, 1.8), tone.main
    levels = int(rng.integers(3, 6))
    rise = (h - 0.14) / levels
    upright = boxes([(0.03, d * 0.4, h - 0.12, s * (w / 2 - 0.015), 0, 0.12) for s in (-1, 1)])
    out = [
        box(w, d, 0.12, (0, 0, 0), 0.006).named("base", mat),
        box(w, 0.03, h - 0.12, (0, 0, 0.12), 0.003).named("back", mat.shaded(1.1)),
        upright.named("upright", mat.shaded(0.75)),
    ]
    boards: list[tuple[float, ...]] = []
    goods: dict[int, list[Piece]] = {}
    for k in range(levels):
        z = 0.12 + k * rise
        for side in (-1, 1):
            if k:
                boards.append((w - 0.04, d / 2 - 0.02, 0.02, 0, side * d / 4, z - 0.02))
            x = -w / 2 + 0.06
            while x < w / 2 - 0.14:
                wide, high = rng.uniform(0.06, 0.15), rise * rng.uniform(0.45, 0.78)
                at = (x + wide / 2, side * d * 0.27, z)
                can = chance(rng, 0.4)
                thing = cylinder(wide / 2, high * 0.8, at, bevel=0.006) if can else box(wide, d * 0.32, high, at, 0.003)
                goods.setdefault(int(rng.integers(len(_GOODS))), []).append(thing)
                x += wide + 0.012
    if boards:
        out.append(boxes(boards, 0.003).named("shelf", mat))
    return out + [join(*found).named("goods", tone.plain(_GOODS[k]), 0.6) for k, found in goods.items()]
