"""Turns of everyday English become plain words, and what is asked in them is answered of the moving rooms."""

from __future__ import annotations

from typing import Any

import pytest

from scenewright.benchmarks._motion.asking import asked
from scenewright.planners.questions.reading.time import several
from scenewright.planners.questions.reading.time.everyday import everyday
from scenewright.planners.questions.reading.time.notation import inflected

PLAIN = [
    ("when does the ball spring into action", "when does the ball start to move"),
    ("the ball is losing speed", "the ball is slowing down"),
    ("the lamp stays rooted to the spot", "the lamp stays still"),
    ("how many seconds have gone by when the ball stops", "when the ball stops"),
    ("at time zero , is the door open", "at the start , is the door open"),
    ("two tenths of a second", "0.2 seconds"),
    ("is it open after 250 ms", "is it open after 0.25 seconds"),
    ("when has the fan turned twice", "when has the fan made two full turns"),
]


@pytest.mark.parametrize(("said", "plain"), PLAIN)
def test_a_turn_of_speech_becomes_plain(said: str, plain: str) -> None:
    assert everyday(said) == plain


@pytest.mark.parametrize("said", [plain for _, plain in PLAIN] + ["how far is the lamp from the bed", "where is it"])
def test_what_is_plain_stays(said: str) -> None:
    assert everyday(said) == said


@pytest.mark.parametrize(
    ("verb", "like", "found"),
    [("start", "springs", "starts"), ("stop", "freezing", "stopping"), ("move", "stirred", "moved"),
     ("fall", "went", "fell"), ("move", "go", "move")],
)  # fmt: skip
def test_a_verb_takes_the_form_of_another(verb: str, like: str, found: str) -> None:
    assert inflected(verb, like) == found


@pytest.mark.parametrize(
    ("text", "question"),
    [
        ("Does the lamp on the desk come to harm, I mean does it fall?", "does the lamp on the desk fall?"),
        ("Could I walk through the door at 0.5 s, i.e. is it open by then?", "is the door open at 0.5 s?"),
    ],
)
def test_what_is_meant_is_asked_of_what_was_named(text: str, question: str) -> None:
    assert list(several.question_alone(text)) == [question]


def test_a_time_that_is_not_said_again_is_not_left_out() -> None:
    assert list(several.question_alone("Does the door creak at 2 s, I mean is it open?")) == []


def _case(room: str, text: str, kind: str, value: Any, tolerance: float = 0.1, unit: str = "") -> dict[str, Any]:
    return {"room": room, "text": text, "expect": {"kind": kind, "value": value, "tolerance": tolerance, "unit": unit}}


@pytest.mark.slow
def test_steps_shares_and_turns() -> None:
    cases = [
        _case("toy", "How many steps does the robot take?", "number", 10, 1),
        _case("toy", "How long does one step of the robot take?", "seconds", 0.4, 0.05, "s"),
        _case("fan", "What percentage of the clip does the fan turn for?", "number", 80, 1, "%"),
        _case("fan", "What fraction of the clip is the fan moving?", "number", 0.8, 0.02),
        _case("fan", "When does the fan complete its third turn?", "seconds", 3, 0.1, "s"),
        _case("fan", "How long does it take the fan to turn once?", "seconds", 1, 0.1, "s"),
        _case("drawer", "Does the drawer open and close at the same speed?", "yesno", True),
        _case("drawer", "Which drawer moves, the top one or the bottom one?", "names", ["top drawer"]),
    ]
    assert [(a.case["text"], a.answer.text) for a in asked(cases) if a.outcome != "right"] == []


@pytest.mark.slow
def test_what_asks_for_more_gets_no_yes() -> None:
    texts = ["Sort the things by how much they please you.", "It stops, the ball, and why is that, when would you say?"]
    found = asked([_case("ball", text, "refuse", None) for text in texts])
    assert [(a.case["text"], a.answer.text) for a in found if a.outcome != "right"] == []
