"""Builders of furniture and appliances of bathrooms and laundries. Each builder returns the pieces of one design."""

from __future__ import annotations

import numpy as np

from ..modeling.materials import STEEL, Material, Tone
from ..modeling.parts import CORNERS, Rng, chance, fronts
from ..modeling.round_shapes import blob, cylinder, disc, lathe, ring, rod, tube
from ..modeling.shapes import Array, Piece, Sheets, box, boxes, extrude, join, panel, rounded_rectangle
from ..registry import kind

Rows = list[tuple[float, ...]]


def _tap(x: float, y: float, z: float, high: float, steel: Material) -> Piece:
    """A tap with a lever and a curved spout towards -y."""
    path = [(x, y, z), (x, y, z + high * 0.7), (x, y - 0.04, z + high), (x, y - 0.1, z + high * 0.82)]
    return join(tube(path, 0.011, smooth=13), rod((x, y, z + high * 0.5), (x + 0.06, y, z + high * 0.62), 0.007)).named(
        "tap", steel
    )


def _basin(outline: Array, h: float, inner: float, deep: float) -> Piece:
    """A hollow block with the outline `outline [M, 2]`: outer wall, rim, and a rounded tub `deep` below the rim."""
    o = np.concatenate([outline, outline[:1]])[::-1]
    centre = outline.mean(axis=0)

    def level(scale: float, z: float) -> Array:
        return np.concatenate([centre + (o - centre) * scale, np.full((len(o), 1), z)], axis=1)

    walls = np.stack([level(0.82, 0.0), level(1.0, h * 0.55), level(1.0, h)])
    rim = np.stack([level(1.0, h), level(inner, h)])
    tub = np.stack(
        [level(inner, h), level(inner * 0.93, h - deep * 0.55), level(inner * 0.8, h - deep), level(0.0, h - deep)]
    )
    return Piece(tuple(Sheets(g[None], True, False, True) for g in (walls, rim, tub)))


@kind("bathtub", palette="light")
def bathtub(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, style = rng.uniform(1.5, 1.8), rng.uniform(0.7, 0.82), rng.uniform(0.54, 0.62), int(rng.integers(3))
    if not tone.asked:
        tone.color = (0.95, 0.95, 0.94)
    white, steel = Material(tone.color, main=True), Material((0.8, 0.81, 0.83), "brushed")
    round_off = {0: 0.06, 1: d / 2 - 0.01, 2: 0.25}[style]
    outline = rounded_rectangle(w, d, round_off, 8)
    out: list[Piece] = []
    if style == 0:  # built in
        out.append(_panelled(w, d, h, white))
        out.append(_basin(outline, h, 0.86, h * 0.78).named("tub", white))
    else:
        lift = 0.1 if style == 1 else 0.0
        out.append(_basin(outline, h - lift, 0.9, (h - lift) * 0.82).moved(0, 0, lift).named("tub", white))
        if lift:
            feet = [blob(0.07, 0.07, 0.13, (sx * w * 0.3, sy * d * 0.24, 0.06)) for sx, sy in CORNERS]
            out.append(join(*feet).named("foot", tone.metal()))
    end = -w / 2 + 0.07
    out.append(_tap(0, 0, 0, 0.16, steel).turned("z", 90).moved(end, 0, h - 0.02).named("tap", steel))
    if chance(rng, 0.4):
        towel = boxes(
            [(0.32, 0.02, 0.34, w * 0.22, -d / 2 - 0.012, h - 0.34), (0.32, 0.12, 0.02, w * 0.22, -d / 2 + 0.04, h)],
            0.006,
        )
        out.append(towel.named("towel", tone.accent()))
    return out


def _panelled(w: float, d: float, h: float, mat: Material) -> Piece:
    """The front and side panels of a built-in bathtub."""
    return boxes([(w - 0.04, 0.02, h - 0.03, 0, -d / 2 + 0.02, 0), (0.02, d - 0.06, h - 0.03, -w / 2 + 0.02, 0, 0),
                  (0.02, d - 0.06, h - 0.03, w / 2 - 0.02, 0, 0)]).named("panel", mat)  # fmt: skip


@kind("toilet", palette="light")
def toilet(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h = rng.uniform(0.37, 0.42), rng.uniform(0.62, 0.7), rng.uniform(0.76, 0.84)
    if not tone.asked:
        tone.color = (0.95, 0.95, 0.94)
    white, steel = Material(tone.color, main=True), Material((0.8, 0.81, 0.83), "brushed")
    seat, lid_open, tank = 0.4, chance(rng, 0.3), 0.17
    bowl = d - tank
    y = -d / 2 + bowl / 2
    t = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    egg = np.stack([w / 2 * np.cos(t), bowl / 2 * np.sin(t) * (1 + 0.06 * np.sin(t))], axis=1)
    foot = extrude(rounded_rectangle(w * 0.62, bowl * 0.8, 0.1), 0.16, 0.01).moved(0, y + bowl * 0.1, 0)
    out = [
        _basin(egg, seat, 0.68, 0.2).moved(0, y, 0).named("bowl", white),
        foot.named("foot", white),
        box(w, tank, h - seat + 0.02, (0, d / 2 - tank / 2, seat - 0.02), 0.02).named("tank", white),
        box(w * 1.04, tank + 0.02, 0.03, (0, d / 2 - tank / 2, h - 0.03), 0.01).named("lid", white),
        cylinder(0.022, 0.012, (0, d / 2 - tank / 2, h)).named("button", steel),
        box(w * 0.5, bowl * 0.4, seat - 0.02, (0, d / 2 - tank - bowl * 0.1, 0), 0.01).named("foot", white),
    ]
    cover = extrude(egg * 0.99, 0.022, 0.008)
    brown = tone.wood() if chance(rng, 0.35) else white
    if lid_open:
        out.append(cover.turned("x", 84).moved(0, d / 2 - tank - 0.035, seat + bowl / 2).named("cover", brown))
        out.append(ring(1.0, 0.12).stretched(w * 0.4, bowl * 0.4, 0.12).moved(0, y, seat + 0.012).named("seat", brown))
    else:
        out.append(cover.moved(0, y, seat + 0.008).named("cover", brown))
    return out


@kind("wash basin", palette="light")
def wash_basin(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, vanity = rng.uniform(0.52, 0.66), rng.uniform(0.42, 0.5), rng.uniform(0.84, 0.9), chance(rng, 0.5)
    steel = Material((0.8, 0.81, 0.83), "brushed")
    white = tone.plain("#f3f2ee")
    main = tone.main
    if not vanity:
        if not tone.asked:
            tone.color = (0.95, 0.95, 0.94)
        white = main = Material(tone.color, main=True)
    bowl = _basin(rounded_rectangle(w, d, 0.16, 8), 0.17, 0.8, 0.13).moved(0, 0, h - 0.17)
    out = [bowl.named("bowl", white), _tap(0, d * 0.42, h - 0.01, 0.16, steel)]
    if vanity:
        w2 = w * rng.uniform(1.0, 1.3)
        out += [
            box(w2, d * 0.94, h - 0.25, (0, 0.01, 0.1), 0.006).named("cabinet", main.along(2)),
            boxes([(w2 - 0.06, d * 0.8, 0.1, 0, 0.02, 0)]).named("plinth", tone.plain("#333130")),
            *fronts(rng, w2 - 0.03, h - 0.3, (0, -d * 0.46, 0.12), 2, 1, main.shaded(1.08).along(2), tone.metal()),
            box(w2 + 0.02, d, 0.025, (0, 0, h - 0.16), 0.004).named("top", tone.plain("#e4dfd6", "marble")),
        ]
    else:
        foot = [(0, 0), (0.12, 0), (0.1, 0.05), (0.075, 0.3), (0.09, h - 0.17)]
        out.append(lathe(foot, (0, 0.04, 0), smooth=15).named("pedestal", white))
    return out


@kind("washing machine", palette="appliance")
def washing_machine(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = 0.6, rng.uniform(0.55, 0.62), rng.uniform(0.83, 0.88), tone.main
    r, steel, dark = rng.uniform(0.17, 0.21), Material((0.76, 0.77, 0.79), "brushed"), tone.plain("#23262b")
    z, y = h * 0.44, -d / 2
    glass = Material((0.35, 0.42, 0.48), "glass", (0.7, 0.78, 0.82))
    window = lathe([(r * 0.78, 0.0), (r * 0.5, 0.025), (0, 0.035)], smooth=9)
    return [
        box(w, d, h, (0, 0, 0), 0.015).named("body", mat),
        box(w * 0.96, 0.012, 0.1, (0, y - 0.003, h - 0.13), 0.004).named(
            "panel", dark if chance(rng, 0.5) else mat.shaded(0.8)
        ),
        ring(r, 0.026, (0, y - 0.012, z), "y").named("ring", steel),
        window.turned("x", 90).moved(0, y - 0.012, z).named("window", glass),
        cylinder(0.035, 0.025, bevel=0.006).turned("x", 90).moved(w * 0.05, y - 0.008, h - 0.08).named("knob", steel),
        box(w * 0.25, 0.01, 0.06, (-w * 0.32, y - 0.008, h - 0.11), 0.003).named("drawer", mat.shaded(0.92)),
        panel(0.1, 0.04, (w * 0.3, y - 0.011, h - 0.1)).named("display", Material((0.2, 0.7, 0.5), "screen", seed=3)),
    ]


@kind("shower", palette="light")
def shower(rng: Rng, tone: Tone) -> list[Piece]:
    w, h = rng.uniform(0.85, 1.0), rng.uniform(1.95, 2.1)
    white, t = tone.in_white(), 0.03
    tiles = Material((0.86, 0.92, 0.93), "tiles", (0.7, 0.8, 0.83), 0.15)
    posts: Rows = [(t, t, h, sx * (w - t) / 2, sy * (w - t) / 2, 0) for sx, sy in CORNERS]
    posts += [(w, t, t, 0, -(w - t) / 2, h - t), (t, w, t, -(w - t) / 2, 0, h - t)]
    head = [(0, w * 0.44, 1.0), (0, w * 0.44, h * 0.96), (0, w * 0.3, h * 0.99), (0, w * 0.14, h * 0.97)]
    glass = Material((0.78, 0.88, 0.9), "glass", (0.93, 0.97, 0.98))
    tile = boxes([(w - t, 0.012, h - 0.1, 0, w / 2 - 0.01, 0.1), (0.012, w - t, h - 0.1, w / 2 - 0.01, 0, 0.1)], 0.0)
    return [
        box(w, w, 0.1, (0, 0, 0), 0.02).named("tray", white),
        disc(0.045, (0, 0, 0.102)).named("drain", STEEL),
        tile.named("tile", tiles),
        boxes(posts, 0.004).named("frame", STEEL),
        box(0.008, w * 0.9, h * 0.4, (-w / 2 + 0.015, 0, 0.12), 0.0).named("glass", glass),
        tube(head, 0.012, smooth=17).named("pipe", STEEL),
        lathe([(0.02, 0.03), (0.11, 0.0), (0, 0.0)], (0, w * 0.14, h * 0.94)).named("head", STEEL),
        cylinder(0.03, 0.05, (0, w * 0.42, 1.05)).named("valve", STEEL),
    ]


@kind("towel rack", palette="fabric")
def towel_rack(rng: Rng, tone: Tone) -> list[Piece]:
    w, h = rng.uniform(0.5, 0.66), rng.uniform(0.4, 0.55)
    cloth = tone.textile(0.05, 0.7)
    out = [rod((-w / 2, -0.05, h - 0.02), (w / 2, -0.05, h - 0.02), 0.011).named("bar", STEEL, 1.3)]
    out.append(boxes([(0.03, 0.08, 0.03, s * (w / 2 - 0.02), -0.02, h - 0.035) for s in (-1, 1)]).named("mount", STEEL))
    for k in range(int(rng.integers(1, 3))):
        x, wide, drop = (k * 2 - 1) * w * 0.22, w * rng.uniform(0.3, 0.4), h * rng.uniform(0.75, 0.95)
        towel = boxes([(wide, 0.012, drop, x, -0.066, h - drop), (wide, 0.03, 0.014, x, -0.05, h - 0.014)], 0.004)
        out.append(towel.named("towel", cloth if k == 0 else tone.accent()))
    return out


@kind("dishwasher", palette="appliance")
def dishwasher(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = 0.6, rng.uniform(0.56, 0.6), rng.uniform(0.82, 0.87), tone.main
    y, dark = -d / 2, tone.plain("#26282c")
    button = boxes([(0.02, 0.008, 0.015, x * w, y - 0.015, h - 0.07) for x in (-0.3, -0.2, -0.1, 0.25)])
    return [
        box(w, d, h, (0, 0, 0), 0.012).named("body", mat),
        box(w * 0.95, 0.02, h * 0.72, (0, y - 0.004, 0.1), 0.006).named("door", mat.shaded(1.05)),
        box(w * 0.95, 0.02, 0.09, (0, y - 0.004, h - 0.11), 0.004).named(
            "panel", dark if chance(rng, 0.6) else mat.shaded(0.75)
        ),
        rod((-w * 0.36, y - 0.045, h * 0.76), (w * 0.36, y - 0.045, h * 0.76), 0.012).named("handle", STEEL),
        boxes([(0.02, 0.03, 0.02, s * w * 0.34, y - 0.025, h * 0.76 - 0.01) for s in (-1, 1)]).named("mount", STEEL),
        button.named("button", tone.plain("#c8d2d8")),
        box(w * 0.94, d * 0.9, 0.08, (0, 0.03, 0.0), 0.0).named("plinth", dark),
    ]
