"""Cuts the surfaces of mesh pieces into flat cells of even size, without holes; each cell becomes one Gaussian.

A grid is cut into rows of equal width along u, and each row into cells of equal length along v. The number of cells is
chosen row by row, so a sphere gets fewer cells at its poles. On closed grids, neighbouring rows are shifted by half a
cell. Cells at hard borders are narrower, so that a Gaussian as wide as its cell does not blur over the edge.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .patterns import FINE, Surface, paint
from .shapes import Piece, Sheets

Array = NDArray[np.float64]
COVER = 0.6  # standard deviation over cell length: a surface without holes whose edges stay crisp
EDGE = 0.45  # width of a cell at a hard border, as a share of the other cells'
MIN_AROUND = 6  # cells around the thinnest bar; with fewer it looks flat


@dataclass(frozen=True, eq=False)
class Samples:
    """`N` cells.

    Attributes:
        xyz: `[N, 3]` centres, metres.
        frame: `[N, 3, 3]` columns are the two tangents and the outward normal, orthonormal, right-handed.
        size: `[N, 2]` lengths of the cell along the tangents, metres.
        uv: `[N, 2]` grid parameters.
        piece: `[N]` index of the piece that each cell belongs to.
    """

    xyz: Array
    frame: Array
    size: Array
    uv: Array
    piece: NDArray[np.int64]

    @property
    def normal(self) -> Array:
        """`[N, 3]` outward normals."""
        return self.frame[:, :, 2]

    def __getitem__(self, rows: NDArray[np.bool_]) -> Samples:
        """The chosen rows of every column."""
        return Samples(self.xyz[rows], self.frame[rows], self.size[rows], self.uv[rows], self.piece[rows])


def sample(pieces: Sequence[Piece], spacing: float) -> Samples:
    """Cut all pieces into cells about `spacing` metres long, smaller on dense pieces and fine patterns."""
    batches: dict[tuple[int, int, bool, bool, bool], list[tuple[int, Sheets, float]]] = {}
    for index, piece in enumerate(pieces):
        fine = FINE.get(piece.material.pattern, 1.0) if piece.material else 1.0
        for s in piece.sheets:
            key = (s.points.shape[1], s.points.shape[2], s.hard_u, s.hard_v, s.closed)
            batches.setdefault(key, []).append((index, s, spacing / (piece.density * fine)))
    parts = [_cut(key, rows) for key, rows in batches.items()]
    joined = [np.concatenate([getattr(p, name) for p in parts]) for name in ("xyz", "frame", "size", "uv", "piece")]
    order = np.argsort(joined[4], kind="stable")  # by piece, independent of the batches
    return Samples(*(column[order] for column in joined))


def _cut(key: tuple[int, int, bool, bool, bool], rows: list[tuple[int, Sheets, float]]) -> Samples:
    """Cells of all grids of one shape and border kind."""
    _, _, hard_u, hard_v, closed = key
    grid = np.concatenate([s.points for _, s, _ in rows])  # [B, U, V, 3]
    count = [len(s.points) for _, s, _ in rows]
    piece = np.repeat([i for i, _, _ in rows], count)  # [B]
    space = np.repeat([d for _, _, d in rows], count)  # [B]

    along_u = np.linalg.norm(np.diff(grid, axis=1), axis=3).mean(axis=2)  # [B, U-1]
    number = cells_along(along_u.sum(axis=1), space, hard_u)  # [B]
    b, k, at_u, wide_u = divide(number, hard_u)  # [R] each: grid, row in it, centre and width as parts of one
    i, f, length_u = _locate(along_u, b, at_u)
    f = f[:, None, None]
    line = grid[b, i] * (1 - f) + grid[b, i + 1] * f  # [R, V, 3]
    slope = grid[b, i + 1] - grid[b, i]

    along_v = np.linalg.norm(np.diff(line, axis=1), axis=2)  # [R, V-1]
    number = cells_along(along_v.sum(axis=1), space[b], hard_v)
    if closed:  # a bar keeps its roundness, except where it shrinks to a point
        number = np.where(along_v.sum(axis=1) > 0.25 * space[b], np.maximum(number, MIN_AROUND), number)
    r, _, at_v, wide_v = divide(number, hard_v)  # [N]
    if not hard_v:
        at_v = np.mod(at_v + 0.5 * wide_v * (k[r] % 2), 1.0) if closed else at_v
    j, g, length_v = _locate(along_v, r, at_v)
    g = g[:, None]
    xyz = line[r, j] * (1 - g) + line[r, j + 1] * g
    tangent_u = slope[r, j] * (1 - g) + slope[r, j + 1] * g
    tangent_v = line[r, j + 1] - line[r, j]
    frame, slant = _frames(tangent_u, tangent_v)
    size = np.stack([wide_u[r] * length_u[r] * slant, wide_v * length_v], axis=1)
    return Samples(xyz, frame, size, np.stack([at_u[r], at_v], axis=1), piece[b][r])


def covered(samples: Samples) -> NDArray[np.bool_]:
    """`[N]` bool, cells that lie just under a cell of another piece with a similar normal, e.g. under a bottle's label.

    Renderers sort Gaussians by the depth of their centres, so two surfaces that are closer than the length of their
    cells would show through each other.
    """
    from scipy.spatial import cKDTree

    reach = samples.size.max(axis=1)
    tree = cKDTree(samples.xyz)
    lift = np.minimum(0.4 * reach, 0.02)
    _, near = tree.query(samples.xyz + samples.normal * lift[:, None], k=4)
    hidden = np.zeros(len(reach), dtype=bool)
    for other in near.T:
        gap = samples.xyz[other] - samples.xyz
        height = np.einsum("ni,ni->n", gap, samples.normal)
        beside = np.linalg.norm(gap - height[:, None] * samples.normal, axis=1)
        alike = np.einsum("ni,ni->n", samples.normal[other], samples.normal) > 0.8
        over = (
            (height > 2e-4)
            & (height < np.minimum(1.1 * reach, 0.03))
            & (beside < 0.75 * samples.size[other].max(axis=1))
        )
        hidden |= over & alike & (samples.piece[other] != samples.piece)
    return hidden


def cells_along(length: Array, space: Array, hard: bool) -> NDArray[np.int64]:
    """Number of cells that cover a length; hard borders need narrow cells in addition."""
    number = np.maximum(np.ceil(length / space - 0.05), 1)
    if hard:  # n - 2 whole cells and two narrow ones cover the length
        number = np.where(number >= 2, np.ceil(length / space + 2 * (1 - EDGE) - 0.3), number)
    return number.astype(np.int64)


def divide(number: NDArray[np.int64], hard: bool) -> tuple[NDArray[np.int64], NDArray[np.int64], Array, Array]:
    """Divide each unit length b into `number[b]` cells: owner b, index, centre and width of each cell, flat arrays."""
    owner = np.repeat(np.arange(len(number)), number)
    index = np.arange(len(owner)) - np.repeat(np.cumsum(number) - number, number)
    n = number[owner]
    edge = np.where(n >= 3, EDGE, 1.0) if hard else np.ones(len(n))
    whole = np.where(n >= 3, n - 2 + 2 * edge, n)
    first, last = (index == 0) & (n >= 3), (index == n - 1) & (n >= 3)
    centre = np.where(first, edge / 2, np.where(last, whole - edge / 2, index - (1 - edge) + 0.5))
    width = np.where(first | last, edge, 1.0)
    return owner, index, centre / whole, width / whole


def _locate(segments: Array, owner: NDArray[np.int64], at: Array) -> tuple[NDArray[np.int64], Array, Array]:
    """Find arc-length positions `at` in [0, 1] on polylines `owner`: segment index, fraction in it, total length."""
    ends = np.cumsum(segments, axis=1)  # [B, S]
    total = ends[:, -1][owner]
    target = at * total
    j = np.minimum((ends[owner] <= target[:, None]).sum(axis=1), segments.shape[1] - 1)
    piece = segments[owner, j]
    fraction = np.where(piece > 1e-12, (target - (ends[owner, j] - piece)) / np.maximum(piece, 1e-12), 0.5)
    return j, np.clip(fraction, 0.0, 1.0), total


def _frames(u: Array, v: Array) -> tuple[Array, Array]:
    """Orthonormal frames `[N, 3, 3]` from two tangents, and the share `[N]` of `u` that is perpendicular to `v`."""
    normal = np.cross(u, v)
    size_n, size_u, size_v = (np.linalg.norm(x, axis=1, keepdims=True) for x in (normal, u, v))
    bad = (size_n[:, 0] <= 1e-7 * np.maximum(size_u * size_v, 1e-12)[:, 0]) | (size_v[:, 0] < 1e-9)
    normal = np.where(bad[:, None], np.array([0.0, 0.0, 1.0]), normal / np.maximum(size_n, 1e-15))
    v = np.where(bad[:, None], np.array([1.0, 0.0, 0.0]), v / np.maximum(size_v, 1e-15))
    first = np.cross(v, normal)
    slant = np.where(bad, 1.0, np.abs(np.einsum("ni,ni->n", first, u)) / np.maximum(size_u[:, 0], 1e-12))
    return np.stack([first, v, normal], axis=2), np.clip(slant, 0.3, 1.0)


def albedo(pieces: Sequence[Piece], samples: Samples) -> Array:
    """RGB `[N, 3]` before lighting: each material is painted once over all its samples."""
    out = np.empty((len(samples.xyz), 3))
    owners: dict[object, list[int]] = {}
    for index, piece in enumerate(pieces):
        assert piece.material is not None, f"piece {piece.part!r} has no material"
        owners.setdefault(piece.material, []).append(index)
    for material, indices in owners.items():
        table = np.zeros(len(pieces), dtype=bool)
        table[indices] = True
        rows = table[samples.piece]
        surface = Surface(samples.xyz[rows], samples.normal[rows], samples.uv[rows])
        out[rows] = paint(surface, material)  # type: ignore[arg-type]
    return out


def area(pieces: Sequence[Piece]) -> float:
    """Total surface area, square metres, from the diagonals of the grid cells."""
    total = 0.0
    for s in (s for p in pieces for s in p.sheets):
        d1 = s.points[:, 1:, 1:] - s.points[:, :-1, :-1]
        d2 = s.points[:, 1:, :-1] - s.points[:, :-1, 1:]
        total += 0.5 * float(np.linalg.norm(np.cross(d1, d2), axis=-1).sum())
    return total
