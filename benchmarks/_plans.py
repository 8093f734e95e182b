"""Draws the floor plans of layouts, seen from above, into one picture, with matplotlib (an extra)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..gaussians.world.person import STEP
from ..planners.rooms.graph import SceneGraph
from ..planners.rooms.node import Node

_COLORS = {"floor": "#d9c8a9", "wall": "#8fb0c9", "ceiling": "none", "carried": "#a9c99b"}


def draw(layouts: Sequence[tuple[str, SceneGraph]], path: Path, columns: int = 4) -> None:
    """Draw one plan for each layout; the thick side of a thing is its front."""
    from matplotlib.figure import Figure

    rows = -(-len(layouts) // columns)
    figure = Figure(figsize=(4.2 * columns, 4.2 * rows), dpi=90, layout="constrained")
    grid = np.atleast_1d(figure.subplots(rows, columns)).ravel()
    for axes, (title, graph) in zip(grid, layouts, strict=False):
        _plan(axes, graph)
        axes.set_title(title, fontsize=8)
    for axes in grid[len(layouts) :]:
        axes.axis("off")
    figure.savefig(path)


def _plan(axes: Any, graph: SceneGraph) -> None:
    width, depth, _ = graph.room.size
    axes.plot(*(np.array([[-1, 1, 1, -1, -1], [-1, -1, 1, 1, -1]]) * [[width / 2], [depth / 2]]), color="black")
    for node in sorted(graph.nodes, key=lambda n: n.bottom + (n.size[2] > STEP)):
        corners = node.box.corners()
        around = _outline(node)
        kind = node.support if node.support in _COLORS else "carried"
        axes.fill(*around.T, facecolor=_COLORS[str(kind)], edgecolor="0.3", linewidth=0.7, alpha=0.8)
        if node.size[2] > STEP and kind in ("floor", "wall"):
            axes.plot(*around[:2].T, color="#b03a2e", linewidth=2)
        axes.text(*corners.mean(axis=0)[:2], node.label, fontsize=5, ha="center", va="center")
    axes.set_aspect("equal")
    axes.axis("off")


def _outline(node: Node) -> np.ndarray[Any, np.dtype[np.float64]]:
    """`[4, 2]` corners of the footprint, the front side first."""
    turn = np.radians(node.yaw)
    along = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    half = np.array(node.size[:2]) / 2
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
    return np.array(node.position[:2]) + corners @ along
