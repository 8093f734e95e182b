"""Rules for scenes without sure names and scale: sizes by what is beside, usual colours, an only thing, roots."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.agent.session.embedding import only_thing
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.query.wholes import rooted
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.world import kinds
from scenewright.gaussians.world.box import Box
from scenewright.tools.new_objects import AssetRequest, SceneScale, _long_vote, _usual_color, _vote
from tests.tools.test_enclosed import scene as urn_scene

AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
UP = np.array([0.0, 0.0, 1.0])


def request(kind: str, color: str | None = None, seed: int = 0) -> AssetRequest:
    return AssetRequest(kind, color, seed, SceneScale(1.0))


@pytest.mark.parametrize("seed", range(6))
def test_a_small_thing_has_a_usual_colour_and_furniture_any(seed: int) -> None:
    apple = kinds.find("apple")
    assert apple is not None and _usual_color(request("apple", seed=seed)) in apple.colors
    assert _usual_color(request("armchair", seed=seed)) is None
    assert _usual_color(request("cactus", seed=seed)) is None  # drawn as a plant in a pot, which is not green


@given(st.floats(0.01, 100.0))
def test_the_longest_side_tells_the_scale_where_the_shape_does_not(units: float) -> None:
    lying = Box((0.0, 0.0, 0.0), AXES, (0.16 * units, 0.216 * units, 0.02 * units))  # a thin book
    assert not _vote(lying, "book")
    ((value, name),) = _long_vote(lying, "book")
    assert name == "book" and np.exp(value) == pytest.approx(units, rel=0.02)
    assert not _long_vote(lying, "flumbergast") and not _long_vote(lying, "")


def group(
    i: int, bottom: float, top: float, wide: float, label: str = "", level: str = "object", x: float = 0
) -> Group:
    box = Box((x, 0.0, (bottom + top) / 2), AXES, (wide, wide, top - bottom))
    score = 0.9 if label else 0.05
    return Group(i, level, -1, label or "shower", score, box, (50.0, 0.0, 0.0), 100, 8, 1.0)  # type: ignore[arg-type]


def field_of(*groups: Group) -> LanguageField:
    rows = tuple(replace(g, id=i) for i, g in enumerate(groups))
    return LanguageField(rows, np.zeros((len(groups), 8), np.float32), "none")


def test_a_crown_goes_with_trunk_and_pot_and_not_with_what_they_stand_on() -> None:
    crown, trunk, pot = group(0, 1.0, 2.0, 1.0), group(1, 0.5, 1.1, 0.15), group(2, 0.2, 0.52, 0.6)
    table, beside = group(3, -1.0, 0.2, 3.0), group(4, 0.2, 0.5, 0.3, x=1.5)
    assert rooted(field_of(crown, trunk, pot, table, beside), 0, UP) == (1, 2)
    sure = group(2, 0.2, 0.52, 0.6, label="box")
    assert rooted(field_of(crown, trunk, sure, table), 0, UP) == (1,)  # what is known as a thing of its own stays
    assert rooted(field_of(group(0, 0.2, 1.2, 1.0), table), 0, UP) == ()


def test_an_only_thing_is_the_whole_scene() -> None:
    cloud = urn_scene().cloud
    alone = Scene(cloud, Frame(), (), field_of(group(0, 0, 1, 1, "guitar")))
    found = only_thing(alone)
    assert found is not None and found.label == "guitar"
    assert only_thing(alone.replace(language=field_of(group(0, 0, 1, 1), group(1, 0, 1, 1)))) is None
    assert only_thing(alone.replace(language=field_of(group(0, 0, 1, 1, "floor", "structure")))) is None
    assert only_thing(alone.replace(language=None)) is None
