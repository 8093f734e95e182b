"""The scene graph: strict, closed, the same both ways, and right about rooms whose layout is known."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.world.box import Box
from scenewright.planners.rooms.check import check
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.planners.rooms.node import Node, RoomShape


def cloud() -> GaussianCloud:
    return GaussianCloud(
        means=torch.zeros(1, 3),
        quats=torch.tensor([[1.0, 0.0, 0.0, 0.0]]),
        scales=torch.full((1, 3), 0.1),
        opacities=torch.full((1,), 0.5),
        sh=torch.zeros(1, 1, 3),
        group=torch.zeros(1, dtype=torch.int32),
        ids=torch.zeros(1, dtype=torch.int64),
    )


def row(
    id: int, label: str, center: tuple[float, float, float], size: tuple[float, float, float], yaw: float = 0.0
) -> Group:
    c, s = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
    box = Box(center=center, axes=((c, s, 0.0), (-s, c, 0.0), (0.0, 0.0, 1.0)), size=size)
    level = "structure" if label == "floor" else "object"
    return Group(id, level, -1, label, 0.9, box, (53.0, 80.0, 67.0), 1, 3, 1.0)  # type: ignore[arg-type]


def scene(groups: list[Group], scale: float = 1.0, floor: float | None = 0.0) -> Scene:
    field = LanguageField(tuple(groups), np.zeros((len(groups), 4), dtype=np.float32), "test")
    frame = Frame(up=(0.0, 0.0, 1.0), floor=floor, metres_per_unit=scale, up_source="given", scale_source="given")
    return Scene(cloud(), frame, language=field)


ROOM = [
    row(0, "floor", (2.0, 3.0, -0.05), (4.0, 6.0, 0.1)),
    row(1, "table", (1.0, 2.0, 0.4), (1.2, 0.8, 0.8), yaw=30.0),
    row(2, "vase", (1.1, 2.0, 0.95), (0.2, 0.2, 0.3)),
    row(3, "chair", (2.5, 2.0, 0.45), (0.5, 0.5, 0.9)),
    row(4, "painting", (2.0, 5.9, 1.6), (0.8, 0.05, 0.6)),
]


def test_known_room() -> None:
    graph = SceneGraph.from_scene(scene(ROOM))
    assert [n.label for n in graph.nodes] == ["table", "vase", "chair", "painting"]
    assert {n.id: n.support for n in graph.nodes} == {1: "floor", 2: 1, 3: "floor", 4: "wall"}
    assert graph.relations == ((2, "on", 1),)
    table = graph.node(1)
    # The floor's centre (2, 3) is the origin; 1e-9 is double rounding.
    assert table.position == pytest.approx((-1.0, -1.0, 0.4), abs=1e-9)
    assert table.yaw == pytest.approx(30.0, abs=1e-9)
    assert table.color == "red"
    assert graph.room.size[:2] == pytest.approx((4.0, 6.0), abs=0.2)


def test_lengths_are_metres() -> None:
    half = SceneGraph.from_scene(scene(ROOM, scale=0.5))
    assert half.node(1).size == pytest.approx((0.6, 0.4, 0.4), abs=1e-9)
    assert half.node(1).support == "floor"
    assert half.node(2).support == 1


@given(st.floats(-math.pi, math.pi), st.floats(-5, 5), st.floats(-5, 5))
def test_support_does_not_depend_on_where_the_room_lies(turn: float, dx: float, dy: float) -> None:
    c, s = math.cos(turn), math.sin(turn)

    def moved(group: Group) -> Group:
        x, y, z = group.box.center
        (ax, ay, _), _, _ = group.box.axes
        yaw = math.degrees(math.atan2(ay, ax) + turn)
        return row(group.id, group.label, (c * x - s * y + dx, s * x + c * y + dy, z), group.box.size, yaw)

    there = SceneGraph.from_scene(scene([moved(g) for g in ROOM]))
    assert [n.support for n in there.nodes] == [n.support for n in SceneGraph.from_scene(scene(ROOM)).nodes]


def test_round_trip() -> None:
    graph = SceneGraph.from_scene(scene(ROOM))
    assert SceneGraph.model_validate_json(graph.model_dump_json()) == graph


def test_empty_room() -> None:
    assert SceneGraph.from_scene(scene([])).nodes == ()


def test_scene_without_language_is_refused() -> None:
    with pytest.raises(UserError, match="embed"):
        SceneGraph.from_scene(Scene(cloud()))


def test_unknown_node_is_refused() -> None:
    with pytest.raises(UserError, match="its ids are 1, 2, 3, 4"):
        SceneGraph.from_scene(scene(ROOM)).node(9)


NODE = Node(id=1, label="chair", size=(1, 1, 1), position=(0, 0, 0.5))


@pytest.mark.parametrize(
    ("nodes", "relations", "told"),
    [
        ((NODE, NODE), (), "same id"),
        ((NODE.model_copy(update={"support": 7}),), (), "no other node"),
        ((NODE.model_copy(update={"support": 1}),), (), "no other node"),
        ((NODE,), ((1, "on", 2),), "not there"),
    ],
)
def test_open_graph_is_refused(nodes: tuple[Node, ...], relations: tuple[tuple[int, str, int], ...], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        SceneGraph(room=RoomShape(size=(4, 4, 3)), nodes=nodes, relations=relations)


@pytest.mark.parametrize(
    "bad",
    [
        '{"room": {"size": [4, 4, 3]}, "nodes": [], "extra": 1}',
        '{"room": {"size": [4, -4, 3]}}',
        '{"room": {"size": [4, 4, NaN]}}',
        '{"room": {"size": [4]}}',
    ],
)
def test_strictness(bad: str) -> None:
    with pytest.raises(ValueError):
        SceneGraph.model_validate_json(bad)


@pytest.mark.parametrize("size", [[8, 6], [8, 6, 0]])
def test_a_room_without_a_height_is_outdoors_and_as_high_as_what_stands_in_it(size: list[float]) -> None:
    tree = {"id": 1, "label": "tree", "size": [1.5, 1.5, 3.2], "position": [0, 0, 1.6]}
    graph = SceneGraph.model_validate_json(json.dumps({"room": {"size": size}, "nodes": [tree]}))
    assert graph.room.outdoor and graph.room.size == (8.0, 6.0, 3.2)
    assert check(graph).ok and SceneGraph.model_validate_json(graph.model_dump_json()) == graph
