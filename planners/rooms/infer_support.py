"""What the things of a measured scene rest on, told from their boxes: each other, the floor, a wall, the ceiling.

Knows boxes, and the names of what belongs to walls. Refuses to know scenes: the graph asks.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from .graph import Node, Size, Support

# A thing stands on another if its underside is this near to the other's top, in shares of the smaller height,
# and at least this share of its footprint's centre lies over it.
_CONTACT = 0.12
_FIXED = 0.1  # metres between a wall and what hangs on it: brackets and frames
_WALL_FIXTURES = frozenset({"painting", "picture", "mirror", "window", "clock", "curtain", "poster", "door"})


def support_of(node: Node, nodes: Sequence[Node], room: Size) -> Support:
    """What a node rests on: the highest box whose top touches its underside, else floor, or the smallest box that its
    underside is in (a seat, a shelf), else ceiling or wall."""
    bottom = node.position[2] - node.size[2] / 2
    others = [n for n in nodes if n.id != node.id and n.support != node.id]
    below = [n for n in others if _carries(n, node, bottom)]
    if below:
        return max(below, key=lambda n: (n.position[2] + n.size[2] / 2, str(n.id))).id
    fixture = not _WALL_FIXTURES.isdisjoint(node.label.split()[-1:])
    if fixture and _at_wall(node, room):
        return "wall"
    if bottom <= max(0.05 * room[2], 0.1 * node.size[2]):
        return "floor"
    around = [
        n for n in others if n.support not in ("wall", "ceiling") and n.bottom < bottom < n.top and _over(n, node)
    ]
    if node.position[2] + node.size[2] / 2 >= 0.97 * room[2] and not fixture:
        return "ceiling"
    if around and not fixture:
        return min(around, key=lambda n: (math.prod(n.size), str(n.id))).id
    return "wall" if fixture or _at_wall(node, room) else "floor"


def _at_wall(node: Node, room: Size) -> bool:
    """Whether a node's box reaches to a wall."""
    reach = np.abs(node.box.corners()[:, :2]).max(axis=0)
    return bool((np.array(room[:2]) / 2 - reach).min() < _FIXED)


def _carries(lower: Node, upper: Node, bottom: float) -> bool:
    """Whether the top of `lower` touches the underside of `upper` below its centre."""
    top = lower.position[2] + lower.size[2] / 2
    gap = abs(bottom - top)
    if lower.position[2] >= upper.position[2] or gap > _CONTACT * max(min(lower.size[2], upper.size[2]), 0.05):
        return False
    return _over(lower, upper)


def _over(lower: Node, upper: Node) -> bool:
    """Whether the middle of `upper` lies over the footprint of `lower`."""
    turn = math.radians(lower.yaw)
    dx, dy = upper.position[0] - lower.position[0], upper.position[1] - lower.position[1]
    x, y = dx * math.cos(turn) + dy * math.sin(turn), dy * math.cos(turn) - dx * math.sin(turn)
    return abs(x) <= lower.size[0] / 2 and abs(y) <= lower.size[1] / 2
