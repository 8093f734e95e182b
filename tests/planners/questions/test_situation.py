"""What a question says of the place and gaze of the person who asks, and what is left of the question."""

from __future__ import annotations

import pytest

from scenewright.planners.questions.reading.side_phrases import side
from scenewright.planners.questions.reading.situation import read_situation
from scenewright.planners.questions.reading.words import plain_words


@pytest.mark.parametrize(
    ("text", "pose", "at", "gaze", "facing", "rest"),
    [
        ("If I sat on the sofa facing the window, is it far?", "on", "sofa", "at", "window", "is it far"),
        ("Would it be far if I stood by the door looking in?", "at", "door", "in", None, "would it be far"),
        ("I'm at the desk with my back to the bed. What is behind me?", "at", "desk", "away", "bed",
         "what is behind me"),
        ("When I come in through the door, what is on my left?", "enter", "door", "", None, "what is on my left"),
        ("sitting in the chair at the desk, facing it, is the bed behind me", "on", "chair", "at", "desk",
         "is the bed behind me"),
        ("is the lamp on its left from the sofa's point of view", "own", "sofa", "", None, "is the lamp on its left"),
        ("With my back to the window, is the bed on my left?", "somewhere", None, "away", "window",
         "is the bed on my left"),
    ],
)  # fmt: skip
def test_place_gaze_and_question(
    text: str, pose: str, at: str | None, gaze: str, facing: str | None, rest: str
) -> None:
    situation, words = read_situation(plain_words(text))
    assert situation is not None
    assert (situation.pose, situation.gaze) == (pose, gaze)
    assert (situation.at.text if situation.at else None) == at
    assert (situation.facing.text if situation.facing else None) == facing
    assert " ".join(words) == rest


def test_what_lies_beside_the_person_is_part_of_the_situation() -> None:
    said = "I am sitting on a toilet and there is a bin on my left within reach. What is behind me?"
    situation, words = read_situation(plain_words(said))
    assert situation is not None
    assert [(q.text, s.at) for q, s in situation.beside] == [("bin", -90.0)]
    assert words == ("what", "is", "behind", "me")


@pytest.mark.parametrize(
    "text",
    [
        "is the lamp standing by the door?",
        "which chair is facing the window?",
        "how far is the bed from the door?",
        "is the chair in front of the desk?",
        "what is on the desk by the window?",
    ],
)
def test_places_of_things_are_no_situation(text: str) -> None:
    words = plain_words(text)
    assert read_situation(words) == (None, words)


@pytest.mark.parametrize(
    ("text", "at"),
    [
        ("on my left", -90.0),
        ("to my right hand side", 90.0),
        ("directly behind me", 180.0),
        ("straight ahead", 0.0),
        ("at my two o'clock", 60.0),
        ("in my eleven o'clock direction", -30.0),
        ("at 6 o'clock", 180.0),
        ("behind me to the left", -135.0),
        ("to my front right", 45.0),
    ],
)
def test_directions_in_degrees(text: str, at: float) -> None:
    found = side(plain_words(text))
    assert found is not None
    assert found.at == at


@pytest.mark.parametrize("text", ["the sofa", "on the desk", "at my 13 o'clock", "left of the sofa"])
def test_other_words_are_no_direction(text: str) -> None:
    assert side(plain_words(text)) is None
