"""Builders of seating, beds and cushions. Each builder returns the pieces of one design."""

from __future__ import annotations

import numpy as np

from ..modeling.materials import Material, Tone
from ..modeling.parts import Rng, chance, clipped_below, drape, polar, shell, tapered_legs
from ..modeling.round_shapes import ball, cushion, cylinder, lathe, pillow, ring, rod, tube
from ..modeling.shapes import Piece, Point, box, boxes, extrude, join, legs4, rounded_rectangle
from ..registry import kind


def _star_base(r: float, h: float, metal: Material, wheels: Material) -> list[Piece]:
    """The base of an office chair: five spokes on castors and a column."""
    turns = [2 * np.pi * k / 5 + 0.3 for k in range(5)]
    spokes = [rod((0, 0, 0.11), polar(r, a, 0.07), 0.022, 0.016) for a in turns]
    castors = [ball(0.033, polar(r, a, 0.033)) for a in turns]
    return [
        join(*spokes).named("base", metal, 1.3),
        join(*castors).named("wheel", wheels, 1.3),
        cylinder(0.03, h - 0.08, (0, 0, 0.08)).named("column", metal, 1.3),
    ]


def _chair_back(rng: Rng, style: int, w: float, d: float, z: float, h: float, mat: Material) -> list[Piece]:
    """A chair's back from z to z + h at y = d/2; styles 0 to 5: solid, slats, ladder, spindles, padded, hoop."""
    y = d / 2 - 0.02
    posts = boxes([(0.035, 0.035, h, s * (w / 2 - 0.018), y, z) for s in (-1, 1)])
    if style == 0:
        parts = box(w, 0.025, h * 0.75, (0, y, z + h * 0.25), 0.01), posts
    elif style == 1:
        n = int(rng.integers(4, 7))
        slats = [(w * 0.5 / n, 0.018, h - 0.04, (k / (n - 1) - 0.5) * (w - 0.13), y, z + 0.02) for k in range(n)]
        parts = boxes(slats), join(posts, box(w, 0.03, 0.06, (0, y, z + h - 0.06)))
    elif style == 2:
        n = int(rng.integers(2, 5))
        rungs = [(w - 0.03, 0.018, h * 0.5 / n, 0.0, y, z + h * (k + 0.75) / (n + 0.6)) for k in range(n)]
        parts = boxes(rungs), posts
    elif style == 3:
        arc = [
            (x, y - 0.04 + 0.5 * x * x / w, z + h * (1 - 0.9 * abs(2 * x / w) ** 3.5))
            for x in np.linspace(-w / 2, w / 2, 9)
        ]
        spindles = [
            rod((x * 0.8, y - 0.02, z), (x, y - 0.03, z + h * 0.93), 0.008) for x in np.linspace(-w * 0.35, w * 0.35, 6)
        ]
        parts = join(*spindles), tube(arc, 0.016, smooth=17)
    elif style == 4:
        pad = extrude(rounded_rectangle(w, h * 0.62, 0.12), 0.04, 0.015).turned("x", 90)
        parts = (pad.moved(0, y + 0.02, z + h * 0.69),
                 boxes([(0.03, 0.02, h * 0.5, s * w * 0.3, y + 0.01, z) for s in (-1, 1)]))  # fmt: skip
    else:
        parts = (
            tube(_hoop(w * 0.98, h, y, z), 0.017, smooth=25),
            join(box(w * 0.22, 0.016, h * 0.9, (0, y, z), 0.006)),
        )
    tilt = rng.uniform(2, 10)
    return [p.turned("x", -tilt, (0, y, z)).named("back", mat.along(2)) for p in parts]


def _hoop(w: float, h: float, y: float, z: float) -> list[Point]:
    t = np.linspace(0, np.pi, 11)
    return [(float(-w / 2 * np.cos(a)), y, float(z + h * np.sin(a) ** 0.7)) for a in t]


@kind("chair")
def chair(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, seat = rng.uniform(0.4, 0.5), rng.uniform(0.42, 0.5), rng.uniform(0.43, 0.48)
    back, style = rng.uniform(0.36, 0.55), int(rng.integers(6))
    mat = tone.main if not chance(rng, 0.25) else Material(tone.color, "wood", seed=tone.seed, axis=2, main=True)
    legs = mat if chance(rng, 0.6) else tone.frame()
    out = _chair_back(rng, style, w, d, seat, back, mat)
    shape = int(rng.integers(3))
    if shape == 0:
        out.append(box(w, d, 0.035, (0, 0, seat - 0.035), 0.01).named("seat", mat.along(1)))
    elif shape == 1:
        plate = extrude(rounded_rectangle(w, d, 0.13), 0.03, 0.012).moved(0, 0, seat - 0.03)
        out.append(plate.named("seat", mat.along(1)))
    else:
        out += [
            box(w, d, 0.03, (0, 0, seat - 0.05)).named("seat", mat),
            cushion(w * 0.96, d * 0.94, 0.07, (0, -0.01, seat - 0.025)).named("cushion", tone.textile(0.06)),
        ]
    under = int(rng.integers(4))
    if under == 0:
        rails = (
            legs4(w, d, seat - 0.03, 0.038, 0.004),
            boxes([(w - 0.05, 0.02, 0.03, 0, s * (d / 2 - 0.03), 0.18) for s in (-1, 1)]),
        )
        out += [p.named("leg", legs.along(2)) for p in rails]
    elif under in (1, 2):
        out.append(tapered_legs(rng, w, d, seat - 0.03, 0.042).named("leg", legs.along(2)))
    else:  # a bent steel cantilever
        for s in (-1, 1):
            x = s * (w / 2 - 0.02)
            path = [
                (x, d / 2, seat),
                (x, -d / 2 + 0.03, seat - 0.02),
                (x, -d / 2 + 0.02, 0.04),
                (x, -d / 2 + 0.06, 0.016),
                (x, d / 2, 0.016),
            ]
            out.append(tube(path, 0.014, smooth=25).named("leg", tone.metal()))
        out.append(rod((-w / 2, d / 2, 0.016), (w / 2, d / 2, 0.016), 0.014).named("leg", tone.metal()))
    return out


@kind("office chair", palette="fabric")
def office_chair(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, seat = rng.uniform(0.46, 0.54), rng.uniform(0.46, 0.52), rng.uniform(0.44, 0.52)
    mat, metal, black = tone.textile(0.07, 0.85), tone.metal(), tone.plain("#222326")
    out = _star_base(rng.uniform(0.27, 0.33), seat - 0.07, metal, black)
    out.append(cushion(w, d, 0.1, (0, 0, seat - 0.08)).named("seat", mat))
    h, curveback = rng.uniform(0.42, 0.7), rng.uniform(0.3, 0.6)
    back = (
        cushion(w * rng.uniform(0.8, 0.98), h, 0.09, square=curveback)
        .turned("x", 90)
        .moved(0, d / 2 + 0.03, seat + 0.08 + h / 2)
    )
    out += [
        back.turned("x", -8, (0, d / 2, seat)).named("back", mat),
        rod((0, d * 0.2, seat - 0.06), (0, d / 2 + 0.08, seat + 0.2), 0.02).named("frame", metal),
    ]
    if chance(rng, 0.65):
        for s in (-1, 1):
            x = s * (w / 2 + 0.03)
            armrest = boxes([(0.035, 0.04, 0.22, x, 0.02, seat - 0.03), (0.06, 0.26, 0.03, x, 0, seat + 0.19)])
            out.append(armrest.named("armrest", black))
    if chance(rng, 0.3):
        y, z = d / 2 + 0.03, seat + 0.05 + h
        head = cushion(0.28, 0.16, 0.07).turned("x", 90).moved(0, y + 0.03, z + 0.12)
        stem = rod((0, y, z - 0.1), (0, y, z + 0.1), 0.014)
        out += [head.turned("x", -8, (0, d / 2, seat)).named("headrest", mat)]
        out += [stem.turned("x", -8, (0, d / 2, seat)).named("headrest stem", metal, 1.2)]
    return out


def _sofa_body(rng: Rng, tone: Tone, w: float, seats: int) -> list[Piece]:
    """Armchairs and sofas: base, arms, back, seat cushions and legs of one of several styles."""
    d, seat, back = rng.uniform(0.8, 0.95), rng.uniform(0.4, 0.46), rng.uniform(0.72, 0.95)
    arm, high = rng.uniform(0.1, 0.24), rng.uniform(0.54, 0.66)
    mat, style = tone.textile(0.12, 0.65), int(rng.integers(4))
    foot = rng.uniform(0.05, 0.16)
    inner = w - 2 * arm
    out = [box(w - 0.04, d - 0.04, seat - foot - 0.12, (0, 0, foot), 0.02).named("base", mat)]
    if style == 0:  # square track arms
        out += [box(arm, d, high - foot, (s * (w - arm) / 2, 0, foot), 0.025).named("arm", mat) for s in (-1, 1)]
    elif style == 1:  # rolled arms
        for s in (-1, 1):
            roll = cylinder(arm * 0.58, d, bevel=0.02).turned("x", -90)
            out += [
                box(arm * 0.75, d, high - foot - arm / 2, (s * (w - arm) / 2, 0, foot), 0.02).named("arm", mat),
                roll.moved(s * (w - arm * 1.1) / 2, -d / 2, high - arm * 0.5).named("arm", mat),
            ]
    elif style == 2:  # soft
        out += [
            cushion(arm * 1.15, d, high - foot, (s * (w - arm) / 2, 0, foot), 0.4).named("arm", mat) for s in (-1, 1)
        ]
    else:  # open wooden arms
        wood = tone.wood()
        for s in (-1, 1):
            x = s * (w / 2 - 0.03)
            posts = [(0.05, 0.05, high, x, t * (d / 2 - 0.06), 0) for t in (-1, 1)]
            out.append(boxes([*posts, (0.07, d, 0.035, x, 0, high)]).named("arm", wood.along(1)))
        inner = w - 0.14
    thick = rng.uniform(0.16, 0.24)
    if style == 2 or chance(rng, 0.3):
        shell = cushion(w - 0.04, thick * 1.2, back - foot, (0, d / 2 - thick * 0.6, foot), 0.3)
    else:
        shell = box(w - 0.02, thick * 0.8, back - foot, (0, d / 2 - thick * 0.4, foot), 0.03)
    out.append(shell.named("back", mat))
    n = seats if chance(rng, 0.8) else 1
    each, deep = inner / n, d - thick * 0.9
    for k in range(n):
        x = -inner / 2 + each * (k + 0.5)
        out.append(cushion(each - 0.008, deep, 0.17, (x, -d / 2 + deep / 2, seat - 0.14), 0.22).named("seat", mat))
        if back > 0.78:
            lean = cushion(each * 0.97, 0.15, back - seat - 0.02, (x, d / 2 - thick * 1.15, seat + 0.01), 0.35)
            out.append(lean.turned("x", -6, (0, d / 2 - thick, seat)).named("back cushion", mat))
    out.append(tapered_legs(rng, w - 0.08, d - 0.08, foot + 0.02, 0.05).named("leg", tone.frame().along(2), 1.2))
    if chance(rng, 0.45):
        scatter = tone.accent()
        for s in (-1, 1)[: int(rng.integers(1, 3))]:
            p = (
                pillow(0.42, 0.42, 0.14)
                .turned("x", 68)
                .turned("z", 12 * s)
                .moved(s * max(inner / 2 - 0.24, 0), d / 2 - thick - 0.2, seat + 0.2)
            )
            out.append(p.named("pillow", scatter))
    return out


@kind("armchair", palette="fabric")
def armchair(rng: Rng, tone: Tone) -> list[Piece]:
    if chance(rng, 0.25):  # a tub chair: one shell for back and arms
        r, seat, h = rng.uniform(0.36, 0.42), 0.42, rng.uniform(0.7, 0.85)
        mat = tone.textile(0.1)
        a = np.radians(np.linspace(-35, 215, 31))[None]
        t = np.linspace(0, 1, 9)[:, None]
        top = 0.58 + (h - 0.58) * np.clip(np.sin(a), 0, 1) ** 1.5
        walls = []
        for rr, flip in ((r, 1), (r - 0.09, -1)):
            z = 0.12 + (top - 0.12) * t
            grid = np.stack([rr * np.cos(a) + 0 * t, rr * np.sin(a) + 0 * t, z], axis=-1)
            walls.append(shell(grid if flip < 0 else grid[::-1]))
        lip = tube(np.stack([(r - 0.045) * np.cos(a[0]), (r - 0.045) * np.sin(a[0]), top[0]], 1), 0.05)
        return [
            join(*walls, lip).named("shell", mat),
            cushion(2 * r - 0.16, 2 * r - 0.14, 0.18, (0, -0.05, seat - 0.16), 0.6).named("seat", mat),
            cylinder(r - 0.02, 0.2, (0, 0, 0.1)).named("base", mat),
            legs4(0.5, 0.5, 0.12, 0.04).named("leg", tone.wood()),
        ]
    return _sofa_body(rng, tone, rng.uniform(0.75, 0.98), 1)


@kind("sofa", palette="fabric")
def sofa(rng: Rng, tone: Tone) -> list[Piece]:
    seats = int(rng.choice([2, 3, 3]))
    w = 0.4 + seats * rng.uniform(0.56, 0.66)
    return _sofa_body(rng, tone, w, seats)


@kind("stool")
def stool(rng: Rng, tone: Tone) -> list[Piece]:
    h, r = rng.choice([rng.uniform(0.42, 0.5), rng.uniform(0.62, 0.78)]), rng.uniform(0.15, 0.2)
    style, mat = int(rng.integers(4)), tone.main
    frame = mat if chance(rng, 0.5) else tone.frame()
    if style == 0:
        top = cylinder(r, 0.04, (0, 0, h - 0.04), bevel=0.012)
    elif style == 1:
        top = extrude(rounded_rectangle(2 * r, 2 * r, 0.05), 0.035, 0.01).moved(0, 0, h - 0.035)
    elif style == 2:
        top = cushion(2.1 * r, 2.1 * r, 0.1, (0, 0, h - 0.08), 1.0)
        mat = tone.textile(0.05)
    else:
        top = box(2.4 * r, 1.5 * r, 0.05, (0, 0, h - 0.05), 0.015)
    out = [top.named("seat", mat.along(1))]
    if style == 2 and chance(rng, 0.6):
        out += [
            cylinder(0.025, h - 0.08, (0, 0, 0.02)).named("column", tone.metal()),
            cylinder(r * 1.05, 0.025, bevel=0.01).named("base", tone.metal()),
            ring(r * 0.8, 0.01, (0, 0, h * 0.35)).named("footrest", tone.metal()),
        ]
        return out
    count, splay = int(rng.choice([3, 4, 4])), rng.uniform(0.0, 0.06)
    turns = [2 * np.pi * (k + 0.5) / count for k in range(count)]
    low, up = r * 0.9 + splay, r * 0.72
    leg = join(*(rod(polar(low, a), polar(up, a, h - 0.03), 0.014, 0.02) for a in turns))
    out.append(leg.named("leg", frame.along(2), 1.2))
    if chance(rng, 0.6):
        out.append(ring((low * 0.65 + up * 0.35), 0.009, (0, 0, h * 0.35)).named("footrest", frame, 1.2))
    return out


@kind("bench", palette="wood")
def bench(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h = rng.uniform(1.0, 1.6), rng.uniform(0.34, 0.45), rng.uniform(0.42, 0.48)
    mat, style = tone.main, int(rng.integers(4))
    out: list[Piece] = []
    if style == 0:
        out.append(box(w, d, 0.05, (0, 0, h - 0.05), 0.01).named("seat", mat.along(0)))
    elif style == 1:
        n = 4
        seat = boxes([(w, d / n - 0.015, 0.03, 0, (k + 0.5) * d / n - d / 2, h - 0.03) for k in range(n)])
        out.append(seat.named("seat", mat.along(0)))
    else:
        out += [
            box(w, d, 0.06, (0, 0, h - 0.13), 0.01).named("seat", mat.along(0)),
            cushion(w, d, 0.1, (0, 0, h - 0.08), 0.2).named("cushion", tone.textile(0.1)),
        ]
    if style == 1 or chance(rng, 0.25):
        slats = [(w, 0.025, 0.08, 0, d / 2, h + 0.12 + 0.13 * k) for k in range(3)]
        posts = [(0.05, 0.05, 0.95 - h + h, s * (w / 2 - 0.1), d / 2 + 0.03, 0) for s in (-1, 1)]
        out += [
            boxes(slats).named("back", mat.along(0)),
            boxes([(a, b, 0.88, x, y, z) for a, b, _, x, y, z in posts]).named("leg", mat.along(2)),
        ]
    if chance(rng, 0.5):
        leg = legs4(w - 0.06, d - 0.02, h - 0.05, 0.055)
        out.append(leg.named("leg", (mat if chance(rng, 0.6) else tone.metal()).along(2)))
    else:
        out.append(
            boxes([(0.05, d - 0.02, h - 0.05, s * (w / 2 - 0.12), 0, 0) for s in (-1, 1)]).named("leg", mat.along(2))
        )
    return out


@kind("ottoman", palette="fabric")
def ottoman(rng: Rng, tone: Tone) -> list[Piece]:
    w, h, mat = rng.uniform(0.45, 0.75), rng.uniform(0.34, 0.45), tone.textile(0.07, 0.4)
    if chance(rng, 0.4):
        seams = [
            rod(polar(0.25 * w, a, h * 0.97), polar(0.499 * w, a, h / 2), 0.004) for a in np.linspace(0, 6.28, 9)[:-1]
        ]
        return [blob_seat(w, h).named("seat", mat), join(*seams).named("seam", mat.shaded(0.6))]
    d, foot = w * rng.uniform(0.7, 1.0), rng.uniform(0.05, 0.14)
    return [
        box(w, d, h - foot - 0.1, (0, 0, foot), 0.02).named("base", mat),
        cushion(w * 1.01, d * 1.01, 0.15, (0, 0, h - 0.15), 0.2).named("seat", mat),
        tapered_legs(rng, w, d, foot, 0.045).named("leg", tone.frame(), 1.2),
    ]


def blob_seat(w: float, h: float) -> Piece:
    """A round stuffed pouf."""
    return lathe(
        [(0, 0), (w * 0.38, 0.0), (w * 0.49, h * 0.25), (w * 0.5, h * 0.6), (w * 0.4, h * 0.95), (0, h)], smooth=15
    )


@kind("bed", palette="fabric")
def bed(rng: Rng, tone: Tone) -> list[Piece]:
    w, d = float(rng.choice([0.95, 1.4, 1.65])) + rng.uniform(0, 0.15), rng.uniform(2.0, 2.15)
    base, painted = rng.uniform(0.26, 0.36), chance(rng, 0.3) or tone.asked
    frame = tone.wood() if chance(rng, 0.7) else tone.plain(str(rng.choice(["#e9e6df", "#2c2b2c", "#6f7278"])))
    frame = tone.main if painted else frame
    cover, linen = tone.textile(0.18, 0.55), tone.plain(str(rng.choice(["#f4f1ea", "#e9edf2", "#f2e9dc"])))
    style, head = int(rng.integers(4)), rng.uniform(0.85, 1.25)
    out = [
        box(w, d, 0.16, (0, 0, base - 0.16), 0.01).named("frame", frame.along(1)),
        cushion(w - 0.04, d - 0.08, 0.24, (0, -0.01, base - 0.02), 0.12).named("mattress", linen),
    ]
    y = d / 2 - 0.03
    if style == 0:
        out.append(box(w, 0.05, head, (0, y, 0), 0.012).named("headboard", frame.along(0)))
    elif style == 1:
        n = 9
        bars = [(0.035, 0.03, head - 0.1, (k / (n - 1) - 0.5) * (w - 0.05), y, 0) for k in range(n)]
        out.append(boxes([*bars, (w, 0.05, 0.06, 0, y, head - 0.08)]).named("headboard", frame.along(2)))
    elif style == 2:
        pads = [
            cushion(w / 4 - 0.005, head - 0.2, 0.1, square=0.25)
            .turned("x", 90)
            .moved((k - 1.5) * w / 4, y + 0.05, head / 2 + 0.1)
            for k in range(4)
        ]
        out += [join(*pads).named("headboard", cover), box(w, 0.04, head, (0, y, 0)).named("headboard", frame)]
    else:
        plate = (
            extrude(rounded_rectangle(w, head * 1.2, 0.35), 0.06, 0.02).turned("x", 90).moved(0, y + 0.03, head * 0.4)
        )
        out.append(clipped_below(plate, 0.0).named("headboard", frame.along(0)))
    over = d - rng.uniform(0.4, 0.62)
    blanket = drape(w - 0.01, over, base + 0.232, rng.uniform(0.12, base + 0.1)).moved(0, (over - d) / 2 - 0.005)
    out.append(blanket.named("blanket", cover))
    n = 1 if w < 1.2 else 2
    for k in range(n):
        p = (
            pillow(min(w / n - 0.06, 0.68), 0.42, 0.17)
            .turned("x", 14)
            .moved((k - (n - 1) / 2) * w / n, d / 2 - 0.34, base + 0.31)
        )
        out.append(p.named("pillow", linen if chance(rng, 0.6) else cover))
    out.append(legs4(w - 0.06, d - 0.06, base - 0.1, 0.07).named("leg", frame.along(2)))
    return out


@kind("cushion")
def throw_cushion(rng: Rng, tone: Tone) -> list[Piece]:
    w, thick, mat = rng.uniform(0.36, 0.5), rng.uniform(0.13, 0.19), tone.textile(0.06, 0.35)
    if chance(rng, 0.2):
        return [
            cylinder(w * 0.22, w, bevel=0.05).turned("y", 90).moved(-w / 2, 0, w * 0.22).named("cushion", mat),
            ring(w * 0.22, 0.006, (-w / 2 + 0.04, 0, w * 0.22), "x").named("piping", mat.shaded(0.6)),
            ring(w * 0.22, 0.006, (w / 2 - 0.04, 0, w * 0.22), "x").named("piping", mat.shaded(0.6)),
        ]
    h = w if chance(rng, 0.6) else w * 0.68
    body = pillow(w, h, thick).turned("x", 72).moved(0, 0, h / 2)
    out = [body.named("cushion", mat)]
    if chance(rng, 0.35):
        out.append(ball(0.014, (0, -thick * 0.48, h * 0.5 + 0.02)).named("button", mat.shaded(0.55), 1.5))
    return out
