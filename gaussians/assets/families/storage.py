"""Builders of cupboards, shelves, boxes and bins. Each builder returns the pieces of one design."""

from __future__ import annotations

import numpy as np

from ..modeling.materials import Material, Tone
from ..modeling.parts import Rng, around, chance, fronts, polar, row_of_books, tapered_legs
from ..modeling.round_shapes import ball, cylinder, disc, lathe, ring, rod, tube
from ..modeling.shapes import Piece, box, boxes, extrude, join, legs4, rounded_rectangle
from ..registry import kind


def _open_box(w: float, d: float, h: float, t: float, z: float = 0.0) -> Piece:
    """The bottom and four walls, of thickness `t`, of a box that is open at the top."""
    return boxes(
        [
            (w, d, t, 0, 0, z),
            (w, t, h - t, 0, d / 2 - t / 2, z + t),
            (w, t, h - t, 0, -d / 2 + t / 2, z + t),
            (t, d - 2 * t, h - t, w / 2 - t / 2, 0, z + t),
            (t, d - 2 * t, h - t, -w / 2 + t / 2, 0, z + t),
        ]
    )


@kind("wardrobe", palette="wood")
def wardrobe(rng: Rng, tone: Tone) -> list[Piece]:
    doors = int(rng.integers(2, 5))
    w, d, h, mat = doors * rng.uniform(0.42, 0.52), rng.uniform(0.52, 0.62), rng.uniform(1.8, 2.2), tone.main
    foot = rng.uniform(0.04, 0.12)
    low = foot + (rng.uniform(0.2, 0.4) if chance(rng, 0.4) else 0.0)
    out = [
        box(w, d, h - foot, (0, 0, foot), 0.01).named("body", mat.along(2)),
        legs4(w - 0.04, d - 0.04, foot, 0.06).named("leg", mat),
    ]
    front = mat.shaded(rng.uniform(0.8, 1.2)).along(2)
    out += fronts(rng, w - 0.03, h - low - 0.05, (0, -d / 2, low + 0.02), doors, 1, front, tone.metal())
    if low > foot:
        below, columns = (0, -d / 2, foot + 0.01), max(doors // 2, 1)
        out += fronts(rng, w - 0.03, low - foot, below, columns, 1, front.along(0), tone.metal())
    if chance(rng, 0.3):
        mirror = box(w / doors - 0.1, 0.006, (h - low) * 0.8, (-w / 2 + w / doors / 2, -d / 2 - 0.02, low + 0.12))
        out.append(mirror.named("mirror", tone.plain("#b9cbd4", "brushed")))
    if chance(rng, 0.5):
        out.append(box(w + 0.06, d + 0.05, 0.05, (0, -0.01, h - 0.01), 0.015).named("cornice", mat.along(0)))
    return out


@kind("cabinet", palette="wood")
def cabinet(rng: Rng, tone: Tone) -> list[Piece]:
    columns = int(rng.integers(1, 4))
    w, d, mat = 0.15 + columns * rng.uniform(0.4, 0.5), rng.uniform(0.36, 0.46), tone.main
    h = rng.uniform(0.65, 0.85) if columns > 1 else rng.uniform(0.8, 1.15)
    foot = rng.uniform(0.05, 0.2)
    leg = tapered_legs(rng, w, d, foot + 0.01, 0.05)
    out = [
        box(w, d, h - foot, (0, 0, foot), 0.008).named("body", mat.along(0)),
        leg.named("leg", mat.along(2) if chance(rng, 0.6) else tone.metal(), 1.2),
        box(w + 0.03, d + 0.02, 0.025, (0, 0, h - 0.02), 0.008).named("top", mat.along(0)),
    ]
    front = mat.shaded(rng.uniform(0.82, 1.25))
    rows = int(rng.integers(1, 3))
    return out + fronts(rng, w - 0.04, h - foot - 0.06, (0, -d / 2, foot + 0.02), columns, rows, front, tone.metal())


@kind("dresser", palette="wood")
def dresser(rng: Rng, tone: Tone) -> list[Piece]:
    wide = chance(rng, 0.5)
    w, h = (
        (rng.uniform(1.1, 1.4), rng.uniform(0.7, 0.85)) if wide else (rng.uniform(0.65, 0.9), rng.uniform(0.95, 1.25))
    )
    d, mat, foot = rng.uniform(0.42, 0.5), tone.main, rng.uniform(0.04, 0.15)
    out = [
        box(w, d, h - foot, (0, 0, foot), 0.008).named("body", mat.along(0)),
        tapered_legs(rng, w, d, foot + 0.01, 0.06).named("leg", mat.along(2)),
    ]
    front = mat.shaded(rng.uniform(0.85, 1.25)).along(0)
    columns, rows = (2, 3) if wide else (1, int(rng.integers(4, 6)))
    return out + fronts(rng, w - 0.04, h - foot - 0.04, (0, -d / 2, foot + 0.02), columns, rows, front, tone.metal())


@kind("bookshelf", palette="wood")
def bookshelf(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, mat, t = rng.uniform(0.65, 1.1), rng.uniform(0.26, 0.34), tone.main, 0.024
    shelves = int(rng.integers(3, 7))
    gap = rng.uniform(0.29, 0.35)
    h = shelves * gap + t
    rows = [(w, d, t, 0.0, 0.0, k * gap) for k in range(shelves + 1)]
    out = [boxes(rows).named("shelf", mat.along(0))]
    if chance(rng, 0.75):
        out.append(boxes([(t, d, h, s * (w / 2 - t / 2), 0, 0) for s in (-1, 1)]).named("side", mat.along(2)))
        if chance(rng, 0.7):
            out.append(box(w, 0.01, h, (0, d / 2 - 0.005, 0), 0.002).named("back", mat.shaded(0.85).along(2)))
    else:
        out.append(legs4(w, d, h, 0.03).named("post", tone.metal()))
    covers = [tone.accent() for _ in range(6)]
    for k in range(shelves):
        fill = rng.random()
        z = k * gap + t
        if fill < 0.7:
            width = (w - 2 * t - 0.02) * rng.uniform(0.35, 0.98)
            out += row_of_books(rng, width, (-w / 2 + t + 0.01, -d / 2 + 0.02, z), d - 0.06, gap - t - 0.03, covers)
        elif fill < 0.85:
            out.append(box(w * 0.35, d * 0.7, gap * 0.5, (w * 0.2, 0, z), 0.01).named("box", tone.accent()))
            out.append(_little_vase(rng, gap * 0.7).moved(-w * 0.25, 0, z).named("vase", tone.accent()))
    return out


def _little_vase(rng: Rng, h: float) -> Piece:
    r = h * rng.uniform(0.2, 0.35)
    return lathe([(0, 0), (r * 0.7, 0), (r, h * 0.4), (r * 0.4, h * 0.8), (r * 0.5, h)], smooth=13)


@kind("books")
def books(rng: Rng, tone: Tone) -> list[Piece]:
    n, pages = int(rng.integers(1, 5)), tone.plain("#f3ecd9")
    main = tone.main
    if chance(rng, 0.3):
        covers = [main, main, main, tone.accent()]
        return row_of_books(rng, rng.uniform(0.16, 0.34), (0, 0, 0), 0.17, 0.26, covers) or [
            box(0.04, 0.16, 0.24).named("book", main)
        ]
    out, z = [], 0.0
    for k in range(n):
        w, d, t = rng.uniform(0.15, 0.2), rng.uniform(0.21, 0.27), rng.uniform(0.022, 0.045)
        cover = main if k == n - 1 or chance(rng, 0.5) else tone.accent()
        turn = rng.uniform(-15, 15)
        block = box(w - 0.008, d - 0.012, t - 0.006, (0.004, 0, z + 0.003), 0.001).turned("z", turn)
        lids = [(w, d, 0.003, 0, 0, z), (w, d, 0.003, 0, 0, z + t - 0.003), (0.004, d, t, -w / 2 + 0.002, 0, z)]
        out += [block.named("pages", pages), boxes(lids, 0.001).turned("z", turn).named("cover", cover)]
        z += t
    return out


@kind("box")
def storage_box(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, style = rng.uniform(0.25, 0.5), rng.uniform(0.22, 0.4), rng.uniform(0.18, 0.42), int(rng.integers(4))
    mat = tone.main
    if style == 0:  # closed, with a lid
        return [
            box(w, d, h * 0.8).named("body", mat),
            box(w + 0.015, d + 0.015, h * 0.22, (0, 0, h * 0.78)).named("lid", mat.shaded(rng.uniform(0.75, 1.2))),
            box(0.08, 0.006, 0.03, (0, -d / 2 - 0.001, h * 0.45)).named("label", tone.plain("#f2eddc")),
        ]
    if style == 1:  # cardboard with open flaps
        out = [_open_box(w, d, h, 0.008).named("body", mat)]
        for s in (-1, 1):
            flap = box(w, d * 0.4, 0.006, (0, s * d * 0.2, 0)).turned("x", s * 35).moved(0, s * (d / 2 + 0.0), h)
            out.append(flap.named("flap", mat.shaded(1.1)))
        return out
    if style == 2:  # slatted crate
        n = 3
        rows: list[tuple[float, ...]] = [
            (w, 0.014, h / n - 0.02, 0, s * d / 2, k * h / n + 0.01) for k in range(n) for s in (-1, 1)
        ]
        rows += [(0.014, d, h / n - 0.02, s * w / 2, 0, k * h / n + 0.01) for k in range(n) for s in (-1, 1)]
        return [
            boxes([*rows, (w, d, 0.012, 0, 0, 0.005)]).named("slat", mat.along(0)),
            legs4(w, d, h, 0.03, 0.006).named("post", mat.shaded(0.85).along(2)),
        ]
    lid = extrude(rounded_rectangle(d, h * 0.6, h * 0.29), w, 0.01).turned("x", 90).turned("z", 90)
    lid = lid.moved(-w / 2, 0, h * 0.7)
    bands = boxes([(0.03, d + 0.01, h * 0.72, s * w * 0.32, 0, 0) for s in (-1, 1)])
    return [
        box(w, d, h * 0.72).named("body", mat.along(0)),
        lid.named("lid", mat.along(0)),
        bands.named("band", tone.metal()),
        box(0.05, 0.015, 0.06, (0, -d / 2, h * 0.6)).named("lock", tone.metal()),
    ]


@kind("basket")
def basket(rng: Rng, tone: Tone) -> list[Piece]:
    mat = Material(tone.color, "wicker", scale=rng.uniform(0.018, 0.035), main=True, seed=tone.seed)
    r, h, flare = rng.uniform(0.15, 0.22), rng.uniform(0.2, 0.45), rng.uniform(0.9, 1.3)
    squash = 1.0 if chance(rng, 0.6) else 0.7
    wall = lathe([(r, 0), (r * (1 + flare) / 2 * 1.05, h / 2), (r * flare, h)], smooth=9)
    inner = lathe([(r * flare - 0.012, h), (r * (1 + flare) / 2 * 1.05 - 0.012, h / 2), (r - 0.012, 0.015)], smooth=9)
    out = [
        wall.named("wall", mat),
        inner.named("inside", mat.shaded(0.7)),
        disc(r, (0, 0, 0.012)).named("bottom", mat.shaded(0.7)),
        ring(r * flare - 0.004, 0.012, (0, 0, h)).named("rim", mat),
    ]
    if chance(rng, 0.4):
        arc = [(r * flare * np.cos(a), 0, h + r * 1.1 * np.sin(a)) for a in np.linspace(0, np.pi, 9)]
        out.append(tube(arc, 0.012, smooth=17).named("handle", mat, 1.2))
    else:
        out += [
            ring(0.045, 0.009, (s * (r * flare + 0.005), 0, h * 0.85), "x").named("handle", mat, 1.2) for s in (-1, 1)
        ]
    return [p.stretched(1.0, squash, 1.0) for p in out]


@kind("bin")
def waste_bin(rng: Rng, tone: Tone) -> list[Piece]:
    r, h, style, mat = rng.uniform(0.12, 0.17), rng.uniform(0.28, 0.42), int(rng.integers(4)), tone.main
    if style == 0:
        return [
            lathe([(r * 0.78, 0), (r, h)]).named("wall", mat),
            lathe([(r - 0.006, h), (r * 0.77, 0.01)]).named("inside", mat.shaded(0.6)),
            disc(r * 0.78, (0, 0, 0.01)).named("bottom", mat.shaded(0.5)),
            ring(r, 0.008, (0, 0, h)).named("rim", mat),
        ]
    if style == 1:  # pedal bin
        h *= 1.5
        dome = lathe([(r, 0), (r * 0.95, 0.04), (r * 0.6, 0.075), (0, 0.09)], (0, 0, h), smooth=11)
        return [
            cylinder(r, h - 0.03, (0, 0, 0.03)).named("wall", mat),
            dome.named("lid", mat.shaded(0.8)),
            cylinder(r * 1.01, 0.035).named("base", tone.plain("#2a2a2c")),
            box(0.06, 0.06, 0.015, (0, -r - 0.02, 0.01)).named("pedal", tone.metal()),
        ]
    if style == 2:  # swing top
        w, h = 2 * r, h * 1.5
        return [
            box(w, w * 0.8, h, (0, 0, 0), 0.02).named("wall", mat),
            extrude(rounded_rectangle(w * 0.8, w * 0.7, w * 0.34), w, 0.01)
            .turned("x", 90)
            .turned("z", 90)
            .moved(-w / 2, 0, h)
            .named("lid", mat.shaded(0.7)),
            box(w * 0.5, 0.01, h * 0.16, (0, -w * 0.4, h * 0.6)).named("label", tone.plain("#f2f2f2")),
        ]
    bars = [rod(polar(r * 0.8, a), polar(r, a, h), 0.004) for a in around(24)]
    hoops = [ring(r * (0.8 + 0.2 * k / 4), 0.005, (0, 0, h * k / 4)) for k in range(5)]
    return [
        join(*bars).named("wall", mat),
        join(*hoops).named("rim", mat),
        disc(r * 0.8, (0, 0, 0.006)).named("bottom", mat),
    ]


@kind("coat rack", palette="wood")
def coat_rack(rng: Rng, tone: Tone) -> list[Piece]:
    h, mat, n = rng.uniform(1.6, 1.85), tone.main, int(rng.integers(3, 6))
    turns = around(n)
    feet = (
        [rod((0, 0, 0.14), polar(0.26, a, 0.02), 0.022, 0.015) for a in turns]
        if chance(rng, 0.6)
        else [cylinder(0.2, 0.03, bevel=0.01)]
    )
    hooks = [
        tube([(0, 0, h - 0.14), polar(0.1, a, h - 0.15), polar(0.17, a, h - 0.05)], 0.013, smooth=9) for a in turns
    ]
    out = [
        rod((0, 0, 0.02), (0, 0, h), 0.026, 0.018).named("pole", mat.along(2)),
        join(*feet).named("foot", mat, 1.2),
        join(*hooks).named("hook", mat, 1.2),
        ball(0.03, (0, 0, h + 0.01)).named("knob", mat),
    ]
    if chance(rng, 0.55):
        a, coat = turns[0], tone.accent()
        body = (
            lathe([(0.16, 0), (0.15, 0.3), (0.12, 0.6), (0.1, 0.72), (0.03, 0.8)], smooth=13)
            .stretched(1.0, 0.55, 1.0)
            .moved(*polar(0.16, a, h - 0.95))
        )
        out.append(body.named("coat", coat))
    return out
