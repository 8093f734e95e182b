"""The surface of a field on a grid by marching tetrahedra: closed, without borders and without edges of three faces.

Each cube is cut into the six tetrahedra around its diagonal (Kuhn), the same way in every cube, so that neighbours
agree on their common face. A tetrahedron has no ambiguous case, as cubes have (Doi and Koide 1991).
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Int = NDArray[np.int64]


def surface(field: NDArray[np.floating]) -> tuple[F64, Int]:
    """Vertices `[V, 3]` in grid steps and triangles `[F, 3]`, counter-clockwise seen from the positive side, of the
    surface where `field [X, Y, Z]` changes from negative (inside) to positive; its border must be positive."""
    inside = field < 0
    shape = np.array(field.shape)
    corner = np.array(list(itertools.product((0, 1), repeat=3)))  # [8, 3]; corner 4 a + 2 b + c is (a, b, c)
    count = np.zeros(tuple(shape - 1), np.int8)
    for a, b, c in corner:
        count += inside[a : shape[0] - 1 + a, b : shape[1] - 1 + b, c : shape[2] - 1 + c]
    cubes = np.argwhere((count > 0) & (count < 8))
    strides = np.array([shape[1] * shape[2], shape[2], 1])
    nodes = (cubes @ strides)[:, None] + corner @ strides  # [C, 8]
    pairs = _crossed(nodes, inside.ravel()[nodes])
    if not len(pairs):
        return np.zeros((0, 3)), np.zeros((0, 3), np.int64)
    keys, place = np.unique(pairs[:, 0] * int(shape.prod()) + pairs[:, 1], return_inverse=True)
    low, high = keys // int(shape.prod()), keys % int(shape.prod())
    a, b = field.ravel()[low].astype(np.float64), field.ravel()[high].astype(np.float64)
    share = (a / (a - b))[:, None]
    at = [np.stack(np.unravel_index(n, field.shape), axis=1).astype(np.float64) for n in (low, high)]
    return at[0] + share * (at[1] - at[0]), place.reshape(-1, 3)


def _crossed(nodes: Int, inside: NDArray[np.bool_]) -> Int:
    """`[3 F, 2]`: for the three corners of every triangle the nodes, lower first, between which it lies."""
    found = []
    for order in itertools.permutations((4, 2, 1)):
        tetrahedron = np.cumsum([0, *order])  # from corner 0 along the axes in this order to corner 7
        turned = _odd(order)
        kind = inside[:, tetrahedron] @ np.array([1, 2, 4, 8])
        for mask, triangles in _CASES.items():
            rows = nodes[kind == mask][:, tetrahedron]
            for triangle in triangles:
                ends = rows[:, np.array(triangle[::-1] if turned else triangle)]  # [R, 3, 2]
                found.append(np.sort(ends, axis=2).reshape(-1, 6))
    return np.concatenate(found).reshape(-1, 2)


def _odd(order: tuple[int, ...]) -> bool:
    """Whether the tetrahedron along these axes is left-handed: 4, 2, 1 are the axes x, y, z."""
    return bool(np.linalg.det(np.eye(3)[[(4, 2, 1).index(axis) for axis in order]]) < 0)


def _cases() -> dict[int, list[tuple[tuple[int, int], ...]]]:
    """For each set of inside corners of a right-handed tetrahedron its triangles, as the edges they cross."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]], dtype=np.float64)
    cases: dict[int, list[tuple[tuple[int, int], ...]]] = {}
    for mask in range(1, 15):
        within = [i for i in range(4) if mask >> i & 1]
        beyond = [i for i in range(4) if not mask >> i & 1]
        edges = [(i, j) for i in within for j in beyond]
        if len(edges) == 3:
            polygons = [edges]
        else:  # two inside: the edges around the quadrilateral
            (a, b), (c, d) = within, beyond
            polygons = [[(a, c), (a, d), (b, d)], [(a, c), (b, d), (b, c)]]
        outward = corners[beyond].mean(axis=0) - corners[within].mean(axis=0)
        cases[mask] = []
        for polygon in polygons:
            p, q, r = ((corners[i] + corners[j]) / 2 for i, j in polygon)
            facing = float(np.cross(q - p, r - p) @ outward) > 0
            cases[mask].append(tuple(polygon if facing else polygon[::-1]))
    return cases


_CASES = _cases()
