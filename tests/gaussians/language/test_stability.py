"""Invariances of queries: order of the table, mirrored scenes, viewers, negation, swapped anchors."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.gaussians import assets
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import NO_GROUP
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.field.measure import box_of, lab_of_cloud
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.resolve import resolve
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.world.box import Box

SWAPPED = {"left_of": "right_of", "right_of": "left_of", "leftmost": "rightmost", "rightmost": "leftmost"}
SIDES = ("left_of", "right_of", "in_front_of", "behind")


@pytest.fixture(scope="module")
def room() -> Scene:
    """A furnished room with a field over its true objects, and its walls each a group; no encoder is needed."""
    made = assets.furnish(8051, "living room", detail=0.15)
    truth, points = made.truth.ids.numpy(), made.scene.cloud.means.numpy()
    w, d, _ = made.size
    column = np.full(len(truth), NO_GROUP, np.int32)
    rows: list[tuple[str, str, np.ndarray]] = [("structure", "floor", (truth < 0) & (points[:, 2] < 0.05))]
    high = (truth < 0) & (points[:, 2] >= 0.05)
    for axis, at in ((0, w / 2), (0, -w / 2), (1, d / 2), (1, -d / 2)):
        on = high & (np.abs(points[:, axis] - at) < 0.02)
        if on.sum() > 20:
            rows.append(("structure", "wall", on))
    rows += [("object", o.kind, truth == o.id) for o in made.truth.objects]
    groups = []
    for level, label, own in rows:
        column[own] = len(groups)
        part = made.scene.cloud[torch.from_numpy(own)]
        box = box_of(part, made.scene.frame)
        groups.append(Group(len(groups), level, -1, label, 1.0, box, lab_of_cloud(part), len(part), 1, 1.0))  # type: ignore[arg-type]
    field = LanguageField(tuple(groups), np.zeros((len(groups), 2), np.float32), "none")
    return replace(made.scene, cloud=made.scene.cloud.replace(group=torch.from_numpy(column)), language=field)


def groups_of(scene: Scene) -> tuple[Group, ...]:
    assert scene.language is not None
    return scene.language.groups


def shuffled(scene: Scene, seed: int) -> tuple[Scene, list[int]]:
    """The same scene with its table in another order, and the new id of each group."""
    order = np.random.default_rng(seed).permutation(len(groups_of(scene)))
    new = np.argsort(order)
    rows = tuple(replace(groups_of(scene)[old], id=i) for i, old in enumerate(order))
    column = scene.cloud.group.numpy()
    moved = np.where(column >= 0, new[np.maximum(column, 0)], NO_GROUP).astype(np.int32)
    field = LanguageField(rows, np.zeros((len(rows), 2), np.float32), "none")
    return replace(scene, cloud=scene.cloud.replace(group=torch.from_numpy(moved)), language=field), new.tolist()


def mirrored(scene: Scene) -> Scene:
    """x becomes -x: means and boxes; quaternions keep w and x and turn y and z about."""
    flip = torch.tensor([-1.0, 1.0, 1.0])
    cloud = scene.cloud.replace(
        means=scene.cloud.means * flip, quats=scene.cloud.quats * torch.tensor([1.0, 1.0, -1.0, -1.0])
    )

    def turned(box: Box) -> Box:
        (ax, ay, az), (bx, by, bz), up = (
            box.axes
        )  # the first axis is turned round, so that the frame stays right-handed
        return Box((-box.center[0], *box.center[1:]), ((ax, -ay, -az), (-bx, by, bz), up), box.size)

    rows = tuple(replace(g, box=turned(g.box)) for g in groups_of(scene))
    return replace(scene, cloud=cloud, language=LanguageField(rows, np.zeros((len(rows), 2), np.float32), "none"))


def mirrored_eye(eye: Camera) -> Camera:
    p, f = eye.position, eye.forward
    return Camera.look_at((-p[0], p[1], p[2]), (-p[0] - f[0], p[1] + f[1], p[2] + f[2]), (0, 0, 1))


def sided(name: str, anchor: int, **more: object) -> Query:
    relation = {"name": name, "anchors": [{"groups": [anchor]}]}
    return Query.model_validate({"text": "thing", "pick": "all", "relations": [relation], **more})


queries = st.one_of(
    st.builds(lambda c: Query(text="thing", colors=(c,), pick="all"), st.sampled_from(["brown", "white", "green"])),
    st.builds(lambda p: Query(text="thing", pick=p), st.sampled_from(["leftmost", "largest", "highest", "nearest"])),
    st.builds(lambda n, o: Query(text="thing", pick="nth", ordinal=n), st.integers(1, 5), st.none()),
    st.builds(lambda p: Query(text="wall", pick=p), st.sampled_from(["all", "leftmost", "farthest"])),
    st.just(Query(text="thing", pick="all", not_colors=("brown",))),
    st.just(Query(text="thing", size="large", pick="all")),
)


@given(queries, st.integers(0, 999))
@settings(max_examples=40, deadline=None)
def test_the_order_of_the_table_decides_nothing(room: Scene, query: Query, seed: int) -> None:
    other, _ = shuffled(room, seed)
    here, there = (resolve(s, query, room.cameras[0]) for s in (room, other))
    assert here.verdict == there.verdict and torch.equal(here.ids, there.ids)


@pytest.mark.parametrize("camera", range(3))
def test_a_mirrored_scene_seen_by_a_mirrored_viewer_swaps_left_and_right_and_nothing_else(
    room: Scene, camera: int
) -> None:
    eye = room.cameras[camera]
    image, there = mirrored(room), mirrored_eye(eye)
    things = [g.id for g in groups_of(room) if g.level == "object"]
    seen = 0
    for anchor in things[:8]:
        for name in (*SIDES, "next_to", "on"):
            here = resolve(room, sided(name, anchor), eye)
            swapped = resolve(image, sided(SWAPPED.get(name, name), anchor), there)
            assert here.groups == swapped.groups, (name, anchor)
            seen += len(here.groups)
    assert seen > 30
    for pick in ("leftmost", "rightmost", "largest", "highest", "farthest"):
        one = resolve(room, Query(text="thing", pick=pick), eye)  # type: ignore[arg-type]
        other = resolve(image, Query.model_validate({"text": "thing", "pick": SWAPPED.get(pick, pick)}), there)
        assert one.groups == other.groups, pick


def test_left_from_here_is_right_from_the_other_side(room: Scene) -> None:
    eye = room.cameras[0]
    p, f = eye.position, eye.forward
    across = Camera.look_at(p + 20 * f * [1, 1, 0], p, (0, 0, 1))
    for anchor in [g.id for g in groups_of(room) if g.level == "object"][:8]:
        for one, other in (("left_of", "right_of"), ("behind", "in_front_of")):
            here, there = resolve(room, sided(one, anchor), eye), resolve(room, sided(other, anchor), across)
            assert set(here.groups) == set(there.groups)


def test_without_and_not_are_complements(room: Scene) -> None:
    """Negation is a set difference, never a word that an encoder reads."""
    eye = room.cameras[0]
    every = set(resolve(room, Query(text="thing", pick="all"), eye).groups)
    for color in ("brown", "white"):
        brown = Query(text="thing", colors=(color,), pick="all")
        some = set(resolve(room, brown, eye).groups)
        but = resolve(room, Query(text="thing", pick="all", exclude=(brown,)), eye)
        rest = resolve(room, brown.model_copy(update={"pick": "rest"}), eye)
        negated = set(resolve(room, Query(text="thing", not_colors=(color,), pick="all"), eye).groups)
        assert some and set(but.groups) == every - some and set(rest.groups) & every == every - some
        assert every - some == negated  # what does not go by a colour is what is not of that colour


def test_colours_are_bound_to_their_nouns(room: Scene) -> None:
    """ "The brown thing and the floor" is not "the thing and the brown floor"."""
    eye = room.cameras[0]
    floor = resolve(room, Query(text="floor"), eye)
    color = next(c.color.split()[-1] for c in floor.candidates)
    other = next(w for w in ("blue", "purple", "green") if w != color)
    right = resolve(room, Query(text="floor", colors=(color,)), eye)
    assert right.groups == floor.groups
    assert resolve(room, Query(text="floor", colors=(other,)), eye).verdict == "absent"
    both = Query(text="thing", colors=(color,), pick="all", also=(Query(text="floor"),))
    assert floor.groups[0] in resolve(room, both, eye).groups


def test_several_walls_are_told_apart_or_asked_about(room: Scene) -> None:
    walls = [g.id for g in groups_of(room) if g.label == "wall"]
    assert len(walls) >= 2
    eye = room.cameras[0]
    which = resolve(room, Query(text="wall"), eye)
    assert which.verdict == "ambiguous" and {c.group for c in which.candidates} == set(walls)
    assert set(resolve(room, Query(text="wall", pick="all"), eye).groups) == set(walls)
    left, right = (resolve(room, Query(text="wall", pick=p), eye) for p in ("leftmost", "rightmost"))  # type: ignore[arg-type]
    assert left.verdict == right.verdict == "found" and left.groups != right.groups
    ordered = sorted(walls, key=lambda g: float(np.array(groups_of(room)[g].box.center) @ eye.right))
    assert [left.groups[0], right.groups[0]] == [ordered[0], ordered[-1]]
    assert all(a != b for a, b in pairwise(ordered))
