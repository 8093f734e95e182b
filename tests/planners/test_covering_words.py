"""Commands for a material in free order, and styles of rooms, in words."""

from __future__ import annotations

from typing import Any

import pytest

from scenewright.planners.grammar.planner import GrammarPlanner


def planned(text: str) -> list[dict[str, Any]]:
    return [o.model_dump(mode="json", exclude_defaults=True) | {"op": o.op} for o in GrammarPlanner().plan(text).ops]


@pytest.mark.parametrize(
    ("text", "target", "material", "more"),
    [
        ("sofa in brown leather", "sofa", "leather", {}),
        ("I'd like the counter to be white marble with grey veins please", "counter", "marble", {"second": "grey"}),
        ("put big tiles on the floor, 60 by 60, light gray", "floor", "tiles", {"unit": {"value": 60.0, "unit": "cm"}}),
        ("put the curtain in linen, off white", "curtain", "fabric", {"color": "off white"}),
        ("change the nightstands to rattan", "nightstand", "wicker", {}),
        ("stainless steel fridge", "fridge", "metal", {}),
        ("wallpaper the wall with something floral, not too busy", "wall", "floral", {}),
        ("the bench should be from oak", "bench", "wood", {}),
        ("would the coffee table look nicer in walnut?", "coffee table", "wood", {}),
        ("could the stool be made of brass", "stool", "gold", {}),
        ("cover the armchair in dark green velvet", "armchair", "velvet", {"color": "dark green"}),
        ("polished concrete on the floor", "floor", "concrete", {}),
    ],
)
def test_a_material_in_free_order(text: str, target: str, material: str, more: dict[str, Any]) -> None:
    (op,) = planned(text)
    assert (op["op"], op["target"]["text"], op["material"]) == ("restyle", target, material)
    assert more.items() <= op.items()


def test_several_in_one_sentence() -> None:
    first, second = planned("brick on the left wall, and the right wall just plain white")
    assert (first["op"], first["material"], first["target"]["pick"]) == ("restyle", "brick", "leftmost")
    assert (second["op"], second["color"], second["target"]["pick"]) == ("recolor", "white", "rightmost")


@pytest.mark.parametrize(
    ("text", "op"),
    [
        ("paint the lamp gold", "recolor"),
        ("make the chair green", "recolor"),
        ("replace the rug with a carpet", "replace"),
        ("put the boards on the table", "move"),
        ("delete the leather sofa", "delete"),
        ("move the wooden chair to the left", "move"),
        ("add a glass vase", "insert"),
        ("replace the mug with a glass", "replace"),
    ],
)
def test_other_commands_stay(text: str, op: str) -> None:
    assert planned(text)[0]["op"] == op


@pytest.mark.parametrize(
    ("text", "target", "style"),
    [
        ("a rustic look", "everything", "rustic"),
        ("make the kitchen industrial", "everything", "industrial"),
        ("give the room a scandinavian look", "everything", "scandinavian"),
        ("mid-century modern whole bedroom, go", "everything", "vintage"),
        ("japandi vibe for the whole thing", "everything", "japanese"),
        ("give the sofa a rustic look", "sofa", "rustic"),
    ],
)
def test_styles(text: str, target: str, style: str) -> None:
    (op,) = planned(text)
    assert (op["op"], op["target"]["text"], op["style"]) == ("restyle", target, style)


@pytest.mark.parametrize(
    "text", ["make the room dark", "make the room warm", "is it made of wood?", "put flowers on the table"]
)
def test_what_is_no_style_or_material_is_none(text: str) -> None:
    assert not any(op["op"] == "restyle" for op in planned(text))
