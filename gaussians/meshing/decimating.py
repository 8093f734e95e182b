"""Fewer triangles with the same shape: edges are collapsed where it moves the surface least.

Garland and Heckbert 1997, "Surface Simplification Using Quadric Error Metrics". A collapse that would join more than
two faces at an edge, or turn a face over, is not made: a closed surface stays closed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import compiled
from ..compiled import exact, exact_helper

F64 = NDArray[np.float64]
Int = NDArray[np.int64]

_PULL = 1e-3  # weight of a vertex's own place against its planes: it settles what planes leave free
_TURN = 0.2  # cosine that a face's normal may turn to
_ROOM = 8  # entries of the heap for each face


def decimate(vertices: F64, faces: Int, most: int, tolerance: float) -> tuple[F64, Int]:
    """Collapse edges of a closed surface.

    Args:
        vertices: `[V, 3]`.
        faces: `[F, 3]`, every edge in two faces.
        most: faces to leave at most; edges are collapsed until then whatever it costs.
        tolerance: then edges are collapsed while the root mean square distance to the planes stays below it.

    Returns:
        the vertices and faces that are left; equal input gives equal bytes.
    """
    v, f = vertices.astype(np.float64).copy(), faces.astype(np.int32).copy()
    n, m = len(v), len(f)
    state = (
        np.zeros((n, 10)), np.zeros(n), np.full(n, -1, np.int32), np.full(n, -1, np.int32),
        np.full(3 * m, -1, np.int32), np.zeros(n, np.int32), np.zeros(n, np.int32),
    )  # fmt: skip
    room = _ROOM * m + 16
    heap = np.empty(room), np.empty((room, 4), np.int32)
    compiled.run_alone(_decimate, v, f, state, heap, most, tolerance * tolerance, np.zeros(4), np.zeros(1, np.int64))
    kept = f[f[:, 0] >= 0]
    used, place = np.unique(kept, return_inverse=True)
    return v[used], place.reshape(-1, 3).astype(np.int64)


@exact
def _decimate(v, f, state, heap, most, limit, point, size):  # type: ignore[no-untyped-def]
    """Collapse in place; a removed face has -1 as its first corner.

    `state`: quadrics `[V, 10]`, their areas, first and last corner (3 face + place) in each vertex's list, the next
    corner in it `[3 F]`, versions and marks of vertices. `heap`: costs, and edges with the versions of their ends.
    """
    quadric, area, head, tail, following, version, mark = state
    count = f.shape[0]
    for face in range(count):
        _add_plane(v, f, face, quadric, area)
        for k in range(3):
            corner, at = 3 * face + k, f[face, k]
            if head[at] < 0:
                head[at] = corner
            else:
                following[tail[at]] = corner
            tail[at] = corner
    for i in range(v.shape[0]):
        _add_place(v, i, quadric, area)
    for face in range(f.shape[0]):
        for k in range(3):
            a, b = f[face, k], f[face, (k + 1) % 3]
            if a < b:
                _push(v, quadric, area, version, a, b, heap, size, point)
    stamp = 0
    while size[0] > 0 and count > 4:
        a, b, va, vb = _pop(heap, size)
        if version[a] != va or version[b] != vb or version[a] < 0 or version[b] < 0:
            continue
        mean = _place(v, quadric, area, a, b, point)
        if count <= most and mean > limit:
            continue
        stamp += 3
        if not _allowed(v, f, head, following, mark, stamp, a, b, point):
            continue
        count -= _collapse(v, f, quadric, area, head, tail, following, version, a, b, point)
        corner = head[a]
        while corner >= 0:
            face = corner // 3
            if f[face, 0] >= 0:
                for k in range(3):
                    other = f[face, k]
                    if other != a and mark[other] != stamp + 2:
                        mark[other] = stamp + 2
                        if size[0] < heap[0].shape[0]:
                            _push(v, quadric, area, version, a, other, heap, size, point)
            corner = following[corner]


@exact_helper
def _add_plane(v, f, face, quadric, area):  # type: ignore[no-untyped-def]
    """Add a face's plane, weighted by its area, to the quadrics of its corners."""
    a, b, c = f[face, 0], f[face, 1], f[face, 2]
    ux, uy, uz = v[b, 0] - v[a, 0], v[b, 1] - v[a, 1], v[b, 2] - v[a, 2]
    wx, wy, wz = v[c, 0] - v[a, 0], v[c, 1] - v[a, 1], v[c, 2] - v[a, 2]
    nx, ny, nz = uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx
    length = np.sqrt(nx * nx + ny * ny + nz * nz)
    if length <= 0.0:
        return
    nx, ny, nz = nx / length, ny / length, nz / length
    d = -(nx * v[a, 0] + ny * v[a, 1] + nz * v[a, 2])
    w = length / 6.0
    for i in (a, b, c):
        quadric[i, 0] += w * nx * nx
        quadric[i, 1] += w * nx * ny
        quadric[i, 2] += w * nx * nz
        quadric[i, 3] += w * ny * ny
        quadric[i, 4] += w * ny * nz
        quadric[i, 5] += w * nz * nz
        quadric[i, 6] += w * nx * d
        quadric[i, 7] += w * ny * d
        quadric[i, 8] += w * nz * d
        quadric[i, 9] += w * d * d
        area[i] += w


@exact_helper
def _add_place(v, i, quadric, area):  # type: ignore[no-untyped-def]
    w = _PULL * area[i]
    x, y, z = v[i, 0], v[i, 1], v[i, 2]
    quadric[i, 0] += w
    quadric[i, 3] += w
    quadric[i, 5] += w
    quadric[i, 6] -= w * x
    quadric[i, 7] -= w * y
    quadric[i, 8] -= w * z
    quadric[i, 9] += w * (x * x + y * y + z * z)


@exact_helper
def _error(q, r, x, y, z):  # type: ignore[no-untyped-def]
    """The summed error of two quadrics at a point."""
    return (
        (q[0] + r[0]) * x * x + (q[3] + r[3]) * y * y + (q[5] + r[5]) * z * z
        + 2.0 * ((q[1] + r[1]) * x * y + (q[2] + r[2]) * x * z + (q[4] + r[4]) * y * z)
        + 2.0 * ((q[6] + r[6]) * x + (q[7] + r[7]) * y + (q[8] + r[8]) * z) + q[9] + r[9]
    )  # fmt: skip


@exact_helper
def _place(v, quadric, area, a, b, point):  # type: ignore[no-untyped-def]
    """Write the best place for the merged vertex to `point[:3]` and its cost to `point[3]`; returns the mean cost."""
    # Coordinates relative to the middle keep the sums exact far from the origin.
    q, r = quadric[a], quadric[b]
    mx, my, mz = 0.5 * (v[a, 0] + v[b, 0]), 0.5 * (v[a, 1] + v[b, 1]), 0.5 * (v[a, 2] + v[b, 2])
    xx, xy, xz = q[0] + r[0], q[1] + r[1], q[2] + r[2]
    yy, yz, zz = q[3] + r[3], q[4] + r[4], q[5] + r[5]
    gx = -(q[6] + r[6] + xx * mx + xy * my + xz * mz)
    gy = -(q[7] + r[7] + xy * mx + yy * my + yz * mz)
    gz = -(q[8] + r[8] + xz * mx + yz * my + zz * mz)
    c0, c1, c2 = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    determinant = xx * c0 + xy * c1 + xz * c2
    trace = xx + yy + zz
    x, y, z = mx, my, mz
    if determinant > 1e-9 * trace * trace * trace:
        dx = (c0 * gx + c1 * gy + c2 * gz) / determinant
        dy = (c1 * gx + (xx * zz - xz * xz) * gy + (xy * xz - xx * yz) * gz) / determinant
        dz = (c2 * gx + (xy * xz - xx * yz) * gy + (xx * yy - xy * xy) * gz) / determinant
        ex, ey, ez = v[a, 0] - mx, v[a, 1] - my, v[a, 2] - mz
        if dx * dx + dy * dy + dz * dz <= 4.0 * (ex * ex + ey * ey + ez * ez):
            x, y, z = mx + dx, my + dy, mz + dz
    cost = max(_error(q, r, x, y, z), 0.0)
    point[0], point[1], point[2], point[3] = x, y, z, cost
    return cost / max(area[a] + area[b], 1e-300)


@exact_helper
def _push(v, quadric, area, version, a, b, heap, size, point):  # type: ignore[no-untyped-def]
    _place(v, quadric, area, a, b, point)
    costs, edges = heap
    i = size[0]
    size[0] += 1
    low, high = min(a, b), max(a, b)
    cost = point[3]
    while i > 0:
        up = (i - 1) // 2
        if costs[up] <= cost:
            break
        costs[i] = costs[up]
        for k in range(4):
            edges[i, k] = edges[up, k]
        i = up
    costs[i] = cost
    edges[i, 0], edges[i, 1], edges[i, 2], edges[i, 3] = low, high, version[low], version[high]


@exact_helper
def _pop(heap, size):  # type: ignore[no-untyped-def]
    costs, edges = heap
    a, b, va, vb = edges[0, 0], edges[0, 1], edges[0, 2], edges[0, 3]
    size[0] -= 1
    n = size[0]
    last, e0, e1, e2, e3 = costs[n], edges[n, 0], edges[n, 1], edges[n, 2], edges[n, 3]
    i = 0
    while 2 * i + 1 < n:
        child = 2 * i + 1
        if child + 1 < n and costs[child + 1] < costs[child]:
            child += 1
        if costs[child] >= last:
            break
        costs[i] = costs[child]
        for k in range(4):
            edges[i, k] = edges[child, k]
        i = child
    costs[i] = last
    edges[i, 0], edges[i, 1], edges[i, 2], edges[i, 3] = e0, e1, e2, e3
    return a, b, va, vb


@exact_helper
def _allowed(v, f, head, following, mark, stamp, a, b, point):  # type: ignore[no-untyped-def]
    """Whether the surface stays closed and no face turns over if the edge is collapsed to `point`."""
    around_a = around_b = shared = common = 0
    corner = head[a]
    while corner >= 0:
        face = corner // 3
        if f[face, 0] >= 0:
            around_a += 1
            has = False
            for k in range(3):
                other = f[face, k]
                mark[other] = stamp
                has = has or other == b
            if not has and _turns(v, f, face, a, point):
                return False
            shared += 1 if has else 0
        corner = following[corner]
    if shared != 2:
        return False
    corner = head[b]
    while corner >= 0:
        face = corner // 3
        if f[face, 0] >= 0:
            around_b += 1
            has = False
            for k in range(3):
                other = f[face, k]
                has = has or other == a
            for k in range(3):
                other = f[face, k]
                if other != a and other != b and mark[other] == stamp:
                    mark[other] = stamp + 1
                    common += 1
            if not has and _turns(v, f, face, b, point):
                return False
        corner = following[corner]
    return common == 2 and around_a + around_b - 4 >= 3


@exact_helper
def _turns(v, f, face, moved, point):  # type: ignore[no-untyped-def]
    """Whether a face turns too far, or loses its area, when one of its corners moves to `point`."""
    k = 0
    for i in range(3):
        if f[face, i] == moved:
            k = i
    b, c = f[face, (k + 1) % 3], f[face, (k + 2) % 3]
    ux, uy, uz = v[c, 0] - v[b, 0], v[c, 1] - v[b, 1], v[c, 2] - v[b, 2]
    wx, wy, wz = v[moved, 0] - v[b, 0], v[moved, 1] - v[b, 1], v[moved, 2] - v[b, 2]
    px, py, pz = point[0] - v[b, 0], point[1] - v[b, 1], point[2] - v[b, 2]
    ox, oy, oz = uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx
    nx, ny, nz = uy * pz - uz * py, uz * px - ux * pz, ux * py - uy * px
    old, new = np.sqrt(ox * ox + oy * oy + oz * oz), np.sqrt(nx * nx + ny * ny + nz * nz)
    side = ux * ux + uy * uy + uz * uz
    if new <= 0.02 * side and new < old:  # nearly a line, and no better than before
        return True
    return old > 0.0 and ox * nx + oy * ny + oz * nz < _TURN * old * new


@exact_helper
def _collapse(v, f, quadric, area, head, tail, following, version, a, b, point):  # type: ignore[no-untyped-def]
    """Merge b into a at `point`; returns the number of faces removed."""
    removed = 0
    corner = head[b]
    while corner >= 0:
        face = corner // 3
        if f[face, 0] >= 0:
            if f[face, 0] == a or f[face, 1] == a or f[face, 2] == a:
                f[face, 0] = -1
                removed += 1
            else:
                f[face, corner % 3] = a
        corner = following[corner]
    following[tail[a]] = head[b]
    tail[a] = tail[b]
    v[a, 0], v[a, 1], v[a, 2] = point[0], point[1], point[2]
    for k in range(10):
        quadric[a, k] += quadric[b, k]
    area[a] += area[b]
    version[a] += 1
    version[b] = -1
    return removed
