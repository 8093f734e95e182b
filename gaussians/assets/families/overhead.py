"""Builders of what hangs from a ceiling besides lamps (beams, streamers, strings of lights), and of balloons.

Each builder returns the pieces of one design.
"""

from __future__ import annotations

import numpy as np

from ..modeling.materials import Material, Tone
from ..modeling.parts import Rng, chance, shell
from ..modeling.round_shapes import ball, blob, cylinder, rod, tube
from ..modeling.shapes import Array, Piece, box, boxes, join, surface
from ..registry import kind

_PARTY = ("#e0455e", "#f2c53d", "#3f79c9", "#4fae6a", "#f08a3c", "#9a5fc0")


@kind("ceiling beams", palette="wood")
def ceiling_beams(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h = rng.uniform(3.0, 7.0), rng.uniform(3.0, 6.0), rng.uniform(0.16, 0.26)
    if not tone.asked:
        tone.color = tone.wood().color
    mat = Material(tone.color, "wood", seed=tone.seed, main=True)
    n, t = int(rng.integers(3, 7)), rng.uniform(0.12, 0.18)
    cross, pitch = chance(rng, 0.6), w / n
    # Along x from wall to wall, so that they are visible from the open side of a room.
    rows = [(w, t, h, 0, (k - (n - 1) / 2) * (d - t) / max(n - 1, 1), 0) for k in range(n)]
    out = [boxes(rows, 0.012).named("beam", mat.along(0), 1.3)]
    if cross:
        purlins = [(0.09, d, h * 0.5, (k - 0.5) * pitch * n / 2, 0, h * 0.5) for k in (0, 1)]
        out.append(boxes(purlins, 0.008).named("cross beam", mat.shaded(0.85).along(1)))
    return out


@kind("beam", palette="wood")
def beam(rng: Rng, tone: Tone) -> list[Piece]:
    w, d, h = rng.uniform(3.0, 6.0), rng.uniform(0.12, 0.2), rng.uniform(0.16, 0.26)
    if not tone.asked:
        tone.color = tone.wood().color
    mat = Material(tone.color, "wood", seed=tone.seed, main=True)
    out = [box(w, d, h, (0, 0, 0), rng.uniform(0.008, 0.02)).named("beam", mat.along(0), 1.2)]
    if chance(rng, 0.5):
        straps = [(0.05, d + 0.008, h + 0.008, s * w * 0.36, 0, -0.004) for s in (-1, 1)]
        out.append(boxes(straps, 0.002).named("strap", tone.plain("#2e2d2c")))
    return out


def _sagging(w: float, sag: float, count: int) -> Array:
    """`[count, 3]` points of a string of span `w` along x whose middle hangs `sag` below z = 0."""
    t = np.linspace(-1, 1, count)
    return np.stack([t * w / 2, 0 * t, -sag * (1 - t**2)], axis=1)


@kind("streamer")
def streamers(rng: Rng, tone: Tone) -> list[Piece]:
    w, sag, style = rng.uniform(2.0, 4.0), rng.uniform(0.15, 0.35), int(rng.integers(3))
    tints = [Material(tone.color, main=True), *(tone.plain(c) for c in rng.permutation(_PARTY)[:3])]
    ropes = 1 if style == 0 else int(rng.integers(2, 4))
    out: list[Piece] = []
    for k in range(ropes):
        turn = 180.0 * k / ropes
        line = _sagging(w, sag, 25)
        parts: list[Piece] = [tube(line, 0.006, segments=6).named("cord", tone.plain("#efe9dc"))]
        if style < 2:  # pennants on a cord
            flags = np.linspace(-0.46, 0.46, int(w / 0.22))
            for i, f in enumerate(flags):
                z = -sag * (1 - (2 * f) ** 2)
                grid = np.array(
                    [
                        [(f * w - 0.08, 0, z), (f * w + 0.08, 0, z)],
                        [(f * w - 0.002, 0, z - 0.2), (f * w + 0.002, 0, z - 0.2)],
                    ]
                )
                parts.append(surface(grid).named("pennant", tints[i % len(tints)], 1.2))
        else:  # twisted crêpe paper
            t = np.linspace(0, 1, 97)
            core, angle = _sagging(w, sag, 97), t * np.pi * w * 3
            side = np.stack([0 * t, np.cos(angle), np.sin(angle)], axis=1) * 0.045
            parts.append(surface(np.stack([core - side, core + side])).named("paper", tints[k % len(tints)], 1.6))
        out += [p.turned("z", turn) for p in parts]
    return out


@kind("balloons")
def balloons(rng: Rng, tone: Tone) -> list[Piece]:
    n, high = int(rng.integers(5, 9)), rng.uniform(1.3, 1.7)
    tints = [Material(tone.color, main=True), *(tone.plain(c) for c in rng.permutation(_PARTY)[:3])]
    out: list[Piece] = [cylinder(0.06, 0.05, (0, 0, 0), top=0.045, bevel=0.01).named("weight", tone.plain("#b9bcc0"))]
    spots: list[Array] = []
    while len(spots) < n:
        at = np.array([*rng.uniform(-0.24, 0.24, 2), rng.uniform(high - 0.4, high)])
        if len(spots) < 2 or min(float(np.linalg.norm(at - s)) for s in spots) > 0.15 or chance(rng, 0.05):
            spots.append(at)
    for i, at in enumerate(spots):
        mat, (x, y, z) = tints[i % len(tints)], (float(v) for v in at)
        out += [
            blob(0.25, 0.25, 0.3, (x, y, z)).named("balloon", mat, 0.9),
            cylinder(0.02, 0.025, (x, y, z - 0.17), top=0.004).named("knot", mat),
            rod((0, 0, 0.04), (x, y, z - 0.16), 0.003).named("string", tone.plain("#e8e4da"), 0.7),
        ]
    return out


@kind("string lights", palette="light")
def string_lights(rng: Rng, tone: Tone) -> list[Piece]:
    w, sag, ropes = rng.uniform(2.0, 4.0), rng.uniform(0.2, 0.35), int(rng.integers(1, 4))
    glow = (
        Material(tone.color, "glow", (1.0, 0.97, 0.85), main=True)
        if tone.asked
        else Material((1.0, 0.86, 0.55), "glow", (1.0, 0.97, 0.85), main=True)
    )
    tone.color = glow.color
    out: list[Piece] = []
    for k in range(ropes):
        y = (k - (ropes - 1) / 2) * rng.uniform(0.9, 1.1)
        line = _sagging(w, sag, 25)
        bulbs = [
            ball(0.035, (f * w, 0, -sag * (1 - (2 * f) ** 2) - 0.06))
            for f in np.linspace(-0.47, 0.47, max(int(w / 0.3), 4))
        ]
        out += [
            tube(line, 0.006, segments=6).moved(0, y).named("cord", tone.plain("#2b2a2a")),
            join(*bulbs).moved(0, y).named("bulb", glow),
        ]
    return out


@kind("paper lantern", palette="light")
def paper_lantern(rng: Rng, tone: Tone) -> list[Piece]:
    r, cord = rng.uniform(0.18, 0.28), rng.uniform(0.1, 0.25)
    lit = Material(tone.color, "glow", (1.0, 0.97, 0.9), main=True)
    t = np.linspace(-np.pi / 2, np.pi / 2, 41)
    ribbed = r * (1 - 0.03 * np.cos(24 * t)) * np.cos(t)
    angle = np.linspace(0, -2 * np.pi, 33)
    grid = np.stack(
        [ribbed[:, None] * np.cos(angle), ribbed[:, None] * np.sin(angle), (r * np.sin(t))[:, None] + 0 * angle],
        axis=-1,
    )
    return [
        shell(grid).moved(0, 0, r).named("paper", lit),
        rod((0, 0, 2 * r - 0.02), (0, 0, 2 * r + cord), 0.005).named("cord", tone.plain("#2b2b2b")),
        cylinder(0.04, 0.02, (0, 0, 2 * r + cord)).named("rose", tone.plain("#e8e6e0")),
    ]
