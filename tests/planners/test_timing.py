"""Words about time and motion: what they mean, and that none of them is guessed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from scenewright.planners.grammar.planner import GrammarPlanner
from scenewright.planners.grammar.timing.verbs import SENSES, forms, verbs_at

PLANNER = GrammarPlanner()
UNDERSTOOD: list[tuple[str, str, dict[str, Any]]] = [
    ("make the ball red while it is on the rug", "recolor", {"during": {"state": "on", "anchors": [{"text": "rug"}]}}),
    ("let the toy car drive to the sofa in three seconds", "move", {"lasting": 3.0}),
    ("hide the vase between second 1 and 3", "opacity", {"start": 1.0, "stop": 3.0}),
    ("ball disappears at 3.5 s", "opacity", {"start": 3.5}),
    ("turn the ball yellow for the last second", "recolor", {"start": -1.0}),
    ("stop the fan after two and a half seconds", "pace", {"start": 2.5}),
    ("the lamp should slowly rise by half a metre over two seconds", "move", {"lasting": 2.0}),
    ("vase turns blue once fan stops", "recolor", {"during": {
        "state": "moving", "of": {"text": "fan"}, "part": "after"}}),
    ("lamp goes green until the first book falls", "recolor", {"during": {
        "state": "falling", "of": {"text": "book", "moving": True, "pick": "nth", "ordinal": 1}, "part": "until"}}),
    ("close the door again after it has opened", "articulate", {"during": {"state": "opening", "part": "after"}}),
    ("paint the box white from 0 to 2.5 s, then back to normal", "recolor", {"stop": 2.5}),
    ("the light should go out at 2 s", "relight", {"start": 2.0}),
    ("turn the lamp off at 2 seconds", "relight", {"start": 2.0}),
    ("fade out the chair", "opacity", {"lasting": 2.0, "gradual": True}),
    ("a red ball appears on the table after 2 s", "insert", {"start": 2.0}),
    ("green book falls at t=3", "pace", {"start": 3.0}),
]  # fmt: skip
WITHOUT_TIME: list[tuple[str, dict[str, Any]]] = [
    ("open the door halfway", {"op": "articulate", "share": 0.5}),
    ("pull the drawer out 40 cm", {"op": "articulate", "distance": {"value": 40.0, "unit": "cm"}}),
    ("play it backwards", {"op": "pace", "change": "reverse"}),
    ("let the ball roll back", {"op": "pace", "change": "return"}),
    ("make the robot walk twice as fast", {"op": "pace", "change": "speed", "factor": 2.0}),
    ("red book falls 1 s later", {"op": "pace", "change": "later", "seconds": 1.0}),
    ("fan rpm 120", {"op": "spin", "turns_per_second": 2.0}),
    ("have the fan spin the other way round", {"op": "spin", "other_way": True}),
    ("let nothing move", {"op": "pace", "change": "stop"}),
    ("start the fan a second later", {"op": "pace", "change": "later", "seconds": 1.0}),
    ("delay the fan by half a second", {"op": "pace", "change": "later", "seconds": 0.5}),
    ("double the fan speed", {"op": "pace", "change": "speed", "factor": 2.0}),
    ("fan speed x3", {"op": "pace", "change": "speed", "factor": 3.0}),
    ("slow motion on the book, quarter speed", {"op": "pace", "change": "speed", "factor": 0.25}),
    ("remove whatever moves", {"op": "delete"}),
]
REFUSED = (
    "frobnicate the ball at 2 s",
    "make the fan spin and stand still at the same time",
    "the drawer should be open at the end",
    "the fan should run for two seconds only",
    "turn the robot by 180 degrees instead of 90 at 2 s",
)
TIMELESS = (
    "I'd like a second lamp to the left of the sofa",
    "put the bench at the end of the bed",
    "there is a gap behind the sofa, please close it",
    "delete the vase before it falls",
    "move the mug to the sink",
    "spin the office chair round to face the other way",
    "keep the sofa and remove everything else",
    "delete the chair quickly",
)


def said(op: Any) -> dict[str, Any]:
    data: dict[str, Any] = op.model_dump(mode="json", exclude_defaults=True) | {"op": op.op}
    return data


@pytest.mark.parametrize(("text", "op", "when"), UNDERSTOOD, ids=[c[0] for c in UNDERSTOOD])
def test_a_time_becomes_part_of_the_operation(text: str, op: str, when: dict[str, Any]) -> None:
    plan = PLANNER.plan(text)
    assert plan.ok, plan.reason
    (only,) = map(said, plan.ops)
    assert only["op"] == op and only["when"] == when


@pytest.mark.parametrize(("text", "meant"), WITHOUT_TIME, ids=[c[0] for c in WITHOUT_TIME])
def test_commands_about_motion_need_no_time(text: str, meant: dict[str, Any]) -> None:
    plan = PLANNER.plan(text)
    assert plan.ok, plan.reason
    (only,) = map(said, plan.ops)
    assert {k: v for k, v in only.items() if k != "target"} == meant


def test_what_moves_and_what_stands_still_are_queries() -> None:
    for text, moving in (("hide everything that moves", True), ("delete all things that stand still", False)):
        (op,) = PLANNER.plan(text).ops
        query = op.query()
        assert query is not None and query.moving is moving and query.pick == "all"


THE_SAME = (  # what a remark repeats, and how a wish is put, changes nothing
    ("start the ball 1 s later, same roll otherwise", "start the ball 1 s later"),
    ("freeze the ball from 1.5 to 2.5 s and then it just keeps rolling like nothing happened",
     "freeze the ball from 1.5 to 2.5 s"),
    ("hide the lamp so long as the book is falling, later one can see it again",
     "hide the lamp as long as the book is falling"),
    ("the door should not begin to open at 1 second but first at 3 seconds",
     "the door should begin to open at 3 seconds"),
    ("Have the car drive over to the shelf, leaving at one second and getting there at three.",
     "have the car drive over to the shelf from 1 to 3 seconds"),
    ("let the robot walk its whole way double so fast", "let the robot walk twice as fast"),
    ("starting at three seconds, the car drives to the bed", "the car drives to the bed from 3 seconds"),
    ("I'd rather the fan started a second later", "let the fan start a second later"),
    ("whatever it is thats moving, dont show it until 3 s", "do not show whatever moves until 3 s"),
    ("the book should stay up there and never fall", "the book should stay where it is"),
    ("open the door at 1 s and close again at 3 s", "open the door at 1 s and close it again at 3 s"),
    ("make the rug green, not blue", "make the rug green"),
)  # fmt: skip
PLACES = (("the book that falls first", 1), ("the last book to fall", -1), ("the second thing that moves", 2))


@pytest.mark.parametrize(("text", "plain"), THE_SAME, ids=[c[0] for c in THE_SAME])
def test_what_goes_without_saying_is_left_out(text: str, plain: str) -> None:
    long, short = PLANNER.plan(text), PLANNER.plan(plain)
    assert short.ok and long.ok, (short.reason, long.reason)
    assert [said(op) for op in long.ops] == [said(op) for op in short.ops]


def test_a_remark_that_says_more_is_not_left_out() -> None:
    for text in (
        "start the ball 1 s later, same roll but twice as fast",
        "stop the ball at 2 s, then roll it red again",
    ):
        plan = PLANNER.plan(text)
        assert not plan.ok or len(plan.ops) > 1


@pytest.mark.parametrize(("np", "place"), PLACES, ids=[c[0] for c in PLACES])
def test_things_are_counted_in_the_order_in_which_they_move(np: str, place: int) -> None:
    for text in (f"hide {np}", f"make {np} red at 2 s", f"delete {np}"):
        (op,) = PLANNER.plan(text).ops
        query = op.query()
        assert query is not None and (query.moving, query.pick, query.ordinal) == (True, "nth", place), text


@pytest.mark.parametrize("text", REFUSED)
def test_what_is_not_understood_is_refused(text: str) -> None:
    assert not PLANNER.plan(text).ok


@pytest.mark.parametrize("text", TIMELESS)
def test_words_that_only_look_like_time_mean_what_they_meant(text: str) -> None:
    assert all(op.time() is None and not op.makes_motion for op in PLANNER.plan(text).ops)


PARAPHRASES = [json.loads(line) for line in (Path(__file__).parent / "timing.jsonl").read_text().splitlines()]


def holds(meant: Any, seen: Any) -> bool:
    """Whether an operation has the fields that are meant, to a thousandth."""
    if isinstance(meant, dict):
        return isinstance(seen, dict) and all(key in seen and holds(value, seen[key]) for key, value in meant.items())
    return bool(seen == pytest.approx(meant, abs=1e-3) if isinstance(meant, float) else seen == meant)


def test_one_thing_is_said_in_many_ways() -> None:
    """Orders, wishes, statements and passives, with the words in any order; what has no meaning is refused."""
    missed = []
    for case in PARAPHRASES:
        plan = PLANNER.plan(case["text"])
        right = not plan.ok if case["op"] is None else [op.op for op in plan.ops] == [case["op"]]
        if not right or (plan.ok and not holds(case["meant"], said(plan.ops[0]))):
            missed.append(case["text"])
    assert not missed


def test_verbs_have_all_their_forms() -> None:
    assert dict(forms("carry")) == {"carry": "plain", "carries": "s", "carrying": "ing", "carried": "past"}
    assert dict(forms("slide")) == {"slide": "plain", "slides": "s", "sliding": "ing", "slid": "past"}
    assert dict(forms("stop"))["stopped"] == "past" and dict(forms("go"))["goes"] == "s"
    for sense, verbs in SENSES.items():
        for verb in verbs.split(", "):
            first, *rest = verb.split(" ")
            for form, kind in forms(first):
                found = verbs_at([form, *rest], 0)
                assert any(v.sense == sense and v.form == kind and v.said == verb for v in found), verb


WHOLE = (  # half of them would be another edit
    "roll the ball to the wall and come back",
    "the drawer should come out twice as far at 2 s",
    "make the door creak open over 4 seconds",
    "have the door open one second earlier and more slowly",
)


@pytest.mark.parametrize("text", WHOLE)
def test_nothing_is_half_done(text: str) -> None:
    plan = PLANNER.plan(text)
    assert not plan.ok and (plan.reason or plan.unknown)
