"""The final boxes of a graph's things: resting on the floor or on their carrier, at a wall, or under the ceiling.

Position in plan and yaw are the graph's. Heights are measured on the carrier's Gaussians: a cup stands on the top of a
table, which may be lower than the top of the table's box.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...gaussians.assets.furnishing.layout import HANG
from ...gaussians.assets.modeling.make import Asset
from ...gaussians.world import kinds
from ...gaussians.world.box import YawBox
from ...gaussians.world.support import SHELL
from .node import Drawn, Node

Array = NDArray[np.float64]
NEAR_FLOOR = 0.1  # metres: what is said to stand on the floor and is lower than this does; higher things were meant so
AT_WALL = 0.15  # metres between a back and a wall from which it counts as fixed to it
FLUSH = 0.002  # metres before the wall's face, for what is let into it
_FACE_TOLERANCE = 0.02  # metres: cells within it belong to one face
_PAD = 0.03  # metres around a footprint: half a cell of a large table, so that a cup has some under it
_MIN_FACE_SHARE = 0.3  # of the cells of the fullest face under a footprint that another one must have to carry
_UPWARD = 0.7  # cosine to the vertical of what carries


@dataclass(frozen=True)
class Load:
    """A thing on a carrier, in the carrier's frame: middle of its footprint, size, yaw, and its wanted height."""

    x: float
    y: float
    w: float
    d: float
    yaw: float
    height: float


def loads(graph: Drawn) -> dict[int | str, list[Load]]:
    """The loads of each node that carries something, by its id."""
    nodes = {n.id: n for n in graph.nodes}
    found: dict[int | str, list[Load]] = {}
    for node in graph.nodes:
        if node.support in nodes:
            found.setdefault(node.support, []).append(_load(node, nodes[node.support]))
    return found


def _load(node: Node, lower: Node) -> Load:
    x, y = lower.yaw_box.local(*node.position[:2])
    return Load(x, y, node.size[0], node.size[1], node.yaw - lower.yaw, node.bottom - lower.bottom)


def level_error(asset: Asset, load: Load) -> float:
    """Distance between the face that would carry a load and the wanted height, metres, at most (or without one) 0.5."""
    level = face_under(asset, load)
    return 0.5 if level is None else min(abs(level - load.height), 0.5)


def face_under(asset: Asset, load: Load) -> float | None:
    """Height of the face of an asset under a footprint, in the asset's frame: of those that carry, the nearest to the
    wanted height. None where nothing is under it."""
    xyz, upward = _cells(asset)
    turn = math.radians(load.yaw)
    dx, dy = xyz[:, 0] - load.x, xyz[:, 1] - load.y
    across, along = dx * math.cos(turn) + dy * math.sin(turn), dy * math.cos(turn) - dx * math.sin(turn)
    under = (np.abs(across) < load.w / 2 + _PAD) & (np.abs(along) < load.d / 2 + _PAD)
    heights = np.sort(xyz[under & upward, 2])
    if not len(heights):
        return None
    # A face is what lies within a hand's breadth of cells below a cell: heights minus the first within reach.
    filled = np.arange(1, len(heights) + 1) - np.searchsorted(heights, heights - _FACE_TOLERANCE)
    carrying = heights[filled >= _MIN_FACE_SHARE * filled.max()]
    return float(carrying[np.argmin(np.abs(carrying - load.height))])


def _cells(asset: Asset) -> tuple[Array, NDArray[np.bool_]]:
    """Centres of an asset's Gaussians, and which of them face upwards; of splats that have no normals, all may."""
    samples = asset.unlit.samples
    if len(samples.xyz):
        return samples.xyz, (samples.normal[:, 2] > _UPWARD) | asset.unlit.two_sided
    means = asset.cloud.means.numpy().astype(np.float64)
    return means, np.ones(len(means), dtype=bool)


def rest_boxes(graph: Drawn, assets: Mapping[int | str, Asset]) -> dict[int | str, YawBox]:
    """Final box of each node that has an asset, by id."""
    nodes = {n.id: n for n in graph.nodes}
    boxes: dict[int | str, YawBox] = {}
    for node in _carriers_first(graph.nodes, nodes):
        if node.id in assets:
            boxes[node.id] = _box(node, assets[node.id], graph, nodes, boxes, assets)
    return boxes


def _carriers_first(nodes: Sequence[Node], by_id: Mapping[int | str, Node]) -> list[Node]:
    """Nodes with what they stand on before them; of a ring of nodes that stand on each other, in their own order."""
    done: dict[int | str, Node] = {}
    for node in nodes:
        chain = [node]
        while chain[-1].support in by_id and chain[-1].support not in done:
            lower = by_id[chain[-1].support]
            if lower in chain:
                break
            chain.append(lower)
        done.update({n.id: n for n in reversed(chain) if n.id not in done})
    return list(done.values())


def _box(
    node: Node,
    asset: Asset,
    graph: Drawn,
    nodes: Mapping[int | str, Node],
    boxes: Mapping[int | str, YawBox],
    assets: Mapping[int | str, Asset],
) -> YawBox:
    w, d, h = asset.size
    box = YawBox(node.position[0], node.position[1], node.bottom, w, d, h, node.yaw)
    if node.support == "floor":
        return box._replace(low=0.0) if node.bottom < NEAR_FLOOR else box
    if node.support == "ceiling":
        return box._replace(low=max(graph.room.size[2] - h, 0.0))
    if node.support == "wall":
        return _at_wall(box, graph, kinds.is_opening(node.label))
    if node.support in SHELL or node.support not in boxes:
        return box
    lower = boxes[node.support]
    level = face_under(assets[node.support], _load(node, nodes[node.support]))
    return box if level is None else box._replace(low=lower.low + level)


def _at_wall(box: YawBox, graph: Drawn, let_in: bool) -> YawBox:
    """Its back just before the wall that it is turned away from, if one is near; doors reach down to the floor."""
    width, depth, _ = graph.room.size
    back = box.axes[1]
    for normal, half in (((0.0, 1.0), depth), ((0.0, -1.0), depth), ((1.0, 0.0), width), ((-1.0, 0.0), width)):
        if float(back @ np.array(normal)) < math.cos(math.radians(10)):
            continue
        gap = half / 2 - (float(np.array([box.x, box.y]) @ np.array(normal)) + box.d / 2)
        if -box.d - AT_WALL < gap < AT_WALL:
            shift = gap - (FLUSH if let_in else HANG)
            box = box._replace(x=box.x + shift * normal[0], y=box.y + shift * normal[1])
    return box._replace(low=0.0) if let_in and box.low < NEAR_FLOOR else box
