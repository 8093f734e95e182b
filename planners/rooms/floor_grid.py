"""A grid over the floor of a room, and how far its cells are from walls and from things that people walk around."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...gaussians.world.person import HEADROOM, STEP
from .graph import SceneGraph
from .node import Node, RoomShape

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

CELL = 0.05  # metres, side of a cell and precision of the width of a passage
MOST_CELLS = 1200  # most cells along a side; larger halls have larger cells


def axes(room: RoomShape, most: int) -> tuple[F64, F64]:
    """Middles of at most `most` cells along x, and along y, symmetric about the room's centre."""
    width, depth, _ = room.size
    cell = max(CELL, max(width, depth) / most)
    counts = (max(int(side / cell), 1) for side in (width, depth))
    x, y = ((np.arange(n, dtype=np.float64) - (n - 1) / 2) * cell for n in counts)
    return x, y


def window_of(node: Node, xs: F64, ys: F64, margin: float) -> tuple[slice, slice]:
    """The cells whose middles may lie within `margin` of a node's footprint."""
    reach = math.hypot(*node.size[:2]) / 2 + margin
    x, y = (
        slice(*np.searchsorted(cells, (middle - reach, middle + reach)).tolist())
        for cells, middle in ((xs, node.position[0]), (ys, node.position[1]))
    )
    return x, y


def is_obstacle(node: Node) -> bool:
    """Whether people walk around a thing, not over or under it."""
    return node.top > STEP and node.bottom < HEADROOM


def clearance(graph: SceneGraph, xs: F64, ys: F64, reach: float) -> F64:
    """`[X, Y]` metres from the middle of each cell to the nearest wall or obstacle; at most `reach`, 0 within one."""
    width, depth, _ = graph.room.size
    aside = (np.maximum(side / 2 - np.abs(cells), 0.0) for cells, side in ((xs, width), (ys, depth)))
    x_gap, y_gap = aside
    free: F64 = np.minimum(np.minimum(x_gap[:, None], y_gap[None, :]), reach)
    for node in graph.nodes:
        if is_obstacle(node):
            x, y = window_of(node, xs, ys, reach)
            free[x, y] = np.minimum(free[x, y], node.yaw_box.distance_to(xs[x][:, None], ys[y][None, :]))
    return free
