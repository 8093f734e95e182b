"""Mesh pieces of furniture as quad grids: boxes with bevelled edges, plates, sheets; `round_shapes` has more.

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
    caps = [np.stack([level(middle, 0.0), level(inner, 0.0)]), np.stack([level(inner, thick), level(middle, thick)])]
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
