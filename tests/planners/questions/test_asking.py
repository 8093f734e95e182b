"""Questions about a written graph, from words to the answer."""

from __future__ import annotations

import json

import pytest

from scenewright.gaussians.errors import UserError
from scenewright.planners.questions.asking import answer
from scenewright.planners.questions.survey import Survey
from scenewright.planners.questions.topic import topic
from scenewright.planners.rooms.graph import SceneGraph

ROOM = {
    "room": {"size": [5, 4, 2.5]},
    "nodes": [
        {"id": "desk", "label": "desk", "color": "brown", "size": [1.4, 0.7, 0.75], "position": [0, 1.5, 0.375]},
        {"id": "lamp", "label": "table lamp", "color": "white", "size": [0.2, 0.2, 0.4], "position": [0.4, 1.5, 0.95],
         "support": "desk"},
        {"id": "c1", "label": "chair", "color": "black", "size": [0.5, 0.5, 0.9], "position": [0, 0.8, 0.45]},
        {"id": "c2", "label": "chair", "color": "red", "size": [0.5, 0.5, 0.9], "position": [-2, 0, 0.45]},
    ],
}  # fmt: skip


@pytest.fixture(scope="module")
def survey() -> Survey:
    return Survey.of_graph(SceneGraph.model_validate_json(json.dumps(ROOM)))


def test_a_thing_that_is_there_is_told_with_its_ids(survey: Survey) -> None:
    found = answer("Is there a lamp on the desk?", survey)
    assert (found.answer, found.answer_type, found.evidence.ids) == ("yes", "yesno", ("lamp",))


def test_an_absent_thing_is_told_with_the_nearest(survey: Survey) -> None:
    found = answer("Could you tell me whether there's a piano in here, please?", survey)
    assert found.answer == "no"
    assert found.evidence.ids


def test_what_nobody_reads_has_no_answer(survey: Survey) -> None:
    found = answer("flurb the wibble at noon?", survey)
    assert (found.answer, found.source, found.confidence) == (None, "none", 0.0)


def test_it_means_what_the_answer_was_about(survey: Survey) -> None:
    assert topic(answer("is there a red chair?", survey), survey) == ("c2",)
    assert answer("is there a chair?", survey).evidence.ids == ("c1", "c2")


def test_a_text_that_is_too_long_is_refused(survey: Survey) -> None:
    with pytest.raises(UserError, match="1001 characters"):
        answer("x" * 1001, survey)
