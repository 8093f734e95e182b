"""What people say of light, and what sounds like it and means something else."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from scenewright.planners.grammar.planner import GrammarPlanner
from scenewright.planners.plan import EditPlan

SENTENCES = [json.loads(line) for line in (Path(__file__).parent / "sentences.jsonl").read_text().splitlines()]
EVERYTHING = {"text": "everything", "pick": "all"}


def plan(text: str, previous: str | None = None) -> EditPlan:
    return GrammarPlanner().plan(text, previous=previous)


def fields(text: str, previous: str | None = None) -> list[dict[str, Any]]:
    return [op.model_dump(mode="json", exclude_defaults=True) | {"op": op.op} for op in plan(text, previous).ops]


@pytest.mark.parametrize("case", SENTENCES, ids=lambda c: c["text"])
def test_a_sentence_about_light(case: dict[str, Any]) -> None:
    target = case.get("target", EVERYTHING)
    (op,) = fields(case["text"])
    assert op == {"op": "relight", "target": target, **case["light"]}


@pytest.mark.parametrize(
    ("text", "previous"),
    [
        ("make the sofa brighter", None), ("make the lamp warmer", None), ("make it darker", "paint the sofa teal"),
        ("a bit brighter", "make the sofa red"), ("make the light blue chair red", None),
        ("paint the walls light grey", None), ("remove the light", None), ("add a lamp to the desk", None),
        ("move the light to the left", None), ("turn the lamp 90 degrees", None), ("turn the red light green", None),
        ("make the light green", None), ("put the candle on the table", None), ("delete the night light", None),
        ("switch the lamp with the vase", None), ("lower the lamp by 20 cm", None), ("make the windows darker", None),
        ("make the moonlight poster bigger", None), ("make the sunflowers brighter", None), ("hide the moon", None),
        ("lower the light by 20 cm", None), ("make the dark chair lighter", None),
    ],
)  # fmt: skip
def test_things_are_still_edited(text: str, previous: str | None) -> None:
    found = fields(text, previous)
    assert found and all(op["op"] != "relight" for op in found)


@pytest.mark.parametrize(
    ("text", "verdict"),
    [
        ("switch on the TV", "impossible"), ("turn off the television", "impossible"),
        ("turn the fan on", "impossible"), ("is the lamp on?", "not_an_edit"),
        ("how bright is the room?", "not_an_edit"), ("don't turn on the lamp", "not_an_edit"),
        ("the room is bright", "not_an_edit"), ("what a lovely evening", "not_an_edit"),
        ("I like the warm light", "not_an_edit"), ("darker", "not_understood"), ("light", "not_understood"),
    ],
)  # fmt: skip
def test_other_verdicts_stay(text: str, verdict: str) -> None:
    assert plan(text).verdict == verdict


def test_light_among_other_edits() -> None:
    first, second = fields("switch on the floor lamp next to the sofa and make the rug red")
    assert (first["op"], first["lamps"], first["target"]["text"]) == ("relight", "on", "floor lamp")
    assert (second["op"], second["target"]["text"], second["color"]) == ("recolor", "rug", "red")
    first, second = fields("delete the chair, then make it evening")
    assert (first["op"], second["op"], second["mood"]) == ("delete", "relight", "evening")


def test_a_remark_is_said_once() -> None:
    (op,) = fields("It's way too bright in this room, tone it down by a third")
    assert op["exposure"] == pytest.approx(2 / 3, abs=1e-3)


def test_light_goes_on_after_light() -> None:
    (op,) = fields("make it a bit warmer", "make the room brighter")
    assert (op["op"], op["warmth"]) == ("relight", 0.25)


@pytest.mark.parametrize("said", ["good morning!", "Good evening everyone", "hello, good day", "good night"])
def test_a_greeting_is_no_light(said: str) -> None:
    assert not GrammarPlanner().plan(said).ok


def test_a_lamp_that_is_switched_is_no_place_of_the_light_behind_it() -> None:
    planned = GrammarPlanner().plan("switch the lamp on, and a cosy evening light please, a third darker")
    assert [(op.op, op.target.text) for op in planned.ops] == [("relight", "lamp"), ("relight", "everything")]
