"""A small furnished room from cloud to table: all columns agree with each other, and nothing but the cloud is read."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, replace

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from scenewright.gaussians.assets import furnish
from scenewright.gaussians.assets.furnishing.furnish import Room
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.language.encoders import Encoder
from scenewright.gaussians.language.encoders.calibration import Calibration
from scenewright.gaussians.language.encoders.vocabulary import Vocabulary
from scenewright.gaussians.language.field.embed import embed
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.field.measure import TRIM
from scenewright.gaussians.render import contributions
from scenewright.gaussians.rotations import normalize
from scenewright.gaussians.scene import Frame, Scene


class Blind:
    """Sees the same in every picture, and whole objects as likely as not: geometry alone decides."""

    fingerprint = "blind:1"
    dim = 2
    image_size = 16
    vocabulary = Vocabulary({"thing": ()}, {}, ("part of something",))
    calibration = Calibration(scale=1.0, threshold=0.5)

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        return np.tile(np.array([[0.6, 0.8]], np.float32), (len(texts), 1))

    def encode_images(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        assert images.dtype == np.uint8 and images.shape[1:] == (16, 16, 3)
        return np.tile(np.array([[0.6, 0.8]], np.float32), (len(images), 1))

    def unknown_words(self, text: str) -> tuple[str, ...]:
        return ()

    def knows(self, text: str) -> bool:
        return True


ENCODER: Encoder = Blind()


@pytest.fixture(scope="module")
def room() -> Room:
    return furnish(5, objects=6, detail=0.35)


@pytest.fixture(scope="module")
def embedded(room: Room) -> Scene:
    return embed(room.scene, ENCODER)


@pytest.fixture(scope="module")
def field(embedded: Scene) -> LanguageField:
    assert embedded.language is not None
    return embedded.language


def rows_of(scene: Scene, group: Group) -> NDArray[np.bool_]:
    assert scene.language is not None
    return np.isin(scene.cloud.group.numpy(), scene.language.leaves(group.id))


def table(field: LanguageField | None) -> str:
    assert field is not None
    return json.dumps([asdict(g) for g in field.groups]) + field.embeddings.tobytes().hex() + repr(field.notes)


@pytest.mark.slow
def test_only_the_group_column_and_the_frame_change(room: Room, embedded: Scene) -> None:
    before, after = dict(room.scene.cloud.columns()), dict(embedded.cloud.columns())
    for name in before:
        assert name == "group" or torch.equal(before[name], after[name])
    assert (room.scene.cloud.group == -1).all() and room.scene.language is None  # the argument is as it was
    assert embedded.frame.up == room.scene.frame.up and embedded.cameras == room.scene.cameras


def test_every_gaussians_group_is_a_leaf_of_the_table(embedded: Scene, field: LanguageField) -> None:
    present = set(torch.unique(embedded.cloud.group).tolist())
    split = {g.parent for g in field.groups}
    assert present <= {-1, *(g.id for g in field.groups)}
    assert not present & (split - {-1})  # an object with parts owns its Gaussians through them
    assert (embedded.cloud.group == -1).float().mean() < 0.05


def test_counts_match_the_column(embedded: Scene, field: LanguageField) -> None:
    for group in field.groups:
        assert group.count == rows_of(embedded, group).sum()


def test_the_tree_has_two_levels(field: LanguageField) -> None:
    for group in field.groups:
        assert (group.level == "part") == (group.parent >= 0)
        if group.parent >= 0:
            assert field.groups[group.parent].level == "object"
    for parent in {g.parent for g in field.groups} - {-1}:
        assert len(field.leaves(parent)) >= 3  # one part alone would be the object itself


def test_boxes_hold_their_gaussians_but_for_the_trimming(embedded: Scene, field: LanguageField) -> None:
    up = embedded.frame.up_vector
    for group in field.groups:
        axes = np.array(group.box.axes)
        assert np.allclose(axes @ axes.T, np.eye(3), atol=1e-9) and np.linalg.det(axes) > 0
        assert np.allclose(axes[2], up, atol=1e-9)
        own = embedded.cloud.means.numpy()[rows_of(embedded, group) & (embedded.cloud.opacities > 0.05).numpy()]
        outside = np.abs(group.box.local(own)) > np.array(group.box.size) / 2 + 1e-6
        # up to TRIM on each of two sides of each axis; quantiles of few points round up to one more
        assert outside.mean(axis=0).max() <= 2 * TRIM + 2 / max(len(own), 1), group


def test_measures_are_in_their_ranges(field: LanguageField) -> None:
    for group in field.groups:
        assert 0 <= group.confidence <= 1 and 0 <= group.label_score <= 1 and group.views >= 0
        assert 0 <= group.lab[0] <= 100 and np.isfinite(group.lab).all()
        assert min(group.box.size) > 0
    norms = np.linalg.norm(field.embeddings, axis=1)
    assert np.all((np.abs(norms - 1) < 1e-5) | (norms == 0))
    pictured = np.array([g.level == "object" for g in field.groups])
    assert (norms[pictured] > 0).all() and (norms[~pictured] == 0).all()


def test_floor_and_walls_are_found_as_the_truth_has_them(room: Room, embedded: Scene, field: LanguageField) -> None:
    names = {g.label for g in field.groups if g.level == "structure"}
    assert {"floor", "wall"} <= names
    structure = np.isin(embedded.cloud.group.numpy(), [g.id for g in field.groups if g.level == "structure"])
    truth = np.asarray(room.truth.ids) == -1
    shared = (structure & truth).sum() / (structure | truth).sum()
    assert shared > 0.7  # doors and windows in the wall's plane decide most of the rest


def test_objects_are_about_as_many_as_the_room_has(room: Room, field: LanguageField) -> None:
    # Without an encoder that knows anything, some things fall apart and some grow together.
    true = len(room.truth.objects)
    assert 0.5 * true <= len(field.objects()) <= 3 * true


@pytest.mark.slow  # the next test compares an embedding of the same cloud to the last bit too
def test_the_same_scene_gives_the_same_bytes(room: Room, embedded: Scene) -> None:
    again = embed(room.scene, ENCODER)
    assert again.cloud.digest() == embedded.cloud.digest()
    assert table(again.language) == table(embedded.language)
    assert again.frame == embedded.frame


@pytest.mark.slow
def test_groups_that_a_file_brought_are_not_looked_at(room: Room, embedded: Scene) -> None:
    leaked = torch.from_numpy(np.asarray(room.truth.ids).astype(np.int32))
    scene = room.scene.replace(cloud=room.scene.cloud.replace(group=leaked, ids=room.scene.cloud.ids + 17))
    again = embed(scene, ENCODER)
    assert torch.equal(again.cloud.group, embedded.cloud.group)
    assert table(again.language) == table(embedded.language)


def test_progress_is_told_in_order(world: Callable[[int], object]) -> None:
    told: list[tuple[str, float]] = []
    cloud = world(0).box("crate", (0, 0, 0), (1, 1, 1), (0.8, 0.1, 0.1), 0.05).cloud()  # type: ignore[attr-defined]
    scene = Scene(cloud, Frame(up_source="given"))
    embed(scene, ENCODER, lambda stage, share: told.append((stage, share)), views_per_candidate=1)
    stages = list(dict.fromkeys(stage for stage, _ in told))
    assert stages[:3] == ["surface", "views", "segments"] and stages[-1] == "table"
    assert all(0 <= share <= 1 for _, share in told)


def test_a_crate_alone_is_one_object(world: Callable[[int], object]) -> None:
    cloud = world(0).box("crate", (0, 0, 0), (1, 1, 1), (0.8, 0.1, 0.1), 0.05).cloud()  # type: ignore[attr-defined]
    scene = embed(Scene(cloud, Frame(up_source="given")), ENCODER, views_per_candidate=1)
    assert scene.language is not None
    largest = max(scene.language.objects(), key=lambda g: g.count)
    assert largest.count > 0.5 * len(cloud)


@pytest.mark.parametrize("count", [1, 2, 5, 60])
@pytest.mark.parametrize("together", [True, False], ids=["one point", "spread"])
def test_degenerate_clouds_are_embedded_without_objects_rather_than_refused(count: int, together: bool) -> None:
    spread = torch.rand(count, 3, generator=torch.Generator().manual_seed(3))
    means = torch.full((count, 3), 0.3) if together else spread
    cloud = GaussianCloud.create(
        means, torch.tensor([[1.0, 0, 0, 0]]).repeat(count, 1), torch.full((count, 3), 0.01), torch.full((count,), 0.9),
        torch.zeros(count, 1, 3),
    )  # fmt: skip
    for frame in (Frame(), Frame(up_source="given", floor=0.0)):
        scene = embed(Scene(cloud, frame), ENCODER, views_per_candidate=1)
        assert scene.language is not None and len(scene.cloud) == count
        assert all(g.count == rows_of(scene, g).sum() for g in scene.language.groups)


def test_haze_alone_is_embedded_without_objects() -> None:
    means = torch.rand(80, 3, generator=torch.Generator().manual_seed(3))
    cloud = GaussianCloud.create(
        means, torch.tensor([[1.0, 0, 0, 0]]).repeat(80, 1), torch.full((80, 3), 0.01), torch.full((80,), 0.02),
        torch.zeros(80, 1, 3),
    )  # fmt: skip
    scene = embed(Scene(cloud), ENCODER, views_per_candidate=1)
    assert scene.language is not None and (scene.cloud.group == -1).all()


def test_an_empty_scene_is_the_users_error() -> None:
    with pytest.raises(UserError, match="no Gaussians"):
        embed(Scene(GaussianCloud.empty()), ENCODER)


def test_what_was_estimated_is_noted(world: Callable[[int], object]) -> None:
    made = world(0).sheet("floor", (-1, -1, 0), (2, 0, 0), (0, 2, 0), (0.5, 0.4, 0.3), 0.06)  # type: ignore[attr-defined]
    cloud = made.box("crate", (-0.3, -0.3, 0.02), (0.3, 0.3, 0.6), (0.8, 0.1, 0.1), 0.05).cloud()
    camera = Camera.look_at((0, -3, 2), (0, 0, 0), (0, 0, 1), 64, 64)
    scene = embed(Scene(cloud, cameras=(camera,)), ENCODER, views_per_candidate=1)
    assert scene.language is not None and scene.frame.up_source == "estimated"
    assert any("up was estimated" in note for note in scene.language.notes)
    known = embed(Scene(cloud, replace(scene.frame, up_source="given")), ENCODER, views_per_candidate=1)
    assert known.language is not None
    assert not any("up was estimated" in note for note in known.language.notes)


def strays(cloud: GaussianCloud, count: int, seed: int) -> GaussianCloud:
    """Splats of any colour in the air of a room, more than a hand's breadth from everything."""
    rng = np.random.default_rng(seed)
    low, high = np.quantile(cloud.means.numpy(), [0.01, 0.99], axis=0)
    points = rng.uniform(low, high, (6 * count, 3))
    points = points[cKDTree(cloud.means.numpy()).query(points)[0] > 0.15][:count].astype(np.float32)
    n = len(points)
    return GaussianCloud.create(
        torch.from_numpy(points),
        normalize(torch.from_numpy(rng.normal(size=(n, 4)).astype(np.float32))),
        torch.from_numpy(rng.uniform(0.005, 0.05, (n, 3)).astype(np.float32)),
        torch.from_numpy(rng.uniform(0.2, 0.95, n).astype(np.float32)),
        torch.from_numpy(rng.normal(0, 0.5, (n, *cloud.sh.shape[1:])).astype(np.float32)),
    )


def best_ious(scene: Scene, truth: NDArray[np.int32], objects: int) -> NDArray[np.float64]:
    """Of the best group for each object, over the first `len(truth)` rows."""
    assert scene.language is not None
    masks = [rows_of(scene, g) for g in scene.language.objects()]
    wholes = [np.r_[truth == i, np.zeros(len(scene.cloud) - len(truth), bool)] for i in range(objects)]
    return np.array([max((m & t).sum() / (m | t).sum() for m in masks) for t in wholes])


@pytest.mark.parametrize("count", [100, 1500, 6000])
@pytest.mark.slow
def test_floaters_belong_to_nothing_and_leave_things_as_they_were(room: Room, embedded: Scene, count: int) -> None:
    added = strays(room.scene.cloud, count, seed=count)
    start = len(room.scene.cloud)
    joined = concat([room.scene.cloud, added.replace(ids=torch.arange(start, start + len(added)))])
    dirty = embed(room.scene.replace(cloud=joined), ENCODER)
    assert (dirty.cloud.group[start:] == -1).float().mean() > 0.85  # the others lie before a wall, as coarse as they
    truth, objects = room.truth.ids.numpy(), len(room.truth.objects)
    clean, now = best_ious(embedded, truth, objects), best_ious(dirty, truth, objects)
    assert now.mean() > clean.mean() - 0.02  # superpoints shift a little as neighbours change


def test_what_no_view_sees_belongs_to_its_thing_all_the_same(room: Room, embedded: Scene) -> None:
    """Backs and undersides: segments are found on the whole surface, not in pictures."""
    shown = torch.stack([contributions(room.scene.cloud, c.resized(160, 107)) for c in room.scene.cameras]).amax(dim=0)
    hidden = (shown < 1e-4).numpy()
    truth, group = room.truth.ids.numpy(), embedded.cloud.group.numpy()
    right, asked = 0, 0
    for thing in room.truth.objects:
        own, back = truth == thing.id, hidden & (truth == thing.id)
        masks = [rows_of(embedded, g) for g in embedded.language.objects()]  # type: ignore[union-attr]
        best = max(masks, key=lambda m: (m & own & ~hidden).sum())  # the group that what is seen of it belongs to
        right, asked = right + int((best & back).sum()), asked + int(back.sum())
    assert asked > 0.05 * (truth >= 0).sum()  # there is something to be right about
    assert right > 0.85 * asked and (group[hidden] >= 0).mean() > 0.95


def test_every_wall_is_a_thing_of_its_own(embedded: Scene, field: LanguageField) -> None:
    walls = [g for g in field.groups if g.label == "wall"]
    assert len(walls) > 1 and sum(g.label == "floor" for g in field.groups) == 1
    for wall in walls:
        assert min(wall.box.size[:2]) < 0.1 * max(wall.box.size)  # one plane, not a corner of two


@pytest.mark.parametrize("kept", [0, 1])
@pytest.mark.slow
def test_dropping_views_changes_no_group(room: Room, embedded: Scene, kept: int) -> None:
    """Where fewer pictures were taken, things are as whole as before: borders are found in space."""
    fewer = embed(room.scene.replace(cameras=room.scene.cameras[:kept]), ENCODER)
    assert torch.equal(fewer.cloud.group, embedded.cloud.group)
