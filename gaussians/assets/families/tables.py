"""Builders of tables and desks. Each builder returns the pieces of one design."""

from __future__ import annotations

from ..modeling.materials import Material, Tone
from ..modeling.parts import CORNERS, Rng, chance, fronts, polar, tapered_legs
from ..modeling.round_shapes import lathe, rod, tube
from ..modeling.shapes import Piece, box, boxes, ellipse, extrude, join, legs4, rounded_rectangle
from ..registry import kind


def _top(rng: Rng, shape: str, w: float, d: float, z: float, thick: float, mat: Material) -> Piece:
    """A table top with its upper face at z; `shape` is "box", "rounded", "oval" or "round"."""
    if shape == "box":
        plate = box(w, d, thick, (0, 0, z - thick), 0.008)
    elif shape == "rounded":
        plate = extrude(rounded_rectangle(w, d, 0.25 * min(w, d)), thick, 0.008).moved(0, 0, z - thick)
    else:
        plate = extrude(ellipse(w, d, 28), thick, 0.008).moved(0, 0, z - thick)
    return plate.named("top", mat.along(0))


def _base(rng: Rng, style: int, w: float, d: float, h: float, mat: Material) -> Piece:
    """A table's base of height h; styles: 0 legs, 1 frame, 2 pedestal, 3 trestles, 4 hairpins, 5 sled, 6 cross."""
    if style == 0:
        return tapered_legs(rng, w * 0.92, d * 0.9, h, rng.uniform(0.045, 0.075)).named("leg", mat.along(2))
    if style == 1:
        t = rng.uniform(0.05, 0.08)
        apron: list[tuple[float, ...]] = [(w * 0.86, 0.02, 0.08, 0, s * (d * 0.43 - 0.01), h - 0.08) for s in (-1, 1)]
        apron += [(0.02, d * 0.84, 0.08, s * (w * 0.44 - 0.01), 0, h - 0.08) for s in (-1, 1)]
        return join(legs4(w * 0.92, d * 0.9, h, t), boxes(apron)).named("leg", mat.along(2))
    if style == 2:
        r = min(w, d)
        foot = lathe(
            [(0, 0), (r * 0.3, 0), (r * 0.3, 0.02), (r * 0.08, 0.06), (0.045, h * 0.35), (0.04, h * 0.8), (0.09, h)],
            smooth=21,
        )
        return foot.named("pedestal", mat)
    if style == 3:
        beams: list[tuple[float, ...]] = [(0.07, d * 0.8, 0.06, s * w * 0.34, 0, 0) for s in (-1, 1)] + [
            (0.08, d * 0.28, h - 0.06, s * w * 0.34, 0, 0.06) for s in (-1, 1)
        ]
        return boxes([*beams, (w * 0.68, 0.03, 0.09, 0, 0, h * 0.4)]).named("leg", mat.along(2))
    if style == 4:
        pins = []
        for sx in (-1, 1):
            for sy in (-1, 1):
                x, y = sx * w * 0.42, sy * d * 0.4
                pins.append(tube([(x - sx * 0.1, y, h), (x, y, 0.012), (x, y - sy * 0.1, h)], 0.0075, segments=8))
        return join(*pins).named("leg", mat, 1.2)
    if style == 5:
        t = 0.035
        rows: list[tuple[float, ...]] = [(t, d * 0.85, t, s * w * 0.42, 0, z) for s in (-1, 1) for z in (0.0, h - t)]
        rows += [(t, t, h - 2 * t, sx * w * 0.42, sy * (d * 0.425 - t / 2), t) for sx, sy in CORNERS]
        return boxes(rows).named("leg", mat.along(2))
    bars = [rod((sx * w * 0.36, sy * d * 0.4, 0.01), (sx * w * 0.36, -sy * d * 0.36, h), 0.025) for sx, sy in CORNERS]
    return join(*bars, rod((-w * 0.36, 0, h / 2), (w * 0.36, 0, h / 2), 0.018)).named("leg", mat)


@kind("table", palette="wood")
def table(rng: Rng, tone: Tone) -> list[Piece]:
    h, mat = rng.uniform(0.71, 0.77), tone.main
    under = mat if chance(rng, 0.55) else tone.frame()
    if chance(rng, 0.3):
        w = d = rng.uniform(0.85, 1.25)
        shape, style = "round", int(rng.choice([0, 2, 2, 4]))
    else:
        w, d = rng.uniform(1.2, 2.0), rng.uniform(0.78, 1.0)
        shape, style = str(rng.choice(["box", "box", "rounded", "oval"])), int(rng.choice([0, 1, 1, 3, 4, 5, 6]))
    thick = rng.uniform(0.03, 0.055)
    return [_top(rng, shape, w, d, h, thick, mat), _base(rng, style, w, d, h - thick, under)]


@kind("coffee table", palette="wood")
def coffee_table(rng: Rng, tone: Tone) -> list[Piece]:
    h, mat, style = rng.uniform(0.34, 0.45), tone.main, int(rng.integers(5))
    under = mat if chance(rng, 0.5) else tone.frame()
    w, d = rng.uniform(0.8, 1.25), rng.uniform(0.5, 0.7)
    if style == 0:
        w = d = rng.uniform(0.65, 0.9)
        return [_top(rng, "round", w, d, h, 0.03, mat), _base(rng, int(rng.choice([0, 2, 4])), w, d, h - 0.03, under)]
    if style == 1:
        return [
            box(w, d, h, (0, 0, 0), 0.01).named("body", mat),
            box(w * 0.4, 0.01, h * 0.3, (0, -d / 2, h * 0.4)).named("drawer", mat.shaded(0.75)),
        ]
    shape = str(rng.choice(["box", "rounded", "oval"]))
    out = [_top(rng, shape, w, d, h, 0.035, mat), _base(rng, int(rng.choice([0, 1, 4, 5, 6])), w, d, h - 0.035, under)]
    if chance(rng, 0.5):
        out.append(_top(rng, "box", w * 0.78, d * 0.72, h * 0.4, 0.02, mat).named("shelf", mat))
    return out


@kind("side table", palette="wood")
def side_table(rng: Rng, tone: Tone) -> list[Piece]:
    w, h, mat, style = rng.uniform(0.38, 0.52), rng.uniform(0.45, 0.6), tone.main, int(rng.integers(4))
    if style == 0:
        return [
            _top(rng, "round", w, w, h, 0.022, mat),
            _base(rng, 2, w, w, h - 0.022, mat if chance(rng, 0.5) else tone.metal()),
        ]
    if style == 1:
        bars = [rod(polar(0.85 * w / 2, a), polar(0.3 * w, a, h - 0.02), 0.014, 0.02) for a in (0.5, 2.6, 4.7)]
        return [_top(rng, "round", w, w, h, 0.025, mat), join(*bars).named("leg", mat, 1.2)]
    if style == 2:
        t = 0.022
        body = boxes([(w, w, t, 0, 0, h - t), (w, w, t, 0, 0, 0), (w, t, h - 2 * t, 0, w / 2 - t / 2, t)])
        return [body.named("body", mat.along(0))]
    return [
        _top(rng, "box", w, w, h, 0.025, mat),
        _base(rng, 1, w, w, h - 0.025, mat),
        _top(rng, "box", w * 0.84, w * 0.84, h * 0.35, 0.018, mat).named("shelf", mat),
    ]


@kind("nightstand", palette="wood")
def nightstand(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(0.42, 0.55), rng.uniform(0.36, 0.44), rng.uniform(0.48, 0.62), tone.main
    foot = rng.uniform(0.06, 0.2)
    out = [
        box(w, d, h - foot, (0, 0, foot), 0.008).named("body", mat.along(0)),
        tapered_legs(rng, w, d, foot + 0.01, 0.04).named("leg", mat.along(2)),
    ]
    rows, front = int(rng.integers(1, 4)), mat.shaded(1.08).along(0)
    return out + fronts(rng, w - 0.03, h - foot - 0.04, (0, -d / 2, foot + 0.02), 1, rows, front, tone.metal())


@kind("desk", palette="wood")
def desk(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(1.15, 1.65), rng.uniform(0.58, 0.78), rng.uniform(0.72, 0.76), tone.main
    under, style = mat if chance(rng, 0.6) else tone.frame(), int(rng.integers(5))
    out = [_top(rng, "box", w, d, h, 0.035, mat)]
    z = h - 0.035
    block = [(-1, 0.36)] if style in (0, 3) else [(-1, 0.34), (1, 0.34)] if style == 1 else []
    for side, bw in block:
        x = side * (w / 2 - bw / 2 - 0.02)
        out.append(box(bw, d - 0.06, z, (x, 0, 0)).named("drawers", mat.along(2)))
        rows, front = int(rng.integers(2, 5)), mat.shaded(1.08)
        out += fronts(rng, bw - 0.02, z - 0.06, (x, -d / 2 + 0.03, 0.04), 1, rows, front, tone.metal())
    if style in (0, 3):
        out.append(box(0.035, d - 0.06, z, (w / 2 - 0.05, 0, 0)).named("leg", under.along(2)))
    elif style == 2:
        out += [
            _base(rng, int(rng.choice([0, 5, 6])), w, d, z, under),
            *fronts(rng, w * 0.7, 0.1, (0, -d * 0.42, z - 0.11), 3, 1, mat, tone.metal()),
        ]
    elif style == 4:
        out += [_base(rng, 4 if chance(rng, 0.5) else 1, w, d, z, under)]
    if style == 3 or chance(rng, 0.15):
        sides = [(0.02, 0.2, 0.28, s * (w / 2 - 0.01), d / 2 - 0.1, h) for s in (-1, 1)]
        out.append(boxes([(w, 0.2, 0.02, 0, d / 2 - 0.1, h + 0.28), *sides]).named("hutch", mat))
    return out
