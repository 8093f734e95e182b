"""The scenes that selection is measured on hold what they claim, and mirrors mirror."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from scenewright.benchmarks._select import mirror, pairs, relations, spatial, stability
from scenewright.benchmarks._select import staged as staged_rooms
from scenewright.benchmarks._select.cases import Case
from scenewright.benchmarks._select.costs import resized
from scenewright.benchmarks._select.pictures import shaken
from scenewright.benchmarks._select.relations import Asked
from scenewright.benchmarks._select.spatial import Solid
from scenewright.gaussians import assets
from scenewright.gaussians.assets import TruthObject
from scenewright.gaussians.camera import Camera, Vec3
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.render import render
from scenewright.gaussians.scene import Frame, Scene

EYE = Camera.look_at([0, -4, 1.5], [0, 0, 0.5], [0, 0, 1], 64, 48, name="eye")


def cloud(count: int, degree: int, seed: int) -> GaussianCloud:
    """Gaussians strewn before the eye."""
    g = torch.Generator().manual_seed(seed)
    return GaussianCloud.create(
        torch.randn(count, 3, generator=g) * 0.6,
        torch.nn.functional.normalize(torch.randn(count, 4, generator=g), dim=1),
        0.05 + 0.3 * torch.rand(count, 3, generator=g),
        0.2 + 0.7 * torch.rand(count, generator=g),
        torch.randn(count, (degree + 1) ** 2, 3, generator=g) * 0.4,
    )


def thing(number: int, kind: str, x: float, y: float, size: Vec3 = (0.5, 0.5, 0.5), low: float = 0.0) -> TruthObject:
    """A box on the floor, or at the height `low`."""
    return TruthObject(number, kind, "red", size, (x, y, low + size[2] / 2), 0.0, "floor", ())


def scene_of(*things: TruthObject) -> Case:
    """A case of true boxes only."""
    return Case(1, Scene(GaussianCloud.empty(), Frame(), (EYE,)), np.zeros(0, np.int32), things)


# --- mirrors ---------------------------------------------------------------------------------------------------------


@given(st.integers(0, 3), st.integers(0, 2**31))
def test_a_mirrored_mirror_is_the_scene_itself(degree: int, seed: int) -> None:
    there = cloud(20, degree, seed)
    back = mirror.cloud_in_mirror(mirror.cloud_in_mirror(there))
    assert back.digest() == there.digest()
    eye = mirror.camera_in_mirror(mirror.camera_in_mirror(EYE))
    assert np.allclose(eye.world_to_camera, EYE.world_to_camera, atol=1e-12) and eye.cx == EYE.cx


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_the_picture_in_the_mirror_is_the_picture_from_right_to_left(degree: int) -> None:
    there = cloud(60, degree, 3)
    eye = Camera.look_at([0.4, -4, 1.5], [0.1, 0, 0.2], [0, 0, 1], 64, 48)
    seen = render(there, eye, backend="reference").rgb
    mirrored = render(mirror.cloud_in_mirror(there), mirror.camera_in_mirror(eye), backend="reference").rgb
    # float32 sums in another order; a Gaussian whose alpha lies at the cut of 1/255 may flip
    assert float((mirrored.flip(1) - seen).abs().max()) < 0.01


def test_left_and_right_swap_in_the_mirror_and_nothing_else_does() -> None:
    room = scene_of(thing(0, "sofa", 0.0, 0.0), thing(1, "chair", -1.5, 0.1), thing(2, "stool", 0.1, 1.6))
    flipped = mirror.mirrored(room)
    there, seen = ([Solid(o) for o in case.objects] for case in (room, flipped))
    other = {"left_of": "right_of", "right_of": "left_of"}
    viewer = flipped.scene.cameras[0]
    for name in spatial.SIDES:
        for i in (1, 2):
            before = spatial.stands(name, there[i], (there[0],), EYE)
            assert before == spatial.stands(other.get(name, name), seen[i], (seen[0],), viewer), (name, i)
            assert before == spatial.stands_by_object(_from_front(name), there[i], there[0])
    assert spatial.stands("left_of", there[1], (there[0],), EYE) is True
    assert spatial.stands("behind", there[2], (there[0],), EYE) is True


def _from_front(name: str) -> str:
    """What a viewer before a thing that faces him calls left is to its right, in front is in front."""
    return {"left_of": "right_of", "right_of": "left_of"}.get(name, name)


# --- relations -------------------------------------------------------------------------------------------------------


@given(st.floats(-180, 180), st.sampled_from(spatial.SIDES))
def test_what_is_clearly_so_is_clearly_not_the_opposite(degrees: float, name: str) -> None:
    a = math.radians(degrees)
    sofa, chair = Solid(thing(0, "sofa", 0, 0)), Solid(thing(1, "chair", 1.6 * math.cos(a), 1.6 * math.sin(a)))
    opposite = {"left_of": "right_of", "right_of": "left_of", "in_front_of": "behind", "behind": "in_front_of"}[name]
    if spatial.stands(name, chair, (sofa,), EYE):
        assert spatial.stands(opposite, chair, (sofa,), EYE) is False
        assert spatial.stands(opposite, sofa, (chair,), EYE) is not False  # along another line of sight: maybe unclear


@given(st.floats(0.2, 4), st.floats(0.2, 4), st.floats(0, 90))
def test_the_gap_of_turned_boxes_is_that_of_their_points(x: float, y: float, yaw: float) -> None:
    a = Solid(thing(0, "box", 0, 0, (1.0, 0.4, 0.5)))
    b = Solid(replace(thing(1, "box", x, y, (0.6, 0.8, 0.5)), yaw=yaw))
    t = np.stack(np.meshgrid(*[np.linspace(-0.5, 0.5, 21)] * 2), axis=-1).reshape(-1, 2)
    turn = np.array([[math.cos(math.radians(yaw)), math.sin(math.radians(yaw))]])
    rows = np.concatenate([turn, np.stack([-turn[:, 1], turn[:, 0]], axis=1)])
    filled = t * [1.0, 0.4], np.array([x, y]) + (t * [0.6, 0.8]) @ rows
    slow = np.linalg.norm(filled[0][:, None] - filled[1][None], axis=2).min()
    # points every 5 cm on one side and every 10 cm on the other: neither knows the gap better than half of that
    assert abs(spatial.gap(a, b) - slow) < 0.08


def test_only_clear_cases_are_asked() -> None:
    """A chair clearly left, another neither left nor not: "the chair left of the sofa" is not asked."""
    sofa, stool = thing(0, "sofa", 0, 0), thing(1, "stool", -1.5, 0.0)
    unclear = [thing(2, "chair", -1.5, 0.3), thing(3, "chair", -1.0, 1.3)]
    assert [spatial.stands("left_of", Solid(c), (Solid(sofa),), EYE) for c in unclear] == [True, None]
    asked = relations.generate(scene_of(sofa, stool, *unclear), [0])
    lefts = [q for q in asked if (q.name, q.frame) == ("left_of", "viewer")]
    of_sofa = [q for q in lefts if q.query.relations[0].anchors[0].text == "sofa"]
    assert [(q.query.text, q.object) for q in of_sofa] == [("stool", 1)]


def test_every_query_of_a_room_has_one_answer_by_the_boxes(staged: Case) -> None:
    asked = relations.generate(staged, [0, 1])
    solids = [Solid(o) for o in staged.objects]
    for one in asked:
        if one.frame == "viewer" and one.name not in ("nearest_to", "farthest_from"):
            assert _standing(staged, solids, one) == ([] if one.object is None else [one.object]), one
    names = {q.name for q in asked if q.object is not None}
    assert {"on", "under", "above", "inside", "left_of", "behind", "nearest_to"} <= names


def _standing(case: Case, solids: list[Solid], one: Asked) -> list[int]:
    """The objects of the asked kind that are not clearly elsewhere."""
    anchors = tuple(s for a in one.query.relations[0].anchors for s in solids if s.thing.kind == a.text)
    of_kind = [s for s in solids if s.thing.kind == one.query.text]
    eye = case.scene.cameras[one.eye]
    return [s.thing.id for s in of_kind if spatial.stands(one.name, s, anchors, eye) is not False]


@pytest.fixture(scope="module")
def staged() -> Case:
    """A room put together for relations."""
    return relations.staged_room(8004)


# --- pairs -----------------------------------------------------------------------------------------------------------


def test_attribute_rooms_hold_pairs_that_differ_in_what_is_asked() -> None:
    case, meant = pairs.attribute_room(8001)
    assert len(meant) >= 8
    for one in meant:
        assert one.object is not None
        own = case.objects[one.object]
        others = [o for o in case.objects if o.kind == own.kind and o.id != own.id]
        assert own.kind == one.query.text and len(others) == 1
        if one.query.size:
            assert (math.prod(own.size) > math.prod(others[0].size)) == (one.query.size == "large")
        else:
            assert (own.color,) == one.query.colors and others[0].color != own.color


@pytest.mark.slow
def test_swapped_rooms_hold_the_same_things_in_each_others_colours() -> None:
    (first, asked), (second, asked_again) = pairs.swap_rooms(8011)
    assert [o.kind for o in first.objects] == [o.kind for o in second.objects]
    assert all(np.allclose(a.position, b.position) for a, b in zip(first.objects, second.objects, strict=True))
    for case, meant in ((first, asked), (second, asked_again)):
        for one in meant:
            there = [o.id for o in case.objects if (o.kind, (o.color,)) == (one.query.text, one.query.colors)]
            assert there == ([] if one.object is None else [one.object])
    answered = [{m.query.describe() for m in meant if m.object is not None} for meant in (asked, asked_again)]
    refused = [{m.query.describe() for m in meant if m.object is None} for meant in (asked, asked_again)]
    assert answered[0] == refused[1] and answered[1] == refused[0]


@pytest.mark.parametrize("color", ["red", "black", "white", "beige"])
def test_a_thing_of_a_colour_is_mostly_painted_so_and_less_of_any_other(color: str) -> None:
    vase = assets.make("vase", pairs.design("vase", [color], 7), color=color)
    assert vase.color == color and staged_rooms.share_of(vase, color) >= pairs.PLAIN
    assert staged_rooms.share_of(vase, "purple") < 1 - pairs.PLAIN


# --- what is done to scenes ------------------------------------------------------------------------------------------


def _small() -> Case:
    there = cloud(50, 0, 1)
    return Case(5, Scene(there, Frame(), (EYE,)), np.arange(50, dtype=np.int32) % 3, ())


@pytest.mark.parametrize("count", [20, 50, 130])
def test_a_resized_case_keeps_truth_aligned(count: int) -> None:
    small, sized = _small(), resized(_small(), count)
    assert len(sized.scene.cloud) == len(sized.ids) == count
    for i in range(count):  # every row lies within a few deviations of one with the same truth
        own = small.scene.cloud.means[small.ids == sized.ids[i]]
        assert float((own - sized.scene.cloud.means[i]).norm(dim=1).min()) < 5 * 0.35


def test_floaters_are_added_behind_and_known_as_nothing() -> None:
    small, hazy = _small(), stability.with_floaters(_small(), 0.2)
    assert len(hazy.ids) == 60 and (hazy.ids[:50] == small.ids).all() and (hazy.ids[50:] == -1).all()
    assert torch.equal(hazy.scene.cloud.means[:50], small.scene.cloud.means)
    assert len(torch.unique(hazy.scene.cloud.ids)) == 60


@given(st.integers(0, 2**31))
def test_shaken_outlines_invent_nothing_and_move_little(seed: int) -> None:
    ids = np.full((64, 64), -1, np.int32)
    ids[10:40, 12:50] = 4
    moved = shaken(ids, np.random.default_rng(seed))
    assert set(np.unique(moved)) == {-1, 4}
    assert ((moved == 4) & (ids == 4)).sum() / (ids == 4).sum() > 0.85  # outlines wander by 0.4 pixels of 30
