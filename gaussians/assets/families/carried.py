"""Builders of bags, shoes and umbrellas. Each builder returns the pieces of one design."""

from __future__ import annotations

import numpy as np

from ..modeling.materials import Material, Tone
from ..modeling.parts import CORNERS, Rng, around, chance, polar
from ..modeling.round_shapes import ball, blob, cylinder, lathe, ring, rod, tube
from ..modeling.shapes import Piece, box, boxes, extrude, join, rounded_rectangle, surface
from ..registry import kind


@kind("backpack")
def backpack(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h, mat = rng.uniform(0.27, 0.33), rng.uniform(0.15, 0.2), rng.uniform(0.4, 0.48), tone.textile(0.07, 0.7)
    trim = tone.accent() if chance(rng, 0.5) else mat.shaded(0.6)
    pocket = blob(w * 0.78, d * 0.6, h * 0.42, (0, -d * 0.42, h * 0.28), 0.5, 0.5)
    out = [
        blob(w, d, h, (0, 0, h / 2), 0.5, 0.45).named("body", mat),
        pocket.named("pocket", mat if chance(rng, 0.5) else trim),
    ]
    zipper = [
        (w * 0.38 * np.cos(a), -d * 0.5 * (0.75 + 0.1 * np.sin(a)), h * 0.62 + h * 0.3 * np.sin(a))
        for a in np.linspace(0, np.pi, 13)
    ]
    out.append(tube(zipper, 0.005, segments=6).named("zip", trim))
    out.append(
        tube(
            [(-0.04, 0, h * 0.97), (-0.035, 0, h * 1.08), (0.035, 0, h * 1.08), (0.04, 0, h * 0.97)], 0.009, smooth=13
        ).named("handle", trim)
    )
    for s in (-1, 1):
        strap = [
            (s * 0.07, d * 0.4, h * 0.93),
            (s * 0.1, d * 0.85, h * 0.75),
            (s * 0.11, d * 0.9, h * 0.35),
            (s * 0.1, d * 0.4, h * 0.08),
        ]
        out.append(tube(strap, 0.016, smooth=15).named("strap", trim))
        if chance(rng, 0.5):
            out.append(blob(0.05, d * 0.7, h * 0.3, (s * w * 0.5, 0, h * 0.22), 0.6, 0.5).named("side pocket", trim))
    return out


@kind("suitcase")
def suitcase(rng: Rng, tone: Tone) -> list[Piece]:
    mat = tone.main
    if chance(rng, 0.5):  # upright, on wheels
        w, d, h = rng.uniform(0.38, 0.48), rng.uniform(0.22, 0.28), rng.uniform(0.55, 0.72)
        z = 0.05
        shell = extrude(rounded_rectangle(w, h, 0.06), d, 0.03).turned("x", 90).moved(0, d / 2, z + h / 2)
        ribs = boxes(
            [(0.02, 0.012, h * 0.8, x, -d / 2 - 0.002, z + h * 0.1) for x in np.linspace(-w * 0.35, w * 0.35, 6)]
        )
        pull = tube(
            [
                (-0.09, d * 0.4, z + h - 0.02),
                (-0.09, d * 0.4, z + h + 0.3),
                (0.09, d * 0.4, z + h + 0.3),
                (0.09, d * 0.4, z + h - 0.02),
            ],
            0.009,
        )
        wheels = [ball(0.026, (sx * w * 0.38, sy * d * 0.36, 0.026)) for sx, sy in CORNERS]
        return [
            shell.named("shell", mat),
            ribs.named("rib", mat.shaded(0.8)),
            pull.named("handle", tone.metal()),
            join(*wheels).named("wheel", tone.plain("#1c1c1e")),
        ]
    w, d, h = rng.uniform(0.55, 0.7), rng.uniform(0.18, 0.24), rng.uniform(0.4, 0.48)
    strap = tone.plain("#6b4423")
    corners = [
        ball(0.035, (sx * (w / 2 - 0.012), sy * (d / 2 - 0.012), z)) for sx, sy in CORNERS for z in (0.028, h - 0.02)
    ]
    handle = tube([(-0.07, 0, h), (-0.06, 0, h + 0.045), (0.06, 0, h + 0.045), (0.07, 0, h)], 0.011, smooth=13)
    lock = boxes([(0.05, 0.012, 0.04, s * w * 0.15, -d / 2 - 0.003, h * 0.8) for s in (-1, 1)])
    return [
        box(w, d, h, (0, 0, 0), 0.015).named("shell", mat),
        boxes([(0.035, d + 0.012, h + 0.01, s * w * 0.28, 0, 0) for s in (-1, 1)]).named("strap", strap),
        join(*corners).named("corner", strap),
        handle.named("handle", strap),
        lock.named("lock", tone.metal()),
    ]


@kind("shoe")
def shoe(rng: Rng, tone: Tone) -> list[Piece]:
    style, mat = int(rng.integers(3)), tone.main
    sole = tone.plain(str(rng.choice(["#f4f2ee", "#26221f", "#8a5a33"])))
    tall = (0.09, 0.22, 0.1)[style]
    t = np.linspace(0, 2 * np.pi, 28, endpoint=False)
    foot = np.stack([0.045 * np.cos(t) * (1 - 0.18 * np.sin(t) - 0.1 * np.sin(2 * t)), -0.14 * np.sin(t)], 1)[::-1]
    one = [extrude(foot, 0.025 if style != 1 else 0.035, 0.006).named("sole", sole)]
    one.append(blob(0.088, 0.17, 0.1, (0, -0.05, 0.035), 0.9, 0.9).named("toe", mat))
    upper = (
        lathe([(0.046, 0.02), (0.045, tall * 0.6), (0.04, tall)], smooth=9).stretched(0.92, 1.45, 1).moved(0, 0.065, 0)
    )
    one.append(upper.named("upper", mat))
    one.append(
        ring(0.04, 0.006, (0, 0, 0)).stretched(0.92, 1.45, 1).moved(0, 0.065, tall).named("collar", mat.shaded(0.7))
    )
    inside = cylinder(0.036, 0.004).stretched(0.92, 1.45, 1).moved(0, 0.065, tall - 0.012)
    one.append(inside.named("inside", tone.plain("#2a2522")))
    if style != 2:
        laces = [
            rod((-0.028, -0.02 - 0.022 * k, 0.085 - 0.009 * k), (0.028, -0.02 - 0.022 * k, 0.085 - 0.009 * k), 0.004)
            for k in range(4)
        ]
        one.append(
            join(*laces).named("lace", tone.plain("#f7f7f4") if sum(tone.color) < 2.2 else tone.plain("#222222"))
        )
    if style == 0 and chance(rng, 0.6):
        one += [
            box(0.004, 0.06, 0.02, (s * 0.043, 0.02, 0.045)).named("stripe", Material(tone.second)) for s in (-1, 1)
        ]
    return [p.moved(-0.062) for p in one] + [
        p.stretched(-1, 1, 1).turned("z", rng.uniform(-8, 8)).moved(0.062, rng.uniform(-0.03, 0.03)) for p in one
    ]


@kind("umbrella")
def umbrella(rng: Rng, tone: Tone) -> list[Piece]:
    mat, metal, wood = tone.textile(0.1, 0.6), Material((0.6, 0.62, 0.65), "brushed"), tone.wood()
    h = rng.uniform(0.82, 0.92)
    hook = [(0, 0, 0.16), (0, 0, 0.05), (0.03, 0, 0.012), (0.07, 0, 0.03), (0.075, 0, 0.06)]
    if chance(rng, 0.65):  # open
        r, n = rng.uniform(0.45, 0.56), 8
        lon = np.linspace(0, -2 * np.pi, 8 * n + 1)[None]
        t = np.linspace(0, 1, 9)[:, None]
        scallop = 1 - 0.06 * (1 - np.abs(np.cos(n * lon / 2))) * t
        rad = r * t * scallop
        z = h - 0.04 - r * 0.42 * (t * scallop) ** 2 - 0.0 * lon
        canopy = surface(np.stack([rad * np.cos(lon), rad * np.sin(lon), z], -1)[::-1])
        ribs = [
            tube(
                [(0, 0, h - 0.045), polar(r * 0.5, a, h - 0.045 - r * 0.105), polar(r, a, h - 0.045 - r * 0.42)],
                0.003,
                smooth=7,
            )
            for a in around(n)
        ]
        whole = [
            canopy.named("canopy", mat),
            join(*ribs).named("rib", metal, 0.8),
            rod((0, 0, 0.14), (0, 0, h), 0.007).named("shaft", metal, 1.2),
            tube(hook, 0.011, smooth=15).named("handle", wood, 1.2),
        ]
        rest = np.degrees(np.arctan2(h - 0.04 - r * 0.42, r))  # rim and handle both touch the ground
        return [p.turned("x", rest if chance(rng, 0.7) else -rest) for p in whole]
    folds = lathe([(0.012, 0.3), (0.045, 0.42), (0.035, 0.6), (0.012, h - 0.03)], smooth=13)
    pleats = [rod(polar(0.04, a, 0.4), polar(0.01, a, h - 0.05), 0.009, 0.004) for a in around(8)]
    stand = lathe([(0.0, 0.0), (0.1, 0.0), (0.11, 0.38), (0.1, 0.38), (0.095, 0.03), (0, 0.02)]).named(
        "stand", tone.metal()
    )
    flip = (
        [stand]
        if chance(rng, 0.6)
        else [
            cylinder(0.1, 0.02, bevel=0.005).named("stand", wood),
            ring(0.06, 0.007, (0, 0, 0.4)).named("stand", wood),
            rod((0.06, 0, 0), (0.06, 0, 0.4), 0.008).named("stand", wood),
        ]
    )
    return [
        *flip,
        folds.named("canopy", mat),
        join(*pleats).named("pleat", mat.shaded(0.8)),
        rod((0, 0, 0.14), (0, 0, h), 0.006).named("shaft", metal, 1.2),
        tube(hook, 0.011, smooth=15).named("handle", wood, 1.2),
        ring(0.046, 0.005, (0, 0, 0.5)).named("strap", mat.shaded(0.6)),
    ]
