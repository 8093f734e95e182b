"""Descriptions of things: those with certain names are counted by name, the others by number only."""

from __future__ import annotations

from dataclasses import replace

from scenewright.agent.terminal.thing_names import NAME_THRESHOLD, describe_things, name_of_thing
from scenewright.gaussians.scene import Scene


def test_sure_names_are_counted_and_the_rest_is_not_named(boxes: Scene) -> None:
    assert boxes.language is not None
    one, two, three = boxes.language.objects()
    unsure = replace(three, label="umbrella", label_score=NAME_THRESHOLD / 2)
    assert name_of_thing(unsure) == "unnamed thing"
    assert describe_things([one, two, unsure]) == "2 things: box ×2; 1 more without a sure name"
    assert describe_things([unsure]) == "1 thing, none with a sure name"
    assert describe_things([one]) == "1 thing: box"
    assert describe_things([]) == "no things"
