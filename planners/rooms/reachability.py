"""Where a person can walk in a room of boxes: a flood fill over a grid of the floor.

It starts at the doors; without a door, the largest free part of the floor counts as reachable.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import scipy
from numpy.typing import NDArray

from ...gaussians.world import kinds
from ...gaussians.world.person import ARM, SHOULDERS, STEP
from .floor_grid import F64, MOST_CELLS, Flags, axes, clearance, window_of
from .graph import SceneGraph
from .node import Node


def unreached(graph: SceneGraph) -> Iterator[tuple[Node, float]]:
    """Blocked doors, and nodes on the floor that are not within arm's reach of a walkable cell.

    Each comes with its distance to the nearest such cell, infinite if there is none.
    """
    xs, ys = axes(graph.room, MOST_CELLS)
    half = SHOULDERS / 2 - 1e-9
    areas, _ = scipy.ndimage.label(clearance(graph, xs, ys, half) >= half, structure=np.ones((3, 3)))
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


def _largest(areas: NDArray[np.int32]) -> set[int]:
    """The largest area, by itself; none where there is none."""
    sizes = np.bincount(areas.ravel())
    sizes[0] = 0
    return {int(sizes.argmax())} if sizes.any() else set()


def _nearest(among: Flags, areas: NDArray[np.int32], node: Node, xs: F64, ys: F64) -> tuple[int, float]:
    """The area of the place nearest to a node's footprint, and its distance; 0 and infinity if there is no place."""
    everywhere = (slice(0, len(xs)), slice(0, len(ys)))
    for window in (window_of(node, xs, ys, SHOULDERS + ARM), everywhere):
        places = np.argwhere(among[window])
        if not len(places):
            continue
        distance = node.yaw_box.distance_to(xs[window[0]][places[:, 0]], ys[window[1]][places[:, 1]])
        best = int(distance.argmin())
        if distance[best] <= SHOULDERS + ARM or window is everywhere:
            return int(areas[window][tuple(places[best])]), float(distance[best])
    return 0, math.inf
