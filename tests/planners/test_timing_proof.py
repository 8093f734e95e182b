"""A plan is held against the times that its words tell: what would move otherwise is read otherwise, or refused."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest
from told_film import ToldFilm

from scenewright.gaussians.language.query.query import Query
from scenewright.planners.grammar.timing.marked.proof import is_borne_out
from scenewright.planners.grammar.timing.moments import Moment
from scenewright.planners.plan import Movement
from scenewright.tools.ops.pace import Pace
from scenewright.tools.registry import AnyOp


def moves(*spells: tuple[float, float], turns: bool = False) -> Movement:
    start, stop = (spells[0][0], spells[-1][1]) if spells else (0.0, 0.0)
    return Movement(start, stop, turns, 5.0, 1440.0 if turns else 0.0, 0.0 if turns else 2.0, (), spells)


BALL, ROBOT, FAN, DOOR = moves((0.5, 3.5)), moves((0.2, 4.0)), moves((0.0, 4.0), turns=True), moves((1.0, 2.5))
MOVES = {"ball": BALL, "robot": ROBOT, "fan": FAN, "door": DOOR}


class Film(ToldFilm):
    """A scene of five seconds as planners see it, in which a ball, a robot, a fan and a door move; it tells how they
    would move after another stop, beginning or speed."""

    def moves(self, query: Query) -> bool | None:
        return query.moving is True or not query.text or query.text.split(" ")[-1] in MOVES

    def movement(self, query: Query) -> Movement | None:
        return MOVES.get(query.text.split(" ")[-1] or "ball")

    def after(self, ops: Sequence[AnyOp], query: Query) -> Movement | None:
        now, (op, *more) = self.movement(query), ops
        when = op.time()
        if now is None or more or not isinstance(op, Pace) or (when is not None and when.during is not None):
            return None
        start, stop = (None, None) if when is None else (when.start, when.stop)
        if op.change == "stop" and isinstance(start, float):
            return moves((now.start, min(now.stop, start))) if start > now.start else moves()
        if op.change == "begin" and not isinstance(start, str) and not isinstance(stop, str):
            begin = now.start if start is None else start
            return moves((begin, begin + now.stop - now.start if stop is None else stop))
        if op.change == "speed":
            return moves((now.start, now.start + (now.stop - now.start) / (op.factor or 1.0)))
        return None


planned = Film().planned


@pytest.mark.parametrize(
    ("change", "after", "moment", "borne_out"),
    [
        ("begin", moves((1.5, 4.5)), Moment(start=1.5), True),
        ("begin", moves((0.5, 3.5)), Moment(start=1.5), False),  # as before
        ("begin", moves((2.0, 5.0)), Moment(stop=2.0), True),  # "it waits until 2 s"
        ("begin", moves((0.5, 4.7)), Moment(stop=4.7), True),
        ("stop", moves((0.5, 2.0)), Moment(start=2.0), True),
        ("stop", moves((0.5, 3.5)), Moment(start=4.7), False),  # it rests then, as it does now
        ("stop", moves((0.5, 1.0), (2.0, 4.5)), Moment(start=1.0, stop=2.0), True),
        ("return", moves((0.5, 3.5), (3.5, 6.5)), Moment(stop=3.5), False),
        ("return", moves((0.5, 3.5), (3.5, 6.5)), Moment(stop=6.5), True),
        ("go_on", moves((0.5, 5.0)), Moment(start=1.0), False),
        ("reverse", moves((0.5, 3.5)), Moment(start=1.0), True),  # how it then moves tells no other time
        ("begin", None, Moment(start=1.5), True),  # nobody can tell
    ],
)
def test_something_begins_or_ends_at_the_seconds_that_are_told(
    change: str, after: Movement | None, moment: Moment, borne_out: bool
) -> None:
    assert is_borne_out(change, BALL, after, [("from", moment)]) is borne_out


def test_a_change_that_changes_nothing_is_not_borne_out() -> None:
    for change in ("stop", "begin", "later", "speed"):
        assert not is_borne_out(change, BALL, BALL, [])
        assert is_borne_out(change, BALL, moves((0.5, 3.4)), [])


def test_what_would_rest_anyway_comes_to_rest_later() -> None:
    (op,) = planned("The ball only comes to a standstill at 4.7 s.")
    assert (op["change"], op["when"]) == ("begin", {"start": 0.5, "stop": 4.7})
    (op,) = planned("Let the fan come to rest only at 4.7 s.")
    assert (op["change"], op["when"]) == ("go_on", {"stop": 4.7})


@pytest.mark.parametrize(
    ("text", "when"),
    [
        ("Delay the robot such that it reaches the bed at 4.9 sec, keeping its speed unchanged.", {"start": 1.1}),
        ("Have the robot set off at one second and get to the bed at four and a half.", {"start": 1.0, "stop": 4.5}),
        ("The ball ought to reach the wall a whole second sooner, setting off as now.", {"start": 0.5, "stop": 2.5}),
    ],
)  # fmt: skip
def test_arrivals_are_ends(text: str, when: dict[str, float]) -> None:
    (op,) = planned(text)
    assert (op["change"], op["when"]) == ("begin", when)


@pytest.mark.parametrize(
    ("text", "changes"),
    [
        ("The fan has to begin turning only at 1.5 seconds, and it stops when it stopped before.", ["begin", "stop"]),
        ("We shall postpone the start of the fan by one second; the stop at 4 s stands.", ["later", "stop"]),
        ("The fan shall observe a recess from one to two seconds, and thereafter resume until four.", ["stop", "stop"]),
    ],
)
def test_an_end_that_stays_is_told_by_its_seconds(text: str, changes: list[str]) -> None:
    made = planned(text)
    assert [op["change"] for op in made] == changes and made[-1]["when"] == {"start": 4.0}


@pytest.mark.parametrize(
    "text",
    [
        "The fan is dead still the whole film and at the same time spinning flat out the whole film.",
        "Let the fan turn from beginning to end and, during those same seconds, be perfectly motionless.",
    ],
)
def test_motion_and_rest_at_once_are_refused(text: str) -> None:
    assert planned(text) == []


@pytest.mark.parametrize(
    ("text", "when"),
    [
        ("After the door has opened it waits half a second and then it closes again, that may take 1 second.",
         {"start": 0.5, "lasting": 1.0}),
        ("Once the door stands fully open, let it hold its breath for one second, then swing shut by four and a half.",
         {"start": 1.0, "stop": 4.5}),
        ("After standing fully open for one second, the door ought to be shut again, which may take another second.",
         {"start": 1.0, "lasting": 1.0}),
    ],
)  # fmt: skip
def test_a_rest_before_a_closing_is_no_moment_of_the_film(text: str, when: dict[str, float]) -> None:
    (op,) = planned(text)
    told = {key: value for key, value in op["when"].items() if key != "during"}
    assert op["change"] == "close" and told == when and op["when"]["during"]["part"] in ("from", "after")


@pytest.mark.parametrize(
    ("text", "op", "told"),
    [
        (
            "Bring the plant beside the bench, and it has to be there just when the door starts to open.",
            "move",
            "until",
        ),
        ("Ball is to halt where the rug ends. It stays put there.", "pace", "after"),
        ("robot does the first leg only, then parks. no turn, no second leg", "pace", "from"),
    ],
)
def test_ends_are_told_by_places_and_legs(text: str, op: str, told: str) -> None:
    (made,) = planned(text)
    assert made["op"] == op and made["when"]["during"]["part"] == told


def test_half_the_time_is_no_half_second() -> None:
    (op,) = planned("Our robot is to cover its whole route in half the time, starting when it starts now.")
    assert (op["change"], op["factor"]) == ("speed", 2.0)


def test_what_moves_is_not_hidden_where_it_waits() -> None:
    (op,) = planned("Robot idles at spawn until 1.0, then runs its full route at normal speed.")
    assert (op["op"], op["change"], op["when"]) == ("pace", "begin", {"start": 1.0})


@pytest.mark.parametrize(
    ("text", "color", "when"),
    [
        ("Wardrobe = black, permanently, no be brown again.", "black", None),
        ("Make the bed pale blue to begin with, and return it to normal when the robot starts.", "pale blue",
         {"during": {"state": "moving", "of": {"text": "robot"}, "part": "until"}}),
        ("yo make the ball go purple the whole time its rolling lol", "purple", {"during": {"state": "moving"}}),
        ("paint that door green n keep it that way", "green", None),
    ],
)  # fmt: skip
def test_the_colour_that_is_wanted_is_painted_when_it_is_wanted(
    text: str, color: str, when: dict[str, Any] | None
) -> None:
    (op,) = planned(text)
    assert (op["op"], op["color"], op.get("when")) == ("recolor", color, when)


@pytest.mark.parametrize(
    ("text", "when"),
    [
        ("Now then, might the ball wait a full two seconds before it sets off on its tour?", {"start": 2.0}),
        ("Hold that door shut till three, then swing it open, normal speed.", {"start": 3.0}),
        ("The robot may set out as late as one second, yet it must keep its appointment at the bed at four.",
         {"start": 1.0, "stop": 4.0}),
        ("When the ball has stopped, wait a full second before the robot starts.",
         {"start": 1.0, "during": {"state": "moving", "of": {"text": "ball"}, "part": "after"}}),
    ],
)  # fmt: skip
def test_what_waits_begins_when_it_has_waited(text: str, when: dict[str, Any]) -> None:
    (op,) = planned(text)
    assert (op["op"], op["change"], op.get("when")) == ("pace", "begin", when)


def test_an_event_may_be_told_as_a_cue() -> None:
    (op,) = planned("Move the bench 0.6 m towards the desk over 2 s, triggered by the door coming to rest.")
    assert op["when"] == {"lasting": 2.0, "during": {"state": "moving", "of": {"text": "door"}, "part": "after"}}


def test_a_colour_that_is_had_is_not_painted() -> None:
    assert planned("Silver would look so much classier on that robot than green.") == []


def test_all_four_things_are_no_time() -> None:
    assert planned("chairs gone, all four, we're doing standing tables now") == []
