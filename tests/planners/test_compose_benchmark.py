"""The benchmark of composed rooms: what it counts as said, on rooms built by hand."""

from __future__ import annotations

from typing import Any

import pytest

from scenewright.benchmarks import _composed, compose
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.planners.rooms.node import Node, RoomShape

ROOM = RoomShape(size=(6.0, 5.0, 2.6))


def node(id: int, label: str, x: float, y: float, **more: Any) -> Node:
    size = more.pop("size", (0.5, 0.5, 0.8))
    low = more.pop("low", 0.0)
    return Node(id=id, label=label, size=size, position=(x, y, low + size[2] / 2), **more)


def judged(nodes: list[Node], **case: Any) -> _composed.Judged:
    return _composed.judge(SceneGraph(room=ROOM, nodes=tuple(nodes)), {"text": "", **case})


def thing(name: str, count: int, **more: Any) -> dict[str, Any]:
    return {"name": [name], "count": count, **more}


def test_a_thing_counts_only_in_the_number_said() -> None:
    chairs = [node(1, "chair", 0, 0), node(2, "chair", 1, 0)]
    assert judged(chairs, things=[thing("chair", 2)]).things == {"2 chair": True}
    assert judged(chairs, things=[thing("chair", 3)]).things == {"3 chair": False}
    assert judged(chairs, things=[thing("chair", 1)]).things == {"1 chair": False}
    assert judged(chairs, things=[thing("chair", 1, more=True)]).things == {"1 chair": True}


def test_another_word_for_the_same_kind_counts_and_another_kind_does_not() -> None:
    assert judged([node(1, "sofa", 0, 0)], things=[thing("couch", 1)]).things == {"1 couch": True}
    assert judged([node(1, "sofa", 0, 0)], things=[thing("bench", 1)]).things == {"1 bench": False}


def test_what_was_asked_for_is_never_odd_and_an_unasked_block_is() -> None:
    found = judged([node(1, "bed", 0, 0), node(2, "end", 2, 0)], things=[thing("bed", 1)], odd=["bed", "stove"])
    assert found.odd == (0, 2) and found.strange == ("end",)
    assert judged([node(1, "double bed", 0, 0)], odd=["bed"]).odd == (1, 1)


@pytest.mark.parametrize(
    ("said", "nodes", "holds"),
    [
        ("cup on table", [node(1, "table", 0, 0), node(2, "mug", 0, 0, low=0.8, support=1)], True),
        ("cup on table", [node(1, "table", 0, 0), node(2, "mug", 2, 0)], False),
        ("chair facing table", [node(1, "chair", 0, 1), node(2, "table", 0, -1)], True),
        ("chair facing table", [node(1, "chair", 0, 1, yaw=180), node(2, "table", 0, -1)], False),
        ("chair against_wall", [node(1, "chair", 0, 2.2)], True),
        ("chair against_wall", [node(1, "chair", 0, 0)], False),
        ("chair in_corner", [node(1, "chair", 2.7, 2.2)], True),
        ("chair left_of table", [node(1, "chair", -2, 0), node(2, "table", 0, 0)], True),
        ("chair left_of table", [node(1, "chair", 2, 0), node(2, "table", 0, 0, yaw=0)], False),
        ("lamp between chair", [node(1, "chair", -1, 0), node(2, "chair", 1, 0), node(3, "floor lamp", 0, 0)], True),
        ("lamp between chair", [node(1, "chair", -1, 0), node(2, "chair", 1, 0), node(3, "floor lamp", 2, 0)], False),
        ("chair in_row", [node(k, "chair", k, 0.5 * k) for k in range(4)], True),
        ("chair in_rows", [node(k, "chair", k % 3, k // 3) for k in range(6)], True),
        ("chair in_rows", [node(k, "chair", 0.9 * k, 0.37 * k * k) for k in range(6)], False),
        ("chair in_circle", [node(1, "chair", 1, 0), node(2, "chair", 0, 1), node(3, "chair", -1, 0),
                             node(4, "chair", 0, -1)], True),
    ],
)  # fmt: skip
def test_relations_between_boxes(said: str, nodes: list[Node], holds: bool) -> None:
    assert judged(nodes, relations=[[said]]).relations == {said: holds}


def test_each_gets_its_own_where_there_are_as_many() -> None:
    desks = [node(1, "desk", -1, 0), node(2, "desk", 1, 0)]
    both = [node(3, "monitor", -1, 0, low=0.8, support=1), node(4, "monitor", -0.8, 0, low=0.8, support=1)]
    own = [both[0], node(4, "monitor", 1, 0, low=0.8, support=2)]
    assert not judged([*desks, *both], relations=[["monitor on desk"]]).relations["monitor on desk"]
    assert judged([*desks, *own], relations=[["monitor on desk"]]).relations["monitor on desk"]


def test_a_refused_sentence_has_nothing_as_said() -> None:
    case = {"text": "", "things": [thing("chair", 1)], "relations": [["chair against_wall"]]}
    found = _composed.judge(None, case)
    assert not any(found.things.values()) and not any(found.relations.values())


def test_a_written_room_is_composed_as_said() -> None:
    case = next(c for c in compose.cases(compose.FOLDER / "rooms.jsonl") if c["text"].startswith("pizzeria"))
    made = compose.made(case)
    assert made.judged.faults == [] and not made.refused and not made.wrong


@pytest.mark.slow
@pytest.mark.parametrize("name", ["rooms.jsonl", "rooms_of_forms.jsonl"])
def test_most_of_what_the_written_sentences_name_is_there(name: str) -> None:
    """The committed sets are regression sets; the least shares leave room for two sentences of 30."""
    found = [compose.made(case) for case in compose.cases(compose.FOLDER / name)]
    values = {m.key: m.value for m in compose.metrics("x", found)}
    assert values["x.things.as_said"] >= 0.97 and values["x.relations.as_said"] >= 0.95
    assert values["x.collision"] == values["x.bounds"] == values["x.support"] == 0
