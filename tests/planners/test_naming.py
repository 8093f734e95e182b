"""Tests of planners/grammar/naming.py: names that a scene lacks, as the ones that are meant."""

from __future__ import annotations

import pytest

from scenewright.gaussians.language.query.query import Query
from scenewright.planners.grammar.naming import named_there


def renamed(name: str, there: set[str]) -> str:
    """What the target of an operation is called in a scene of some names."""
    (op,) = named_there([{"op": "delete", "target": Query(text=name)}], lambda query: query.text not in there)
    return str(op["target"].text)


@pytest.mark.parametrize(
    ("name", "meant"),
    [("dinning table", "dining table"), ("wardobe", "wardrobe"), ("wee robot", "robot"), ("ghastly fan", "fan")],
)
def test_a_name_that_is_spelt_wrong_or_has_a_strange_adjective_is_the_one_that_is_there(name: str, meant: str) -> None:
    assert renamed(name, {meant, "bed"}) == meant


@pytest.mark.parametrize(
    "name", ["bedside lamp", "umbrella stand", "teddy bear", "wee dragon", "mirror", "garage door"]
)
def test_another_thing_than_is_there_keeps_its_name(name: str) -> None:
    assert renamed(name, {"lamp", "stand", "bear", "bed", "door"}) == name


def test_a_scene_is_not_asked_for_names_that_are_known_and_what_it_has_keeps_its_name() -> None:
    def fails(query: Query) -> bool:
        raise AssertionError("a known name is not looked for")

    ops = [
        {"op": "delete", "target": Query(text="chair")},
        {"op": "insert"},
        {"op": "delete", "target": Query(last=True)},
    ]
    assert list(named_there(ops, fails)) == ops
    assert renamed("wee robot", {"wee robot", "robot"}) == "wee robot"
