"""Descriptions: everything that is told is in the survey, and the kind of room follows from what it holds."""

from __future__ import annotations

import json

import pytest
from small_room import BED, BIN, DEPTH, DESK, DOOR, HEIGHT, RUG, THINGS, WIDTH, graph, node, said

from scenewright.gaussians.color import BASIC
from scenewright.planners.questions.describing import describe
from scenewright.planners.questions.room_kind import room_kinds
from scenewright.planners.questions.survey import Survey

LAMP = node(20, "table lamp", (0.2, 0.2, 0.4), (-1.8, 1.7), low=0.75, support=3, color="white")
CHAIR = node(21, "chair", (0.45, 0.5, 0.9), (-1.6, 1.1), 180.0, color="black")
STAND = node(22, "nightstand", (0.4, 0.4, 0.5), (0.6, 1.7), color="brown")
WARDROBE = node(23, "wardrobe", (0.6, 0.6, 2.0), (2.15, -1.6), color="white")
BEDROOM = (*THINGS, LAMP, CHAIR, STAND, WARDROBE)


def test_every_thing_has_a_line_with_its_measures() -> None:
    found = describe(Survey.of_graph(graph(*BEDROOM)))
    assert [t.id for t in found.things] == [n.id for n in BEDROOM]
    for caption, thing in zip(found.things, BEDROOM, strict=True):
        assert (caption.name, caption.color, caption.size) == (thing.label, thing.color, thing.size)
        assert thing.label in caption.text and caption.place
    desk = next(t for t in found.things if t.id == DESK.id)
    assert desk.holds == (LAMP.id,) and "white table lamp" in desk.text


def test_the_paragraph_tells_the_room_its_main_things_and_what_stands_on_what() -> None:
    text = describe(Survey.of_graph(graph(*BEDROOM))).text
    assert f"{WIDTH:.1f} m wide, {DEPTH:.1f} m deep and {HEIGHT:.1f} m high" in text
    assert "black chair stands at a desk" in text
    assert "bed stands" in text and "brown nightstand" in text
    assert "on the desk is a white table lamp" in text.lower()
    assert "bedroom" in text
    for thing in (BED, DESK, RUG, BIN, DOOR, WARDROBE):
        assert thing.label in text


def test_nothing_is_told_that_is_not_there() -> None:
    text = describe(Survey.of_graph(graph(*BEDROOM))).text.lower()
    told = set(text.replace(",", " ").replace(".", " ").split())
    assert not told & (set(BASIC) - {"white", "black", "brown"})
    assert not told & {"sofa", "television", "shelf", "mirror", "lamps"}


def test_things_without_a_name_are_told_as_such() -> None:
    unnamed = [node(30 + i, "", (0.5 + i / 10, 0.5, 0.5), (i - 2.0, -1.0), color="gray") for i in range(3)]
    found = describe(Survey.of_graph(graph(*THINGS, *unnamed)))
    assert "three of the 9 things have no sure name" in found.text.lower()
    assert found.things[-1].name == "" and "unnamed thing" in found.things[-1].text


def test_an_empty_room_is_described() -> None:
    one = node(1, "", (1.0, 1.0, 1.0), (0.0, 0.0))
    found = describe(Survey.of_graph(graph(one)))
    assert found.room_kind == "" and "One thing has no sure name" in found.text


def test_a_description_is_plain_json_and_the_same_each_time() -> None:
    first, second = (json.dumps(describe(Survey.of_graph(graph(*BEDROOM))).to_json()) for _ in range(2))
    assert first == second
    assert set(json.loads(first)) == {"text", "room_kind", "things"}


def test_the_kind_of_room_follows_from_what_it_holds() -> None:
    survey = Survey.of_graph(graph(*BEDROOM))
    assert room_kinds(survey)[0].name == "bedroom"
    assert sum(g.probability for g in room_kinds(survey)) <= 1
    assert not room_kinds(Survey.of_graph(graph(BED, DOOR)))  # one kind of thing tells nothing


@pytest.mark.parametrize(
    ("question", "answer_type", "value"),
    [
        ("What kind of room is this?", "label", "bedroom"),
        ("Is this a bedroom?", "yesno", "yes"),
        ("Is this a kitchen?", "yesno", "no"),
        ("Is this a kitchen or a bedroom?", "label", "bedroom"),
    ],
)
def test_questions_about_the_kind_of_room(question: str, answer_type: str, value: str) -> None:
    found = said(question, graph(*BEDROOM))
    assert (found.answer_type, found.answer) == (answer_type, value)


def test_questions_for_descriptions() -> None:
    whole = said("Describe the room.", graph(*BEDROOM))
    assert whole.answer == describe(Survey.of_graph(graph(*BEDROOM))).text
    one = said("Describe the desk, please.", graph(*BEDROOM))
    assert one.evidence.ids == (DESK.id,) and "1.40 m wide" in one.text
