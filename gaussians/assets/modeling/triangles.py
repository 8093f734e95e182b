"""Cuts the triangles of a mesh into flat cells; each cell becomes one Gaussian.

A Gaussian reaches beyond its cell, which nobody sees within a surface. At its outlines, where it ends or turns sharply,
it would stick out. So a narrow strip is cut off along them and divided along its length; what is left of a triangle is
halved across its longest side until no side is longer than wanted. Small cells that are neighbours in one patch are
merged. Last, cells are narrowed across the outlines near them, so that half of an outline is covered and hardly
anything beyond it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from .sampling import COVER, EDGE, cells_along, divide

Array = NDArray[np.float64]
Int = NDArray[np.int64]
_SHARP = 20.0  # degrees between faces from which their common edge may be seen as an outline
_TALL = 1.5  # times the spacing: a triangle's height from which a strip is cut off
_SMALL = 0.3  # of the squared spacing: the area of a cell up to which it is merged with others
_STRIP = 0.25  # of a triangle's height: the widest strip
_INWARD = 0.5  # of a strip's width: the distance of its Gaussians from the outline
_CLEAR = 2.0  # standard deviations of a Gaussian that lie between its centre and an outline, at least
_LEAST = 0.1  # share of its width that a cell keeps
_NEAR, _REACH = 16, 2.0  # points of outlines that are looked at around each cell; times the spacing
_PAST = 0.5  # of the spacing, by which an outline counts beyond its ends: corners may be rounded
_FLAT = 0.3  # sine of the angle to a cell's plane up to which an outline is in that plane
_LONGEST = 1.5  # of the spacing: the longest side of a cell that is no strip
_SAME = 1e-5  # of the mesh's extent: vertices that are nearer are one
_THINNEST = 1e-9  # of the square of the longest side: the double area of a triangle that has no height


@dataclass(frozen=True, eq=False)
class Cells:
    """`N` cells of a mesh.

    Attributes:
        xyz: `[N, 3]` centres.
        frame: `[N, 3, 3]` columns are the two tangents and the normal, orthonormal, right-handed.
        size: `[N, 2]` lengths along the tangents.
        face: `[N]` the triangle that each is of.
        weights: `[N, 3]` barycentric coordinates of the centre in it.
    """

    xyz: Array
    frame: Array
    size: Array
    face: Int
    weights: Array


def cut(triangles: Array, spacing: float, part: Int | None = None) -> Cells:
    """Cells about `spacing` long that cover triangles `[F, 3, 3]`; triangles without area have none.

    Args:
        part: `[F]` the material that each is of, which may end where the surface goes on; None: all are of one.
    """
    sides = np.linalg.norm(np.roll(triangles, -1, axis=1) - triangles, axis=2)  # [F, 3], side i from corner i to i + 1
    across = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = np.linalg.norm(across, axis=1)
    whole = np.flatnonzero(area > _THINNEST * np.maximum(sides.max(axis=1) ** 2, 1e-30))
    hard, patch = outlines(triangles, part)
    height = area[whole, None] / np.maximum(sides[whole], 1e-30)
    cutting = hard[whole] & (height > _TALL * spacing)
    strip = np.where(cutting, np.minimum(EDGE * spacing / height, _STRIP), 0.0)  # [W, 3], share of the height
    parts = [_strips(triangles[whole], strip, i, spacing) for i in range(3)]
    parts.append(_inner(triangles[whole], strip, spacing))
    corners = np.concatenate([p[0] for p in parts])  # [N, 4, 3] barycentric, in order around
    owner = np.concatenate([p[1] for p in parts])
    order = np.argsort(owner, kind="stable")
    cells = merged(_as_cells(triangles, corners[order], whole[owner[order]]), patch, spacing)
    return narrowed(cells, triangles, hard, patch, spacing)


def outlines(triangles: Array, part: Int | None = None) -> tuple[NDArray[np.bool_], Int]:
    """`[F, 3]` whether each side of triangles `[F, 3, 3]` is an outline: it borders no other triangle of its part, or
    turns sharply to it; and `[F]` the number of the patch that each is of, which ends at outlines."""
    points = triangles.reshape(-1, 3)
    extent = float(np.ptp(points, axis=0).max())
    grid = np.round((points - points.min(axis=0)) / max(_SAME * extent, 1e-30)).astype(np.int64)
    own = np.zeros(len(grid), dtype=np.int64) if part is None else np.repeat(part, 3)
    _, corner = np.unique(np.column_stack([grid, own]), axis=0, return_inverse=True)
    corner = corner.reshape(-1, 3)
    ends = np.sort(np.stack([corner, np.roll(corner, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    _, edge, count = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    edge = edge.reshape(-1)
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    order = np.argsort(edge, kind="stable")
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    flat = np.zeros(len(count), dtype=bool)
    paired = np.flatnonzero(count == 2)
    one, other = (normal[order[first[paired] + k] // 3] for k in (0, 1))
    flat[paired] = (one * other).sum(axis=1) > np.cos(np.radians(_SHARP))
    joins = paired[flat[paired]]
    faces = [order[first[joins] + k] // 3 for k in (0, 1)]
    graph = coo_array((np.ones(len(joins)), (faces[0], faces[1])), shape=(len(triangles),) * 2)
    patch = connected_components(graph, directed=False)[1].astype(np.int64)
    return ~flat[edge].reshape(-1, 3), patch


def merged(cells: Cells, patch: Int, spacing: float) -> Cells:
    """The cells, with all small ones of a patch that lie in one voxel as wide as `spacing` and face the same way
    replaced by one with their area, middle and second moments; `patch` is of `outlines`."""
    area = cells.size.prod(axis=1)
    small = area < _SMALL * spacing**2
    if small.sum() < 2:
        return cells
    xyz, frame, area = cells.xyz[small], cells.frame[small], area[small]
    voxel = np.floor((xyz - xyz.min(axis=0)) / spacing).astype(np.int64)
    facing = np.abs(frame[:, :, 2]).argmax(axis=1)  # a knob that is smaller than a voxel has several sides
    facing = 2 * facing + (np.take_along_axis(frame[:, :, 2], facing[:, None], axis=1)[:, 0] > 0)
    key = np.column_stack([voxel, patch[cells.face[small]], facing])
    _, first, which = np.unique(key, axis=0, return_index=True, return_inverse=True)
    which, count = which.reshape(-1), len(first)

    def mean(values: Array) -> Array:
        flat = values.reshape(len(values), -1)
        total = np.stack([np.bincount(which, area * column, count) for column in flat.T], axis=1)
        return (total / np.bincount(which, area, count)[:, None]).reshape(count, *values.shape[1:])

    middle, normal = mean(xyz), mean(frame[:, :, 2])
    lengths = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = np.where(lengths > 1e-6, normal / np.maximum(lengths, 1e-30), frame[first, :, 2])
    apart = xyz - middle[which]
    spread = frame[:, :, :2] * (cells.size[small] / math.sqrt(12))[:, None, :]
    moments = mean(spread @ spread.transpose(0, 2, 1) + apart[:, :, None] * apart[:, None, :])
    level = np.eye(3) - normal[:, :, None] * normal[:, None, :]
    value, axis = np.linalg.eigh(level @ moments @ level)  # the axis of the least value is the normal
    along = axis[:, :, 2] - normal * (axis[:, :, 2] * normal).sum(axis=1, keepdims=True)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-30)
    turned = np.stack([along, np.cross(normal, along), normal], axis=2)
    size = np.sqrt(12 * np.maximum(value[:, [2, 1]], 0.0))
    order = np.lexsort((area, which))  # colours are those of the largest cell
    largest = np.flatnonzero(small)[order[np.append(np.flatnonzero(np.diff(which[order])), len(order) - 1)]]
    rest = ~small
    return Cells(
        np.concatenate([cells.xyz[rest], middle]),
        np.concatenate([cells.frame[rest], turned]),
        np.concatenate([cells.size[rest], size]),
        np.concatenate([cells.face[rest], cells.face[largest]]),
        np.concatenate([cells.weights[rest], cells.weights[largest]]),
    )


def narrowed(cells: Cells, triangles: Array, hard: NDArray[np.bool_], patch: Int, spacing: float) -> Cells:
    """The cells, each no wider across the outlines of its own patch than its distance from them allows.

    Args:
        hard, patch: of `outlines`.
    """
    face, side = np.nonzero(hard)
    if not len(face):
        return cells
    start, end = triangles[face, side], triangles[face, (side + 1) % 3]
    length = np.linalg.norm(end - start, axis=1)
    inward = np.cross(np.cross(end - start, triangles[face, (side + 2) % 3] - start), end - start)
    count = np.maximum(np.ceil(2 * length / spacing), 1).astype(np.int64)
    segment = np.repeat(np.arange(len(face)), count)
    share = (np.arange(len(segment)) - np.repeat(np.cumsum(count) - count, count) + 0.5) / count[segment]
    points = start[segment] + share[:, None] * (end - start)[segment]
    reach = _REACH * spacing  # patches are told apart by a fourth coordinate
    points = np.column_stack([points, 2 * reach * patch[face][segment]])
    places = np.column_stack([cells.xyz, 2 * reach * patch[cells.face]])
    far, near = cKDTree(points).query(places, k=min(_NEAR, len(points)), distance_upper_bound=reach)
    far, near = far.reshape(len(cells.xyz), -1), near.reshape(len(cells.xyz), -1)
    shape = np.zeros((len(cells.xyz), 2, 2))  # the matrix whose rows are the sides of each cell, in its plane
    shape[:, [0, 1], [0, 1]] = cells.size
    for column, distance in zip(near.T, far.T, strict=True):
        rows = np.flatnonzero(np.isfinite(distance))
        own = segment[column[rows]]
        way, away, meets = _across(cells, rows, start[own], end[own], inward[own], _PAST * spacing)
        rows, way, away = rows[meets], way[meets], away[meets]
        wide = COVER * np.linalg.norm((shape[rows] @ way[:, :, None])[:, :, 0], axis=1)
        shrink = np.clip(away / np.maximum(_CLEAR * wide, 1e-30), _LEAST, 1.0) - 1
        shape[rows] += (shape[rows] @ way[:, :, None]) * (shrink[:, None, None] * way[:, None, :])
    _, size, turn = np.linalg.svd(shape)
    turn[np.linalg.det(turn) < 0, 1] *= -1
    frame = cells.frame.copy()
    frame[:, :, :2] = cells.frame[:, :, :2] @ turn.transpose(0, 2, 1)
    return replace(cells, frame=frame, size=size)


def _across(
    cells: Cells, rows: Int, start: Array, end: Array, inward: Array, past: float
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """From some cells, rows `[M]`, to the lines through segments: the unit direction in the plane of each `[M, 2]`, the
    distance `[M]`, and whether the nearest point of the line is on the segment, or at most `past` beyond it, in the
    plane, and the cell on its inner side (`inward` `[M, 3]`)."""
    along = end - start
    length = np.maximum(np.linalg.norm(along, axis=1), 1e-30)
    along = along / length[:, None]
    gap = start - cells.xyz[rows]
    at = -(gap * along).sum(axis=1)
    inside = (gap * inward).sum(axis=1) < 0
    gap = gap + at[:, None] * along
    away = np.linalg.norm(gap, axis=1)
    way = np.einsum("mi,mij->mj", gap, cells.frame[rows]) / np.maximum(away, 1e-30)[:, None]
    meets = inside & (at >= -past) & (at <= length + past) & (np.abs(way[:, 2]) < _FLAT) & (away > 0)
    level = way[:, :2] / np.maximum(np.linalg.norm(way[:, :2], axis=1, keepdims=True), 1e-30)
    return level, away, meets


def _strips(triangles: Array, strip: Array, side: int, spacing: float) -> tuple[Array, Int]:
    """The strips along one side of each triangle, divided along their length: corners `[M, 4, 3]` in barycentric
    coordinates, and the triangle of each."""
    own = np.flatnonzero(strip[:, side] > 0)
    outer = np.zeros((len(own), 2, 3))
    a, b = side, (side + 1) % 3
    outer[:, 0, a] = outer[:, 1, b] = 1.0
    inner = _inset(strip[own])[:, [a, b]]
    length = np.linalg.norm(triangles[own, b] - triangles[own, a], axis=1)
    which, _, at, wide = divide(cells_along(length, np.full(len(own), spacing), True), True)
    low, high = ((at + s * wide / 2)[:, None] for s in (-1, 1))

    def along(line: Array, share: Array) -> Array:
        return line[which, 0] * (1 - share) + line[which, 1] * share

    corners = np.stack([along(outer, low), along(outer, high), along(inner, high), along(inner, low)], axis=1)
    return corners, own[which]


def _inset(strip: Array) -> Array:
    """`[W, 3, 3]` barycentric corners of what is left of triangles without their strips (shares `[W, 3]` of the height
    over each side)."""
    opposite = np.roll(strip, -1, axis=1)  # the side opposite to corner i is that from i + 1 to i + 2
    left = np.repeat(opposite[:, None, :], 3, axis=1)
    corner = np.arange(3)
    left[:, corner, corner] = 1.0 - (opposite.sum(axis=1, keepdims=True) - opposite)
    return left


def _inner(triangles: Array, strip: Array, spacing: float) -> tuple[Array, Int]:
    """What is left of triangles without their strips, halved until it is short enough, as in `_strips`; the last corner
    is there twice."""
    bary, owner = _inset(strip), np.arange(len(triangles))
    done: list[tuple[Array, Int]] = []
    while len(bary):
        xyz = bary @ triangles[owner]
        sides = np.linalg.norm(np.roll(xyz, -1, axis=1) - xyz, axis=2)
        longest = sides.argmax(axis=1)
        small = sides.max(axis=1) <= _LONGEST * spacing
        done.append((bary[small], owner[small]))
        rest, own, at = bary[~small], owner[~small], longest[~small]
        rows = np.arange(len(rest))
        a, b, c = rest[rows, at], rest[rows, (at + 1) % 3], rest[rows, (at + 2) % 3]
        middle = (a + b) / 2
        bary = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
        owner = np.concatenate([own, own])
    found = np.concatenate([d[0] for d in done])
    return found[:, [0, 1, 2, 2]], np.concatenate([d[1] for d in done])


def _as_cells(triangles: Array, corners: Array, face: Int) -> Cells:
    """Cells from their corners `[N, 4, 3]` in barycentric coordinates; those with three corners have the last one
    twice."""
    three = (corners[:, 2] == corners[:, 3]).all(axis=1)
    xyz = corners @ triangles[face]
    outer, inner = corners[:, :2].mean(axis=1), corners[:, 2:].mean(axis=1)
    weights = np.where(three[:, None], corners[:, :3].mean(axis=1), outer + _INWARD * (inner - outer))
    normal = np.cross(triangles[face, 1] - triangles[face, 0], triangles[face, 2] - triangles[face, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    # Of a strip the first tangent runs along it; of a triangle along the longer axis of its second moments.
    along = xyz[:, 1] - xyz[:, 0] + xyz[:, 2] - xyz[:, 3]
    apart = xyz[:, :3] - xyz[:, :3].mean(axis=1, keepdims=True)
    moments = apart.transpose(0, 2, 1) @ apart / 12
    value, axis = np.linalg.eigh(moments[three])
    along[three] = axis[:, :, 2]
    first = along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-30)
    first -= normal * (first * normal).sum(axis=1, keepdims=True)
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-30)
    second = np.cross(normal, first)
    size = np.stack([np.abs((along * first).sum(axis=1)) / 2, np.zeros(len(face))], axis=1)
    upward = (xyz[:, 3] - xyz[:, 0] + xyz[:, 2] - xyz[:, 1]) / 2
    size[:, 1] = np.abs((upward * second).sum(axis=1))
    size[three] = np.sqrt(12 * np.maximum(value[:, [2, 1]], 0.0))  # sides of the rectangle with the same moments
    middle = (weights[:, :, None] * triangles[face]).sum(axis=1)
    return Cells(middle, np.stack([first, second, normal], axis=2), size, face, weights)
