"""Shortest ways over a floor as a few straight legs, and the narrowest place between two things.

Dijkstra's algorithm on the walkable cells finds the way (16 neighbours); then each leg is drawn to the farthest cell
that is in a straight walkable line from its start (string pulling).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy
from numpy.typing import NDArray

from ....gaussians.world import kinds
from ....gaussians.world.person import SHOULDERS, WALKWAY
from ...rooms.floor_grid import F64, Flags
from ...rooms.node import Node
from .floor_map import Cells, FloorMap

Point2 = tuple[float, float]
End = Callable[[float], Cells]  # the cells where a way for a disc of some width begins or ends
_STEPS = ((1, 0), (0, 1), (1, 1), (1, -1), (2, 1), (1, 2), (2, -1), (1, -2))
_DETOUR = 1.15  # a comfortably wide way is taken if it is at most this much longer than the shortest
_CROSSING = 30.0  # cost of a metre through obstacles, so that as few as possible are crossed
_WIDEST = 3.0  # metres: passages are not told apart beyond


@dataclass(frozen=True)
class Route:
    """A way over the floor.

    Attributes:
        points: where its straight legs begin and end, metres.
        width: of the widest disc that could take exactly this way, metres.
    """

    points: tuple[Point2, ...]
    width: float

    @property
    def length(self) -> float:
        """Metres."""
        return sum(math.dist(a, b) for a, b in pairwise(self.points))


def to_node(floor: FloorMap, node: Node) -> End:
    """The end of a way that leads up to a thing."""
    return lambda width: floor.beside(node, width, kinds.is_door(node.label))


def to_point(floor: FloorMap, x: float, y: float) -> End:
    """The end of a way that leads to a place, or as near to it as one can stand."""
    return lambda width: floor.cell_at(x, y, width)


def route(floor: FloorMap, start: End, goal: End, width: float = SHOULDERS) -> Route | None:
    """The shortest way for a disc of `width`, None if there is none.

    A way that is comfortably wide is preferred if it is hardly longer.
    """
    found = _shortest(floor, start(width), goal(width), width)
    if found is None or width >= WALKWAY:
        return found
    wide = _shortest(floor, start(width), goal(width), WALKWAY)
    return wide if wide is not None and wide.length <= _DETOUR * found.length else found


def is_open(floor: FloorMap, start: End, goal: End, width: float = SHOULDERS) -> bool:
    """Whether there is a way for a disc of `width`."""
    return _connected(floor, start(width), goal(width), width)


def passage(floor: FloorMap, start: End, goal: End) -> float:
    """Width in metres of the widest disc for which there is a way, 0 if there is none."""
    step = floor.cell / 2  # the same widths are tried each time, so that their areas are found once
    low, high = 0, int(min(_WIDEST, 2 * float(floor.clear.max(initial=0.0))) / step)
    if is_open(floor, start, goal, high * step):
        return high * step
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if is_open(floor, start, goal, middle * step) else (low, middle)
    return low * step


def in_the_way(floor: FloorMap, start: End, goal: End, width: float = SHOULDERS) -> list[Node]:
    """The fewest obstacles, in order, that a disc of `width` would have to cross from one end to the other."""
    inside = np.ones(floor.clear.shape, dtype=bool)
    number = np.arange(inside.size).reshape(inside.shape)
    first, last = (_or_all(floor, end(width), end(0.0)) for end in (start, goal))
    if not len(first) or not len(last):
        return []
    cost = np.where(floor.walkable(width), 1.0, _CROSSING)
    path = _path(floor, inside, number, cost, first, last)
    if path is None:
        return []
    points = [floor.point(c) for c in path if not floor.walkable(width)[tuple(c)]]
    found: dict[int | str, Node] = {}
    for x, y in points:
        near = floor.nearest_obstacles(x, y)
        if near and near[0][0] <= width / 2:
            found.setdefault(near[0][1].id, near[0][1])
    return list(found.values())


def _or_all(floor: FloorMap, cells: Cells, instead: Cells) -> Cells:
    return cells if len(cells) else instead


def _connected(floor: FloorMap, start: Cells, goal: Cells, width: float) -> bool:
    if not len(start) or not len(goal):
        return False
    areas = floor.areas(width)
    here, there = set(areas[tuple(start.T)].tolist()), set(areas[tuple(goal.T)].tolist())
    return bool((here & there) - {0})


def _shortest(floor: FloorMap, start: Cells, goal: Cells, width: float) -> Route | None:
    free = floor.walkable(width)
    if not _connected(floor, start, goal, width):
        return None
    number = np.full(free.shape, -1, dtype=np.int64)
    number[free] = np.arange(int(free.sum()))
    path = _path(floor, free, number, np.ones(free.shape), start, goal)
    if path is None:
        return None
    legs = _pulled(floor, path, width)
    return Route(tuple(floor.point(c) for c in legs), 2 * _least(floor, legs))


def _path(
    floor: FloorMap, free: Flags, number: NDArray[np.int64], cost: F64, start: Cells, goal: Cells
) -> Cells | None:
    """`[M, 2]` the cells of the cheapest path, None if there is none; `cost` is that of a metre in each cell."""
    links = _links(floor, free, number, cost)
    start, goal = (cells[free[tuple(cells.T)]] for cells in (start, goal))
    costs, before, _ = scipy.sparse.csgraph.dijkstra(
        links, directed=False, indices=number[tuple(start.T)], min_only=True, return_predecessors=True
    )
    ends = number[tuple(goal.T)]
    at = int(ends[int(costs[ends].argmin())])
    if not np.isfinite(costs[at]):
        return None
    path = [at]
    while before[path[-1]] >= 0:
        path.append(int(before[path[-1]]))
    return np.asarray(np.argwhere(free)[path[::-1]])


def _links(floor: FloorMap, free: Flags, number: NDArray[np.int64], cost: F64) -> scipy.sparse.csr_matrix:
    """Lengths between neighbouring cells; each link once."""
    rows, columns, lengths = [], [], []
    n, m = free.shape
    for dx, dy in _STEPS:
        here = (slice(0, n - dx), slice(max(0, -dy), m - max(0, dy)))
        there = (slice(dx, n), slice(max(0, dy), m - max(0, -dy)))
        both = free[here] & free[there]
        rows.append(number[here][both])
        columns.append(number[there][both])
        lengths.append(floor.cell * math.hypot(dx, dy) * (cost[here][both] + cost[there][both]) / 2)
    count = int(free.sum())
    data = (np.concatenate(lengths), (np.concatenate(rows), np.concatenate(columns)))
    return scipy.sparse.csr_matrix(data, shape=(count, count))


def _pulled(floor: FloorMap, cells: Cells, width: float) -> list[tuple[int, int]]:
    """The cells where the legs of a path begin and end."""
    path = [(int(i), int(j)) for i, j in cells]
    kept, at = [path[0]], 0
    while at < len(path) - 1:
        low, high = at + 1, len(path) - 1
        if _seen(floor, path[at], path[high], width):
            at = high
        else:
            while high - low > 1:
                middle = (low + high) // 2
                low, high = (middle, high) if _seen(floor, path[at], path[middle], width) else (low, middle)
            at = low
        kept.append(path[at])
    return kept


def _along(floor: FloorMap, a: tuple[int, int], b: tuple[int, int]) -> NDArray[np.float64]:
    """Clearances of the cells on the straight line from one cell to another."""
    steps = 2 * max(abs(a[0] - b[0]), abs(a[1] - b[1])) + 1
    x, y = (np.rint(np.linspace(p, q, steps)).astype(np.intp) for p, q in zip(a, b, strict=True))
    return floor.clear[x, y]


def _seen(floor: FloorMap, a: tuple[int, int], b: tuple[int, int], width: float) -> bool:
    return bool((_along(floor, a, b) >= width / 2 - floor.cell / 4 - 1e-6).all())


def _least(floor: FloorMap, legs: list[tuple[int, int]]) -> float:
    """The least clearance on a path."""
    return float(np.concatenate([_along(floor, a, b) for a, b in pairwise(legs)] or [floor.clear[legs[0]][None]]).min())
