"""Ways in which people ask that were once misread: exceptions, sums, places told twice, picks by distance."""

from __future__ import annotations

import json
from typing import Any

import pytest

from scenewright.gaussians.language.query.query import Query
from scenewright.planners.questions.answer import Answer
from scenewright.planners.questions.asking import answer
from scenewright.planners.questions.survey import Found, Survey
from scenewright.planners.questions.telling import absent
from scenewright.planners.rooms.graph import SceneGraph


def _node(id: int, label: str, color: str, size: tuple[float, ...], at: tuple[float, ...], on: Any = "floor") -> dict:
    return {"id": id, "label": label, "color": color, "size": size, "position": at, "support": on}


ROOM = {
    "room": {"size": [6.0, 4.0, 2.5]},
    "nodes": [
        _node(1, "desk", "brown", (1.4, 0.7, 0.75), (-2.2, 1.6, 0.375)),
        _node(2, "desk", "brown", (1.4, 0.7, 0.75), (2.2, 1.6, 0.375)),
        _node(3, "chair", "white", (0.5, 0.5, 0.9), (-2.2, 0.9, 0.45)),
        _node(4, "chair", "white", (0.5, 0.5, 0.9), (2.2, 0.9, 0.45)),
        _node(5, "laptop", "black", (0.3, 0.2, 0.2), (-2.4, 1.6, 0.85), 1),
        _node(6, "mug", "blue", (0.1, 0.1, 0.1), (-2.0, 1.6, 0.8), 1),
        _node(7, "bin", "gray", (0.25, 0.25, 0.3), (-2.2, 1.6, 0.15)),
        _node(8, "guitar", "red", (0.4, 0.2, 1.0), (-2.8, -0.5, 0.5)),
        _node(9, "coffee table", "black", (1.0, 0.6, 0.4), (1.0, -1.0, 0.2)),
        _node(10, "bookshelf", "white", (1.0, 0.3, 1.9), (0.0, 1.85, 0.95)),
        _node(11, "printer", "white", (0.4, 0.35, 0.25), (1.0, -1.0, 0.525), 9),
        _node(12, "door", "white", (0.9, 0.06, 2.0), (-2.97, 0.5, 1.0), "wall"),
    ],
}


@pytest.fixture(scope="module")
def survey() -> Survey:
    return Survey.of_graph(SceneGraph.model_validate_json(json.dumps(ROOM)))


def _value(given: Answer) -> Any:
    return list(given.answer) if isinstance(given.answer, tuple) else given.answer


@pytest.mark.parametrize(
    ("asked", "value"),
    [
        # An exception is one from what is there, not from where it is.
        ("what is on the left desk besides the laptop?", ["mug"]),
        ("what's on the desk apart from the mug", ["laptop"]),
        ("what is next to the bookshelf?", []),
        # A sum of several things is not the measure of each.
        ("total width of both desks", 2.8),
        ("what is the combined height of the two chairs?", 1.8),
        ("how wide are both desks", 1.4),
        # The floor or wall may only say more exactly where a relation holds.
        ("is anything on the floor under the desks?", "yes"),
        ("is anything on the floor under the left desk", "yes"),
        ("is anything on the floor under the coffee table?", "no"),
        ("what is on the floor under the desk", ["bin"]),
        # "Not under the other desk" must not be hidden by what is under the first one.
        ("is anything on the floor under the right desk?", "no"),
        # A kind is no other kind that only shares the last word.
        ("is there a dining table?", "no"),
        ("is there a wine rack?", "no"),
        ("is there a coffee table?", "yes"),
        # Sides of one thing compared with each other.
        ("is the desk wider than it is deep?", "yes"),
        ("Is the bookshelf wider than it's tall?", "no"),
        ("are the chairs taller than they are wide", "yes"),
        # Counts.
        ("how many things are not white?", 7),
        ("how many chairs and how many desks are there?", ["2 chairs", "2 desks"]),
        ("how many people can sit at the left desk?", 1),
        ("how many chairs are there in total (the stools next door are not ours)?", 2),
        ("how many chairs are there, all kinds?", 2),
        # Sorted either way.
        ("sort the desks and the bookshelf by height, tallest first", ["bookshelf", "desk", "desk"]),
        ("sort the chairs and the bookshelf by height, shortest first", ["chair", "chair", "bookshelf"]),
        # Rooms and walls.
        ("how long is the wall with the door?", 4.0),
        ("how long is the wall behind the bookshelf in cm", 600.0),
        ("anything I might trip over?", "no"),
        ("yo is there a guitar", "yes"),
        ("what is the object next to the guitar", ["door"]),
    ],
)  # fmt: skip
def test_value(survey: Survey, asked: str, value: Any) -> None:
    given = answer(asked, survey)
    found = _value(given)
    assert found == (pytest.approx(value, abs=0.02) if isinstance(value, float) else value), given.text


def test_the_nearest_of_several_is_measured_from_the_other_end(survey: Survey) -> None:
    near, far = (
        answer("how far is the guitar from the nearest desk?", survey),
        answer("how far is the guitar from the farthest desk?", survey),
    )
    assert near.evidence.ids == (8, 1) and far.evidence.ids == (8, 2)
    assert isinstance(near.answer, float) and isinstance(far.answer, float) and near.answer < far.answer


def test_several_things_of_one_colour_are_told_as_several(survey: Survey) -> None:
    assert answer("what colour is the chair?", survey).text == "Both chairs are white."
    assert answer("what colour are the desks?", survey).text == "Both desks are brown."


def test_a_thing_that_stands_on_another_kind_gives_no_label_of_the_kind_asked(survey: Survey) -> None:
    given = answer("which desk has the printer?", survey)
    assert given.answer is None and given.source == "none" and "coffee table" in given.text
    assert answer("which desk has the mug?", survey).answer == "desk on the left"


@pytest.mark.parametrize("asked", ["how far is the wine rack from the guitar?", "how wide is the dining table?"])
def test_an_absent_kind_is_not_measured_as_another(survey: Survey, asked: str) -> None:
    given = answer(asked, survey)
    assert given.answer is None and given.source == "none"


def test_what_carries_the_name_is_not_told_as_absent(survey: Survey) -> None:
    chairs = tuple(t for t in survey.things if t.label == "chair")
    unsure = absent(survey, Query(text="chair"), Found("absent", (), chairs), "yesno")
    assert unsure.answer is None and "no chair" not in unsure.text and "surely" in unsure.text
    red = absent(survey, Query(text="chair", colors=("red",)), Found("absent", (), chairs), "yesno")
    assert red.answer == "no" and "There is no red chair here" in red.text


@pytest.mark.parametrize(
    ("asked", "value"),
    [
        ("is anything blue on the left desk?", "yes"),
        ("does anything red stand in the corner?", "no"),
        ("is anything white in the corner", "no"),
        ("does anything white hang on the wall?", "yes"),
        ("what blue things are on the desk?", ["mug"]),
        ("what white things are next to the left desk", ["chair"]),
        ("what is the nearest white thing to the guitar?", "door"),
    ],
)
def test_a_colour_narrows_anything(survey: Survey, asked: str, value: Any) -> None:
    given = answer(asked, survey)
    assert _value(given) == value, given.text


def test_a_length_between_things_is_no_thing(survey: Survey) -> None:
    assert answer("is there more than a metre between the two desks?", survey).answer == "yes"
    assert answer("is there more than four metres between the two desks?", survey).answer == "no"
    assert answer("how much wall space is there between the left desk and the bookshelf?", survey).answer == (
        pytest.approx(1.0, abs=0.02)
    )


def test_labels_in_the_plural_stay_as_they_are() -> None:
    books = [_node(i, "books", "blue", (0.2, 0.2, 0.1), (float(i), 0.0, 0.05)) for i in (1, 2)]
    shelf = Survey.of_graph(SceneGraph.model_validate({"room": {"size": [6.0, 4.0, 2.5]}, "nodes": books}))
    assert answer("what colour are the books?", shelf).text == "Both books are blue."
    assert "2 books:" in answer("are there any books?", shelf).text


def test_who_sits_before_one_of_several_things_faces_that_one(survey: Survey) -> None:
    given = answer("If I sit on the left chair facing the desk, is the guitar on my left or my right?", survey)
    assert given.answer == "left", given.text


@pytest.mark.parametrize(
    "asked", ["do I have to walk around anything to get from the door to the desk?",
              "is it hard to get from the door to the printer?", "does the laptop shine on the desk?"]
)  # fmt: skip
def test_a_question_is_not_restated_as_its_opposite(survey: Survey, asked: str) -> None:
    assert answer(asked, survey).source == "none"


def test_the_verb_agrees_with_a_label_in_the_plural() -> None:
    nodes = [_node(1, "desk", "brown", (1.4, 0.7, 0.75), (0.0, 0.0, 0.375)),
             _node(2, "books", "blue", (0.2, 0.2, 0.1), (0.0, 0.0, 0.8), 1)]  # fmt: skip
    desk = Survey.of_graph(SceneGraph.model_validate({"room": {"size": [6.0, 4.0, 2.5]}, "nodes": nodes}))
    assert answer("what is on the desk?", desk).text == "The books are on the desk."
