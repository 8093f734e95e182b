"""Plain solids for things that no builder draws: a boulder, a fence, a cart; each fills a box of a given size.

`solid` takes the name of a shape, as `world/everyday.json` has it for classes of nouns.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, pi, sin

import numpy as np

from ...camera import Vec3
from ...color import Rgb, shade_of
from .materials import Material, shade
from .round_shapes import ball, blob, cylinder, lathe, rod
from .shapes import Piece, box, join, quad

Solid = Callable[[float, float, float, Material, Material], list[Piece]]
_DEFAULT = {"rock": "gray", "tree": "green", "bush": "green", "disc": "green", "post": "gray", "tub": "gray"}
_STEM: Rgb = (0.36, 0.25, 0.16)


def solid(shape: str, size: Vec3, rgb: Rgb | None) -> list[Piece] | None:
    """The pieces of a shape in a box of `size` (width, depth, height, metres) on z = 0; None if no shape has this name.

    Args:
        rgb: main colour; None takes a usual one of the shape.
    """
    if shape not in _SOLIDS:
        return None
    color = shade_of(_DEFAULT.get(shape, "brown")) if rgb is None else rgb
    return _SOLIDS[shape](*size, Material(color, main=True), Material(shade(color, 0.6)))


def _rock(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    small = blob(0.55 * w, 0.6 * d, 0.6 * h, (0.2 * w, -0.18 * d, 0.3 * h), 0.8, 0.7).named("side", dark)
    return [blob(0.9 * w, 0.9 * d, h, (-0.05 * w, 0.05 * d, h / 2), 0.75, 0.8).named("rock", main), small]


def _tree(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    stem = Material(_STEM)
    crowns = [
        blob(0.62 * w, 0.62 * d, 0.36 * h, (0.19 * w * cos(a), 0.19 * d * sin(a), 0.68 * h + 0.06 * h * (k % 2)))
        for k, a in enumerate(2 * pi * i / 5 for i in range(5))
    ]
    trunk = cylinder(0.07 * w, 0.62 * h, top=0.045 * w).named("trunk", stem)
    top = blob(0.7 * w, 0.7 * d, 0.34 * h, (0, 0, 0.83 * h)).named("crown", main)
    return [trunk, join(*crowns).named("leaves", dark), top]


def _bush(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    sides = [blob(0.6 * w, 0.6 * d, 0.7 * h, (0.2 * w * cos(a), 0.2 * d * sin(a), 0.36 * h))
             for a in (0.4, 2.0, 3.6, 5.2)]  # fmt: skip
    return [join(*sides).named("leaves", dark), blob(0.7 * w, 0.7 * d, 0.75 * h, (0, 0, 0.62 * h)).named("bush", main)]


def _planter(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    del dark
    high = 0.6 * h
    soil = box(0.94 * w, 0.94 * d, 0.02, (0, 0, high - 0.03)).named("soil", Material((0.22, 0.15, 0.1)))
    count = max(2, round(w / 0.35))
    leaves = [blob(0.8 * w / count, 0.7 * d, 0.42 * h, ((k + 0.5) / count * w - w / 2, 0, high + 0.18 * h))
              for k in range(count)]  # fmt: skip
    green = Material(shade_of("green"))
    return [box(w, d, high).named("box", main), soil, join(*leaves).named("plants", green)]


def _disc(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    del dark
    return [blob(w, d, h, (0, 0, h / 2), 0.7, 0.3).named("patch", main)]


def _slab(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    del dark
    return [box(w, d, h).named("slab", main)]


def _fence(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    count = max(3, round(w / 0.16))
    slats = [
        box(0.55 * w / count, 0.4 * d, 0.96 * h, ((k + 0.5) / count * w - w / 2, -0.2 * d, 0)) for k in range(count)
    ]
    rails = [box(w, 0.45 * d, 0.06 * h, (0, 0.2 * d, z * h)) for z in (0.2, 0.75)]
    ends = [box(min(0.08, 0.1 * w), d, h, (s * (w / 2 - min(0.04, 0.05 * w)), 0, 0)) for s in (-1, 1)]
    return [join(*slats).named("slats", main), join(*rails, *ends).named("rails", dark)]


def _frame(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    del dark
    thick = 0.1 * w
    posts = [box(thick, d, h, (s * (w - thick) / 2, 0, 0)) for s in (-1, 1)]
    return [join(*posts, box(w, d, 0.1 * h, (0, 0, 0.9 * h))).named("frame", main)]


def _canopy(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    posts = [
        box(0.08, 0.08, 0.92 * h, (sx * (w / 2 - 0.05), sy * (d / 2 - 0.05), 0)) for sx in (-1, 1) for sy in (-1, 1)
    ]
    beams = [box(w, 0.06, 0.05 * h, (0, (k / 6 - 0.5) * 0.96 * d, 0.95 * h)) for k in range(7)]
    return [join(*posts).named("posts", dark), join(*beams, box(w, d, 0.04 * h, (0, 0, 0.91 * h))).named("roof", main)]


def _parasol(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    cloth = _oval(
        lathe([(0, 0.8 * h), (w / 2, 0.78 * h), (w / 2, 0.81 * h), (0.25 * w, 0.92 * h), (0, 0.99 * h)]), w, d
    )
    pole = join(cylinder(0.03, h), cylinder(0.12 * w, 0.04 * h))
    return [cloth.named("cloth", main), pole.named("pole", dark)]


def _bunting(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    count = max(3, round(w / 0.22))
    flags = []
    for k in range(count):
        x, half = ((k + 0.5) / count - 0.5) * w, 0.4 * w / count
        flags.append(quad([(x - half, 0, h), (x + half, 0, h), (x, 0, 0), (x, 0, 0)]))
    return [box(w, d, 0.06 * h, (0, 0, 0.94 * h)).named("line", dark), join(*flags).named("flags", main)]


def _house(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    wall, deep = 0.68 * h, 0.94 * d
    sides = [
        quad([(s * w / 2, -d / 2, wall), (s * w / 2, d / 2, wall), (0, -d / 2, h), (0, d / 2, h)]) for s in (-1, 1)
    ]
    gables = [quad([(-0.47 * w, y, wall), (0.47 * w, y, wall), (0, y, h), (0, y, h)]) for y in (-deep / 2, deep / 2)]
    door = box(0.3 * w, 0.02, 0.8 * wall, (0, -deep / 2 - 0.01, 0))
    roof = [*sides, box(w, d, 0.01, (0, 0, wall - 0.01))]
    return [join(box(0.94 * w, deep, wall), *gables).named("walls", main), join(*roof, door).named("roof", dark)]


def _post(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    r = min(w, d) / 2
    foot = cylinder(r, 0.06 * h).named("foot", dark)
    return [foot, cylinder(0.4 * r, 0.8 * h, (0, 0, 0.06 * h)).named("post", main),
            blob(w, d, 0.16 * h, (0, 0, 0.92 * h), 1.0, 0.5).named("head", dark)]  # fmt: skip


def _oval(piece: Piece, w: float, d: float) -> Piece:
    """A round piece of width `w`, made `d` deep."""
    return piece.transformed(np.diag([1.0, d / w, 1.0]), (0, 0, 0))


def _tub(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    r = w / 2
    rim = lathe([(0, 0), (0.92 * r, 0), (r, h), (0.86 * r, h), (0.84 * r, 0.78 * h)])
    water = cylinder(0.85 * r, 0.02, (0, 0, 0.76 * h))
    return [_oval(rim, w, d).named("rim", main), _oval(water, w, d).named("inside", dark)]


def _lounger(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    seat, long = 0.55 * h, 0.66 * d
    back = quad([(-w / 2, 0.16 * d, seat), (w / 2, 0.16 * d, seat), (-w / 2, d / 2, h), (w / 2, d / 2, h)])
    legs = [box(0.05, 0.05, seat, (sx * 0.45 * w, y * d, 0)) for sx in (-1, 1) for y in (-0.42, 0.14)]
    frame = join(
        box(w, long, 0.12 * h, (0, -0.17 * d, seat - 0.12 * h)), box(w, 0.03, 0.1 * h, (0, 0.485 * d, 0.9 * h))
    )
    return [join(frame, back).named("seat", main), join(*legs).named("legs", dark)]


def _hammock(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    sag = [(x / 6 - 0.5) * 0.86 for x in range(7)]
    low = [0.3 * h + 0.6 * h * (2 * x) ** 2 for x in sag]
    strips = [
        quad([(sag[k] * w, -d / 2, low[k]), (sag[k] * w, d / 2, low[k]),
              (sag[k + 1] * w, -d / 2, low[k + 1]), (sag[k + 1] * w, d / 2, low[k + 1])])
        for k in range(6)
    ]  # fmt: skip
    posts = [box(0.07, 0.07, h, (s * (w / 2 - 0.035), 0, 0)) for s in (-1, 1)]
    feet = [box(0.08, 0.8 * d, 0.05, (s * (w / 2 - 0.04), 0, 0)) for s in (-1, 1)]
    return [join(*strips).named("cloth", main), join(*posts, *feet).named("stand", dark)]


def _bridge(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    rise = [0.35 * h * (1 - (2 * (k + 0.5) / 9 - 1) ** 2) for k in range(9)]
    planks = [box(0.95 * w / 9, d, 0.08 * h, ((k + 0.5) / 9 * w - w / 2, 0, z)) for k, z in enumerate(rise)]
    rails = [rod((-w / 2, s * 0.47 * d, 0.55 * h), (0, s * 0.47 * d, 0.97 * h), 0.02) for s in (-1, 1)]
    rails += [rod((w / 2, s * 0.47 * d, 0.55 * h), (0, s * 0.47 * d, 0.97 * h), 0.02) for s in (-1, 1)]
    posts = [box(0.05, 0.05, 0.6 * h, (x * w, s * 0.47 * d, 0)) for s in (-1, 1) for x in (-0.48, 0.48)]
    return [join(*planks).named("planks", main), join(*rails, *posts).named("rails", dark)]


def _wheel(r: float, thick: float, x: float, y: float) -> Piece:
    return cylinder(r, thick).turned("y", 90).moved(x - thick / 2, y, r)


def _bike(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    r = min(0.17 * d, 0.3 * h)
    wheels = join(_wheel(r, 0.12 * w, 0, -d / 2 + r), _wheel(r, 0.12 * w, 0, d / 2 - r))
    body = blob(0.35 * w, 0.5 * d, 0.34 * h, (0, 0, 0.55 * h), 0.6, 0.7)
    seat = blob(0.3 * w, 0.3 * d, 0.12 * h, (0, 0.16 * d, 0.74 * h), 0.5, 0.6)
    bar = rod((-w / 2, -0.3 * d, 0.97 * h), (w / 2, -0.3 * d, 0.97 * h), 0.025)
    fork = rod((0, -d / 2 + r, r), (0, -0.3 * d, 0.97 * h), 0.03)
    return [wheels.named("wheels", Material((0.08, 0.08, 0.08))), join(body).named("body", main),
            join(seat, bar, fork).named("seat", dark)]  # fmt: skip


def _car(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    r = min(0.16 * d, 0.24 * h)
    wheels = [_wheel(r, 0.14 * w, s * 0.43 * w, y * d) for s in (-1, 1) for y in (-0.31, 0.31)]
    body = blob(w, d, 0.5 * h, (0, 0, 0.42 * h), 0.2, 0.4).named("body", main)
    cabin = blob(0.86 * w, 0.56 * d, 0.56 * h, (0, 0.04 * d, 0.72 * h), 0.25, 0.5).named("cabin", dark)
    return [body, cabin, join(*wheels).named("wheels", Material((0.08, 0.08, 0.08)))]


def _boat(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    sides = lathe(
        [(0, 0), (0.3 * w, 0), (0.46 * w, 0.6 * h), (w / 2, h), (0.42 * w, h), (0.3 * w, 0.3 * h), (0, 0.2 * h)]
    )
    benches = [box(0.7 * w, 0.06 * d, 0.05 * h, (0, y * d, 0.7 * h)) for y in (-0.2, 0.2)]
    return [_oval(sides, w, d).named("hull", main), join(*benches).named("benches", dark)]


def _cart(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    r = min(0.2 * h, 0.16 * d)
    tray = [box(w, 0.7 * d, 0.05 * h, (0, -0.1 * d, 0.35 * h)),
            *(box(0.04 * w, 0.7 * d, 0.35 * h, (s * 0.48 * w, -0.1 * d, 0.35 * h)) for s in (-1, 1)),
            *(box(w, 0.03 * d, 0.35 * h, (0, y * d, 0.35 * h)) for y in (-0.44, 0.235))]  # fmt: skip
    wheels = [_wheel(r, 0.1 * w, s * 0.38 * w, y * d) for s in (-1, 1) for y in (-0.34, 0.12)]
    handle = [rod((s * 0.4 * w, 0.23 * d, 0.6 * h), (s * 0.4 * w, 0.48 * d, 0.97 * h), 0.02) for s in (-1, 1)]
    grip = rod((-0.4 * w, 0.48 * d, 0.97 * h), (0.4 * w, 0.48 * d, 0.97 * h), 0.025)
    return [join(*tray).named("tray", main), join(*wheels, *handle, grip).named("wheels", dark)]


def _board(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    del dark
    return [blob(w, 0.5 * d, h, (0, 0.1 * d, h / 2), 0.3, 0.35).named("board", main),
            box(0.6 * w, d, 0.04 * h).named("foot", main)]  # fmt: skip


def _cage(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    bars = []
    for k in range(10):
        a = ((k + 0.5) / 10 - 0.5) * 0.94
        bars += [rod((a * w, s * 0.47 * d, 0.06 * h), (a * w, s * 0.47 * d, 0.94 * h), 0.008) for s in (-1, 1)]
        bars += [rod((s * 0.47 * w, a * d, 0.06 * h), (s * 0.47 * w, a * d, 0.94 * h), 0.008) for s in (-1, 1)]
    plates = join(box(w, d, 0.06 * h), box(w, d, 0.05 * h, (0, 0, 0.95 * h)))
    return [plates.named("plates", main), join(*bars).named("bars", dark)]


def _sack(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    return [blob(w, d, 0.85 * h, (0, 0, 0.425 * h), 0.6, 0.6).named("sack", main),
            blob(0.3 * w, 0.3 * d, 0.25 * h, (0, 0, 0.875 * h)).named("tie", dark)]  # fmt: skip


def _barrel(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    r = w / 2
    staves = lathe([(0, 0), (0.8 * r, 0), (r, 0.5 * h), (0.8 * r, h), (0, h)], smooth=16)
    hoops = [lathe([(f * r, z * h), (f * r + 0.008, z * h), (f * r + 0.008, (z + 0.05) * h), (f * r, (z + 0.05) * h)])
             for f, z in ((0.88, 0.14), (0.88, 0.8))]  # fmt: skip
    return [_oval(staves, w, d).named("staves", main), _oval(join(*hoops), w, d).named("hoops", dark)]


def _logs(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    r = min(h / 6, w / 8)
    rows = max(1, int(h / (2 * r)))
    across = max(1, int(w / (2 * r)))
    logs, ends = [], []
    for j in range(rows):
        for k in range(across - j % 2):
            x = (k + 0.5 + 0.5 * (j % 2)) * w / across - w / 2
            z = (j + 0.5) * h / rows
            logs.append(rod((x, -0.49 * d, z), (x, 0.49 * d, z), r))
            ends.append(cylinder(0.9 * r, 0.01).turned("x", 90).moved(x, -0.49 * d, z))
    return [join(*logs).named("logs", main), join(*ends).named("ends", dark)]


def _harp(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    post = rod((0, -0.42 * d, 0.05 * h), (0, -0.42 * d, h), 0.05 * w)
    neck = rod((0, -0.42 * d, 0.97 * h), (0, 0.42 * d, 0.72 * h), 0.06 * w)
    body = rod((0, -0.2 * d, 0.08 * h), (0, 0.42 * d, 0.74 * h), 0.22 * w, 0.1 * w)
    strings = []
    for k in range(8):
        y = (-0.34 + 0.09 * k) * d
        top = (0.95 - 0.25 * (y / d + 0.42) / 0.84) * h
        strings.append(rod((0, y, (0.1 + 0.08 * k) * h), (0, y, top), 0.006))
    foot = box(w, 0.7 * d, 0.06 * h)
    return [join(post, neck, body, foot).named("frame", main), join(*strings).named("strings", dark)]


def _poster(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    picture = box(0.88 * w, 0.02, 0.88 * h, (0, -d / 2 + 0.005, 0.06 * h))
    return [box(w, 0.8 * d, h, (0, 0.1 * d, 0)).named("frame", dark), picture.named("board", main)]


def _wall_lamp(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    plate = box(0.6 * w, 0.12 * d, 0.5 * h, (0, 0.44 * d, 0))
    head = _oval(lathe([(0, 0.35 * h), (w / 2, 0.35 * h), (0.3 * w, h), (0, h)]), w, 0.8 * d).moved(0, -0.1 * d, 0)
    return [join(plate, rod((0, 0.4 * d, 0.2 * h), (0, -0.1 * d, 0.4 * h), 0.02)).named("arm", dark),
            head.named("head", main)]  # fmt: skip


def _animal(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    body = blob(0.9 * w, 0.66 * d, 0.4 * h, (0, 0.08 * d, 0.58 * h), 0.8, 0.8)
    neck = rod((0, -0.18 * d, 0.66 * h), (0, -0.36 * d, 0.85 * h), 0.16 * w, 0.12 * w)
    head = blob(0.4 * w, 0.26 * d, 0.24 * h, (0, -0.38 * d, 0.87 * h))
    legs = [cylinder(0.09 * w, 0.5 * h, (sx * 0.28 * w, y * d, 0)) for sx in (-1, 1) for y in (-0.16, 0.3)]
    tail = rod((0, 0.38 * d, 0.62 * h), (0, 0.49 * d, 0.4 * h), 0.04 * w)
    return [join(body, neck, head).named("body", main), join(*legs, tail).named("legs", dark)]


def _figure(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    head = ball(0.068 * h, (0, 0, 0.932 * h))
    torso = blob(0.72 * w, 0.8 * d, 0.34 * h, (0, 0, 0.68 * h), 0.7, 0.7)
    arms = [rod((s * 0.36 * w, 0, 0.8 * h), (s * 0.46 * w, 0, 0.46 * h), 0.09 * w, 0.06 * w) for s in (-1, 1)]
    skirt = cylinder(0.36 * w, 0.5 * h, (0, 0, 0.03 * h), top=0.26 * w)
    return [join(head, torso, *arms, skirt).named("figure", main), box(w, d, 0.04 * h).named("foot", dark)]


def _tent(w: float, d: float, h: float, main: Material, dark: Material) -> list[Piece]:
    sides = [quad([(s * w / 2, -d / 2, 0), (s * w / 2, d / 2, 0), (0, -d / 2, h), (0, d / 2, h)]) for s in (-1, 1)]
    back = quad([(-w / 2, d / 2, 0), (w / 2, d / 2, 0), (0, d / 2, h), (0, d / 2, h)])
    front = [quad([(s * w / 2, -d / 2, 0), (s * 0.16 * w, -d / 2, 0), (0, -d / 2, h), (0, -d / 2, h)]) for s in (-1, 1)]
    return [join(*sides, back).named("cloth", main), join(*front).named("door", dark)]


_SOLIDS: dict[str, Solid] = {
    "rock": _rock, "tree": _tree, "bush": _bush, "planter": _planter, "disc": _disc, "slab": _slab, "fence": _fence,
    "frame": _frame, "canopy": _canopy, "parasol": _parasol, "bunting": _bunting, "house": _house, "post": _post,
    "tub": _tub, "lounger": _lounger, "hammock": _hammock, "bridge": _bridge, "bike": _bike, "car": _car,
    "boat": _boat, "cart": _cart, "board": _board, "cage": _cage, "sack": _sack, "barrel": _barrel, "logs": _logs,
    "harp": _harp, "poster": _poster, "wall lamp": _wall_lamp, "animal": _animal, "figure": _figure, "tent": _tent,
}  # fmt: skip
SHAPES = tuple(_SOLIDS)
