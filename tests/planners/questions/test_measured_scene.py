"""Questions about Gaussians: names, colours and sizes as measured in a scene that was built from a graph."""

from __future__ import annotations

import re

import pytest

from scenewright.agent.session.session import Session
from scenewright.planners.questions.asking import answer
from scenewright.planners.questions.survey import Survey
from scenewright.planners.rooms.graph import SceneGraph

ROOM = SceneGraph.model_validate(
    {
        "room": {"size": [5.0, 4.0, 2.5]},
        "nodes": [
            {"id": 1, "label": "sofa", "color": "blue", "size": [2.0, 0.9, 0.8], "position": [0, 1.5, 0.4]},
            {"id": 2, "label": "coffee table", "color": "brown", "size": [1, 0.6, 0.4], "position": [0, 0.3, 0.2]},
            {"id": 3, "label": "chair", "color": "red", "size": [0.5, 0.5, 0.9], "position": [-2, -1, 0.45]},
            {"id": 4, "label": "chair", "color": "white", "size": [0.5, 0.5, 0.85], "position": [2, -1, 0.425]},
        ],
    }
)


@pytest.fixture(scope="module")
def survey() -> Survey:
    return Session(ROOM.build(detail=0.1)).survey()


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("what colour is the sofa?", "blue"), ("is the coffee table brown?", "yes"), ("is the sofa red?", "no"),
        ("how many chairs are there?", 2), ("which is bigger, the sofa or the table?", "sofa"),
        ("is there a piano?", "no"), ("which chair is white?", "chair"),
        # The built sofa fills its box; two centimetres are the noise of its outermost Gaussians.
        ("how wide is the sofa?", pytest.approx(2.0, abs=0.02)),
    ],
)  # fmt: skip
def test_a_scene_is_answered_as_its_graph_is(survey: Survey, text: str, value: object) -> None:
    assert answer(text, survey).answer == value
    assert answer(text, Survey.of_graph(ROOM)).answer == value


def test_what_was_pointed_at_is_told() -> None:
    session = Session(ROOM.build(detail=0.1))
    language = session.embed().language
    assert language is not None
    chair = next(g.id for g in language.groups if g.label == "chair" and g.box.center[0] > 0)
    for text, told in (
        ("what is this?", r"^That is a white chair, 0\.5\d m wide"), ("what kind of thing is that?", "a white chair"),
        ("where is it?", "^The white chair is "), ("how large is it?", r"^The white chair is 0\.5\d m wide"),
        ("describe it", "^White chair: "), ("is it on the left?", "^No, the white chair is on the right"),
    ):  # fmt: skip
        session.remember((chair,))
        assert re.search(told, session.ask(text).text), (text, session.ask(text).text)


def test_a_size_of_several_things_has_its_unit_once(survey: Survey) -> None:
    assert " m high)" in (told := answer("how large is the chair?", survey).text) and "high m" not in told, told


def test_colours_are_the_plain_words_that_selection_uses(survey: Survey) -> None:
    assert {t.label + t.color for t in survey.things} == {"sofablue", "coffee tablebrown", "chairred", "chairwhite"}


CHAIRS = SceneGraph.model_validate(
    {
        "room": {"size": [5.0, 4.0, 2.5]},
        "nodes": [  # ids that are no rows of the graph
            {"id": 10, "label": "door", "size": [0.9, 0.06, 2], "position": [0, -1.97, 1], "support": "wall"},
            {"id": 11, "label": "chair", "color": "red", "size": [0.5, 0.5, 0.9], "position": [-2, 1, 0.45]},
            {"id": 12, "label": "piano", "color": "black", "size": [1.4, 0.6, 1.2], "position": [0, 1.6, 0.6]},
            {"id": 13, "label": "chair", "color": "red", "size": [0.5, 0.5, 0.7], "position": [2, 0, 0.35]},
        ],
    }
)


@pytest.fixture(scope="module", params=["measured", "written"])
def rooms(request: pytest.FixtureRequest) -> Survey:
    return Session(CHAIRS.build(detail=0.1)).survey() if request.param == "measured" else Survey.of_graph(CHAIRS)


def test_each_candidate_of_an_ambiguous_phrase_has_its_own_answer(rooms: Survey) -> None:
    tall = answer("how tall is the chair?", rooms)
    assert tall.answer is None and set(tall.evidence.ids) == {11, 13}
    heights = [float(value) for value in re.findall(r"\(([\d.]+) m\)", tall.text)]
    assert sorted(heights) == [pytest.approx(0.7, abs=0.02), pytest.approx(0.9, abs=0.02)]
    far = answer("how far is the chair from the door?", rooms)
    assert far.answer is None and set(far.evidence.ids) == {10, 11, 13}
    lengths = [float(value) for value in re.findall(r"([\d.]+) m\b", far.text)]
    # Between the middles of the boxes: (2, 1.97, 0.65) and (2, 2.97, 0.55) m.
    assert sorted(lengths) == [pytest.approx(2.882, abs=0.03), pytest.approx(3.623, abs=0.03)]


@pytest.mark.slow
def test_it_means_what_the_answer_was_about_until_the_scene_changes() -> None:
    session = Session(CHAIRS.build(detail=0.1), planner="grammar")
    assert session.ask("how tall is the piano?").answer == pytest.approx(1.2, abs=0.02)
    assert session.ask("what colour is it?").answer == "black"
    session.do("delete it")
    assert session.ask("is there a piano?").answer == "no"
    session.undo()
    assert session.ask("is there a piano?").answer == "yes"
    assert session.ask("how wide is it?").answer == pytest.approx(1.4, abs=0.02)


@pytest.mark.parametrize(
    "text",
    [
        "is the piano taller than the ceiling?", "which is wider, the wall or the piano?",
        "what is the left wall standing on?", "what carries the floor?", "is the ceiling on the wall?",
        "is the floor in the left corner?", "how wide is the floor?", "where is the ceiling?",
        "what colour is the wall?", "where does the ceiling go?",
        "would the chair fit inside the wall?",
        "is the ceiling the wall farthest away from the floor?", "how many feet does the door measure?",
    ],
)  # fmt: skip
def test_floor_walls_and_ceiling_may_be_asked_about(rooms: Survey, text: str) -> None:
    assert answer(text, rooms).text
