"""Fragments, questions, places and lamps in sentences about light, and what such words leave alone."""

from __future__ import annotations

from typing import Any

import pytest

from scenewright.planners.grammar.planner import GrammarPlanner

PLANNER = GrammarPlanner()


def fields(text: str) -> list[dict[str, Any]]:
    return [op.model_dump(mode="json", exclude_defaults=True) | {"op": op.op} for op in PLANNER.plan(text).ops]


@pytest.mark.parametrize(
    ("text", "light"),
    [
        ("70% brightness", {"exposure": 0.7}), ("set the brightness to 50%", {"exposure": 0.5}),
        ("quarter brightness", {"exposure": 0.25}), ("+1 EV", {"exposure": 2.0}), ("-2 stops", {"exposure": 0.25}),
        ("not so bright please", {"exposure": 0.62}), ("6am", {"mood": "sunrise"}),
        ("what would it look like by candlelight?", {"mood": "candle light"}),
        ("what if it was night time?", {"mood": "night"}), ("how would it look at dusk?", {"mood": "dusk"}),
        ("it's raining outside", {"mood": "overcast"}), ("get rid of the orange tint", {"warmth": -0.5}),
        ("brighter by 30 percent and warmer", {"exposure": 1.3, "warmth": 0.5}),
        ("cosier and down about a third", {"exposure": 0.6667, "warmth": 0.5}),
        ("a bit warmer but don't change the brightness", {"warmth": 0.25}),
    ],
)  # fmt: skip
def test_light_of_the_whole_scene(text: str, light: dict[str, Any]) -> None:
    (op,) = fields(text)
    assert op == {"op": "relight", "target": {"text": "everything", "pick": "all"}, **light}


@pytest.mark.parametrize(
    ("text", "thing", "light"),
    [
        ("the corner by the plant is too dark", "plant", {"exposure": 1.5}),
        ("twice as bright over the island", "island", {"exposure": 2.0}),
        ("can the desk get more light", "desk", {"exposure": 1.5}),
        ("reduce the glare from the window", "window", {"exposure": 0.62}),
        ("dim the floor lamp by 20%", "floor lamp", {"exposure": 0.8}),
        ("turn the left lamp off", "lamp", {"lamps": "off"}),
        ("purple light behind the tv", "tv", {"color": "purple"}),
    ],
)
def test_light_at_a_thing(text: str, thing: str, light: dict[str, Any]) -> None:
    (op,) = fields(text)
    assert op["target"]["text"] == thing
    assert {name: op.get(name) for name in light} == light


@pytest.mark.parametrize(
    "text",
    [
        "only the floor lamp on", "switch on the floor lamp and kill everything else",
        "just leave the floor lamp on, everything else off", "floor lamp on, the other lamps off",
    ],
)  # fmt: skip
def test_one_lamp_on_and_the_others_off(text: str) -> None:
    on, off = fields(text)
    assert (on["lamps"], on["target"]["text"]) == ("on", "floor lamp")
    assert (off["lamps"], off["target"]["text"], off["target"]["exclude"]) == ("off", "lamp", [{"last": True}])


@pytest.mark.parametrize(
    "text",
    [
        "what would it look like with a red sofa?", "how would the room look without the table", "put a candle here",
        "make the table under the window darker", "delete everything but the lamp", "put the pendant on the table",
        "make the sofa darker, like the rug", "make the corner sofa brighter",
        "remove the yellow light", "a bit lighter on the walls", "let's go with black on the chandelier",
    ],
)  # fmt: skip
def test_other_words_are_left_to_the_grammar(text: str) -> None:
    assert all(op["op"] != "relight" for op in fields(text))
