"""Things that move in step with others, in turn, or each at its own time; and what a wish says twice."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import pytest
from told_film import ToldFilm

from scenewright.gaussians.language.query.query import Query
from scenewright.planners.grammar.timing.marked.kinds import marked_ways
from scenewright.planners.grammar.timing.marked.names import with_nouns
from scenewright.planners.plan import Movement


class Film(ToldFilm):
    """A scene with motion as planners see it: three drawers of which the top one moves, a robot, a car that stands, a
    ball, a fan; all that is blue, green or red moves, too."""

    _MOVING = ("robot", "ball", "fan", "book")

    def moves(self, query: Query) -> bool | None:
        if query.text == "drawer":
            return query.pick in ("highest", "all")
        return query.moving is True or not query.text or query.text.split(" ")[-1] in self._MOVING

    def movement(self, query: Query) -> Movement | None:
        if not self.moves(query):
            return None
        return Movement(0.0, 4.0, True) if query.text == "fan" else Movement(0.5, 3.5, False)


planned = Film().planned


HALFWAY = {"state": "halfway", "part": "from"}


def book(color: str) -> dict[str, Any]:
    return {"text": "book", "colors": [color]}


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


@pytest.mark.parametrize(
    ("text", "when"),
    [
        ("hide the robot, on the move from 1 sec to 3 sec", {"start": 1.0, "stop": 3.0}),
        ("shift the car to the robot in the time from 1 s to 3 s", {"start": 1.0, "stop": 3.0}),
        ("paint the car red between the second second and the third", {"start": 2.0, "stop": 3.0}),
        ("the car ought to be invisible during whole first two seconds", {"stop": 2.0}),
        ("run the car over to the robot, off at 1, parked up at 3", {"start": 1.0, "stop": 3.0}),
        ("the car disappears at 0.5 s for a duration of two seconds", {"start": 0.5, "lasting": 2.0}),
    ],
)
def test_times_in_numbers_are_read_in_any_words(text: str, when: dict[str, float]) -> None:
    (op,) = planned(text)
    assert op["when"] == when


@pytest.mark.parametrize(
    ("text", "fields"),
    [
        ("let the robot turn by only 45 degrees at the corner", {"change": "turn", "degrees": 45.0}),
        (
            "the top drawer gets caught after ten centimetres for half a second, then slides out the rest",
            {"when": {"lasting": 0.5, "during": HALFWAY | {"distance": {"value": 0.1}}}},
        ),
        (
            "a quarter of the way down the red book hovers for 0.4 s",
            {"when": {"lasting": 0.4, "during": HALFWAY | {"share": 0.25}}},
        ),
        ("run the fan one more second, please", {"change": "go_on", "when": {"stop": 5.0}}),
        ("the red ball falls one more time at 4 s", {"change": "repeat", "when": {"start": 4.0}}),
    ],
)
def test_how_far_how_often_and_how_much_longer(text: str, fields: dict[str, Any]) -> None:
    (op,) = planned(text)
    assert {key: op[key] for key in fields} == fields


@pytest.mark.parametrize(
    ("text", "order"),
    [
        ("swap the red book and the blue book in the falling queue", {"order": None, "first": None}),
        ("the red book should wait its turn and be the last to drop", {"order": "listed", "last": book("red")}),
        (
            "flip the show: the green book leads, the blue book follows, the red book closes",
            {"order": "listed", "first": [book("green"), book("blue"), book("red")]},
        ),
    ],
)
def test_orders_are_read_in_any_words(text: str, order: dict[str, Any]) -> None:
    (op,) = planned(text)
    assert op["op"] == "order" and {key: op.get(key) for key in order} == order


def test_marks_that_make_no_plan_give_way_to_the_next_likely_ones() -> None:
    """The likeliest marks take "on the rug" for a time, or leave the amount out: others are tried."""
    words = ["robot", ":", "a", "1", "s", "pause", "right", "after", "its", "turn", ",", "then", "on", "as", "usual"]
    first, *others = marked_ways(words)
    assert others and all(way != first for way in others)
    (op,) = planned(" ".join(words))
    assert op["change"] == "stop" and op["when"]["lasting"] == 1.0


def test_another_thing_is_never_changed_for_want_of_a_plan() -> None:
    """Of marks that name another thing than the likeliest do, none is tried."""
    assert planned("the machine between the robot and the fan ought to be frobnicated at 3 s") == []
