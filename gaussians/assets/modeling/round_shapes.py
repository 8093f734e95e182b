"""Round mesh pieces: lathes, tubes, rings, ellipsoids, cushions and pillows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from .shapes import Array, Piece, Point, Sheets, join, rotation

ROUND = 24  # segments of a grid that closes around an axis


def lathe(profile: ArrayLike, at: Point = (0.0, 0.0, 0.0), smooth: int = 0) -> Piece:
    """A surface of revolution about z.

    `profile` is `[M, 2]` (radius, height); the outside is to the right of its direction. `smooth` > 0 resamples it as
    a curve with that many points.
    """
    rz = np.asarray(profile, dtype=np.float64)
    if smooth:
        rz = curve(rz, smooth)
        rz[:, 0] = np.maximum(rz[:, 0], 0.0)
    angle = np.linspace(0, 2 * np.pi, ROUND + 1)
    ring = np.stack([np.cos(angle), -np.sin(angle)], axis=-1)
    grid = np.concatenate(
        [rz[:, None, :1] * ring[None], np.broadcast_to(rz[:, None, 1:], (len(rz), ROUND + 1, 1))], axis=-1
    )
    return Piece((Sheets(grid[None] + np.asarray(at), hard_u=not smooth, hard_v=False, closed=True),))


def turned_parts(*profiles: ArrayLike, at: Point = (0.0, 0.0, 0.0)) -> Piece:
    """A lathe with hard edges between the profiles."""
    return join(*(lathe(p, at) for p in profiles))


def disc(r: float, at: Point = (0.0, 0.0, 0.0), up: bool = True) -> Piece:
    """A round flat plate facing up or down."""
    return lathe([(r, 0.0), (0.0, 0.0)] if up else [(0.0, 0.0), (r, 0.0)], at)


def cylinder(r: float, h: float, at: Point = (0.0, 0.0, 0.0), top: float | None = None, bevel: float = 0.0) -> Piece:
    """A cylinder, or a frustum with radius `top` at its top; `at` is the centre of its bottom."""
    t = r if top is None else top
    b = min(bevel, h / 3, r / 2)
    if b > 0:
        return turned_parts(
            [(0, 0), (r - b, 0)], [(r - b, 0), (r, b)], [(r, b), (t, h - b)], [(t, h - b), (t - b, h)],
            [(max(t - b, 0), h), (0, h)], at=at,
        )  # fmt: skip
    caps = [[(0, 0), (r, 0)]] if r > 0 else []
    return turned_parts(*caps, [(r, 0), (t, h)], *([[(t, h), (0, h)]] if t > 0 else []), at=at)


def rod(a: Sequence[float], b: Sequence[float], r: float, top: float | None = None) -> Piece:
    """A straight round bar from `a` to `b`, of radius `r` at `a`."""
    return tube(np.array([a, b]), [r, r if top is None else top])


def curve(points: ArrayLike, count: int) -> Array:
    """`[count, D]` points of a Catmull-Rom curve through `points`, evenly spaced in its parameter."""
    p = np.asarray(points, dtype=np.float64)
    if len(p) < 3:
        t = np.linspace(0, 1, count)[:, None]
        return np.asarray(p[0] * (1 - t) + p[-1] * t)
    ext = np.concatenate([[2 * p[0] - p[1]], p, [2 * p[-1] - p[-2]]])
    t = np.linspace(0, len(p) - 1, count)
    i = np.minimum(t.astype(int), len(p) - 2)
    f = (t - i)[:, None]
    a, b, c, d = ext[i], ext[i + 1], ext[i + 2], ext[i + 3]
    return np.asarray(0.5 * (2 * b + (c - a) * f + (2 * a - 5 * b + 4 * c - d) * f**2 + (3 * b - a - 3 * c + d) * f**3))


def tube(path: ArrayLike, radius: ArrayLike, closed: bool = False, segments: int = 12, smooth: int = 0) -> Piece:
    """A round bar along `path` `[M, 3]`; `radius` is a number or `[M]`. Open paths get caps, closed ones none."""
    p = np.asarray(path, dtype=np.float64)
    r = np.broadcast_to(np.asarray(radius, dtype=np.float64), (len(p),))
    if smooth:
        joined = curve(np.concatenate([p, r[:, None]], axis=1), smooth)
        p, r = joined[:, :3], joined[:, 3]
    step = np.gradient(p, axis=0) if len(p) > 2 else np.repeat(p[-1:] - p[:1], 2, axis=0)
    if closed:
        step[0] = step[-1] = p[1] - p[-2]
    forward = step / np.maximum(np.linalg.norm(step, axis=1, keepdims=True), 1e-12)
    side = _transported(forward, closed)
    other = np.cross(forward, side)
    angle = np.linspace(0, 2 * np.pi, segments + 1)
    ring = np.cos(angle)[None, :, None] * side[:, None] - np.sin(angle)[None, :, None] * other[:, None]
    grid = p[:, None] + r[:, None, None] * ring
    sheets = [Sheets(grid[None], hard_u=not closed and not smooth, hard_v=False, closed=True)]
    if not closed:
        caps = [
            np.stack([np.broadcast_to(p[0], grid[0].shape), grid[0]]),
            np.stack([grid[-1], np.broadcast_to(p[-1], grid[0].shape)]),
        ]
        sheets.append(Sheets(np.stack(caps), hard_u=False, hard_v=False, closed=True))
    return Piece(tuple(sheets))


def _transported(forward: Array, closed: bool) -> Array:
    """`[M, 3]` unit vectors perpendicular to `forward`, transported along the path with minimal rotation."""
    if closed:  # closed paths are planar here, so the plane's normal is used at every point
        normal = np.cross(forward[0], forward[len(forward) // 3])
        return np.broadcast_to(normal / np.linalg.norm(normal), forward.shape)
    side = np.empty_like(forward)
    start = np.eye(3)[int(np.argmin(np.abs(forward[0])))]
    for i, f in enumerate(forward):
        start = start - f * (start @ f)
        start = start / np.linalg.norm(start)
        side[i] = start
    return side


def ring(r: float, thick: float, at: Point = (0.0, 0.0, 0.0), axis: str = "z", squash: float = 1.0) -> Piece:
    """A torus of bar radius `thick`."""
    t = np.linspace(0, 2 * np.pi, ROUND + 1)
    path = np.stack([r * np.cos(t), r * squash * np.sin(t), 0 * t], axis=1)
    piece = tube(path, thick, closed=True, segments=8)
    turn = {"z": np.eye(3), "x": rotation("y", 90), "y": rotation("x", 90)}[axis]
    return piece.transformed(turn, at)


def blob(w: float, d: float, h: float, at: Point = (0.0, 0.0, 0.0), square: float = 1.0, flat: float = 1.0) -> Piece:
    """A superellipsoid centred on `at`; exponents `square` (seen from above) and `flat` (from the side): 1 is round,
    towards 0 it becomes a box."""
    lat = np.linspace(-np.pi / 2, np.pi / 2, 15)[:, None]
    lon = np.linspace(0, -2 * np.pi, ROUND + 9)[None]
    c, s = _signed(np.cos(lat), flat), _signed(np.sin(lat), flat)
    grid = np.stack(
        [c * _signed(np.cos(lon), square) * w / 2, c * _signed(np.sin(lon), square) * d / 2, s * h / 2 + 0 * lon],
        axis=-1,
    )
    return Piece((Sheets(grid[None] + np.asarray(at), hard_u=False, hard_v=False, closed=True),))


def _signed(x: Array, power: float) -> Array:
    return np.asarray(np.sign(x) * np.abs(x) ** power)


def ball(r: float, at: Point = (0.0, 0.0, 0.0)) -> Piece:
    """A sphere centred on `at`."""
    return blob(2 * r, 2 * r, 2 * r, at)


def cushion(w: float, d: float, h: float, at: Point = (0.0, 0.0, 0.0), square: float = 0.35) -> Piece:
    """A stuffed block with rounded sides and a slightly domed top; `at` is the centre of its bottom."""
    return blob(w, d, h, (at[0], at[1], at[2] + h / 2), square, 0.45)


def pillow(w: float, h: float, thick: float, at: Point = (0.0, 0.0, 0.0)) -> Piece:
    """A throw pillow lying flat, centred on `at`: thin edges, pointed corners, thick middle."""
    t = np.linspace(-1, 1, 11)
    u, v = np.meshgrid(t, t, indexing="ij")
    bulge = np.sqrt(np.clip((1 - u**4) * (1 - v**4), 0, 1)) * thick / 2
    pinch = 1 - 0.10 * (1 - np.abs(u) ** 2) * np.abs(v) ** 3, 1 - 0.10 * (1 - np.abs(v) ** 2) * np.abs(u) ** 3
    top = np.stack([u * w / 2 * pinch[1], v * h / 2 * pinch[0], bulge], axis=-1) + np.asarray(at)
    low = np.stack([u * w / 2 * pinch[1], v * h / 2 * pinch[0], -bulge], axis=-1) + np.asarray(at)
    return Piece((Sheets(np.stack([top, low[::-1]]), False, False),))
