"""Sentences about parts of things ("the wardrobe door", "the dresser drawers") in rooms with and without them."""

from __future__ import annotations

import pytest

from scenewright.agent.session.session import Session
from scenewright.benchmarks._motion import rooms
from scenewright.gaussians.errors import AbsentError
from scenewright.planners.rooms.build import construct
from scenewright.planners.rooms.graph import SceneGraph

DETAIL = 0.3


@pytest.fixture(scope="module")
def living() -> Session:
    """A room with a door, a wardrobe and a dresser in one piece each."""
    nodes = [
        {"id": 0, "label": "door", "size": (0.9, 0.08, 2.0), "position": (-1.2, 1.96, 1.0), "support": "wall"},
        {"id": 1, "label": "wardrobe", "size": (1.2, 0.6, 2.0), "position": (0.2, 1.65, 1.0)},
        {"id": 2, "label": "dresser", "size": (0.9, 0.5, 0.75), "position": (1.4, 1.7, 0.375)},
        {"id": 3, "label": "chair", "size": (0.45, 0.5, 0.9), "position": (-0.5, -0.8, 0.45)},
    ]
    graph = SceneGraph.model_validate({"room": {"size": (4.5, 4.0, 2.6)}, "nodes": nodes})
    return Session(construct(graph, seed=3, detail=DETAIL).scene)


@pytest.fixture(scope="module")
def bedroom() -> Session:
    """A room with a dresser that has three drawers, and with a wardrobe."""
    return Session(rooms.moving_room("drawer", DETAIL))


def labels(session: Session, said: str) -> list[str]:
    field = session.scene.language
    assert field is not None
    return [field.groups[i].label for i in session.select(said).groups]


@pytest.mark.parametrize(
    "text",
    [
        "delete the wardrobe door", "paint the cabinet door red", "open the wardrobe door at 1 s",
        "open the fridge door at 1 s", "open the dresser drawer at 1 s", "remove the door of the wardrobe",
        "paint the wardrobe's door blue", "delete both oven doors", "hide the dresser doors", "open the car door",
        "paint the washing machine door white", "delete the toy car's wheels",
    ],
)  # fmt: skip
def test_what_has_no_such_part_is_not_changed(living: Session, text: str) -> None:
    before = living.scene
    with pytest.raises(AbsentError):
        living.do(text)
    assert living.scene is before


@pytest.mark.parametrize("text", ["open the front door at 1 s", "paint the bathroom door red"])
def test_the_door_of_a_place_is_the_door(living: Session, text: str) -> None:
    assert living.do(text).receipts
    living.undo()


@pytest.mark.parametrize("said", ["the kitchen door", "the front door", "the garage door", "the wooden door"])
def test_a_place_or_a_material_before_a_door_tells_of_no_thing(living: Session, said: str) -> None:
    assert labels(living, said) == ["door"]


@pytest.mark.parametrize(
    ("question", "answer"),
    [
        ("is there a fridge door?", "no"), ("is there a wardrobe door?", "no"), ("is there a dresser drawer?", "no"),
        ("is there a door?", "yes"), ("is there a bathroom door?", "yes"), ("how many wardrobe doors are there?", 0),
        ("how many doors are there?", 1), ("what color is the oven door?", None), ("how tall is the car door?", None),
    ],
)  # fmt: skip
def test_questions_about_parts(living: Session, question: str, answer: object) -> None:
    assert living.ask(question).answer == answer


@pytest.mark.parametrize(
    ("said", "count"),
    [
        ("the dresser drawers", 3), ("the drawers of the dresser", 3), ("the dresser's drawers", 3),
        ("the top dresser drawer", 1), ("the bottom drawer of the dresser", 1), ("the middle drawer", 1),
        ("the wardrobe drawer", 0), ("the drawers of the wardrobe", 0), ("the bed's drawer", 0),
        ("the nightstand drawer", 0), ("the desk drawers", 0),
    ],
)  # fmt: skip
def test_drawers_of_one_thing(bedroom: Session, said: str, count: int) -> None:
    assert labels(bedroom, said) == ["drawer"] * count


@pytest.mark.parametrize(
    ("question", "answer"),
    [
        ("how many dresser drawers are there?", 3), ("is there a wardrobe drawer?", "no"),
        ("does the top dresser drawer open?", "yes"), ("is there a desk drawer?", "no"),
    ],
)  # fmt: skip
def test_questions_about_drawers(bedroom: Session, question: str, answer: object) -> None:
    assert bedroom.ask(question).answer == answer


def test_legs_of_chairs_are_told_by_shape(living: Session) -> None:
    legs = living.select("the chair legs")
    assert legs.chosen and 0 < len(legs) < len(living.select("the chair"))
    assert living.select("the wardrobe door").verdict == "absent"


def test_a_part_need_not_look_like_a_whole_thing(living: Session) -> None:
    assert living.do("make the dresser top white").receipts[0].checks
    living.undo()
