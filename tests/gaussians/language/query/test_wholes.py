"""Plants and their pots: which words mean both, which one, and what a pot of a plant is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from boxed_things import Thing, box_of, cloud_of

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.language.encoders.backends.vectors import wrap
from scenewright.gaussians.language.field.language_field import Group, LanguageField, Names
from scenewright.gaussians.language.query.query import Query, Relation
from scenewright.gaussians.language.query.resolve import resolve
from scenewright.gaussians.language.query.selection import Selection
from scenewright.gaussians.language.query.wholes import means_both, names_plant, names_vessel, vessel_of
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.world.box import Box

UP = np.array([0.0, 0.0, 1.0])
EYE = Camera.look_at((0, -7, 1.6), (0, 0, 0.5), (0, 0, 1))
NAMES = ("potted plant", "flower pot", "cooking pot", "vase", "stool", "floor lamp")
ENCODER = wrap([["potted plant", "plant"], *([n] for n in NAMES[1:])], np.eye(len(NAMES)))
EACH = 60

CROWN: Thing = ("potted plant", (0, 0, 0.35), (0.5, 0.5, 0.9))
POT: Thing = ("flower pot", (0.03, 0, 0), (0.35, 0.35, 0.4))
OTHER_POT: Thing = ("flower pot", (2, 0, 0), (0.3, 0.3, 0.3))
STOOL: Thing = ("stool", (0, 0, 0), (0.4, 0.4, 0.35))


def scene_of(*things: Thing, names: dict[int, Names] | None = None) -> Scene:
    groups = []
    for i, thing in enumerate(things):
        own = (names or {}).get(i, ((thing[0], 0.9),))
        label, score = own[0]
        groups.append(Group(i, "object", -1, label, score, box_of(thing), (50, 0, 0), EACH, 3, 1.0, names=own))
    vectors = np.eye(len(NAMES), dtype=np.float32)[[NAMES.index(t[0]) for t in things]]
    field = LanguageField(tuple(groups), vectors, ENCODER.fingerprint)
    return Scene(cloud_of(things, EACH), Frame((0, 0, 1), 0.0, 1.0, "given", "given"), language=field)


def its(text: str, owner: str) -> Query:
    return Query(text=text, relations=(Relation(name="part_of", anchors=(Query(text=owner),)),))


def found(scene: Scene, query: Query | str) -> Selection:
    query = Query(text=query) if isinstance(query, str) else query
    return resolve(scene, query, EYE, ENCODER)


@pytest.mark.parametrize("text", ["plant", "potted plant", "houseplant", "fern", "flowers", "bonsai", "tree"])
def test_words_for_plants(text: str) -> None:
    assert names_plant(text) and not names_vessel(text)
    assert means_both(text) == (text == "potted plant")


@pytest.mark.parametrize("text", ["pot", "flower pot", "planter", "vase", "bucket"])
def test_words_for_pots(text: str) -> None:
    assert names_vessel(text) and not names_plant(text) and not means_both(text)


def test_a_potted_plant_is_the_plant_with_the_pot_that_it_stands_in() -> None:
    scene = scene_of(CROWN, POT, OTHER_POT)
    both = found(scene, "potted plant")
    assert both.verdict == "found" and both.groups == (0, 1) and "with the flower pot" in both.reason
    assert sorted(both.ids.tolist()) == list(range(2 * EACH))
    for word in ("pot", "flower pot", "planter"):
        assert found(scene, Query(text="plant", also=(its(word, "plant"),))).groups == (0, 1)
    assert found(scene, its("pot", "plant")).groups == (1,)


def test_the_plant_is_what_grows_and_the_other_reading_is_offered() -> None:
    one = found(scene_of(CROWN, POT, OTHER_POT), "plant")
    assert one.verdict == "found" and one.groups == (0,)
    assert "without the flower pot" in one.reason and "the plant with its pot" in one.reason
    alone = found(scene_of(CROWN, OTHER_POT), "plant")
    assert alone.groups == (0,) and alone.reason == ""
    told = found(scene_of(CROWN, POT), Query(text="plant", exclude=(its("pot", "plant"),)))
    assert told.groups == (0,) and "without" not in told.reason  # as was asked


def test_a_plant_without_a_pot_of_its_own_holds_what_is_seen_of_one() -> None:
    scene = scene_of(CROWN, STOOL, OTHER_POT)
    assert found(scene, "potted plant").groups == (0,)
    both = found(scene, Query(text="plant", also=(its("pot", "plant"),)))
    assert both.verdict == "found" and both.groups == (0,) and "no pot of its own" in both.reason
    assert not found(scene, its("pot", "plant")).chosen  # nothing else is taken for it


def test_each_of_several_plants_comes_with_its_own_pot() -> None:
    second: Thing = ("potted plant", (2, 0, 0.28), (0.4, 0.4, 0.5))
    scene = scene_of(CROWN, POT, second, OTHER_POT)
    assert set(found(scene, Query(text="potted plant", pick="all")).groups) == {0, 1, 2, 3}
    right = found(scene, Query(text="potted plant", pick="rightmost"))
    assert set(right.groups) == {2, 3}
    assert found(scene, "plant").verdict == "ambiguous"


def test_an_anchor_is_the_plant_alone() -> None:
    stool: Thing = ("stool", (0.6, 0, 0), (0.4, 0.4, 0.4))
    near = Query(text="stool", relations=(Relation(name="next_to", anchors=(Query(text="potted plant"),)),))
    assert found(scene_of(CROWN, POT, stool), near).groups == (2,)


def test_a_pot_may_be_named_unsurely_but_stands_below_and_is_no_larger() -> None:
    def pot_of(pot: Thing, names: Names = (("stool", 0.7), ("flower pot", 0.2))) -> int | None:
        field = scene_of(CROWN, pot, names={1: names}).language
        assert field is not None
        return vessel_of(field, 0, UP)

    assert pot_of(POT) == 1
    assert pot_of(POT, (("stool", 0.9), ("flower pot", 0.1))) is None
    assert pot_of(("flower pot", (0, 0, 0), (0.9, 0.9, 0.4))) is None  # a bed that it stands in
    assert pot_of(("flower pot", (0, 0, 0.8), (0.35, 0.35, 0.4))) is None  # hangs in its crown
    assert pot_of(("flower pot", (0.6, 0, 0), (0.35, 0.35, 0.4))) is None  # beside it
    assert pot_of(("flower pot", (0, 0, -0.4), (0.35, 0.35, 0.4))) is None  # far below


def test_pots_are_told_wherever_the_scene_is_turned() -> None:
    field = scene_of(CROWN, POT).language
    assert field is not None
    turned = ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))  # up is x

    def along(box: Box) -> Box:
        x, y, z = box.center
        return Box((z, x, y), turned, box.size)

    groups = tuple(replace(g, box=along(g.box)) for g in field.groups)
    assert vessel_of(replace(field, groups=groups), 0, np.array([1.0, 0.0, 0.0])) == 1


def test_what_nobody_names_below_a_plant_is_its_pot_only_where_it_is_asked_for() -> None:
    scene = scene_of(CROWN, STOOL, OTHER_POT, names={1: (("stool", 0.05), ("vase", 0.04))})
    asked = found(scene, Query(text="plant", also=(its("pot", "plant"),)))
    assert asked.verdict == "unconfirmed" and asked.groups == (0, 1) and "place alone" in asked.reason
    assert found(scene, its("pot", "plant")).verdict == "unconfirmed"
    assert found(scene, "potted plant").groups == (0,) == found(scene, "plant").groups
