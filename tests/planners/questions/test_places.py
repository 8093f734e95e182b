"""Distances, sides, relations and places in a small room whose coordinates are round numbers.

The sofa stands at the left wall and faces +x, the TV hangs opposite; the viewer looks along +y.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest

from scenewright.planners.questions.answer import Answer
from scenewright.planners.questions.asking import answer
from scenewright.planners.questions.survey import Survey
from scenewright.planners.rooms.graph import SceneGraph

Node = dict[str, Any]

NODES: list[Node] = [
    {"id": 1, "label": "sofa", "size": [2.0, 1.0, 0.8], "position": [-2.0, 0.0, 0.4], "yaw": 90.0},
    {"id": 2, "label": "coffee table", "size": [1.0, 0.6, 0.4], "position": [-0.5, 0.0, 0.2], "yaw": 90.0},
    {"id": 3, "label": "television", "size": [1.2, 0.1, 0.7], "position": [2.45, 0.0, 1.2], "yaw": -90.0,
     "support": "wall"},
    {"id": 4, "label": "floor lamp", "size": [0.4, 0.4, 1.6], "position": [-2.2, -1.6, 0.8]},
    {"id": 5, "label": "vase", "size": [0.2, 0.2, 0.3], "position": [-0.5, 0.2, 0.55], "support": 2},
    {"id": 6, "label": "rug", "size": [1.4, 2.0, 0.01], "position": [-0.5, 0.0, 0.005]},
    {"id": 7, "label": "door", "size": [0.9, 0.06, 2.0], "position": [1.5, -1.97, 1.0], "yaw": 180.0,
     "support": "wall"},
    {"id": 8, "label": "bookshelf", "size": [0.8, 0.4, 1.8], "position": [1.0, 1.8, 0.9]},
    {"id": 9, "label": "book", "size": [0.1, 0.2, 0.25], "position": [1.0, 1.8, 1.0], "support": 8},
]  # fmt: skip


def room(nodes: list[Node] = NODES, **more: Any) -> Survey:
    data = {"room": {"size": [5.0, 4.0, 2.5]}, "nodes": nodes, **more}
    return Survey.of_graph(SceneGraph.model_validate_json(json.dumps(data)))


def mirrored() -> Survey:
    """The room with left and right exchanged; a front turns with it."""

    def flip(node: Node) -> Node:
        x, y, z = node["position"]
        return {**node, "position": [-x, y, z], "yaw": -node.get("yaw", 0.0)}

    return room([flip(n) for n in NODES])


def from_behind() -> Survey:
    """The room seen from its back wall."""
    return room(viewer={"position": [0.0, 6.0, 1.5], "target": [0.0, 0.0, 1.5]})


@pytest.fixture(scope="module")
def survey() -> Survey:
    return room()


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("what is the gap between the sofa and the coffee table?", 0.7),  # -1.5 to -0.8
        ("how much space is there between the sofa and the coffee table", 0.7),
        ("how far is the coffee table from the sofa, centre to centre", 1.513),  # hypot(1.5, 0.2)
        ("how far is the floor lamp from the left wall", 0.1),
        ("what's the distance between the television and the floor?", 0.85),
        ("how many metres apart are the sofa and the coffee table", 1.513),
        ("how far is the rug from the sofa edge to edge", 0.3),
    ],
)  # fmt: skip
def test_lengths(survey: Survey, question: str, expected: float) -> None:
    found = answer(question, survey)
    assert found.answer_type == "metres"
    assert found.answer == pytest.approx(expected, abs=0.005)
    assert found.unit == "m"
    assert found.evidence.lines


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("is the vase within 1 m of the sofa?", "yes"),  # gap 0.9
        ("is the vase more than 1 m from the sofa?", "no"),
        ("is the coffee table closer to the sofa than to the television?", "yes"),
        ("is the coffee table farther from the sofa than the rug?", "yes"),
        ("which is closer to the sofa, the bookshelf or the rug?", "rug"),
        ("what is closest to the door?", "television"),
        ("what is the furthest thing from the sofa?", "television"),
        ("is the floor lamp the closest thing to the bookshelf?", "no"),
    ],
)  # fmt: skip
def test_distances_compared(survey: Survey, question: str, expected: str) -> None:
    assert answer(question, survey).answer == expected


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("If I sat on the sofa, would the floor lamp be on my right?", "yes"),
        ("would the bookshelf be on my right if I sat on the sofa?", "no"),
        ("sitting on the sofa facing the television, is the door to my left or my right?", "right"),
        ("I am sitting on the sofa. What is in front of me?", "coffee table"),
        ("If I come in through the door, is the sofa on my left?", "yes"),
        ("standing at the door looking in, which side is the bookshelf on?", "left"),
        ("with my back to the television, is the bookshelf on my right?", "yes"),
        ("I'm sitting on the sofa. At what clock position is the television?", "12 o'clock"),
        ("is the lamp to the sofa's right?", "yes"),
        ("is the floor lamp left of the bookshelf?", "yes"),
        ("is the floor lamp in front of the sofa?", "yes"),  # nearer to the viewer
        ("is the television to the left or to the right of the sofa?", "right"),
        ("which side of the room is the sofa on, left or right?", "left"),
        ("what does the television face?", "sofa"),
        ("what is to the left of the coffee table?", "sofa"),
        ("is the floor lamp on the sofa's own left or right side?", "right"),
        ("does the sofa have the coffee table before it or behind it, from its own point of view?", "in front"),
        ("is the television opposite the sofa?", "yes"),
        ("is the floor lamp opposite the sofa?", "no"),
        ("which is further left, the door or the bookshelf?", "bookshelf"),
        ("sitting on the sofa, can I see the television?", "yes"),
        ("You are sitting on the sofa. The door is on your right. What is in front of you?", "coffee table"),
        ("does the sofa face the television?", "yes"),
        ("is the sofa facing the bookshelf?", "yes"),  # 31 degrees off its front
        ("is the sofa facing the floor lamp?", "no"),
    ],
)  # fmt: skip
def test_sides(survey: Survey, question: str, expected: str) -> None:
    found = answer(question, survey)
    assert found.answer == expected, found.text


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("what is on the coffee table?", ("vase",)),
        ("what does the coffee table have on it", ("vase",)),
        ("what's in the bookshelf?", ("book",)),
        ("what is under the coffee table?", ("rug",)),
        ("is anything on the sofa?", "no"),
        ("is the vase on the coffee table?", "yes"),
        ("is the vase under the coffee table?", "no"),
        ("what is the vase standing on?", "coffee table"),
        ("what hangs on the right wall?", ("television",)),
        ("which wall is the television on?", "right wall"),
        ("what is between the sofa and the television?", ("coffee table",)),
        ("is the coffee table between the sofa and the television?", "yes"),
        ("where is the vase?", "on the coffee table"),
        ("is the vase on the sofa or on the coffee table?", "coffee table"),
        ("which corner is the floor lamp in?", "front left corner"),
        ("what is in the front left corner?", ("floor lamp",)),
        ("is anything on the left wall?", "no"),
        ("does the coffee table stand against a wall?", "no"),
        ("does the bookshelf stand against the back wall?", "yes"),
        ("are the sofa and the television next to each other?", "no"),
        ("what is the leftmost thing?", "floor lamp"),
    ],
)  # fmt: skip
def test_relations_and_places(survey: Survey, question: str, expected: object) -> None:
    found = answer(question, survey)
    assert found.answer == expected, found.text


SIDED = [
    "is the floor lamp left of the bookshelf?",
    "which side of the room is the sofa on, left or right?",
    "is the television right of the coffee table?",
]


@pytest.mark.parametrize("question", SIDED)
@pytest.mark.parametrize("other", [mirrored, from_behind])
def test_a_mirror_and_the_other_side_of_the_room_swap_left_and_right(
    survey: Survey, question: str, other: Callable[[], Survey]
) -> None:
    swapped = {"yes": "no", "left": "right", "right": "left"}
    before, after = answer(question, survey).answer, answer(question, other()).answer
    assert isinstance(before, str)
    assert after == swapped[before]


def test_own_sides_do_not_depend_on_the_viewer() -> None:
    for question in ("is the lamp to the sofa's right?", "if I sat on the sofa, would the floor lamp be on my right?"):
        assert answer(question, from_behind()).answer == "yes"
        assert answer(question, mirrored()).answer == "no"


def test_distance_is_symmetric_and_does_not_change_when_everything_moves(survey: Survey) -> None:
    def moved(node: Node) -> Node:
        x, y, z = node["position"]
        return {**node, "position": [x + 7.0, y - 3.0, z]}

    there = answer("how far is the sofa from the bookshelf?", survey)
    back = answer("how far is the bookshelf from the sofa?", survey)
    away = answer("how far is the sofa from the bookshelf?", room([moved(n) for n in NODES]))
    assert isinstance(there.answer, float)
    assert back.answer == pytest.approx(there.answer)
    assert away.answer == pytest.approx(there.answer)


def test_a_place_in_a_noun_phrase_picks_the_thing_there() -> None:
    chair = {"label": "chair", "size": [0.5, 0.5, 0.9]}
    left, right = {**chair, "id": 20, "position": [-2.2, 1.7, 0.45]}, {**chair, "id": 21, "position": [2.2, 1.7, 0.45]}
    two = room([*NODES, left, right])
    for corner, expected in (("left", 20), ("right", 21)):
        found = answer(f"how far is the chair in the back {corner} corner from the sofa?", two)
        assert expected in found.evidence.ids
        assert isinstance(found.answer, float)


def test_a_thing_without_a_front_has_no_left(survey: Survey) -> None:
    found: Answer = answer("what is on the vase's left?", survey)
    assert found.answer is None
    assert "front" in found.text


def test_candidates_that_differ_are_told() -> None:
    chair = {"label": "chair", "size": [0.5, 0.5, 0.9], "color": "red"}
    two = room(
        [*NODES, {**chair, "id": 20, "position": [0.0, 1.0, 0.45]}, {**chair, "id": 21, "position": [2.0, 1.0, 0.45]}]
    )
    found = answer("how far is the chair from the sofa?", two)
    assert found.answer is None
    assert "2.2" in found.text
    assert set(found.evidence.ids) >= {20, 21}
