"""Builders of vending machines, mannequins, clothes rails, carts and workbenches. Each returns one design's pieces."""

from __future__ import annotations

import numpy as np

from ..modeling.materials import STEEL, Material, Tone
from ..modeling.parts import CORNERS, Rng, chance, fronts
from ..modeling.round_shapes import ball, blob, cylinder, lathe, ring, rod, tube
from ..modeling.shapes import Piece, box, boxes, join, legs4, panel
from ..registry import kind

Rows = list[tuple[float, ...]]


@kind("vending machine")
def vending_machine(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(0.88, 1.0), rng.uniform(0.78, 0.86), rng.uniform(1.8, 1.9), tone.main
    y, dark = -d / 2, tone.plain("#1d2024")
    goods: dict[int, Rows] = {}
    tints = ("#c8201e", "#f2d31b", "#2a5ac8", "#3c9a3f", "#f07c1c", "#f2f2f2")
    for k in range(5):
        for x in np.linspace(-0.4, 0.16, 6):
            goods.setdefault(int(rng.integers(len(tints))), []).append(
                (0.07, 0.02, 0.16, x * w, y - 0.012, h * 0.32 + k * 0.215)
            )
    shelf = boxes([(w * 0.7, 0.02, 0.012, -w * 0.11, y - 0.008, h * 0.31 + k * 0.215) for k in range(5)])
    display = panel(w * 0.12, 0.1, (w * 0.37, y - 0.012, h * 0.72))
    out = [
        box(w, d, h, (0, 0, 0), 0.02).named("body", mat),
        box(w * 0.7, 0.012, h * 0.62, (-w * 0.11, y - 0.002, h * 0.3), 0.0).named("window", dark),
        shelf.named("shelf", STEEL),
        box(w * 0.6, 0.012, h * 0.12, (-w * 0.11, y - 0.002, h * 0.1), 0.0).named("flap", dark),
        box(w * 0.16, 0.012, h * 0.3, (w * 0.37, y - 0.003, h * 0.5), 0.0).named("panel", STEEL),
        display.named("display", Material((0.2, 0.6, 0.8), "screen", seed=1)),
    ]
    return out + [boxes(rows, 0.004).named("goods", tone.plain(tints[k])) for k, rows in goods.items()]


@kind("mannequin", palette="light")
def mannequin(rng: Rng, tone: Tone) -> list[Piece]:
    skin, cloth = tone.in_white(), tone.accent()
    skirt = chance(rng, 0.5)
    trunk = lathe(
        [(0.06, 0.82), (0.17, 0.88), (0.13, 1.05), (0.18, 1.25), (0.17, 1.4), (0.06, 1.47), (0.05, 1.52)], smooth=25
    ).stretched(1, 0.7, 1)
    legs = [rod((s * 0.085, 0, 0.06), (s * 0.08, 0, 0.86), 0.045, 0.075) for s in (-1, 1)]
    arms = [
        tube([(s * 0.18, 0, 1.38), (s * 0.24, 0.02, 1.1), (s * 0.22, -0.05, 0.84)], [0.045, 0.035, 0.03], smooth=9)
        for s in (-1, 1)
    ]
    out = [
        cylinder(0.2, 0.02, bevel=0.006).named("base", STEEL),
        trunk.named("top", cloth),
        join(*legs).named("leg", skin),
        join(*arms).named("arm", skin),
        blob(0.15, 0.18, 0.22, (0, 0, 1.62)).named("head", skin),
    ]
    if skirt:
        out.append(lathe([(0.26, 0.5), (0.16, 0.85), (0.13, 1.02)], smooth=11).named("skirt", tone.accent()))
    else:
        trousers = join(*(rod((s * 0.085, 0, 0.12), (s * 0.08, 0, 0.9), 0.06, 0.09) for s in (-1, 1)))
        out.append(trousers.named("trousers", tone.accent()))
    return out


@kind("clothes rail", palette="fabric")
def clothes_rail(rng: Rng, tone: Tone) -> list[Piece]:
    w, h = rng.uniform(1.1, 1.4), rng.uniform(1.5, 1.65)
    bars = [rod((s * w / 2, 0, 0.04), (s * w / 2, 0, h), 0.015) for s in (-1, 1)] + [
        rod((-w / 2, 0, h), (w / 2, 0, h), 0.015)
    ]
    bars += [rod((s * w / 2, -0.22, 0.04), (s * w / 2, 0.22, 0.04), 0.016) for s in (-1, 1)]
    feet = [ball(0.028, (s * w / 2, y, 0.03)) for s in (-1, 1) for y in (-0.2, 0.2)]
    out = [join(*bars).named("frame", tone.metal()), join(*feet).named("wheel", tone.plain("#1d1d1f"))]
    main = Material(tone.color, "weave", main=True)
    for k, x in enumerate(np.linspace(-w * 0.42, w * 0.42, int(rng.integers(7, 11)))):
        long = rng.uniform(0.6, 0.95)
        mat = main if k % 3 == 0 else tone.accent()
        out.append(blob(0.05, 0.42, long, (float(x), 0, h - 0.1 - long / 2), 0.5, 0.5).named("garment", mat, 0.8))
    return out


@kind("bar cart", palette="wood")
def bar_cart(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(0.68, 0.82), rng.uniform(0.38, 0.44), rng.uniform(0.78, 0.88), tone.main
    metal, glass = tone.metal(), ("#3c7a4a", "#8a5230", "#d8e2e6", "#c8201e")
    posts = [
        rod((sx * (w / 2 - 0.02), sy * (d / 2 - 0.02), 0.08), (sx * (w / 2 - 0.02), sy * (d / 2 - 0.02), h), 0.011)
        for sx, sy in CORNERS
    ]
    wheels = [ring(0.032, 0.01, (sx * (w / 2 - 0.02), sy * (d / 2 - 0.02), 0.042), "x") for sx, sy in CORNERS]
    out = [
        boxes([(w, d, 0.022, 0, 0, z) for z in (0.2, h - 0.12)], 0.006).named("shelf", mat.along(0)),
        join(*posts).named("post", metal), join(*wheels).named("wheel", tone.plain("#232326")),
        rod((-w / 2 - 0.06, -d * 0.4, h - 0.02), (-w / 2 - 0.06, d * 0.4, h - 0.02), 0.012).named("handle", metal),
    ]  # fmt: skip
    for k, x in enumerate(np.linspace(-w * 0.36, w * 0.36, 5)):
        tall = rng.uniform(0.2, 0.3)
        flask = [(0, 0), (0.035, 0), (0.036, tall * 0.6), (0.013, tall * 0.78), (0.013, tall)]
        z = 0.222 if k % 2 else h - 0.098
        out.append(
            lathe(flask, (float(x), rng.uniform(-0.06, 0.08), z), smooth=13).named("bottle", tone.plain(glass[k % 4]))
        )
    return out


@kind("workbench", palette="wood")
def workbench(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(1.4, 1.8), rng.uniform(0.6, 0.7), rng.uniform(0.86, 0.92), tone.main
    return [
        box(w, d, 0.06, (0, 0, h - 0.06), 0.008).named("top", mat.along(0)),
        legs4(w - 0.06, d - 0.06, h - 0.06, 0.09).named("leg", mat.along(2)),
        box(w - 0.14, d - 0.14, 0.025, (0, 0, 0.18), 0.004).named("shelf", mat.along(0)),
        *fronts(rng, w * 0.5, 0.14, (-w * 0.2, -d / 2 + 0.03, h - 0.22), 2, 1, mat.shaded(0.85), tone.metal()),
        box(0.16, 0.1, 0.12, (w * 0.34, -d / 2 - 0.03, h - 0.14), 0.01).named("vice", tone.plain("#3d4a5a")),
        box(0.4, 0.24, 0.2, (w * 0.1, 0, 0.205), 0.01).named("toolbox", tone.plain("#c8201e")),
    ]
