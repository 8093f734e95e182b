"""Resolving queries on a hand-made table, with an encoder of exact vectors."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from scenewright.gaussians.camera import Camera, Vec3
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.color import BASIC, parse, rgb_to_lab
from scenewright.gaussians.errors import BackendError, UserError
from scenewright.gaussians.harmonics import SH_C0
from scenewright.gaussians.language.encoders import Encoder
from scenewright.gaussians.language.encoders.calibration import Calibration
from scenewright.gaussians.language.encoders.vocabulary import Vocabulary
from scenewright.gaussians.language.field.language_field import Group, LanguageField, Level
from scenewright.gaussians.language.field.naming import joined, with_names
from scenewright.gaussians.language.query.query import Picks, Query, Relation
from scenewright.gaussians.language.query.resolve import resolve
from scenewright.gaussians.language.query.selection import Selection
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.world.box import Box
from scenewright.gaussians.world.relations import QueryName
from scenewright.gaussians.world.words import normalise

AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
KINDS = ("chair", "sofa", "table", "lamp", "vase", "bicycle", "rug")
EYE = Camera.look_at((0, -7, 1.6), (0, 0, 0.5), (0, 0, 1))
BACK = Camera.look_at((0, 7, 1.6), (0, 0, 0.5), (0, 0, 1))
EACH = 150  # Gaussians in every leaf


class Exact:
    """One axis a kind and one for what is no object: cosines are 1 or 0."""

    fingerprint = "exact:1"
    dim = len(KINDS) + 1
    image_size = 8
    vocabulary = Vocabulary(
        {k: ("couch",) if k == "sofa" else () for k in KINDS}, {"seat": ("chair", "sofa")}, ("part",)
    )
    calibration = Calibration(scale=8.0, threshold=0.5)

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        rows = np.zeros((len(texts), self.dim), np.float32)
        for row, text in zip(rows, texts, strict=True):
            kinds = self.vocabulary.covered(text)
            row[[KINDS.index(k) for k in kinds] if kinds else [self.dim - 1]] = 1 / math.sqrt(max(len(kinds), 1))
        return rows

    def encode_images(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        return np.eye(self.dim, dtype=np.float32)[[self.dim - 1] * len(images)]

    def unknown_words(self, text: str) -> tuple[str, ...]:
        return tuple(w for w in normalise(text) if not self.vocabulary.covered(w) and w not in ("part", "red"))

    def knows(self, text: str) -> bool:
        return bool(normalise(text)) and not self.unknown_words(text)


ENCODER: Encoder = Exact()


@dataclass(frozen=True)
class Row:
    """One thing of the hand-made room."""

    kind: str
    color: str
    center: Vec3
    size: Vec3
    level: Level = "object"
    parent: int = -1
    sure: float = 0.97  # how much the encoder believes in the kind: 0 leaves it unnamed


FLOOR, WALL, RED, BLUE, TALL, SOFA, TABLE, VASE, LAMP, SHADE, FOOT, BIKE = range(12)
ROOM = (
    Row("floor", "brown", (0, 0, 0), (8, 8, 0.02), "structure"),
    Row("wall", "white", (0, 4, 1.2), (8, 0.1, 2.4), "structure"),
    Row("chair", "red", (-2, 0, 0.45), (0.5, 0.5, 0.9)),
    Row("chair", "blue", (0.0, 0, 0.45), (0.5, 0.5, 0.9)),
    Row("chair", "green", (2, 0, 0.75), (0.5, 0.5, 1.5)),
    Row("sofa", "blue", (0, 2.5, 0.4), (2, 0.9, 0.8)),
    Row("table", "white", (-2, -2, 0.375), (1.2, 0.8, 0.75)),
    Row("vase", "green", (-2, -2, 0.9), (0.2, 0.2, 0.3)),
    Row("lamp", "red", (3, 2, 0.8), (0.4, 0.4, 1.6)),
    Row("", "red", (3, 2, 1.3), (0.4, 0.4, 0.6), "part", LAMP),
    Row("", "gray", (3, 2, 0.5), (0.1, 0.1, 1.0), "part", LAMP),
    Row("", "orange", (3, -2, 0.3), (0.5, 0.15, 0.4), sure=0.0),  # a bicycle that the encoder does not recognise
)


def rgb_of(name: str) -> tuple[float, float, float]:
    return parse(BASIC[name])


def filled(row: Row, index: int) -> tuple[torch.Tensor, torch.Tensor]:
    """Means and display colours of one row's Gaussians, spread through its box."""
    rng = np.random.default_rng(index)
    means = np.array(row.center) + rng.uniform(-0.5, 0.5, (EACH, 3)) * np.array(row.size)
    return torch.from_numpy(means).float(), torch.tensor(rgb_of(row.color)).repeat(EACH, 1)


def scene_of(rows: tuple[Row, ...], loose: int = 10) -> Scene:
    """Gaussians and table of some rows, and `loose` Gaussians that belong to nothing."""
    owners = [i for i in range(len(rows)) if not any(r.parent == i for r in rows)]
    made = [filled(rows[i], i) for i in owners]
    stray = torch.from_numpy(np.random.default_rng(99).uniform(-3, 3, (loose, 3))).float()
    means = torch.cat([m for m, _ in made] + [stray])
    colors = torch.cat([c for _, c in made] + [torch.full((loose, 3), 0.5)])
    group = torch.tensor([i for i in owners for _ in range(EACH)] + [-1] * loose, dtype=torch.int32)
    n = len(means)
    cloud = GaussianCloud.create(
        means, torch.tensor([[1.0, 0, 0, 0]]).repeat(n, 1), torch.full((n, 3), 0.05), torch.full((n,), 0.9),
        ((colors - 0.5) / SH_C0)[:, None, :].contiguous(), group,
    ).replace(ids=torch.arange(n) * 3 + 7)  # fmt: skip  # ids are no row numbers
    vectors = np.zeros((len(rows), Exact.dim), np.float32)
    table = []
    for i, row in enumerate(rows):
        if row.level == "object":
            vectors[i, KINDS.index(row.kind) if row.sure else -1] = 1
        children = sum(r.parent == i for r in rows)
        lightness, a, b = rgb_to_lab(torch.tensor(rgb_of(row.color), dtype=torch.float64)).tolist()
        sure = 1.0 if row.level == "structure" else row.sure if row.level == "object" else 0.0
        table.append(
            Group(
                i, row.level, row.parent, row.kind, sure, Box(row.center, AXES, row.size), (lightness, a, b),
                EACH * max(children, 1), 3, 1.0,
            )
        )  # fmt: skip
    field = LanguageField(tuple(table), vectors, Exact.fingerprint)
    return Scene(cloud, Frame((0, 0, 1), 0.0, 1.0, "given", "given"), language=field)


SCENE = scene_of(ROOM)
STRANGE = scene_of(tuple(replace(r, sure=min(r.sure, 0.35)) for r in ROOM))  # the encoder is sure of nothing here


def ask(query: Query, scene: Scene = SCENE, viewer: Camera = EYE, last: Selection | None = None) -> Selection:
    return resolve(scene, query, viewer, ENCODER, last)


def named(text: str, *colors: str, pick: Picks = "one", **more: object) -> Query:
    return Query.model_validate({"text": text, "colors": colors, "pick": pick, **more})


def by(name: QueryName, *anchors: Query, frame: str = "viewer") -> dict[str, object]:
    return {"relations": (Relation.model_validate({"name": name, "anchors": anchors, "frame": frame}),)}


def ids_of(scene: Scene, *groups: int) -> list[int]:
    """Ids of the Gaussians of some rows of the table, straight from the cloud's column."""
    assert scene.language is not None
    leaves = {leaf for g in groups for leaf in scene.language.leaves(g)}
    rows = zip(scene.cloud.ids.tolist(), scene.cloud.group.tolist(), strict=True)
    return [i for i, g in rows if g in leaves]


def found(query: Query, *groups: int, scene: Scene = SCENE, viewer: Camera = EYE) -> bool:
    answer = ask(query, scene, viewer)
    assert answer.verdict == "found", answer.reason
    return answer.ids.tolist() == ids_of(scene, *groups) and set(answer.groups) == set(groups)


# -- one term at a time ----------------------------------------------------------------------------------------------


def test_the_encoder_is_one() -> None:
    assert isinstance(ENCODER, Encoder)


@pytest.mark.parametrize(("text", "group"), [("sofa", SOFA), ("couch", SOFA), ("vase", VASE), ("lamp", LAMP)])
def test_a_noun_finds_its_one_thing_with_its_parts(text: str, group: int) -> None:
    assert found(named(text), group)


def test_several_matches_are_ambiguous_and_listed() -> None:
    answer = ask(named("chair"))
    assert answer.verdict == "ambiguous" and not len(answer) and not answer.groups
    assert {c.group for c in answer.candidates} == {RED, BLUE, TALL}
    assert "3 things match" in answer.reason and "red chair" in answer.reason


def test_what_is_not_there_is_absent_and_the_nearest_is_named() -> None:
    answer = ask(named("rug"))
    assert answer.verdict == "absent" and not len(answer) and len(answer.candidates) == 3
    assert "the rug is not in this scene" in answer.reason and "nearest" in answer.reason


def test_a_word_the_encoder_never_learnt_is_said_to_be_unknown() -> None:
    answer = ask(named("gizmo"))
    assert answer.verdict == "absent" and "does not know the word 'gizmo'" in answer.reason


def test_colours_tell_things_apart_and_swapped_colours_swap_them() -> None:
    assert found(named("chair", "red"), RED) and found(named("chair", "blue"), BLUE)
    rows = list(ROOM)
    rows[RED], rows[BLUE] = replace(rows[RED], color="blue"), replace(rows[BLUE], color="red")
    swapped = scene_of(tuple(rows))
    assert found(named("chair", "red"), BLUE, scene=swapped) and found(named("chair", "blue"), RED, scene=swapped)


def test_swapped_nouns_swap_too() -> None:
    sofa, chair = named("sofa", "blue"), named("chair", "blue")
    assert found(sofa, SOFA) and found(chair, BLUE)
    assert found(named("chair", **by("in_front_of", named("sofa")), colors=("blue",)), BLUE)
    assert found(named("sofa", **by("behind", named("chair", "blue"))), SOFA)


def test_a_colour_nobody_of_that_kind_has_is_absent() -> None:
    assert ask(named("sofa", "purple")).verdict == "absent"


def test_an_unknown_colour_is_the_users_error() -> None:
    with pytest.raises(UserError, match="unknown colour"):
        ask(named("chair", "blurple"))


def test_a_negated_colour_leaves_the_others() -> None:
    assert found(named("chair", pick="all", not_colors=("red",)), BLUE, TALL)
    assert ask(named("sofa", pick="all", not_colors=("blue",))).verdict == "absent"


def test_size_words_choose_among_what_otherwise_matches() -> None:
    assert found(named("chair", size="tall"), TALL)
    assert found(named("chair", pick="all", size="short"), RED, BLUE)
    assert found(named("chair", "red", size="tall"), RED)  # the only red one is as tall as red ones come
    assert found(named("", "blue", size="large"), SOFA)


@pytest.mark.parametrize("text", ["floor", "ground", "wall"])
def test_structure_is_found_by_name_and_by_nothing_else(text: str) -> None:
    assert found(named(text), WALL if text == "wall" else FLOOR)
    assert ask(named("ceiling")).verdict == "absent"
    everything = ask(named("thing", pick="all"))
    assert not {FLOOR, WALL} & set(everything.groups)


def test_only_a_green_ground_is_grass() -> None:
    lawn = scene_of((replace(ROOM[FLOOR], color="green"), *ROOM[FLOOR + 1 :]))
    assert ask(named("grass"), lawn).groups == (FLOOR,) and ask(named("ground"), lawn).groups == (FLOOR,)
    assert ask(named("grass")).verdict == "absent"  # this floor is brown


def test_structure_of_another_colour_is_absent_and_not_some_thing_of_that_colour() -> None:
    assert ask(named("wall", "orange")).verdict == "absent"
    assert found(named("wall", "white"), WALL)


def test_everything_is_every_gaussian() -> None:
    assert ask(named("everything", pick="all")).ids.tolist() == SCENE.cloud.ids.tolist()


def test_parts_are_asked_for_as_parts() -> None:
    answer = ask(named("part", pick="all", **by("part_of", named("lamp"))))
    assert set(answer.groups) == {SHADE, FOOT}


# -- picks -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("pick", "group"),
    [
        ("leftmost", RED), ("rightmost", TALL), ("tallest", TALL), ("largest", TALL), ("highest", TALL),
    ],
)  # fmt: skip
def test_superlatives(pick: Picks, group: int) -> None:
    assert found(named("chair", pick=pick), group)


def test_nearest_and_farthest_are_the_viewers() -> None:
    assert found(named("chair", pick="nearest"), BLUE)
    side = Camera.look_at((-7, 0, 1.6), (0, 0, 0.5), (0, 0, 1))
    assert found(named("chair", pick="nearest"), RED, viewer=side)
    assert found(named("chair", pick="farthest"), TALL, viewer=side)


@pytest.mark.parametrize(("ordinal", "group"), [(1, RED), (2, BLUE), (3, TALL)])
def test_nth_counts_from_the_viewers_left(ordinal: int, group: int) -> None:
    assert found(named("chair", pick="nth", ordinal=ordinal), group)
    mirrored = {RED: TALL, TALL: RED}.get(group, group)
    assert found(named("chair", pick="nth", ordinal=ordinal), mirrored, viewer=BACK)


@pytest.mark.parametrize(("ordinal", "group"), [(-1, TALL), (-2, BLUE), (-3, RED)])
def test_a_negative_rank_counts_from_the_viewers_right(ordinal: int, group: int) -> None:
    assert found(named("chair", pick="nth", ordinal=ordinal), group)
    assert ask(named("chair", pick="nth", ordinal=-4)).verdict == "absent"


def test_the_middle_is_one_of_an_odd_number() -> None:
    assert found(named("chair", pick="middle"), BLUE)
    two = named("chair", pick="middle", relations=(Relation(name="right_of", anchors=(Query(groups=(RED,)),)),))
    assert ask(two).verdict == "ambiguous"


def test_the_middle_of_a_stack_is_told_from_the_bottom_up() -> None:
    assert SCENE.language is not None
    heights = {RED: 1.5, BLUE: 0.5, TALL: 1.0}
    groups = tuple(
        replace(g, box=replace(g.box, center=(0.0, 0.0, heights[g.id]))) if g.id in heights else g
        for g in SCENE.language.groups
    )
    stack = SCENE.replace(language=replace(SCENE.language, groups=groups))
    assert found(named("chair", pick="middle"), TALL, scene=stack)


def test_what_is_left_out_is_not_in_the_way_of_the_one() -> None:
    others = (Query(groups=(RED,)), Query(groups=(TALL,)))
    assert found(named("chair", exclude=others), BLUE)
    assert ask(named("chair", exclude=others[:1])).verdict == "ambiguous"


def test_nth_beyond_the_last_is_absent() -> None:
    answer = ask(named("chair", pick="nth", ordinal=4))
    assert answer.verdict == "absent" and "only 3" in answer.reason


@pytest.mark.parametrize(("count", "verdict"), [(2, "ambiguous"), (3, "found"), (4, "absent")])
def test_a_count_must_be_right(count: int, verdict: str) -> None:
    answer = ask(named("chair", pick="all", count=count))
    assert answer.verdict == verdict
    assert verdict == "found" or f"{count} were asked for, 3 match" in answer.reason


def test_any_takes_one_and_all_takes_all() -> None:
    assert len(ask(named("chair", pick="any")).groups) == 1
    assert found(named("chair", pick="all"), RED, BLUE, TALL)


def test_the_rest_is_everything_else_with_floor_and_strays() -> None:
    rest = ask(named("chair", pick="rest"))
    assert rest.ids.tolist() == sorted(set(SCENE.cloud.ids.tolist()) - set(ids_of(SCENE, RED, BLUE, TALL)))
    assert FLOOR in rest.groups and RED not in rest.groups
    assert ask(named("rug", pick="rest")).verdict == "absent"  # "everything but the rug" where there is no rug


# -- relations -------------------------------------------------------------------------------------------------------


def test_relations_choose_and_depend_on_the_viewer() -> None:
    left = named("chair", **by("left_of", named("chair", "blue")))
    assert found(left, RED) and found(left, TALL, viewer=BACK)
    front = named("chair", "blue", **by("in_front_of", named("sofa")))
    assert found(front, BLUE)
    assert ask(front, viewer=BACK).verdict == "absent"


def test_relations_in_an_objects_own_frame_do_not_depend_on_the_viewer() -> None:
    # the sofa stands at the wall in the north, so it faces -y and its own left hand is at +x
    scene = scene_of((*ROOM[:SOFA], replace(ROOM[SOFA], center=(0, 3.5, 0.4)), *ROOM[SOFA + 1 :]))
    front = named("chair", "blue", **by("in_front_of", named("sofa"), frame="object"))
    left = named("lamp", **by("left_of", named("sofa"), frame="object"))
    behind = named("chair", pick="all", **by("behind", named("sofa"), frame="object"))
    for viewer in (EYE, BACK):
        assert found(front, BLUE, scene=scene, viewer=viewer) and found(left, LAMP, scene=scene, viewer=viewer)
        assert "away from the wall" in ask(front, scene, viewer).reason
        assert ask(behind, scene, viewer).verdict == "absent"


def test_a_thing_that_faces_nowhere_is_seen_from_the_viewer_and_that_is_said() -> None:
    front = named("chair", "blue", **by("in_front_of", named("sofa"), frame="object"))
    answer = ask(front)
    assert answer.groups == (BLUE,) and "cannot be told" in answer.reason
    assert ask(front, viewer=BACK).verdict == "absent"


def test_on_and_under() -> None:
    assert found(named("", **by("on", named("table"))), VASE)
    assert found(named("table", **by("under", named("vase"))), TABLE)
    assert ask(named("lamp", **by("on", named("table")))).verdict == "absent"


def test_between_two_anchors_and_two_of_one_kind() -> None:
    assert found(named("chair", **by("between", named("chair", "red"), named("chair", "green"))), BLUE)


def test_nearest_to_another_thing() -> None:
    assert found(named("chair", **by("nearest_to", named("table"))), RED)
    assert found(named("chair", **by("farthest_from", named("table"))), TALL)
    # a thing is not the nearest to itself
    assert found(named("chair", **by("nearest_to", named("chair", "red"))), BLUE)


def test_a_missing_or_doubtful_anchor_is_the_answer() -> None:
    gone = ask(named("chair", **by("left_of", named("rug"))))
    assert gone.verdict == "absent" and "rug" in gone.reason
    which = ask(named("lamp", **by("right_of", named("chair"))))
    assert which.verdict == "ambiguous" and "things match" in which.reason


@pytest.mark.parametrize("name", ["left_of", "nearest_to", "farthest_from"])
def test_an_anchor_found_by_its_colour_alone_is_an_anchor(name: QueryName) -> None:
    answer = ask(named("chair", pick="any", **by(name, named("bicycle", "orange"))), STRANGE)
    assert answer.verdict == "unconfirmed" and set(answer.groups) <= {RED, BLUE, TALL}
    assert "could not be confirmed" in answer.reason  # what rests on a doubtful anchor is as doubtful


def test_a_relation_by_contact_chooses_among_several_anchors() -> None:
    second = replace(ROOM[TABLE], center=(-3.0, -3.0, ROOM[TABLE].center[2]))
    scene = scene_of((*ROOM, second))
    assert ask(named("table"), scene).verdict == "ambiguous"
    assert found(named("vase", **by("on", named("table"))), VASE, scene=scene)
    assert ask(named("lamp", **by("on", named("table"))), scene).verdict == "absent"
    assert ask(named("vase", **by("left_of", named("table"))), scene).verdict == "ambiguous"  # of which?


def test_the_largest_of_three_equals_is_ambiguous() -> None:
    scene = scene_of((*ROOM, *(Row("vase", "blue", (x, 3.0, 0.3), (0.5, 0.5, 0.5)) for x in (-2.0, 0.0, 2.0))))
    for pick in ("largest", "tallest"):
        answer = ask(named("vase", pick=pick), scene)
        assert answer.verdict == "ambiguous" and len(answer.candidates) == 3 and "equal" in answer.reason
    assert found(named("vase", pick="smallest"), VASE, scene=scene)
    assert found(named("vase", pick="highest"), VASE, scene=scene)
    assert ask(named("vase", pick="lowest"), scene).verdict == "ambiguous"
    assert len(ask(named("vase", pick="rightmost"), scene).groups) == 1


# -- colour where words fail -----------------------------------------------------------------------------------------


def test_where_the_encoder_is_a_stranger_a_thing_is_found_by_its_colour_and_that_is_said() -> None:
    answer = ask(named("bicycle", "orange"), STRANGE)
    assert answer.verdict == "unconfirmed" and answer.ids.tolist() == ids_of(STRANGE, BIKE)
    assert "could not be confirmed" in answer.reason and "colour" in answer.reason
    assert ask(named("bicycle"), STRANGE).verdict == "absent"  # without a colour there is nothing to go by


def test_a_word_the_encoder_never_learnt_may_be_found_by_its_colour_anywhere() -> None:
    answer = ask(named("gizmo", "orange"))
    assert answer.verdict == "unconfirmed" and answer.ids.tolist() == ids_of(SCENE, BIKE)
    assert "could not be confirmed" in answer.reason


@pytest.mark.parametrize("color", ["red", "blue", "orange", "white"])
def test_where_the_encoder_is_at_home_what_it_does_not_find_is_not_there_in_any_colour(color: str) -> None:
    assert ask(named("bicycle", color)).verdict == "absent"


@pytest.mark.parametrize(("kind", "color"), [("chair", "orange"), ("sofa", "red"), ("table", "green")])
def test_a_thing_of_another_colour_is_not_mistaken_for_its_colour_elsewhere(kind: str, color: str) -> None:
    answer = ask(named(kind, color))
    assert answer.verdict == "absent" and answer.candidates[0].label == kind  # the nearest is one of that kind


def test_two_places_of_the_colour_are_ambiguous() -> None:
    second = replace(ROOM[BIKE], center=(-3.2, 2.5, 0.5))
    scene = scene_of((*ROOM, second))
    answer = ask(named("gizmo", "orange"), scene)
    assert answer.verdict == "ambiguous" and not len(answer) and "2 places" in answer.reason
    assert len(ask(named("gizmo", "orange", pick="all"), scene)) == 2 * EACH
    placed = ask(named("gizmo", "orange", **by("left_of", named("sofa"))), scene)
    assert placed.ids.tolist() == ids_of(scene, len(ROOM))


def test_parts_of_a_colour_are_all_its_places_whatever_they_belong_to() -> None:
    answer = ask(named("part", "red", pick="all"))
    assert set(ids_of(SCENE, RED, SHADE)) <= set(answer.ids.tolist())
    assert not set(ids_of(SCENE, BLUE, SOFA, TABLE)) & set(answer.ids.tolist())


# -- what was before, and what is gone -------------------------------------------------------------------------------


def test_it_is_what_was_selected_last() -> None:
    before = ask(named("sofa"))
    again = ask(Query(last=True), last=before)
    assert again.verdict == "found" and torch.equal(again.ids, before.ids) and again.query == Query(last=True)
    for nothing in (None, ask(named("rug")), ask(named("chair"))):
        assert ask(Query(last=True), last=nothing).verdict == "absent"


def without(scene: Scene, *groups: int) -> Scene:
    """Groups deleted as the operation does it: no Gaussians, and a count of 0 in the table."""
    assert scene.language is not None
    gone = torch.isin(scene.cloud.ids, torch.tensor(ids_of(scene, *groups)))
    leaves = {leaf for g in groups for leaf in scene.language.leaves(g)}
    rows = tuple(replace(g, count=0) if g.id in leaves else g for g in scene.language.groups)
    return scene.replace(cloud=scene.cloud[~gone], language=replace(scene.language, groups=rows))


def test_what_was_deleted_is_never_found_again() -> None:
    scene = without(SCENE, RED, LAMP)
    assert found(named("chair", pick="all"), BLUE, TALL, scene=scene)
    for query in (
        named("chair", "red"), named("lamp"), Query(groups=(RED,)), named("part", "red", pick="all"),
        Query(last=True),
    ):  # fmt: skip
        assert ask(query, scene, last=ask(named("chair", "red"))).verdict == "absent", query
    assert ask(named("part", pick="all"), scene).verdict == "found"


def test_explicit_groups_are_taken_as_they_are() -> None:
    assert found(Query(groups=(RED, LAMP, RED)), RED, LAMP)
    assert found(Query(groups=(SHADE,)), SHADE)
    assert ask(Query(groups=(500,))).verdict == "absent"


def test_an_empty_table_answers_absent() -> None:
    field = LanguageField((), np.zeros((0, Exact.dim), np.float32), Exact.fingerprint)
    for query in (named("chair"), named("floor"), named("part", pick="all"), named("", size="small")):
        assert ask(query, SCENE.replace(language=field)).verdict == "absent"
    assert len(ask(named("part", "blue", pick="all"), SCENE.replace(language=field)))  # colour needs no table


# -- back ends -------------------------------------------------------------------------------------------------------


def test_another_encoder_and_a_missing_field_are_refused() -> None:
    assert SCENE.language is not None
    other = SCENE.replace(language=replace(SCENE.language, encoder="other:2"))
    with pytest.raises(BackendError, match="other:2"):
        ask(named("chair"), other)
    with pytest.raises(BackendError, match="embed"):
        ask(named("chair"), SCENE.replace(language=None))
    with pytest.raises(BackendError, match="encoder"):
        resolve(SCENE, named("chair"), EYE)


def test_colour_place_and_structure_need_no_encoder() -> None:
    assert resolve(SCENE, named("floor"), EYE).groups == (FLOOR,)
    assert set(resolve(SCENE, named("", "blue", pick="all"), EYE).groups) == {BLUE, SOFA}
    assert resolve(SCENE, Query(groups=(RED,)), EYE).groups == (RED,)


# -- algebra ---------------------------------------------------------------------------------------------------------

simple = st.one_of(
    st.builds(named, st.sampled_from(["chair", "sofa", "lamp", "vase", "thing", "floor"]), pick=st.just("all")),
    st.builds(lambda c: named("", c, pick="all"), st.sampled_from(["red", "blue", "green"])),
    st.builds(lambda p: named("chair", pick=p), st.sampled_from(["leftmost", "tallest", "rest", "any"])),
    st.builds(lambda g: Query(groups=tuple(g)), st.sets(st.integers(0, BIKE), min_size=1, max_size=4)),
)


def ids(query: Query) -> set[int]:
    return set(ask(query).require().ids.tolist())


@given(simple, simple)
def test_also_is_a_union(a: Query, b: Query) -> None:
    both = ask(a.model_copy(update={"also": (b,)}))
    assert set(both.ids.tolist()) == ids(a) | ids(b)
    assert both.ids.tolist() == sorted(both.ids.tolist())
    assert set(both.groups) >= set(ask(a).groups) and set(both.groups) >= set(ask(b).groups)


@given(simple, simple)
def test_exclude_is_a_difference_and_an_empty_one_is_absent(a: Query, b: Query) -> None:
    answer = ask(a.model_copy(update={"exclude": (b,)}))
    left = ids(a) - ids(b)
    assert set(answer.ids.tolist()) == left
    assert answer.verdict == ("found" if left else "absent")


@given(simple, simple, simple)
def test_unions_come_before_differences(a: Query, b: Query, c: Query) -> None:
    answer = ask(a.model_copy(update={"also": (b,), "exclude": (c,)}))
    assert set(answer.ids.tolist()) == (ids(a) | ids(b)) - ids(c)


@given(simple)
def test_rest_is_the_complement(query: Query) -> None:
    if query.groups or query.pick != "all":
        return
    rest = ask(query.model_copy(update={"pick": "rest"}))
    assert set(rest.ids.tolist()) == set(SCENE.cloud.ids.tolist()) - ids(query)


@given(simple)
def test_every_score_is_the_product_of_terms_that_are_shares(query: Query) -> None:
    for candidate in ask(query).candidates:
        assert all(0 <= v <= 1 for v in candidate.terms.values())
        assert candidate.score == pytest.approx(math.prod(candidate.terms.values()))


def test_an_absent_exception_is_said_and_changes_nothing() -> None:
    answer = ask(named("chair", pick="all", exclude=(named("chair", "purple"),)))
    assert answer.verdict == "absent" and "leave out" in answer.reason
    assert ask(named("sofa", also=(named("rug"),))).verdict == "absent"


def test_an_exception_takes_all_that_it_names() -> None:
    assert found(named("thing", pick="all", exclude=(named("chair"),)), SOFA, TABLE, VASE, LAMP, BIKE)


def test_resolving_changes_neither_scene_nor_order() -> None:
    before = SCENE.cloud.digest()
    once, again = ask(named("chair", pick="all")), ask(named("chair", pick="all"))
    assert SCENE.cloud.digest() == before
    assert torch.equal(once.ids, again.ids) and once.candidates == again.candidates


# -- names that were given ---------------------------------------------------------------------------------------------


def test_a_given_name_finds_what_the_encoder_does_not_recognise() -> None:
    given = with_names(SCENE, {BIKE: "bicycle"}, "sight")
    assert ask(named("bicycle")).verdict == "absent"
    assert found(named("bicycle"), BIKE, scene=given)
    assert ask(named("sofa"), given).groups == (SOFA,)


def test_a_given_name_outweighs_the_encoder() -> None:
    given = with_names(SCENE, {VASE: "lamp", LAMP: "vase"}, "sight")
    assert found(named("lamp"), VASE, scene=given) and found(named("vase"), LAMP, scene=given)


def test_two_words_for_one_kind_name_two_things_where_both_were_given() -> None:
    both = with_names(SCENE, {SOFA: "sofa", TABLE: "couch"}, "user")
    assert ask(named("couch"), both).groups == (TABLE,) and ask(named("sofa"), both).groups == (SOFA,)
    alone = with_names(SCENE, {SOFA: "sofa"}, "user")
    assert ask(named("couch"), alone).groups == (SOFA,)


def test_a_word_that_no_encoder_knows_can_be_given() -> None:
    assert found(named("gizmo"), VASE, scene=with_names(SCENE, {VASE: "purple gizmo"}, "caption"))


def test_pieces_that_are_joined_are_one_thing_with_all_its_parts() -> None:
    scene, whole = joined(SCENE, [LAMP, VASE], "kettle", "sight")
    answer = ask(named("kettle"), scene)
    assert answer.groups == (whole,)
    assert answer.ids.tolist() == ids_of(SCENE, LAMP, VASE)
    assert ask(named("vase"), scene).verdict == "absent"
    assert scene.language is not None and scene.language.groups[whole].count == 3 * EACH
    assert torch.equal(scene.cloud.group, SCENE.cloud.group)


def test_a_part_becomes_a_thing_of_its_own() -> None:
    scene, shade = joined(SCENE, [SHADE], "lampshade", "sight")
    assert ask(named("lampshade"), scene).ids.tolist() == ids_of(SCENE, SHADE)
    assert ask(named("lamp"), scene).ids.tolist() == ids_of(SCENE, FOOT)
    assert scene.language is not None and scene.language.groups[LAMP].count == EACH
    assert scene.language.groups[shade].count == EACH


def test_one_piece_alone_keeps_its_row() -> None:
    scene, whole = joined(SCENE, [VASE], "kettle", "sight")
    assert whole == VASE and found(named("kettle"), VASE, scene=scene)


@pytest.mark.parametrize("groups", [[], [999], [-1]])
def test_groups_that_are_not_there_cannot_be_joined(groups: list[int]) -> None:
    with pytest.raises(UserError):
        joined(SCENE, groups, "kettle", "sight")
