"""Comparisons in a scene with time, questions that are made of several, and those that offer names to choose from."""

from __future__ import annotations

import pytest

from scenewright.agent.session.session import Session
from scenewright.planners.questions.reading.time import several
from scenewright.planners.questions.reading.time.comparing import comparisons
from scenewright.planners.questions.reading.time.loosely import loosely
from tests.planners.questions.test_motion_asked import moving, said


@pytest.fixture(scope="module")
def session() -> Session:
    return Session(moving())


@pytest.mark.parametrize(
    ("text", "answer"),
    [
        ("does the clock turn faster than 20 rpm?", "yes"),
        ("Does the clock do more than 40 rpm?", "no"),
        ("does the ball roll farther than 3 metres?", "yes"),
        ("is the ball on the rug for more than a second?", "no"),
        pytest.param("does the red book take as long to fall as the green one?", "yes", marks=pytest.mark.slow),
        pytest.param("do the two books fall equally fast?", "yes", marks=pytest.mark.slow),
        ("does the ball move longer than it stands still?", "no"),
        ("does the ball move longer than the red book?", "yes"),
        ("has the ball covered more than half of its way at 1.5 s?", "no"),
        ("do more than two books fall?", "no"),
        ("which takes longer, the fall of the red book or the movement of the ball?", "movement of the ball"),
        ("how much longer does the ball move than the red book?", pytest.approx(1.6, abs=0.06)),
        ("does the ball roll farther than the cat?", None),
        ("which moves, the chair, the desk or the ball?", "ball"),
        ("What stays where it is from start to finish, the chair or the ball?", "chair"),
        ("which of these moves: the chair or the desk?", None),
        ("Does the chair fall over, or at least move a little?", "no"),
        ("does the red book fall, or at least move?", "yes"),
        ("when does the ball cross the rug and stop?", None),
        pytest.param("I lost my glasses. What does the ball cross?", "rug", marks=pytest.mark.slow),
        ("Something fell. When does the red book fall?", pytest.approx(2.0, abs=0.03)),
        pytest.param("how many cats are on the desk at 1 s?", None, marks=pytest.mark.slow),
        ("how many chairs are on the desk at 1 s?", 0.0),
        pytest.param("which surface is under the ball at 2.2 s?", "rug", marks=pytest.mark.slow),
        ("does the red book finally fall?", "yes"),
        pytest.param("to the wall the ball rolls at which second", None, marks=pytest.mark.slow),
        pytest.param(
            "onto the rug the ball gets at which second", pytest.approx(1.95, abs=0.03), marks=pytest.mark.slow
        ),
        ("rolly the ball, when does it stop?", pytest.approx(3.0, abs=0.03)),
        ("My wife says no way, but does the ball roll more than three metres?", "yes"),
        ("Which way does it go, the ball? My son bet me it goes left.", "right"),
        ("How many books have fallen by 2.2 s?", 1.0),
        ("when have two books fallen?", pytest.approx(2.4, abs=0.03)),
        ("do three books fall?", "no"),
        pytest.param("is there a book on the floor at 0.7 s?", "no", marks=pytest.mark.slow),
        ("is the ball ever not moving?", "yes"),
        ("how many full rotations does the clock make by the third second?", pytest.approx(1.5, abs=0.02)),
        ("when is the chair's first movement?", None),
        ("the ball, not before the rug, when does it stop?", None),
        ("hi there, quick one: at what second is the ball done rolling?", pytest.approx(3.0, abs=0.03)),
        ("Once it's off the rug, how much longer does the ball keep rolling?", pytest.approx(0.5, abs=0.06)),
        ("Does the clock turn at a constant speed?", "yes"),
        ("Only one thing in here never moves near the desk; which?", None),
        ("does the ball end up where it started?", "no"),
        ("how long is it standing at the desk in the end?", None),
        ("does the ball stop on the rug?", "no"),
        ("which books fall after 0.2 s?", ("green book", "red book")),
        ("does the red book take longer than the green one to fall?", "no"),
        ("does the ball roll more slowly than 1 m/s?", "no"),
        pytest.param("is the door open at 2 s?", None, marks=pytest.mark.slow),
        ("does the clock turn at least 20 times a minute?", "yes"),
        ("does the ball ever go faster than 3 m/s?", "no"),
        ("Is the ball at its top speed when it leaves the rug?", None),
        ("By the halfway point of the clip, has the green book fallen?", "yes"),
        ("How much time is left in the clip when the ball stops?", pytest.approx(1.0, abs=0.03)),
        ("I need a sound for the ball. How long should it last?", None),
        ("by the time the red book lands, has the green one fallen?", "yes"),
    ],
)
def test_comparisons_and_questions_of_two(session: Session, text: str, answer: object) -> None:
    given = said(session, text)
    assert given.answer == answer, given.text


@pytest.mark.parametrize(
    ("words", "first", "second"),
    [
        ("does it open faster than it closes", "how fast does it open", "how fast does it closes"),
        ("does it take longer to open than to close", "how long does it take to open",
         "how long does it take to close"),
        ("does it go farther before the turn than after", "how far does it go before the turn",
         "how far does it go after the turn"),
        ("do the out stroke and the return stroke take the same time", "how long does the out stroke take",
         "how long does the return stroke take"),
        ("is the door more than half open at 2 s", "how far is the door open at 2 s", "how far does the door open"),
    ],
)  # fmt: skip
def test_a_comparison_is_two_questions(words: str, first: str, second: str) -> None:
    found = next(comparisons(words))
    assert found.first[0] == first and second in found.second


@pytest.mark.parametrize(
    ("words", "plain"),
    [
        ("robby the robot gets to the bed at which second", "when does the robot gets to the bed"),
        ("robot , turn , when", "when does the robot turn"),
        ("the robot at which speed walks", "how fast does the robot walks"),
        ("the robot not walks when", ""),
        ("when walks the robot more than the dragon", ""),
        ("the robot zorps when", ""),
    ],
)
def test_words_in_any_order_are_put_together_unless_some_that_matter_are_left(words: str, plain: str) -> None:
    found = loosely(words, frozenset({"robot", "bed"}))
    assert (plain in found) if plain else found == ()


def test_what_is_no_comparison_is_left_alone() -> None:
    for words in ("does it move at the same time", "which book falls first", "is the door open at 2 s"):
        assert list(comparisons(words)) == [], words
    assert several.either("is it open or closed") is None and several.choice("what moves at 2 s") is None
