"""Relations between the boxes of a finished room, with plain tolerances, for judging what a sentence says.

The geometry is apart from that of the solver and of the checker, which the judged rooms were made with. Lengths are
metres, angles degrees, frames those of the scene graph.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise, permutations

from ..gaussians.world import everyday, kinds
from ..gaussians.world.box import YawBox, plan_gap, to_world
from ..planners.rooms.graph import SceneGraph
from ..planners.rooms.node import Node

_NEAR = 0.8  # largest gap of things that are next to each other; larger for large things, see `_next_to`
_IN_CIRCLE = 1.8  # largest gap of things in a circle to what it is around
_AT_WALL, _IN_CORNER, _AT_WINDOW = 0.35, 0.5, 0.9  # largest gaps to a wall, to both walls of a corner, to a window
_FACES = 50.0  # largest angle between a front and what it faces
_SIDE = 60.0  # largest angle between a side and the direction to what stands there
_IN_LINE = 0.12  # largest offset of a thing from the line of its row


def _flat(node: Node) -> YawBox:
    return node.yaw_box


def _away(one: Node, other: Node) -> tuple[float, float]:
    return other.position[0] - one.position[0], other.position[1] - one.position[1]


def _degrees(a: tuple[float, float], b: tuple[float, float]) -> float:
    reach = math.hypot(*a) * math.hypot(*b)
    return math.degrees(math.acos(max(-1.0, min(1.0, (a[0] * b[0] + a[1] * b[1]) / reach)))) if reach > 1e-9 else 180.0


def _front(node: Node) -> tuple[float, float]:
    turn = math.radians(node.yaw)
    return math.sin(turn), -math.cos(turn)


def _gap(one: Node, other: Node) -> float:
    return float(plan_gap(_flat(one), _flat(other)))


def _next_to(one: Node, other: Node, graph: SceneGraph) -> bool:
    del graph
    reach = max(_NEAR, 0.3 * (max(one.size) + max(other.size)))
    apart = max(one.bottom - other.top, other.bottom - one.top, 0.0)
    return math.hypot(_gap(one, other), apart if apart > 1.2 else 0.0) <= reach


def _overlaps(one: Node, other: Node) -> bool:
    """Whether the middle of the smaller of two footprints is over the larger one."""
    small, large = sorted((one, other), key=lambda n: n.size[0] * n.size[1])
    u, v = large.yaw_box.local(*small.position[:2])
    return abs(u) <= large.size[0] / 2 + 0.02 and abs(v) <= large.size[1] / 2 + 0.02


def _on(one: Node, other: Node, graph: SceneGraph) -> bool:
    del graph
    stands = one.support == other.id or (_overlaps(one, other) and abs(one.bottom - other.top) <= 0.06)
    return stands or (other.is_stepped_on and _overlaps(one, other))


def _above(one: Node, other: Node, graph: SceneGraph) -> bool:
    del graph
    if _overlaps(one, other) and one.bottom + everyday.free_beneath(one.label, one.size[2]) >= other.top - 0.05:
        return True  # a parasol stands over a table
    near = _overlaps(one, other) or (one.support == "wall" and _gap(one, other) <= 0.3 and _within(one, other))
    return near and one.bottom >= other.top - 0.05


def _within(one: Node, other: Node) -> bool:
    """Whether the middle of one is within the width of the other, along the wall that it hangs on."""
    fx, fy = _front(one)
    dx, dy = _away(one, other)
    return abs(dx * -fy + dy * fx) <= max(other.size[:2]) / 2 + 0.05


def _under(one: Node, other: Node, graph: SceneGraph) -> bool:
    del graph
    return _overlaps(one, other) and one.bottom + one.top < other.bottom + other.top


def _facing(one: Node, other: Node, graph: SceneGraph) -> bool:
    """The front points at the nearest point of the other; of a desk, the side that its user looks over counts too."""
    del graph
    (fx, fy), toward = _front(one), _nearest(one, other)
    kind = kinds.of(one.label)
    sides = [(fx, fy), (-fx, -fy)] if kind is not None and kind.role == "desk" else [(fx, fy)]
    return min(_degrees(side, aim) for side in sides for aim in (toward, _away(one, other))) <= _FACES


def _nearest(one: Node, other: Node) -> tuple[float, float]:
    """The way from the middle of one to the nearest point of the other's footprint."""
    u, v = other.yaw_box.local(*one.position[:2])
    w, d = other.size[0] / 2, other.size[1] / 2
    x, y = to_world(other.position[0], other.position[1], other.yaw, max(-w, min(w, u)), max(-d, min(d, v)))
    return float(x) - one.position[0], float(y) - one.position[1]


def _around(one: Node, other: Node, graph: SceneGraph) -> bool:
    """Near it, or in a circle around it and turned to it."""
    reach = _IN_CIRCLE if _facing(one, other, graph) else max(_NEAR, 0.5 * max(other.size[:2]))
    return _gap(one, other) <= reach and not _on(one, other, graph)


def _toward(aim: tuple[float, float]) -> Callable[[Node, Node, SceneGraph], bool]:
    """Being at a side of the other thing, for a viewer who looks along +y; before and behind also as its own front
    says."""

    def holds(one: Node, other: Node, graph: SceneGraph) -> bool:
        del graph
        fx, fy = _front(other)
        own = (-aim[1] * fx, -aim[1] * fy) if aim[1] else aim
        x, y = _nearest(one, other)
        return min(_degrees(side, way) for side in (aim, own) for way in ((-x, -y), _away(other, one))) <= _SIDE

    return holds


def _far(one: Node, other: Node, graph: SceneGraph) -> bool:
    return math.hypot(*_away(one, other)) >= 0.4 * math.hypot(*graph.room.size[:2])


def _inside(one: Node, other: Node, graph: SceneGraph) -> bool:
    return _overlaps(one, other) and (one.bottom < other.top or _on(one, other, graph))


def _aligned(one: Node, other: Node, graph: SceneGraph) -> bool:
    del graph
    u, v = other.yaw_box.local(*one.position[:2])
    return min(abs(u), abs(v)) <= _IN_LINE


def between(one: Node, a: Node, b: Node) -> bool:
    sx, sy = _away(a, b)
    dx, dy = _away(a, one)
    length = math.hypot(sx, sy)
    along, aside = (dx * sx + dy * sy) / length**2, abs(dx * sy - dy * sx) / length
    return 0.05 < along < 0.95 and aside <= max(0.45 * length, max(one.size[:2]) / 2)


def _walls(node: Node, graph: SceneGraph) -> tuple[float, float, float, float]:
    """Gaps to the walls at left, right, front and back."""
    hx, hy = node.yaw_box.half
    w, d, _ = graph.room.size
    x, y = node.position[:2]
    return x - hx + w / 2, w / 2 - x - hx, y - hy + d / 2, d / 2 - y - hy


def _against_wall(node: Node, graph: SceneGraph) -> bool:
    kind = kinds.of(node.label)
    return min(_walls(node, graph)) <= _AT_WALL + (kind.aisle if kind else 0.0)


def _in_corner(node: Node, graph: SceneGraph) -> bool:
    left, right, front, back = _walls(node, graph)
    return min(left, right) <= _IN_CORNER and min(front, back) <= _IN_CORNER


def _in_center(node: Node, graph: SceneGraph) -> bool:
    return all(abs(c) <= side / 5 for c, side in zip(node.position[:2], graph.room.size[:2], strict=True))


def _at_window(node: Node, graph: SceneGraph) -> bool:
    return any(_gap(node, w) <= _AT_WINDOW for w in graph.nodes if kinds.of(w.label) is kinds.find("window"))


def _lines(nodes: Sequence[Node]) -> int:
    """Number of parallel lines that the middles of the nodes stand in, along the axis that needs fewer."""

    def along(axis: int) -> int:
        found = sorted(n.position[axis] for n in nodes)
        return 1 + sum(b - a > _IN_LINE for a, b in pairwise(found))

    return min(along(0), along(1))


def _row(nodes: Sequence[Node]) -> bool:
    return _lines(nodes) == 1 or _one_line(nodes)


def _one_line(nodes: Sequence[Node]) -> bool:
    """Whether the middles of all nodes are on one straight line of any direction."""
    if len(nodes) < 3:
        return True
    a, b = max(permutations(nodes, 2), key=lambda p: math.hypot(*_away(*p)))
    sx, sy = _away(a, b)
    length = math.hypot(sx, sy)
    return all(abs(_away(a, n)[0] * sy - _away(a, n)[1] * sx) / length <= _IN_LINE for n in nodes)


def _rows(nodes: Sequence[Node]) -> bool:
    """Several straight lines with at least two things in each."""
    return 2 <= _lines(nodes) <= len(nodes) // 2


def _circle(nodes: Sequence[Node]) -> bool:
    """All middles are equally far from the middle of all, within a fifth, and all around it."""
    x, y = (sum(n.position[k] for n in nodes) / len(nodes) for k in (0, 1))
    away = [math.hypot(n.position[0] - x, n.position[1] - y) for n in nodes]
    angles = sorted(math.degrees(math.atan2(n.position[1] - y, n.position[0] - x)) for n in nodes)
    widest = max(b - a for a, b in zip(angles, [*angles[1:], angles[0] + 360], strict=True))
    return max(away) <= 1.25 * min(away) and widest <= 1.6 * 360 / len(nodes)


GROUPS: dict[str, Callable[[Sequence[Node]], bool]] = {
    "in_row": _row, "in_a_row": _row, "in_line": _row, "in_rows": _rows, "in_columns": _rows, "in_grid": _rows,
    "in_circle": _circle, "in_a_circle": _circle,
}  # fmt: skip
ROOM: dict[str, Callable[[Node, SceneGraph], bool]] = {
    "against_wall": _against_wall, "on_wall": _against_wall, "in_corner": _in_corner, "in_center": _in_center,
    "in_middle": _in_center, "at_window": _at_window,
}  # fmt: skip
PAIRS: dict[str, Callable[[Node, Node, SceneGraph], bool]] = {
    "on": _on, "under": _under, "below": _under, "above": _above, "over": _above, "inside": _inside, "in": _inside,
    "next_to": _next_to, "near": _next_to, "beside": _next_to, "facing": _facing, "around": _around,
    "left_of": _toward((-1.0, 0.0)), "right_of": _toward((1.0, 0.0)), "behind": _toward((0.0, 1.0)),
    "in_front_of": _toward((0.0, -1.0)), "far_from": _far, "aligned_with": _aligned, "against": _next_to,
}  # fmt: skip
NAMES = {*GROUPS, *ROOM, *PAIRS, "between"}
