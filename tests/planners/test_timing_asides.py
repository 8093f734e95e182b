"""What asks for nothing is left out of words about motion, and what may ask for something stays."""

from __future__ import annotations

import pytest

from scenewright.planners.grammar.timing.asides import changes_nothing, told_of, without_comparisons


@pytest.mark.parametrize(
    ("said", "left"),
    [
        ("let the ball start one second later than it does now", "let the ball start one second later"),
        ("play the fan twice as fast , starting from the same moment as before", "play the fan twice as fast"),
        ("stop the robot at 1 s , just where it would normally turn", "stop the robot at 1 s"),
        ("stop the fan at 2 s , if that is possible", "stop the fan at 2 s"),
        # these say what is to be
        ("start the ball at the same time as the robot", None),
        ("the fan should still stop at the same time", None),
        ("stop the ball at 2 s so that it stays on the rug", None),
        ("make the ball roll at the same speed as the robot", None),
    ],
)
def test_only_comparisons_with_now_are_left_out(said: str, left: str | None) -> None:
    assert without_comparisons(said) == (said if left is None else left)


@pytest.mark.parametrize(
    "part",
    [
        "the other books remain as they are",
        "after that he does just what he did before",
        "only then drops the rest of the way",
        "they would jump",
        "before and after that it keeps its own brown",
        "the timing is fine as it is",
    ],
)
def test_what_changes_nothing_is_known_by_all_of_its_words(part: str) -> None:
    assert changes_nothing(part)


@pytest.mark.parametrize(
    "part", ["the lamp goes red", "it stops at 2 s", "ten centimetres is plenty", "the other books fall at 2 s"]
)
def test_what_asks_for_something_changes_something(part: str) -> None:
    assert not changes_nothing(part)


@pytest.mark.parametrize(
    ("part", "thing"),
    [
        ("the drawer is staying open too long", "the drawer"),
        ("my son finds the robot too slow", "the robot"),
        ("that fan makes me quite dizzy", "that fan"),
        ("the little car just stands there", "the little car"),
        ("the blue one should wait a bit longer", "the blue one"),
        ("the door should open", None),
        ("the lamp is very red", None),
        ("the ball rolls for 2 seconds", None),
    ],
)
def test_complaints_tell_what_the_wish_behind_them_is_about(part: str, thing: str | None) -> None:
    assert told_of(part) == thing
