"""Where a person can walk in a room of boxes: a flood fill over a grid of the floor.

It starts at the doors; without a door, the largest free part of the floor counts as reachable.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ...gaussians.world import kinds
from ...gaussians.world.person import ARM, HEADROOM, SHOULDERS, STEP
from .graph import SceneGraph
from .node import Node

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

CELL = 0.05  # metres, side of a cell and precision of the width of a passage
_MOST = 1200  # most cells along a side; larger halls have larger cells


def unreached(graph: SceneGraph) -> Iterator[tuple[Node, float]]:
    """Blocked doors, and nodes on the floor that are not within arm's reach of a walkable cell.

    Each comes with its distance to the nearest such cell, infinite if there is none.
    """
    xs, ys = _axes(graph)
    areas, _ = ndimage.label(_free(graph, xs, ys), structure=np.ones((3, 3)))
    entered = set[int]()
    for door in (n for n in graph.nodes if kinds.is_door(n.label)):
        area, distance = _nearest(areas > 0, areas, door, xs, ys)
        if distance > SHOULDERS + ARM:
            yield door, distance
        else:
            entered.add(area)
    walkable = np.isin(areas, sorted(entered or _largest(areas)))
    for node in graph.nodes:
        if node.support == "floor" and node.size[2] > STEP and not kinds.is_door(node.label):
            _, distance = _nearest(walkable, areas, node, xs, ys)
            if distance > SHOULDERS / 2 + ARM:
                yield node, distance


def _axes(graph: SceneGraph) -> tuple[F64, F64]:
    """Middles of the cells along x and y, symmetric about the room's centre."""
    width, depth, _ = graph.room.size
    cell = max(CELL, max(width, depth) / _MOST)
    counts = (max(int(side / cell), 1) for side in (width, depth))
    x, y = ((np.arange(n, dtype=np.float64) - (n - 1) / 2) * cell for n in counts)
    return x, y


def _largest(areas: NDArray[np.int32]) -> set[int]:
    """The largest area, by itself; none where there is none."""
    sizes = np.bincount(areas.ravel())
    sizes[0] = 0
    return {int(sizes.argmax())} if sizes.any() else set()


def _nearest(among: Flags, areas: NDArray[np.int32], node: Node, xs: F64, ys: F64) -> tuple[int, float]:
    """The area of the place nearest to a node's footprint, and its distance; 0 and infinity if there is no place."""
    everywhere = (slice(0, len(xs)), slice(0, len(ys)))
    for window in (_window(node, xs, ys, SHOULDERS + ARM), everywhere):
        places = np.argwhere(among[window])
        if not len(places):
            continue
        distance = node.yaw_box.distance_to(xs[window[0]][places[:, 0]], ys[window[1]][places[:, 1]])
        best = int(distance.argmin())
        if distance[best] <= SHOULDERS + ARM or window is everywhere:
            return int(areas[window][tuple(places[best])]), float(distance[best])
    return 0, math.inf


def _window(node: Node, xs: F64, ys: F64, margin: float) -> tuple[slice, slice]:
    """The cells whose middles may lie within `margin` of a node's footprint."""
    reach = math.hypot(*node.size[:2]) / 2 + margin
    x, y = (
        slice(*np.searchsorted(cells, (middle - reach, middle + reach)).tolist())
        for cells, middle in ((xs, node.position[0]), (ys, node.position[1]))
    )
    return x, y


def _free(graph: SceneGraph, xs: F64, ys: F64) -> Flags:
    """`[X, Y]` cells where a person can stand without touching a wall or a thing."""
    width, depth, _ = graph.room.size
    half = SHOULDERS / 2 - 1e-9
    free: Flags = (np.abs(xs) <= width / 2 - half)[:, None] & (np.abs(ys) <= depth / 2 - half)[None, :]
    for node in graph.nodes:
        if node.top > STEP and node.bottom < HEADROOM:
            x, y = _window(node, xs, ys, half)
            free[x, y] &= node.yaw_box.distance_to(xs[x][:, None], ys[y][None, :]) >= half
    return free
