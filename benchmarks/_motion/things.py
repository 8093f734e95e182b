"""The moving things of the six rooms, as mesh pieces in the room's frame; each part is an asset of its own.

Metres, z up; the south side of a room is open.
"""

from __future__ import annotations

from ...gaussians.assets.modeling.materials import Material, mix
from ...gaussians.assets.modeling.parts import CORNERS
from ...gaussians.assets.modeling.round_shapes import ball, cylinder, ring, rod
from ...gaussians.assets.modeling.shapes import Piece, Point, box, boxes, join
from ...gaussians.color import Rgb, parse

Parts = dict[str, list[Piece]]  # "label" or "label/part" to pieces; parts with one label are one thing

BALL = 0.11  # metres, radius
LEAF = (0.85, 0.045, 2.03)  # width, thickness and height of the door
DRAWER = (0.9, 0.42, 0.2)  # width, depth and height of a drawer
BOOK = (0.26, 0.2, 0.05)
_DARK = Material((0.1, 0.09, 0.1))
_STEEL = Material((0.75, 0.76, 0.78), "brushed")


def red_ball(at: Point) -> Parts:
    """A ball with dark seams, by which its rolling is seen, resting on `at`."""
    middle = (at[0], at[1], at[2] + BALL)
    seams = [ring(BALL * 1.004, BALL * 0.05, middle, axis) for axis in "xyz"]
    skin = ball(BALL, middle).named("ball", Material(parse("#c8201e"), main=True))
    return {"ball": [skin, join(*seams).named("seam", _DARK)]}


def door(x: float, wall: float) -> Parts:
    """A door whose leaf closes the wall at y = `wall`: the leaf, and the frame that stays."""
    w, t, h = LEAF
    wood = Material(parse("#7a4a26"), "wood", mix(parse("#7a4a26"), (0.0, 0.0, 0.0), 0.3), axis=2, main=True)
    y = wall - t / 2
    panels = boxes([(0.55 * w, 0.012, high, x, y - t / 2, z) for z, high in ((0.18, 0.7), (1.08, 0.78))], 0.005)
    knobs = [ball(0.032, (x + w / 2 - 0.08, y + side * (t / 2 + 0.03), 1.0)) for side in (-1, 1)]
    sides = [(0.09, 0.1, h + 0.09, x + side * (w / 2 + 0.05), wall + 0.01, 0) for side in (-1, 1)]
    leaf = box(w - 0.006, t, h - 0.01, (x, y, 0.008), 0.004)
    return {
        "door": [
            leaf.named("leaf", wood),
            panels.named("panel", wood.shaded(0.75)),
            join(*knobs).named("knob", _STEEL, 1.4),
        ],
        "door frame": [
            boxes([*sides, (w + 0.01, 0.1, 0.09, x, wall + 0.01, h)], 0.006).named("frame", wood.shaded(0.85))
        ],
    }


def closet(x: float, wall: float) -> list[Piece]:
    """What is seen through the door: a closet 50 cm deep behind the wall."""
    w, h, deep = LEAF[0] + 0.1, LEAF[2] + 0.1, 0.5
    plaster = Material((0.62, 0.6, 0.55))
    rows = [
        (w, 0.02, h, x, wall + deep, 0.0),
        (w, deep, 0.02, x, wall + deep / 2 + 0.02, -0.02),
        (w, deep, 0.02, x, wall + deep / 2 + 0.02, h),
        *((0.02, deep, h, x + side * w / 2, wall + deep / 2 + 0.02, 0.0) for side in (-1, 1)),
    ]
    return [boxes(rows, 0.0).named("closet", plaster)]


def dresser(x: float, wall: float) -> tuple[list[Parts], Parts]:
    """A white dresser with its back at y = `wall`: three drawers from the top down, and its body."""
    (w, d, h), rows, foot = DRAWER, 3, 0.08
    white, gap, side = Material((0.94, 0.94, 0.92), main=True), 0.012, 0.025
    wide, deep, high = w + 2 * (gap + side), d + 0.06, foot + rows * (h + gap) + gap + side
    y = wall - deep / 2 - 0.02
    levels = [foot + gap + k * (h + gap) for k in range(rows)]
    body = boxes(
        [
            (wide, deep, side, x, y, high - side),
            (wide, deep, side, x, y, foot - side),
            (wide, 0.015, high - foot, x, y + deep / 2, foot),
            *((side, deep, high - foot, x + s * (wide - side) / 2, y, foot) for s in (-1, 1)),
            *((wide - 2 * side, 0.03, gap, x, y - deep / 2 + 0.03, z - gap) for z in levels),
            *((0.05, 0.05, foot, x + s * (wide / 2 - 0.05), y + f * (deep / 2 - 0.05), 0) for s, f in CORNERS),
        ],
        0.004,
    )  # fmt: skip
    drawers = [_drawer(x, y - deep / 2, z, white) for z in reversed(levels)]
    return drawers, {"dresser": [body.named("body", white.shaded(0.92))]}


def _drawer(x: float, front: float, z: float, white: Material) -> Parts:
    """A drawer whose front is at y = `front`, open above."""
    w, d, h = DRAWER
    inside = boxes(
        [
            (w, d, 0.012, x, front + d / 2, z + 0.01),
            (w, 0.012, h - 0.05, x, front + d, z + 0.01),
            *((0.012, d, h - 0.05, x + s * (w / 2 - 0.006), front + d / 2, z + 0.01) for s in (-1, 1)),
        ],
        0.0,
    )
    knobs = [ball(0.018, (x + s * 0.25, front - 0.028, z + h / 2)) for s in (-1, 1)]
    return {
        "drawer": [
            box(w, 0.022, h, (x, front, z), 0.004).named("front", white),
            inside.named("inside", Material(parse("#c79a63"), "wood")),
            join(*knobs).named("knob", Material((0.2, 0.2, 0.22)), 1.4),
        ]
    }


def ceiling_fan(x: float, y: float, ceiling: float) -> Parts:
    """A fan of three blades under the ceiling: what turns, and the rod that carries it."""
    wood = Material(parse("#8a5a33"), "wood", main=True)
    z = ceiling - 0.3
    blades = []
    for k in range(3):
        blade = box(0.5, 0.14, 0.012, (0.36, 0, -0.006), 0.004).turned("x", 12)
        blades.append(blade.turned("z", 120 * k).moved(x, y, z))
    hub = cylinder(0.1, 0.1, (x, y, z - 0.04), bevel=0.02)
    cup = cylinder(0.07, 0.05, (x, y, ceiling - 0.05))
    pole = join(rod((x, y, z + 0.06), (x, y, ceiling), 0.018), cup)
    return {
        "ceiling fan/blades": [
            blades[0].named("blade", wood.shaded(0.6)),  # by which a turn is told from a third of one
            join(*blades[1:]).named("blade", wood),
            hub.named("hub", _STEEL),
        ],
        "ceiling fan/rod": [pole.named("rod", _STEEL)],
    }


def book(at: Point, cover: Rgb) -> Parts:
    """A book lying flat on `at`, its spine towards the north."""
    w, d, h = BOOK
    bound = Material(cover, main=True)
    pages = box(w - 0.012, d - 0.01, h - 0.012, (at[0], at[1] - 0.004, at[2] + 0.006), 0.0)
    lids = boxes([(w, d, 0.006, *at), (w, d, 0.006, at[0], at[1], at[2] + h - 0.006)], 0.001)
    spine = box(w, 0.008, h, (at[0], at[1] + d / 2 - 0.004, at[2]), 0.002)
    title = box(0.5 * w, 0.3 * d, 0.002, (at[0], at[1], at[2] + h - 0.001), 0.0)
    return {
        "book": [
            join(lids, spine).named("cover", bound),
            pages.named("pages", Material((0.93, 0.9, 0.82))),
            title.named("title", Material((0.95, 0.85, 0.5)), 1.3),
        ]
    }


def robot(at: Point, yaw: float) -> Parts:
    """A green toy robot, 38 cm high, standing on `at`; at a yaw of 0 degrees it looks towards -y."""
    green, dark = Material(parse("#2f9d3a"), main=True), Material(parse("#17561f"))
    eyes = [ball(0.017, (s * 0.03, -0.06, 0.29)) for s in (-1, 1)]
    legs = boxes([(0.06, 0.08, 0.1, s * 0.045, 0, 0) for s in (-1, 1)], 0.008)
    arms = boxes([(0.035, 0.05, 0.13, s * 0.12, -0.005, 0.11) for s in (-1, 1)], 0.008)
    pieces = [
        legs.named("leg", dark),
        box(0.2, 0.13, 0.15, (0, 0, 0.1), 0.015).named("body", green),
        box(0.1, 0.01, 0.07, (0, -0.065, 0.14), 0.003).named("panel", Material(parse("#e8d44a"))),
        arms.named("arm", dark),
        box(0.14, 0.11, 0.09, (0, 0, 0.25), 0.015).named("head", green),
        join(*eyes).named("eye", Material((0.97, 0.97, 0.97)), 1.3),
        join(rod((0, 0, 0.34), (0, 0, 0.37), 0.005), ball(0.014, (0, 0, 0.375))).named("aerial", _STEEL, 1.3),
    ]
    return {"toy robot": [p.turned("z", yaw).moved(*at) for p in pieces]}
