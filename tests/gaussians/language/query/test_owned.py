"""Names of parts with their whole: "the wardrobe door" is a door that belongs to a wardrobe, never the room's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from boxed_things import Thing, box_of, cloud_of

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.language.encoders.backends.vectors import wrap
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.query.query import Query, Relation
from scenewright.gaussians.language.query.resolve import resolve
from scenewright.gaussians.language.query.selection import Selection
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.world.compounds import same_thing, split

EYE = Camera.look_at((0, -7, 1.6), (0, 0, 0.5), (0, 0, 1))
NAMES = ("wall", "door", "wardrobe", "fridge", "dresser", "drawer", "nightstand", "cabinet", "car", "wheel", "sofa",
         "cushion", "tv stand", "desk lamp", "bookshelf", "bin", "lid")  # fmt: skip
ENCODER = wrap([["fridge", "refrigerator"] if n == "fridge" else [n] for n in NAMES], np.eye(len(NAMES)))
EACH = 60

WALL: Thing = ("wall", (0, 2.0, 0), (4, 0.1, 2.6))
ROOM_DOOR: Thing = ("door", (-1.2, 1.95, 0), (0.9, 0.08, 2.0))
WARDROBE: Thing = ("wardrobe", (0, 1.6, 0), (1.2, 0.6, 2.0))  # 15 cm beside the door of the room
ITS_DOOR: Thing = ("door", (-0.3, 1.29, 0.05), (0.6, 0.03, 1.9))
ITS_OPEN_DOOR: Thing = ("door", (-0.6, 0.98, 0.05), (0.03, 0.6, 1.9))
DRESSER: Thing = ("dresser", (1.3, 1.7, 0), (0.9, 0.5, 0.75))
ITS_DRAWER: Thing = ("drawer", (1.3, 1.65, 0.5), (0.85, 0.45, 0.2))
NIGHTSTAND: Thing = ("nightstand", (2.0, 1.7, 0), (0.45, 0.4, 0.55))  # touches the dresser
ITS_OWN_DRAWER: Thing = ("drawer", (2.0, 1.68, 0.35), (0.42, 0.36, 0.15))
FRIDGE: Thing = ("fridge", (-3, 1.6, 0), (0.6, 0.6, 1.8))
BIN: Thing = ("bin", (3, -1, 0), (0.3, 0.3, 0.5))
ITS_LID: Thing = ("lid", (3, -1, 0.5), (0.3, 0.3, 0.05))


def scene_of(*things: Thing, named_by: str = "", parents: dict[int, int] | None = None) -> Scene:
    groups = []
    for i, thing in enumerate(things):
        label, parent = thing[0], (parents or {}).get(i, -1)
        level = "structure" if label == "wall" else "part" if parent >= 0 else "object"
        groups.append(Group(i, level, parent, label, 0.9, box_of(thing), (50, 0, 0), EACH, 3, 1.0, named_by=named_by))
    vectors = np.zeros((len(things), len(NAMES)), dtype=np.float32)
    for i, (label, *_) in enumerate(things):
        if label in NAMES:
            vectors[i, NAMES.index(label)] = 1
    field = LanguageField(tuple(groups), vectors, ENCODER.fingerprint)
    return Scene(cloud_of(things, EACH), Frame((0, 0, 1), 0.0, 1.0, "given", "given"), language=field)


def found(scene: Scene, query: Query | str, pick: str = "one") -> Selection:
    query = Query(text=query, pick=pick) if isinstance(query, str) else query
    return resolve(scene, query, EYE, ENCODER)


def its(text: str, owner: str) -> Query:
    return Query(text=text, relations=(Relation(name="part_of", anchors=(Query(text=owner),)),))


@pytest.mark.parametrize(
    ("name", "whole", "part"),
    [
        ("wardrobe door", "wardrobe", "door"), ("kitchen cabinet door", "kitchen cabinet", "door"),
        ("refrigerator doors", "refrigerator", "door"), ("oven door", "oven", "door"),
        ("washing machine door", "washing machine", "door"), ("car door", "car", "door"),
        ("car wheel", "car", "wheel"), ("toy car wheel", "toy car", "wheel"), ("desk drawer", "desk", "drawer"),
        ("coffee table leg", "coffee table", "leg"), ("lamp shade", "lamp", "shade"), ("bin lid", "bin", "lid"),
        ("wardrobe door handle", "wardrobe door", "handle"), ("car window", "car", "window"),
        ("wardrobe shelf", "wardrobe", "shelf"),
    ],
)  # fmt: skip
def test_a_part_with_its_whole_before_it(name: str, whole: str, part: str) -> None:
    compound = split(name)
    assert compound is not None and (compound.whole, compound.part) == (whole, part)


@pytest.mark.parametrize(
    "name",
    [
        "door", "kitchen door", "front door", "garage door", "bathroom door", "living room door", "bedroom window",
        "oak door", "glass door", "wooden door", "sliding door", "trap door", "screen door", "toilet door", "bar door",
        "desk lamp", "table lamp", "bed lamp", "door frame", "book shelf", "wall shelf", "plant shelf", "shoe shelf",
        "sofa cushion", "tv stand", "toy car", "window seat", "car seat", "sock drawer", "cutlery drawer",
        "steering wheel", "chest of drawers", "table with drawers", "wine glass", "",
    ],
)  # fmt: skip
def test_places_materials_and_kinds_of_their_own_are_no_wholes(name: str) -> None:
    assert split(name) is None


def test_two_names_for_one_thing() -> None:
    assert same_thing("fridge", "refrigerator") and same_thing("cupboard", "cabinet")
    assert not same_thing("fridge", "wardrobe") and not same_thing("sled", "wardrobe")


@pytest.mark.parametrize("text", ["wardrobe door", "fridge door", "oven door", "cabinet door", "car door"])
@pytest.mark.parametrize("named_by", ["", "user"])
def test_the_door_of_the_room_is_that_of_no_thing(text: str, named_by: str) -> None:
    scene = scene_of(WALL, ROOM_DOOR, WARDROBE, named_by=named_by)
    assert found(scene, "door").groups == (1,)
    missing = found(scene, text)
    assert missing.verdict == "absent" and f"the {text} is not in this scene" in missing.reason
    assert "door (group 1)" in missing.reason
    assert found(scene, text, "all").verdict == "absent"


@pytest.mark.parametrize("text", ["kitchen door", "front door", "bedroom door", "oak door", "sliding door"])
def test_a_place_or_a_material_before_a_door_means_the_door(text: str) -> None:
    assert found(scene_of(WALL, ROOM_DOOR, FRIDGE), text).groups == (1,)


def test_a_closet_is_a_wardrobe_where_one_stands() -> None:
    assert found(scene_of(WALL, ROOM_DOOR, WARDROBE), "closet door").verdict == "absent"
    assert found(scene_of(WALL, ROOM_DOOR, WARDROBE, ITS_DOOR), "closet door").groups == (3,)


@pytest.mark.parametrize("door", [ITS_DOOR, ITS_OPEN_DOOR])
@pytest.mark.parametrize("query", ["wardrobe door", its("door", "wardrobe")])
def test_a_door_of_a_thing_is_told_by_its_place(door: Thing, query: Query | str) -> None:
    scene = scene_of(WALL, ROOM_DOOR, WARDROBE, door)
    assert found(scene, query).groups == (3,)
    assert found(scene, "door").verdict == "ambiguous"
    assert found(scene, "fridge door").verdict == "absent"


def test_a_door_at_the_wall_beside_a_thing_is_none_of_it() -> None:
    beside: Thing = ("door", (-1.06, 1.95, 0), (0.9, 0.08, 2.0))  # its frame touches the wardrobe
    scene = scene_of(WALL, beside, WARDROBE)
    for query in ("wardrobe door", its("door", "wardrobe")):
        assert found(scene, query).verdict == "absent"


def test_a_label_says_whose_part_it_is() -> None:
    far: Thing = ("refrigerator door", (1, -1, 0), (0.6, 0.05, 1.2))  # taken off and laid aside
    scene = scene_of(WALL, ROOM_DOOR, far, WARDROBE, named_by="user")
    assert found(scene, "fridge door").groups == (2,)
    assert found(scene, "wardrobe door").verdict == "absent"
    at_wardrobe: Thing = ("refrigerator door", *ITS_DOOR[1:])  # leans at the wardrobe
    assert found(scene_of(WALL, WARDROBE, at_wardrobe, named_by="user"), "wardrobe door").verdict == "absent"


def test_a_part_in_the_table_is_found_under_its_thing() -> None:
    scene = scene_of(WALL, ROOM_DOOR, WARDROBE, ITS_DOOR, named_by="user", parents={3: 2})
    assert found(scene, "wardrobe door").groups == (3,)


def test_drawers_belong_to_what_they_lie_in() -> None:
    scene = scene_of(WALL, DRESSER, ITS_DRAWER, NIGHTSTAND, ITS_OWN_DRAWER, named_by="user")
    assert found(scene, "dresser drawer").groups == found(scene, its("drawer", "dresser")).groups == (2,)
    assert found(scene, "nightstand drawer").groups == (4,)
    assert found(scene, "wardrobe drawer").verdict == "absent"
    assert found(scene, "drawer", "all").groups == (2, 4)


def test_a_thing_is_no_part_of_itself() -> None:
    missing = found(scene_of(WALL, DRESSER), "dresser drawer")
    assert missing.verdict == "absent" and [c.label for c in missing.candidates] == ["dresser"]


def test_a_lid_lies_on_its_bin() -> None:
    assert found(scene_of(WALL, BIN, ITS_LID), "bin lid").groups == (2,)
    aside: Thing = ("lid", (2, -1, 0), (0.3, 0.3, 0.05))
    assert found(scene_of(WALL, BIN, aside), "bin lid").verdict == "absent"


def test_colours_and_relations_hold_as_of_any_thing() -> None:
    scene = scene_of(WALL, ROOM_DOOR, WARDROBE, ITS_DOOR)
    groups = list(scene.language.groups)  # type: ignore[union-attr]
    groups[1] = replace(groups[1], lab=(53, 80, 67))
    scene = scene.replace(language=replace(scene.language, groups=tuple(groups)))  # type: ignore[type-var]
    assert found(scene, Query(text="door", colors=("red",))).groups == (1,)
    other = found(scene, Query(text="wardrobe door", colors=("red",)))
    assert other.verdict == "absent" and other.candidates[0].group == 3
    near = Relation(name="next_to", anchors=(Query(text="wardrobe"),))
    assert found(scene, Query(text="wardrobe door", relations=(near,))).groups == (3,)


@pytest.mark.parametrize("text", ["tv stand", "desk lamp"])
def test_kinds_of_their_own_are_found_as_before(text: str) -> None:
    scene = scene_of(WALL, ("sofa", (0, 0, 0), (2, 0.9, 0.8)), (text, (2, 0, 0), (0.5, 0.4, 0.4)))
    assert found(scene, text).groups == (2,)
