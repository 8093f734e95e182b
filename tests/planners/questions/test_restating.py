"""Questions that no template reads, restated by their cue and the things that they name."""

from __future__ import annotations

import json

import pytest

from scenewright.planners.questions.asking import route
from scenewright.planners.questions.reading.restating import restated
from scenewright.planners.questions.reading.words import plain_words
from scenewright.planners.questions.survey import Survey
from scenewright.planners.rooms.graph import SceneGraph

ROOM = {
    "room": {"size": [5, 4, 2.5]},
    "nodes": [
        {"id": "desk", "label": "desk", "color": "brown", "size": [1.4, 0.7, 0.75], "position": [0, 1.5, 0.375]},
        {"id": "lamp", "label": "table lamp", "color": "white", "size": [0.2, 0.2, 0.4], "position": [0.4, 1.5, 0.95],
         "support": "desk"},
        {"id": "chair", "label": "armchair", "color": "red", "size": [0.8, 0.8, 0.9], "position": [0, 0, 0.45]},
        {"id": "case", "label": "bookshelf", "color": "black", "size": [1, 0.3, 1.9], "position": [-2, 1.8, 0.95]},
    ],
}  # fmt: skip
LABELS = ("desk", "table lamp", "armchair", "bookshelf")


@pytest.fixture(scope="module")
def survey() -> Survey:
    return Survey.of_graph(SceneGraph.model_validate_json(json.dumps(ROOM)))


@pytest.mark.parametrize(
    ("question", "meant"),
    [
        ("And the armchair, what shade have they chosen for it?", "what colour is the armchair"),
        ("I've got to order a frame for it: give me the bookcase's width.", "how wide is the bookcase"),
        ("Front to back the place runs to how many metres?", "how deep is the room"),
        ("Can the desk be reached from the bookcase on foot?", "can one walk from the bookcase to the desk"),
        ("Is it behind the armchair that the desk stands?", "is the desk behind the armchair"),
    ],
)
def test_a_question_in_other_words_becomes_a_plain_one(question: str, meant: str) -> None:
    assert meant in list(restated(plain_words(question), LABELS))


@pytest.mark.parametrize(
    "question",
    [
        "What colour was the armchair before they bought it?",
        "How wide is the desk of the neighbours?",
        "How many armchairs are there without the red one?",
        "Who made the bookcase, and how tall are they?",
        "When I sat at the desk, where had they left the armchair?",
    ],
)
def test_words_that_change_the_meaning_are_not_dropped(question: str) -> None:
    assert not [q for q in restated(plain_words(question), LABELS) if "armchair" in q or "desk" in q or "bookcase" in q]


def test_the_answer_says_how_the_question_was_read(survey: Survey) -> None:
    reading = route("And the armchair, what shade have they chosen for it?", survey)
    assert reading.answer.answer == "red"
    assert reading.restated and f"Read as: {reading.restated}?" in reading.answer.text
    assert reading.answer.confidence < 0.9


def test_a_seat_and_a_gaze_give_the_frame() -> None:
    said = "Let's pretend you're eating on the armchair, facing the desk; is the bookshelf then on your left?"
    assert "if i sat on the armchair facing the desk , is the bookshelf on my left" in list(
        restated(plain_words(said), LABELS)
    )
