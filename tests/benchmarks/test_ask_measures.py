"""Measures of `bench ask` other than the questions themselves: changed scenes, routing, and views."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from scenewright.benchmarks._ask import rooms, routing, stability, views, views_chart
from scenewright.benchmarks._ask.question import Question, judge
from scenewright.benchmarks._ask.truth import Table, bearing
from scenewright.benchmarks._ask.views import Shown
from scenewright.benchmarks.harness import Metric, Result
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.planners.rooms.node import Node, RoomShape

GRAPH = SceneGraph(
    room=RoomShape(size=(4.0, 4.0, 2.5)),
    nodes=(
        Node(id=1, label="sofa", color="blue", size=(2.0, 0.9, 0.8), position=(-0.8, 1.5, 0.4), yaw=10.0),
        Node(id=2, label="mug", color="red", size=(0.1, 0.1, 0.1), position=(1.0, 1.0, 0.8), support=3),
        Node(id=3, label="table", color="brown", size=(1.0, 1.0, 0.75), position=(1.0, 1.0, 0.375)),
        Node(id=4, label="mug", color="red", size=(0.1, 0.1, 0.1), position=(1.2, 1.0, 0.8), support=3),
    ),
)


@pytest.fixture
def table() -> Table:
    return rooms.table_of_graph(GRAPH, "by hand", 1)


def test_a_mirror_exchanges_left_and_right_and_nothing_else(table: Table) -> None:
    flipped = rooms.table_of_graph(stability.in_mirror(GRAPH), "mirrored", 1)
    for a, b in zip(table.things, flipped.things, strict=True):
        eye, ahead = np.array(table.eye), np.array(table.forward)
        right, far = bearing(a.xy, eye, ahead)
        assert bearing(b.xy, eye, ahead) == pytest.approx((-right, far))
        # Corners are mirrored too, so a turned thing is turned the other way.
        assert np.sort(b.corners[:, 0]) == pytest.approx(np.sort(-a.corners[:, 0]))
    assert stability.in_mirror(stability.in_mirror(GRAPH)) == GRAPH
    assert stability.swapped("is it on the left of it?") == "is it on the right of it?"
    assert stability.swapped("is it left or right of it?") == "is it left or right of it?"


def test_who_walks_half_round_a_room_sees_its_sides_exchanged(table: Table) -> None:
    seen, turned = stability.walked(GRAPH, table, 180.0)
    assert turned.right == pytest.approx(-table.right)
    assert seen.viewer is not None and seen.viewer.position[1] > 2.0
    right, ahead = bearing(np.array([1.0, 0.0]), np.array(turned.eye), np.array(turned.forward))
    assert (right, ahead) == pytest.approx((-1.0, 3.0))


def test_a_true_table_and_its_graph_say_the_same(table: Table) -> None:
    again = rooms.table_of_graph(rooms.graph_of_table(table), "by hand", 1)
    assert again.things == table.things and again.size == table.size
    viewer = rooms.graph_of_table(table).viewer
    assert viewer is not None and viewer.target[1] - viewer.position[1] == pytest.approx(1.0)


def test_answers_agree_as_lengths_and_lists_do() -> None:
    length = Question("", "size", "", "metres", (2.0,))
    assert stability.agrees(2.0, judge(length, 2.1, "")) and not stability.agrees(2.0, judge(length, 2.5, ""))
    assert stability.agrees(None, judge(length, None, "")) and not stability.agrees(2.0, judge(length, None, ""))
    assert stability.agrees(("mug",), judge(Question("", "on", "", "list", (("mug",),)), ("cup", "mug"), ""))


def test_every_kind_has_a_family() -> None:
    from scenewright.benchmarks._ask import generate

    families = {kind for kinds in stability.FAMILIES.values() for kind in kinds}
    renamed = {"lists": "list", "hazards": "hazard", "routes": "route"}
    assert {renamed.get(m.__name__, m.__name__) for m in generate.MAKERS} <= families


def test_routes_are_compared_with_all_that_are_accepted() -> None:
    case = {"question": "q", "route": "vlm", "also_ok": ["none"]}
    assert (
        routing.is_right(case, "vlm") and routing.is_right(case, "neither") and not routing.is_right(case, "geometry")
    )
    assert routing.is_right({"question": "q", "route": "geometry", "also_ok": None}, "geometry")
    assert routing.told({"situation": "I sit on the sofa", "question": "What is left?"}) == (
        "I sit on the sofa. What is left?"
    )


def test_a_plain_question_goes_to_geometry() -> None:
    assert routing.route("Is there a sofa in this room?") == "geometry"
    assert routing.route("Does the wallpaper look dated to you?") != "geometry"


def test_the_stand_in_knows_only_what_it_was_shown(table: Table) -> None:
    count = Question("by hand", "count", "", "number", (2.0,), about=(1, 3), names=(1, 3))
    on = Question("by hand", "on", "", "list", (("mug", "mug"),), about=(2, 1, 3), names=(2,))
    there = Question("by hand", "existence", "", "yesno", ("yes",), about=(1, 3), names=(1, 3))
    one, both = [Shown(frozenset({1, 2}))], [Shown(frozenset({1, 2})), Shown(frozenset({3}))]
    assert not views.is_right(count, one, table) and views.is_right(count, both, table)
    assert views.is_right(there, one, table) and not views.is_right(there, [], table)
    assert views.is_right(on, both, table) and not views.is_right(on, [Shown(frozenset({1, 3}))], table)


def test_the_chart_of_views_is_drawn_from_a_result(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    found = tuple(Metric(f"views.{way}.{n}", 0.5 + n / 20, "share") for way in views_chart.WAYS for n in (1, 3, 8))
    result = Result.from_json(Result("t", "share right", found, ()).to_json())
    assert views_chart.draw(result, tmp_path / "views.png").read_bytes()[:4] == b"\x89PNG"


def test_written_routes_are_read_line_by_line(tmp_path: Path) -> None:
    path = tmp_path / "routing.jsonl"
    case = {"set": "sqa3d", "situation": "", "question": "Is there a sofa here?", "human_answer": "yes"}
    path.write_text(json.dumps({**case, "route": "geometry", "also_ok": []}) + "\n", encoding="utf-8")
    assert [taken for _, taken in routing.checked(path)] == ["geometry"]
    assert routing.checked(tmp_path / "none.jsonl") == []
