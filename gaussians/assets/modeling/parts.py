"""Parts that several families of furniture share: legs, drawer fronts, books, blankets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .materials import Material
from .round_shapes import ball, rod
from .shapes import Array, Piece, Point, Sheets, box, boxes, join, legs4, surface

Rng = np.random.Generator
CORNERS = ((-1, -1), (-1, 1), (1, -1), (1, 1))  # signs of x and y


def chance(rng: Rng, p: float) -> bool:
    """True with probability `p`."""
    return bool(rng.random() < p)


def around(count: int) -> Array:
    """`[count]` angles spread evenly over a full turn, radians, from 0."""
    return np.linspace(0, 2 * np.pi, count + 1)[:-1]


def polar(r: float, angle: float, z: float = 0.0) -> Point:
    """The point at distance `r` from the z axis in the direction `angle`, radians counter-clockwise from +x."""
    return (r * np.cos(angle), r * np.sin(angle), z)


def tapered_legs(rng: Rng, w: float, d: float, h: float, thick: float) -> Piece:
    """Four legs: square posts, or round ones that taper and splay outwards."""
    if chance(rng, 0.4):
        return legs4(w, d, h, thick)
    splay = rng.uniform(0.0, 0.07)
    low = [(w / 2 + splay - thick), (d / 2 + splay - thick)]
    top = [w / 2 - 1.5 * thick, d / 2 - 1.5 * thick]
    return join(
        *(
            rod((sx * low[0], sy * low[1], 0), (sx * top[0], sy * top[1], h), thick * 0.35, thick * 0.6)
            for sx, sy in CORNERS
        )
    )


def shell(grid: Array) -> Piece:
    """One open surface `[U, V, 3]` with hard borders; its normal is du x dv."""
    return Piece((Sheets(np.asarray(grid)[None], True, True),))


def clipped_below(piece: Piece, z: float) -> Piece:
    """The piece with everything below `z` flattened onto z."""

    def cut(points: Array) -> Array:
        low = points[..., 2:].clip(min=z)
        return np.concatenate([points[..., :2], low], axis=-1)

    return replace(piece, sheets=tuple(replace(s, points=cut(s.points)) for s in piece.sheets))


def fronts(
    rng: Rng, w: float, h: float, at: Point, columns: int, rows: int, mat: Material, knob: Material
) -> list[Piece]:
    """A `columns` x `rows` grid of doors or drawers on a front plane at y = at[1] facing -y, with knobs or bars."""
    x0, y, z0 = at
    cw, rh = w / columns, h / rows
    style = int(rng.integers(3))
    plates, pulls = [], []
    for i in range(columns):
        for j in range(rows):
            x, z = x0 - w / 2 + (i + 0.5) * cw, z0 + j * rh
            plates.append((cw - 0.012, 0.02, rh - 0.012, x, y - 0.008, z + 0.006))
            tall = rh > 1.3 * cw
            px = x + (cw * 0.36 * (1 if i % 2 == 0 else -1) if tall else 0.0)
            pz = z + rh * 0.5
            if style == 0:
                pulls.append(ball(0.016, (px, y - 0.032, pz)))
            elif style == 1:
                bar = (0.014, 0.02, min(rh * 0.3, 0.22)) if tall else (min(cw * 0.4, 0.24), 0.02, 0.014)
                pulls.append(box(*bar, (px, y - 0.03, pz - bar[2] / 2), 0.004))
    out = [boxes(plates, 0.005).named("drawer" if rows > columns else "door", mat)]
    return [*out, join(*pulls).named("handle", knob, 1.3)] if pulls else out


def drape(w: float, d: float, top: float, drop: float, thick: float = 0.008) -> Piece:
    """A cloth over a w x d rectangle at height `top`, hanging down on both sides and at the front."""
    t, u = np.linspace(0, 1, 17)[:, None], np.linspace(-1, 1, 23)[None]
    across, along = np.abs(u) * (w / 2 + drop), (1 - t) * (d + drop)
    over_x, over_y = np.clip(across - w / 2, 0, None), np.clip(along - d, 0, None)
    fold = 0.012 * np.sin(17 * along / max(d, 1e-6)) * (over_x > 0) + 0 * t
    x = np.sign(u) * (np.minimum(across, w / 2) + 0.012 * (over_x > 0) + fold)
    y = d / 2 - np.minimum(along, d) - 0.012 * (over_y > 0) + 0.012 * np.sin(15 * u) * (over_y > 0)
    z = top + thick - np.maximum(over_x, over_y) + 0.006 * np.sin(5 * u + 6 * t)
    grid = np.stack([x + 0 * t, y + 0 * u, z], axis=-1)
    return surface(grid[:, ::-1])


def row_of_books(rng: Rng, width: float, at: Point, deep: float, high: float, palette: list[Material]) -> list[Piece]:
    """Upright books side by side from `at` (left, front bottom) to the right, spines facing -y."""
    rows: dict[int, list[tuple[float, float, float, float, float, float]]] = {}
    x = at[0]
    while True:
        thick = rng.uniform(0.018, 0.045)
        if x + thick > at[0] + width:
            break
        h, d = high * rng.uniform(0.72, 0.97), deep * rng.uniform(0.75, 0.95)
        rows.setdefault(int(rng.integers(len(palette))), []).append(
            (thick - 0.002, d, h, x + thick / 2, at[1] + d / 2, at[2])
        )
        x += thick
        if rng.random() < 0.06:
            x += rng.uniform(0.02, 0.08)
    return [boxes(r, 0.0).named("book", palette[k]) for k, r in rows.items()]
