"""Questions about Gaussians: names, colours and sizes as measured in a scene that was built from a graph."""

from __future__ import annotations

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


def test_colours_are_the_plain_words_that_selection_uses(survey: Survey) -> None:
    assert {t.label + t.color for t in survey.things} == {"sofablue", "coffee tablebrown", "chairred", "chairwhite"}
