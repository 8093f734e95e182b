"""A room as something to be rearranged: what may move, what stays, what goes along; and where things are by now.

Knows a graph's nodes and which of them a person would push about. Refuses to know wishes, and to move what it does not
believe: a thing far larger or smaller than its name allows was probably named wrongly, and stays where it is.
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
SMALL = 0.4  # metres; what is smaller in every direction is a thing and no furniture
TOUCHING = 0.01  # metres that boxes may be in each other
_BUILDING = bag("column pillar wall railing fence tree")  # what stays and is no kind of thing


class CannotError(Exception):
    """A wish cannot come true; the message says why.

    Attributes:
        verdict: of the plan.
    """

    def __init__(self, reason: str, verdict: Literal["impossible", "absent", "ambiguous"] = "impossible") -> None:
        super().__init__(reason)
        self.verdict = verdict


@dataclass
class Room:
    """The graph while a wish is being worked out.

    Attributes:
        stage: the graph as it was, for finding what words mean.
        nodes: where everything is by now, by id.
        ops: operations that follow the moves: what is put on something, added or taken away.
        told: what was done, for the plan's reason.
    """

    stage: Stage
    nodes: dict[Id, Node]
    ops: list[EditOp] = field(default_factory=list)
    told: list[str] = field(default_factory=list)

    @classmethod
    def of(cls, graph: SceneGraph) -> Room:
        """A room as it stands."""
        return cls(Stage.of(graph), {n.id: n for n in graph.nodes})

    @property
    def graph(self) -> SceneGraph:
        """As it was."""
        return self.stage.graph

    @property
    def size(self) -> tuple[float, float, float]:
        return self.graph.room.size

    def after(self) -> SceneGraph:
        """As it is by now, without relations: moving things about may well end them."""
        return self.graph.model_copy(update={"nodes": tuple(self.nodes.values()), "relations": ()})

    def find(self, query: Query | None, several: bool = True) -> list[Node]:
        """What a phrase means; None means all furniture.

        Raises:
            CannotError: there is nothing of that kind, or it is not clear which is meant.
        """
        if query is None:
            return [n for n in self.nodes.values() if self.moves(n) and max(n.size) >= SMALL]
        if query.text in ("seat", "seating") and not query.relations:
            found = [n for n in self.nodes.values() if is_seat(n)]
            if found:
                return found
        if query.text == "furniture":
            return self.find(None)
        try:
            meant = self.stage.find(query)
        except UserError as error:
            raise CannotError(str(error)) from error
        if meant.verdict != "found" or (not several and len(meant.groups) > 1):
            verdict = "ambiguous" if meant.verdict != "absent" else "absent"
            raise CannotError(self.stage.told(meant.reason) or f"{query.describe()} is not here", verdict)  # type: ignore[arg-type]
        named = self.stage.names(meant.groups)
        return [self.nodes[i] for i in named if i in self.nodes]

    def one(self, query: Query) -> Node | None:
        """What a phrase means, if it is one thing; None for a wall, the floor or the ceiling."""
        found = self.find(query, several=query.pick not in ("one", "any"))
        return found[0] if found else None

    def moves(self, node: Node) -> bool:
        """Whether a person would push a thing about: it stands on the floor, is no part of the house, and is what it
        is called."""
        words, kind = node.label.lower().split(), kinds.of(node.label)
        if node.support != "floor" or node.is_stepped_on or not words:
            return False
        stays = words[-1] in _BUILDING if kind is None else kind.fixed
        return not stays and is_likely(node)

    def riders(self, id: Id) -> list[Id]:
        """Ids of what stands on a thing, and on that."""
        found, todo = list[Id](), [id]
        while todo:
            at = todo.pop()
            fresh = [n.id for n in self.nodes.values() if n.support == at and n.id not in found]
            found += fresh
            todo += fresh
        return found

    def put(self, id: Id, x: float, y: float, yaw: float) -> None:
        """Move a thing, with what stands on it."""
        moved = carried(self.nodes[id], [self.nodes[i] for i in self.riders(id)], x, y, yaw)
        self.nodes |= {n.id: n for n in moved}

    def taken(self, box: Node, but: Iterable[Id] = ()) -> list[Node]:
        """What a thing would stand in; rugs are stood upon."""
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
        """Whether a thing can stand somewhere."""
        node = self.nodes[id]
        there = node.model_copy(update={"position": (x, y, node.position[2]), "yaw": yaw})
        return self.inside(there) and not self.taken(there, (*but, *self.riders(id)))


def is_likely(node: Node) -> bool:
    """Whether a thing is about as large as things of its name are; what nobody knows the size of is."""
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


def carried(node: Node, riders: Sequence[Node], x: float, y: float, yaw: float) -> list[Node]:
    """A thing at another place, turned, and what stands on it where it then is."""
    turn = math.radians(yaw - node.yaw)
    c, s = math.cos(turn), math.sin(turn)
    moved = []
    for one in (node, *riders):
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


def copied(room: Room) -> Room:
    """The same room, to try something in."""
    return replace(room, nodes=dict(room.nodes), ops=list(room.ops), told=list(room.told))
