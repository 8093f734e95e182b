"""What instructions say of the material of another thing or of a photograph, and of the size of what repeats."""

from __future__ import annotations

from typing import Any

import pytest

from scenewright.planners.grammar.planner import GrammarPlanner


def planned(text: str, previous: str | None = None) -> list[dict[str, Any]]:
    plan = GrammarPlanner().plan(text, previous=previous)
    return [op.model_dump(mode="json", exclude_defaults=True) | {"op": op.op} for op in plan.ops]


@pytest.mark.parametrize(
    ("text", "target", "source", "material"),
    [
        ("give the sofa the pattern of the curtain", "sofa", "curtain", None),
        ("put the pattern of the rug on the armchair", "armchair", "rug", None),
        ("the pattern of the curtain on the sofa", "sofa", "curtain", None),
        ("I want the bookshelf in wood like the table", "bookshelf", "table", "wood"),
        ("make the chair the same material as the door", "chair", "door", None),
        ("the sofa in the fabric of the armchair please", "sofa", "armchair", "fabric"),
        ("can you make the desk out of the same wood as the bookcase?", "desk", "bookcase", "wood"),
        ("copy the texture of the floor onto the coffee table", "coffee table", "floor", None),
        ("cover the armchair with the curtain's fabric", "armchair", "curtain", "fabric"),
        ("the bench should have the same finish as the table", "bench", "table", None),
        ("I want the curtains to have the same pattern as the bedspread", "curtain", "bedspread", None),
        ("take the pattern of the rug and put it on the chair", "chair", "rug", None),
    ],
)
def test_a_thing_gets_the_surface_of_another(text: str, target: str, source: str, material: str | None) -> None:
    (op,) = planned(text)
    assert op["op"] == "restyle"
    assert op["target"]["text"] == target
    assert op["like"]["text"] == source
    assert op.get("material") == material


@pytest.mark.parametrize(
    ("text", "target", "more"),
    [
        ("make the sofa like in the photo", "sofa", {}),
        ("the sofa like in the photo", "sofa", {}),
        ("cover the floor with the photo", "floor", {}),
        ("upholster the armchair in the fabric from this picture", "armchair", {"material": "fabric"}),
        ("use bricks.jpg for the wall", "wall", {"reference": "bricks.jpg"}),
        ("cover the sofa with fabric_03.png", "sofa", {"reference": "fabric_03.png"}),
        ("use the photo for the floor, it is 50 cm wide", "floor", {"width": {"value": 50.0, "unit": "cm"}}),
        ("put the 20 cm tiles from the photo on the floor", "floor", {"unit": {"value": 20.0, "unit": "cm"}}),
    ],
)
def test_a_thing_gets_the_surface_of_a_photograph(text: str, target: str, more: dict[str, Any]) -> None:
    (op,) = planned(text)
    assert op["op"] == "restyle"
    assert op["target"]["text"] == target
    assert {"reference": "photo", **more}.items() <= op.items()


def test_a_photograph_as_wallpaper_of_one_wall() -> None:
    (op,) = planned("use this photo as wallpaper on the left wall")
    assert op == {"op": "restyle", "target": {"text": "wall", "pick": "leftmost"}, "reference": "photo"}


@pytest.mark.parametrize(
    ("text", "material", "value", "unit"),
    [
        ("make the floor 20 cm tiles", "tiles", 20.0, "cm"),
        ("cover the floor with 60x60 cm tiles", "tiles", 60.0, "cm"),
        ("10 cm wide stripes on the sofa", "stripes", 10.0, "cm"),
        ("give the wall red and white stripes 20 cm wide", "stripes", 20.0, "cm"),
    ],
)
def test_the_length_of_what_repeats(text: str, material: str, value: float, unit: str) -> None:
    (op,) = planned(text)
    assert (op["op"], op["material"], op["unit"]) == ("restyle", material, {"value": value, "unit": unit})


def test_it_and_several_steps() -> None:
    (op,) = planned("make it the same material as the door", "move the chair to the left")
    assert op == {"op": "restyle", "target": {"last": True}, "like": {"text": "door"}}
    first, second = planned("delete the lamp and give the sofa the pattern of the rug")
    assert (first["op"], second["op"], second["like"]["text"]) == ("delete", "restyle", "rug")


@pytest.mark.parametrize(
    ("text", "op"),
    [
        ("paint the chair the same colour as the table", "recolor"),
        ("put the picture on the left wall", "move"),
        ("put the cloth of the table on the floor", "move"),
        ("move the photo to the left", "move"),
        ("delete the tiles from the wall", "delete"),
    ],
)
def test_other_commands_stay(text: str, op: str) -> None:
    assert planned(text)[0]["op"] == op


@pytest.mark.parametrize(
    "text", ["is the sofa of the same material as the armchair?", "the sofa has the same pattern as the curtain"]
)
def test_what_asks_for_nothing_changes_nothing(text: str) -> None:
    assert planned(text) == []
