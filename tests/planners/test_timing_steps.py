"""Things that move in step with others, in turn, or each at its own time; and what a wish says twice."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import pytest

from scenewright.gaussians.language.query.query import Query
from scenewright.planners.grammar.planner import GrammarPlanner
from scenewright.planners.grammar.timing.marked.names import with_nouns
from scenewright.planners.plan import Movement

PLANNER = GrammarPlanner()


class Film:
    """A scene with motion as planners see it: three drawers of which the top one moves, a robot, a car that stands, a
    ball, a fan; all that is blue, green or red moves, too."""

    _MOVING = ("robot", "ball", "fan", "book")

    def graph(self) -> Any:
        raise AssertionError("no graph is needed")

    def picture(self) -> bytes | None:
        return None

    def moves(self, query: Query) -> bool | None:
        if query.text == "drawer":
            return query.pick in ("highest", "all")
        return query.moving is True or not query.text or query.text.split(" ")[-1] in self._MOVING

    def movement(self, query: Query) -> Movement | None:
        if not self.moves(query):
            return None
        return Movement(0.0, 4.0, True) if query.text == "fan" else Movement(0.5, 3.5, False)

    def lacks(self, query: Query) -> bool:
        return False


def planned(text: str) -> list[dict[str, Any]]:
    plan = PLANNER.plan(text, observation=Film())
    return [op.model_dump(exclude_defaults=True, mode="json") | {"op": op.op} for op in plan.ops]


def drawer(pick: str) -> dict[str, str]:
    return {"text": "drawer", "pick": pick}


@pytest.mark.parametrize(
    "text",
    [
        "sync the middle drawer with the top one, pops out together and shuts together",
        "The middle drawer is to accompany the top one, opening and closing at exactly the same moments.",
    ],
)
def test_a_drawer_opens_and_closes_as_another_one_does(text: str) -> None:
    opens, closes = planned(text)
    for op, change, state in ((opens, None, "opening"), (closes, "close", "closing")):
        assert (op["op"], op["target"], op.get("change")) == ("articulate", drawer("middle"), change)
        assert op["when"]["during"] == {"state": state, "of": drawer("highest")}


@pytest.mark.parametrize(
    ("text", "picks"),
    [
        ("all three drawers open one by one, first bottom then middle then top", "lowest middle highest"),
        ("make all 3 drawers pop out one after the other, bottom one first, then middle, then top",
         "lowest middle highest"),
        ("Open the bottom drawer first, then the middle one and finally the top one", "lowest middle highest"),
    ],
)  # fmt: skip
def test_drawers_open_in_turn(text: str, picks: str) -> None:
    """What opens by itself only begins then."""
    ops = planned(text)
    assert [op["target"] for op in ops] == [drawer(pick) for pick in picks.split()]
    assert [op["op"] for op in ops] == ["articulate", "articulate", "pace"]
    for before, op in pairwise(ops):
        assert op["when"]["during"] == {"state": "opening", "of": before["target"], "part": "after"}


def test_one_after_the_other_is_not_all_at_once() -> None:
    assert planned("let all the drawers come out one by one") == []


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("the yellow car drives to the bed too, it leaves and arrives at the same time as the robot", None),
        ("also the car shall drive to the bed, starting together with the robot and arriving together with him", None),
    ],
)
def test_a_thing_goes_somewhere_as_another_one_moves(text: str, part: str | None) -> None:
    (op,) = planned(text)
    assert op["op"] == "move" and op["target"]["text"] == "car"
    assert op["when"]["during"].get("part") == part and op["when"]["during"]["of"] == {"text": "robot"}


@pytest.mark.parametrize(
    ("text", "starts"),
    [
        ("Permute the fall sequence: blue at 0.5 s, green at 1.2 s, red at 2.0 s.",
         {"blue": 0.5, "green": 1.2, "red": 2}),
        ("let the red book fall at 1 s and the blue book at 3 s", {"red": 1.0, "blue": 3.0}),
    ],
)  # fmt: skip
def test_each_of_several_things_has_its_own_time(text: str, starts: dict[str, float]) -> None:
    ops = planned(text)
    assert {op["target"]["colors"][0]: op["when"]["start"] for op in ops} == starts
    assert all(op["change"] == "begin" for op in ops)


def test_a_beginning_and_a_speed_are_two_changes() -> None:
    speed, begin = planned("Our guests are late, so the ball begins to roll at two seconds, but at double speed.")
    assert (speed["change"], speed["factor"]) == ("speed", 2.0)
    assert (begin["change"], begin["when"]) == ("begin", {"start": 2.0})


def test_numbers_that_say_nothing_new_are_no_other_wish() -> None:
    (op,) = planned("Pull the drawer's return 0.4 s earlier: close begins at 3.1.")
    assert (op["change"], op["when"]) == ("close", {"start": 3.1})
    (op,) = planned("The ball still departs at 0.5 s but travels at 1.5 times its present speed.")
    assert (op["change"], op["factor"]) == ("speed", 1.5)
    assert planned("The ball still departs at 1.7 s but travels at 1.5 times its present speed.") != [op]


def test_what_rests_may_still_end_as_it_does() -> None:
    rest, stop = planned("Interrupt the fan from 1.0 to 2.0 s, then let it resume, with its final stop at 4 s as now.")
    assert (rest["change"], rest["when"]) == ("stop", {"start": 1.0, "stop": 2.0})
    assert (stop["change"], stop["when"]) == ("stop", {"start": 4.0})


@pytest.mark.parametrize(
    "text",
    [
        "place three bottles on the table. frobnicate the table",
        "At t = 3 s the middle drawer shall be completely shut and simultaneously extended by 30 cm.",
        "On the sofa there sits a cat, could you make her black instead of white?",
    ],
)
def test_what_cannot_be_or_is_not_there_is_not_done(text: str) -> None:
    assert planned(text) == []


def test_words_for_one_of_several() -> None:
    assert with_nouns("hide it from when the first book falls until the last has landed").endswith(
        "the last book has landed"
    )
    assert with_nouns("pull out the bottom one as well") == "pull out the bottom drawer as well"
    assert with_nouns("open the top drawer , then the middle one and stop") == (
        "open the top drawer , then the middle drawer and stop"
    )
