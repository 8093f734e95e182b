"""What an instruction says stays as it is, ends that are earlier or later, notations, and a time for each part."""

from __future__ import annotations

from typing import Any

import pytest

from scenewright.gaussians.language.query.query import Query
from scenewright.planners.grammar.parsing import Refusal
from scenewright.planners.grammar.planner import GrammarPlanner
from scenewright.planners.grammar.timing.ending import with_end
from scenewright.planners.grammar.timing.keeping import Kept, held, kept_by, without_kept
from scenewright.planners.grammar.timing.spoken import written
from scenewright.planners.plan import Movement
from scenewright.tools.when import During, When

PLANNER = GrammarPlanner()
FAN, DOOR = Query(text="fan"), Query(text="door")
MOVES = {"fan": Movement(0.0, 4.0, True), "door": Movement(1.0, 2.5, False)}


def movement(query: Query) -> Movement | None:
    return MOVES.get(query.text)


def pace(target: Query, change: str, **more: Any) -> dict[str, Any]:
    return {"op": "pace", "target": target, "change": change, **more}


def planned(text: str) -> list[dict[str, Any]]:
    return [op.model_dump(exclude_defaults=True, mode="json") | {"op": op.op} for op in PLANNER.plan(text).ops]


@pytest.mark.parametrize(
    ("text", "rest"),
    [
        ("make the door open half as fast, still starting at 1 s", "make the door open half as fast"),
        (
            "Delay the roll of the ball by one second without altering its speed.",
            "delay the roll of the ball by one second",
        ),
        ("robot twice as fast, start stays at 0.2", "robot twice as fast"),
    ],
)
def test_what_stays_is_cut_out(text: str, rest: str) -> None:
    asked, kept = without_kept(text)
    assert asked.strip(" ,.") == rest and kept


@pytest.mark.parametrize(
    "text", ["keep the drawer open", "the red book should stay on the shelf", "leave the door as it is until 2 s"]
)
def test_what_is_asked_to_stay_is_no_remark(text: str) -> None:
    assert without_kept(text) == (text, ())


@pytest.mark.parametrize(
    ("said", "kept"),
    [
        ("still starting at 1 s", Kept(frozenset({"start"}), 1.0, None, "still starting at 1 s")),
        ("still off at 4", Kept(frozenset({"stop"}), None, 4.0, "still off at 4")),
        ("same speed", Kept(frozenset({"speed"}), said="same speed")),
        ("the green book falls as now", Kept(frozenset(), said="the green book falls as now")),
    ],
)
def test_what_stays_is_told(said: str, kept: Kept) -> None:
    assert kept_by(said) == kept


def test_a_plan_in_which_everything_stays_is_left_alone() -> None:
    ops = [pace(DOOR, "speed", factor=2.0)]
    assert held(ops, [kept_by("its start stays")], movement) == tuple(ops)
    turning = [pace(FAN, "speed", factor=2.0)]  # it turns faster until the same time
    assert held(turning, [kept_by("it still stops at 4 s")], movement) == tuple(turning)


@pytest.mark.parametrize(
    ("op", "said", "when"),
    [
        (pace(DOOR, "speed", factor=2.0), "still finishing at the same time", When(start=1.75, stop=2.5)),
        (pace(DOOR, "begin", when=When(start=2.0)), "the end stays as it is", When(start=2.0, stop=2.5)),
        (pace(DOOR, "begin", when=When(lasting=0.5)), "still done at 2.5", When(start=2.0, stop=2.5)),
        (pace(DOOR, "begin", when=When(lasting=0.5)), "start still at 1.2", When(start=1.2, lasting=0.5)),
    ],
)
def test_a_plan_is_made_so_that_it_stays(op: dict[str, Any], said: str, when: When) -> None:
    (made,) = held([op], [kept_by(said)], movement)
    assert (made["change"], made["when"]) == ("begin", when)


@pytest.mark.parametrize(
    ("op", "said"),
    [
        (pace(DOOR, "speed", factor=2.0), "at the same speed as now"),
        (pace(DOOR, "later", seconds=1.0), "its start is not to change"),
        (pace(DOOR, "stop", when=When(start=2.0)), "it still ends when it does now"),
        (pace(DOOR, "speed", factor=2.0), "start and end stay the same"),
    ],
)
def test_what_contradicts_itself_is_refused(op: dict[str, Any], said: str) -> None:
    with pytest.raises(Refusal, match="stay"):
        held([op], [kept_by(said)], movement)


@pytest.mark.parametrize(
    ("said", "target", "seconds", "change", "when"),
    [
        ("let the fan stop two seconds earlier", FAN, -2.0, "stop", When(start=2.0)),
        ("let the fan stop one second later", FAN, 1.0, "go_on", When(stop=5.0)),
        (
            "the door should be done half a second earlier, finishing sooner",
            DOOR,
            -0.5,
            "begin",
            When(start=1.0, stop=2.0),
        ),
        ("the door should come to a halt half a second earlier", DOOR, -0.5, "stop", When(start=2.0)),
    ],
)
def test_an_end_is_moved(said: str, target: Query, seconds: float, change: str, when: When) -> None:
    (made,) = with_end(said, [pace(target, "later", seconds=seconds)], movement)
    assert (made["change"], made["when"]) == (change, when)


@pytest.mark.parametrize("said", ["let the door start one second earlier", "everything one second earlier"])
def test_a_beginning_is_no_end(said: str) -> None:
    ops = (pace(DOOR, "later", seconds=-0.5),)
    assert with_end(said, ops, movement) == ops
    assert (
        with_end("let it stop one second earlier", (pace(Query(text="sofa"), "later", seconds=-1.0),), movement)[0][
            "change"
        ]
        == "later"
    )  # what stands still has no end


@pytest.mark.parametrize(
    ("spoken", "plain"),
    [
        ("hide the lamp for 800 ms", "hide the lamp for 0.8 s"),
        ("spin it at 90 rpm", "spin it at 1.5 turns per second"),
        ("Lamp hidden in the interval [0.5 s, 1.5 s]", "Lamp hidden from 0.5 s to 1.5 s"),
        ("no wardrobe 2.0-4.0", "no wardrobe from 2.0 s to 4.0 s"),
        ("hide it between 1,5 and 3 s", "hide it between 1.5 and 3 s"),
        ("TC-01: paint it red", "paint it red"),
        ("spin it at 3 turns/s", "spin it at 3 turns per second"),
        ("move it to 1, 2 and 3", "move it to 1, 2 and 3"),
        ("please remove the rack from the hall.", "please remove the rack"),
    ],
)
def test_notations_are_put_in_words(spoken: str, plain: str) -> None:
    assert written(spoken) == plain


def test_each_part_has_its_own_time() -> None:
    first, second = planned("hide the bed from 1 to 2 s. Make the shelf blue from 2 to 4 s.")
    assert (first["when"], second["when"]) == ({"start": 1.0, "stop": 2.0}, {"start": 2.0, "stop": 4.0})
    removed, hidden = planned("delete the bed, and hide the shelf from 1 to 2 s")
    assert "when" not in removed and hidden["when"] == {"start": 1.0, "stop": 2.0}
    slowed, begun = planned("slow the robot down by half and start it at 1 s")
    assert "when" not in slowed and begun["when"] == {"start": 1.0}
    shelf, bed = planned("hide the shelf from 1 to 2 s and the bed from 2 to 3 s")
    assert (shelf["target"], shelf["when"]) == ({"text": "shelf"}, {"start": 1.0, "stop": 2.0})
    assert (bed["target"], bed["when"]) == ({"text": "bed"}, {"start": 2.0, "stop": 3.0})


def test_what_is_closed_is_not_what_has_closed() -> None:
    (op,) = planned("paint the door red while it is closed")
    assert op["when"]["during"] == During(state="open", part="unless").model_dump(exclude_defaults=True, mode="json")


@pytest.mark.parametrize(
    ("text", "amount"),
    [
        ("have the vase make a quarter turn on the spot from 3 to 4", {"degrees": 90.0}),
        ("In the last second, two full spins on the spot for the toy car.", {"turns": 2.0}),
        ("vase does 1 full turn, 0.5 to 1.5 s", {"turns": 1.0}),
    ],
)
def test_how_far_something_turns(text: str, amount: dict[str, float]) -> None:
    (op,) = planned(text)
    assert op["op"] in ("spin", "rotate") and amount.items() <= op.items()


def test_as_fast_is_no_slower() -> None:
    (op,) = planned("The robot feels slow to our testers, so please make it one and a half times as fast.")
    assert op["factor"] == 1.5


@pytest.mark.parametrize(
    ("text", "metres"), [("stop the ball after two metres", 2.0), ("halt the ball after 1.5 m", 1.5)]
)
def test_what_stops_after_a_length_goes_so_far(text: str, metres: float) -> None:
    (op,) = planned(text)
    assert (op["change"], op["distance"]["value"]) == ("part", metres)


def test_two_sentences_have_two_times() -> None:
    first, second = planned("hide the bed at 1 s. Hide the shelf at 2 s.")
    assert (first["when"], second["when"]) == ({"start": 1.0}, {"start": 2.0})
    assert second["target"]["text"] == "shelf"
