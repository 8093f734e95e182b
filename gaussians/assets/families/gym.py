"""Builders of gym equipment and the drum kit. Each builder returns the pieces of one design; its user faces -y."""

from __future__ import annotations

import numpy as np

from ..modeling.materials import Material, Tone
from ..modeling.parts import Rng, chance, polar
from ..modeling.round_shapes import ball, blob, cylinder, ring, rod
from ..modeling.shapes import Piece, box, boxes, join
from ..registry import kind

_STEEL = Material((0.72, 0.73, 0.75), "brushed")


@kind("exercise bike", palette="dark")
def exercise_bike(rng: Rng, tone: Tone) -> list[Piece]:
    d, mat, black = rng.uniform(1.05, 1.2), tone.main, tone.plain("#1b1b1d")
    wheel, seat, front = rng.uniform(0.2, 0.24), (0.22, 0.88), -d * 0.27
    crank = (0.02, 0.3)
    pedals = [
        part
        for s in (-1, 1)
        for part in (
            rod((s * 0.07, *crank), (s * 0.08, crank[0] + s * 0.1, crank[1] + s * 0.13), 0.012),
            rod(
                (s * 0.06, crank[0] + s * 0.1, crank[1] + s * 0.13),
                (s * 0.17, crank[0] + s * 0.1, 0.3 + s * 0.13),
                0.018,
            ),
        )
    ]
    bars = [
        ((0, 0.02, 0.28), (0, *seat)),
        ((0, front, 0.1), (0, front + 0.02, 1.04)),
        ((0, 0.02, 0.28), (0, front, 0.6)),
    ]
    grips = [rod((s * 0.06, front, 1.04), (s * 0.2, front + 0.12, 1.12), 0.016) for s in (-1, 1)]
    flywheel = cylinder(wheel, 0.06, (0, 0, -0.03)).turned("y", 90).moved(0, front + 0.02, wheel + 0.09)
    return [
        boxes([(0.5, 0.07, 0.06, 0, y, 0) for y in (-d * 0.44, d * 0.44)], 0.015).named("foot", black),
        box(0.08, d * 0.88, 0.06, (0, 0, 0.05), 0.015).named("beam", mat),
        flywheel.named("flywheel", _STEEL),
        ring(wheel, 0.02, (0, front + 0.02, wheel + 0.09), "x").named("rim", black),
        box(0.11, 0.42, 0.2, (0, -0.08, 0.22), 0.05).named("cover", mat),
        join(*(rod(a, b, 0.03) for a, b in bars)).named("frame", mat),
        blob(0.22, 0.28, 0.1, (0, seat[0] + 0.03, seat[1] + 0.03), 0.9, 0.7).named("seat", black),
        join(*pedals).named("pedal", black),
        join(rod((-0.2, front, 1.04), (0.2, front, 1.04), 0.017), *grips).named("handle", black),
        box(0.2, 0.04, 0.14, (0, front - 0.02, 1.08), 0.015).turned("x", 0).named("console", black),
    ]


@kind("rowing machine", palette="dark")
def rowing_machine(rng: Rng, tone: Tone) -> list[Piece]:
    d, mat, black = rng.uniform(2.15, 2.4), tone.main, tone.plain("#1b1b1d")
    front, slide = -d / 2, rng.uniform(0.1, 0.5)
    arm = rod((0, front + 0.3, 0.3), (0, front + 0.16, 0.86), 0.025)
    return [
        boxes([(0.5, 0.06, 0.06, 0, y, 0) for y in (front + 0.06, d / 2 - 0.06)], 0.015).named("foot", black),
        box(0.06, d - 0.35, 0.07, (0, 0.16, 0.3), 0.01).named("rail", _STEEL),
        rod((0, d / 2 - 0.08, 0.04), (0, d / 2 - 0.08, 0.32), 0.025).named("post", mat),
        cylinder(0.26, 0.12, (0, 0, -0.06)).turned("y", 90).moved(0, front + 0.28, 0.3).named("flywheel", mat),
        ring(0.2, 0.02, (0.07, front + 0.28, 0.3), "x").named("ring", _STEEL),
        arm.named("arm", mat),
        box(0.24, 0.03, 0.18, (0, front + 0.15, 0.8), 0.012).named("console", black),
        boxes([(0.11, 0.08, 0.26, s * 0.13, front + 0.55, 0.24) for s in (-1, 1)], 0.02).named("footrest", black),
        rod((-0.24, front + 0.5, 0.48), (0.24, front + 0.5, 0.48), 0.015).named("handle", black),
        box(0.3, 0.24, 0.06, (0, slide, 0.38), 0.025).named("seat", black),
    ]


@kind("weight bench", palette="dark")
def weight_bench(rng: Rng, tone: Tone) -> list[Piece]:
    d, mat, black = rng.uniform(1.3, 1.45), tone.main, tone.plain("#1b1b1d")
    back, plate = d / 2 - 0.12, rng.uniform(0.12, 0.17)
    posts = [rod((s * 0.26, back, 0.02), (s * 0.26, back, 0.98), 0.028) for s in (-1, 1)]
    plates = [
        cylinder(plate * f, 0.035, (0, 0, 0)).turned("y", 90).moved(s * x, back - 0.04, 0.94)
        for s in (-1, 1)
        for f, x in ((1.0, 0.3), (0.75, 0.335))
    ]
    return [
        boxes([(0.62, 0.07, 0.05, 0, back, 0), (0.42, 0.07, 0.05, 0, -d * 0.4, 0)], 0.012).named("foot", black),
        box(0.07, d * 0.82, 0.06, (0, 0, 0.3), 0.01).named("beam", _STEEL),
        join(*posts, rod((0, -d * 0.4, 0.03), (0, -d * 0.4, 0.32), 0.03)).named("post", _STEEL),
        box(0.3, d * 0.82, 0.08, (0, -d * 0.05, 0.36), 0.03).named("pad", mat),
        rod((-0.36, back - 0.04, 0.94), (0.36, back - 0.04, 0.94), 0.014).named("bar", _STEEL),
        join(*plates).named("plate", black),
    ]


@kind("punching bag", palette="dark")
def punching_bag(rng: Rng, tone: Tone) -> list[Piece]:
    r, h, mat = rng.uniform(0.17, 0.19), rng.uniform(0.75, 0.85), tone.main
    chains = [rod(polar(0.11, a, h), (0, 0, h + 0.2), 0.008) for a in np.arange(4) * np.pi / 2]
    bands = [ring(r, 0.008, (0, 0, z)) for z in (0.1 * h, 0.5 * h, 0.9 * h)]
    return [
        cylinder(r, h, (0, 0, 0), bevel=0.04).named("bag", mat),
        join(*bands).named("band", mat.shaded(0.6)),
        join(*chains, rod((0, 0, h + 0.18), (0, 0, h + 0.3), 0.012)).named("chain", _STEEL),
        cylinder(0.05, 0.012, (0, 0, h + 0.29)).named("plate", _STEEL),
    ]


@kind("drum kit")
def drum_kit(rng: Rng, tone: Tone) -> list[Piece]:
    shell, skin, brass = tone.main, tone.plain("#f1eee6"), Material((0.83, 0.66, 0.28), "brushed")
    drums: list[tuple[float, float, float, float, float]] = [  # radius, height, x, y, underside
        (0.2, 0.4, 0.5, 0.12, 0.16), (0.17, 0.15, -0.42, 0.2, 0.48), (0.15, 0.2, -0.17, -0.12, 0.6),
        (0.16, 0.22, 0.19, -0.12, 0.6),
    ]  # fmt: skip
    cymbals = [(-0.66, -0.05, 0.98, 0.2), (0.62, -0.25, 1.08, 0.24)] + [(-0.2, -0.38, 1.14, 0.2)] * chance(rng, 0.6)
    stands = [rod((x, y, 0.0), (x, y, z), 0.012) for x, y, z, _ in cymbals]
    legs = [rod((x, y, 0), (x, y, z + 0.02), 0.014) for _, _, x, y, z in drums]
    bass = cylinder(0.28, 0.36, (0, 0, -0.18)).turned("x", 90).moved(0, -0.2, 0.29)
    front = cylinder(0.25, 0.006, (0, 0, 0)).turned("x", 90).moved(0, -0.383, 0.29)
    seat = [cylinder(0.15, 0.07, (0, 0.5, 0.42), bevel=0.02).named("seat", tone.plain("#1b1b1d"))]
    return [
        join(bass, *(cylinder(r, h, (x, y, z)) for r, h, x, y, z in drums)).named("shell", shell),
        join(front, *(cylinder(r * 0.97, 0.006, (x, y, z + h)) for r, h, x, y, z in drums)).named("skin", skin),
        join(*(ring(r, 0.009, (x, y, z + h)) for r, h, x, y, z in drums)).named("hoop", _STEEL),
        join(*stands, *legs, rod((0, 0.5, 0), (0, 0.5, 0.43), 0.02)).named("stand", _STEEL),
        join(*(cylinder(r, 0.008, (x, y, z), top=0.03) for x, y, z, r in cymbals)).named("cymbal", brass),
        *seat,
        ball(0.02, (0, -0.2, 0.58)).named("knob", _STEEL),
    ]
