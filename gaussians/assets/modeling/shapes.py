"""Mesh pieces of furniture as quad grids: boxes with bevelled edges, lathes, tubes, cushions, sheets, extrusions.

Metres; z up; x right, the front faces -y.

Every surface is a grid `[U, V, 3]`: a flat side is a 2x2 grid, a lathe is profile x angle, a leaf is length x width.
The normal of a grid is `dP/du x dP/dv` and points outward. Grids of one shape are stored together, `[B, U, V, 3]`, so
that sampling takes a few array operations for any number of parts.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from .materials import Material

Array = NDArray[np.float64]
Point = tuple[float, float, float]
ROUND = 24  # segments of a grid that closes around an axis


@dataclass(frozen=True, eq=False)
class Sheets:
    """`B` grids of one shape.

    Attributes:
        points: `[B, U, V, 3]`, metres.
        hard_u, hard_v: whether the borders u = 0, 1 and v = 0, 1 are hard edges.
        closed: whether v = 1 meets v = 0.
    """

    points: Array
    hard_u: bool = True
    hard_v: bool = True
    closed: bool = False


@dataclass(frozen=True, eq=False)
class Piece:
    """Grids that share a material and a part name.

    Attributes:
        sheets: the surfaces.
        part: "leg", "seat", "shade", ...; "" until `named`.
        material: None until `named`.
        density: samples per length relative to the asset's average, for small or finely patterned pieces.
        two_sided: whether it is lit from both sides (leaves, cloth).
    """

    sheets: tuple[Sheets, ...]
    part: str = ""
    material: Material | None = None
    density: float = 1.0
    two_sided: bool = False

    def named(self, part: str, material: Material, density: float = 1.0) -> Self:
        """The same piece with a part name and a material."""
        return replace(self, part=part, material=material, density=density * self.density)

    def transformed(self, matrix: ArrayLike, offset: ArrayLike = (0.0, 0.0, 0.0)) -> Self:
        """`x -> matrix @ x + offset`; a mirroring matrix also flips the grids so that normals stay outward."""
        m, t = np.asarray(matrix, dtype=np.float64), np.asarray(offset, dtype=np.float64)
        flip = np.linalg.det(m) < 0
        moved = []
        for s in self.sheets:
            points = s.points @ m.T + t
            moved.append(replace(s, points=points[:, ::-1] if flip else points))
        return replace(self, sheets=tuple(moved))

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Self:
        """Shifted by metres."""
        offset = np.array([x, y, z])
        return replace(self, sheets=tuple(replace(s, points=s.points + offset) for s in self.sheets))

    def turned(self, axis: str, degrees: float, about: ArrayLike = (0.0, 0.0, 0.0)) -> Self:
        """Rotated counter-clockwise about the line through `about` along the axis "x", "y" or "z"."""
        centre = np.asarray(about, dtype=np.float64)
        m = rotation(axis, degrees)
        return self.transformed(m, centre - m @ centre)

    def stretched(self, x: float = 1.0, y: float = 1.0, z: float = 1.0) -> Self:
        """Scaled along the axes about the origin (a negative factor mirrors)."""
        return self.transformed(np.diag([x, y, z]))


def rotation(axis: str, degrees: float) -> Array:
    """`[3, 3]` rotation about "x", "y" or "z"."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    m = np.eye(3)
    m[i, i], m[j, j], m[i, j], m[j, i] = c, c, -s, s
    return m


def join(*pieces: Piece) -> Piece:
    """One piece made of several; material, part and density of the first."""
    return replace(pieces[0], sheets=tuple(s for p in pieces for s in p.sheets))


def bounds(pieces: Sequence[Piece]) -> tuple[Array, Array]:
    """Lowest and highest corner of all grids."""
    flat = [s.points.reshape(-1, 3) for p in pieces for s in p.sheets]
    low = np.min([f.min(axis=0) for f in flat], axis=0)
    return low, np.max([f.max(axis=0) for f in flat], axis=0)


# --- flat pieces -----------------------------------------------------------------------------------------------------


def _cube(bevel: Array) -> Array:
    """`[18, 2, 2, 3]` six sides, then twelve bevels of the cube [-1, 1]^3; `bevel [3]` in fractions of half a side."""
    sides = []
    for n, sign in ((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)):
        a, b = (n + 1) % 3, (n + 2) % 3
        grid = np.zeros((2, 2, 3))
        grid[..., n] = sign
        grid[..., a] = np.array([[-1.0, -1.0], [1.0, 1.0]]) * (1 - bevel[a])
        grid[..., b] = np.array([[-1.0, 1.0], [-1.0, 1.0]]) * (1 - bevel[b])
        sides.append(grid if sign > 0 else grid[::-1])
    for k in range(3):  # edges along axis k
        a, b = (k + 1) % 3, (k + 2) % 3
        for sa in (-1.0, 1.0):
            for sb in (-1.0, 1.0):
                grid = np.zeros((2, 2, 3))
                grid[..., k] = np.array([[-1.0, 1.0], [-1.0, 1.0]]) * (1 - bevel[k])
                grid[0, :, a], grid[0, :, b] = sa * (1 - bevel[a]), sb
                grid[1, :, a], grid[1, :, b] = sa, sb * (1 - bevel[b])
                # du = (a: sa, b: -sb), dv = +k; du x dv = (a: -sb ... ) is outward when sa * sb < 0
                sides.append(grid[::-1] if sa * sb > 0 else grid)
    return np.stack(sides)


def box(w: float, d: float, h: float, at: Point = (0.0, 0.0, 0.0), bevel: float = 0.006) -> Piece:
    """A block; `at` is the centre of its bottom face; its edges are bevelled if `bevel` > 0."""
    half = np.array([w, d, h]) / 2
    cube = _cube(np.minimum(bevel / half, 0.45)) * half + np.array([at[0], at[1], at[2] + h / 2])
    if bevel <= 0:
        return Piece((Sheets(cube[:6]),))
    return Piece((Sheets(cube[:6]), Sheets(cube[6:], hard_u=False)))


def boxes(rows: Sequence[Sequence[float]], bevel: float = 0.004) -> Piece:
    """Several blocks `(w, d, h, x, y, z)` as one piece."""
    return join(*(box(w, d, h, (x, y, z), bevel) for w, d, h, x, y, z in rows))


def legs4(w: float, d: float, h: float, leg: Piece | float, inset: float = 0.0) -> Piece:
    """Four copies of an upright piece (or square posts of width `leg`) at the corners of a w x d rectangle."""
    post = box(leg, leg, h) if isinstance(leg, int | float) else leg
    inset += leg / 2 if isinstance(leg, int | float) else 0.0
    return join(*(post.moved(sx * (w / 2 - inset), sy * (d / 2 - inset)) for sx in (-1, 1) for sy in (-1, 1)))


def quad(corners: ArrayLike) -> Piece:
    """A flat patch from four corners: (u0 v0), (u0 v1), (u1 v0), (u1 v1)."""
    return Piece((Sheets(np.asarray(corners, dtype=np.float64).reshape(1, 2, 2, 3)),))


def panel(w: float, h: float, at: Point = (0.0, 0.0, 0.0)) -> Piece:
    """A flat upright panel facing -y; `at` is the centre of its bottom edge; u runs up, v towards -x."""
    x, y, z = at
    return quad([(x + w / 2, y, z), (x - w / 2, y, z), (x + w / 2, y, z + h), (x - w / 2, y, z + h)])


# --- round pieces ----------------------------------------------------------------------------------------------------


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


def extrude(outline: ArrayLike, thick: float, rounding: float = 0.0) -> Piece:
    """A plate lying flat, bottom at z = 0: `outline` `[M, 2]`, counter-clockwise, star-shaped about its mean.

    `rounding` bevels the rims. Use `turned` to stand it upright.
    """
    o = np.asarray(outline, dtype=np.float64)
    o = np.concatenate([o, o[:1]])[::-1]  # clockwise v with upward u gives outward normals
    centre = o[:-1].mean(axis=0)
    b = min(rounding, thick / 2)
    reach = np.linalg.norm(o - centre, axis=1, keepdims=True)
    inner = centre + (o - centre) * np.maximum(1 - b / np.maximum(reach, 1e-9), 0.2)

    def level(xy: Array, z: float) -> Array:
        return np.concatenate([xy, np.full((len(xy), 1), z)], axis=1)

    middle = np.broadcast_to(centre, o.shape)
    strips = [np.stack([level(o, b), level(o, thick - b)])]
    caps = [
        np.stack([level(middle, 0.0), level(inner, 0.0)]),
        np.stack([level(inner, thick), level(middle, thick)]),
    ]
    if b > 0:
        caps += [np.stack([level(inner, 0.0), level(o, b)]), np.stack([level(o, thick - b), level(inner, thick)])]
    return Piece((Sheets(np.stack(strips + caps), True, False, True),))


def rounded_rectangle(w: float, d: float, r: float, steps: int = 6) -> Array:
    """`[4 * steps, 2]` outline, counter-clockwise, corners of radius `r`."""
    r = min(r, w / 2, d / 2)
    corners = [
        (w / 2 - r, d / 2 - r, 0),
        (-w / 2 + r, d / 2 - r, 90),
        (-w / 2 + r, -d / 2 + r, 180),
        (w / 2 - r, -d / 2 + r, 270),
    ]
    out = []
    for x, y, start in corners:
        a = np.radians(np.linspace(start, start + 90, steps))
        out.append(np.stack([x + r * np.cos(a), y + r * np.sin(a)], axis=1))
    return np.concatenate(out)


def ellipse(w: float, d: float, count: int = 24) -> Array:
    """`[count, 2]` outline, counter-clockwise."""
    a = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return np.stack([w / 2 * np.cos(a), d / 2 * np.sin(a)], axis=1)


# --- soft pieces -----------------------------------------------------------------------------------------------------


def surface(grid: ArrayLike, hard: bool = True) -> Piece:
    """An open sheet `[U, V, 3]`, lit from both sides."""
    return Piece((Sheets(np.asarray(grid, dtype=np.float64)[None], hard, hard),), two_sided=True)


def leaf(length: float, width: float, bend: float = 0.5, rise: float = 0.6) -> Piece:
    """A leaf growing from the origin along +x, first upwards at slope `rise`, then drooping by `bend`."""
    t = np.linspace(0, 1, 7)[:, None]
    s = np.linspace(-1, 1, 5)[None]
    half = width / 2 * np.sin(np.pi * np.clip(t, 0.03, 0.985) ** 0.8)
    x = length * t * (1 - 0.25 * bend * t) + 0 * s
    z = length * (rise * t - bend * t**2) - 0.15 * half * (1 - s**2)
    return surface(np.stack([x, -half * s, z], axis=-1), hard=False)
