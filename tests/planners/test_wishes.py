"""Wishes for a room: what is read as one, and that what was wished holds afterwards, without harm to anything else."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from same_plan import same

from scenewright.gaussians.world.box import overlap
from scenewright.planners.plan import EditPlan
from scenewright.planners.rooms.check import check
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.planners.rooms.node import Node
from scenewright.planners.wishes import WishPlanner
from scenewright.planners.wishes import goals as kinds
from scenewright.planners.wishes.move_order import ordered_moves
from scenewright.planners.wishes.parsing import NotAWish, WishParser
from scenewright.planners.wishes.rearrange import in_disc
from scenewright.planners.wishes.room import Room, move_carrying, toward
from scenewright.tools.ops.arrange import Arrange
from scenewright.tools.ops.insert import Insert
from scenewright.tools.ops.move import Move

HERE = Path(__file__).parent
CASES: list[dict[str, Any]] = [
    json.loads(line) for line in (HERE / "wishes.jsonl").read_text(encoding="utf-8").splitlines()
]
NAMES = {
    kinds.Clear: "clear", kinds.Walls: "walls", kinds.Tidy: "tidy", kinds.Declutter: "declutter",
    kinds.SetTable: "table", kinds.See: "see", kinds.Spread: "spread", kinds.ReadingCorner: "corner",
    kinds.Symmetric: "symmetric", kinds.Become: "become", kinds.Party: "party", kinds.PlainEdit: "add",
}  # fmt: skip
PLANNER, PARSER = WishPlanner(), WishParser()


class Seen:
    """A written graph to look at."""

    def __init__(self, graph: SceneGraph) -> None:
        self._graph = graph

    def graph(self) -> SceneGraph:
        return self._graph

    def picture(self) -> bytes | None:
        return None


def thing(id: int, label: str, at: Sequence[float], size: Sequence[float], yaw: float = 0.0, on: Any = "floor") -> Node:
    """A thing by its underside's middle."""
    x, y, low = (*at, 0.0)[:3]
    return Node(id=id, label=label, size=tuple(size), position=(x, y, low + size[2] / 2), yaw=yaw, support=on)


def hall(*nodes: Node) -> SceneGraph:
    return SceneGraph.model_validate({"room": {"size": (6, 5, 2.7)}, "nodes": [n.model_dump() for n in nodes]})


CHAIR, TABLE = (0.5, 0.55, 0.9), (1.4, 0.8, 0.75)
ROOM = hall(
    thing(0, "sofa", (0, 1.9), (2.0, 0.9, 0.8)),
    thing(1, "coffee table", (0.2, 0.4), (1.0, 0.6, 0.4), 10),
    thing(2, "vase", (0.3, 0.4, 0.4), (0.15, 0.15, 0.3), on=1),
    thing(3, "television", (0, -2.2, 0.5), (1.1, 0.2, 0.7), 180, on=4),
    thing(4, "tv stand", (0, -2.2), (1.4, 0.4, 0.5), 180),
    thing(5, "armchair", (-1.8, 0.3), (0.8, 0.8, 0.9), 90),
    thing(6, "potted plant", (2.6, 2.0), (0.5, 0.5, 1.1)),
    thing(7, "potted plant", (2.0, 2.1), (0.5, 0.5, 1.1)),
    thing(8, "bookshelf", (-2.8, -1.0), (1.0, 0.35, 1.9), 90),
    thing(9, "mug", (1.2, -0.9), (0.1, 0.08, 0.1)),
    thing(10, "rug", (0, 0.4), (2.2, 1.6, 0.02)),
    thing(11, "door", (2.97, -1.5), (0.9, 0.08, 2.1), -90, on="wall"),
)  # fmt: skip
DINING = hall(
    thing(0, "dining table", (0, 0), TABLE),
    *(thing(1 + i, "chair", (-2 + 1.2 * i, -1.8), CHAIR, 90.0 * i) for i in range(4)),
    thing(5, "bowl", (0.1, 0, 0.75), (0.2, 0.2, 0.1), on=0),
)


def plan(text: str, graph: SceneGraph = ROOM) -> EditPlan:
    return PLANNER.plan(text, observation=Seen(graph))


def played(plan: EditPlan, graph: SceneGraph) -> dict[Any, Node]:
    """Where things are after the moves of a plan; each step is checked: nothing stands in anything on the way."""
    room = Room.of(graph)
    known = {frozenset((n.id, m.id)) for n in room.nodes.values() for m in room.overlapping(n)}
    for op in plan.ops:
        if not isinstance(op, Arrange):
            continue
        (id,) = op.target.groups
        node = room.nodes[id]
        for one in move_carrying(node, [room.nodes[i] for i in room.carried_by(id)], node.position[0] + op.x,
                           node.position[1] + op.y, node.yaw + op.turn):  # fmt: skip
            room.nodes[one.id] = one
        met = {frozenset((id, n.id)) for n in room.overlapping(room.nodes[id], room.carried_by(id))}
        assert met <= known, (op, met)
    return room.nodes


def unharmed(before: SceneGraph, nodes: dict[Any, Node]) -> bool:
    """Whether the checker finds nothing that it did not find before, reachability aside."""
    after = before.model_copy(update={"nodes": tuple(nodes.values()), "relations": ()})
    old = {(v.kind, v.ids) for v in check(before).violations}
    return not [v for v in check(after).violations if v.kind != "reach" and (v.kind, v.ids) not in old]


def read(text: str) -> list[str]:
    try:
        found = PARSER.parse(text).goals
    except NotAWish:
        return []
    return [g.shape if isinstance(g, kinds.Formation) else NAMES[type(g)] for g in found]


@pytest.mark.parametrize("held", [False, True])
def test_written_wishes_are_read(held: bool) -> None:
    half = [c for c in CASES if hashlib.sha256(c["id"].encode()).digest()[0] % 2 == held]
    wrong = [c["id"] for c in half if read(c["text"]) != c["goals"]]
    assert len(CASES) >= 80 and len(half) >= 30
    # The half to look at is right; of the other, reported in totals, one in twenty may be missed.
    assert len(wrong) <= (len(half) // 20 if held else 0)


def test_what_is_no_wish_is_left_to_others() -> None:
    others = (
        "paint the sofa red", "delete the chair", "push the sofa to the wall", "what is in the room?", "",
        "clear my schedule", "set the table on fire", "make a red chair", "line the drawer with paper",
    )  # fmt: skip
    for text in others:
        assert not PLANNER.reads(text), text
        assert plan(text).verdict == "not_understood"


def test_a_wish_needs_the_scene_and_says_so() -> None:
    found = PLANNER.plan("clear some space in the middle")
    assert found.verdict == "not_understood" and "scene" in found.reason


def test_unknown_words_are_named() -> None:
    assert "frobnicate" in plan("tidy up and frobnicate the walls").unknown


def test_the_middle_is_free_and_the_furniture_at_the_walls() -> None:
    found = plan("rearrange the living room for a party: push the furniture to the walls, clear a dance floor in the "
                 "middle, hang streamers from the ceiling")  # fmt: skip
    assert found.ok, found.reason
    nodes = played(found, ROOM)
    assert unharmed(ROOM, nodes)
    assert not [n.label for n in nodes.values() if n.size[2] > 0.05 and n.bottom < 1.9 and in_disc(n, (0, 0, 1.0))]
    for node in nodes.values():
        if node.label in ("sofa", "coffee table", "armchair", "bookshelf", "tv stand", "potted plant"):
            corners = np.abs(node.box.corners()[:, :2]).max(axis=0)
            assert min(3 - corners[0], 2.5 - corners[1]) < 0.35, node.label
    assert [op.asset for op in found.ops if isinstance(op, Insert)] == ["streamer"]
    # What stands on a thing goes along, and nothing else is said to move.
    assert 2 not in {op.target.groups[0] for op in found.ops if isinstance(op, Arrange)}
    assert math.dist(nodes[2].position[:2], nodes[1].position[:2]) == pytest.approx(0.1, abs=1e-3)


def test_less_floor_moves_less() -> None:
    small = plan("leave a 1 metre wide free space in the middle")
    large = plan("leave a 2.4 metre wide free space in the middle")
    assert small.ok and large.ok and len(small.ops) <= len(large.ops)
    for found, radius in ((small, 0.5), (large, 1.2)):
        nodes = played(found, ROOM)
        assert not [n for n in nodes.values() if n.size[2] > 0.05 and n.bottom < 1.9 and in_disc(n, (0, 0, radius))]
        assert unharmed(ROOM, nodes)


def test_what_has_no_room_is_impossible_and_says_what_conflicts() -> None:
    found = plan("leave a 4.8 metre wide free space in the middle")
    assert found.verdict == "impossible" and not found.ops and "cannot all be" in found.reason


@pytest.mark.parametrize("text", ["arrange the chairs in a circle", "form a circle with the chairs"])
def test_chairs_in_a_circle_look_at_its_middle(text: str) -> None:
    found = plan(text, DINING)
    assert found.ok, found.reason
    nodes = played(found, DINING)
    chairs = [nodes[i] for i in range(1, 5)]
    middle = np.mean([n.position[:2] for n in chairs], axis=0)
    reach = [math.dist(n.position[:2], middle) for n in chairs]
    assert max(reach) - min(reach) < 1e-3
    for chair in chairs:
        assert abs(math.remainder(toward(chair, (middle[0], middle[1])) - chair.yaw, 360)) < 1
    assert unharmed(DINING, nodes)


def test_chairs_in_a_row_stand_in_one_line() -> None:
    nodes = played(plan("line up the chairs", DINING), DINING)
    chairs = [nodes[i] for i in range(1, 5)]
    assert len({round(n.yaw) for n in chairs}) == 1
    points = np.array([n.position[:2] for n in chairs])
    assert np.linalg.svd(points - points.mean(axis=0))[1][1] < 1e-3
    assert unharmed(DINING, nodes)


def test_chairs_go_around_the_table_and_it_is_set_for_them() -> None:
    nodes = played(plan("arrange the chairs around the table", DINING), DINING)
    for chair in (nodes[i] for i in range(1, 5)):
        gap = np.abs(nodes[0].box.local(np.array([chair.position]))[0, :2]) - np.array(TABLE[:2]) / 2
        assert max(gap) < 0.7
    assert unharmed(DINING, nodes)
    found = plan("set the table for four", DINING)
    plates = [op for op in found.ops if isinstance(op, Insert) and op.asset == "plate"]
    spots = [op.place.offset for op in plates if op.place is not None and op.place.offset is not None]
    assert len(spots) == 4 and all(abs(x) < 0.7 and abs(y) < 0.4 for x, y in spots)
    assert all(math.dist(a, b) > 0.3 for i, a in enumerate(spots) for b in spots[:i])
    assert plan("set the table for twenty", DINING).verdict == "impossible"


def test_tidying_straightens_and_picks_up() -> None:
    found = plan("tidy up")
    nodes = played(found, ROOM)
    assert all(abs(math.remainder(n.yaw, 90)) < 1 for n in nodes.values() if n.label == "coffee table")
    moved = [op for op in found.ops if isinstance(op, Move)]
    assert [op.target.groups for op in moved] == [(9,)]
    assert moved[0].place is not None and moved[0].place.relation == "on"
    assert unharmed(ROOM, nodes)


def test_everybody_sees_the_television_and_the_plants_are_apart() -> None:
    nodes = played(plan("move the seats so that everybody sees the tv"), ROOM)
    for seat in (nodes[0], nodes[5]):
        assert abs(math.remainder(toward(seat, nodes[3].position[:2]) - seat.yaw, 360)) <= 45
    nodes = played(plan("spread the plants out"), ROOM)
    assert math.dist(nodes[6].position[:2], nodes[7].position[:2]) > 2.5
    assert unharmed(ROOM, nodes)


def test_things_that_wait_for_each_other_are_set_aside() -> None:
    graph = hall(thing(0, "table", (-1.5, 0), TABLE), thing(1, "table", (1.5, 0), TABLE))
    start, goal = Room.of(graph), Room.of(graph)
    goal.move_to(0, 1.5, 0, 0)
    goal.move_to(1, -1.5, 0, 0)
    found = ordered_moves(start, goal)
    assert len(found) == 3
    nodes = played(EditPlan(instruction="swap", ops=tuple(found), planner="test"), graph)
    assert nodes[0].position[0] == pytest.approx(1.5, abs=1e-3)
    assert nodes[1].position[0] == pytest.approx(-1.5, abs=1e-3)
    assert overlap(nodes[0].box, nodes[1].box) == 0


def test_the_same_wish_gives_the_same_plan() -> None:
    assert same(plan("push everything to the walls"), plan("push everything to the walls"))
    assert plan("put the seats around the unicorn").verdict in ("absent", "not_understood")
