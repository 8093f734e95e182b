"""Pieces of an instruction that ask for nothing are left out where the whole is not understood, and no others."""

from __future__ import annotations

from typing import Any

import pytest

from scenewright.planners.grammar.planner import GrammarPlanner

PLANNER = GrammarPlanner()


def planned(text: str) -> list[dict[str, Any]]:
    return [op.model_dump(exclude_defaults=True, mode="json") | {"op": op.op} for op in PLANNER.plan(text).ops]


@pytest.mark.parametrize(
    ("text", "plainly"),
    [
        ("To calm things down, stop the fan at 2 s.", "stop the fan at 2 s"),
        ("Stop the fan at 2 s, that noise drives my neighbours mad.", "stop the fan at 2 s"),
        ("When you find the time, please hide the vase from 1 to 2 s.", "hide the vase from 1 to 2 s"),
        ("Hide the vase from 1 to 2 s, magician style.", "hide the vase from 1 to 2 s"),
        ("Let the door open at 3 s, so the audience can look around first.", "let the door open at 3 s"),
        ("The fan is far too lively, half as fast would do.", "the fan at half speed"),
        ("Our witness says that the ball started at 2 s, please correct that.", "start the ball at 2 s"),
        (
            "Nobody sees the vase until the fan stops, and then, voila, there it is.",
            "hide the vase until the fan stops",
        ),
    ],
)
def test_what_asks_for_nothing_is_left_out(text: str, plainly: str) -> None:
    assert planned(text) == planned(plainly) != []


@pytest.mark.parametrize(
    "text",
    [
        "stop the fan at 2 s, and the lamp should sing",
        "hide the vase from 1 to 2 s, except in the mirror",
        "let the ball roll to the wall in 2 s, I want it to explode there",
        "open the door at 3 s, not before the bell has rung twice",
    ],
)
def test_what_may_ask_for_something_is_not_left_out(text: str) -> None:
    assert planned(text) == []


@pytest.mark.parametrize(
    ("text", "plainly"),
    [
        ("the red book drops a second time at 3 s", "the red book falls once more at 3 s"),
        ("leave the drawer open, no need for it to shut again", "do not close the drawer"),
        ("take the ball down to half its pace", "play the ball at half the speed"),
        ("swing the door to 30 degrees", "open the door by 30 degrees"),
        ("the sofa would look nicer in green, the whole film through", "make the sofa green"),
        ("hide the lamp at the point where the ball stops", "hide the lamp once the ball stops"),
        (
            "slide the chair over and park next to the bed from 1 to 3 s",
            "slide the chair next to the bed from 1 to 3 s",
        ),
    ],
)
def test_one_thing_is_said_in_other_words(text: str, plainly: str) -> None:
    assert planned(text) == planned(plainly) != []


def test_an_order_is_told_by_places() -> None:
    (op,) = planned("the blue book should fall first and the red one last, with the green one in the middle")
    assert op["op"] == "order"
    assert [q["colors"] for q in op["first"]] == [["blue"], ["green"], ["red"]]
