"""A room of six things with known places, asked questions."""

from __future__ import annotations

from scenewright.planners.questions.answer import Answer
from scenewright.planners.questions.asking import answer
from scenewright.planners.questions.survey import Survey
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.planners.rooms.node import Node, RoomShape

WIDTH, DEPTH, HEIGHT = 5.0, 4.0, 2.5


def node(id: int, label: str, size: tuple[float, float, float], at: tuple[float, float], yaw: float = 0.0, *,
         low: float = 0.0, support: int | str = "floor", color: str = "") -> Node:  # fmt: skip
    return Node(id=id, label=label, color=color, size=size, position=(*at, low + size[2] / 2), yaw=yaw, support=support)


DOOR = node(1, "door", (0.9, 0.06, 2.0), (-1.5, -1.97), 180.0, support="wall")
BED = node(2, "bed", (1.6, 2.0, 0.6), (1.7, 0.9))
DESK = node(3, "desk", (1.4, 0.7, 0.75), (-1.6, 1.65))
RUG = node(4, "rug", (1.5, 1.0, 0.01), (-0.5, 0.0))
BIN = node(5, "bin", (0.25, 0.25, 0.3), (-1.4, -0.3))
WINDOW = node(6, "window", (1.2, 0.06, 1.2), (-1.6, 1.97), low=0.9, support="wall")
THINGS = (DOOR, BED, DESK, RUG, BIN, WINDOW)


def graph(*nodes: Node, size: tuple[float, float, float] = (WIDTH, DEPTH, HEIGHT)) -> SceneGraph:
    return SceneGraph(room=RoomShape(size=size), nodes=nodes or THINGS)


def turned(scene: SceneGraph) -> SceneGraph:
    """The room turned by a quarter turn, counter-clockwise from above."""
    width, depth, height = scene.room.size
    nodes = tuple(
        n.model_copy(update={"position": (-n.position[1], n.position[0], n.position[2]), "yaw": (n.yaw + 90) % 360})
        for n in scene.nodes
    )
    return SceneGraph(room=RoomShape(size=(depth, width, height)), nodes=nodes)


def said(question: str, scene: SceneGraph | None = None) -> Answer:
    return answer(question, Survey.of_graph(scene if scene is not None else graph()))
