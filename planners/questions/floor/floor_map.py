"""`FloorMap`: the floor of a room as cells, with the clearance of each, from which questions about floor are answered.

World frame: z up, metres, the origin at the centre of the floor. A person is a disc; the width of a passage is known to
half a cell.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Self

import numpy as np
import scipy
from numpy.typing import NDArray

from ....gaussians.world import kinds
from ....gaussians.world.person import ARM, SHOULDERS, STEP
from ...rooms.floor_grid import F64, Flags, axes, clearance, is_obstacle, window_of
from ...rooms.graph import SceneGraph
from ...rooms.node import Node

Cells = NDArray[np.intp]  # `[M, 2]` rows along x and y

GROUNDED = 0.15  # metres: a thing whose underside is lower covers the floor beneath it
_MOST = 240  # most cells along a side, so that answers are immediate in halls as well
_REACH = 1.2  # metres: clearances beyond are estimates
_FINE = 0.02  # metres, side of the cells by which covered floor is measured
_MOST_FINE = 700
_ALL_AROUND = np.ones((3, 3))


@dataclass(frozen=True, eq=False)
class FloorMap:
    """The floor of a room as cells.

    Attributes:
        graph: whose floor it is.
        xs, ys: middles of the cells along x and y, metres.
        cell: their side, metres.
        clear: `[X, Y]` metres from the middle of each cell to the nearest wall or obstacle.
    """

    graph: SceneGraph
    xs: F64
    ys: F64
    cell: float
    clear: F64
    _areas: dict[float, NDArray[np.int32]] = field(default_factory=dict)
    _beside: dict[tuple[int | str, float], Cells] = field(default_factory=dict)

    @classmethod
    def of(cls, graph: SceneGraph) -> Self:
        """The floor of a graph's room."""
        xs, ys = axes(graph.room, _MOST)
        cell = float(xs[1] - xs[0]) if len(xs) > 1 else float(ys[1] - ys[0]) if len(ys) > 1 else 0.05
        near = clearance(graph, xs, ys, _REACH)
        beyond = scipy.ndimage.distance_transform_edt(np.pad(near >= _REACH, 1)) * cell
        return cls(graph, xs, ys, cell, near + np.maximum(beyond[1:-1, 1:-1] - cell / 2, 0.0))

    # -- walking ----------------------------------------------------------------------------------------------------

    def walkable(self, width: float = SHOULDERS) -> Flags:
        """`[X, Y]` cells on which a disc of this width touches nothing; right to half a cell in width."""
        return self.clear >= width / 2 - self.cell / 4 - 1e-6

    def areas(self, width: float = SHOULDERS) -> NDArray[np.int32]:
        """`[X, Y]` number of the connected walkable area of each cell, 0 where one cannot stand."""
        key = round(width, 4)
        if key not in self._areas:
            self._areas[key] = scipy.ndimage.label(self.walkable(width), structure=_ALL_AROUND)[0]
        return self._areas[key]

    def entered(self, width: float = SHOULDERS) -> set[int]:
        """Areas into which the doors open; without a door that can be reached, the largest one."""
        areas = self.areas(width)
        found = {int(areas[tuple(cells[0])]) for door in self.doors if len(cells := self.beside(door, width, True))}
        if found:
            return found
        sizes = np.bincount(areas.ravel())
        sizes[0] = 0
        return {int(sizes.argmax())} if sizes.any() else set()

    def beside(self, node: Node, width: float = SHOULDERS, door: bool = False) -> Cells:
        """Cells from which a disc is at a thing, the nearest first; none if there is no such cell.

        A person is within arm's reach, or next to the thing where that is possible. A wider disc covers a place where a
        person would be.
        """
        key = (node.id, round(width, 4))
        if key not in self._beside:
            self._beside[key] = self._cells_beside(node, width, door)
        return self._beside[key]

    def _cells_beside(self, node: Node, width: float, door: bool) -> Cells:
        if width > SHOULDERS + self.cell / 2:
            person = self.beside(node, SHOULDERS, door)
            away = np.ones(self.clear.shape, dtype=bool)
            away[tuple(person.T)] = False
            if away.all():
                return person
            gap = scipy.ndimage.distance_transform_edt(away) * self.cell
            cells = np.argwhere((gap <= width / 2) & self.walkable(width))
            return np.asarray(cells[np.argsort(gap[tuple(cells.T)], kind="stable")])
        box = self.base(node).yaw_box
        arm = (SHOULDERS if door else width / 2) + ARM
        x, y = window_of(self.base(node), self.xs, self.ys, arm)
        gap = box.distance_to(self.xs[x][:, None], self.ys[y][None, :])
        near = np.argwhere((gap <= arm + 1e-6) & self.walkable(width)[x, y])
        if not len(near):
            return near
        gaps = gap[tuple(near.T)]
        close = gaps <= max(width / 2 + 0.1, float(gaps.min()) + self.cell) + 1e-6
        order = np.argsort(gaps[close], kind="stable")
        return np.asarray(near[close][order] + (x.start, y.start))

    def base(self, node: Node) -> Node:
        """The thing on the floor that a node stands on, itself if it stands on none."""
        seen = {node.id}
        while isinstance(node.support, int) or node.support not in ("floor", "wall", "ceiling"):
            below = self._nodes.get(node.support)
            if below is None or below.id in seen or below.is_stepped_on:
                break
            seen.add(below.id)
            node = below
        return node

    def cell_at(self, x: float, y: float, width: float = SHOULDERS) -> Cells:
        """`[1, 2]` the walkable cell nearest to a point; none if nobody can stand anywhere."""
        cells = np.argwhere(self.walkable(width))
        if not len(cells):
            return cells
        off = np.hypot(self.xs[cells[:, 0]] - x, self.ys[cells[:, 1]] - y)
        return np.asarray(cells[int(off.argmin())][None])

    def point(self, cell: Iterable[int]) -> tuple[float, float]:
        """The middle of a cell, metres."""
        i, j = cell
        return float(self.xs[i]), float(self.ys[j])

    @cached_property
    def doors(self) -> tuple[Node, ...]:
        """The doors of the room."""
        return tuple(n for n in self.graph.nodes if kinds.is_door(n.label))

    @cached_property
    def _nodes(self) -> dict[int | str, Node]:
        return {n.id: n for n in self.graph.nodes}

    def nearest_obstacles(self, x: float, y: float) -> list[tuple[float, Node]]:
        """Obstacles by their distance from a point, the nearest first."""
        found = [(float(n.yaw_box.distance_to(x, y)), n) for n in self.graph.nodes if is_obstacle(n)]
        return sorted(found, key=lambda f: f[0])

    # -- free floor -------------------------------------------------------------------------------------------------

    @cached_property
    def area(self) -> float:
        """Square metres of floor."""
        width, depth, _ = self.graph.room.size
        return width * depth

    @cached_property
    def covered(self) -> float:
        """Square metres of floor on which things stand; rugs and openings do not count."""
        width, depth, _ = self.graph.room.size
        cell = max(_FINE, max(width, depth) / _MOST_FINE)
        xs, ys = (_middles(side, cell) for side in (width, depth))
        taken = np.zeros((len(xs), len(ys)), dtype=bool)
        for node in filter(covers_floor, self.graph.nodes):
            x, y = window_of(node, xs, ys, 0.0)
            u, v = node.yaw_box.local(xs[x][:, None], ys[y][None, :])
            taken[x, y] |= (np.abs(u) <= node.size[0] / 2) & (np.abs(v) <= node.size[1] / 2)
        return float(taken.mean()) * self.area

    @property
    def free(self) -> float:
        """Square metres of floor on which nothing stands."""
        return self.area - self.covered

    def most_open(self) -> tuple[float, float, float]:
        """The middle (x, y) and the radius of the largest disc of floor without obstacles, metres."""
        i, j = np.unravel_index(int(self.clear.argmax()), self.clear.shape)
        return float(self.xs[i]), float(self.ys[j]), float(self.clear[i, j])


def _middles(side: float, cell: float) -> F64:
    """Middles of the cells of about this size that divide a side of the room."""
    n = max(round(side / cell), 1)
    return np.asarray((np.arange(n) + 0.5) * (side / n) - side / 2, dtype=np.float64)


def covers_floor(node: Node) -> bool:
    """Whether a thing takes floor away: it stands there, is no rug and no opening in a wall."""
    return node.bottom <= GROUNDED and node.top > STEP and not kinds.is_opening(node.label)
