"""What the words of an instruction say for or against a step, and how a plan compares with the grammar's reading."""

from __future__ import annotations

from typing import Any

import pytest

from scenewright.benchmarks import _written
from scenewright.planners.grammar import GrammarPlanner
from scenewright.planners.model.verify.guard import Guard
from scenewright.planners.model.verify.said import Said
from scenewright.planners.model.verify.second_reading import alike
from scenewright.planners.plan import EditPlan, Observation
from scenewright.tools.registry import parse

ROOM = _written.stage("living_room").graph


class Reads:
    """A grammar that reads noun phrases, and no instruction: what a model is asked for."""

    name = "noun phrases"

    def __init__(self) -> None:
        self._grammar = GrammarPlanner()

    def plan(self, text: str, *, previous: str | None = None, observation: Observation | None = None) -> EditPlan:
        if text.startswith("select "):
            return self._grammar.plan(text)
        return EditPlan(instruction=text, planner=self.name, verdict="not_understood", reason="not read")


def step(name: str, thing: Any, **fields: Any) -> Any:
    target = {"text": thing} if isinstance(thing, str) else {"groups": thing, "pick": "all"}
    return parse({"op": name, "target": target, **fields})


def kinds(text: str, *ops: Any, recall: Any = None) -> set[str]:
    guard = Guard(text, None, ROOM, recall or Reads())
    return {f.kind for f in guard.faults(guard.drop_unstated(ops))}


ON_SOFA = {"relation": "on", "anchors": [{"text": "sofa"}]}
UNDER_SOFA = {"relation": "under", "anchors": [{"text": "sofa"}]}
ON_RUG = {"relation": "on", "anchors": [{"text": "rug"}]}
M = {"unit": "m"}


@pytest.mark.parametrize(
    ("text", "right", "wrong"),
    [
        ("the rug, in teal please", step("recolor", "rug", color="teal"), step("recolor", "rug", color="red")),
        ("the clock a foot further up", step("move", "clock", direction="up"), step("move", "clock", direction="down")),
        ("the mug wants to be on the sofa", step("move", "mug", place=ON_SOFA), step("move", "mug", place=ON_RUG)),
        ("mug on the sofa, quick", step("move", "mug", place=ON_SOFA), step("move", "mug", place=UNDER_SOFA)),
        ("bookshelf, thirty degrees clockwise", step("rotate", "bookshelf", degrees=-30),
         step("rotate", "bookshelf", degrees=30)),
        ("bookshelf, thirty degrees round", step("rotate", "bookshelf", degrees=30),
         step("rotate", "bookshelf", degrees=60)),
        ("the vase half as tall", step("scale", "vase", factor=0.5), step("scale", "vase", factor=2.0)),
        ("the sofa 40 cm over to the left", step("move", "sofa", direction="left", distance={"value": 0.4, **M}),
         step("move", "sofa", direction="left", distance={"value": 4, **M})),
        ("rug out, please", step("delete", "rug"), step("delete", "television")),
        ("rug out, please", step("delete", "rug"), step("duplicate", "rug")),
        ("no rug here, thanks", step("delete", "rug"), step("delete", "clock")),
        ("the blue cushion away with it", step("delete", [14]), step("delete", [14, 15])),
        ("delete all the cushions but the blue one", step("delete", [15, 16]), step("delete", [14, 15, 16])),
        ("I'd like the vase removed", step("delete", "vase"), step("opacity", "vase", value=0.0)),
    ],
)  # fmt: skip
def test_words_speak_for_the_right_step_and_against_the_wrong_one(text: str, right: Any, wrong: Any) -> None:
    assert "unasked" not in kinds(text, right) and "groundless" not in kinds(text, right)
    assert {"unasked", "groundless"} & kinds(text, wrong)


@pytest.mark.parametrize("more", [step("move", "floor lamp", direction="left"), step("scale", "rug", factor=2)])
def test_a_step_beyond_what_is_said_is_a_fault(more: Any) -> None:
    assert "unasked" in kinds("rug out, please", step("delete", "rug"), more)


def test_a_turn_of_which_nobody_says_the_way_counts_as_positive() -> None:
    guard = Guard("turn the sofa by 30 degrees", None, ROOM, GrammarPlanner())
    (settled,) = guard.drop_unstated([step("rotate", "sofa", degrees=-30)])
    assert settled == step("rotate", "sofa", degrees=30)
    said = Guard("turn the sofa by 30 degrees clockwise", None, ROOM, GrammarPlanner())
    assert said.drop_unstated([step("rotate", "sofa", degrees=-30)]) == (step("rotate", "sofa", degrees=-30),)


# The grammar's reading ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "ops",
    [
        [step("delete", [14]), step("delete", [15, 16])],
        [step("delete", [14, 15, 16])],
        [step("select", [14]), step("delete", [14, 15, 16])],
    ],
)
def test_the_same_said_in_other_steps_agrees(ops: list[Any]) -> None:
    assert not kinds("delete all the cushions", *ops, recall=GrammarPlanner())


@pytest.mark.parametrize(
    ("text", "ops", "kind"),
    [
        ("delete the cushions", [step("delete", [14, 15])], "missing"),
        ("paint the sofa red and delete the rug", [step("recolor", "sofa", color="red")], "missing"),
        ("paint the sofa red", [step("recolor", "sofa", color="blue")], "unasked"),
        ("paint the sofa red", [step("delete", "sofa")], "unasked"),
        ("move the sofa 40 cm left", [step("move", "sofa", direction="left", distance={"value": 1, **M})], "unasked"),
        ("select the clock", [step("select", "vase")], "unasked"),
    ],
)
def test_what_differs_from_a_reading_is_a_fault(text: str, ops: list[Any], kind: str) -> None:
    assert kind in kinds(text, *ops, recall=GrammarPlanner())


@pytest.mark.parametrize(("one", "other"), [("navy blue", "navy"), ("crimson", "red"), ("grey", "gray")])
def test_words_for_one_colour(one: str, other: str) -> None:
    assert alike(one, other)


@pytest.mark.parametrize(("one", "other"), [("red", "blue"), ("black", "navy"), ("white", "yellow")])
def test_words_for_two_colours(one: str, other: str) -> None:
    assert not alike(one, other)


def test_an_instruction_too_long_for_the_grammar_speaks_against_nothing() -> None:
    said = Said("delete the vase " * 200)
    assert not list(said.against(step("delete", "rug"), False))
