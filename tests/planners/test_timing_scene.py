"""Wishes that only the scene makes exact: so much more or less than now, what stays as it is, and what it is called."""

from __future__ import annotations

from typing import Any

import pytest
from told_film import ToldFilm

from scenewright.gaussians.language.query.query import Query
from scenewright.planners.plan import Movement

MOVES = {
    "door": Movement(1.0, 2.5, False, 5.0, 80.0, 0.0, (1.0, 2.5)),
    "drawer": Movement(1.0, 4.5, False, 5.0, 0.0, 0.3, (1.0, 2.0, 3.5, 4.5)),
    "robot": Movement(0.2, 4.0, False, 5.0, 90.0, 2.5),
    "ball": Movement(0.5, 3.5, False, 5.0, 0.0, 4.0),
    "fan": Movement(0.0, 4.0, True, 5.0, 1440.0, 0.0, (0.0, 4.0)),
    "book": Movement(0.5, 2.5, False, 5.0, 0.0, 1.5, (0.5, 1.0)),
}


class Film(ToldFilm):
    """A scene of five seconds as planners see it, in which a door, the top drawer, a robot, a ball, a fan and books
    move; the wardrobe is brown, the vase blue."""

    def moves(self, query: Query) -> bool | None:
        if query.text.endswith("drawer"):
            return query.pick in ("highest", "all")
        return query.moving is True or not query.text or query.text.split(" ")[-1] in MOVES

    def movement(self, query: Query) -> Movement | None:
        return MOVES.get(query.text.split(" ")[-1] or "ball") if self.moves(query) else None

    def has(self, query: Query) -> bool:
        return (query.text, *query.colors) in (("wardrobe", "brown"), ("vase", "blue"))


planned = Film().planned


@pytest.mark.parametrize(
    ("text", "fields"),
    [
        ("Open the door 15 degrees further.", {"degrees": 95.0}),
        ("The door should open wider, 110 degrees.", {"degrees": 110.0}),
        ("The door may swing a full hundred and ten degrees.", {"degrees": 110.0}),
        ("Pull the top drawer out ten centimetres further.", {"distance": {"value": 0.4}}),
        ("Don't pull the top drawer out any further than 12 cm.", {"distance": {"value": 0.12}}),
        ("Ten centimetres is plenty for the top drawer.", {"distance": {"value": 0.1}}),
        ("The top drawer should come out a third less.", {"distance": {"value": 0.2}}),
        ("Let the robot turn by 30 degrees more at the corner.", {"change": "turn", "degrees": 120.0}),
        ("The robot should make a half turn instead of a quarter one.", {"change": "turn", "degrees": 180.0}),
        ("The ball should stop a metre short of the wall.", {"change": "part", "share": 0.75}),
        ("The ball should roll at 2 m/s.", {"change": "speed", "factor": 1.5}),
    ],
)
def test_how_far_is_told_by_how_far_it_goes_now(text: str, fields: dict[str, Any]) -> None:
    (op,) = planned(text)
    assert {key: op.get(key) for key in fields} == fields


@pytest.mark.parametrize(
    ("text", "ops"),
    [
        ("The top drawer stays open until 5 s.", 1),
        ("Cancel the way back of the top drawer, so that it is still open at the end.", 1),
        ("The fan takes a break between 1 and 2 s, then it goes on until 4 s like before.", 2),
    ],
)
def test_what_is_so_anyway_may_be_said_in_numbers(text: str, ops: int) -> None:
    made = planned(text)
    assert len(made) == ops and all(op["op"] == "pace" for op in made)


def test_a_colour_that_a_thing_has_now_is_no_other_wish() -> None:
    (op,) = planned("Let the wardrobe be white while the drawer is open, brown otherwise.")
    assert op["op"] == "recolor" and op["color"] == "white"
    assert planned("Let the wardrobe be white while the drawer is open, green otherwise.") == []


@pytest.mark.parametrize(
    ("text", "during"),
    [
        ("make the car red during the robot's second walk", {"state": "turning", "part": "after"}),
        ("hide the car when the second walk of the robot begins", None),
        ("stop the robot once the turn is completed", {"state": "turning", "part": "after"}),
        ("the ball should stop in the middle of the rug", {"state": "closest", "part": "from"}),
        (
            "The ball should halt on leaving the rug, pause for exactly one second, and only then go on to the wall.",
            {"state": "on", "part": "after"},
        ),
    ],
)
def test_places_and_legs_tell_times(text: str, during: dict[str, str] | None) -> None:
    for op in planned(text):
        told = op["when"]["during"]
        assert during is None or {key: told.get(key, "while") for key in during} == during
    assert planned(text) or during is None


@pytest.mark.parametrize(
    "text",
    [
        "The red book must fall before the green one and, equally, only after it.",
        "The fan has to turn twice as fast and at the same moment not move at all.",
        "Vase I don't like and table also not, take them both away please.",
    ],
)
def test_what_cannot_be_or_is_not_understood_is_not_done(text: str) -> None:
    assert planned(text) == []


def test_what_moves_is_spoken_of_without_a_time() -> None:
    (op,) = planned("The top drawer comes out too far, 15 cm is enough.")
    assert (op["op"], op["distance"]) == ("articulate", {"value": 0.15})
    (order,) = planned("Rather green, then red, then blue, so should the books fall.")
    assert [query["colors"] for query in order["first"]] == [["green"], ["red"], ["blue"]]


@pytest.mark.parametrize(
    ("text", "fields"),
    [
        ("Send the robot over to the sofa instead.", {"toward": {"text": "sofa"}}),
        ("let the ball go to the tv stand", {"toward": {"text": "tv stand"}}),
        (
            "send the robot in front of the shelf",
            {"place": {"relation": "in_front_of", "anchors": [{"text": "shelf"}]}},
        ),
    ],
)
def test_what_moves_by_itself_goes_where_it_is_sent(text: str, fields: dict[str, Any]) -> None:
    (op,) = planned(text)
    assert op.get("when") == {}
    assert {key: op.get(key) for key in fields} == fields


@pytest.mark.parametrize("text", ["send the bench to the wardrobe", "move the robot next to the sofa"])
def test_what_stands_still_is_put_there_and_what_is_moved_is_shifted(text: str) -> None:
    (op,) = planned(text)
    assert "when" not in op


@pytest.mark.parametrize(
    ("text", "during"),
    [
        ("then the robot walks to the sofa", {"state": "moving", "part": "after"}),
        ("After that the robot walks to the sofa in two seconds.", {"state": "moving", "part": "after"}),
        ("then let the bench slide to the sofa in 2 s", {"state": "moving", "of": {"moving": True}, "part": "after"}),
        ("then the robot walks to the sofa from 4 to 5 s", None),
    ],
)
def test_what_is_done_then_begins_when_the_last_movement_is_over(text: str, during: dict[str, Any] | None) -> None:
    (op,) = planned(text)
    found = op["when"].get("during")
    assert (None if found is None else {**found, **({"of": {"moving": True}} if "of" in found else {})}) == during


@pytest.mark.parametrize(
    "text",
    [
        "Play the whole clip in reverse.",
        "Reverse the footage so the ball rolls from the wall to the sofa.",
    ],
)
def test_a_film_that_runs_backwards_is_all_of_it(text: str) -> None:
    (op,) = planned(text)
    assert (op["change"], op["target"]["text"]) == ("reverse", "everything")


@pytest.mark.parametrize(
    ("text", "change"), [("The fall of the green book should take three times as long.", ("speed", 0.3333))]
)
def test_so_many_times_as_long_is_slower(text: str, change: tuple[str, float]) -> None:
    (op,) = planned(text)
    assert (op["change"], op["factor"]) == change


@pytest.mark.parametrize(
    "text",
    [
        "Robot never leaves its spot at the shelf, and it ends up next to the bed.",
        "Kindly have the top drawer wide open for the whole film, and see to it that it is never open.",
        "Robot: no corner, just keep going straight.",
        "Drawer: start opening at 0.5, closed again at 2. Nothing after that.",
    ],
)
def test_nothing_is_done_of_half_a_wish(text: str) -> None:
    assert planned(text) == []


@pytest.mark.parametrize(
    "text",
    [
        "wrong way, the robot should turn right at the corner",
        "Mirror it: the robot turns 90 degrees right instead of left.",
    ],
)
def test_what_turns_the_wrong_way_is_mirrored(text: str) -> None:
    (op,) = planned(text)
    assert op["change"] == "mirror"


def test_what_opens_in_the_place_of_another_does_so_in_its_time() -> None:
    opened, closed, stopped = planned(
        "The top one is too high for them, so pull out the bottom drawer instead of the top one."
    )
    assert (opened.get("change", "open"), closed["change"], stopped["change"]) == (
        "open",
        "close",
        "stop",
    )
    assert [op["target"]["pick"] for op in (opened, closed, stopped)] == ["lowest", "lowest", "highest"]
    assert [op["when"]["during"]["state"] for op in (opened, closed)] == ["opening", "closing"]


@pytest.mark.parametrize(
    ("text", "relation"),
    [("send the ball to a corner", "corner"), ("send the robot to the middle of the room", "center")],
)
def test_what_is_sent_to_a_place_without_a_thing_goes_there(text: str, relation: str) -> None:
    (op,) = planned(text)
    assert (op["when"], op["place"]["relation"]) == ({}, relation)


@pytest.mark.parametrize(
    ("text", "operation"),
    [
        ("Make the bottom drawer blue, and not the top one.", "recolor"),
        ("put the candle on the table at 2 s", "move"),
        ("turn the lamp on the table red at 2 s", "recolor"),
    ],
)
def test_words_for_openings_and_lamps_are_no_other_edits(text: str, operation: str) -> None:
    (op,) = planned(text)
    assert op["op"] == operation and op["target"]["text"] in ("drawer", "candle", "lamp")


def test_what_is_raised_and_dropped_is_not_deleted() -> None:
    assert planned("lift the ball by 1 m and then drop it") == []
    raised, dropped = planned("raise the ball by 1 m at 1 s, then drop it")
    assert (raised["direction"], dropped["direction"], dropped["distance"]) == ("up", "down", raised["distance"])
