"""The surface of Gaussians as triangles: what views leave filled, its surface, brought to where the splats show it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components

from ..camera import Camera
from ..cloud import GaussianCloud
from ..errors import UserError
from .carving import Sight
from .decimating import decimate
from .tetrahedra import surface

F64 = NDArray[np.float64]
Int = NDArray[np.int64]

WIDTH = 0.75  # cells by which what is thin is thickened on each side, so that the grid does not lose it
THIN = 0.3  # of that width which what stays thin keeps
LEAST = 0.002  # of the largest piece's area, below which a piece is a floater
SMOOTHINGS = 3
TOLERANCE = 0.12  # cells, root mean square distance that fewer triangles may lie from the surface


@dataclass(frozen=True, eq=False)
class Shape:
    """Triangles.

    Attributes:
        vertices: `[V, 3]` float64, world, scene units.
        faces: `[F, 3]` int64, counter-clockwise seen from outside; every edge is in two faces.
    """

    vertices: F64
    faces: Int

    @property
    def normals(self) -> F64:
        """`[V, 3]` unit normals of the vertices, faces weighted by their area."""
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        of_face = np.cross(b - a, c - a)
        total = np.zeros_like(self.vertices)
        for k in range(3):
            for axis in range(3):
                total[:, axis] += np.bincount(self.faces[:, k], of_face[:, axis], len(total))
        return total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-300)

    @property
    def areas(self) -> F64:
        """`[F]`."""
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2

    def keep(self, rows: NDArray[np.bool_]) -> Shape:
        """Only the faces of `rows` `[F]`, and the vertices that they use."""
        used, place = np.unique(self.faces[rows], return_inverse=True)
        return Shape(self.vertices[used], place.reshape(-1, 3).astype(np.int64))


@dataclass(frozen=True)
class Grid:
    """`low` is the first node, `step` the side of a cell (scene units), `shape` the number of nodes."""

    low: F64
    step: float
    shape: tuple[int, int, int]


def shape_of(cloud: GaussianCloud, cameras: Sequence[Camera], grid: Grid, level: float, most: int | None) -> Shape:
    """The closed surface of what `cameras`, all of one size, see of a cloud.

    Args:
        level: share of the light that is left at the surface.
        most: faces at most; None: as many as keep the shape.

    Raises:
        UserError: nothing of it is opaque enough.
    """
    sight = Sight.of(cloud, cameras, level)
    reach = 2 * grid.step
    pixel = grid.step * _pixels_per_cell(cameras, grid)
    wide = sight.widened(WIDTH * pixel / grid.step)
    field = wide.free_on(grid.low, grid.step, grid.shape, reach) - WIDTH * grid.step
    for axis in range(3):  # what reaches the border is closed there
        ends = np.moveaxis(field, axis, 0)
        ends[0] = ends[-1] = reach
    nodes, faces = surface(field)
    if not len(faces):
        raise UserError(
            f"these Gaussians are too faint to have a surface: they hardly stop {1 - level:.0%} of the light anywhere"
        )
    shape = without_floaters(Shape(grid.low + nodes * grid.step, faces))
    shape = smoothed(settled(shape, sight, grid.step), SMOOTHINGS)
    vertices, faces = decimate(shape.vertices, shape.faces, most or len(faces), TOLERANCE * grid.step)
    return Shape(vertices, faces)


def _pixels_per_cell(cameras: Sequence[Camera], grid: Grid) -> float:
    middle = grid.low + grid.step * np.array(grid.shape) / 2
    return float(np.median([c.fx * grid.step / max(float(np.linalg.norm(c.position - middle)), 1e-9) for c in cameras]))


def settled(shape: Shape, sight: Sight, step: float) -> Shape:
    """The shape with every vertex moved inward to where filled space begins; what is thinner than a cell keeps a part
    of its width."""
    normals = shape.normals
    far = 2.2 * WIDTH * step
    share = sight.first_filled(shape.vertices, -far * normals, -1.0)
    thin = share < 0
    share[thin] = (1 - THIN) * WIDTH * step / far
    return Shape(shape.vertices - far * share[:, None] * normals, shape.faces)


def smoothed(shape: Shape, times: int) -> Shape:
    """The shape without ripples of the size of its triangles, not shrunk (Taubin 1995)."""
    mean, at = neighbours(shape), shape.vertices
    for _ in range(times):
        at = at + 0.5 * (mean @ at - at)
        at = at - 0.53 * (mean @ at - at)
    return Shape(at, shape.faces)


def without_floaters(shape: Shape) -> Shape:
    """The shape without pieces far smaller than the largest one."""
    count, piece = pieces(shape)
    area = np.bincount(piece[shape.faces[:, 0]], shape.areas, count)
    return shape.keep((area >= LEAST * area.max())[piece[shape.faces[:, 0]]])


def pieces(shape: Shape) -> tuple[int, Int]:
    """How many pieces do not touch, and the piece of each vertex `[V]`."""
    f, n = shape.faces, len(shape.vertices)
    ends = np.concatenate([f[:, :2], f[:, 1:]])
    joined: csr_matrix = coo_matrix((np.ones(len(ends), np.int8), (ends[:, 0], ends[:, 1])), shape=(n, n)).tocsr()
    count, piece = connected_components(joined, directed=False)
    return int(count), piece.astype(np.int64)


def neighbours(shape: Shape) -> csr_matrix:
    """`[V, V]`, rows sum to one: the mean over the vertices that share an edge."""
    f, n = shape.faces, len(shape.vertices)
    ends = np.concatenate([f[:, [0, 1]], f[:, [1, 2]], f[:, [2, 0]]])
    ends = np.concatenate([ends, ends[:, ::-1]])
    table = coo_matrix((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(n, n)).tocsr()
    table.data[:] = 1.0
    degree = np.maximum(np.asarray(table.sum(axis=1)).ravel(), 1.0)
    return csr_matrix(table.multiply(1.0 / degree[:, None]))


def sphere_cameras(center: F64, radius: float, count: int, size: int) -> list[Camera]:
    """Cameras all around a ball, evenly spread (Fibonacci), each showing all of it."""
    fov = 40.0
    distance = 1.03 * radius / math.sin(math.radians(fov / 2))
    found = []
    for i in range(count):
        z = 1 - 2 * (i + 0.5) / count
        turn = i * math.pi * (3 - math.sqrt(5))
        across = math.sqrt(1 - z * z)
        way = np.array([across * math.cos(turn), across * math.sin(turn), z])
        found.append(Camera.look_at(center + distance * way, center, (0, 0, 1), size, size, fov, f"around {i}"))
    return found
