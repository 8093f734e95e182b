"""Steps that nobody asked for are faults of a model's plan; right plans in odd words are none."""

from __future__ import annotations

from typing import Any

import pytest

from scenewright.benchmarks import _written
from scenewright.planners.grammar import GrammarPlanner
from scenewright.planners.model.verify.guard import Guard
from scenewright.tools.registry import parse

ROOM = _written.stage("living_room").graph


def step(name: str, thing: str, **fields: Any) -> Any:
    return parse({"op": name, "target": {"text": thing}, **fields})


def kinds(text: str, *ops: Any) -> set[str]:
    return {f.kind for f in Guard(text, None, ROOM, GrammarPlanner()).faults(ops)}


@pytest.mark.parametrize(
    ("text", "ops"),
    [
        ("delete the rug", [step("delete", "rug"), step("move", "floor lamp", direction="left")]),
        ("delete the rug", [step("delete", "television")]),
        ("paint the sofa red", [step("recolor", "sofa", color="red"), step("scale", "sofa", factor=2)]),
        ("add a lamp next to the sofa", [parse({"op": "insert", "asset": "lamp", "count": 4})]),
    ],
)
def test_what_nobody_asked_for_is_a_fault(text: str, ops: list[Any]) -> None:
    assert "unasked" in kinds(text, *ops)


@pytest.mark.parametrize("text", ["rug out, please", "I never want to see that rug again", "no rug here, thanks"])
def test_odd_words_for_a_removal_are_enough(text: str) -> None:
    assert not kinds(text, step("delete", "rug")) & {"groundless", "unasked"}


@pytest.mark.parametrize("text", ["move the rug over to the left", "paint the rug red, not blue"])
def test_another_verb_is_no_removal(text: str) -> None:
    assert "groundless" in kinds(text, step("delete", "rug"))


def test_other_languages_are_left_to_the_words_of_removal() -> None:
    assert "unasked" not in kinds("mach das Sofa rot", step("recolor", "sofa", color="red"))
