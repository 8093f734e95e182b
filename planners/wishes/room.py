"""The state of a room while it is rearranged: where things are, which may move, what they carry, what fits where.

Things far larger or smaller than their kind allows do not move: their label is probably wrong.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from ...gaussians.errors import UserError
from ...gaussians.language.query.query import Query
from ...gaussians.world import kinds
from ...gaussians.world.box import overlap
from ...tools.operation import EditOp
from ..grammar.tagging.words import bag
from ..rooms.graph import SceneGraph
from ..rooms.graph_scene import Stage
from ..rooms.node import Node

Id = int | str
SMALL = 0.4  # metres; a thing that is smaller in every direction is not furniture
TOUCHING = 0.01  # metres by which boxes may overlap
_BUILDING = bag(
    "column pillar wall railing fence tree"
)  # fixed parts of buildings and gardens that are not in the table of kinds


class WishError(Exception):
    """A wish cannot be fulfilled; the message says why.

    Attributes:
        verdict: of the plan.
    """

    def __init__(self, reason: str, verdict: Literal["impossible", "absent", "ambiguous"] = "impossible") -> None:
        super().__init__(reason)
        self.verdict = verdict


@dataclass
class Room:
    """A scene graph while a wish is being planned.

    Attributes:
        stage: the original graph, in which queries are resolved.
        nodes: the nodes at their present places, by id.
        ops: operations that follow the moves: things put on others, added or removed.
        done: what was done, for the plan's reason.
    """

    stage: Stage
    nodes: dict[Id, Node]
    ops: list[EditOp] = field(default_factory=list)
    done: list[str] = field(default_factory=list)

    @classmethod
    def of(cls, graph: SceneGraph) -> Room:
        """The state of a graph before any change."""
        return cls(Stage.of(graph), {n.id: n for n in graph.nodes})

    @property
    def graph(self) -> SceneGraph:
        """The original graph."""
        return self.stage.graph

    @property
    def size(self) -> tuple[float, float, float]:
        return self.graph.room.size

    def after(self) -> SceneGraph:
        """The graph in its present state, without relations, because moves may break them."""
        return self.graph.model_copy(update={"nodes": tuple(self.nodes.values()), "relations": ()})

    def find(self, query: Query | None, several: bool = True) -> list[Node]:
        """The nodes that a query selects; None selects all movable furniture.

        Raises:
            WishError: there is nothing of that kind, or the query is ambiguous.
        """
        if query is None:
            return [n for n in self.nodes.values() if self.is_movable(n) and max(n.size) >= SMALL]
        if query.text in ("seat", "seating") and not query.relations:
            found = [n for n in self.nodes.values() if is_seat(n)]
            if found:
                return found
        if query.text == "furniture":
            return self.find(None)
        try:
            meant = self.stage.find(query)
        except UserError as error:
            raise WishError(str(error)) from error
        if meant.verdict != "found" or (not several and len(meant.groups) > 1):
            verdict = "ambiguous" if meant.verdict in ("found", "ambiguous") else "absent"
            raise WishError(self.stage.told(meant.reason) or f"{query.describe()} is not here", verdict)  # type: ignore[arg-type]
        return [self.nodes[i] for i in self.stage.names(meant.groups) if i in self.nodes]

    def one(self, query: Query) -> Node | None:
        """The first node that a query selects; None for a wall, the floor or the ceiling."""
        found = self.find(query, several=query.pick not in ("one", "any"))
        return found[0] if found else None

    def is_movable(self, node: Node) -> bool:
        """Whether a thing may be moved: it stands on the floor, is not fixed, and its size fits its label."""
        words, kind = node.label.lower().split(), kinds.of(node.label)
        if node.support != "floor" or node.is_stepped_on or not words:
            return False
        stays = words[-1] in _BUILDING if kind is None else kind.fixed
        return not stays and is_likely(node)

    def carried_by(self, id: Id) -> list[Id]:
        """Ids of everything that stands on a thing, directly or indirectly."""
        found, todo = list[Id](), [id]
        while todo:
            at = todo.pop()
            fresh = [n.id for n in self.nodes.values() if n.support == at and n.id not in found]
            found += fresh
            todo += fresh
        return found

    def move_to(self, id: Id, x: float, y: float, yaw: float) -> None:
        """Move a thing, with what stands on it."""
        moved = move_carrying(self.nodes[id], [self.nodes[i] for i in self.carried_by(id)], x, y, yaw)
        self.nodes |= {n.id: n for n in moved}

    def overlapping(self, box: Node, but: Iterable[Id] = ()) -> list[Node]:
        """The things that a box overlaps, except rugs, its support, what it carries, and the ids in `but`."""
        own, (x, y, _), reach = {box.id, *but}, box.position, math.hypot(*box.size[:2])
        around = (
            n
            for n in self.nodes.values()
            if math.hypot(n.position[0] - x, n.position[1] - y) < (reach + math.hypot(*n.size[:2])) / 2
            and n.id not in own
            and not n.is_stepped_on
        )
        return [n for n in around if n.support != box.id and n.id != box.support and overlap(n.box, box.box) > TOUCHING]

    def inside(self, node: Node) -> bool:
        """Whether a thing is within the walls."""
        corners = abs(node.box.corners()[:, :2]).max(axis=0)
        return bool(corners[0] <= self.size[0] / 2 + TOUCHING and corners[1] <= self.size[1] / 2 + TOUCHING)

    def fits(self, id: Id, x: float, y: float, yaw: float, but: Iterable[Id] = ()) -> bool:
        """Whether a thing can stand at a place: inside the walls and without overlaps."""
        node = self.nodes[id]
        there = node.model_copy(update={"position": (x, y, node.position[2]), "yaw": yaw})
        return self.inside(there) and not self.overlapping(there, (*but, *self.carried_by(id)))


def is_likely(node: Node) -> bool:
    """Whether a thing's size fits its label; True for labels without a known size."""
    kind = kinds.find(node.label)
    if kind is None:
        return True
    sizes = kinds.extent(kind.name)
    usual = [sorted(sizes[:2]), [sizes[2]]]
    measured = [sorted(node.size[:2]), [node.size[2]]]
    pairs = zip([*usual[0], *usual[1]], [*measured[0], *measured[1]], strict=True)
    return all(low <= size <= high for (low, high), size in pairs)


def is_seat(node: Node) -> bool:
    """Whether people sit on a thing."""
    kind = kinds.of(node.label)
    return kind is not None and kind.seats > 0


def move_carrying(node: Node, on_it: Sequence[Node], x: float, y: float, yaw: float) -> list[Node]:
    """A thing at another place and yaw (degrees), followed by the things on it, moved along."""
    turn = math.radians(yaw - node.yaw)
    c, s = math.cos(turn), math.sin(turn)
    moved = []
    for one in (node, *on_it):
        dx, dy = one.position[0] - node.position[0], one.position[1] - node.position[1]
        position = (x + c * dx - s * dy, y + s * dx + c * dy, one.position[2])
        moved.append(one.model_copy(update={"position": position, "yaw": wrapped(one.yaw + yaw - node.yaw)}))
    return moved


def wrapped(degrees: float) -> float:
    """The same angle in (-180, 180]."""
    turned = math.remainder(degrees, 360.0)
    return 180.0 if turned <= -180.0 else turned


def toward(node: Node | tuple[float, float], goal: tuple[float, float]) -> float:
    """The yaw at which a thing's front (-y) looks at a point."""
    x, y = node if isinstance(node, tuple) else node.position[:2]
    return wrapped(math.degrees(math.atan2(goal[0] - x, y - goal[1])))


def copy_of(room: Room) -> Room:
    """A copy of a state, for trying something."""
    return replace(room, nodes=dict(room.nodes), ops=list(room.ops), done=list(room.done))
